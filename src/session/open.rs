//! The control side's half of an output.

use super::account::Account;
use super::outside::Outside;
use super::side::Side;
use super::{Event, SessionError};
use crate::link::{Address, Link, Receiver, bytes_per_second};
use crate::report::LinkReport;
use crate::scene::Output;
use std::pin::pin;
use std::time::Duration;
use tokio::time::{Instant, interval_at, timeout_at};

/// No waiting notice for a reader that comes within this time: a command or a demonstration opens its link by
/// itself.
const PATIENCE: Duration = Duration::from_millis(500);
/// Time between two words about a wait.
pub(super) const BEAT: Duration = Duration::from_secs(1);

/// After a reader is gone for this long, the user gets a notice.
const GONE: Duration = Duration::from_secs(1);

/// The control side's half of an output: its link, observed without delaying the pacing thread.
pub(super) struct OpenOutput {
    pub output: Output,
    pub link: Link,
    /// Where the other side answers, if not there.
    pub answers: Option<Link>,
    /// Where the other side tells its attitude besides, or why that is not heard.
    pub aside: Option<Result<Link, String>>,
    /// Whether something may come back on it.
    pub speaks: bool,
    /// The highest fill of the link's buffers, bytes.
    fullest: Option<usize>,
    /// Since when its reader is gone, and whether the user knows.
    gone: Option<Instant>,
    told_gone: bool,
    /// The port was unplugged.
    unplugged: bool,
    /// Its reader has left for good.
    pub abandoned: bool,
}

impl OpenOutput {
    /// Opens its link, and a connection to where the other side answers.
    /// `bridged` is whether a ground station takes the place where it may tell its attitude besides.
    pub(super) async fn open(output: &Output, bridged: bool) -> Result<OpenOutput, SessionError> {
        let link = Link::open(&output.to.address).await?;
        let answers = match output.to.apart() {
            Some(address) => Some(Link::open(address).await.map_err(|source| {
                let whom = output.to.target.map_or(output.to.protocol.name(), |target| target.name);
                SessionError::Answers { whom, source }
            })?),
            None => None,
        };
        let aside = overhear(output, bridged).await;
        let (output, speaks) = (output.clone(), link.answers());
        Ok(OpenOutput {
            output,
            link,
            answers,
            aside,
            speaks,
            fullest: None,
            gone: None,
            told_gone: false,
            unplugged: false,
            abandoned: false,
        })
    }

    /// What the other side says, wherever it does; once.
    pub(super) fn receiver(&mut self) -> Option<Receiver> {
        self.answers.as_mut().unwrap_or(&mut self.link).receiver()
    }

    /// Lets go of its links.
    pub(super) async fn close(self) {
        self.link.close().await;
        if let Some(answers) = self.answers {
            answers.close().await;
        }
        if let Some(Ok(aside)) = self.aside {
            aside.close().await;
        }
    }

    /// What to connect to.
    pub(super) fn name(&self) -> &str {
        self.link.name()
    }

    /// Reports that the link is open, and what the user should know about it.
    pub(super) fn introduce(&self, outside: &mut Outside<'_>) {
        self.link.notices().iter().for_each(|notice| outside.notice(notice.clone()));
        if let Some(Err(why)) = &self.aside {
            outside.notice(why.clone());
        }
        outside.tell(Event::Ready(&self.output.to.at(self.name())));
    }

    /// True when somebody is on the link; false when the user or the command ended the wait. `waited` is the length
    /// of the whole wait, which ends at the deadline.
    pub(super) async fn wait_for_reader(
        &mut self,
        waited: Duration,
        deadline: Instant,
        outside: &mut Outside<'_>,
    ) -> Result<bool, SessionError> {
        let link = self.name().to_string();
        let whom = self.whom();
        let hint = self.output.to.target.map_or("", |target| target.nobody);
        let hint = if hint.is_empty() { String::new() } else { format!("{hint}; ") };
        let mut peer = pin!(timeout_at(deadline, self.link.peer()));
        let mut beats = interval_at(Instant::now() + PATIENCE, BEAT);
        loop {
            tokio::select! {
                peer = &mut peer => {
                    peer.map_err(|_| SessionError::Nobody { link, waited, hint })??;
                    return Ok(true);
                }
                () = outside.ends() => return Ok(false),
                _ = beats.tick() => outside.tell(Event::Waiting { whom: &whom, left: deadline - Instant::now() }),
            }
        }
    }

