//! The upload of a BMI270's program, without which it measures nothing (BST-BMI270-DS000, device
//! initialization).

/// Bytes of the program's memory.
const MEMORY: usize = 8192;
/// Bytes of the image that gives the features' memory to the FIFO, as its maker publishes it.
const LARGE_FIFO: usize = 328;
/// How long the chip takes at most to say that it is ready, ns.
const START_NS: u64 = 20_000_000;

/// Which image was uploaded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Image {
    /// All of the memory.
    Full,
    /// The short one.
    LargeFifo,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    Open,
    Failed,
    /// Ready at this time, ns.
    Complete(u64),
}

/// Which bytes of the memory were written.
#[derive(Clone, Debug)]
pub(super) struct Upload {
    written: [u64; MEMORY / 64],
    next: usize,
    state: State,
}

impl Default for Upload {
    fn default() -> Upload {
        Upload { written: [0; MEMORY / 64], next: 0, state: State::Open }
    }
}

impl Upload {
    /// The next byte belongs to this word: INIT_ADDR_0 has four low bits, INIT_ADDR_1 eight high ones.
    pub fn seek(&mut self, [low, high]: [u8; 2]) {
        self.next = (usize::from(high) << 4 | usize::from(low & 0x0f)) * 2;
    }

    /// A byte of INIT_DATA.
    pub fn take(&mut self) {
        if self.state != State::Open {
            return;
        }
        if let Some(bits) = self.written.get_mut(self.next / 64) {
            *bits |= 1 << (self.next % 64);
        }
        self.next = (self.next + 1) % MEMORY;
    }

    /// The upload is said to be complete: the image, if it is.
    pub fn end(&mut self, t_ns: u64) -> Option<Image> {
        if self.state != State::Open {
            return None;
        }
        let bytes: usize = self.written.iter().map(|bits| bits.count_ones() as usize).sum();
        let first = self
            .written
            .iter()
            .position(|bits| *bits != u64::MAX)
            .map_or(MEMORY, |word| 64 * word + self.written[word].trailing_ones() as usize);
        let image = match (first, bytes) {
            (MEMORY, _) => Some(Image::Full),
            (LARGE_FIFO, LARGE_FIFO) => Some(Image::LargeFifo),
            _ => None,
        };
        self.state = image.map_or(State::Failed, |_| State::Complete(t_ns.saturating_add(START_NS)));
        image
    }

    /// Whether the program was uploaded.
    pub fn is_complete(&self) -> bool {
        matches!(self.state, State::Complete(_))
    }

    /// INTERNAL_STATUS.message: not initialized 0, initialized 1, failed 2.
    pub fn message(&self, t_ns: u64) -> u8 {
        match self.state {
            State::Complete(ready_ns) if t_ns >= ready_ns => 1,
            State::Failed => 2,
            _ => 0,
        }
    }
}
