//! PX4's watch on a sensor: too many equal readings, or none for too long, and it is not used.

/// So many equal readings in a row and the sensor is stale (`VALUE_EQUAL_COUNT_DEFAULT`).
const EQUAL: u32 = 100;
/// Without a reading for so long it has timed out (`DATA_VALIDATOR_TIMEOUT`), µs.
const TIMEOUT_US: u64 = 500_000;

/// One sensor.
#[derive(Debug, Clone, Default)]
pub(super) struct Validator {
    last: Option<[f32; 3]>,
    equal: u32,
    at_us: Option<u64>,
    timed_out: bool,
}

impl Validator {
    /// Takes a reading; whether it is to be used.
    pub(super) fn take(&mut self, value: [f32; 3], now_us: u64) -> bool {
        self.equal = if self.last == Some(value) { self.equal + 1 } else { 0 };
        (self.last, self.at_us, self.timed_out) = (Some(value), Some(now_us), false);
        self.equal < EQUAL
    }

    /// Whether it has just timed out.
    pub(super) fn times_out(&mut self, now_us: u64) -> bool {
        let late = self.at_us.is_some_and(|at_us| now_us.saturating_sub(at_us) > TIMEOUT_US);
        late && !std::mem::replace(&mut self.timed_out, late)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hundred_equal_readings_make_it_stale_and_another_one_well_again() {
        let mut validator = Validator::default();
        let good = (0..150).filter(|k| validator.take([1.0, 2.0, 3.0], k * 4000)).count();
        assert_eq!(good, 100);
        assert!(validator.take([1.0, 2.0, 3.1], 600_000));
        assert!(validator.take([1.0, 2.0, 3.0], 604_000));
    }

    #[test]
    fn a_silence_of_half_a_second_is_told_once() {
        let mut validator = Validator::default();
        assert!(!validator.times_out(9_000_000), "nothing has come yet");
        validator.take([0.0; 3], 1_000_000);
        let told: Vec<u64> =
            (1_000_000..3_000_000).step_by(1000).filter(|&t| validator.times_out(t)).collect();
        assert_eq!(told, [1_501_000]);
        validator.take([0.0; 3], 3_000_000);
        assert!(!validator.times_out(3_400_000) && validator.times_out(3_600_000));
    }
}
