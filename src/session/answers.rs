//! Watches the answers of one other side: how many come, how evenly, and when they stop.
//!
//! A controller that was killed, reset or stalled looks like a healthy link: packets go out on time and nothing comes
//! back. A silence is longer than ten usual gaps and half a second (PX4 on a busy host pauses for up to 220 ms and goes
//! on).

use super::shared::TICK;
use crate::report::{AnswersReport, Times, number};
use crate::time::{NANOS, SimTime};

/// No silence is shorter, ns.
const LEAST: i64 = NANOS / 2;
/// How many usual gaps a silence lasts.
const GAPS: i64 = 10;
/// Before this many gaps the usual gap is not known, and a silence is this long, ns.
const KNOWN: u64 = 10;
const UNKNOWN: i64 = 2 * NANOS;
/// A look that comes later than this, ns, means that this process did not run: that time is nobody's silence.
const OWN_STALL: i64 = 20 * TICK.as_nanos() as i64;

/// The answers of one side.
#[derive(Debug, Default)]
pub(super) struct Answers {
    /// During the scene.
    received: u64,
    gaps: Times,
    silences: u64,
    silent: i64,
    /// The longest gap, silences included, ns.
    longest: i64,
    pub restarts: u64,
    /// When the last one came, ns, and the scene time then.
    last: Option<(i64, SimTime)>,
    looked: i64,
    /// Whether the user knows of the present silence.
    told: bool,
}

impl Answers {
    /// An answer came at `now`, ns; `t` is the scene time, or `None` before the scene. Returns how long the silence was
    /// that it ended, if the user knows of one.
    pub(super) fn take(&mut self, now: i64, t: Option<SimTime>) -> Option<String> {
        let gap = self.last.map(|(last, _)| now - last);
        let was_silent = gap.is_some_and(|gap| gap > self.limit());
        self.last = Some((now, t.unwrap_or_default()));
        if t.is_some() {
            self.received += 1;
            if self.received > 1 {
                self.longest = self.longest.max(gap.unwrap_or_default());
            }
            match gap {
                Some(gap) if was_silent => self.count_silence(gap),
                Some(gap) if self.received > 1 => self.gaps.record(gap),
                _ => {}
            }
        }
        std::mem::take(&mut self.told)
            .then(|| format!("answers again after {} s", seconds(gap.unwrap_or_default())))
    }

    /// Looks whether it is silent at `now`, ns. Returns a notice once in each silence.
    pub(super) fn look(&mut self, now: i64) -> Option<String> {
        let stall = now - std::mem::replace(&mut self.looked, now);
        if let Some((last, _)) = self.last.as_mut().filter(|_| stall > OWN_STALL) {
            *last = (*last + stall).min(now);
        }
        let silent = self.silent_for(now)?;
        (!std::mem::replace(&mut self.told, true)).then(|| {
            let usual = self.usual().map_or(String::new(), |gap| {
                format!(" (one every {} ms is usual)", number(gap as f64 * 1e-6))
            });
            format!(
                "no answer for {} s{usual}: it hangs, restarts, or is no longer connected",
                seconds(silent)
            )
        })
    }

    /// The report of a scene during which `asked` packets went out, where each of them is answered. It took `span` ns and
    /// ended at `end`, ns.
    pub(super) fn report(&self, asked: Option<u64>, span: i64, end: i64) -> Option<AnswersReport> {
        let stopped = self.silent_for(end).zip(self.last);
        if self.received == 0 && asked.is_none() && span < UNKNOWN {
            return None;
        }
        let by_gap = self.mean_gap().map(|gap| libm::round(span as f64 / gap) as u64);
        Some(AnswersReport {
            expected: asked.or(by_gap.map(|expected| expected.max(self.received))),
            expected_by: if asked.is_some() { "packets" } else { "usual gap" },
            received: self.received,
            gap_us: self.gaps.spread(),
            silences: self.silences + u64::from(stopped.is_some()),
            silent_s: (self.silent + stopped.map_or(0, |(silent, _)| silent)) as f64 * 1e-9,
            silent_longest_s: self.longest.max(stopped.map_or(0, |(silent, _)| silent)) as f64 * 1e-9,
            restarts: self.restarts,
            stopped_at_s: stopped.map(|(_, (_, t))| t.seconds()),
        })
    }

    /// For how long it has been silent at `now`, ns, where that is longer than usual.
    fn silent_for(&self, now: i64) -> Option<i64> {
        let silent = now - self.last?.0;
        (silent > LEAST && silent > self.limit()).then_some(silent)
    }

    fn count_silence(&mut self, ns: i64) {
        self.silences += 1;
        self.silent += ns;
    }

    /// How long a silence is at least, ns.
    fn limit(&self) -> i64 {
        self.usual().map_or(UNKNOWN, |gap| (GAPS * gap).max(LEAST))
    }

