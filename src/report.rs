//! Results as data, tables and charts: they read what a run left behind and never reach into one.
//!
//! ```
//! use ratetable::report::Limit;
//!
//! let limit: Limit = "attitude.rms_deg<0.5".parse()?;
//! assert!(limit.broken(&serde_json::json!({ "attitude": { "rms_deg": 0.2 } })).is_none());
//! assert!(limit.broken(&serde_json::json!({ "attitude": { "rms_deg": 0.7 } })).is_some());
//! # Ok::<(), ratetable::report::LimitError>(())
//! ```

#[cfg(feature = "charts")]
pub mod chart;
mod heard;
mod limit;
mod scored;
mod table;
mod text;
mod times;
mod timing;

pub use heard::{HeardLink, HeardReport, HeardSensor};
pub use limit::{Limit, LimitError};
pub use scored::{ScoreReport, Scored};
pub use table::{table, table_within, wrap};
pub use text::{count, number};
pub use times::Times;
pub use timing::{Baseline, SensorTiming, TimingReport};

use crate::score::Figures;
use serde::Serialize;
use std::collections::BTreeMap;

/// A run's report, one JSON object.
#[derive(Clone, Debug, Default, Serialize)]
#[non_exhaustive]
pub struct Report {
    /// The program's version.
    pub version: String,
    /// Whether nothing was lost and every limit held.
    pub ok: bool,
    /// What did not hold: `sensors.gyro.late_us.p99 = 312 > 200`.
    pub failed: Vec<String>,
    /// The scene's name.
    pub scene: String,
    /// Its seed.
    pub seed: u64,
    /// Scene time played, s.
    pub duration_s: f64,
    /// For how long the vehicle was held still before the scene began, s: in the counts, and not in `duration_s`.
    pub rest_s: f64,
    /// For how long scene time stood still because a link was full (`overload = "stretch"`) or a controller in lockstep took its time, s.
    pub stretched_s: f64,
    /// Scene seconds a second, or `max`.
    pub speed: serde_json::Value,
    /// The faults that acted: `gyro stuck from 2 s to 3 s`, `mpu@pty drop from 2 s`.
    pub faults: Vec<String>,
    /// What it ran on.
    pub host: Host,
    /// Each sensor, counts summed over links.
    pub sensors: Vec<SensorReport>,
    /// Each link.
    pub links: Vec<LinkReport>,
    /// How well the other side knew its attitude, where it answered.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub attitude: Option<AttitudeReport>,
}

impl Report {
    /// Of a scene of which nothing has been played yet.
    pub fn new(scene: &str, seed: u64) -> Report {
        Report {
            version: env!("CARGO_PKG_VERSION").into(),
            ok: true,
            scene: scene.into(),
            seed,
            ..Report::default()
        }
    }
}

/// How well somebody knew the attitude.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AttitudeReport {
    /// Whose estimate it is.
    pub estimator: String,
    /// What it amounts to.
    #[serde(flatten)]
    pub figures: Figures,
}

/// What a run ran on.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Host {
    /// Name and release.
    pub kernel: String,
    /// Processors this process may use.
    pub cpus: usize,
    /// Whether the pacing thread had real-time priority.
    pub realtime: bool,
    /// Whether the process was locked in memory.
    pub memory_locked: bool,
    /// Which clock paced it.
    pub clock: &'static str,
    /// How the pacing thread waited; absent where nothing is paced.
    #[serde(flatten)]
    pub pacing: Option<PacingReport>,
}

impl Host {
    /// This machine, with so many processors for this process; nothing was paced on it.
    pub fn new(cpus: usize) -> Host {
        let name = rustix::system::uname();
        let kernel = format!("{} {}", name.sysname().to_string_lossy(), name.release().to_string_lossy());
        Host { kernel, cpus, clock: "CLOCK_MONOTONIC", ..Host::default() }
    }
}

/// How the pacing thread waited.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct PacingReport {
    /// Its margin for spinning at the end, as learnt from its own wake-ups, µs.
    pub spin_us: f64,
    /// Its share of a core while it streamed, writes included.
    pub pacing_cpu: f64,
    /// The processor it was bound to, where it was.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pinned_cpu: Option<usize>,
}

