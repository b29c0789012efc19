//! Readings thinned to a bounded number of stretches of time, each with its least and its greatest value.

use crate::time::SimTime;

/// A sensor's readings over time, thinned.
#[derive(Clone, Debug)]
pub(super) struct Strip {
    /// How long a stretch is, ns.
    width: i64,
    least: i64,
    most: usize,
    /// Readings taken in.
    pub count: u64,
    /// When the first reading of each stretch was taken.
    pub t: Vec<SimTime>,
    /// By column, the least value of each stretch.
    pub low: Vec<Vec<f64>>,
    /// By column, the greatest.
    pub high: Vec<Vec<f64>>,
    /// By column, the error-free value of the first reading; no columns where that is not known.
    pub truth: Vec<Vec<f64>>,
}

impl Strip {
    /// An empty strip of so many columns, with their truth or without; stretches are `width` long until there are more
    /// than `most`, then twice as long, and so on.
    pub(super) fn new(columns: usize, has_truth: bool, width: SimTime, most: usize) -> Strip {
        Strip {
            width: width.0.max(1),
            least: width.0.max(1),
            most: most.max(2),
            count: 0,
            t: Vec::new(),
            low: vec![Vec::new(); columns],
            high: vec![Vec::new(); columns],
            truth: vec![Vec::new(); if has_truth { columns } else { 0 }],
        }
    }

    /// Takes a reading in, not earlier than the one before.
    pub(super) fn add(&mut self, t: SimTime, values: &[f64], truth: &[f64]) {
        self.count += 1;
        let place = |t: SimTime| t.0.div_euclid(self.width);
        if self.t.last().is_some_and(|&last| place(last) == place(t)) {
            for ((low, high), value) in self.low.iter_mut().zip(&mut self.high).zip(values) {
                if let (Some(low), Some(high)) = (low.last_mut(), high.last_mut()) {
                    (*low, *high) = (low.min(*value), high.max(*value));
                }
            }
            return;
        }
        self.t.push(t);
        for ((low, high), value) in self.low.iter_mut().zip(&mut self.high).zip(values) {
            low.push(*value);
            high.push(*value);
        }
        self.truth.iter_mut().zip(truth).for_each(|(column, value)| column.push(*value));
        while self.t.len() > self.most {
            self.widen();
        }
    }

    /// Makes stretches twice as long.
    fn widen(&mut self) {
        self.width = self.width.saturating_mul(2);
        let mut kept = 0;
        for i in 0..self.t.len() {
            let joins =
                kept > 0 && self.t[kept - 1].0.div_euclid(self.width) == self.t[i].0.div_euclid(self.width);
            let to = if joins { kept - 1 } else { kept };
            for (low, high) in self.low.iter_mut().zip(&mut self.high) {
                let before = if joins { (low[to], high[to]) } else { (low[i], high[i]) };
                (low[to], high[to]) = (before.0.min(low[i]), before.1.max(high[i]));
            }
            if !joins {
                self.t[to] = self.t[i];
                self.truth.iter_mut().for_each(|column| column[to] = column[i]);
                kept += 1;
            }
        }
        self.t.truncate(kept);
        let columns = self.low.iter_mut().chain(&mut self.high).chain(&mut self.truth);
        columns.for_each(|column| column.truncate(kept));
    }

    /// Whether a stretch holds more than one reading.
    pub(super) fn is_thinned(&self) -> bool {
        self.count > self.t.len() as u64
    }

    /// Takes everything out; stretches are as long as in the beginning again.
    pub(super) fn take(&mut self) -> Strip {
        let empty = Strip::new(self.low.len(), !self.truth.is_empty(), SimTime(self.least), self.most);
        std::mem::replace(self, empty)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_slow_sensor_keeps_every_reading() {
        let mut strip = Strip::new(1, true, SimTime(10), 100);
        (0..50).for_each(|k| strip.add(SimTime(k * 10), &[k as f64], &[0.5]));
        assert_eq!((strip.t.len(), strip.is_thinned()), (50, false));
        assert!(strip.low[0] == strip.high[0] && strip.truth[0] == vec![0.5; 50]);
    }

    proptest! {
        /// However it is thinned: bounded, in order, and every stretch spans exactly its readings.
        #[test]
        fn every_stretch_spans_its_readings(
            values in proptest::collection::vec(-1e3..1e3f64, 1..600), most in 2usize..40, width in 1i64..50,
        ) {
            let mut strip = Strip::new(1, true, SimTime(width), most);
            for (k, value) in values.iter().enumerate() {
                strip.add(SimTime(k as i64 * 7), &[*value], &[-value]);
            }
            prop_assert!(strip.t.len() <= most && strip.t.is_sorted());
            let index = |t: SimTime| (t.0 / 7) as usize;
            let mut ends: Vec<usize> = strip.t.iter().skip(1).map(|t| index(*t)).collect();
            ends.push(values.len());
            for (i, (t, end)) in strip.t.iter().zip(ends).enumerate() {
                let of = &values[index(*t)..end];
                prop_assert_eq!(strip.low[0][i], of.iter().copied().fold(f64::INFINITY, f64::min));
                prop_assert_eq!(strip.high[0][i], of.iter().copied().fold(f64::NEG_INFINITY, f64::max));
                prop_assert_eq!(strip.truth[0][i], -of[0]);
            }
        }
    }
}
