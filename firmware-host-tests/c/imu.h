/* A chip on the bus, as bus.c wants it. imu_mpu9250.c is one; a folder named by RATETABLE_C_DRIVER may hold another:
 * the published driver's own files as they are, and one file with these two functions that calls it. */
#ifndef IMU_H
#define IMU_H

#include "ratetable.h"

/* One sample, in the chip's axes, which lie forward-left-up. */
struct imu_sample {
    float rate[3];      /* rad/s */
    float force[3];     /* m/s^2 */
    float field[3];     /* uT */
    int has_field;      /* 1: `field` is new */
    uint32_t period_us; /* by the chip's clock since the sample before; 0: it is of the moment of its read */
    int has_more;       /* 1: the driver holds another one */
};

/* Finds the chip and sets it up. Returns 0, or less than 0 if it could not: it is tried again. */
int imu_start(rt_bus *bus);

/* Reads the chip. Returns 1 with a sample, 0 if it has no new one, less than 0 if the bus failed. `out` is all zeros
 * before. */
int imu_read(rt_bus *bus, struct imu_sample *out);

#endif
