/* The explicit complementary filter on SO(3): R. Mahony, T. Hamel, J.-M. Pflimlin, "Nonlinear complementary filters on
 * the special orthogonal group", IEEE Transactions on Automatic Control 53(5), 2008, doi 10.1109/TAC.2008.923738.
 *
 * As a quaternion:  dq/dt = q * (0, w - b + e)/2,  db/dt = -ki e,  e = k_acc (v x v^) + k_mag (m x m^)
 *
 * where v and m are measured directions and v^, m^ those of the estimate, in body axes. The magnetometer's part is taken
 * about the vertical alone, so that a disturbed field turns the heading and tilts nothing. */
#ifndef MAHONY_H
#define MAHONY_H

struct mahony {
    float q[4];    /* w, x, y, z: body (forward-right-down) to nav (north-east-down) */
    float bias[3]; /* of the gyro, rad/s */
    float before[3]; /* its newest reading, rad/s */
    float level[3], north[3]; /* v x v^ and m x m^ of the newest readings */
};

/* Gains, 1/s and 1/s^2. Small ones, for a gyro whose bias is taken out at rest: a hard turn may then mislead the
 * accelerometer for seconds. */
#define MAHONY_K_ACC 0.03f
#define MAHONY_K_MAG 0.3f
#define MAHONY_K_I 0.001f

/* An accelerometer is believed within this part of 1 g, and while the vehicle turns slower than this, rad/s: in a turn
 * that is flown as turns are it reads as if level. */
#define MAHONY_G_SHARE 0.05f
#define MAHONY_RATE_MOST 0.2f

/* Begins at rest with means of all three sensors: rad/s, m/s^2, any unit; a field of zero is none, and north is ahead.
 * Declination in rad, positive east. */
void mahony_start(struct mahony *m, const float rate[3], const float force[3], const float field[3], float declination);

/* A reading of each sensor, in body axes; where several are of one time, the gyro's first. */
void mahony_gyro(struct mahony *m, const float rate[3], float dt_s);
void mahony_accel(struct mahony *m, const float force[3]);
void mahony_mag(struct mahony *m, const float field[3], float declination);

/* Roll, pitch and yaw, rad. */
void mahony_euler(const struct mahony *m, float out[3]);

#endif
