//! Live progress on standard error, where that is a terminal.

use super::tell;
use super::terminal::Stream;
use crate::geometry::{Axes, Euler};
use crate::listen;
use crate::session::{Event, Off, Progress};
use crate::time::SimTime;
use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// Time between two lines about a wait where nobody sees them change.
const PLAIN_BEAT: Duration = Duration::from_secs(10);
/// Columns for the bar beside a message, and for one line with the truth and the estimate.
const WIDE: usize = 80;

/// A bar that moves with scene time, where standard error is a terminal that can move it.
pub struct Bar {
    bar: ProgressBar,
    style: ProgressStyle,
    is_seen: bool,
    /// The axes in which attitudes are told.
    axes: Axes,
    /// Packets that wait.
    queued: AtomicU64,
    /// Who is waited for, and how much was left when that was told.
    waits: Mutex<Option<(String, Duration)>>,
}

const MILLIS: i64 = 1_000_000;

impl Bar {
    /// Up to `end`; invisible where standard error is no terminal, or one that cannot move its cursor.
    pub fn new(end: SimTime) -> Bar {
        Bar::styled(end, Bar::template(end, ""))
    }

    /// The same for a run, whose attitudes are told in these axes, on a line of their own.
    pub fn of_run(end: SimTime, axes: Axes) -> Bar {
        Bar { axes, ..Bar::styled(end, Bar::template(end, "\n{prefix}")) }
    }

    fn template(end: SimTime, more: &str) -> String {
        let bar = match (Stream::Err.width() < WIDE, is_plain()) {
            (true, _) => "{bar:12}",
            (false, true) => "{bar:30}",
            (false, false) => "{bar:30.cyan/blue}",
        };
        match end {
            SimTime::FOREVER => format!("{{spinner}} {{wide_msg}}{more}"),
            _ => format!("{bar} {{percent:>3}} %  {{wide_msg}}{more}"),
        }
    }

    fn styled(end: SimTime, template: String) -> Bar {
        let is_seen =
            std::io::stderr().is_terminal() && std::env::var_os("TERM").is_none_or(|it| it != "dumb");
        let target = if is_seen { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
        let length = (end < SimTime::FOREVER).then_some((end.0 / MILLIS).max(1) as u64);
        let style = styled(&template);
        Bar {
            bar: ProgressBar::with_draw_target(length, target).with_style(style.clone()),
            style,
            is_seen,
            axes: Axes::default(),
            queued: AtomicU64::default(),
            waits: Mutex::default(),
        }
    }

    /// Shows what every run can tell: notices, open links, waits, progress.
    pub fn event(&self, event: &Event<'_>) {
        match event {
            Event::Notice(notice) => self.line(&format!("notice: {notice}")),
            Event::Ready(name) => self.line(&format!("ready: {name}")),
            Event::Ground(place) => self.line(&format!("ground station: udp {place}")),
            Event::Waiting { whom, left } => self.waiting(whom, *left),
            Event::Links(links) => {
                self.queued.store(links.iter().map(|link| link.queued).sum(), Ordering::Relaxed)
            }
            Event::Progress(progress) => self.live(progress),
            _ => {}
        }
    }

    /// Somebody has to do something, within so long: a line that counts down, or where nobody sees that a line now and
    /// then.
    fn waiting(&self, whom: &str, left: Duration) {
        let seconds = left.as_secs_f64().ceil();
        let text = format!("waiting for {whom}, {seconds:.0} s left");
        let mut waits = self.waits.lock().unwrap_or_else(PoisonError::into_inner);
        if self.is_seen {
            if waits.replace((whom.to_string(), left)).is_none() {
                self.bar.set_style(styled("{wide_msg}"));
            }
            let fits = text.chars().count() < Stream::Err.width();
            // Of a long path the end may go, not the time.
            let cut = || format!("{seconds:.0} s left, waiting for {whom}");
            return self.bar.set_message(if fits { text } else { cut() });
        }
        let is_due =
            |(told, then): &(String, Duration)| told != whom || then.saturating_sub(left) >= PLAIN_BEAT;
        if waits.as_ref().is_none_or(is_due) {
            *waits = Some((whom.to_string(), left));
            self.line(&text);
        }
    }

    /// Of steps of which nobody knows how long they take.
    pub fn of_steps() -> Bar {
        let bar = Bar::new(SimTime::FOREVER);
        let style = ProgressStyle::with_template("{spinner} {msg} ({elapsed})");
        bar.bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_spinner()));
        bar.bar.enable_steady_tick(Duration::from_millis(100));
        bar
    }

    /// The step at hand.
    pub fn step(&self, what: String) {
        self.bar.set_message(what);
    }

    /// Of a count of jobs, whose number is told with the first that is done.
    pub fn of_jobs(name: &'static str) -> Bar {
        let bar = Bar::new(SimTime(MILLIS));
        bar.bar.set_message(name);
        bar
    }

    /// Of jobs.
    pub fn jobs(&self, done: usize, all: usize) {
        self.bar.set_length(all as u64);
        self.bar.set_position(done as u64);
    }

    /// Of a live run.
    fn live(&self, progress: &Progress) {
        let Progress { t, still, packets, dropped, estimate, .. } = progress;
        if self.waits.lock().unwrap_or_else(PoisonError::into_inner).take().is_some() {
            self.bar.set_style(self.style.clone());
        }
        self.bar.set_prefix(attitudes(progress, self.axes, Stream::Err.width()));
        if *still {
            let text = format!(
                "holding still until the other side is ready: {:.1} s, {packets} packets",
                t.seconds()
            );
            return self.bar.set_message(text);
        }
        let error = estimate.map_or(String::new(), |(_, off)| {
            let Off { roll_deg, pitch_deg, heading_deg, .. } = off;
            format!(", off by roll {roll_deg:+.2}° pitch {pitch_deg:+.2}° heading {heading_deg:+.2}°")
        });
        let some =
            |count: u64, what: &str| if count > 0 { format!(", {count} {what}") } else { String::new() };
        let (queued, lost) =
            (some(self.queued.load(Ordering::Relaxed), "queued"), some(*dropped, "samples dropped"));
        self.bar.set_message(format!("{:.1} s, {packets} packets{queued}{lost}{error}", t.seconds()));
        self.bar.set_position((t.0 / MILLIS) as u64);
    }

    /// Of a stream that is listened to.
    pub fn heard(&self, progress: &listen::Progress<'_>) {
        let listen::Progress { elapsed, meter, rates } = progress;
        let rate = |(stream, hz): (&listen::Stream, &f64)| format!("{} {hz:.1} Hz", stream.name());
        let rates: Vec<_> = meter.streams().iter().zip(*rates).map(rate).collect();
        let counts = meter.counts();
        let lost = match (counts.lost, counts.damaged) {
            (0, 0) => String::new(),
            (lost, damaged) => format!(", {lost} lost, {damaged} damaged"),
        };
        let what = if rates.is_empty() { format!("{} bytes", counts.bytes) } else { rates.join(", ") };
        self.bar.set_message(format!("{:.1} s, {what}{lost}", elapsed.as_secs_f64()));
        self.bar.set_position(u64::try_from(elapsed.as_millis()).unwrap_or(u64::MAX));
    }

    /// Of a dataset.
    pub fn offline(&self, t: SimTime) {
        self.bar.set_position((t.0 / MILLIS) as u64);
        self.bar.set_message(format!("{:.1} s, {}", t.seconds(), self.pace(1e-3, "times real time")));
    }

    /// Of runs of a scene.
    pub fn runs(&self, done: usize, all: usize) {
        self.jobs(done, all);
        self.bar.set_message(format!("{done} of {all} runs, {}", self.pace(1.0, "runs/s")));
    }

    /// How fast it moves on the whole, a position being so many of what is counted, and how long that leaves.
    fn pace(&self, each: f64, what: &str) -> String {
        let (elapsed, position) = (self.bar.elapsed().as_secs_f64(), self.bar.position() as f64);
        let rate = position / elapsed.max(1e-9);
        let left = (self.bar.length().unwrap_or_default() as f64 - position).max(0.0) / rate.max(1e-9);
        format!("{:.1} {what}, {} left", rate * each, HumanDuration(Duration::from_secs_f64(left.min(1e9))))
    }

    /// A line above the bar.
    pub fn line(&self, text: &str) {
        self.bar.suspend(|| tell(text));
    }

    /// Takes it off the screen.
    pub fn clear(&self) {
        self.bar.finish_and_clear();
    }
}

