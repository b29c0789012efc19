//! Command 0x201F, from the firmware: what it would do to the servos, and its attitude.
//!
//! Behind these fields follows what its display shows, run-length coded, if it has one.

use crate::msp::Direction;

/// The command on the wire.
pub const COMMAND: u16 = 0x201f;

/// Which way it goes.
pub const DIRECTION: Direction = Direction::Reply;

payload! {
    little, at_least, "the payload of a `simulator` reply";
    /// Bytes of payload, those of the display behind it left out.
    LEN;
    #[derive(Eq)]
    fields {
        /// Stabilised roll, pitch, yaw and throttle, -500 to 500.
        outputs / set_outputs: [i16; 4],
        /// Which `debug` value this is in bits 2:0; bit 4 and 5: no display; bit 6: armed; bit 7: an aeroplane.
        state / set_state: u8,
        /// One of the firmware's eight debug values, in turn.
        debug / set_debug: i32,
        /// Its own roll, pitch (nose down positive) and yaw (0 to 3600), 0.1 degrees.
        attitude / set_attitude: [i16; 3],
        /// 255, then the rows of its display: 0 for none.
        display / set_display: [u8; 2],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOLDEN: [u8; LEN] = [
        0xf4, 0xff, 0x22, 0x00, 0xc8, 0xff, 0xf4, 0x01, 0x35, 0xc0, 0x1d, 0xfe, 0xff, 0x2c, 0x01, 0x9c, 0xff,
        0x84, 0x03, 0xff, 0x00,
    ];

    fn repr() -> Repr {
        Repr {
            outputs: [-12, 34, -56, 500],
            state: 53,
            debug: -123456,
            attitude: [300, -100, 900],
            display: [255, 0],
        }
    }

    golden_tests!(GOLDEN, repr());

    #[test]
    fn bytes_of_the_display_behind_the_fields_are_left_alone() {
        assert_eq!(Repr::parse(&Payload::new_checked([GOLDEN, [7; LEN]].as_flattened()).unwrap()), repr());
    }
}
