//! Double-double arithmetic: a number as the unevaluated sum of two `f64`s, about 106 bits.
//!
//! An angle after an hour at full scale has 10⁵ rad in it, and a plain `f64` then resolves only
//! 10⁻¹¹ rad; a datasheet's "20 deg/s" is not an `f64` at all. Such values are kept as `hi + lo`.
//! The algorithms are those of T. J. Dekker, *A floating-point technique for extending the
//! available precision* (1971), in the form of Y. Hida, X. S. Li and D. H. Bailey,
//! *Library for double-double and quad-double arithmetic* (2007).

mod sines;

pub(crate) use sines::{polynomial, small_sin_cos};

use sines::eighth_turn;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// The number `hi + lo`, with `hi` the `f64` nearest to it.
///
/// Sums, differences, products and quotients are good to about 10⁻³¹ of the result, as long as
/// nothing over- or underflows; a result too large for an `f64` is an infinity or a NaN, as there.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub struct Double {
    /// The nearest `f64`.
    pub hi: f64,
    /// What `hi` leaves out: at most half a unit in the last place of `hi`.
    pub lo: f64,
}

impl Double {
    /// Zero.
    pub const ZERO: Double = Double { hi: 0.0, lo: 0.0 };
    /// One.
    pub const ONE: Double = Double { hi: 1.0, lo: 0.0 };
    /// π.
    pub const PI: Double = Double { hi: std::f64::consts::PI, lo: 1.224_646_799_147_353_2e-16 };
    /// π/2, a quarter turn in radians.
    pub const FRAC_PI_2: Double = Double { hi: std::f64::consts::FRAC_PI_2, lo: 6.123_233_995_736_766e-17 };
    /// 2π, one turn in radians.
    pub const TAU: Double = Double { hi: std::f64::consts::TAU, lo: 2.449_293_598_294_706_4e-16 };
    /// π/180, one degree in radians.
    pub const PI_OVER_180: Double = Double { hi: 0.017_453_292_519_943_295, lo: 2.948_652_270_870_168_7e-19 };

    /// The exact sum of `hi` and `lo`, whichever is the larger.
    pub const fn new(hi: f64, lo: f64) -> Self {
        let sum = hi + lo;
        let shadow = sum - hi;
        Self::renormalised(sum, (hi - (sum - shadow)) + (lo - shadow))
    }

    /// Reads a decimal literal: an optional sign, digits with an optional point, and an optional
    /// exponent (`-4.04`, `.5`, `3e-6`).
    ///
    /// `hi` is the `f64` nearest to the text, as `str::parse` gives it; `lo` is the `f64` nearest
    /// to what is left. Anything else (words such as `inf`, spaces, an empty text) and a number
    /// too large for an `f64` is `None`; one too small is 0.
    pub fn from_decimal(text: &str) -> Option<Self> {
        let literal = decimal::Literal::parse(text)?;
        let hi: f64 = text.parse().ok()?;
        if !hi.is_finite() {
            return None;
        }
        let lo = literal.minus(hi.abs());
        Some(Self { hi, lo: if hi.is_sign_negative() { -lo } else { lo } })
    }

    /// The nearest `f64`.
    pub const fn to_f64(self) -> f64 {
        self.hi
    }

    /// Whether it is neither infinite nor NaN.
    pub const fn is_finite(self) -> bool {
        self.hi.is_finite() && self.lo.is_finite()
    }

    /// The absolute value.
    pub fn abs(self) -> Self {
        if self.hi < 0.0 || (self.hi == 0.0 && self.lo < 0.0) { -self } else { self }
    }

    /// The square root; of a negative number, NaN.
    pub fn sqrt(self) -> Self {
        if self.hi <= 0.0 || !self.hi.is_finite() {
            return Self::from(self.hi.sqrt());
        }
        // One Newton step from the f64 root doubles its digits (Karp and Markstein 1997).
        let root = self.hi.sqrt();
        let rest = self - product(root, root);
        Self::new(root, rest.hi / (2.0 * root))
    }