    /// The median gap, ns.
    fn usual(&self) -> Option<i64> {
        let median = self.gaps.spread().map(|us| (us.p50 * 1e3) as i64);
        median.filter(|_| self.gaps.count() >= KNOWN)
    }

    /// The mean gap, ns.
    fn mean_gap(&self) -> Option<f64> {
        (self.gaps.count() >= KNOWN).then(|| self.gaps.mean_ns())
    }
}

fn seconds(ns: i64) -> String {
    format!("{:.1}", ns as f64 * 1e-9)
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: i64 = 1_000_000;

    /// One every 10 ms of so many seconds of a scene, each gap as `gap` makes it, looked at every 10 ms.
    fn answering(seconds: i64) -> Answers {
        let mut answers = Answers::default();
        for k in 0..100 * seconds {
            assert_eq!(answers.look(k * 10 * MS), None);
            assert_eq!(answers.take(k * 10 * MS, Some(SimTime(k * 10 * MS))), None);
        }
        answers
    }

    fn looks(answers: &mut Answers, from_ms: i64, to_ms: i64) -> Vec<(i64, String)> {
        let look = |ms| Some((ms, answers.look(ms * MS)?));
        (from_ms..to_ms).step_by(10).filter_map(look).collect()
    }

    #[test]
    fn even_answers_are_counted_and_none_is_missed() {
        let answers = answering(5);
        let report = answers.report(Some(500), 5 * NANOS, 5 * NANOS).unwrap();
        assert_eq!((report.received, report.expected, report.silences), (500, Some(500), 0));
        assert_eq!((report.stopped_at_s, report.restarts), (None, 0));
        let gap = report.gap_us.unwrap();
        assert!((gap.p50 - 1e4).abs() < 100.0 && (gap.max - 1e4).abs() < 100.0, "{gap:?}");
        let by_gap = answering(5).report(None, 10 * NANOS, 5 * NANOS).unwrap();
        assert!(
            by_gap.expected.unwrap().abs_diff(1000) <= 1,
            "twice the span, twice the answers: {by_gap:?}"
        );
        assert_eq!(by_gap.expected_by, "usual gap");
    }

    #[test]
    fn a_silence_is_told_once_while_it_lasts_and_again_when_it_ends() {
        let mut answers = answering(5);
        let told = looks(&mut answers, 5000, 9000);
        assert_eq!(told.len(), 1, "{told:?}");
        let (ms, text) = &told[0];
        // Half a second after the last answer, at 4.99 s.
        assert_eq!(*ms, 5500);
        assert!(text.starts_with("no answer for 0.5 s (one every 10 ms is usual)"), "{text}");
        let back = answers.take(9000 * MS, Some(SimTime(9000 * MS)));
        assert_eq!(back.as_deref(), Some("answers again after 4.0 s"));
        for k in 901..1000 {
            assert_eq!(answers.take(k * 10 * MS, Some(SimTime(k * 10 * MS))), None);
        }
        let report = answers.report(Some(1000), 10 * NANOS, 10 * NANOS).unwrap();
        assert_eq!((report.received, report.silences, report.stopped_at_s), (600, 1, None));
        assert!((report.silent_s - 4.01).abs() < 1e-9 && report.silent_longest_s == report.silent_s);
        assert!(report.gap_us.unwrap().max < 10_100.0, "the silence is no gap");
    }

    #[test]
    fn one_that_does_not_come_back_has_stopped_and_a_slow_one_has_not() {
        let report = answering(5).report(Some(5000), 50 * NANOS, 50 * NANOS).unwrap();
        assert_eq!(report.count(), "500 of 5000 answers");
        assert_eq!((report.stopped_at_s, report.silences), (Some(4.99), 1));
        let mut slow = Answers::default();
        for k in 0..20 {
            slow.take(k * NANOS, Some(SimTime(k * NANOS)));
        }
        // One a second: eight seconds are within ten gaps.
        assert_eq!(slow.silent_for(27 * NANOS), None);
        assert!(slow.silent_for(30 * NANOS).is_some());
        assert_eq!(answering(5).report(None, 5 * NANOS, 5 * NANOS + 200 * MS).unwrap().stopped_at_s, None);
    }

    #[test]
    fn a_stall_of_this_process_is_nobodys_silence() {
        let mut answers = answering(5);
        assert_eq!(answers.look(5000 * MS), None);
        // SIGSTOP, and SIGCONT after ten seconds.
        assert_eq!(answers.look(15_000 * MS), None);
        assert!(looks(&mut answers, 15_010, 15_400).is_empty());
        assert_eq!(looks(&mut answers, 15_400, 17_000).len(), 1, "from then on it counts");
    }

    #[test]
    fn where_nothing_ever_answers_there_is_no_report() {
        assert_eq!(Answers::default().report(None, NANOS, NANOS), None);
        let silent = Answers::default().report(Some(100), NANOS, NANOS).unwrap();
        assert_eq!(
            (silent.received, silent.expected),
            (0, Some(100)),
            "each packet should have been answered"
        );
    }
}
