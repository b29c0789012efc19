/* What the tests of c/ratetable.h run: it reads cases, does as they say with the header, and tells what came of it.
 *
 *   driver decode            each case of standard input is a stream; a line for each packet, then one of the counts
 *   driver encode            each case is seq, t_us, clock_us and q; a line with the packet
 *   driver bus WORD...       operations on a bridge whose answers are the bytes of standard input
 *
 * A case is a length of four bytes, little-endian, and as many bytes. */
#include <stdio.h>
#include <stdlib.h>

#include "ratetable.h"

static uint8_t input[1 << 24];
static size_t input_len, input_at;

static void hex(const uint8_t *bytes, size_t n) {
    size_t i;
    for (i = 0; i < n; i++) printf("%02x", bytes[i]);
}

static void triad(const char *name, int there, const float v[3]) {
    if (there) printf(" %s %.9g %.9g %.9g", name, (double)v[0], (double)v[1], (double)v[2]);
}

/* A packet's own fields, and what they are by the newest config. */
static void tell(const rt_packet *p, rt_config *config) {
    const rt_config *c = &p->config;
    float v[3];
    int i;
    printf("%u %u %u", p->type, p->seq, p->t_us);
    for (i = 0; i < 3; i++) printf(" %d", p->accel[i]);
    printf(" %d", p->temperature);
    for (i = 0; i < 3; i++) printf(" %d", p->gyro[i]);
    printf(" %u", p->st1);
    for (i = 0; i < 3; i++) printf(" %d", p->mag[i]);
    printf(" %u %u %u %u %u %u %u %u", p->st2, c->who_am_i, c->smplrt_div, c->config, c->gyro_config, c->accel_config,
           c->mag_who, c->cntl1);
    for (i = 0; i < 3; i++) printf(" %u", c->asa[i]);
    printf(" %u", p->clock_us);
    for (i = 0; i < 4; i++) {
        uint32_t bits;
        memcpy(&bits, &p->q[i], sizeof bits);
        printf(" %08x", bits);
    }
    if (p->type == RT_CONFIG) *config = *c;
    if (p->type == RT_IMU || p->type == RT_GYRO) triad("rate", rt_rate_rad_s(config, p->gyro, v), v);
    if (p->type == RT_IMU || p->type == RT_ACCEL) triad("force", rt_force_m_s2(config, p->accel, v), v);
    if (p->type == RT_MAG) triad("field", rt_field_ut(config, p, v), v);
    if (p->type == RT_IMU && rt_temperature_c(config, p->temperature, v)) printf(" degc %.9g", (double)v[0]);
    printf("\n");
}

static void decode(const uint8_t *bytes, size_t n) {
    rt_decoder decoder;
    rt_config config;
    rt_packet packet;
    size_t i;
    memset(&decoder, 0, sizeof decoder);
    memset(&config, 0, sizeof config);
    for (i = 0; i < n; i++) {
        if (rt_feed(&decoder, bytes[i], &packet)) tell(&packet, &config);
    }
    printf("= %u %u %u %u %u\n", decoder.packets, decoder.damaged, decoder.lost, decoder.duplicates,
           decoder.out_of_order);
}

static void encode(const uint8_t *bytes, size_t n) {
    uint8_t out[RT_PACKET_MAX];
    float q[4];
    if (n != 25) exit(2);
    memcpy(q, bytes + 9, sizeof q);
    hex(out, rt_encode_attitude(out, bytes[0], rt__le32(bytes + 1), rt__le32(bytes + 5), q));
    printf("\n");
}

static int bridge_send(void *context, const uint8_t *bytes, size_t n) {
    (void)context;
    hex(bytes, n);
    return 0;
}

static int bridge_receive(void *context, uint8_t *bytes, size_t n, uint32_t timeout_ms) {
    size_t there = input_len - input_at;
    (void)context;
    if (timeout_ms == RT_QUIET_MS) printf("(drained)");
    if (n > there) n = there;
    if (n) memcpy(bytes, input + input_at, n);
    input_at += n;
    return (int)n;
}

/* Bytes of a word in hex. */
static size_t unhex(const char *word, uint8_t *out) {
    size_t n = 0;
    for (; word[0] && word[1]; word += 2, n++) {
        char pair[3] = {0, 0, 0};
        pair[0] = word[0];
        pair[1] = word[1];
        out[n] = (uint8_t)strtoul(pair, NULL, 16);
    }
    return n;
}

/* Operations: unchecked | baud N | w ADDR HEX | r ADDR N | x ADDR HEX N; `-` is no byte. A line for each: what was sent, the
 * result, what was read. */
static void bus(int count, char **word) {
    static uint8_t data[1024], got[1024];
    rt_bus bridge;
    int i;
    memset(&bridge, 0, sizeof bridge);
    bridge.send = bridge_send;
    bridge.receive = bridge_receive;
    for (i = 0; i < count; i++) {
        const char what = word[i][0];
        int result = RT_OK;
        size_t n = 0;
        uint8_t addr;
        if (what == 'u') {
            bridge.unchecked = 1;
            continue;
        }
        addr = (uint8_t)strtoul(word[i + 1], NULL, 16);
        if (what == 'b') {
            result = rt_bus_baud(&bridge, (uint32_t)strtoul(word[++i], NULL, 10));
        } else if (what == 'w') {
            result = rt_i2c_write(&bridge, addr, data, unhex(word[i + 2], data));
            i += 2;
        } else if (what == 'r') {
            n = strtoul(word[i + 2], NULL, 10);
            result = rt_i2c_read(&bridge, addr, got, n);
            i += 2;
        } else {
            n = strtoul(word[i + 3], NULL, 10);
            result = rt_i2c_write_read(&bridge, addr, data, unhex(word[i + 2], data), got, n);
            i += 3;
        }
        printf(" %d ", result);
        if (result == RT_OK) hex(got, n);
        printf("\n");
    }
}

int main(int count, char **word) {
    input_len = fread(input, 1, sizeof input, stdin);
    if (count >= 2 && word[1][0] == 'b') {
        bus(count - 2, word + 2);
        return 0;
    }
    while (input_len - input_at >= 4) {
        size_t n = rt__le32(input + input_at);
        uint8_t *one = NULL;
        input_at += 4;
        if (n > input_len - input_at) return 2;
        /* Each case in a block of its own, so that a step beyond its end is seen. */
        one = (uint8_t *)malloc(n ? n : 1);
        if (!one) return 2;
        memcpy(one, input + input_at, n);
        input_at += n;
        if (count >= 2 && word[1][0] == 'e') encode(one, n);
        else decode(one, n);
        free(one);
    }
    return 0;
}