    /// The nearest whole number to `hi + lo`, halves away from zero, if an `i64` can hold it.
    pub fn round_to_i64(self) -> Option<i64> {
        // Whole part and rest of each half; all four are exact.
        let (hi, lo) = (self.hi.trunc(), self.lo.trunc());
        if hi.is_nan() || hi.abs() > 9.3e18 {
            return None;
        }
        let rest = Self::new(self.hi - hi, self.lo - lo);
        let half = if rest.hi.abs() > 0.5 || (rest.hi.abs() == 0.5 && rest.lo * rest.hi > 0.0) {
            // Past the half in its own direction.
            rest.hi.signum() as i128
        } else if rest.hi.abs() == 0.5 && rest.lo == 0.0 && rest.hi * self.hi > 0.0 {
            self.hi.signum() as i128
        } else {
            0
        };
        i64::try_from(hi as i128 + lo as i128 + half).ok()
    }

    /// Sine and cosine of this angle in radians, each to about one unit in the last place.
    ///
    /// The angle is first brought into ±π/4 with a 107-bit π/2, so that the digits of `lo` count in
    /// full; beyond 2³¹ rad, where that would no longer be better, by the addition theorem over
    /// the two halves. Not finite in, NaN out.
    pub fn sin_cos(self) -> (f64, f64) {
        /// Added and taken away, it leaves a number below 2⁵¹ rounded to a whole one.
        const ROUND: f64 = 6_755_399_441_055_744.0;
        if self.hi.abs() < 2_147_483_648.0 {
            let quarters = (self.hi * std::f64::consts::FRAC_2_PI + ROUND) - ROUND;
            let (sin, cos) = eighth_turn(self - Self::FRAC_PI_2 * quarters);
            return match quarters as i64 & 3 {
                0 => (sin, cos),
                1 => (cos, -sin),
                2 => (-sin, -cos),
                _ => (-cos, sin),
            };
        }
        let (sin, cos) = (libm::sin(self.hi), libm::cos(self.hi));
        let (sin_lo, cos_lo) = (libm::sin(self.lo), libm::cos(self.lo));
        (sin * cos_lo + cos * sin_lo, cos * cos_lo - sin * sin_lo)
    }

    /// `sum + error` where they already do not overlap; infinities carry no error.
    const fn renormalised(sum: f64, error: f64) -> Self {
        if sum.is_finite() { Self { hi: sum, lo: error } } else { Self { hi: sum, lo: 0.0 } }
    }
}

/// `a + b` exactly, for |a| ≥ |b| or a = 0 (Dekker's fast two-sum).
fn ordered_sum(a: f64, b: f64) -> Double {
    let sum = a + b;
    Double::renormalised(sum, b - (sum - a))
}

/// `a · b` exactly.
fn product(a: f64, b: f64) -> Double {
    let product = a * b;
    Double::renormalised(product, a.mul_add(b, -product))
}

impl From<f64> for Double {
    fn from(value: f64) -> Self {
        Self { hi: value, lo: 0.0 }
    }
}

impl From<i64> for Double {
    /// Exact.
    fn from(value: i64) -> Self {
        let hi = value as f64;
        if value.unsigned_abs() <= 1 << 53 {
            return Self { hi, lo: 0.0 };
        }
        Self { hi, lo: (i128::from(value) - hi as i128) as f64 }
    }
}

impl Neg for Double {
    type Output = Self;
    fn neg(self) -> Self {
        Self { hi: -self.hi, lo: -self.lo }
    }
}

impl Add for Double {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let high = Self::new(self.hi, other.hi);
        let low = Self::new(self.lo, other.lo);
        let sum = ordered_sum(high.hi, high.lo + low.hi);
        ordered_sum(sum.hi, sum.lo + low.lo)
    }
}

impl Sub for Double {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Double {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let high = product(self.hi, other.hi);
        let cross = self.hi * other.lo + self.lo * other.hi;
        ordered_sum(high.hi, high.lo + cross)
    }
}

