//! `mpu`: the answer packet, a firmware's estimate with the time of its newest sample.

use crate::geometry::Attitude;
use crate::time::SimTime;
use crate::wire::dialogue::{Dialogue, Estimate, Said, Stamp};
use crate::wire::wrap::{MICROS_32, unwrapped};
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
                *newest = unwrapped(i64::from(t_us) * 1000, MICROS_32, *newest);
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