    /// Whom the link waits for.
    fn whom(&self) -> String {
        let name = self.name();
        match self.output.to.address {
            Address::TcpIn(_) => format!("somebody to connect to {name}"),
            Address::UdpIn(_) => format!("somebody to send to {name}"),
            _ => format!("a reader to open {name}"),
        }
    }

    /// Checks the link, and reports a port that left or came back.
    pub(super) fn look(&mut self, outside: &mut Outside<'_>) {
        self.fullest = self.fullest.max(self.link.queued());
        let (name, is_unplugged) = (self.link.name(), self.link.is_unplugged());
        match (self.unplugged, is_unplugged) {
            (false, true) => {
                outside.notice(format!("{name} was unplugged: it is opened again when it is back"))
            }
            (true, false) => outside.notice(format!("{name} is back: the scene goes on where it is now")),
            _ => {}
        }
        self.unplugged = is_unplugged;
        self.look_for_reader(outside);
    }

    /// Bytes that the other side has not read, if the system tells.
    pub(super) fn unread(&self) -> Option<u64> {
        self.link.queued().map(|bytes| bytes as u64)
    }

    /// Notices a reader that leaves for longer than a moment, and one that comes back.
    fn look_for_reader(&mut self, outside: &mut Outside<'_>) {
        if !self.link.peer_has_left() {
            self.gone = None;
            if std::mem::take(&mut self.told_gone) {
                outside.notice(format!("{} has a reader again", self.name()));
            }
            return;
        }
        let gone = *self.gone.get_or_insert_with(Instant::now);
        if gone.elapsed() >= GONE && !std::mem::replace(&mut self.told_gone, true) {
            outside.notice(format!("{}: its reader is gone; what is sent meanwhile is lost", self.name()));
        }
    }

    /// The link's report, from the output's account and its conversation.
    pub(super) fn report(&self, account: &Account, side: &Side) -> LinkReport {
        let Account { made, tally, left, .. } = account;
        let address = &self.output.to.address;
        let baud = self.link.baud().map(|port| port.now()).or(address.baud());
        LinkReport {
            to: self.output.to.to_string(),
            name: self.name().to_string(),
            made: made.packets,
            sent: tally.packets,
            packets: tally.packets,
            bytes: tally.bytes,
            dropped: tally.dropped,
            queued: left.packets,
            overload: self.output.overload.name().into(),
            queue_bytes: self.fullest.map(|bytes| bytes as u64),
            utilisation: baud.zip(tally.bytes_per_s()).map(|(baud, bytes)| bytes / bytes_per_second(baud)),
            paced_baud: baud.filter(|_| matches!(address, Address::Pty { .. })),
            gaps: tally.gaps.report(),
            replies: tally.replies + side.replies(),
            faults: made.by_fault(&self.output),
            answers: side.report(tally),
            crc_errors: side.damaged(),
            asked: made.asked.clone(),
            broken: self.broken(account),
            ..LinkReport::default()
        }
    }

    /// Why the link stopped taking packets.
    fn broken(&self, account: &Account) -> Option<String> {
        match account.end {
            _ if self.unplugged => Some("unplugged, and not back".into()),
            _ if self.abandoned => Some("the reader left".into()),
            end => end.map(|kind| kind.to_string()),
        }
    }
}

/// Opens the place where a controller tells its attitude besides; `None` where there is none, or `bridged` to a ground
/// station that takes it.
async fn overhear(output: &Output, bridged: bool) -> Option<Result<Link, String>> {
    let address = output.to.overheard().filter(|_| !bridged)?;
    Some(Link::open(address).await.map_err(|error| {
        format!("{error}: its attitude is not heard there, so it is not scored and its estimator is given some time before the scene")
    }))
}