impl Mul<f64> for Double {
    type Output = Self;
    fn mul(self, other: f64) -> Self {
        let high = product(self.hi, other);
        ordered_sum(high.hi, high.lo + self.lo * other)
    }
}

impl Div for Double {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let first = self.hi / other.hi;
        if !first.is_finite() || !other.hi.is_finite() {
            return Self::from(first);
        }
        let rest = self - other * first;
        let second = rest.hi / other.hi;
        let rest = rest - other * second;
        let third = rest.hi / other.hi;
        ordered_sum(first, second) + Self::from(third)
    }
}

/// Exact comparison of a decimal literal with an `f64`, in whole numbers of any length.
mod decimal {
    /// Digits beyond these change a number by less than 10⁻⁸⁰⁰ of itself and are left out.
    const DIGITS: usize = 800;

    /// The magnitude of a decimal literal: `digits · 10^exponent`.
    pub struct Literal {
        digits: Whole,
        exponent: i32,
    }

    impl Literal {
        /// The literal, unless it is something else than one.
        pub fn parse(text: &str) -> Option<Self> {
            let unsigned = text.strip_prefix(['+', '-']).unwrap_or(text);
            let (mantissa, power) = match unsigned.find(['e', 'E']) {
                Some(at) => (&unsigned[..at], Some(&unsigned[at + 1..])),
                None => (unsigned, None),
            };
            let power = power.map_or(Some(0), exponent)?;
            let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
            let all = || whole.bytes().chain(fraction.bytes());
            if all().next().is_none() || !all().all(|byte| byte.is_ascii_digit()) {
                return None;
            }
            let places = i64::try_from(fraction.len()).ok()?;
            let leading = all().take_while(|byte| *byte == b'0').count();
            let significant = whole.len() + fraction.len() - leading;
            let mut digits = Whole::default();
            for byte in all().skip(leading).take(DIGITS) {
                digits.multiply_add(10, u32::from(byte - b'0'));
            }
            let dropped = i64::try_from(significant.saturating_sub(DIGITS)).ok()?;
            let exponent = (power - places + dropped).clamp(-1_000_000_000, 1_000_000_000);
            Some(Self { digits, exponent: i32::try_from(exponent).ok()? })
        }

        /// The literal less `hi`, which is the `f64` nearest to it (and so 0 or not far off).
        pub fn minus(&self, hi: f64) -> f64 {
            if hi == 0.0 {
                return 0.0;
            }
            let (mantissa, power) = split(hi);
            let tens_below = self.exponent.min(0).unsigned_abs();
            let twos_below = power.min(0).unsigned_abs();
            let mut literal = self.digits.clone();
            literal.multiply_tens(self.exponent.max(0).unsigned_abs());
            literal.shift_up(twos_below);
            let mut nearest = Whole::from(mantissa);
            nearest.multiply_tens(tens_below);
            nearest.shift_up(power.max(0).unsigned_abs());
            let mut unit = Whole::from(1);
            unit.multiply_tens(tens_below);
            unit.shift_up(twos_below);
            if literal.less_than(&nearest) {
                -nearest.less(&literal).over(unit)
            } else {
                literal.less(&nearest).over(unit)
            }
        }
    }

    /// The digits after `e`, with a sign; far out of range is as good as any other far number.
    fn exponent(text: &str) -> Option<i64> {
        let unsigned = text.strip_prefix(['+', '-']).unwrap_or(text);
        if unsigned.is_empty() || !unsigned.bytes().all(|byte| byte.is_ascii_digit()) {
            return None;
        }
        let value = unsigned.parse().unwrap_or(i64::MAX).min(1 << 40);
        Some(if text.starts_with('-') { -value } else { value })
    }

