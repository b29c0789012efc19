//! HIL_GPS: a receiver's fix, at each of its ticks.

use crate::sensor::{Claims, Fix};
use crate::time::SimTime;
use ratetable_protocols::mavlink::{Message, hil_gps};

/// A fix in three dimensions.
const THREE_D: u8 = 3;

/// The message of a fix: WGS 84, velocity along north, east and down, accuracies in cm, which is how PX4 reads
/// `eph` and `epv`.
pub(super) fn message(t: SimTime, fix: &Fix, claims: &Claims) -> Message {
    let [north, east, down] = fix.velocity.v.to_array();
    let course = libm::atan2(east, north).to_degrees().rem_euclid(360.0);
    let centi = |x: f64| libm::round(x * 100.0);
    Message::HilGps(hil_gps::Repr {
        time_usec: t.0 as u64 / 1000,
        lat: libm::round(fix.position.latitude.to_degrees() * 1e7) as i32,
        lon: libm::round(fix.position.longitude.to_degrees() * 1e7) as i32,
        alt: libm::round(fix.position.altitude * 1e3) as i32,
        eph: centi(claims.eph) as u16,
        epv: centi(claims.epv) as u16,
        vel: centi(libm::hypot(north, east)) as u16,
        velocity: [north, east, down].map(|v| centi(v) as i16),
        // 359.996° is 0°.
        cog: centi(course) as u16 % 36_000,
        fix_type: THREE_D,
        satellites_visible: claims.satellites,
        ..hil_gps::Repr::default()
    })
}