/// One sensor.
#[derive(Clone, Debug, Default, Serialize)]
pub struct SensorReport {
    /// `gyro`, `accel`, `mag`.
    pub name: String,
    /// Requested, Hz.
    pub rate_hz: f64,
    /// Delivered: (n − 1)/(t_last − t_first), Hz; absent where nothing is paced, as are lateness and intervals.
    pub sent_hz: Option<f64>,
    /// The same at the other end, where known, Hz.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub received_hz: Option<f64>,
    /// Samples made: `sent + dropped + queued`.
    pub made: u64,
    /// Samples whose packet the link took.
    pub sent: u64,
    /// Samples that a full or broken link, or a newer sample, cost.
    pub dropped: u64,
    /// Those of the dropped that a newer sample replaced because packets are fewer than samples.
    pub replaced: u64,
    /// Samples still on their way when the run was stopped.
    pub queued: u64,
    /// The moment just before the write call minus due, µs.
    pub late_us: Option<Late>,
    /// Between two packets of this sensor, µs.
    pub interval_us: Option<Interval>,
    /// What the write call itself took, µs.
    pub write_us: Option<Spread>,
    /// What `timing` adds.
    #[serde(flatten)]
    pub timing: Option<SensorTiming>,
}

impl SensorReport {
    /// With every field that a run can have, for limits to be checked against.
    pub fn shape(name: &str, rate_hz: f64) -> SensorReport {
        SensorReport {
            name: name.into(),
            rate_hz,
            received_hz: Some(0.0),
            late_us: Some(Late::default()),
            interval_us: Some(Interval::default()),
            write_us: Some(Spread::default()),
            ..SensorReport::default()
        }
    }
}

/// Lateness, µs.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct Late {
    /// Least.
    pub min: f64,
    /// Median.
    pub p50: f64,
    /// 99th percentile.
    pub p99: f64,
    /// 99.9th percentile.
    pub p99_9: f64,
    /// Greatest.
    pub max: f64,
}

/// Intervals, µs.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct Interval {
    /// Least.
    pub min: f64,
    /// Standard deviation.
    pub std: f64,
    /// Median.
    pub p50: f64,
    /// 99th percentile.
    pub p99: f64,
    /// 99.9th percentile.
    pub p99_9: f64,
    /// Greatest.
    pub max: f64,
}

/// Durations, µs.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct Spread {
    /// Median.
    pub p50: f64,
    /// 99th percentile.
    pub p99: f64,
    /// Greatest.
    pub max: f64,
}

/// One link.
#[derive(Clone, Debug, Default, Serialize)]
pub struct LinkReport {
    /// `PROTOCOL@LINK` as asked for.
    pub to: String,
    /// What one connects to.
    pub name: String,
    /// Packets made for it: `sent + dropped + queued`.
    pub made: u64,
    /// Packets it took.
    pub sent: u64,
    /// The same as `sent`.
    pub packets: u64,
    /// Their bytes.
    pub bytes: u64,
    /// Packets it did not take.
    pub dropped: u64,
    /// Packets still on their way to it when the run was stopped.
    pub queued: u64,
    /// What happens to a packet that it does not accept in time: `drop-newest`, `drop-oldest`, `stretch`.
    pub overload: String,
    /// The most bytes that it had taken and the other side had not, where the system tells, looked at every 20 ms.
    pub queue_bytes: Option<u64>,
    /// Bytes sent a second, first to last packet, against what the baud rate carries (8N1), where there is one.
    pub utilisation: Option<f64>,
    /// The speed of the UART whose time a pty took.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub paced_baud: Option<u32>,
    /// When the port was unplugged.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gaps: Option<Gaps>,
    /// Packets that it took beside the stream: answers to the other side, requests, a farewell.
    pub replies: u64,
    /// Packets that each kind of fault acted on, of those its output has; not among `dropped`.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub faults: BTreeMap<&'static str, u64>,
    /// The rates that the controller asked for while it was sent others, in order.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub asked: Vec<AskedRate>,
    /// Damaged answers.
    pub crc_errors: u64,
    /// Packets the other side missed by their sequence numbers, where it is known.
    pub lost_seq: Option<u64>,
    /// Why it takes nothing any more.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub broken: Option<String>,
}

impl LinkReport {
    /// With every field that a run can have, for limits to be checked against; it has these kinds of faults.
    pub fn shape(to: &str, overload: &str, faults: impl Iterator<Item = &'static str>) -> LinkReport {
        LinkReport {
            to: to.into(),
            name: to.into(),
            overload: overload.into(),
            queue_bytes: Some(0),
            gaps: Some(Gaps::default()),
            faults: faults.map(|kind| (kind, 0)).collect(),
            ..LinkReport::default()
        }
    }
}

/// A rate that a controller asked for while it was sent another: after a restart, say.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct AskedRate {
    /// Stream time from which packets were made at it, the rest before the scene included, s.
    pub at_s: f64,
    /// Packets a second.
    pub hz: f64,
}

/// A port that was unplugged while packets were sent.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct Gaps {
    /// How often.
    pub count: u64,
    /// For how long in all, from the first packet that it could not take to the next that it took, s.
    pub total_s: f64,
    /// Packets dropped meanwhile.
    pub dropped: u64,
    /// Samples in them.
    pub samples: u64,
}
