#include "mavlink.h"

#include <string.h>

/* CRC-16/MCRF4XX, byte by byte. */
static uint16_t crc(uint16_t sum, uint8_t byte) {
    int bit;
    sum = (uint16_t)(sum ^ byte);
    for (bit = 0; bit < 8; bit++) sum = (uint16_t)(sum & 1 ? sum >> 1 ^ 0x8408 : sum >> 1);
    return sum;
}

/* A message around the payload at out + 10: zeros at its end are left out, but for its first byte. */
static size_t finish(uint8_t *out, uint8_t seq, uint8_t id, uint8_t crc_extra, size_t len) {
    uint16_t sum = 0xFFFF;
    size_t i;
    while (len > 1 && out[10 + len - 1] == 0) len--;
    out[0] = 0xFD;
    out[1] = (uint8_t)len;
    out[2] = out[3] = 0; /* nothing incompatible, nothing compatible */
    out[4] = seq;
    out[5] = 1; /* system */
    out[6] = 1; /* component: autopilot */
    out[7] = id;
    out[8] = out[9] = 0;
    for (i = 1; i < 10 + len; i++) sum = crc(sum, out[i]);
    sum = crc(sum, crc_extra);
    out[10 + len] = (uint8_t)sum;
    out[11 + len] = (uint8_t)(sum >> 8);
    return 12 + len;
}

static void put32(uint8_t *p, uint32_t v) {
    int i;
    for (i = 0; i < 4; i++) p[i] = (uint8_t)(v >> 8 * i);
}

static void put_floats(uint8_t *p, const float v[3]) {
    int i;
    for (i = 0; i < 3; i++) {
        uint32_t bits;
        memcpy(&bits, &v[i], sizeof bits);
        put32(p + 4 * i, bits);
    }
}

size_t mavlink_attitude(uint8_t out[MAVLINK_MAX], uint8_t seq, uint32_t time_boot_ms, const float euler[3],
                        const float rate[3]) {
    put32(out + 10, time_boot_ms);
    put_floats(out + 14, euler);
    put_floats(out + 26, rate);
    return finish(out, seq, 30, 39, 28);
}

size_t mavlink_heartbeat(uint8_t out[MAVLINK_MAX], uint8_t seq) {
    static const uint8_t payload[9] = {0, 0, 0, 0, 2, 8, 0, 4, 3}; /* quadrotor, no autopilot of others, active */
    memcpy(out + 10, payload, sizeof payload);
    return finish(out, seq, 0, 50, sizeof payload);
}
