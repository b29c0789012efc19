#include "estimator.h"

#include <math.h>
#include <string.h>

static const float DECLINATION = (float)(DECLINATION_DEG)*0.017453293f;
static const uint64_t REST_US = 2000000, TELL_US = 20000;
/* Rest: below these, rad/s and m/s^2 off 1 g; and, once there is a mean, rad/s off that. */
static const float REST_RATE = 0.05f, REST_FORCE = 0.5f, REST_CHANGE = 0.03f;

static float norm(const float v[3]) { return sqrtf(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

/* Takes a reading into a mean. */
static void add(float mean[3], uint32_t *count, const float v[3]) {
    int i;
    ++*count;
    for (i = 0; i < 3; i++) mean[i] += (v[i] - mean[i]) / (float)*count;
}

/* 1 if a rate is one at rest. */
static int rests(const struct estimator *e, const float rate[3]) {
    float change[3];
    int i;
    for (i = 0; i < 3; i++) change[i] = rate[i] - e->rate[i];
    return e->running ? norm(change) < REST_CHANGE : norm(rate) < REST_RATE;
}

/* Begins the filter once there was rest for long enough, and anew as long as it lasts: a longer mean is a better one. A
 * chip without a magnetometer is taken to head north. */
static void begin_filter(struct estimator *e) {
    if (e->t_us - e->since_us < REST_US || e->t_us - e->begun_us < TELL_US || !e->forces) return;
    mahony_start(&e->filter, e->rate, e->force, e->field, DECLINATION);
    e->begun_us = e->t_us;
    e->running = 1;
}

/* A reading at rest, or the one that ends it. */
static void rest(struct estimator *e, uint64_t t_us, const float rate[3]) {
    if (!rests(e, rate)) {
        e->has_moved = e->running;
        if (!e->running) memset(e, 0, sizeof *e);
    }
    if (e->has_moved) return;
    if (e->gyros == 0) e->since_us = t_us;
    e->t_us = t_us;
    add(e->rate, &e->gyros, rate);
    begin_filter(e);
}

void estimator_gyro(struct estimator *e, uint64_t t_us, const float rate[3]) {
    const float dt_s = (float)(t_us - e->t_us) * 1e-6f;
    int i;
    if (!e->has_moved) rest(e, t_us, rate);
    if (e->has_moved) {
        e->t_us = t_us;
        mahony_gyro(&e->filter, rate, dt_s);
    }
    for (i = 0; i < 3; i++) e->newest[i] = rate[i] - e->filter.bias[i];
}

void estimator_accel(struct estimator *e, const float reading[3]) {
    static const float OFFSET_MG[3] = {ACCEL_OFFSET_MG};
    float force[3];
    int i;
    for (i = 0; i < 3; i++) force[i] = reading[i] - 9.80665e-3f * OFFSET_MG[i];
    if (e->has_moved) mahony_accel(&e->filter, force);
    else if (e->running || fabsf(norm(force) - 9.80665f) < REST_FORCE) add(e->force, &e->forces, force);
    else memset(e, 0, sizeof *e);
}

void estimator_mag(struct estimator *e, const float field[3]) {
    if (e->has_moved) mahony_mag(&e->filter, field, DECLINATION);
    else add(e->field, &e->fields, field);
}

int estimator_due(struct estimator *e) {
    if (!e->running || e->t_us - e->told_us < TELL_US) return 0;
    e->told_us = e->t_us;
    return 1;
}
