//! `mpu`: the answer packet, a firmware's estimate with the time of its newest sample.

use crate::geometry::Attitude;
use crate::time::SimTime;
use crate::wire::dialogue::{Dialogue, Estimate, Said, Stamp};
use glam::DQuat;
use ratetable_protocols::mpu;

/// Decodes the answers on one link.
pub(super) struct Answers {
    decoder: mpu::Decoder,
    newest: SimTime,
    damaged: u64,
}

impl Answers {
    pub(super) fn new() -> Answers {
        Answers { decoder: mpu::Decoder::new(), newest: SimTime::ZERO, damaged: 0 }
    }
}

impl Dialogue for Answers {
    fn hear(&mut self, bytes: &[u8], _now: i64, say: &mut dyn FnMut(Said<'_>)) {
        let Answers { decoder, newest, damaged } = self;
        decoder.feed(bytes, |received| match received {
            Ok(mpu::Received { t_us, packet: mpu::Packet::Attitude(answer), .. }) => {
                *newest = unwrapped(t_us, *newest);
                let [w, x, y, z] = answer.q.map(f64::from);
                let q = DQuat::from_xyzw(x, y, z, w);
                if q.length_squared() > 0.25 && q.is_finite() {
                    let attitude = Attitude::from_quat(q.normalize());
                    say(Said::Estimate(Estimate { stamp: Stamp::Sample(*newest), attitude }));
                } else {
                    *damaged += 1;
                }
            }
            Ok(_) => {}
            Err(_) => *damaged += 1,
        });
    }

    fn damaged(&self) -> u64 {
        self.damaged
    }
}

/// The time whose microseconds are `t_us` modulo 2³² and which is nearest to `near`, but not negative.
pub(super) fn unwrapped(t_us: u32, near: SimTime) -> SimTime {
    let near_us = near.0 / 1000;
    let ahead = t_us.wrapping_sub(near_us as u32) as i32;
    let nearest = near_us + i64::from(ahead);
    SimTime(if nearest < 0 { nearest + (1 << 32) } else { nearest } * 1000)
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
