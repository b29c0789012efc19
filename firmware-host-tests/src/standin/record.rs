//! What a stand-in has seen, said and estimated.

use std::fmt;

/// Its own estimate after a gyro reading.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moment {
    /// Time of the sample as the firmware has it (its arrival, except in lockstep), µs of its own clock.
    pub t_us: u64,
    /// The sender's time of the sample, µs, where packets carry one: for judging, the firmware does not use it.
    pub said_us: Option<u64>,
    /// The attitude `w, x, y, z`: body (FRD) to nav (NED).
    pub attitude: [f64; 4],
}

/// Everything that a stand-in can tell of its run.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Record {
    /// Its own estimates, in order.
    pub history: Vec<Moment>,
    /// What came and went.
    pub counts: Counts,
}

/// What came and went.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Counts {
    /// Whole packets of any kind.
    pub packets: u64,
    /// Stretches of bytes that were no packet, or one with a wrong checksum.
    pub damaged: u64,
    /// Packets missing by the numbers of their senders.
    pub lost: u64,
    /// Packets of samples that were used.
    pub samples: u64,
    /// Packets of samples that came and were not used: it does not hear, or not yet.
    pub refused: u64,
    /// Readings left because the sensor has said the same too often.
    pub stale: u64,
    /// Silences after which the sensors counted as lost.
    pub timeouts: u64,
    /// Bytes that found no room.
    pub overflowed: u64,
    /// Attitudes of the sender's that came, and were not used.
    pub foreign: u64,
    /// Attitudes it told.
    pub told: u64,
    /// Answers to samples, one each.
    pub answered: u64,
    /// Questions it asked: commands of a handshake with their resends, comparisons of clocks.
    pub asked: u64,
    /// Answers it got to them.
    pub answers: u64,
    /// Times that it gave a handshake up and began again.
    pub restarts: u64,
}

impl fmt::Display for Counts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { packets, damaged, lost, samples, refused, stale, timeouts, .. } = self;
        let Self { overflowed, foreign, told, answered, asked, answers, restarts, .. } = self;
        write!(
            f,
            "{packets} packets, {damaged} damaged, {lost} lost, {overflowed} bytes overflowed; samples: {samples} used, \
             {refused} refused, {stale} stale readings, {timeouts} timeouts; attitudes: {told} told, {foreign} of \
             others ignored; {answered} samples answered; {asked} questions, {answers} answers"
        )?;
        if *restarts > 0 { write!(f, ", {restarts} handshakes begun again") } else { Ok(()) }
    }
}
