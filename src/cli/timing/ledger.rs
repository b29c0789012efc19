//! Both ends of a run side by side: what was sent when, what of it came when, line by line and in sums, in fixed
//! memory however long the run is.

use super::reader::Arrival;
use crate::report::Times;
use crate::scene::Plan;
use crate::sensor::SensorKind;
use crate::session::Record;
use crate::time::{Rate, SimTime};
use std::collections::VecDeque;
use std::fmt::Write;

/// The first line of `timing.csv`. Times are ns of one monotonic clock; `sent_ns` is empty for a sample that the link
/// did not take, `received_ns` for one that did not arrive. Lines of `baseline` are wake-ups of the bare timer.
pub const HEADING: &str = "sensor,k,due_ns,sent_ns,received_ns\n";
/// Samples of one sensor on their way, at most: an older one is missed.
const ON_THE_WAY: usize = 1 << 16;

/// A sample that was sent, or was not taken.
#[derive(Clone, Copy, Debug)]
struct Sent {
    t: SimTime,
    due: i64,
    sent: Option<i64>,
}

/// One sensor at both ends.
#[derive(Debug)]
pub struct Sensor {
    kind: SensorKind,
    rate: Rate,
    phase: SimTime,
    sent: VecDeque<Sent>,
    came: VecDeque<Arrival>,
    /// The last arrival: its slice and when.
    last: Option<(i64, i64)>,
    /// Intervals between arrivals within a slice, and their sum, ns.
    intervals: (u64, i64),
    /// Samples that arrived.
    pub received: u64,
    /// Samples that did not.
    pub missed: u64,
    /// Samples sent later than a whole period.
    pub overdue: u64,
    /// From sent to received.
    pub transit: Times,
}

impl Sensor {
    /// At the far end: (n − 1)/(t_last − t_first), summed over slices, Hz.
    pub fn received_hz(&self) -> Option<f64> {
        let (count, sum) = self.intervals;
        (sum > 0).then(|| count as f64 / (sum as f64 * 1e-9))
    }

    fn arrived(&mut self, sent: Sent, at: i64, slice: SimTime) {
        self.received += 1;
        if let Some(written) = sent.sent {
            self.transit.record(at - written);
        }
        // The first slice is half of one.
        let slice = (sent.t.0 + slice.0 / 2) / slice.0;
        if let Some((before, last)) = self.last.replace((slice, at))
            && before == slice
        {
            self.intervals.0 += 1;
            self.intervals.1 += at - last;
        }
    }
}

/// The greatest value in each of at most 1000 stretches of time, whose length doubles when they run out.
#[derive(Debug)]
pub struct Peaks {
    width: i64,
    first: i64,
    values: Vec<f64>,
}

impl Peaks {
    const MOST: usize = 1000;

    /// From `first` on, ns.
    pub fn new(first: i64) -> Peaks {
        Peaks { width: 10_000_000, first, values: Vec::with_capacity(Peaks::MOST) }
    }

    /// A value at a time, ns.
    pub fn add(&mut self, at: i64, value: f64) {
        while (at - self.first) / self.width >= Peaks::MOST as i64 {
            self.values =
                self.values.chunks(2).map(|pair| pair.iter().copied().fold(f64::NAN, f64::max)).collect();
            self.width *= 2;
        }
        let i = ((at - self.first) / self.width).max(0) as usize;
        if self.values.len() <= i {
            self.values.resize(i + 1, f64::NAN);
        }
        self.values[i] = self.values[i].max(value);
    }

    /// Seconds since the first, and the greatest value of each stretch; NaN where there was none.
    pub fn points(&self) -> (Vec<f64>, Vec<f64>) {
        let x = |i: usize| (i as f64 + 0.5) * self.width as f64 * 1e-9;
        ((0..self.values.len()).map(x).collect(), self.values.clone())
    }

    /// How long a stretch is, ms.
    pub fn width_ms(&self) -> f64 {
        self.width as f64 / 1e6
    }
}

/// The ledger of a run.
pub struct Ledger {
    /// In the plan's order.
    pub sensors: Vec<Sensor>,
    /// Lateness of the first sensor, µs, over time.
    pub stream: Peaks,
    /// That of the bare timer.
    pub bare: Peaks,
    /// Lateness of the first sensor.
    pub late: Times,
    /// Whether anybody receives.
    receives: bool,
    slice: SimTime,
    lines: String,
}

