#include "estimator.h"

#include <math.h>
#include <string.h>

static const float DECLINATION = (float)(DECLINATION_DEG)*0.017453293f;
static const uint64_t REST_US = 2000000, TELL_US = 20000;
/* Rest: below these, rad/s and m/s^2 off 1 g. */
static const float REST_RATE = 0.05f, REST_FORCE = 0.5f;

static float norm(const float v[3]) { return sqrtf(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

static void add(float sum[3], uint32_t *count, const float v[3]) {
    int i;
    for (i = 0; i < 3; i++) sum[i] += v[i];
    ++*count;
}

static void begin_rest(struct estimator *e) {
    memset(e, 0, sizeof *e);
}

static void mean(const float sum[3], uint32_t count, float out[3]) {
    int i;
    for (i = 0; i < 3; i++) out[i] = sum[i] / (float)count;
}

/* Begins the filter once there was rest for long enough. A chip without a magnetometer is taken to head north. */
static void begin_filter(struct estimator *e) {
    float rate[3], force[3], field[3] = {0, 0, 0};
    if (e->t_us - e->since_us < REST_US || !e->forces) return;
    mean(e->rate, e->gyros, rate);
    mean(e->force, e->forces, force);
    if (e->fields) mean(e->field, e->fields, field);
    mahony_start(&e->filter, rate, force, field, DECLINATION);
    e->running = 1;
}

void estimator_gyro(struct estimator *e, uint64_t t_us, const float rate[3]) {
    const uint64_t before_us = e->t_us;
    int i;
    if (e->running) {
        e->t_us = t_us;
        mahony_gyro(&e->filter, rate, (float)(t_us - before_us) * 1e-6f);
        for (i = 0; i < 3; i++) e->rate[i] = rate[i] - e->filter.bias[i];
        return;
    }
    if (norm(rate) > REST_RATE) begin_rest(e);
    if (e->gyros == 0) e->since_us = t_us;
    e->t_us = t_us;
    add(e->rate, &e->gyros, rate);
    begin_filter(e);
}

void estimator_accel(struct estimator *e, const float force[3]) {
    if (e->running) {
        mahony_accel(&e->filter, force);
    } else if (fabsf(norm(force) - 9.80665f) > REST_FORCE) {
        begin_rest(e);
    } else {
        add(e->force, &e->forces, force);
    }
}

void estimator_mag(struct estimator *e, const float field[3]) {
    if (e->running) mahony_mag(&e->filter, field, DECLINATION);
    else add(e->field, &e->fields, field);
}

int estimator_due(struct estimator *e) {
    if (!e->running || e->t_us - e->told_us < TELL_US) return 0;
    e->told_us = e->t_us;
    return 1;
}
