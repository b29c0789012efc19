//! `sbg`: a unit that is asked which device it is.
//!
//! ArduPilot's driver asks every five seconds until it is answered, and needs no answer. It also tells the unit what its
//! own compass and barometer read, ten times a second each, which this unit has no use for.

use crate::wire::dialogue::{Dialogue, Pause, Said};
use ratetable_protocols::sbg::{Decoder, MAX_LEN, Packet, Received, encode, info};

/// What the unit calls itself.
const PRODUCT: &[u8] = b"RATETABLE";
/// Version 1.0.0 of hardware and firmware as the unit packs one. The driver asks again while the firmware's is 0.
const HARDWARE: u32 = 1 << 24;
const FIRMWARE: u32 = 1 << 22;

/// One link to a flight controller that takes this for its unit.
#[derive(Default)]
pub(super) struct Unit {
    decoder: Decoder,
    damaged: u64,
    pause: Pause,
}

impl Dialogue for Unit {
    fn hear(&mut self, bytes: &[u8], now: i64, say: &mut dyn FnMut(Said<'_>)) {
        self.pause.heard(now);
        let Unit { decoder, damaged, .. } = self;
        decoder.feed(bytes, |received| match received {
            Ok(Received { packet: Some(Packet::InfoRequest), .. }) => answer(say),
            Ok(_) => {}
            Err(_) => *damaged += 1,
        });
    }

    fn tick(&mut self, now: i64, say: &mut dyn FnMut(Said<'_>)) {
        if self.pause.is_now(now) {
            let Unit { decoder, damaged, .. } = self;
            decoder.finish(|received| match received {
                Ok(Received { packet: Some(Packet::InfoRequest), .. }) => answer(say),
                Ok(_) => {}
                Err(_) => *damaged += 1,
            });
        }
    }

    fn damaged(&self) -> u64 {
        self.damaged
    }
}

fn answer(say: &mut dyn FnMut(Said<'_>)) {
    let mut product = [0; 32];
    product[..PRODUCT.len()].copy_from_slice(PRODUCT);
    let info = info::Repr {
        product,
        serial: 0,
        calibration: 0,
        year: 0,
        month: 0,
        day: 0,
        hardware: HARDWARE,
        firmware: FIRMWARE,
    };
    let mut buffer = [0; MAX_LEN];
    // MAX_LEN holds every packet.
    let len = encode(&Packet::Info(info), &mut buffer).unwrap_or(0);
    say(Said::Reply(&buffer[..len]));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wire::dialogue::{PAUSE, Stage};
    use proptest::prelude::*;
    use ratetable_protocols::sbg::{HEADER_LEN, air_data, mag};

    /// As ArduPilot's driver was seen to ask.
    const REQUEST: [u8; 9] = [0xff, 0x5a, 0x04, 0x10, 0x00, 0x00, 0x79, 0xf7, 0x33];

    fn hear(unit: &mut Unit, bytes: &[u8]) -> Vec<u8> {
        let mut heard = Vec::new();
        unit.hear(bytes, 0, &mut |said| match said {
            Said::Reply(bytes) => heard.extend_from_slice(bytes),
            other => panic!("{other:?}"),
        });
        heard
    }

    fn bytes(packet: &Packet) -> Vec<u8> {
        let mut buffer = [0; MAX_LEN];
        let len = encode(packet, &mut buffer).unwrap();
        buffer[..len].to_vec()
    }

    #[test]
    fn the_request_is_answered_with_a_device_that_has_a_firmware() {
        let mut unit = Unit::default();
        let answer = hear(&mut unit, &REQUEST);
        assert_eq!((answer.len(), &answer[..HEADER_LEN]), (61, &[0xff, 0x5a, 4, 16, 52, 0][..]));
        let mut seen = None;
        Decoder::new().feed(&answer, |received| seen = received.unwrap().packet);
        let Some(Packet::Info(info)) = seen else { panic!("{seen:?}") };
        assert!(info.firmware != 0 && info.product.starts_with(b"RATETABLE\0"));
        assert_eq!((unit.stage(), unit.damaged()), (Stage::Ready, 0));
        // However it is cut, and as often as it is asked.
        let pieces: Vec<u8> = REQUEST.repeat(2).chunks(1).flat_map(|byte| hear(&mut unit, byte)).collect();
        assert_eq!(pieces, answer.repeat(2));
    }

    #[test]
    fn what_the_controllers_own_sensors_read_is_not_answered_and_is_no_damage() {
        let mut unit = Unit::default();
        for packet in [
            Packet::Mag(mag::Repr { field: [1.0, 2.0, 3.0], ..Default::default() }),
            Packet::AirData(air_data::Repr::default()),
            // On a link that echoes.
            Packet::Info(info::Repr::default()),
        ] {
            assert_eq!(hear(&mut unit, &bytes(&packet)).len(), 0);
        }
        assert_eq!(unit.damaged(), 0);
        for bit in 0..REQUEST.len() * 8 {
            let mut hurt = REQUEST;
            hurt[bit / 8] ^= 1 << (bit % 8);
            assert_eq!(hear(&mut Unit::default(), &hurt).len(), 0, "bit {bit}");
        }
    }

    proptest! {
        #[test]
        fn any_bytes_do_not_keep_the_request_from_being_answered_after_a_pause(
            rubbish in prop::collection::vec(prop_oneof![any::<u8>(), Just(0xff), Just(0x5a), Just(0)], 0..400),
            piece in 1..100usize,
        ) {
            let mut unit = Unit::default();
            rubbish.chunks(piece).for_each(|piece| drop(hear(&mut unit, piece)));
            unit.tick(PAUSE, &mut |_| {});
            prop_assert_eq!(hear(&mut unit, &REQUEST).len(), 61);
        }
    }
}