impl Ledger {
    /// For a plan streamed in slices; `now` is where its time axis begins.
    pub fn new(plan: &Plan, receives: bool, slice: SimTime, now: i64) -> Ledger {
        let sensor = |sensor: &crate::sensor::SensorPlan| Sensor {
            kind: sensor.kind,
            rate: sensor.rate,
            phase: sensor.phase,
            sent: VecDeque::new(),
            came: VecDeque::new(),
            last: None,
            intervals: (0, 0),
            received: 0,
            missed: 0,
            overdue: 0,
            transit: Times::new(),
        };
        Ledger {
            sensors: plan.sensors.iter().map(sensor).collect(),
            stream: Peaks::new(now),
            bare: Peaks::new(now),
            late: Times::new(),
            receives,
            slice,
            lines: String::new(),
        }
    }

    /// Takes a record of the pacing thread in.
    pub fn record(&mut self, record: Record) {
        match record {
            Record::Wake { k, due, woke } => {
                self.bare.add(woke, (woke - due) as f64 / 1000.0);
                self.line("baseline", k, due, Some(woke), None);
            }
            Record::Sample { kind, t, due, sent } => {
                let Some(i) = self.sensors.iter().position(|sensor| sensor.kind == kind) else { return };
                let period = (self.sensors[i].rate.period() * 1e9) as i64;
                self.sensors[i].overdue += u64::from(sent.is_some_and(|sent| sent - due > period));
                if let (0, Some(sent)) = (i, sent) {
                    self.late.record(sent - due);
                    self.stream.add(sent, (sent - due) as f64 / 1000.0);
                }
                let sample = Sent { t, due, sent };
                if self.receives {
                    self.sensors[i].sent.push_back(sample);
                } else {
                    self.sample(i, sample, None);
                }
            }
        }
    }

    /// Takes an arrival in.
    pub fn arrival(&mut self, arrival: Arrival) {
        if let Some(sensor) = self.sensors.iter_mut().find(|sensor| sensor.kind == arrival.kind) {
            sensor.came.push_back(arrival);
        }
    }

    /// Sets what came against what was sent, as far as both are known.
    pub fn settle(&mut self) {
        for i in 0..self.sensors.len() {
            while let (Some(&sent), Some(&came)) =
                (self.sensors[i].sent.front(), self.sensors[i].came.front())
            {
                self.compare(i, sent, came);
            }
            while self.sensors[i].sent.len() > ON_THE_WAY {
                self.miss(i);
            }
            let came = &mut self.sensors[i].came;
            came.drain(..came.len().saturating_sub(ON_THE_WAY));
        }
    }

    /// The oldest sample on its way and the oldest arrival: one is settled, or both as one. A packet says its time in
    /// whole µs, rounded down.
    fn compare(&mut self, i: usize, sent: Sent, came: Arrival) {
        let ahead = (sent.t - came.t).0;
        if ahead < 0 {
            return self.miss(i);
        }
        self.sensors[i].came.pop_front();
        // Else a value held over from the packet before.
        if ahead < 1000 {
            self.sensors[i].sent.pop_front();
            self.sensors[i].arrived(sent, came.at, self.slice);
            self.sample(i, sent, Some(came.at));
        }
    }

    /// Counts what is still on its way as missed: nothing more will come.
    pub fn end(&mut self) {
        self.settle();
        for i in 0..self.sensors.len() {
            while !self.sensors[i].sent.is_empty() {
                self.miss(i);
            }
        }
    }

    fn miss(&mut self, i: usize) {
        if let Some(sent) = self.sensors[i].sent.pop_front() {
            self.sample(i, sent, None);
        }
    }

    /// The lines since the last call.
    pub fn lines(&mut self) -> String {
        std::mem::take(&mut self.lines)
    }

    fn sample(&mut self, i: usize, sample: Sent, received: Option<i64>) {
        let sensor = &mut self.sensors[i];
        sensor.missed += u64::from(self.receives && received.is_none());
        // The newest tick that the packet can carry.
        let k = sensor.rate.ticks_before(sensor.phase, sample.t + SimTime(1)).saturating_sub(1);
        let name = sensor.kind.name();
        self.line(name, k, sample.due, sample.sent, received);
    }

    fn line(&mut self, name: &str, k: u64, due: i64, sent: Option<i64>, received: Option<i64>) {
        let cell = |t: Option<i64>| t.map_or(String::new(), |t| t.to_string());
        // Writing to a string cannot fail.
        let _ = writeln!(self.lines, "{name},{k},{due},{},{}", cell(sent), cell(received));
    }
}
