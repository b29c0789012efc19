//! Rows that are left out, counted and reported.

/// How many rows are left out, and why.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct LeftOut {
    /// With the time of the newest row before them.
    pub duplicate: usize,
    /// Older than the newest, while time goes on from there.
    pub overtaken: usize,
    /// Ahead of all the rows that follow.
    pub ahead: usize,
    /// Without a time or a value, or with one that is not finite.
    pub not_finite: usize,
    /// With a quaternion of zeros.
    pub zero: usize,
}

impl LeftOut {
    /// All of them.
    pub fn count(&self) -> usize {
        self.duplicate + self.overtaken + self.ahead + self.not_finite + self.zero
    }
}

/// Why one row is left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Reason {
    Duplicate,
    Overtaken,
    Ahead,
    NotFinite,
    Zero,
}

/// The rows of a table.
#[derive(Clone, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct Rows {
    /// How many there are, with those that are left out.
    pub read: usize,
    /// How many are left out.
    pub left_out: LeftOut,
    /// The line of the first of each reason.
    #[serde(skip)]
    first: [Option<u64>; 5],
}

impl Rows {
    /// Rows of which none is left out.
    pub fn whole(read: usize) -> Rows {
        Rows { read, ..Rows::default() }
    }

    /// Rows that are no lines of a text, some of them not finite.
    pub fn records(read: usize, not_finite: usize) -> Rows {
        Rows { read, left_out: LeftOut { not_finite, ..LeftOut::default() }, first: [None; 5] }
    }

    pub(super) fn leave(&mut self, reason: Reason, line: u64) {
        let count = match reason {
            Reason::Duplicate => &mut self.left_out.duplicate,
            Reason::Overtaken => &mut self.left_out.overtaken,
            Reason::Ahead => &mut self.left_out.ahead,
            Reason::NotFinite => &mut self.left_out.not_finite,
            Reason::Zero => &mut self.left_out.zero,
        };
        *count += 1;
        let first = &mut self.first[reason as usize];
        // Records that are no lines have the number 0.
        *first = Some(first.map_or(line, |first| first.min(line))).filter(|line| *line > 0);
    }

    /// What is left out and why, in one line; nothing where nothing is.
    pub fn told(&self) -> Option<String> {
        let LeftOut { duplicate, overtaken, ahead, not_finite, zero } = self.left_out;
        let all = self.left_out.count();
        let reasons = [
            (duplicate, "with the time of the previous row", self.first[0]),
            (overtaken, "older than an earlier row", self.first[1]),
            (ahead, "later than all rows after it", self.first[2]),
            (not_finite, "without a finite value", self.first[3]),
            (zero, "with a quaternion of zeros", self.first[4]),
        ];
        let reason = |(count, what, line): (usize, &str, Option<u64>)| {
            let place = match line {
                Some(line) if count == 1 => format!(" (line {line})"),
                Some(line) => format!(" (first in line {line})"),
                None => String::new(),
            };
            (count > 0).then(|| format!("{count} {what}{place}"))
        };
        let reasons: Vec<_> = reasons.into_iter().filter_map(reason).collect();
        let verb = if all == 1 { "is" } else { "are" };
        let coarse = if 2 * duplicate > self.read {
            "; its time resolution is coarser than its row interval"
        } else {
            ""
        };
        (all > 0)
            .then(|| format!("{all} of {} rows {verb} left out: {}{coarse}", self.read, reasons.join(", ")))
    }
}
