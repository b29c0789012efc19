//! What was heard on a link: the report of `listen`, with the names of a run's where they mean the same.

use super::{Host, Interval, Late, Limit};
use serde::Serialize;
use std::collections::BTreeMap;

/// The report of somebody's stream, one JSON object.
#[derive(Clone, Debug, Default, Serialize)]
#[non_exhaustive]
pub struct HeardReport {
    /// The program's version.
    pub version: String,
    /// Whether nothing was lost or damaged and every limit held.
    pub ok: bool,
    /// What did not hold: `links.0.lost_seq = 3 > 0`.
    pub failed: Vec<String>,
    /// From the first bytes to the last, s, or from the first stamp of a `.tlog` to its last; absent for other recordings.
    pub duration_s: Option<f64>,
    /// What it ran on.
    pub host: Host,
    /// Each sensor heard, in the order of gyro, accel, mag.
    pub sensors: Vec<HeardSensor>,
    /// The link that was listened to.
    pub links: Vec<HeardLink>,
}

impl HeardReport {
    /// Of these sensors and this link, not judged yet.
    pub fn new(host: Host, sensors: Vec<HeardSensor>, link: HeardLink) -> HeardReport {
        let version = env!("CARGO_PKG_VERSION").into();
        HeardReport { version, ok: true, host, sensors, links: vec![link], ..HeardReport::default() }
    }

    /// What was lost or damaged, a stream that has no samples at all, and broken limits.
    ///
    /// # Errors
    /// The report cannot be written as JSON.
    pub fn judge(&mut self, limits: &[Limit]) -> serde_json::Result<()> {
        let value = serde_json::to_value(&*self)?;
        let lost = self.links.iter().enumerate().flat_map(|(i, link)| {
            let counts = [("lost_seq", link.lost_seq.unwrap_or(0)), ("crc_errors", link.crc_errors)];
            let some = counts.into_iter().filter(|(_, count)| *count > 0);
            some.map(move |(name, count)| format!("links.{i}.{name} = {count} > 0"))
        });
        let mut failed: Vec<_> = lost.collect();
        if self.sensors.is_empty() {
            failed.push("no packet carried a sample of gyro, accel or mag".into());
        }
        failed.extend(limits.iter().filter_map(|limit| limit.broken(&value)));
        self.ok = failed.is_empty();
        self.failed = failed;
        Ok(())
    }
}

/// One sensor as the receiver sees it.
#[derive(Clone, Debug, Default, Serialize)]
pub struct HeardSensor {
    /// `gyro`, `accel`, `mag`; others of the same kind on the link are `gyro-2`, …
    pub name: String,
    /// Which packets bring it.
    pub source: String,
    /// Samples received.
    pub received: u64,
    /// How often the sender samples, by its own sample times: intervals a second, those hidden in gaps counted, Hz. What
    /// is lost changes nothing; steps of the clock are left out.
    pub rate_hz: Option<f64>,
    /// How many samples arrive a second: (n − 1)/(t_last − t_first), Hz, steps of a recording's stamps left out.
    pub received_hz: Option<f64>,
    /// Samples that are missing by their times: intervals, as long as the stream's own are, that passed without one.
    pub missing: Option<u64>,
    /// How often a sample's time was not after that of the one before.
    pub steps_back: u64,
    /// How often a sample's time was so far after that of the one before that the clock was set: more than 1 s and 100
    /// intervals, and neither as long between the arrivals nor, up to a minute, a packet missing by the numbers.
    pub steps_forward: u64,
    /// The longest of those steps, s, negative if back.
    pub longest_step_s: Option<f64>,
    /// The share of samples that arrived in the same read as the one before.
    pub burst_share: Option<f64>,
    /// Between two arrivals, µs.
    pub interval_us: Option<Interval>,
    /// Between two sample times, µs.
    pub sample_interval_us: Option<Interval>,
    /// How far the interval between two arrivals is from that between the two sample times, either way, µs: the
    /// error of dt for a receiver that takes the time of arrival for the time of the sample.
    pub jitter_us: Option<Late>,
}

impl HeardSensor {
    /// With every field that there can be, for limits to be checked against.
    pub fn shape(name: String) -> HeardSensor {
        HeardSensor {
            name,
            rate_hz: Some(0.0),
            received_hz: Some(0.0),
            missing: Some(0),
            longest_step_s: Some(0.0),
            burst_share: Some(0.0),
            interval_us: Some(Interval::default()),
            sample_interval_us: Some(Interval::default()),
            jitter_us: Some(Late::default()),
            ..HeardSensor::default()
        }
    }
}

/// The link as the receiver sees it.
#[derive(Clone, Debug, Default, Serialize)]
pub struct HeardLink {
    /// `PROTOCOL@LINK` as asked for.
    pub to: String,
    /// What was opened.
    pub name: String,
    /// Whole packets.
    pub packets: u64,
    /// Bytes, those of no packet included.
    pub bytes: u64,
    /// Bytes a second from the first to the last arrival.
    pub bytes_per_s: Option<f64>,
    /// The same against what the baud rate carries (8N1), where there is one.
    pub utilisation: Option<f64>,
    /// Packets that fail their checksum or are cut short; a stretch of other bytes counts as one.
    pub crc_errors: u64,
    /// Packets missing by their sequence numbers, modulo 256, damaged ones included; absent in protocols without.
    pub lost_seq: Option<u64>,
    /// Packets whose number came twice in a row; absent in protocols without.
    pub duplicates: Option<u64>,
    /// Packets that later ones overtook, sixteen at most; they are not lost. Absent in protocols without numbers.
    pub out_of_order: Option<u64>,
    /// 1 if the first bytes were the rest of a packet, which is no damage.
    pub joined_midway: u64,
    /// Packets of MAVLink messages beyond the dialects `common` and `ardupilotmega`, whose checksum and so whose number
    /// cannot be checked: they show no gap, but fill one.
    pub unchecked: u64,
    /// How often the stamps of a `.tlog` went back, or on by more than an hour; absent elsewhere.
    pub stamp_steps: Option<u64>,
    /// Packets without a sample, by name.
    pub foreign: BTreeMap<String, u64>,
}