    /// A positive finite `f64` as `mantissa · 2^power`.
    fn split(value: f64) -> (u64, i32) {
        let bits = value.to_bits();
        let fraction = bits & ((1 << 52) - 1);
        match (bits >> 52) as i32 & 0x7ff {
            0 => (fraction, -1074),
            power => (fraction | 1 << 52, power - 1075),
        }
    }

    /// A whole number of any length, least significant 32 bits first, no zeros on top.
    #[derive(Clone, Default)]
    struct Whole(Vec<u32>);

    impl From<u64> for Whole {
        fn from(value: u64) -> Self {
            let mut whole = Whole(vec![value as u32, (value >> 32) as u32]);
            whole.trim();
            whole
        }
    }

    impl Whole {
        fn trim(&mut self) {
            while self.0.last() == Some(&0) {
                self.0.pop();
            }
        }

        fn multiply_add(&mut self, factor: u32, add: u32) {
            let mut carry = u64::from(add);
            for limb in &mut self.0 {
                let value = u64::from(*limb) * u64::from(factor) + carry;
                *limb = value as u32;
                carry = value >> 32;
            }
            if carry > 0 {
                self.0.push(carry as u32);
            }
        }

        fn multiply_tens(&mut self, power: u32) {
            for _ in 0..power / 9 {
                self.multiply_add(1_000_000_000, 0);
            }
            self.multiply_add(10_u32.pow(power % 9), 0);
        }

        fn shift_up(&mut self, bits: u32) {
            if self.0.is_empty() {
                return;
            }
            self.multiply_add(1 << (bits % 32), 0);
            self.0.splice(0..0, (0..bits / 32).map(|_| 0));
        }

        fn bits(&self) -> u32 {
            let top = self.0.last().map_or(0, |limb| 32 - limb.leading_zeros());
            32 * (self.0.len().max(1) as u32 - 1) + top
        }

        fn less_than(&self, other: &Whole) -> bool {
            let lengths = self.0.len().cmp(&other.0.len());
            lengths.then_with(|| self.0.iter().rev().cmp(other.0.iter().rev())).is_lt()
        }

        /// `self - other`, which is not above it.
        fn less(mut self, other: &Whole) -> Whole {
            let mut borrow = 0;
            for (at, limb) in self.0.iter_mut().enumerate() {
                let value = i64::from(*limb) - i64::from(other.0.get(at).copied().unwrap_or(0));
                let value = value - borrow;
                borrow = i64::from(value < 0);
                *limb = value as u32;
            }
            self.trim();
            self
        }

