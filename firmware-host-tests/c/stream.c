/* Firmware (a): reads the stream `mpu` on UART0, answers on it, and tells MAVLink's ATTITUDE on UART1. Its time is that
 * of the samples. */
#include "board.h"
#include "estimator.h"
#include "ratetable.h"
#include "telemetry.h"

static rt_decoder decoder;
static rt_config config;
static struct estimator estimator;
static uint64_t t_us; /* the samples' time, unwrapped */
static int has_time;
static uint8_t answers;

static void answer(const rt_packet *p) {
    uint8_t out[RT_PACKET_MAX];
    size_t n = rt_encode_attitude(out, answers++, p->t_us, (uint32_t)board_now_us(), estimator.filter.q);
    board_write(BOARD_LINK, out, n);
    telemetry_send(&estimator);
}

/* Goes on to the time of a packet; returns 0 for one that was overtaken. */
static int advance(uint32_t packet_us) {
    const uint32_t step = packet_us - (uint32_t)t_us;
    if (has_time && step > 0x7FFFFFFFu) return 0;
    has_time = 1;
    t_us += step;
    return 1;
}

static void take(const rt_packet *p) {
    float v[3];
    if (p->type == RT_CONFIG) config = p->config;
    if (p->type == RT_CONFIG || p->type == RT_ATTITUDE || !advance(p->t_us)) return;
    if ((p->type == RT_IMU || p->type == RT_GYRO) && rt_rate_rad_s(&config, p->gyro, v)) {
        rt_flip_yz(v);
        estimator_gyro(&estimator, t_us, v);
    }
    if ((p->type == RT_IMU || p->type == RT_ACCEL) && rt_force_m_s2(&config, p->accel, v)) {
        rt_flip_yz(v);
        estimator_accel(&estimator, v);
    }
    if (p->type == RT_MAG && rt_field_ut(&config, p, v)) {
        rt_flip_yz(v);
        estimator_mag(&estimator, v);
    }
    if ((p->type == RT_IMU || p->type == RT_GYRO) && estimator_due(&estimator)) answer(p);
}

int main(int argc, char **argv) {
    uint8_t bytes[256];
    rt_packet packet;
    board_start(argc, argv);
    for (;;) {
        size_t i, n = board_read(bytes, sizeof bytes, 1500000u);
        for (i = 0; i < n; i++) {
            if (rt_feed(&decoder, bytes[i], &packet)) take(&packet);
        }
        /* Silence behind a stream is its end. */
        if (n == 0 && (decoder.packets > 0 || board_closed())) board_exit(decoder.packets > 0 ? 0 : 1);
    }
}
