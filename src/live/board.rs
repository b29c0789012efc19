//! Where whoever runs something puts what happens, and from where it is taken ten times a second.

use super::batch::{Heard, Told};
use super::end::End;
use super::message::{Link, Notice, seconds};
use crate::listen;
use crate::sensor::{SensorKind, Setting};
use crate::session::{Event, LinkProgress, Progress};
use crate::time::SimTime;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Notices that wait to be taken, at most; the oldest go first.
const NOTICES: usize = 1000;
/// Attitudes and values that wait to be taken, at most: as many come in seconds of the fastest streams.
const WAITING: usize = 1 << 20;

/// What a run does now.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Phase {
    /// Somebody is waited for.
    #[default]
    Waiting,
    /// The vehicle is held still.
    Still,
    /// The scene plays.
    Playing,
    /// A stream is listened to.
    Listening,
}

impl Phase {
    /// As the page calls it.
    pub(super) fn name(self) -> &'static str {
        match self {
            Phase::Waiting => "waiting",
            Phase::Still => "still",
            Phase::Playing => "playing",
            Phase::Listening => "listening",
        }
    }
}

/// What has happened since it was taken last.
#[derive(Debug, Default)]
pub(super) struct Mail {
    pub phase: Phase,
    /// Scene time; `None` before the scene.
    pub t: Option<SimTime>,
    /// Stream time at which the scene began.
    pub starts: Option<SimTime>,
    pub waiting: Option<String>,
    pub told: Vec<Told>,
    pub notices: Vec<Notice>,
    pub links: Vec<Link>,
    pub settings: Vec<(usize, Setting)>,
    /// Sensors that are heard: their names and kinds.
    pub sensors: Vec<(String, SensorKind)>,
    pub values: Vec<Heard>,
    /// Each sensor's rate, where it is measured elsewhere, Hz.
    pub rates: Vec<f64>,
    pub end: Option<End>,
}

/// Where whoever runs something puts what happens. Nobody waits for anybody here: what is put is copied, under a lock
/// that is held for as long as that takes.
#[derive(Debug, Default)]
pub struct Board(Mutex<Mail>);

impl Board {
    fn mail(&self) -> MutexGuard<'_, Mail> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Takes what has happened; the present state stays.
    pub(super) fn take(&self) -> Mail {
        let mut mail = self.mail();
        let next = Mail {
            phase: mail.phase,
            t: mail.t,
            starts: mail.starts,
            waiting: mail.waiting.clone(),
            links: mail.links.clone(),
            sensors: mail.sensors.clone(),
            rates: mail.rates.clone(),
            ..Mail::default()
        };
        std::mem::replace(&mut *mail, next)
    }

    /// Puts an event of a run.
    pub fn put(&self, event: &Event<'_>) {
        let mut mail = self.mail();
        match event {
            Event::Notice(text) => notice(&mut mail, text.clone()),
            Event::Ready(name) => notice(&mut mail, format!("ready: {name}")),
            Event::Ground(place) => notice(&mut mail, format!("ground station: udp {place}")),
            Event::Waiting { whom, left } => {
                let left = left.as_secs_f64().ceil();
                mail.waiting = Some(format!("waiting for {whom}, {left:.0} s left"));
            }
            Event::Still => {
                mail.phase = Phase::Still;
                mail.waiting = Some("holding still until the other side is ready".into());
            }
            Event::Started => (mail.phase, mail.waiting) = (Phase::Playing, None),
            Event::Progress(progress) => now(&mut mail, progress),
            Event::Links(links) => mail.links = links.iter().map(link).collect(),
            Event::Estimates(of, told) => {
                let told = told.iter().map(|&(t, attitude)| Told { of: *of, t, attitude });
                mail.told.extend(told);
                let over = mail.told.len().saturating_sub(WAITING);
                mail.told.drain(..over);
            }
            Event::Set(change) => mail.settings.push((change.sensor, change.setting.clone())),
        }
    }

    /// Puts what is heard of a stream: `at` is since its first bytes.
    pub fn put_heard(&self, at: SimTime, progress: &listen::Progress<'_>) {
        let mut mail = self.mail();
        (mail.phase, mail.waiting, mail.t) = (Phase::Listening, None, Some(at));
        let streams = progress.meter.streams();
        mail.sensors = streams.iter().map(|stream| (stream.name().to_string(), stream.kind())).collect();
        mail.rates = progress.rates.to_vec();
        let counts = progress.meter.counts();
        mail.links = vec![Link {
            packets: counts.packets,
            bytes: counts.bytes,
            dropped: counts.lost,
            damaged: Some(counts.damaged),
            ..Link::default()
        }];
    }

    /// Puts values that were heard: which of the sensors, when since the first, and what it said. False where too many
    /// wait to be taken: the caller tries again soon, or they are left out.
    pub fn put_values(&self, values: impl Iterator<Item = (usize, SimTime, Vec<f64>)>) -> bool {
        let mut mail = self.mail();
        if mail.values.len() >= WAITING {
            return false;
        }
        mail.values.extend(values.map(|(of, t, values)| Heard { of, t, values }));
        true
    }

    /// Puts an attitude that was told.
    pub fn put_told(&self, told: impl Iterator<Item = Told>) {
        self.mail().told.extend(told);
    }

    /// Puts what is waited for.
    pub fn put_waiting(&self, whom: String) {
        self.mail().waiting = Some(whom);
    }

    /// Puts a notice.
    pub fn put_notice(&self, text: String) {
        notice(&mut self.mail(), text);
    }

    /// Puts what came of it all.
    pub(super) fn put_end(&self, end: End, until: Option<SimTime>) {
        let mut mail = self.mail();
        mail.waiting = None;
        mail.t = until.or(mail.t);
        mail.end = Some(end);
    }
}

fn notice(mail: &mut Mail, text: String) {
    let t = mail.t.map(seconds);
    mail.notices.push(Notice { t, text });
    let over = mail.notices.len().saturating_sub(NOTICES);
    mail.notices.drain(..over);
}

fn now(mail: &mut Mail, progress: &Progress) {
    if progress.still {
        mail.phase = Phase::Still;
        return;
    }
    (mail.phase, mail.waiting, mail.t) = (Phase::Playing, None, Some(progress.t));
    mail.starts = Some(progress.stream - progress.t);
}

fn link(progress: &LinkProgress) -> Link {
    Link {
        packets: progress.packets,
        bytes: progress.bytes,
        dropped: progress.dropped,
        queued: Some(progress.queued),
        received_bytes: Some(progress.received),
        damaged: progress.damaged,
    }
}
