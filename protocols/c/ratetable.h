/* ratetable.h: the firmware's end of ratetable's links, in one header.
 *
 * Two links, each usable alone:
 *
 * 1. `mpu`, a stream of register images (docs/wire/mpu.md): rt_feed() takes a byte and tells when a packet is
 *    complete, rt_rate_rad_s() and its neighbours convert counts, rt_encode_attitude() writes the answer.
 *
 *        static rt_decoder decoder;                     // all zeros is a fresh decoder
 *        static rt_config config;
 *        rt_packet p;
 *        float rate[3];
 *        while (uart_read(&byte) && rt_feed(&decoder, byte, &p)) {
 *            if (p.type == RT_CONFIG) config = p.config;
 *            if (p.type == RT_GYRO && rt_rate_rad_s(&config, p.gyro, rate)) use(p.t_us, rate);
 *        }
 *
 * 2. A UART-to-I2C bridge (NXP SC18IM700 and SC18IM704): rt_i2c_write(), rt_i2c_read() and rt_i2c_write_read() over
 *    two functions of yours.
 *
 *        rt_bus bus = {0};
 *        bus.send = my_send;
 *        bus.receive = my_receive;
 *        if (rt_i2c_read_register(&bus, 0x68, 0x75, &who_am_i, 1) == RT_OK) ...
 *
 * C99 or C++17; no heap, no globals, no library but the compiler's own headers. Vectors are in the chip's axes.
 * Licensed under MIT or Apache-2.0, at your option.
 */
#ifndef RATETABLE_H
#define RATETABLE_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

/* ---- the stream `mpu` ------------------------------------------------------------------------------------------ */

/* Packet types. */
enum { RT_IMU = 0x01, RT_MAG = 0x02, RT_GYRO = 0x03, RT_ACCEL = 0x04, RT_CONFIG = 0x05, RT_ATTITUDE = 0x10 };

/* Bytes of the longest packet on the wire, which is an attitude, its closing zero included. */
#define RT_PACKET_MAX 30u

/* What the chip calls itself in WHO_AM_I, and its magnetometer in WIA. */
#define RT_WHO_MPU60X0 0x68u
#define RT_WHO_MPU9250 0x71u
#define RT_WHO_AK8963 0x48u

/* Registers that say how to read the others. */
typedef struct rt_config {
    uint8_t who_am_i;     /* 75 */
    uint8_t smplrt_div;   /* 19 */
    uint8_t config;       /* 1A */
    uint8_t gyro_config;  /* 1B: full scale in bits 4:3 */
    uint8_t accel_config; /* 1C: full scale in bits 4:3 */
    uint8_t mag_who;      /* AK8963 00; 0 without a magnetometer */
    uint8_t cntl1;        /* AK8963 0A */
    uint8_t asa[3];       /* AK8963 10-12: sensitivity adjustment */
} rt_config;

/* A packet. Only the fields of its type are set, all others are 0. */
typedef struct rt_packet {
    uint8_t type;
    uint8_t seq;         /* counts every packet on the link, wraps */
    uint32_t t_us;       /* time of the sample, us, wraps */
    int16_t accel[3];    /* counts: RT_IMU, RT_ACCEL */
    int16_t temperature; /* counts: RT_IMU */
    int16_t gyro[3];     /* counts: RT_IMU, RT_GYRO */
    int16_t mag[3];      /* counts in the AK8963's own axes: RT_MAG */
    uint8_t st1, st2;    /* its status: RT_MAG */
    rt_config config;    /* RT_CONFIG */
    uint32_t clock_us;   /* RT_ATTITUDE */
    float q[4];          /* w, x, y, z: RT_ATTITUDE */
} rt_packet;

/* Finds packets in a stream, and counts. All zeros is a fresh one. */
typedef struct rt_decoder {
    uint32_t packets;      /* received whole */
    uint32_t damaged;      /* stretches between zeros that are no packet */
    uint32_t lost;         /* packets that did not come, by their numbers */
    uint32_t duplicates;   /* the number before once more */
    uint32_t out_of_order; /* came after one that was sent later */
    uint16_t missing;      /* bit i: the number last - 1 - i has not come yet */
    uint8_t last;
    uint8_t started;
    uint8_t overlong;
    uint8_t len;
    uint8_t held[2 * RT_PACKET_MAX];
} rt_decoder;

