//! Results as data, tables and charts: this room reads what a run has produced and never affects it.
//!
//! ```
//! use ratetable::report::Limit;
//!
//! let limit: Limit = "attitude.rms_deg<0.5".parse()?;
//! assert!(limit.broken(&serde_json::json!({ "attitude": { "rms_deg": 0.2 } })).is_none());
//! assert!(limit.broken(&serde_json::json!({ "attitude": { "rms_deg": 0.7 } })).is_some());
//! # Ok::<(), ratetable::report::LimitError>(())
//! ```

mod answers;
mod bus;
#[cfg(feature = "charts")]
pub mod chart;
mod heard;
mod limit;
mod scored;
mod table;
mod text;
mod times;
mod timing;

pub use answers::AnswersReport;
pub use bus::{BusReport, ReadReport};
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
    /// The limits and conditions that failed: `sensors.gyro.late_us.p99 = 312 > 200`.
    pub failed: Vec<String>,
    /// The scene's name.
    pub scene: String,
    /// Its seed.
    pub seed: u64,
    /// Scene time played, s.
    pub duration_s: f64,
    /// How long the vehicle was held still before the scene began, s: included in the counts, not in `duration_s`.
    pub rest_s: f64,
    /// How long scene time stood still for a full link (`overload = "stretch"`) or a controller in lockstep, s.
    pub stretched_s: f64,
    /// Scene seconds a second, or `max`.
    pub speed: serde_json::Value,
    /// The faults that acted: `gyro stuck from 2 s to 3 s`, `mpu@pty drop from 2 s`.
    pub faults: Vec<String>,
    /// What a driver set sensors to: `0 s gyro: 200 Hz, ±500 deg/s, low-pass 41 Hz`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub settings: Vec<String>,
    /// The machine.
    pub host: Host,
    /// Each sensor, counts summed over links.
    pub sensors: Vec<SensorReport>,
    /// Each link.
    pub links: Vec<LinkReport>,
    /// How well the other side knew its attitude, if it sent estimates.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub attitude: Option<AttitudeReport>,
}

impl Report {
    /// The report of a scene that has not played yet.
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

/// How well an estimator knew the attitude.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AttitudeReport {
    /// The name of the estimator.
    pub estimator: String,
    /// The error figures.
    #[serde(flatten)]
    pub figures: Figures,
}

/// The machine of a run.
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
    /// The clock that paced it.
    pub clock: &'static str,
    /// How the pacing thread waited; absent if nothing was paced.
    #[serde(flatten)]
    pub pacing: Option<PacingReport>,
}

impl Host {
    /// This machine, with this many processors for the process, without pacing.
    pub fn new(cpus: usize) -> Host {
        let name = rustix::system::uname();
        let kernel = format!("{} {}", name.sysname().to_string_lossy(), name.release().to_string_lossy());
        Host { kernel, cpus, clock: "CLOCK_MONOTONIC", ..Host::default() }
    }
}

/// How the pacing thread waited.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct PacingReport {
    /// Its spin margin, learnt from its own wake-ups, µs.
    pub spin_us: f64,
    /// Its share of a core while streaming, writes included.
    pub pacing_cpu: f64,
    /// The processor it was bound to, if any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pinned_cpu: Option<usize>,
}

/// One sensor.
#[derive(Clone, Debug, Default, Serialize)]
pub struct SensorReport {
    /// `gyro`, `accel`, `mag`.
    pub name: String,
    /// Requested rate, Hz.
    pub rate_hz: f64,
    /// Delivered rate: (n − 1)/(t_last − t_first), Hz. If nothing is paced, this, lateness and intervals are
    /// absent.
    pub sent_hz: Option<f64>,
    /// The same at the other end, if known, Hz.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub received_hz: Option<f64>,
    /// Samples made: `sent + dropped + queued`.
    pub made: u64,
    /// Samples in packets that the link took.
    pub sent: u64,
    /// Samples lost to a full or broken link, or to a newer sample.
    pub dropped: u64,
    /// Dropped samples that a newer one replaced, because packets are fewer than samples.
    pub replaced: u64,
    /// Those of the sent that are in a packet as part of a mean, because packets are fewer than samples.
    pub merged: u64,
    /// Samples still on their way when the run was stopped.
    pub queued: u64,
    /// Time just before the write call minus the due time, µs.
    pub late_us: Option<Late>,
    /// Between two packets of this sensor, µs.
    pub interval_us: Option<Interval>,
    /// Duration of the write call itself, µs.
    pub write_us: Option<Spread>,
    /// How a driver read it, on a bus.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub read: Option<ReadReport>,
    /// The additional figures of `timing`.
    #[serde(flatten)]
    pub timing: Option<SensorTiming>,
}