fn styled(template: &str) -> ProgressStyle {
    ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar())
}

/// Roll, pitch and yaw of the truth, and of the estimate where it fits.
fn attitudes(progress: &Progress, axes: Axes, width: usize) -> String {
    let angles = |attitude| {
        let Euler { roll, pitch, yaw } = Euler::from_quat(axes.attitude_out(attitude));
        let [roll, pitch, yaw] = [roll, pitch, yaw].map(f64::to_degrees);
        format!("{roll:+6.1}° {pitch:+5.1}° {yaw:+6.1}°")
    };
    let truth = format!("roll, pitch, yaw: true {}", angles(progress.truth));
    let both = progress.estimate.map(|(attitude, _)| format!("{truth}  estimated {}", angles(attitude)));
    both.filter(|both| both.chars().count() < width).unwrap_or(truth)
}

/// Whether the user wants no colours.
fn is_plain() -> bool {
    std::env::var_os("NO_COLOR").is_some_and(|it| !it.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Attitude;

    #[test]
    fn the_estimate_is_told_where_there_is_room() {
        let off = Off { total_deg: 0.0, roll_deg: 0.0, pitch_deg: 0.0, heading_deg: 0.0 };
        let progress = Progress {
            t: SimTime::ZERO,
            stream: SimTime::ZERO,
            still: false,
            packets: 0,
            dropped: 0,
            truth: Attitude::from_quat(Euler { roll: -3.0, pitch: -1.5, yaw: -3.0 }.to_quat()),
            estimate: Some((Attitude::IDENTITY, off)),
        };
        for (width, estimated) in [(60, false), (80, true), (120, true)] {
            let text = attitudes(&progress, Axes::NedFrd, width);
            assert!(text.chars().count() < width, "{text}");
            assert_eq!(text.contains("estimated"), estimated, "{text}");
            assert!(text.contains(" -171.9° -85.9° -171.9°"), "{text}");
        }
    }
}