static inline uint16_t rt__le16(const uint8_t *p) { return (uint16_t)(p[0] | p[1] << 8); }

static inline uint32_t rt__le32(const uint8_t *p) { return rt__le16(p) | (uint32_t)rt__le16(p + 2) << 16; }

static inline void rt__put32(uint8_t *p, uint32_t v) {
    int i;
    for (i = 0; i < 4; i++) p[i] = (uint8_t)(v >> 8 * i);
}

/* CRC-16/IBM-3740: polynomial 1021, initial FFFF; "123456789" gives 29B1. */
static inline uint16_t rt_crc16(const uint8_t *p, size_t n) {
    uint16_t crc = 0xFFFF;
    while (n--) {
        int bit;
        crc = (uint16_t)(crc ^ *p++ << 8);
        for (bit = 0; bit < 8; bit++) crc = (uint16_t)(crc & 0x8000 ? crc << 1 ^ 0x1021 : crc << 1);
    }
    return crc;
}

/* Undoes COBS; returns the length, 0 if it is damaged or does not fit. */
static inline size_t rt__unstuff(const uint8_t *in, size_t n, uint8_t *out, size_t room) {
    size_t i = 0, len = 0;
    while (i < n) {
        size_t code = in[i++], run = code - 1;
        if (code == 0 || run > n - i || run > room - len) return 0;
        if (run) memcpy(out + len, in + i, run);
        i += run;
        len += run;
        if (code != 0xFF && i < n) {
            if (len == room) return 0;
            out[len++] = 0;
        }
    }
    return len;
}

/* Bytes of payload of a type; 0 for one that does not exist. */
static inline size_t rt__payload_len(uint8_t type) {
    switch (type) {
    case RT_IMU: return 14;
    case RT_MAG: return 8;
    case RT_GYRO:
    case RT_ACCEL: return 6;
    case RT_CONFIG: return 10;
    case RT_ATTITUDE: return 20;
    default: return 0;
    }
}

/* Three numbers of two bytes; `low` is where the low byte of each lies. */
static inline void rt__triad(const uint8_t *p, int low, int16_t out[3]) {
    int i;
    for (i = 0; i < 3; i++) out[i] = (int16_t)(uint16_t)(p[2 * i + low] | p[2 * i + !low] << 8);
}

/* The fields of a payload. */
static inline void rt__fields(rt_packet *out, const uint8_t *p) {
    const int big_endian = 1, little_endian = 0;
    switch (out->type) {
    case RT_IMU:
        rt__triad(p, big_endian, out->accel);
        out->temperature = (int16_t)(uint16_t)(p[6] << 8 | p[7]);
        rt__triad(p + 8, big_endian, out->gyro);
        break;
    case RT_MAG:
        out->st1 = p[0];
        rt__triad(p + 1, little_endian, out->mag);
        out->st2 = p[7];
        break;
    case RT_GYRO: rt__triad(p, big_endian, out->gyro); break;
    case RT_ACCEL: rt__triad(p, big_endian, out->accel); break;
    case RT_CONFIG: memcpy(&out->config, p, sizeof out->config); break;
    default: {
        int i;
        out->clock_us = rt__le32(p);
        for (i = 0; i < 4; i++) {
            uint32_t bits = rt__le32(p + 4 + 4 * i);
            memcpy(&out->q[i], &bits, sizeof bits);
        }
    }
    }
}

/* Reads one packet without its closing zero; returns 1 if it is whole, else 0. */
static inline int rt_decode(const uint8_t *stuffed, size_t n, rt_packet *out) {
    uint8_t body[RT_PACKET_MAX - 2];
    size_t len = rt__unstuff(stuffed, n, body, sizeof body);
    if (len < 8 || rt_crc16(body, len - 2) != rt__le16(body + len - 2)) return 0;
    if (rt__payload_len(body[0]) != len - 8) return 0;
    memset(out, 0, sizeof *out);
    out->type = body[0];
    out->seq = body[1];
    out->t_us = rt__le32(body + 2);
    rt__fields(out, body + 6);
    return 1;
}

