//! A board: the main loop of a firmware around its UART, its driver and its estimator.

mod answer;
mod estimator;
mod port;

use std::io;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

pub use port::{Arrival, Device, Port, Source};

use crate::ahrs::Kind;
use crate::driver::{Counts, Driver, Protocol};
use crate::sample::Sample;
use answer::Answers;
pub(crate) use estimator::Estimator;

/// Bytes asked of the link at once.
const READ_LEN: usize = 4096;

/// How long [`Board::run`] waits for bytes before it looks at its stop flag.
const TURN: Duration = Duration::from_millis(20);

/// What a board is told before it starts: a firmware's parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// The estimator.
    pub ahrs: Kind,
    /// Declination of the field, rad, positive east: added to magnetic heading.
    pub declination_rad: f64,
    /// Sample time between answers, µs; `None` answers nothing.
    pub answer_every_us: Option<u64>,
    /// Baud rate to set on a serial port; `None` leaves it.
    pub baud: Option<u32>,
    /// How long [`Board::run`] goes on without data once data has come; `None` for ever.
    pub quiet: Option<Duration>,
}

impl Default for Options {
    /// VQF, magnetic north, no answers, one second of quiet.
    fn default() -> Self {
        Self {
            ahrs: Kind::default(),
            declination_rad: 0.0,
            answer_every_us: None,
            baud: None,
            quiet: Some(Duration::from_secs(1)),
        }
    }
}

/// What one turn of the loop brought.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Step {
    /// Bytes came, and with them so many samples (perhaps none).
    Data {
        /// Samples completed.
        samples: usize,
    },
    /// Nothing came in time.
    Idle,
    /// The other side is gone; nothing more will come.
    Closed,
}

/// What a board has seen and said.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Report {
    /// What has arrived.
    pub counts: Counts,
    /// Sample time of the first and the newest sample, µs.
    pub span_us: Option<(u64, u64)>,
    /// The newest attitude `w, x, y, z`, body (FRD) to nav (NED).
    pub attitude: Option<[f64; 4]>,
    /// Packets sent: attitudes and heartbeats.
    pub answers_sent: u64,
    /// Packets not sent because the link was full.
    pub answers_dropped: u64,
}

/// A firmware's board on a link.
pub struct Board {
    port: Box<dyn Port + Send>,
    driver: Box<dyn Driver + Send>,
    estimator: Estimator,
    answers: Option<Answers>,
    history: Vec<(u64, [f64; 4])>,
    attitude: Option<[f64; 4]>,
    span_us: Option<(u64, u64)>,
    quiet: Option<Duration>,
}

impl Board {
    /// Opens a serial port, a pty or a file as a firmware opens its UART.
    ///
    /// A terminal is made raw; nothing that waits in it is thrown away.
    ///
    /// # Errors
    /// Those of opening and of setting the terminal.
    pub fn open(path: impl AsRef<Path>, protocol: Protocol, options: Options) -> io::Result<Self> {
        let device = Device::open(path.as_ref(), options.baud)?;
        Ok(Self::over(Box::new(device), protocol, options))
    }

    /// A board on a link that is already there; `Source` makes one of any reader.
    pub fn over(port: Box<dyn Port + Send>, protocol: Protocol, options: Options) -> Self {
        let started = Instant::now();
        Self {
            port,
            driver: protocol.driver(),
            estimator: Estimator::new(options.ahrs, options.declination_rad),
            answers: options.answer_every_us.map(|every| Answers::new(protocol, every, started)),
            history: Vec::new(),
            attitude: None,
            span_us: None,
            quiet: options.quiet,
        }
    }

    /// The same board with another driver: for a chip mounted differently.
    pub fn with_driver(mut self, driver: Box<dyn Driver + Send>) -> Self {
        self.driver = driver;
        self
    }

    /// Waits up to `timeout` for bytes and takes them through driver and estimator.
    ///
    /// # Errors
    /// Those of the link; a link whose other side is gone is [`Step::Closed`].
    pub fn step(&mut self, timeout: Duration) -> io::Result<Step> {
        let mut bytes = [0; READ_LEN];
        match self.port.read(&mut bytes, timeout)? {
            Arrival::Bytes(len) => {
                let samples = self.receive(&bytes[..len])?;
                Ok(Step::Data { samples })
            }
            Arrival::Idle => Ok(Step::Idle),
            Arrival::Closed => {
                self.finish();
                Ok(Step::Closed)
            }
        }
    }

    /// Steps until the link closes, falls quiet after data came, or `stop` is set.
    ///
    /// # Errors
    /// Those of [`step`](Self::step).
    pub fn run(&mut self, stop: &AtomicBool) -> io::Result<Report> {
        let mut last_data = None;
        while !stop.load(Ordering::Relaxed) {
            match self.step(TURN)? {
                Step::Data { .. } => last_data = Some(Instant::now()),
                Step::Closed => break,
                Step::Idle if self.is_over(last_data) => break,
                Step::Idle => {}
            }
        }
        self.finish();
        Ok(self.report())
    }

    /// Attitudes after each gyro reading: sample time in µs and `w, x, y, z`, body to nav.
    pub fn history(&self) -> &[(u64, [f64; 4])] {
        &self.history
    }

    /// Takes the attitudes since the last call out of the board: for a board that runs for long.
    pub fn take_history(&mut self) -> Vec<(u64, [f64; 4])> {
        std::mem::take(&mut self.history)
    }

    /// What the board has seen and said.
    pub fn report(&self) -> Report {
        let (answers_sent, answers_dropped) = self.answers.as_ref().map_or((0, 0), Answers::counts);
        Report {
            counts: self.driver.counts(),
            span_us: self.span_us,
            attitude: self.attitude,
            answers_sent,
            answers_dropped,
        }
    }

    /// Puts what is still held back for measuring periods through the estimator.
    pub fn finish(&mut self) {
        self.estimator.settle(&mut self.history);
        self.attitude = self.history.last().map(|last| last.1).or(self.attitude);
    }

    /// Whether data came once and has stayed away for too long.
    fn is_over(&self, last_data: Option<Instant>) -> bool {
        match (last_data, self.quiet) {
            (Some(last), Some(quiet)) => last.elapsed() >= quiet,
            _ => false,
        }
    }

    /// Takes bytes through driver and estimator, and answers.
    fn receive(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let mut samples = Vec::new();
        self.driver.feed(bytes, &mut |sample| samples.push(sample));
        for sample in &samples {
            self.take(sample)?;
        }
        if let Some(answers) = &mut self.answers {
            answers.heartbeat(&mut *self.port)?;
        }
        Ok(samples.len())
    }

    /// Takes one sample.
    fn take(&mut self, sample: &Sample) -> io::Result<()> {
        let first = self.span_us.map_or(sample.t_us, |span| span.0);
        self.span_us = Some((first, sample.t_us));
        self.estimator.take(sample, &mut self.history);
        let Some(attitude) = self.estimator.attitude() else {
            return Ok(());
        };
        self.attitude = Some(attitude);
        if let Some(answers) = &mut self.answers {
            answers.attitude(&mut *self.port, sample, attitude)?;
        }
        Ok(())
    }
}
