//! When bytes arrive, by a firmware's own clock.

use std::time::Instant;

use ratetable_protocols::{betaflight, ilabs, mavlink, mip, msp, sbg, vectornav};

/// How a link's packets are told apart, by who only counts packets of samples.
pub enum Framing {
    /// `HIL_SENSOR` in MAVLink.
    Mavlink(Box<mavlink::Decoder>),
    /// INAV's simulator message.
    Msp(Box<msp::Decoder>),
    /// A VN-100's packets with gyro and accelerometer.
    Vectornav(Box<vectornav::Decoder>),
    /// A MicroStrain unit's packets.
    Mip(Box<mip::Decoder>),
    /// An Inertial Labs unit's frames.
    Ilabs(Box<ilabs::Decoder>),
    /// An SBG Systems unit's IMU_SHORT.
    Sbg(Box<sbg::Decoder>),
    /// What Betaflight's SITL takes from a simulator.
    Betaflight(Box<betaflight::Decoder>),
}

impl Framing {
    /// Whether this byte is the last of a packet of samples.
    fn completes(&mut self, byte: u8) -> bool {
        let mut whole = false;
        let bytes = [byte];
        match self {
            Self::Mavlink(decoder) => decoder.feed(&bytes, |received| {
                whole |= received.is_ok_and(|received| received.id == mavlink::hil_sensor::ID);
            }),
            Self::Msp(decoder) => decoder.feed(&bytes, |received| {
                whole |= received.is_ok_and(|received| received.command == msp::simulator::COMMAND);
            }),
            Self::Vectornav(decoder) => decoder.feed(&bytes, |received| {
                whole |= matches!(received, Ok(vectornav::Packet::Imu(_) | vectornav::Packet::Inertial(_)));
            }),
            Self::Mip(decoder) => decoder.feed(&bytes, |received| whole |= received.is_ok()),
            Self::Ilabs(decoder) => decoder.feed(&bytes, |received| whole |= received.is_ok()),
            Self::Sbg(decoder) => decoder.feed(&bytes, |received| {
                whole |= received.is_ok_and(|received| received.id == sbg::imu_short::ID);
            }),
            Self::Betaflight(decoder) => decoder.feed(&bytes, |received| whole |= received.is_ok()),
        }
        whole
    }
}

/// What a firmware takes for time, µs from its boot.
pub enum Clock {
    /// Time as it passes, so many times as fast.
    Wall {
        /// The boot.
        since: Instant,
        /// Firmware seconds a second: for a stream that is played at `--speed` so many times.
        scale: f64,
    },
    /// The clock beside a link that delivers samples perfectly evenly: each packet of samples arrives `period_us`
    /// after the one before, however long that takes. Until the first one comes time passes.
    ///
    /// With it a firmware that stamps samples on arrival can be fed as fast as it reads, and no result depends on how
    /// busy the machine is.
    Even {
        /// Between packets of samples, µs.
        period_us: u64,
        /// What a packet of samples looks like.
        framing: Framing,
        /// The boot; `None` once samples have come.
        booted: Option<Instant>,
        /// The time now, µs.
        now_us: u64,
    },
}

impl Clock {
    /// Time as it passes, `scale` times as fast.
    pub fn wall(scale: f64) -> Self {
        Self::Wall { since: Instant::now(), scale }
    }

    /// The clock of a link with packets of samples every `period_us`.
    pub fn even(period_us: u64, framing: Framing) -> Self {
        Self::Even { period_us, framing, booted: Some(Instant::now()), now_us: 0 }
    }

    /// The time now.
    pub fn now_us(&self) -> u64 {
        match self {
            Self::Wall { since, scale } => (since.elapsed().as_secs_f64() * scale * 1e6) as u64,
            Self::Even { now_us, .. } => *now_us,
        }
    }

    /// Nothing came for a while.
    pub(super) fn idle(&mut self) {
        if let Self::Even { booted: Some(booted), now_us, .. } = self {
            *now_us = booted.elapsed().as_micros() as u64;
        }
    }

    /// When what was held until a later turn has certainly been done.
    pub(super) fn after_the_last(&self) -> u64 {
        match self {
            Self::Wall { .. } => self.now_us(),
            Self::Even { now_us, period_us, .. } => now_us + period_us,
        }
    }

    /// The bytes in pieces, each with its time of arrival.
    pub(super) fn times<'b>(&mut self, bytes: &'b [u8]) -> Vec<(&'b [u8], u64)> {
        let Self::Even { period_us, framing, booted, now_us } = self else {
            return vec![(bytes, self.now_us())];
        };
        let (mut pieces, mut from) = (Vec::new(), 0);
        for (i, &byte) in bytes.iter().enumerate() {
            if framing.completes(byte) {
                if booted.take().is_none() {
                    *now_us += *period_us;
                }
                pieces.push((&bytes[from..=i], *now_us));
                from = i + 1;
            }
        }
        if from < bytes.len() {
            pieces.push((&bytes[from..], *now_us));
        }
        pieces
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_even_link_delivers_each_packet_a_period_after_the_one_before_however_it_is_cut() {
        let mut packet = [0; mip::MAX_LEN];
        let imu = mip::imu::Repr { gyro: Some([0.1, 0.2, 0.3]), ..Default::default() };
        let len = mip::encode(&imu, &mut packet).unwrap();
        let stream = packet[..len].repeat(10);
        for cut in [1, 7, len, 3 * len, stream.len()] {
            let mut clock = Clock::even(4000, Framing::Mip(Box::default()));
            let mut ends = Vec::new();
            let (mut count, start) = (0, clock.now_us());
            for piece in stream.chunks(cut) {
                for (bytes, now_us) in clock.times(piece) {
                    count += bytes.len();
                    if count % len == 0 {
                        ends.push(now_us - start);
                    }
                }
            }
            assert_eq!(ends, (0..10).map(|k| k * 4000).collect::<Vec<_>>(), "cut at {cut}");
        }
    }
}