/* Counts by the number of a packet. A number of the last sixteen that was missing is out of order, no longer lost. */
static inline void rt__count(rt_decoder *d, uint8_t seq) {
    unsigned behind = (uint8_t)(d->last - seq), gap = (uint8_t)(seq - d->last - 1);
    uint16_t place = (uint16_t)(behind >= 1 && behind <= 16 ? 1u << (behind - 1) : 0);
    d->packets++;
    if (d->started && behind == 0) {
        d->duplicates++;
    } else if (d->started && (d->missing & place)) {
        d->missing = (uint16_t)(d->missing & ~place);
        d->lost--;
        d->out_of_order++;
    } else {
        if (d->started) {
            uint32_t come = gap < 16 ? (uint32_t)d->missing << 1 << gap : 0;
            d->missing = (uint16_t)(come | ((1u << (gap < 16 ? gap : 16)) - 1));
            d->lost += gap;
        }
        d->started = 1;
        d->last = seq;
    }
}

/* What has come since the last zero; behind damage that hid a zero, the packet at its end. */
static inline int rt__close(rt_decoder *d, rt_packet *out) {
    static const uint8_t lengths[] = {14, 8, 6, 10, 20};
    size_t i;
    if (!d->overlong && rt_decode(d->held, d->len, out)) return 1;
    d->damaged++;
    for (i = 0; i < sizeof lengths; i++) {
        size_t n = lengths[i] + 9u;
        if (d->len > n && rt_decode(d->held + (d->len - n), n, out)) return 1;
    }
    return 0;
}

/* Takes one byte of the stream; returns 1 if it completes a packet, which `out` then holds, else 0. */
static inline int rt_feed(rt_decoder *d, uint8_t byte, rt_packet *out) {
    int whole = 0;
    if (byte != 0) {
        if (d->len == sizeof d->held) { /* too long for a packet: only its end can be one */
            memmove(d->held, d->held + RT_PACKET_MAX, RT_PACKET_MAX);
            d->len = RT_PACKET_MAX;
            d->overlong = 1;
        }
        d->held[d->len++] = byte;
        return 0;
    }
    if (d->len > 0) whole = rt__close(d, out);
    if (whole) rt__count(d, out->seq);
    d->len = 0;
    d->overlong = 0;
    return whole;
}

/* Counts per deg/s and per g: RM-MPU-6000A and RM-MPU-9250A, registers 1B and 1C. */
static inline float rt_lsb_per_dps(const rt_config *c) {
    static const float lsb[] = {131.0f, 65.5f, 32.8f, 16.4f};
    return lsb[c->gyro_config >> 3 & 3];
}

static inline float rt_lsb_per_g(const rt_config *c) { return (float)(16384 >> (c->accel_config >> 3 & 3)); }

/* Angular rate, rad/s. Returns 1, or 0 as long as no config has come. */
static inline int rt_rate_rad_s(const rt_config *c, const int16_t counts[3], float out[3]) {
    float unit = 0.017453293f / rt_lsb_per_dps(c);
    int i;
    for (i = 0; i < 3; i++) out[i] = unit * (float)counts[i];
    return c->who_am_i != 0;
}

/* Specific force, m/s^2 (g is 9.80665). Returns 1, or 0 as long as no config has come. */
static inline int rt_force_m_s2(const rt_config *c, const int16_t counts[3], float out[3]) {
    float unit = 9.80665f / rt_lsb_per_g(c);
    int i;
    for (i = 0; i < 3; i++) out[i] = unit * (float)counts[i];
    return c->who_am_i != 0;
}

/* Field, uT, turned to the axes of gyro and accelerometer (MS1356-E, ASAX; PS-MPU-9250A, orientation of axes). Returns
 * 1, or 0 if the reading is old, overflowed, or of no magnetometer. */
static inline int rt_field_ut(const rt_config *c, const rt_packet *p, float out[3]) {
    float unit = p->st2 & 0x10 ? 0.15f : 0.6f, own[3];
    int i;
    for (i = 0; i < 3; i++) own[i] = (float)p->mag[i] * unit * (((float)c->asa[i] - 128.0f) / 256.0f + 1.0f);
    out[0] = own[1];
    out[1] = own[0];
    out[2] = -own[2];
    return c->mag_who == RT_WHO_AK8963 && (p->st1 & 0x01) != 0 && (p->st2 & 0x08) == 0;
}

/* Temperature of the die, degC. Returns 1, or 0 for a chip that is not known. */
static inline int rt_temperature_c(const rt_config *c, int16_t counts, float *out) {
    int is_60x0 = c->who_am_i == RT_WHO_MPU60X0;
    *out = is_60x0 ? (float)counts / 340.0f + 36.53f : (float)counts / 333.87f + 21.0f;
    return is_60x0 || c->who_am_i == RT_WHO_MPU9250;
}

