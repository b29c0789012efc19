#include "telemetry.h"

#include "board.h"
#include "mavlink.h"

static uint8_t seq;
static uint64_t beat_us;

void telemetry_send(const struct estimator *e) {
    uint8_t out[MAVLINK_MAX];
    float euler[3];
    if (seq == 0 || board_now_us() - beat_us >= 1000000u) {
        beat_us = board_now_us();
        board_write(BOARD_TELEMETRY, out, mavlink_heartbeat(out, seq++));
    }
    mahony_euler(&e->filter, euler);
    board_write(BOARD_TELEMETRY, out, mavlink_attitude(out, seq++, (uint32_t)(e->t_us / 1000u), euler, e->newest));
}
