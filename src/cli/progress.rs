//! Live progress on standard error, where that is a terminal.

use super::tell;
use crate::listen;
use crate::session::{Off, Progress};
use crate::time::SimTime;
use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::time::Duration;

/// A bar that moves with scene time.
pub struct Bar(ProgressBar);

const MILLIS: i64 = 1_000_000;

impl Bar {
    /// Up to `end`; invisible where standard error is no terminal.
    pub fn new(end: SimTime) -> Bar {
        let visible = std::io::stderr().is_terminal();
        let target = if visible { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
        let (length, template) = match end {
            SimTime::FOREVER => (None, "{spinner} {msg}"),
            end => (Some((end.0 / MILLIS).max(1) as u64), "{bar:30.cyan/blue} {percent:>3} %  {msg}"),
        };
        let style = ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar());
        Bar(ProgressBar::with_draw_target(length, target).with_style(style))
    }

    /// Of steps of which nobody knows how long they take.
    pub fn of_steps() -> Bar {
        let bar = Bar::new(SimTime::FOREVER);
        let style = ProgressStyle::with_template("{spinner} {msg} ({elapsed})");
        bar.0.set_style(style.unwrap_or_else(|_| ProgressStyle::default_spinner()));
        bar.0.enable_steady_tick(Duration::from_millis(100));
        bar
    }

    /// The step at hand.
    pub fn step(&self, what: String) {
        self.0.set_message(what);
    }

    /// Of a count of jobs, whose number is told with the first that is done.
    pub fn of_jobs(name: &'static str) -> Bar {
        let bar = Bar::new(SimTime(MILLIS));
        bar.0.set_message(name);
        bar
    }

    /// Of jobs.
    pub fn jobs(&self, done: usize, all: usize) {
        self.0.set_length(all as u64);
        self.0.set_position(done as u64);
    }

    /// Of a live run.
    pub fn live(&self, progress: &Progress) {
        let Progress { t, still, packets, dropped, error, .. } = progress;
        let error = error.map_or(String::new(), |off| {
            let Off { roll_deg, pitch_deg, heading_deg, .. } = off;
            format!(", off by roll {roll_deg:+.2}° pitch {pitch_deg:+.2}° heading {heading_deg:+.2}°")
        });
        if *still {
            self.0.set_message(format!("held still for {:.1} s, {packets} packets", t.seconds()));
            return;
        }
        let lost = if *dropped > 0 { format!(", {dropped} samples dropped") } else { String::new() };
        self.0.set_message(format!("{:.1} s, {packets} packets{lost}{error}", t.seconds()));
        self.0.set_position((t.0 / MILLIS) as u64);
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
        self.0.set_message(format!("{:.1} s, {what}{lost}", elapsed.as_secs_f64()));
        self.0.set_position(u64::try_from(elapsed.as_millis()).unwrap_or(u64::MAX));
    }

    /// Of a dataset.
    pub fn offline(&self, t: SimTime) {
        self.0.set_position((t.0 / MILLIS) as u64);
        self.0.set_message(format!("{:.1} s, {}", t.seconds(), self.pace(1e-3, "times real time")));
    }

    /// Of runs of a scene.
    pub fn runs(&self, done: usize, all: usize) {
        self.jobs(done, all);
        self.0.set_message(format!("{done} of {all} runs, {}", self.pace(1.0, "runs/s")));
    }

    /// How fast it moves on the whole, a position being so many of what is counted, and how long that leaves.
    fn pace(&self, each: f64, what: &str) -> String {
        let (elapsed, position) = (self.0.elapsed().as_secs_f64(), self.0.position() as f64);
        let rate = position / elapsed.max(1e-9);
        let left = (self.0.length().unwrap_or_default() as f64 - position).max(0.0) / rate.max(1e-9);
        format!("{:.1} {what}, {} left", rate * each, HumanDuration(Duration::from_secs_f64(left.min(1e9))))
    }

    /// A line above the bar.
    pub fn line(&self, text: &str) {
        self.0.suspend(|| tell(text));
    }

    /// Takes it off the screen.
    pub fn clear(&self) {
        self.0.finish_and_clear();
    }
}