/* Forward-left-up (a chip that lies flat, x forward) to forward-right-down, or back. */
static inline void rt_flip_yz(float v[3]) {
    v[1] = -v[1];
    v[2] = -v[2];
}

/* Writes the answer: body (FRD) to nav (NED), true north. `t_us` is that of the newest sample used, `clock_us` the
 * firmware's own clock, `seq` counts the answers. Returns RT_PACKET_MAX, the bytes to send. */
static inline size_t rt_encode_attitude(uint8_t out[RT_PACKET_MAX], uint8_t seq, uint32_t t_us, uint32_t clock_us,
                                        const float q[4]) {
    uint8_t *body = out + 1;
    size_t i, code_at = 0;
    uint16_t crc;
    body[0] = RT_ATTITUDE;
    body[1] = seq;
    rt__put32(body + 2, t_us);
    rt__put32(body + 6, clock_us);
    for (i = 0; i < 4; i++) {
        uint32_t bits;
        memcpy(&bits, &q[i], sizeof bits);
        rt__put32(body + 10 + 4 * i, bits);
    }
    crc = rt_crc16(body, 26);
    body[26] = (uint8_t)crc;
    body[27] = (uint8_t)(crc >> 8);
    for (i = 1; i < RT_PACKET_MAX - 1; i++) { /* COBS: each zero becomes the way to the next */
        if (out[i] == 0) {
            out[code_at] = (uint8_t)(i - code_at);
            code_at = i;
        }
    }
    out[code_at] = (uint8_t)(i - code_at);
    out[i] = 0;
    return RT_PACKET_MAX;
}

/* ---- an I2C bus behind a UART ------------------------------------------------------------------------------------ */

/* What came of a transfer. */
enum {
    RT_OK = 0,
    RT_E_LENGTH = -1,  /* nothing to read, or more than 255 bytes of it */
    RT_E_SEND = -2,    /* bus.send failed */
    RT_E_TIMEOUT = -3, /* the bridge did not answer in time */
    RT_E_ADDRESS = -4, /* no chip acknowledged this address */
    RT_E_DATA = -5,    /* the chip did not acknowledge data */
    RT_E_BUS = -6      /* the bridge reports a time-out, or something that is no status */
};

/* How long it is quiet behind the last byte of a late answer. */
#define RT_QUIET_MS 5u

/* A bridge. Set `send` and `receive`; all else may be 0. */
typedef struct rt_bus {
    /* Sends n bytes; returns 0, or less than 0 if it cannot. */
    int (*send)(void *context, const uint8_t *bytes, size_t n);
    /* Waits for n bytes, for at most this time; returns how many came, or less than 0. */
    int (*receive)(void *context, uint8_t *bytes, size_t n, uint32_t timeout_ms);
    void *context;
    uint32_t timeout_ms; /* of one answer; 0 is 1000 ms */
    int unchecked;       /* 1: does not ask for the status of a transfer, which saves a round trip; 0xFF is then read
                            where nobody answers */
    int late;            /* the header's own: 1 if answers and questions may be out of step */
} rt_bus;

static inline int rt__receive(rt_bus *bus, uint8_t *bytes, size_t n) {
    int got = bus->receive(bus->context, bytes, n, bus->timeout_ms ? bus->timeout_ms : 1000);
    if (got >= 0 && (size_t)got >= n) return RT_OK;
    bus->late = 1;
    return RT_E_TIMEOUT;
}

/* Behind an answer that was given up: throws away what comes until it is quiet. */
static inline void rt__drain(rt_bus *bus) {
    uint8_t byte;
    int most = 1024;
    if (!bus->late) return;
    while (most-- && bus->receive(bus->context, &byte, 1, RT_QUIET_MS) == 1) {}
    bus->late = 0;
}

/* One or more messages of a write. The bridge's length is a byte: what is longer continues in the next message. */
static inline int rt__messages(rt_bus *bus, uint8_t addr, const uint8_t *data, size_t n) {
    do {
        size_t part = n < 255 ? n : 255;
        uint8_t head[3] = {0x53, 0, 0};
        head[1] = (uint8_t)(addr << 1);
        head[2] = (uint8_t)part;
        if (bus->send(bus->context, head, 3) < 0) return RT_E_SEND;
        if (part && bus->send(bus->context, data, part) < 0) return RT_E_SEND;
        n -= part;
        if (n) data += part;
    } while (n);
    return RT_OK;
}