impl SensorReport {
    /// A report with every possible field, to check limits against.
    pub fn shape(name: &str, rate_hz: f64) -> SensorReport {
        SensorReport {
            name: name.into(),
            rate_hz,
            received_hz: Some(0.0),
            late_us: Some(Late::default()),
            interval_us: Some(Interval::default()),
            write_us: Some(Spread::default()),
            read: Some(ReadReport { hz: Some(0.0), ..ReadReport::default() }),
            ..SensorReport::default()
        }
    }
}

/// Lateness, µs.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct Late {
    /// Minimum.
    pub min: f64,
    /// Median.
    pub p50: f64,
    /// 99th percentile.
    pub p99: f64,
    /// 99.9th percentile.
    pub p99_9: f64,
    /// Maximum.
    pub max: f64,
}

/// Intervals, µs.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct Interval {
    /// Minimum.
    pub min: f64,
    /// Standard deviation.
    pub std: f64,
    /// Median.
    pub p50: f64,
    /// 99th percentile.
    pub p99: f64,
    /// 99.9th percentile.
    pub p99_9: f64,
    /// Maximum.
    pub max: f64,
}

/// Durations, µs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Spread {
    /// Median.
    pub p50: f64,
    /// 99th percentile.
    pub p99: f64,
    /// Maximum.
    pub max: f64,
}

/// One link.
#[derive(Clone, Debug, Default, Serialize)]
pub struct LinkReport {
    /// `PROTOCOL@LINK` as requested.
    pub to: String,
    /// What to connect to.
    pub name: String,
    /// Packets made for it: `sent + dropped + queued`.
    pub made: u64,
    /// Packets it took.
    pub sent: u64,
    /// The same as `sent`.
    pub packets: u64,
    /// Bytes in those packets.
    pub bytes: u64,
    /// Packets it did not take.
    pub dropped: u64,
    /// Packets still on their way to it when the run was stopped.
    pub queued: u64,
    /// What happens to a packet that the link does not take in time: `drop-newest`, `drop-oldest`, `stretch`.
    pub overload: String,
    /// The most bytes in the link's buffers that the other side had not read, sampled every 20 ms; absent if the
    /// system does not tell.
    pub queue_bytes: Option<u64>,
    /// Bytes sent a second, from first to last packet, relative to the capacity of the baud rate (8N1), if there is
    /// one.
    pub utilisation: Option<f64>,
    /// The speed of the UART that a pty emulated.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub paced_baud: Option<u32>,
    /// When the port was unplugged.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gaps: Option<Gaps>,
    /// Packets sent beside the stream: replies to the other side, requests, a farewell.
    pub replies: u64,
    /// Packets that each kind of fault on this output acted on; not part of `dropped`.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub faults: BTreeMap<&'static str, u64>,
    /// The rates that the controller asked for while it was sent others, in order.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub asked: Vec<AskedRate>,
    /// What came back during the scene, where the other side answers.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub answers: Option<AnswersReport>,
    /// What a driver asked, on a bus.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bus: Option<BusReport>,
    /// Damaged packets received.
    pub crc_errors: u64,
    /// Packets that the other side missed by their sequence numbers, if known.
    pub lost_seq: Option<u64>,
    /// Why it stopped taking packets.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub broken: Option<String>,
}

impl LinkReport {
    /// A report with every possible field and these kinds of faults, to check limits against.
    pub fn shape(to: &str, overload: &str, faults: impl Iterator<Item = &'static str>) -> LinkReport {
        LinkReport {
            to: to.into(),
            name: to.into(),
            overload: overload.into(),
            queue_bytes: Some(0),
            gaps: Some(Gaps::default()),
            answers: Some(AnswersReport::shape()),
            bus: Some(BusReport::shape()),
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
    /// Total time from each first packet that it could not take to the next that it took, s.
    pub total_s: f64,
    /// Packets dropped during the gaps.
    pub dropped: u64,
    /// Samples in them.
    pub samples: u64,
}
