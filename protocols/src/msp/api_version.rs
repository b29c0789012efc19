//! Command 1, from the firmware: which version of MSP it speaks.

use crate::msp::Direction;

/// The command on the wire.
pub const COMMAND: u16 = 1;

/// Which way it goes.
pub const DIRECTION: Direction = Direction::Reply;

payload! {
    little, exactly, "the payload of an `api_version` reply";
    /// Bytes of payload.
    LEN;
    #[derive(Eq)]
    fields {
        /// Version of the protocol.
        protocol / set_protocol: u8,
        /// Major version of the commands.
        major / set_major: u8,
        /// Minor version of the commands.
        minor / set_minor: u8,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOLDEN: [u8; LEN] = [0x00, 0x02, 0x05];

    fn repr() -> Repr {
        Repr { protocol: 0, major: 2, minor: 5 }
    }

    golden_tests!(GOLDEN, repr());
}
