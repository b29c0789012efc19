//! Reads a link into the meter until the sender leaves, the time is over or the user stops it.

use super::asking::Asking;
use super::{Event, Heard, Job, ListenError, Meter, Progress};
use crate::clock::{Clock, WallClock};
use crate::interrupt::Interrupt;
use crate::link::{Address, Link, LinkError, Receiver, Sender};
use crate::time::SimTime;
use crate::wire::Protocol;
use bytes::BytesMut;
use std::time::Duration;
use tokio::time::{Instant, MissedTickBehavior, interval, sleep_until};

/// Time between two progress reports.
const PROGRESS: Duration = Duration::from_millis(200);
/// Time between two greetings, and the window of the displayed rates.
const SECOND: Duration = Duration::from_secs(1);
/// Time between two looks at what to ask for.
const QUESTIONS: Duration = Duration::from_millis(10);

/// Listens to a link and reports events to `on`.
///
/// # Errors
/// A link that does not open, no byte or no packet in time, a system without signals.
pub fn listen(job: &Job, on: &mut dyn FnMut(Event<'_>)) -> Result<Heard, ListenError> {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
    let runtime =
        runtime.map_err(|source| ListenError::System { doing: "start the listening loop", source })?;
    runtime.block_on(async {
        let signals = Interrupt::listen();
        let mut signals =
            signals.map_err(|source| ListenError::System { doing: "listen for Ctrl-C", source })?;
        let mut link = Link::listen(&job.address).await?;
        link.notices().iter().for_each(|notice| on(Event::Notice(notice.clone())));
        let name = link.name().to_string();
        on(Event::Ready(&format!("{}@{name}", job.protocol.name())));
        let live = link.is_live();
        let Some(receiver) = link.receiver() else {
            return Err(ListenError::Mute {
                link: name,
                right: "listen to a port, a pty, a socket or a file",
            });
        };
        // A UDP sender that waits for a first datagram gets a greeting, and so does a controller that is asked for its
        // attitude. Nothing is sent to others.
        let greeted = matches!(job.address, Address::UdpOut(_)) && !job.attitude;
        let greeted = greeted.then(|| link.sender());
        let asking = job.attitude.then(|| Asking::new(job.protocol, link.sender())).flatten();
        let mut meter = if live { Meter::new(job.protocol) } else { Meter::recorded(job.protocol) };
        if job.values {
            meter.keep_values();
        }
        let clock = WallClock::start();
        let ear = Ear { job, name, live, link, receiver, greeted, asking, meter, clock };
        ear.hear(&mut signals, on).await
    })
}

struct Ear<'a> {
    job: &'a Job,
    name: String,
    live: bool,
    link: Link,
    receiver: Receiver,
    greeted: Option<Sender>,
    asking: Option<Asking>,
    meter: Meter,
    clock: WallClock,
}

