/* Two messages of MAVLink 2 (mavlink.io, common.xml): ATTITUDE and HEARTBEAT. */
#ifndef MAVLINK_H
#define MAVLINK_H

#include <stddef.h>
#include <stdint.h>

#define MAVLINK_MAX 40u

/* Angles rad, rates rad/s about body axes. Both return the bytes to send; `seq` counts messages. */
size_t mavlink_attitude(uint8_t out[MAVLINK_MAX], uint8_t seq, uint32_t time_boot_ms, const float euler[3],
                        const float rate[3]);
size_t mavlink_heartbeat(uint8_t out[MAVLINK_MAX], uint8_t seq);

#endif
