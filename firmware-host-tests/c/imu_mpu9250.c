/* MPU-9250 with its AK8963, or an MPU-6050 without a magnetometer: registers of RM-MPU-9250A and MS1356-E. It samples at
 * 100 Hz into its FIFO, which is read every 40 ms: what a busy bus or processor delays is not lost for 0.25 s, and the time
 * between samples is the chip's own. The chip's I2C master reads the magnetometer into the FIFO as well. */
#include "imu.h"

#include "board.h"

enum { MPU = 0x68, AK8963 = 0x0C };
enum {
    SMPLRT_DIV = 0x19, CONFIG = 0x1A, GYRO_CONFIG = 0x1B, ACCEL_CONFIG = 0x1C, ACCEL_CONFIG_2 = 0x1D,
    FIFO_EN = 0x23, I2C_MST_CTRL = 0x24, SLV0_ADDR = 0x25, SLV0_REG = 0x26, SLV0_CTRL = 0x27, SLV4_ADDR = 0x31, SLV4_REG = 0x32,
    SLV4_DO = 0x33, SLV4_CTRL = 0x34, SLV4_DI = 0x35, I2C_MST_STATUS = 0x36, USER_CTRL = 0x6A,
    PWR_MGMT_1 = 0x6B, FIFO_COUNT_H = 0x72, FIFO_R_W = 0x74, WHO_AM_I = 0x75
};
enum { AK_WIA = 0x00, AK_HXL = 0x03, AK_CNTL1 = 0x0A, AK_ASAX = 0x10 };
enum { AK_POWER_DOWN = 0x00, AK_FUSE_ROM = 0x0F, AK_CONTINUOUS_100_HZ_16_BIT = 0x16 };

/* A sample in the FIFO is 12 bytes of accelerometer and gyro, and 7 of the magnetometer: x, y, z and ST2. A message of
 * the bridge has at most 255. */
enum { MAG_AT = 12, FETCH = 255, SAMPLE_US = 10000, FETCH_US = 40000 };

/* What has been fetched from the FIFO. */
static uint8_t held[FETCH];
static size_t held_at, held_end, frame;
static uint64_t fetched_us;
/* 1: samples have been lost, or there were none before. */
static int has_gap;

/* What the chip is set to, as the stream `mpu` would tell it. */
static rt_config config;

static int set(rt_bus *bus, uint8_t reg, uint8_t value) { return rt_i2c_write_register(bus, MPU, reg, value); }

static int get(rt_bus *bus, uint8_t reg, uint8_t *value) { return rt_i2c_read_register(bus, MPU, reg, value, 1); }

/* Registers and values, until the first that fails. */
static int set_all(rt_bus *bus, const uint8_t (*pairs)[2], size_t n) {
    int result = RT_OK;
    size_t i;
    for (i = 0; i < n && result == RT_OK; i++) result = set(bus, pairs[i][0], pairs[i][1]);
    return result;
}

/* One transfer of the chip's master, by its slave 4; `value` is written, or read if `address` has bit 7. */
static int slave(rt_bus *bus, uint8_t address, uint8_t reg, uint8_t *value) {
    const uint8_t transfer[][2] = {{SLV4_ADDR, address}, {SLV4_REG, reg}, {SLV4_DO, *value}, {SLV4_CTRL, 0x80}};
    int result = set_all(bus, transfer, 4), tries;
    uint8_t status = 0;
    for (tries = 0; tries < 100 && result == RT_OK && !(status & 0x40); tries++) {
        result = get(bus, I2C_MST_STATUS, &status);
    }
    if (result != RT_OK) return result;
    if (!(status & 0x40) || status & 0x10) return RT_E_ADDRESS; /* not done, or not acknowledged */
    return address & 0x80 ? get(bus, SLV4_DI, value) : RT_OK;
}

static int ak_get(rt_bus *bus, uint8_t reg, uint8_t *value) {
    *value = 0;
    return slave(bus, AK8963 | 0x80, reg, value);
}

static int ak_set(rt_bus *bus, uint8_t reg, uint8_t value) {
    int result = slave(bus, AK8963, reg, &value);
    board_wait_until(board_now_us() + 100u); /* MS1356-E: between modes */
    return result;
}

/* Identity, sensitivity, 100 Hz, and its registers 03 to 09 behind each of the chip's samples. */
static int start_mag(rt_bus *bus) {
    static const uint8_t master[][2] = {{USER_CTRL, 0x20}, {I2C_MST_CTRL, 0x4D}};
    static const uint8_t stream[][2] = {{SLV0_ADDR, AK8963 | 0x80}, {SLV0_REG, AK_HXL}, {SLV0_CTRL, 0x87}};
    uint8_t i;
    if (set_all(bus, master, 2) != RT_OK || ak_get(bus, AK_WIA, &config.mag_who) != RT_OK) return -1;
    if (config.mag_who != RT_WHO_AK8963 || ak_set(bus, AK_CNTL1, AK_FUSE_ROM) != RT_OK) return -1;
    for (i = 0; i < 3; i++) {
        if (ak_get(bus, (uint8_t)(AK_ASAX + i), &config.asa[i]) != RT_OK) return -1;
    }
    if (ak_set(bus, AK_CNTL1, AK_POWER_DOWN) != RT_OK) return -1;
    if (ak_set(bus, AK_CNTL1, AK_CONTINUOUS_100_HZ_16_BIT) != RT_OK) return -1;
    return set_all(bus, stream, 3);
}