/* Asks how the last transfer went: register 0A, I2CStat. Whatever but RT_E_TIMEOUT tells that a bridge is there. */
static inline int rt_bus_status(rt_bus *bus) {
    static const uint8_t ask[] = {0x52, 0x0A, 0x50};
    uint8_t status;
    int result;
    if (bus->send(bus->context, ask, sizeof ask) < 0) return RT_E_SEND;
    if ((result = rt__receive(bus, &status, 1)) != RT_OK) return result;
    switch (status) {
    case 0xF0: return RT_OK;
    case 0xF1: return RT_E_ADDRESS;
    case 0xF2: return RT_E_DATA;
    case 0xF8: return RT_E_BUS;
    default: /* no status at all */
        bus->late = 1;
        return RT_E_BUS;
    }
}

/* Writes n bytes to the chip at a 7-bit address; none is a probe whether it is there. More than 255 bytes go as
 * messages of one transfer, which ratetable's bridge takes for one write: real bridges start anew between them. */
static inline int rt_i2c_write(rt_bus *bus, uint8_t addr, const uint8_t *data, size_t n) {
    static const uint8_t stop = 0x50;
    int result;
    rt__drain(bus);
    if ((result = rt__messages(bus, addr, data, n)) != RT_OK) return result;
    if (bus->send(bus->context, &stop, 1) < 0) return RT_E_SEND;
    return bus->unchecked ? RT_OK : rt_bus_status(bus);
}

/* Reads n bytes, 1 to 255, behind what has been written. */
static inline int rt__read(rt_bus *bus, uint8_t addr, uint8_t *out, size_t n) {
    uint8_t ask[4] = {0x53, 0, 0, 0x50};
    int result, status;
    ask[1] = (uint8_t)(addr << 1 | 1);
    ask[2] = (uint8_t)n;
    if (bus->send(bus->context, ask, 4) < 0) return RT_E_SEND;
    result = rt__receive(bus, out, n);
    if (bus->unchecked) return result;
    status = rt_bus_status(bus); /* says why nothing came */
    return status != RT_OK ? status : result;
}

/* Reads n bytes, 1 to 255, from the chip at a 7-bit address. */
static inline int rt_i2c_read(rt_bus *bus, uint8_t addr, uint8_t *out, size_t n) {
    if (n < 1 || n > 255) return RT_E_LENGTH;
    rt__drain(bus);
    return rt__read(bus, addr, out, n);
}

/* Writes wn bytes, then reads n bytes, 1 to 255, in one transfer. */
static inline int rt_i2c_write_read(rt_bus *bus, uint8_t addr, const uint8_t *data, size_t wn, uint8_t *out, size_t n) {
    int result;
    if (n < 1 || n > 255) return RT_E_LENGTH;
    rt__drain(bus);
    if ((result = rt__messages(bus, addr, data, wn)) != RT_OK) return result;
    return rt__read(bus, addr, out, n);
}

/* Reads n bytes, 1 to 255, of registers from `reg` on. */
static inline int rt_i2c_read_register(rt_bus *bus, uint8_t addr, uint8_t reg, uint8_t *out, size_t n) {
    return rt_i2c_write_read(bus, addr, &reg, 1, out, n);
}

/* Writes one register. */
static inline int rt_i2c_write_register(rt_bus *bus, uint8_t addr, uint8_t reg, uint8_t value) {
    uint8_t data[2];
    data[0] = reg;
    data[1] = value;
    return rt_i2c_write(bus, addr, data, 2);
}

/* Tells the bridge another baud rate (9600 after its reset): registers 0 and 1, 7372800 / (16 + BRG). Sent at the old
 * rate; change the UART's 1 ms later. */
static inline int rt_bus_baud(rt_bus *bus, uint32_t baud) {
    uint32_t divider = baud ? 7372800u / baud : 0;
    uint8_t set[6] = {0x57, 0x00, 0, 0x01, 0, 0x50};
    if (divider < 16 || divider - 16 > 0xFFFF) return RT_E_LENGTH;
    set[2] = (uint8_t)(divider - 16);
    set[4] = (uint8_t)((divider - 16) >> 8);
    return bus->send(bus->context, set, sizeof set) < 0 ? RT_E_SEND : RT_OK;
}

#endif