        /// `self / other`, rounded to nearest: 55 bits by long division, and one for the rest.
        fn over(mut self, mut other: Whole) -> f64 {
            if self.0.is_empty() {
                return 0.0;
            }
            let power = self.bits() as i32 - other.bits() as i32;
            self.shift_up((-power).max(0).unsigned_abs());
            other.shift_up(power.max(0).unsigned_abs());
            let mut quotient = 0_u64;
            for _ in 0..57 {
                quotient <<= 1;
                if !self.less_than(&other) {
                    self = self.less(&other);
                    quotient |= 1;
                }
                self.shift_up(1);
            }
            let quotient = quotient << 1 | u64::from(!self.0.is_empty());
            libm::scalbn(quotient as f64, power - 57)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn read(text: &str) -> Double {
        Double::from_decimal(text).unwrap_or_else(|| panic!("{text} is a number"))
    }

    /// Relative difference.
    fn apart(a: Double, b: Double) -> f64 {
        ((a - b).hi / b.hi).abs()
    }

    #[test]
    fn constants_have_the_digits_of_pi() {
        let pi = read("3.14159265358979323846264338327950288419716939937510");
        assert_eq!(Double::PI, pi);
        assert_eq!(Double::TAU, pi * 2.0);
        assert!(apart(Double::PI_OVER_180, pi / Double::from(180_i64)) < 1e-31);
    }

    #[test]
    fn a_literal_is_kept_to_thirty_digits() {
        // Text, and its nearest f64 and the nearest f64 to the rest, from exact fractions.
        for (text, hi, lo) in [
            ("0.1", 0.1, -5.551115123125783e-18),
            ("-0.1", -0.1, 5.551115123125783e-18),
            ("1e23", 1e23, 8388608.0),
            ("1125", 1125.0, 0.0),
            (".5", 0.5, 0.0),
            ("5.", 5.0, 0.0),
            ("+2.5E-0", 2.5, 0.0),
            ("9007199254740993", 9007199254740992.0, 1.0),
            ("123456789012345678901234567890", 1.2345678901234568e29, 1_023_514_970_834.0),
            ("0e999999999999", 0.0, 0.0),
            ("-0", -0.0, 0.0),
        ] {
            let value = read(text);
            assert_eq!((value.hi, value.lo), (hi, lo), "{text}");
        }
        // Ten thousand zeros change nothing.
        let long = format!("1{}e-10001", "0".repeat(10_000));
        assert_eq!(read(&long), read("0.1"));
    }

    #[test]
    fn small_literals_are_as_exact_as_large_ones() {
        let small = read("1.2345678901234567890123456789e-250");
        let scale = read("1e250");
        assert!(apart(small * scale, read("1.2345678901234567890123456789")) < 1e-30);
        assert_eq!(read("1e-300").hi, 1e-300);
        assert_eq!(read("1e-400"), Double::ZERO);
        assert_eq!(read("5e-324").hi, 5e-324);
    }

    #[test]
    fn what_is_no_finite_decimal_is_refused() {
        for text in [
            "",
            ".",
            "-",
            "+",
            "e5",
            ".e5",
            "1e",
            "1e+",
            "1e5.0",
            "1.2.3",
            "--1",
            "+-1",
            " 1",
            "1 ",
            "1_000",
            "0x10",
            "inf",
            "-inf",
            "infinity",
            "nan",
            "NaN",
            "1e309",
            "-1e400",
            "1e99999999999999999999",
            "\u{2212}1",
            "\u{664}",
            "1d5",
        ] {
            assert_eq!(Double::from_decimal(text), None, "{text:?}");
        }
    }

    #[test]
    fn whole_numbers_are_exact() {
        for value in [0, 1, -1, i64::MAX, i64::MIN, (1 << 53) + 1, -(1 << 62) - 1] {
            let double = Double::from(value);
            assert_eq!(double, Double::new(double.hi, double.lo), "{value} is normalised");
            assert_eq!(double.round_to_i64(), Some(value));
        }
    }

    #[test]
    fn rounding_goes_to_the_nearest_and_halves_away_from_zero() {
        for (text, rounded) in [
            ("0.5", Some(1)),
            ("-0.5", Some(-1)),
            ("2.4999999999999999999999999", Some(2)),
            ("2.5000000000000000000000001", Some(3)),
            ("-2.5", Some(-3)),
            ("-2.4999999999999999999999999", Some(-2)),
            ("9007199254740992.5", Some(9007199254740993)),
            ("9007199254740991.5", Some(9007199254740992)),
            ("9007199254740991.4999999999", Some(9007199254740991)),
            ("9223372036854775807.4", Some(i64::MAX)),
            ("9223372036854775807.5", None),
            ("-9223372036854775808.4", Some(i64::MIN)),
            ("1e300", None),
        ] {
            assert_eq!(read(text).round_to_i64(), rounded, "{text}");
        }
        assert_eq!(Double::from(f64::NAN).round_to_i64(), None);
    }

    #[test]
    fn infinities_carry_no_error_term() {
        let large = Double::from(f64::MAX);
        for value in [large * large, large + large, large / read("1e-300"), Double::new(f64::INFINITY, 1.0)] {
            assert_eq!((value.hi, value.lo), (f64::INFINITY, 0.0));
            assert!(!value.is_finite());
        }
        assert!((Double::ZERO / Double::ZERO).hi.is_nan());
        assert_eq!(Double::ONE / large / large, Double::ZERO);
        assert!(read("-4").sqrt().hi.is_nan());
        assert_eq!(Double::ZERO.sqrt(), Double::ZERO);
    }

    /// Angle, sine and cosine, the latter computed with 90 digits.
    const SINES: [(&str, f64, f64); 10] = [
        ("0", 0.0, 1.0),
        ("0.7", 0.644217687237691, 0.7648421872844884),
        ("7.25", 0.8230808790115055, 0.5679241732886948),
        ("123456.789", -0.9986640823434471, 0.05167253271439977),
        ("3.14159265358979", 3.2384626433832794e-15, -1.0),
        ("6.28318530717958647692528676655900577", 1.6056612012497883e-36, 1.0),
        ("31415926.5358979", -3.238462643383279e-08, 0.9999999999999994),
        ("1e9", 0.5458434494486996, 0.8378871813639024),
        ("999999999.123456789", -0.29470594974767106, 0.9555879881953955),
        ("1234567890123456.789", 0.36232593881701824, 0.9320514546205946),
    ];

    #[test]
    fn sine_and_cosine_are_right_to_the_last_place_for_any_angle() {
        for (angle, sine, cosine) in SINES {
            let (sin, cos) = read(angle).sin_cos();
            let reach = 1e-32 * read(angle).hi;
            for (ours, exact) in [(sin, sine), (cos, cosine)] {
                assert!(
                    (ours - exact).abs() <= 2.3e-16 * exact.abs() + reach,
                    "{angle}: {ours:e} for {exact:e}"
                );
            }
            let (sin, cos) = read(angle).neg().sin_cos();
            assert!((sin + sine).abs() <= 2.3e-16 && (cos - cosine).abs() <= 2.3e-16, "-{angle}");
        }
        assert!(Double::from(f64::INFINITY).sin_cos().0.is_nan());
    }

    #[test]
    fn without_the_low_half_a_large_angle_would_be_wrong() {
        let exact = read("999999999.123456789");
        let (sin, _) = Double::from(exact.hi).sin_cos();
        assert!((sin - exact.sin_cos().0).abs() > 1e-9);
    }

    fn ordinary() -> impl Strategy<Value = Double> {
        (-1e6_f64..1e6, -1.0_f64..1.0, -40_i32..40).prop_map(|(hi, lo, power)| {
            let scale = 2_f64.powi(power);
            Double::new(hi * scale, lo * hi * scale * 1e-17)
        })
    }

    proptest! {
        #[test]
        fn results_are_normalised_and_undo_each_other(a in ordinary(), b in ordinary()) {
            prop_assume!(a.hi != 0.0 && b.hi != 0.0);
            for value in [a + b, a - b, a * b, a / b, a.abs().sqrt()] {
                prop_assert_eq!(value.hi, value.hi + value.lo);
            }
            prop_assert!(apart(a * b / b, a) < 1e-30);
            prop_assert!(((a + b - b - a).hi / (a.hi.abs() + b.hi.abs())).abs() < 1e-31);
            prop_assert!(apart(a.abs().sqrt() * a.abs().sqrt(), a.abs()) < 1e-30);
            prop_assert!(apart((a + b) * (a - b), a * a - b * b) * ((a + b) * (a - b)).hi.abs()
                < 1e-29 * (a.hi * a.hi + b.hi * b.hi));
        }

        #[test]
        fn an_exact_literal_leaves_nothing_over(value in any::<f64>()) {
            prop_assume!(value.is_finite());
            // Rust writes an f64 in full when asked for enough places; 1080 is every one of them.
            let exact = format!("{value:.1080}");
            let read = Double::from_decimal(&exact);
            prop_assert_eq!(read.map(|d| d.hi.to_bits()), Some(value.to_bits()));
            if value.abs() > 1e-200 {
                prop_assert_eq!(read.map(|d| d.lo), Some(0.0));
            }
        }

        #[test]
        fn no_text_panics(text in any::<String>()) {
            let _ = Double::from_decimal(&text);
        }
    }
}
