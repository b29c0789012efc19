//! What to run.

use super::heard::Judging;
use super::pace::Speed;
use super::watch::Watch;
use crate::link::Address;
use crate::scene::{Output, Plan};
use crate::time::SimTime;
use std::sync::Arc;
use std::time::Duration;

/// What to run.
#[derive(Debug)]
pub struct Job {
    /// The scene.
    pub plan: Arc<Plan>,
    /// Where to: at least one.
    pub outputs: Vec<Output>,
    /// Scene time at which it ends.
    pub end: SimTime,
    /// How long the vehicle is held still before the scene at the least, and then until every other side is ready;
    /// `None` begins with the scene.
    pub rest: Option<SimTime>,
    /// A ground station, and which of the outputs has the controller that it is to talk to.
    pub ground: Option<(Address, usize)>,
    /// How fast scene time goes.
    pub speed: Speed,
    /// How long to wait for somebody on the other side; zero starts at once.
    pub wait: Duration,
    /// A program to start when the links are ready, with its arguments.
    pub command: Vec<String>,
    /// Whether standard output is ours alone: the command's then goes to standard error.
    pub keep_stdout: bool,
    /// How what the other side estimates is judged.
    pub judging: Judging,
    /// The processor that the pacing thread is to keep to.
    pub cpu: Option<usize>,
    /// A comparison with a bare timer, on the pacing thread.
    pub watch: Option<Watch>,
    /// Who takes in what comes back on the first link, in place of the score: a loopback plug returns the packets.
    pub tap: Option<Tap>,
}

/// Called with bytes as they arrive.
pub type OnBytes = dyn FnMut(&[u8]);

/// Takes in what a link receives.
pub struct Tap(pub Box<OnBytes>);

impl std::fmt::Debug for Tap {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Tap")
    }
}
