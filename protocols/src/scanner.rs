//! Packets that say their own length, out of a stream of bytes: what the decoders of several formats share.

use crate::error::Error;

/// How the packets of a format are recognised.
pub(crate) trait Format {
    /// What a packet amounts to.
    type Packet;

    /// Whether a packet may start with this byte.
    fn may_start(byte: u8) -> bool;

    /// Says what the held bytes, at least one, start with.
    fn judge(held: &[u8]) -> Verdict<Self::Packet>;
}

/// What held bytes start with.
pub(crate) enum Verdict<P> {
    /// Something: more bytes will tell.
    Wait,
    /// So many bytes that say nothing and may stand between packets.
    Filler(usize),
    /// No packet.
    Not(Error),
    /// A packet of so many bytes whose checksum is right, or why it is refused all the same.
    Packet(Result<P, Error>, usize),
}

/// Holds what has come of the next packet; `N` bytes are more than the longest has.
///
/// After damage it looks on from the byte behind the false start, so that a damaged length hides no packet. Damage is
/// reported once, however many bytes it takes to be in step again.
#[derive(Debug, Clone)]
pub(crate) struct Scanner<const N: usize> {
    held: [u8; N],
    len: usize,
    in_step: bool,
}

impl<const N: usize> Scanner<N> {
    /// Holds nothing.
    pub(crate) const fn new() -> Self {
        Self { held: [0; N], len: 0, in_step: true }
    }

    /// Takes more of the stream and calls `on` with each packet that it completes.
    pub(crate) fn feed<F: Format>(&mut self, bytes: &[u8], on: &mut impl FnMut(Result<F::Packet, Error>)) {
        for &byte in bytes {
            self.held[self.len] = byte;
            self.len += 1;
            let full = self.len == N;
            self.scan::<F>(full, on);
        }
    }

    /// Judges what is held as if no more were to come.
    pub(crate) fn finish<F: Format>(&mut self, on: &mut impl FnMut(Result<F::Packet, Error>)) {
        self.scan::<F>(true, on);
    }

    /// Takes all that can be judged from the front of what is held; at the end nothing may wait.
    fn scan<F: Format>(&mut self, at_end: bool, on: &mut impl FnMut(Result<F::Packet, Error>)) {
        while self.len > 0 {
            match F::judge(&self.held[..self.len]) {
                Verdict::Wait if !at_end => return,
                Verdict::Wait => self.refuse::<F>(Error::Malformed, on),
                Verdict::Not(error) => self.refuse::<F>(error, on),
                Verdict::Filler(count) => self.drop_front(count),
                Verdict::Packet(packet, len) => {
                    on(packet);
                    self.in_step = true;
                    self.drop_front(len);
                }
            }
        }
    }

    /// Drops a false start and all up to the next byte that may start a packet.
    fn refuse<F: Format>(&mut self, error: Error, on: &mut impl FnMut(Result<F::Packet, Error>)) {
        if self.in_step {
            on(Err(error));
        }
        self.in_step = false;
        let skip = self.held[1..self.len].iter().position(|&byte| F::may_start(byte));
        self.drop_front(skip.map_or(self.len, |skip| skip + 1));
    }

    /// Drops bytes from the front.
    fn drop_front(&mut self, count: usize) {
        let count = count.clamp(1, self.len);
        self.held.copy_within(count..self.len, 0);
        self.len -= count;
    }
}

/// Declares a format's public decoder over a [`Scanner`] of so many bytes: its docs, the format, what it finds, and the
/// docs of `feed`.
macro_rules! decoder {
    (
        $(#[$doc:meta])*
        $format:ident in $held:expr => $packet:ty;
        $(#[$feed:meta])*
        feed
    ) => {
        $(#[$doc])*
        #[derive(Debug, Clone)]
        pub struct Decoder($crate::scanner::Scanner<{ $held }>);

        impl Default for Decoder {
            fn default() -> Self {
                Self::new()
            }
        }

        impl Decoder {
            /// A decoder that holds nothing.
            pub const fn new() -> Self {
                Self($crate::scanner::Scanner::new())
            }

            $(#[$feed])*
            pub fn feed(&mut self, bytes: &[u8], mut on: impl FnMut(Result<$packet, $crate::error::Error>)) {
                self.0.feed::<$format>(bytes, &mut on);
            }

            /// Judges what is held as if no more were to come: for the end of a stream or a long pause.
            pub fn finish(&mut self, mut on: impl FnMut(Result<$packet, $crate::error::Error>)) {
                self.0.finish::<$format>(&mut on);
            }
        }
    };
}

pub(crate) use decoder;
