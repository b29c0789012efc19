//! What the control side sees of the links while packets go out, and what it says of them at the end.

use super::pacer::Left;
use super::producer::Made;
use super::tally::LinkTally;
use crate::link::{Address, Link, bytes_per_second};
use crate::report::{Gaps, LinkReport};
use crate::scene::Output;
use crate::wire::Acts;
use std::collections::BTreeMap;
use std::io::ErrorKind;
use std::time::Duration;

/// Between two looks.
pub(super) const LOOK: Duration = Duration::from_millis(20);

/// What is seen of the links, now and then: nothing that the pacing thread would have to wait for.
#[derive(Debug)]
pub(super) struct Lookout {
    /// The fullest that each one's buffers were, bytes.
    fullest: Vec<Option<usize>>,
    /// Whether each is a port that was pulled out.
    out: Vec<bool>,
}

impl Lookout {
    pub(super) fn new(links: usize) -> Lookout {
        Lookout { fullest: vec![None; links], out: vec![false; links] }
    }

    /// Looks at every link and tells of ports that came or went.
    pub(super) fn look(&mut self, links: &[Link], mut tell: impl FnMut(String)) {
        for ((link, fullest), out) in links.iter().zip(&mut self.fullest).zip(&mut self.out) {
            *fullest = (*fullest).max(link.queued());
            match (*out, link.is_unplugged()) {
                (false, true) => {
                    tell(format!("{} was unplugged: it is opened again when it is back", link.name()))
                }
                (true, false) => tell(format!("{} is back: the scene goes on where it is now", link.name())),
                _ => {}
            }
            *out = link.is_unplugged();
        }
    }
}

/// What there is to say of all links.
pub(super) struct Account<'a> {
    pub outputs: &'a [Output],
    pub names: Vec<String>,
    pub tallies: &'a [LinkTally],
    pub gone: &'a [Option<ErrorKind>],
    pub made: &'a Made,
    pub left: &'a Left,
    pub lookout: &'a Lookout,
    /// Damaged answers.
    pub damaged: &'a [u64],
    /// Packets beside the stream that went out before it began.
    pub replies: &'a [u64],
    /// The link whose reader left for good.
    pub abandoned: Option<usize>,
}

impl Account<'_> {
    /// A report a link.
    pub(super) fn reports(&self) -> Vec<LinkReport> {
        (0..self.outputs.len()).map(|i| self.report(i)).collect()
    }

    fn report(&self, i: usize) -> LinkReport {
        let (output, tally) = (&self.outputs[i], &self.tallies[i]);
        let baud = output.to.address.baud();
        let gaps = &tally.gaps;
        LinkReport {
            to: output.to.to_string(),
            name: self.names[i].clone(),
            made: self.made.packets.get(i).copied().unwrap_or(0),
            sent: tally.packets,
            packets: tally.packets,
            bytes: tally.bytes,
            dropped: tally.dropped,
            queued: self.left.packets[i],
            overload: output.overload.name().into(),
            queue_bytes: self.lookout.fullest[i].map(|bytes| bytes as u64),
            utilisation: baud.zip(tally.bytes_per_s()).map(|(baud, bytes)| bytes / bytes_per_second(baud)),
            paced_baud: baud.filter(|_| matches!(output.to.address, Address::Pty { .. })),
            gaps: (gaps.count > 0).then_some(Gaps {
                count: gaps.count,
                total_s: gaps.total_ns as f64 * 1e-9,
                dropped: gaps.dropped,
                samples: gaps.samples,
            }),
            replies: tally.replies + self.replies[i],
            faults: by_kind(output, self.made.faults.get(i).map_or(&[], Vec::as_slice)),
            crc_errors: self.damaged[i],
            lost_seq: None,
            broken: self.broken(i),
        }
    }

    /// Why it takes nothing any more.
    fn broken(&self, i: usize) -> Option<String> {
        match self.gone[i] {
            _ if self.lookout.out[i] => Some("unplugged, and not back".into()),
            _ if self.abandoned == Some(i) => Some("the reader left".into()),
            gone => gone.map(|kind| kind.to_string()),
        }
    }
}

/// The packets that each kind of an output's faults acted on.
fn by_kind(output: &Output, acts: &[Acts]) -> BTreeMap<&'static str, u64> {
    let mut all: BTreeMap<_, _> = output.faults.iter().map(|fault| (fault.kind.name(), 0)).collect();
    acts.iter().for_each(|acts| *all.entry(acts.kind.name()).or_default() += acts.packets);
    all
}

/// The faults of outputs that acted: `mpu@pty drop from 2 s to 3 s`.
pub(super) fn fired(outputs: &[Output], made: &Made) -> Vec<String> {
    let acted = outputs.iter().zip(&made.faults).flat_map(|(output, acts)| {
        acts.iter().filter(|acts| acts.packets > 0).map(|acts| format!("{} {}", output.to, acts.what))
    });
    acted.collect()
}
