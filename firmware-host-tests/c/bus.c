/* Firmware (b): reads a chip over an I2C bridge on UART0, by its own clock, and tells MAVLink's ATTITUDE on UART1 with
 * that clock. It asks the driver 200 times a second. */
#include "board.h"
#include "estimator.h"
#include "imu.h"
#include "telemetry.h"

static const uint32_t PERIOD_US = 5000, GIVE_UP_US = 5000000;

static struct estimator estimator;

static int send_bytes(void *context, const uint8_t *bytes, size_t n) {
    (void)context;
    board_write(BOARD_LINK, bytes, n);
    return board_closed() ? -1 : 0;
}

static int receive_bytes(void *context, uint8_t *bytes, size_t n, uint32_t timeout_ms) {
    uint64_t now = board_now_us(), until = now + (uint64_t)timeout_ms * 1000u;
    size_t got = 0;
    (void)context;
    for (;;) {
        got += board_read(bytes + got, n - got, (uint32_t)(until - now));
        now = board_now_us();
        if (got == n || now >= until || board_closed()) return (int)got;
    }
}

/* A bridge is at 9600 baud after its reset, and where this firmware has left it after the firmware's own. */
static int find_bridge(rt_bus *bus) {
    static const uint32_t bauds[] = {9600, 115200};
    size_t i;
    for (i = 0; i < 2; i++) {
        board_baud(bauds[i]);
        board_wait_until(board_now_us() + 1000u);
        if (rt_bus_status(bus) == RT_E_TIMEOUT) continue;
        if (bauds[i] == 115200) return 1;
        if (rt_bus_baud(bus, 115200) != RT_OK) return 0;
        board_wait_until(board_now_us() + 10000u); /* six bytes at 9600 baud, and 1 ms */
        board_baud(115200);
        return 1;
    }
    return 0;
}

static void take(uint64_t read_us, struct imu_sample *s) {
    static uint64_t t_us;
    t_us = s->period_us > 0 ? t_us + s->period_us : read_us;
    rt_flip_yz(s->rate);
    rt_flip_yz(s->force);
    rt_flip_yz(s->field);
    estimator_gyro(&estimator, t_us, s->rate);
    estimator_accel(&estimator, s->force);
    if (s->has_field) estimator_mag(&estimator, s->field);
    if (estimator_due(&estimator)) telemetry_send(&estimator);
}

/* Reads until the chip has not answered for five seconds. */
static void run(rt_bus *bus) {
    uint64_t due_us = board_now_us(), heard_us = due_us;
    while (board_now_us() - heard_us < GIVE_UP_US && !board_closed()) {
        struct imu_sample sample;
        uint64_t t_us;
        board_wait_until(due_us);
        t_us = board_now_us();
        due_us = t_us - due_us > PERIOD_US ? t_us + PERIOD_US : due_us + PERIOD_US; /* what is late is left out */
        do {
            memset(&sample, 0, sizeof sample);
            if (imu_read(bus, &sample) <= 0) break;
            heard_us = board_now_us();
            take(t_us, &sample);
        } while (sample.has_more);
    }
}

int main(int argc, char **argv) {
    static rt_bus bus;
    int has_run = 0;
    board_start(argc, argv);
    bus.send = send_bytes;
    bus.receive = receive_bytes;
    bus.timeout_ms = 1000;
    while (!board_closed()) {
        const int is_there = find_bridge(&bus);
        if (!is_there && has_run) break;
        if (!is_there || imu_start(&bus) != 0) continue;
        run(&bus);
        has_run = 1;
    }
    board_exit(has_run ? 0 : 1);
    return 1;
}
