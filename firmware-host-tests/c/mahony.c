#include "mahony.h"

#include <math.h>

static const float G = 9.80665f;

static float norm(const float v[3]) { return sqrtf(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

/* Body to nav as a matrix. */
static void matrix(const float q[4], float r[3][3]) {
    const float w = q[0], x = q[1], y = q[2], z = q[3];
    r[0][0] = 1 - 2 * (y * y + z * z);
    r[0][1] = 2 * (x * y - w * z);
    r[0][2] = 2 * (x * z + w * y);
    r[1][0] = 2 * (x * y + w * z);
    r[1][1] = 1 - 2 * (x * x + z * z);
    r[1][2] = 2 * (y * z - w * x);
    r[2][0] = 2 * (x * z - w * y);
    r[2][1] = 2 * (y * z + w * x);
    r[2][2] = 1 - 2 * (x * x + y * y);
}

static void from_euler(float roll, float pitch, float yaw, float q[4]) {
    const float cr = cosf(roll / 2), sr = sinf(roll / 2);
    const float cp = cosf(pitch / 2), sp = sinf(pitch / 2);
    const float cy = cosf(yaw / 2), sy = sinf(yaw / 2);
    q[0] = cr * cp * cy + sr * sp * sy;
    q[1] = sr * cp * cy - cr * sp * sy;
    q[2] = cr * sp * cy + sr * cp * sy;
    q[3] = cr * cp * sy - sr * sp * cy;
}

void mahony_start(struct mahony *m, const float rate[3], const float force[3], const float field[3], float declination) {
    /* At rest the accelerometer reads up: -g along nav's down. */
    const float roll = atan2f(-force[1], -force[2]);
    const float pitch = atan2f(force[0], hypotf(force[1], force[2]));
    float r[3][3], north, east;
    int i;
    from_euler(roll, pitch, 0, m->q);
    matrix(m->q, r);
    north = r[0][0] * field[0] + r[0][1] * field[1] + r[0][2] * field[2];
    east = r[1][0] * field[0] + r[1][1] * field[1] + r[1][2] * field[2];
    if (hypotf(north, east) > 0) from_euler(roll, pitch, declination - atan2f(east, north), m->q);
    for (i = 0; i < 3; i++) {
        m->bias[i] = rate[i];
        m->before[i] = rate[i];
        m->level[i] = 0;
        m->north[i] = 0;
    }
}

void mahony_accel(struct mahony *m, const float force[3]) {
    const float strength = norm(force);
    const float rate[3] = {m->before[0] - m->bias[0], m->before[1] - m->bias[1], m->before[2] - m->bias[2]};
    const int believed = fabsf(strength / G - 1) < MAHONY_G_SHARE && norm(rate) < MAHONY_RATE_MOST;
    const float scale = believed ? -1 / strength : 0; /* down is against the force */
    float r[3][3];
    matrix(m->q, r);
    m->level[0] = scale * (force[1] * r[2][2] - force[2] * r[2][1]);
    m->level[1] = scale * (force[2] * r[2][0] - force[0] * r[2][2]);
    m->level[2] = scale * (force[0] * r[2][1] - force[1] * r[2][0]);
}

void mahony_mag(struct mahony *m, const float field[3], float declination) {
    float r[3][3], north, east, across, horizontal;
    int i;
    matrix(m->q, r);
    north = r[0][0] * field[0] + r[0][1] * field[1] + r[0][2] * field[2];
    east = r[1][0] * field[0] + r[1][1] * field[1] + r[1][2] * field[2];
    horizontal = hypotf(north, east);
    across = north * sinf(declination) - east * cosf(declination);
    for (i = 0; i < 3; i++) m->north[i] = horizontal > 0 ? across / horizontal * r[2][i] : 0;
}

/* Over a step the rate goes evenly from the reading before to this one. The turn is then their mean and, for an axis that
 * turns as well, a twelfth of their cross product: the first terms of the Magnus series. */
void mahony_gyro(struct mahony *m, const float rate[3], float dt_s) {
    const float w = m->q[0], x = m->q[1], y = m->q[2], z = m->q[3];
    float turn[3], from[3], to[3], half, s, c, length;
    int i;
    for (i = 0; i < 3; i++) {
        from[i] = m->before[i] - m->bias[i];
        to[i] = rate[i] - m->bias[i];
        m->before[i] = rate[i];
    }
    for (i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        const float e = MAHONY_K_ACC * m->level[i] + MAHONY_K_MAG * m->north[i];
        const float cone = (from[j] * to[k] - from[k] * to[j]) * dt_s / 12;
        m->bias[i] -= MAHONY_K_I * e * dt_s;
        turn[i] = ((from[i] + to[i]) / 2 + cone + e) * dt_s;
    }
    half = norm(turn) / 2;
    s = half > 0 ? sinf(half) / (2 * half) : 0.5f;
    c = cosf(half);
    for (i = 0; i < 3; i++) turn[i] *= s;
    m->q[0] = w * c - x * turn[0] - y * turn[1] - z * turn[2];
    m->q[1] = w * turn[0] + x * c + y * turn[2] - z * turn[1];
    m->q[2] = w * turn[1] - x * turn[2] + y * c + z * turn[0];
    m->q[3] = w * turn[2] + x * turn[1] - y * turn[0] + z * c;
    length = sqrtf(m->q[0] * m->q[0] + m->q[1] * m->q[1] + m->q[2] * m->q[2] + m->q[3] * m->q[3]);
    for (i = 0; i < 4; i++) m->q[i] /= length;
}

void mahony_euler(const struct mahony *m, float out[3]) {
    float r[3][3];
    matrix(m->q, r);
    out[0] = atan2f(r[2][1], r[2][2]);
    out[1] = asinf(fmaxf(-1, fminf(1, -r[2][0])));
    out[2] = atan2f(r[1][0], r[0][0]);
}
