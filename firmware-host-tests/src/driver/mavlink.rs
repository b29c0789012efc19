//! The driver of a simulated sensor that speaks MAVLink.

use ratetable_protocols::Losses;
use ratetable_protocols::mavlink::{Decoder, Message, Received, hil_sensor};

use super::{Counts, Driver};
use crate::sample::Sample;

/// µT in a gauss.
const UT_PER_GAUSS: f64 = 100.0;

/// Reads `HIL_SENSOR`; `fields_updated` says which sensors have something new.
#[derive(Debug, Clone, Default)]
pub struct MavlinkDriver {
    decoder: Decoder,
    state: State,
}

/// Everything but the stream's own state.
#[derive(Debug, Clone, Default)]
struct State {
    sender: Option<(u8, u8)>,
    losses: Losses,
    counts: Counts,
}

impl MavlinkDriver {
    /// A driver that listens to whoever speaks first.
    pub fn new() -> Self {
        Self::default()
    }
}

impl Driver for MavlinkDriver {
    fn feed(&mut self, bytes: &[u8], on: &mut dyn FnMut(Sample)) {
        let Self { decoder, state } = self;
        decoder.feed(bytes, |received| match received {
            Ok(received) => {
                if let Some(sample) = state.receive(&received) {
                    on(sample);
                }
            }
            Err(_) => state.counts.damaged += 1,
        });
    }

    fn counts(&self) -> Counts {
        Counts { lost: self.state.losses.lost(), ..self.state.counts }
    }
}

impl State {
    /// Takes a packet; gives its readings if it has any.
    fn receive(&mut self, received: &Received) -> Option<Sample> {
        let header = &received.header;
        let sender = (header.system, header.component);
        self.counts.packets += 1;
        if *self.sender.get_or_insert(sender) == sender {
            self.losses.observe(header.seq);
        }
        let Some(Message::HilSensor(message)) = received.message else {
            return None;
        };
        let sample = read(&message);
        match &sample {
            Some(sample) => self.counts.take(sample),
            None => self.counts.skipped += 1,
        }
        sample
    }
}

/// The new readings of a message; `None` if it has none, or is of another set of sensors.
fn read(message: &hil_sensor::Repr) -> Option<Sample> {
    let sample = readings(message);
    let any = sample.gyro.is_some() || sample.accel.is_some() || sample.mag.is_some();
    (any && message.id == 0).then_some(sample)
}

/// What is new in a message of whichever set of sensors.
pub(crate) fn readings(message: &hil_sensor::Repr) -> Sample {
    let vector = |bits: u32, values: [f32; 3], scale: f64| {
        let new = message.fields_updated & bits == bits;
        new.then(|| values.map(|value| f64::from(value) * scale))
    };
    Sample {
        t_us: message.time_usec,
        gyro: vector(hil_sensor::GYRO, message.gyro, 1.0),
        accel: vector(hil_sensor::ACCEL, message.accel, 1.0),
        mag: vector(hil_sensor::MAG, message.mag, UT_PER_GAUSS),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ratetable_protocols::mavlink::{self, Header, Version};

    fn feed(driver: &mut MavlinkDriver, seq: u8, message: hil_sensor::Repr) -> Vec<Sample> {
        let header = Header { version: Version::V2, seq, system: 1, component: 1 };
        let mut bytes = [0; mavlink::MAX_LEN];
        let message = Message::HilSensor(message);
        let len = mavlink::encode(&header, &message, &mut bytes).unwrap();
        let mut samples = Vec::new();
        driver.feed(&bytes[..len], &mut |sample| samples.push(sample));
        samples
    }

    #[test]
    fn only_what_is_new_is_taken_and_gauss_become_microtesla() {
        let mut driver = MavlinkDriver::new();
        let message = hil_sensor::Repr {
            time_usec: 5_000,
            gyro: [0.5, 0.0, 0.0],
            accel: [0.0, 0.0, -9.75],
            mag: [0.25, 0.0, 0.5],
            fields_updated: hil_sensor::GYRO | hil_sensor::MAG,
            ..Default::default()
        };
        let [sample] = feed(&mut driver, 0, message)[..] else { panic!() };
        assert_eq!(sample.t_us, 5_000);
        assert_eq!(sample.gyro, Some([0.5, 0.0, 0.0]));
        assert_eq!(sample.accel, None);
        assert_eq!(sample.mag, Some([25.0, 0.0, 50.0]));

        let nothing = hil_sensor::Repr { fields_updated: hil_sensor::PRESSURE, ..message };
        assert!(feed(&mut driver, 3, nothing).is_empty());
        let other = hil_sensor::Repr { id: 1, ..message };
        assert!(feed(&mut driver, 4, other).is_empty());
        let counts = driver.counts();
        assert_eq!((counts.packets, counts.lost, counts.gyro, counts.skipped), (3, 2, 1, 2));
    }
}
