//! What came of a bus that was served.

use crate::bus::{Change, Reads};
use crate::report::{BusReport, LinkReport, ReadReport, SensorReport, Times};
use crate::scene::Plan;
use crate::session::Outcome;
use crate::time::SimTime;
use ratetable_protocols::bridge::Counts;

/// What came of a bus that was served.
#[derive(Default)]
pub(super) struct Served {
    pub to: String,
    pub name: String,
    pub chips: Vec<String>,
    /// Scene time that was played.
    pub played: SimTime,
    /// How long the vehicle was held still before.
    pub rest: SimTime,
    /// What the bridge did in the scene.
    pub counts: Counts,
    pub bytes: u64,
    pub latency: Times,
    pub reads: Vec<Reads>,
    pub changes: Vec<Change>,
    pub realtime: bool,
    pub memory_locked: bool,
    pub baud: Option<u32>,
}

impl Served {
    /// Its part of the outcome of a run.
    pub(super) fn outcome(self, plan: &Plan) -> Outcome {
        let sensors = plan.sensors.iter().zip(&self.reads).map(|(sensor, reads)| {
            let tally = reads.tally;
            SensorReport {
                name: sensor.kind.name().to_string(),
                rate_hz: sensor.rate.as_hz(),
                made: tally.made,
                sent: tally.read,
                dropped: tally.missed + tally.overflowed,
                replaced: tally.missed,
                queued: reads.waiting(),
                read: Some(ReadReport {
                    hz: reads.hz(),
                    samples: tally.read,
                    again: tally.again,
                    missed: tally.missed,
                    overflowed: tally.overflowed,
                }),
                ..SensorReport::default()
            }
        });
        let seconds = self.played.seconds();
        let bus = BusReport {
            chips: self.chips.clone(),
            transfers: self.counts.transfers,
            transfers_per_s: (seconds > 0.0).then(|| self.counts.transfers as f64 / seconds),
            refused: self.counts.refused,
            strange: self.counts.strange,
            answer_us: self.latency.spread(),
        };
        let link = LinkReport {
            to: self.to.clone(),
            name: self.name.clone(),
            made: self.counts.transfers,
            sent: self.counts.transfers,
            packets: self.counts.transfers,
            bytes: self.bytes,
            paced_baud: self.baud,
            bus: Some(bus),
            ..LinkReport::default()
        };
        Outcome {
            played: self.played,
            rest_s: self.rest.seconds(),
            realtime: self.realtime,
            memory_locked: self.memory_locked,
            sensors: sensors.collect(),
            links: vec![link],
            settings: self.changes,
            ..Outcome::default()
        }
    }
}
