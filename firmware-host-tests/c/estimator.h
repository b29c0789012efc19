/* What a firmware does with readings: it waits for two seconds of rest, takes the gyro's bias and its attitude from the means
 * until something moves, then filters, and tells the attitude at even times. */
#ifndef ESTIMATOR_H
#define ESTIMATOR_H

#include <stdint.h>

#include "mahony.h"

/* Declination of the field where the firmware flies, deg, positive east. */
#ifndef DECLINATION_DEG
#define DECLINATION_DEG 0
#endif

/* Calibration of the board's accelerometer: what it reads too much, mg in body axes, separated by commas. */
#ifndef ACCEL_OFFSET_MG
#define ACCEL_OFFSET_MG 0, 0, 0
#endif

struct estimator {
    struct mahony filter;
    int running;           /* 1: there is an attitude */
    int has_moved;         /* 1: the rest is over, and the filter runs */
    uint64_t t_us;         /* of the newest gyro reading */
    uint64_t since_us;     /* begin of the rest */
    uint64_t begun_us;     /* when the means were taken over last */
    uint64_t told_us;      /* when the attitude was told last */
    uint32_t gyros, forces, fields;
    float rate[3], force[3], field[3]; /* means at rest */
    float newest[3];                   /* the newest rate, less its bias */
};

/* Readings in body axes (forward-right-down), in order of time, rad/s, m/s^2, uT. */
void estimator_gyro(struct estimator *e, uint64_t t_us, const float rate[3]);
void estimator_accel(struct estimator *e, const float reading[3]);
void estimator_mag(struct estimator *e, const float field[3]);

/* 1 if an attitude is there and it is time to tell it: every 20 ms of the readings' time. */
int estimator_due(struct estimator *e);

#endif
