//! One stream of bytes, read by its protocol's reader.

use super::{Assumed, Counts, Reader, Sample};
use crate::wire::Protocol;

/// Reads the samples from one stream of bytes, in pieces of any size.
pub struct Samples {
    counts: Counts,
    reader: Box<dyn Reader>,
}

impl Samples {
    /// A reader for a stream of which nothing else is known.
    pub fn new(protocol: Protocol) -> Samples {
        Samples::assuming(protocol, &Assumed::default())
    }

    /// A reader for a recording. A MAVLink recording may be a ground station's log (`.tlog`), with a stamp before
    /// each packet; its content decides.
    pub fn recorded(protocol: Protocol) -> Samples {
        Samples::of(protocol, &Assumed { recorded: true, ..Assumed::default() })
    }

    /// A reader for a stream with known axes.
    pub fn assuming(protocol: Protocol, assumed: &Assumed) -> Samples {
        Samples::of(protocol, assumed)
    }

    fn of(protocol: Protocol, assumed: &Assumed) -> Samples {
        let row = protocol.row();
        let counts = Counts { numbered: row.is_numbered, ..Counts::default() };
        Samples { counts, reader: (row.reader)(assumed) }
    }

    /// Processes bytes as they arrive and passes on every sample in them, in the order of the bytes.
    pub fn feed(&mut self, bytes: &[u8], mut each: impl FnMut(Sample)) {
        self.counts.bytes += bytes.len() as u64;
        self.reader.feed(bytes, &mut self.counts, &mut each);
    }

    /// Reads held bytes as if the stream ended here. Half a packet at the end is no damage.
    pub fn finish(&mut self, mut each: impl FnMut(Sample)) {
        self.reader.finish(&mut self.counts, &mut each);
    }

    /// The counts so far.
    pub fn counts(&self) -> &Counts {
        &self.counts
    }
}
