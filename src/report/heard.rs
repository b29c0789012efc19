//! The report of `listen`, with the field names of a run's report where the meaning is the same.

use super::{Host, Interval, Late, Limit};
use serde::Serialize;
use std::collections::BTreeMap;

/// The report on a received stream, one JSON object.
#[derive(Clone, Debug, Default, Serialize)]
#[non_exhaustive]
pub struct HeardReport {
    /// The program's version.
    pub version: String,
    /// Whether nothing was lost or damaged and every limit held.
    pub ok: bool,
    /// The limits and conditions that failed: `links.0.lost_seq = 3 > 0`.
    pub failed: Vec<String>,
    /// Time from the first bytes to the last, s, or from the first stamp of a `.tlog` to its last; absent for other
    /// recordings.
    pub duration_s: Option<f64>,
    /// The machine.
    pub host: Host,
    /// Each sensor heard, in the order gyro, accel, mag.
    pub sensors: Vec<HeardSensor>,
    /// The link that was listened to.
    pub links: Vec<HeardLink>,
}

impl HeardReport {
    /// The report of these sensors and this link, not judged yet.
    pub fn new(host: Host, sensors: Vec<HeardSensor>, link: HeardLink) -> HeardReport {
        let version = env!("CARGO_PKG_VERSION").into();
        HeardReport { version, ok: true, host, sensors, links: vec![link], ..HeardReport::default() }
    }

    /// Judges losses, damage, a stream without samples, and broken limits.
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
        if self.sensors.is_empty()
            && !self.links.iter().any(|link| link.attitudes.is_some_and(|count| count > 0))
        {
            failed.push("no packet carried a sample of gyro, accel or mag".into());
        }
        failed.extend(limits.iter().filter_map(|limit| limit.broken(&value)));
        self.ok = failed.is_empty();
        self.failed = failed;
        Ok(())
    }
}

/// One sensor, on the receiving side.
#[derive(Clone, Debug, Default, Serialize)]
pub struct HeardSensor {
    /// `gyro`, `accel`, `mag`; others of the same kind on the link are `gyro-2`, …
    pub name: String,
    /// The packets that carry it.
    pub source: String,
    /// Samples received.
    pub received: u64,
    /// The sender's sample rate by its own sample times, Hz: intervals a second, with those hidden in gaps counted.
    /// Losses do not change it; steps of the clock are left out.
    pub rate_hz: Option<f64>,
    /// Samples arriving a second: (n − 1)/(t_last − t_first), Hz, without steps of a recording's stamps.
    pub received_hz: Option<f64>,
    /// Missing samples by their times: the stream's own intervals that passed without a sample.
    pub missing: Option<u64>,
    /// How often a sample's time was not after the previous one's.
    pub steps_back: u64,
    /// How often a sample's time was so far after the previous one's that the clock was set: more than 1 s and 100
    /// intervals, while the arrivals were not that far apart and, up to a minute, no packet was missing by sequence
    /// number.
    pub steps_forward: u64,
    /// The longest of those steps, s; negative for a step back.
    pub longest_step_s: Option<f64>,
    /// The share of samples that arrived in the same read as the one before.
    pub burst_share: Option<f64>,
    /// Between two arrivals, µs.
    pub interval_us: Option<Interval>,
    /// Between two sample times, µs.
    pub sample_interval_us: Option<Interval>,
    /// The difference between the interval of two arrivals and that of their sample times, absolute value, µs: the
    /// error of dt for a receiver that uses the arrival time as the sample time.
    pub jitter_us: Option<Late>,
}

impl HeardSensor {
    /// A report with every possible field, to check limits against.
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

/// The link, on the receiving side.
#[derive(Clone, Debug, Default, Serialize)]
pub struct HeardLink {
    /// `PROTOCOL@LINK` as requested.
    pub to: String,
    /// The name of the opened link.
    pub name: String,
    /// Whole packets.
    pub packets: u64,
    /// Bytes, including those outside packets.
    pub bytes: u64,
    /// Bytes a second from the first to the last arrival.
    pub bytes_per_s: Option<f64>,
    /// The same relative to the capacity of the baud rate (8N1), if there is one.
    pub utilisation: Option<f64>,
    /// Packets that fail their checksum or are truncated; a stretch of other bytes counts as one.
    pub crc_errors: u64,
    /// Packets missing by their sequence numbers, modulo 256, damaged ones included; absent in protocols without
    /// numbers.
    pub lost_seq: Option<u64>,
    /// Packets whose number came twice in a row; absent in protocols without numbers.
    pub duplicates: Option<u64>,
    /// Packets that later ones overtook, by sixteen at most; they are not lost. Absent in protocols without
    /// numbers.
    pub out_of_order: Option<u64>,
    /// 1 if the first bytes were the rest of a packet, which is no damage.
    pub joined_midway: u64,
    /// Packets of MAVLink messages outside the dialects `common` and `ardupilotmega`, whose checksum, and therefore
    /// sequence number, cannot be checked: they show no gap, but fill one.
    pub unchecked: u64,
    /// How often the stamps of a `.tlog` went back, or forward by more than an hour; absent elsewhere.
    pub stamp_steps: Option<u64>,
    /// Attitudes that the controller told, where it was asked for them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub attitudes: Option<u64>,
    /// Packets without a sample, by name.
    pub foreign: BTreeMap<String, u64>,
}
