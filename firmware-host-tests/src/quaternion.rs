//! The few quaternion operations that a board needs: `[w, x, y, z]`, Hamilton.

/// Unit quaternion that turns nothing.
pub const IDENTITY: [f64; 4] = [1.0, 0.0, 0.0, 0.0];

/// The product: first `b`, then `a`.
pub fn mul(a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
    let [aw, ax, ay, az] = a;
    let [bw, bx, by, bz] = b;
    [
        aw * bw - ax * bx - ay * by - az * bz,
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
    ]
}

/// The turn back.
pub fn conj([w, x, y, z]: [f64; 4]) -> [f64; 4] {
    [w, -x, -y, -z]
}

/// The vector turned by `q`.
pub fn rotate(q: [f64; 4], [x, y, z]: [f64; 3]) -> [f64; 3] {
    let [_, x, y, z] = mul(mul(q, [0.0, x, y, z]), conj(q));
    [x, y, z]
}

/// The turn by `angle_rad` about a unit `axis`.
pub fn about(axis: [f64; 3], angle_rad: f64) -> [f64; 4] {
    let (s, c) = (angle_rad / 2.0).sin_cos();
    [c, s * axis[0], s * axis[1], s * axis[2]]
}

/// Body to nav from roll, pitch and yaw (ZYX), rad.
pub fn from_euler(roll: f64, pitch: f64, yaw: f64) -> [f64; 4] {
    let tilt = mul(about([0.0, 1.0, 0.0], pitch), about([1.0, 0.0, 0.0], roll));
    mul(about([0.0, 0.0, 1.0], yaw), tilt)
}

/// Roll, pitch and yaw (ZYX), rad; roll and yaw in (−π, π].
pub fn to_euler([w, x, y, z]: [f64; 4]) -> [f64; 3] {
    let roll = (2.0 * (w * x + y * z)).atan2(1.0 - 2.0 * (x * x + y * y));
    let pitch = (2.0 * (w * y - x * z)).clamp(-1.0, 1.0).asin();
    let yaw = (2.0 * (w * z + x * y)).atan2(1.0 - 2.0 * (y * y + z * z));
    [roll, pitch, yaw]
}

/// The angle between two attitudes, rad, whatever their signs.
pub fn angle_between(a: [f64; 4], b: [f64; 4]) -> f64 {
    let [w, x, y, z] = mul(conj(a), b);
    2.0 * (x * x + y * y + z * z).sqrt().atan2(w.abs())
}

/// Body (FRD) to nav (NED) from one accelerometer and one magnetometer reading at rest.
///
/// North is magnetic. `None` where the two are parallel or one is zero.
pub fn from_accel_mag(accel: [f64; 3], mag: [f64; 3]) -> Option<[f64; 4]> {
    let down = unit(accel.map(|f| -f))?;
    let east = unit(cross(down, mag))?;
    let north = cross(east, down);
    Some(from_rows([north, east, down]))
}

/// The unit vector along `v`; `None` for zero.
fn unit(v: [f64; 3]) -> Option<[f64; 3]> {
    let norm = v.iter().map(|c| c * c).sum::<f64>().sqrt();
    (norm > 1e-9).then(|| v.map(|c| c / norm))
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The quaternion of a rotation matrix, by the largest of its four squares (Shepperd).
fn from_rows(m: [[f64; 3]; 3]) -> [f64; 4] {
    let trace = m[0][0] + m[1][1] + m[2][2];
    let squares = [trace, m[0][0], m[1][1], m[2][2]];
    let largest = (0..4).max_by(|&a, &b| squares[a].total_cmp(&squares[b])).unwrap_or(0);
    let (wx, wy, wz) = (m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1]);
    let (xy, xz, yz) = (m[0][1] + m[1][0], m[0][2] + m[2][0], m[1][2] + m[2][1]);
    let square = 1.0 + 2.0 * squares[largest] - trace;
    let q = match largest {
        0 => [1.0 + trace, wx, wy, wz],
        1 => [wx, square, xy, xz],
        2 => [wy, xy, square, yz],
        _ => [wz, xz, yz, square],
    };
    let norm = q.iter().map(|c| c * c).sum::<f64>().sqrt();
    q.map(|c| c / norm)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_come_back() {
        for (roll, pitch, yaw) in [(0.5, -0.3, 2.0), (-3.0, 1.2, -1.0), (0.0, 0.0, 3.1)] {
            let [r, p, y] = to_euler(from_euler(roll, pitch, yaw));
            assert!((r - roll).abs() + (p - pitch).abs() + (y - yaw).abs() < 1e-12);
        }
    }

    #[test]
    fn roll_to_the_right_puts_the_right_wing_down_and_yaw_turns_east() {
        let right = rotate(from_euler(0.1, 0.0, 0.0), [0.0, 1.0, 0.0]);
        assert!(right[2] > 0.0);
        let nose = rotate(from_euler(0.0, 0.0, 0.1), [1.0, 0.0, 0.0]);
        assert!(nose[1] > 0.0);
    }

    #[test]
    fn two_vectors_give_the_attitude_everywhere() {
        for i in 0..200 {
            let i = f64::from(i);
            let q = from_euler(i * 0.7 - 60.0, (i * 0.3).sin() * 1.5, i * 1.1);
            let accel = rotate(conj(q), [0.0, 0.0, -9.8]);
            let mag = rotate(conj(q), [20.0, 0.0, 40.0]);
            let found = from_accel_mag(accel, mag).unwrap();
            assert!(angle_between(q, found) < 1e-7, "{i}");
        }
        assert_eq!(from_accel_mag([0.0; 3], [1.0, 0.0, 0.0]), None);
        assert_eq!(from_accel_mag([0.0, 0.0, -9.8], [0.0, 0.0, 5.0]), None);
    }
}
