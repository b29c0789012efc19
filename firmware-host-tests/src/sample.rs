//! What a driver hands to the estimator.

/// Readings of one instant, in body axes (FRD); a sensor that has nothing new is `None`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Sample {
    /// The sender's time of the readings, µs, unwrapped.
    pub t_us: u64,
    /// Angular rate, rad/s.
    pub gyro: Option<[f64; 3]>,
    /// Specific force, m/s²: level at rest is `[0, 0, -9.8]`.
    pub accel: Option<[f64; 3]>,
    /// Magnetic field, µT.
    pub mag: Option<[f64; 3]>,
}

/// Makes a wrapping 32-bit time in µs one that does not wrap.
///
/// Right as long as neighbours are less than 35 minutes apart; a time from before the first is 0.
#[derive(Debug, Clone, Copy, Default)]
pub struct Unwrap {
    last: Option<u64>,
}

impl Unwrap {
    /// The unwrapped time, µs.
    pub fn unwrap(&mut self, t_us: u32) -> u64 {
        let unwrapped = match self.last {
            None => u64::from(t_us),
            Some(last) => {
                let step = t_us.wrapping_sub(last as u32) as i32;
                last.saturating_add_signed(i64::from(step))
            }
        };
        self.last = Some(unwrapped);
        unwrapped
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_goes_on_past_the_wrap_and_may_step_back_a_little() {
        let mut unwrap = Unwrap::default();
        assert_eq!(unwrap.unwrap(u32::MAX - 9), u64::from(u32::MAX) - 9);
        assert_eq!(unwrap.unwrap(10), u64::from(u32::MAX) + 11);
        assert_eq!(unwrap.unwrap(5), u64::from(u32::MAX) + 6);
    }
}
