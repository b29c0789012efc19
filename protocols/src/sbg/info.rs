//! Class 16, id 4, from the unit: which device it is.

/// The class on the wire.
pub const CLASS: u8 = super::COMMAND;

/// The id on the wire.
pub const ID: u8 = 4;

payload! {
    little, at_least, "the payload of an `info` packet";
    /// Bytes of payload.
    LEN;
    #[derive(Eq)]
    fields {
        /// The product's name, zeros behind it.
        product / set_product: [u8; 32],
        /// The serial number.
        serial / set_serial: u32,
        /// The calibration's version.
        calibration / set_calibration: u32,
        /// Year of the calibration.
        year / set_year: u16,
        /// Month of the calibration, 1 to 12.
        month / set_month: u8,
        /// Day of the calibration, 1 to 31.
        day / set_day: u8,
        /// The hardware's version.
        hardware / set_hardware: u32,
        /// The firmware's version; ArduPilot's driver asks again while this is 0.
        firmware / set_firmware: u32,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOLDEN: [u8; LEN] = [
        0x45, 0x4c, 0x4c, 0x49, 0x50, 0x53, 0x45, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,
        0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x15, 0xcd,
        0x5b, 0x07, 0x01, 0x00, 0x00, 0x00, 0xea, 0x07, 0x0b, 0x16, 0x00, 0x00, 0x00, 0x03, 0x02, 0x00, 0x41,
        0x00,
    ];

    fn repr() -> Repr {
        let mut product = [0; 32];
        product[..7].copy_from_slice(b"ELLIPSE");
        Repr {
            product,
            serial: 123_456_789,
            calibration: 1,
            year: 2026,
            month: 11,
            day: 22,
            hardware: 0x0300_0000,
            firmware: 0x0041_0002,
        }
    }

    golden_tests!(GOLDEN, repr());
}