/* Empties the FIFO and lets it fill again. */
static int restart_fifo(rt_bus *bus) {
    bus->unchecked = 0;
    has_gap = 1;
    held_at = held_end = 0;
    return set(bus, USER_CTRL, config.mag_who ? 0x64 : 0x44);
}

int imu_start(rt_bus *bus) {
    /* 100 Hz behind 41 Hz of gyro and 45 Hz of accelerometer; 500 deg/s, 4 g. */
    static const uint8_t setup[][2] = {{PWR_MGMT_1, 0x01},   {SMPLRT_DIV, 9},      {CONFIG, 3},    {GYRO_CONFIG, 0x08},
                                       {ACCEL_CONFIG, 0x08}, {ACCEL_CONFIG_2, 3}};
    bus->unchecked = 0;
    memset(&config, 0, sizeof config);
    config.gyro_config = config.accel_config = 0x08;
    if (get(bus, WHO_AM_I, &config.who_am_i) != RT_OK) return -1;
    if (config.who_am_i != RT_WHO_MPU9250 && config.who_am_i != RT_WHO_MPU60X0) return -1;
    if (set_all(bus, setup, sizeof setup / sizeof *setup) != RT_OK) return -1;
    if (config.who_am_i == RT_WHO_MPU9250 && start_mag(bus) != RT_OK) return -1;
    /* Both into the FIFO, and what slave 0 reads. */
    if (set(bus, FIFO_EN, config.mag_who ? 0x79 : 0x78) != RT_OK) return -1;
    frame = config.mag_who ? 19 : 12;
    fetched_us = board_now_us();
    return restart_fifo(bus);
}

static int16_t big(const uint8_t *p) { return (int16_t)(uint16_t)(p[0] << 8 | p[1]); }

static int16_t little(const uint8_t *p) { return (int16_t)(uint16_t)(p[0] | p[1] << 8); }

/* Takes what is in the FIFO, as often as is worth a transfer; less than 0 if the bus failed. It does not ask how a
 * transfer went, which doubles the round trips: where nobody answers it reads FF, which is no whole number of samples. */
static int fetch(rt_bus *bus) {
    uint8_t raw[2];
    size_t n;
    if (board_now_us() - fetched_us < FETCH_US) return 0;
    fetched_us = board_now_us();
    bus->unchecked = 1;
    if (rt_i2c_read_register(bus, MPU, FIFO_COUNT_H, raw, 2) != RT_OK) return -1;
    n = (size_t)(raw[0] << 8 | raw[1]);
    if (n % frame != 0) return restart_fifo(bus); /* it was full, and has lost parts of samples */
    if (n > FETCH) n = FETCH / frame * frame;
    if (n == 0) return 0;
    if (rt_i2c_read_register(bus, MPU, FIFO_R_W, held, n) != RT_OK) {
        restart_fifo(bus); /* nobody knows what of it was read */
        return -1;
    }
    held_at = 0;
    held_end = n;
    return 0;
}

/* The gyro's filter delays by 5.9 ms (RM-MPU-9250A, register 1A), and nothing delays the field: turns it back to where it
 * was then, as one that is fixed in the world turns against the rate. */
static void delay_field(const float rate[3], float field[3]) {
    const float delay_s = 0.0059f, x = field[0], y = field[1], z = field[2];
    field[0] += delay_s * (rate[1] * z - rate[2] * y);
    field[1] += delay_s * (rate[2] * x - rate[0] * z);
    field[2] += delay_s * (rate[0] * y - rate[1] * x);
}

int imu_read(rt_bus *bus, struct imu_sample *out) {
    const uint8_t *raw;
    rt_packet p;
    int i;
    if (held_at == held_end && fetch(bus) != 0) return -1;
    if (held_at == held_end) return 0;
    raw = held + held_at;
    memset(&p, 0, sizeof p);
    for (i = 0; i < 3; i++) {
        p.accel[i] = big(raw + 2 * i);
        p.gyro[i] = big(raw + 6 + 2 * i);
        p.mag[i] = config.mag_who ? little(raw + MAG_AT + 2 * i) : (int16_t)0;
    }
    p.st1 = p.mag[0] || p.mag[1] || p.mag[2]; /* all zero: there was none yet */
    p.st2 = config.mag_who ? raw[MAG_AT + 6] : 0;
    held_at += frame;
    rt_rate_rad_s(&config, p.gyro, out->rate);
    rt_force_m_s2(&config, p.accel, out->force);
    out->has_field = rt_field_ut(&config, &p, out->field);
    delay_field(out->rate, out->field);
    out->has_more = held_at < held_end;
    out->period_us = has_gap ? 0 : SAMPLE_US;
    has_gap = 0;
    return 1;
}
