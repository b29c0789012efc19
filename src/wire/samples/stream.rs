//! One stream of bytes, read by its protocol's reader.

use super::{Assumed, Counts, Reader, Sample};
use crate::wire::Protocol;

/// Reads the samples out of one stream of bytes, however it is cut up.
pub struct Samples {
    counts: Counts,
    reader: Box<dyn Reader>,
}

impl Samples {
    /// For a stream of which nothing more is known.
    pub fn new(protocol: Protocol) -> Samples {
        Samples::assuming(protocol, &Assumed::default())
    }

    /// For a recording. One of MAVLink may be a ground station's log (`.tlog`), with a stamp before each packet: its
    /// content tells.
    pub fn recorded(protocol: Protocol) -> Samples {
        Samples::of(protocol, &Assumed { recorded: true, ..Assumed::default() })
    }

    /// For a stream whose axes are known.
    pub fn assuming(protocol: Protocol, assumed: &Assumed) -> Samples {
        Samples::of(protocol, assumed)
    }

    fn of(protocol: Protocol, assumed: &Assumed) -> Samples {
        let row = protocol.row();
        let counts = Counts { numbered: row.is_numbered, ..Counts::default() };
        Samples { counts, reader: (row.reader)(assumed) }
    }

    /// Takes bytes in as they arrive and hands on every sample in them, in the order of the bytes.
    pub fn feed(&mut self, bytes: &[u8], mut each: impl FnMut(Sample)) {
        self.counts.bytes += bytes.len() as u64;
        self.reader.feed(bytes, &mut self.counts, &mut each);
    }

    /// Judges what is held as if nothing more were to come; half a packet at the end is no damage.
    pub fn finish(&mut self, mut each: impl FnMut(Sample)) {
        self.reader.finish(&mut self.counts, &mut each);
    }

    /// What has come so far.
    pub fn counts(&self) -> &Counts {
        &self.counts
    }
}
