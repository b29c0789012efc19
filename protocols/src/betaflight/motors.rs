//! To the simulator, one for each packet that the firmware accepts: what its motors are to do.

payload! {
    little, exactly, "a `motors` packet";
    /// Bytes of the packet.
    LEN;
    fields {
        /// Each motor's throttle, 0 to 1.
        throttle / set_throttle: [f32; 4],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Python: `struct.pack('<4f', 0, .25, .5, 1)`.
    const GOLDEN: [u8; LEN] = [0, 0, 0, 0, 0, 0, 0x80, 0x3e, 0, 0, 0, 0x3f, 0, 0, 0x80, 0x3f];

    fn repr() -> Repr {
        Repr { throttle: [0.0, 0.25, 0.5, 1.0] }
    }

    golden_tests!(GOLDEN, repr());
}