impl Ear<'_> {
    async fn hear(
        mut self,
        signals: &mut Interrupt,
        on: &mut dyn FnMut(Event<'_>),
    ) -> Result<Heard, ListenError> {
        let start = Instant::now();
        let (mut first, mut came, mut interrupted) = (None, None, false);
        let mut ticks = interval(PROGRESS);
        ticks.set_missed_tick_behavior(MissedTickBehavior::Delay);
        let mut greetings = interval(SECOND);
        let mut questions = interval(QUESTIONS);
        let (mut greeting, mut recent, mut bytes, mut told) = (0u8, Recent::default(), 0, 0);
        let mut buffer = BytesMut::with_capacity(65_536);
        loop {
            let end = first.zip(self.job.span).map(|(first, span): (Instant, Duration)| first + span);
            tokio::select! {
                count = self.receiver.recv(&mut buffer) => {
                    let now = self.clock.now();
                    if count.map_err(|source| self.broke(source))? == 0 {
                        break;
                    }
                    first.get_or_insert_with(Instant::now);
                    self.meter.arrived(&buffer, self.live.then_some(now));
                    let came = *came.get_or_insert(now);
                    self.pass_on(now - came, on);
                    let notices = self.asking.as_mut().map(|asking| asking.hear(&buffer, now));
                    notices.into_iter().flatten().for_each(|notice| on(Event::Notice(notice)));
                    buffer.clear();
                }
                _ = ticks.tick() => {
                    self.give_up(start.elapsed())?;
                    if self.is_over(&mut bytes) {
                        break;
                    }
                    recent.look(&self.meter);
                    let elapsed = first.map_or(Duration::ZERO, |first: Instant| first.elapsed());
                    on(Event::Progress(Progress { elapsed, meter: &self.meter, rates: &recent.rates }));
                    if let Some(new) = self.asking.as_ref().map(|asking| &asking.told()[told..]) {
                        on(Event::Told(new));
                        told += new.len();
                    }
                }
                _ = greetings.tick(), if self.greeted.is_some() || self.asking.is_some() => {
                    self.greet(greeting);
                    greeting = greeting.wrapping_add(1);
                }
                _ = questions.tick(), if self.asking.is_some() => {
                    let now = self.clock.now();
                    let notices = self.asking.as_mut().map(|asking| asking.tick(now));
                    notices.into_iter().flatten().for_each(|notice| on(Event::Notice(notice)));
                }
                () = signals.recv() => {
                    interrupted = true;
                    break;
                }
                () = until(end) => break,
            }
        }
        self.meter.finish();
        let elapsed = first.map_or(Duration::ZERO, |first: Instant| first.elapsed());
        on(Event::Progress(Progress { elapsed, meter: &self.meter, rates: &recent.rates }));
        if !self.live {
            on(Event::Notice(recording(&self.meter).into()));
        }
        if self.meter.counts().packets == 0 && !interrupted {
            return Err(self.nothing(None));
        }
        let told = self.asking.map_or(Vec::new(), Asking::into_told);
        Ok(Heard { name: self.name, interrupted, meter: self.meter, told })
    }

    /// Passes on what the samples of a read said, which came so many ns after the first.
    fn pass_on(&mut self, since: i64, on: &mut dyn FnMut(Event<'_>)) {
        let values = self.meter.take_values();
        if !values.is_empty() {
            on(Event::Values(self.live.then_some(SimTime(since)), &values));
        }
    }

    /// Whether the writer of our pty has left and everything is read; the end that we hold does not show it.
    fn is_over(&self, before: &mut u64) -> bool {
        let bytes = self.meter.counts().bytes;
        let idle = std::mem::replace(before, bytes) == bytes && bytes > 0;
        idle && self.link.peer_has_left()
    }

    fn greet(&mut self, seq: u8) {
        let greeting = self.job.protocol.greeting(seq);
        if let Some(sender) = &mut self.greeted {
            // If it is lost, the next one follows.
            let _ = sender.send(&greeting);
        }
        if let Some(asking) = &mut self.asking {
            asking.greet(&greeting);
        }
    }

    /// Ends a wait without a packet after the timeout.
    fn give_up(&self, waited: Duration) -> Result<(), ListenError> {
        let waits = self.job.wait.is_zero() || waited < self.job.wait || self.meter.counts().packets > 0;
        if waits { Ok(()) } else { Err(self.nothing(Some(self.job.wait))) }
    }

    /// The reason for the missing packet.
    fn nothing(&self, waited: Option<Duration>) -> ListenError {
        let (link, bytes, protocol) = (self.name.clone(), self.meter.counts().bytes, self.job.protocol);
        match bytes {
            0 => ListenError::Silence { link, waited, check: check(&self.job.address) },
            _ => ListenError::Noise { link, bytes, protocol, reads_as: self.reads_as(protocol) },
        }
    }

    fn reads_as(&self, protocol: Protocol) -> Option<Protocol> {
        self.meter.reads_as().filter(|other| *other != protocol)
    }

    fn broke(&self, source: std::io::Error) -> ListenError {
        LinkError::Io { link: self.name.clone(), doing: "read".into(), source }.into()
    }
}

/// The meaning of the times in a recording.
fn recording(meter: &Meter) -> &'static str {
    match meter.counts().stamps {
        Some(_) => "a .tlog: the stamps in front of its packets are taken for the times of arrival",
        None => "a recording: its bytes have no times of arrival, so rates are by sample times",
    }
}

async fn until(end: Option<Instant>) {
    match end {
        Some(end) => sleep_until(end).await,
        None => std::future::pending().await,
    }
}

/// What to check when a link stays silent.
fn check(address: &Address) -> &'static str {
    match address {
        Address::Serial { .. } => {
            "is the sender on, its TX wired to our RX with a common ground, and the baud rate its own?"
        }
        Address::Pty { .. } => "does the sender write into the path above?",
        Address::TcpIn(_) => "does the sender connect to this address and port?",
        Address::TcpOut(_) => {
            "the sender took the connection and said nothing; does it wait for a word first?"
        }
        Address::UdpIn(_) => {
            "does the sender send to this port, and from this machine (else listen on udpin:0.0.0.0:PORT)?"
        }
        Address::UdpOut(_) => {
            "the sender was greeted once a second; is the port right, or does it send to udpin:PORT?"
        }
        Address::File { .. } | Address::Stdout => "it is empty",
    }
}

/// Samples a second of each stream over the last whole second.
#[derive(Default)]
struct Recent {
    since: Option<Instant>,
    counts: Vec<u64>,
    rates: Vec<f64>,
}

impl Recent {
    fn look(&mut self, meter: &Meter) {
        let now = Instant::now();
        let seconds = self.since.map_or(f64::INFINITY, |since| (now - since).as_secs_f64());
        if seconds < SECOND.as_secs_f64() {
            return;
        }
        let counts: Vec<u64> = meter.streams().iter().map(|stream| stream.count()).collect();
        let before = self.counts.iter().copied().chain(std::iter::repeat(0));
        self.rates = counts.iter().zip(before).map(|(now, before)| (now - before) as f64 / seconds).collect();
        (self.since, self.counts) = (Some(now), counts);
    }
}
