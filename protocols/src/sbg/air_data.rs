//! Class 0, id 36: what the barometer reads.

/// The class on the wire.
pub const CLASS: u8 = super::LOG;

/// The id on the wire.
pub const ID: u8 = 36;

/// The bit of [`Repr::status`] that says that [`Repr::pressure`] holds.
pub const HAS_PRESSURE: u16 = 0x0002;

/// The bit of [`Repr::status`] that says that [`Repr::temperature`] holds.
pub const HAS_TEMPERATURE: u16 = 0x0020;

payload! {
    little, at_least, "the payload of an `air_data` packet";
    /// Bytes of payload.
    LEN;
    fields {
        /// Since the unit started, µs; it begins again after 71 minutes.
        time_us / set_time_us: u32,
        /// Which fields hold: see [`HAS_PRESSURE`] and [`HAS_TEMPERATURE`].
        status / set_status: u16,
        /// Static pressure, Pa.
        pressure / set_pressure: f32,
        /// Altitude by that pressure, m.
        altitude / set_altitude: f32,
        /// Of a pitot tube, Pa.
        differential_pressure / set_differential_pressure: f32,
        /// True airspeed, m/s.
        airspeed / set_airspeed: f32,
        /// Of the air, °C.
        temperature / set_temperature: f32,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOLDEN: [u8; LEN] = [
        0x40, 0x42, 0x0f, 0x00, 0x22, 0x00, 0x00, 0x92, 0xb8, 0x47, 0x00, 0x00, 0xc0, 0x3f, 0x00, 0x00, 0x20,
        0xc1, 0x00, 0x00, 0x48, 0x41, 0x00, 0x00, 0xc8, 0x41,
    ];

    fn repr() -> Repr {
        Repr {
            time_us: 1_000_000,
            status: HAS_PRESSURE | HAS_TEMPERATURE,
            pressure: 94_500.0,
            altitude: 1.5,
            differential_pressure: -10.0,
            airspeed: 12.5,
            temperature: 25.0,
        }
    }

    golden_tests!(GOLDEN, repr());
}
