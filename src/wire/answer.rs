//! What the other side answers: its own estimate of the attitude, to be judged against the truth.

use super::Protocol;
use crate::geometry::Attitude;
use crate::time::SimTime;
use glam::DQuat;
use ratetable_protocols::mpu;

/// An attitude estimate that came back.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The scene time of the newest sample it rests on, as echoed.
    pub t: SimTime,
    /// Body to nav.
    pub attitude: Attitude,
}

/// Decodes the answers on one link.
pub struct Listener {
    decoder: mpu::Decoder,
    newest: SimTime,
    /// Bytes that were no packet, or packets that were damaged.
    pub damaged: u64,
}

impl Listener {
    /// For the answers of a protocol, or `None` if it has none that echo scene time.
    pub fn new(protocol: Protocol) -> Option<Listener> {
        (protocol == Protocol::Mpu).then(|| Listener {
            decoder: mpu::Decoder::new(),
            newest: SimTime::ZERO,
            damaged: 0,
        })
    }

    /// Takes bytes in as they arrive and hands on every estimate in them.
    pub fn feed(&mut self, bytes: &[u8], mut each: impl FnMut(Estimate)) {
        let Listener { decoder, newest, damaged } = self;
        decoder.feed(bytes, |received| match received {
            Ok(mpu::Received { t_us, packet: mpu::Packet::Attitude(answer), .. }) => {
                *newest = unwrapped(t_us, *newest);
                let [w, x, y, z] = answer.q.map(f64::from);
                let q = DQuat::from_xyzw(x, y, z, w);
                if q.length_squared() > 0.25 && q.is_finite() {
                    each(Estimate { t: *newest, attitude: Attitude::from_quat(q.normalize()) });
                } else {
                    *damaged += 1;
                }
            }
            Ok(_) => {}
            Err(_) => *damaged += 1,
        });
    }
}

/// The time whose microseconds are `t_us` modulo 2³² and which is nearest to `near`.
pub(super) fn unwrapped(t_us: u32, near: SimTime) -> SimTime {
    let near_us = near.0 / 1000;
    let ahead = t_us.wrapping_sub(near_us as u32) as i32;
    SimTime((near_us + i64::from(ahead)).max(0) * 1000)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_goes_on_when_its_32_bits_wrap() {
        let mut t = SimTime::ZERO;
        for minute in 0..300i64 {
            let us = minute * 60_000_000;
            t = unwrapped(us as u32, t);
            assert_eq!(t.0, us * 1000);
        }
        assert_eq!(
            unwrapped(4_294_000_000, SimTime(4_295_000_000_000)).0,
            4_294_000_000_000,
            "and back a little"
        );
    }
}
