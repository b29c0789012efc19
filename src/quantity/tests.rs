use super::*;
use proptest::prelude::*;
use std::f64::consts::PI;

const DEG: f64 = PI / 180.0;
const G: f64 = 9.80665;

/// Good texts: what reads them, and the value in inside units.
#[test]
fn a_datasheet_value_is_read_as_it_is_written() {
    for (kind, text, value) in [
        (Kind::ANGLE, "180 deg", PI),
        (Kind::ANGLE, "180°", PI),
        (Kind::ANGLE, "180 º", PI),
        (Kind::ANGLE, "0.5 rev", PI),
        (Kind::ANGLE, "5 mrad", 0.005),
        (Kind::ANGLE, "5 µrad", 5e-6),
        (Kind::ANGLE, "5 μrad", 5e-6),
        (Kind::ANGLE, "5 urad", 5e-6),
        (Kind::ANGLE, "60 arcmin", DEG),
        (Kind::ANGLE, "3600 arcsec", DEG),
        (Kind::ANGLE, "720 deg", 4.0 * PI),
        (Kind::ANGULAR_RATE, "20 deg/s", 20.0 * DEG),
        (Kind::ANGULAR_RATE, "−20 °/s", -20.0 * DEG),
        (Kind::ANGULAR_RATE, "-20 dps", -20.0 * DEG),
        (Kind::ANGULAR_RATE, "+20000 mdps", 20.0 * DEG),
        (Kind::ANGULAR_RATE, "30 rpm", PI),
        (Kind::ANGULAR_RATE, "0.5 rev/s", PI),
        (Kind::ANGULAR_RATE, "3600 deg/h", DEG),
        (Kind::ANGULAR_RATE, "3600 °/hr", DEG),
        (Kind::ANGULAR_RATE, "-0.0005 rad/s", -0.0005),
        (Kind::ANGULAR_RATE, "2 rad*Hz", 2.0),
        (Kind::ANGULAR_RATE, "2 rad s⁻¹", f64::NAN),
        (Kind::ANGULAR_RATE, "2 rad·s⁻¹", 2.0),
        (Kind::ANGULAR_RATE, "2 rad * s^-1", 2.0),
        (Kind::ANGULAR_RATE, "2 rad/s²*s", 2.0),
        (Kind::ANGULAR_RATE, "2 rad/(s^2/s)", 2.0),
        (Kind::ACCELERATION, "1 g", G),
        (Kind::ACCELERATION, "1 g0", G),
        (Kind::ACCELERATION, "1 gn", G),
        (Kind::ACCELERATION, "1000 mg", G),
        (Kind::ACCELERATION, "1e6 µg", G),
        (Kind::ACCELERATION, "1e6 ug", G),
        (Kind::ACCELERATION, "9.80665 m/s^2", G),
        (Kind::ACCELERATION, "9.80665 m/s²", G),
        (Kind::ACCELERATION, "9.80665m/s/s", G),
        (Kind::ACCELERATION, "9806.65 mm/s^2", G),
        (Kind::FIELD, "50 uT", 50.0),
        (Kind::FIELD, "50 µT", 50.0),
        (Kind::FIELD, "50000 nT", 50.0),
        (Kind::FIELD, "0.05 mT", 50.0),
        (Kind::FIELD, "5e-5 T", 50.0),
        (Kind::FIELD, "0.5 G", 50.0),
        (Kind::FIELD, "0.5 gauss", 50.0),
        (Kind::FIELD, "0.5 Gs", 50.0),
        (Kind::FIELD, "500 mG", 50.0),
        (Kind::FIELD, "500 mGs", 50.0),
        (Kind::FIELD, "500 mgauss", 50.0),
        (Kind::TIME, "5s", 5.0),
        (Kind::TIME, " 5 s ", 5.0),
        (Kind::TIME, "1e3ms", 1.0),
        (Kind::TIME, "250 µs", 250e-6),
        (Kind::TIME, "250 us", 250e-6),
        (Kind::TIME, "250 ns", 250e-9),
        (Kind::TIME, "1.5 min", 90.0),
        (Kind::TIME, "1h", 3600.0),
        (Kind::TIME, "2 day", 172_800.0),
        (Kind::FREQUENCY, "2 kHz", 2000.0),
        (Kind::FREQUENCY, "2 MHz", 2e6),
        (Kind::FREQUENCY, "2 mHz", 0.002),
        (Kind::FREQUENCY, "2 /s", 2.0),
        (Kind::FREQUENCY, "2 / 3 Hz", 2.0 / 3.0),
        (Kind::FREQUENCY, "400/3Hz", 400.0 / 3.0),
        (Kind::LENGTH, "2.5 cm", 0.025),
        (Kind::LENGTH, "10 ft", 3.048),
        (Kind::LENGTH, "2 km", 2000.0),
        (Kind::SPEED, "36 km/h", 10.0),
        (Kind::SPEED, "3600 knot", 1852.0),
        (Kind::GYRO_DENSITY, "0.01 deg/s/√Hz", 0.01 * DEG),
        (Kind::GYRO_DENSITY, "0.01 dps/rtHz", 0.01 * DEG),
        (Kind::GYRO_DENSITY, "10 mdps/sqrt(Hz)", 0.01 * DEG),
        (Kind::GYRO_DENSITY, "0.01 °/s/√(Hz)", 0.01 * DEG),
        (Kind::GYRO_DENSITY, "0.01 deg/s/Hz^0.5", 0.01 * DEG),
        (Kind::GYRO_DENSITY, "0.01 deg/s/rt(Hz)", 0.01 * DEG),
        (Kind::GYRO_DENSITY, "0.01 deg/s*Hz^(-1/2)", 0.01 * DEG),
        (Kind::GYRO_DENSITY, "0.01 deg/(s*√Hz)", 0.01 * DEG),
        (Kind::ANGLE_RANDOM_WALK, "0.34 deg/√h", 0.34 / 60.0 * DEG),
        (Kind::ANGLE_RANDOM_WALK, "0.34 °/√hr", 0.34 / 60.0 * DEG),
        (Kind::ANGLE_RANDOM_WALK, "0.34 deg/rth", 0.34 / 60.0 * DEG),
        (Kind::ANGLE_RANDOM_WALK, "0.01 rad/s/rtHz", 0.01),
        (Kind::ANGLE_RANDOM_WALK, "0.01 rad/rts", 0.01),
        (Kind::ACCEL_DENSITY, "300 µg/√Hz", 300e-6 * G),
        (Kind::ACCEL_DENSITY, "300 ug/rtHz", 300e-6 * G),
        (Kind::VELOCITY_RANDOM_WALK, "0.037 m/s/√h", 0.037 / 60.0),
        (Kind::MAG_DENSITY, "100 nT/√Hz", 0.1),
        (Kind::GYRO_VARIANCE, "3e-6 rad^2/s^2", 3e-6),
        (Kind::GYRO_VARIANCE, "3e-6 (rad/s)^2", 3e-6),
        (Kind::GYRO_VARIANCE, "3×10^-6 rad^2/s^2", f64::NAN),
        (Kind::ACCEL_VARIANCE, "1 g²", G * G),
        (Kind::MAG_VARIANCE, "0.04 uT^2", 0.04),
        (Kind::GYRO_WALK, "0.001 deg/s/√s", 0.001 * DEG),
        (Kind::GYRO_WALK, "0.001 deg/s/rts", 0.001 * DEG),
        (Kind::GYRO_WALK, "0.001 deg/s^2/√Hz", 0.001 * DEG),
        (Kind::GYRO_WALK, "0.001 deg/s*√Hz", 0.001 * DEG),
        (Kind::ACCEL_WALK, "0.001 m/s^3/rtHz", 0.001),
        (Kind::MAG_WALK, "0.001 uT/√s", 0.001),
        (Kind::RATIO, "3 %", 0.03),
        (Kind::RATIO, "30 ppm", 30e-6),
        (Kind::RATIO, "0.03", 0.03),
        (Kind::RATIO, "2 deg/deg", 2.0),
        (Kind::TEMPERATURE, "25 degC", 25.0),
        (Kind::TEMPERATURE, "25 °C", 25.0),
        (Kind::TEMPERATURE, "25℃", 25.0),
        (Kind::TEMPERATURE, "298.15 K", 25.0),
        (Kind::TEMPERATURE_DIFFERENCE, "15 K", 15.0),
        (Kind::TEMPERATURE_DIFFERENCE, "15 degC", 15.0),
        (Kind::GYRO_PER_KELVIN, "0.005 °/s/K", 0.005 * DEG),
        (Kind::ACCEL_PER_KELVIN, "0.15 mg/°C", 0.15e-3 * G),
        (Kind::RATIO_PER_KELVIN, "100 ppm/K", 1e-4),
        (Kind::G_SENSITIVITY, "0.1 °/s/g", 0.1 * DEG / G),
        (Kind::ACCEL_SPECTRUM, "0.01 g^2/Hz", 0.01 * G * G),
        (Kind::PRESSURE, "1013.25 hPa", 101_325.0),
        (Kind::PRESSURE, "1013.25 mbar", 101_325.0),
        (Kind::PRESSURE, "101.325 kPa", 101_325.0),
    ] {
        let read = kind.scalar(text);
        if value.is_nan() {
            assert!(read.is_err(), "{text}");
            continue;
        }
        let read = read.unwrap_or_else(|error| panic!("{text}: {error}")).to_f64();
        assert!((read - value).abs() <= 4e-16 * value.abs(), "{text}: {read} for {value}");
    }
}

#[test]
fn inside_units_are_the_nearest_f64_of_their_decimals() {
    for (kind, text, value) in [
        (Kind::ANGULAR_RATE, "0.1 rad/s", 0.1),
        (Kind::ACCELERATION, "0.7 mm/s^2", 0.0007),
        (Kind::ACCELERATION, "-4.04 mm/s^2", -0.00404),
        (Kind::ACCELERATION, "9.80665 m/s^2", 9.80665),
        (Kind::ACCELERATION, "3 g", 29.41995),
        (Kind::TIME, "0.1 ms", 0.0001),
        (Kind::TIME, "500 ms", 0.5),
        (Kind::FIELD, "49.1 nT", 0.0491),
        (Kind::RATIO, "0.3 %", 0.003),
        (Kind::TEMPERATURE, "300 K", 26.85),
    ] {
        assert_eq!(kind.scalar(text).map(Double::to_f64), Ok(value), "{text}");
    }
    // And beyond f64: one degree, to 30 digits.
    let degree = Kind::ANGLE.scalar("1 deg").unwrap();
    assert_eq!(degree, Double::PI_OVER_180);
    let whole = Kind::ANGLE.scalar("360 deg").unwrap() - Double::TAU;
    assert!(whole.hi.abs() < 1e-30);
}

#[test]
fn a_vector_has_three_values_and_a_scalar_fills_all() {
    let read = |kind: Kind, text| kind.vector(text).map(|v| v.map(Double::to_f64));
    assert_eq!(read(Kind::ACCELERATION, "[0.7, 0.33, -4.04] mm/s^2"), Ok([0.0007, 0.00033, -0.00404]));
    assert_eq!(read(Kind::ANGLE, "[0, 0, 0] deg"), Ok([0.0; 3]));
    assert_eq!(read(Kind::FIELD, "[ 3.2,15.0 , −50.3 ]uT"), Ok([3.2, 15.0, -50.3]));
    assert_eq!(read(Kind::FIELD, "[1, 2, 3,] uT"), Ok([1.0, 2.0, 3.0]));
    assert_eq!(read(Kind::RATIO, "[1, 2, 1/2]"), Ok([1.0, 2.0, 0.5]));
    assert_eq!(read(Kind::FIELD, "7 uT"), Ok([7.0; 3]));
}

/// Bad texts: what the message says, and the part it points at.
#[test]
fn a_refusal_says_what_is_wrong_where_and_what_would_be_right() {
    for (kind, text, message, part) in [
        (Kind::ANGULAR_RATE, "20", "`20` has no unit: write \"20 rad/s\" or \"20 deg/s\"", "20"),
        (Kind::ANGULAR_RATE, " [1, 2, 3]", "\"[1, 2, 3] deg/s\"", "[1, 2, 3]"),
        (
            Kind::ANGULAR_RATE,
            "20 deg",
            "`20 deg` is an angle, but an angular rate is required, such as \"20 deg/s\"",
            "deg",
        ),
        (Kind::ANGULAR_RATE, "20 Hz", "is a frequency, but an angular rate", "Hz"),
        (Kind::FREQUENCY, "20 rad/s", "is an angular rate, but a frequency", "rad/s"),
        (Kind::ANGULAR_RATE, "20 deg/s^4", "is in rad/s^4, but", "deg/s^4"),
        (Kind::GYRO_WALK, "1 deg/s/√Hz", "is a gyro noise density, but a gyro bias random walk", "deg/s/√Hz"),
        (Kind::RATIO, "5 deg", "is an angle, but a ratio is required", "deg"),
        (Kind::ANGULAR_RATE, "5 %", "is a ratio, but", "%"),
        (Kind::ANGULAR_RATE, "20 degs", "unknown unit `degs`: did you mean `deg/s`?", "degs"),
        (Kind::ANGULAR_RATE, "20 Deg/s", "did you mean `deg`?", "Deg"),
        (Kind::ANGULAR_RATE, "20 rad/sed", "unknown unit `sed`: did you mean `sec`?", "sed"),
        (Kind::ACCELERATION, "1 m/s2", "unknown unit `s2`: did you mean `s^2`?", "s2"),
        (Kind::ACCELERATION, "1 mps2", "did you mean `m/s^2`?", "mps2"),
        (Kind::FREQUENCY, "1 hz", "did you mean `Hz`?", "hz"),
        (Kind::FREQUENCY, "1 khz", "did you mean `kHz`?", "khz"),
        (Kind::FIELD, "1 V", "unknown unit `V`: a magnetic field is required, such as \"50 uT\"", "V"),
        (Kind::FIELD, "1 kg", "unknown unit `kg`", "kg"),
        (Kind::TEMPERATURE, "25 C", "did you mean `degC`?", "C"),
        (Kind::FIELD, "", "a value is missing: write, for example, \"50 uT\"", ""),
        (Kind::FIELD, "uT", "a number is missing before `uT`, as in \"50 uT\"", "uT"),
        (Kind::FIELD, "√Hz ", "a number is missing before `√Hz`", "√Hz"),
        (Kind::FIELD, "nan uT", "`nan` is not a finite number", "nan"),
        (Kind::FIELD, "[0, -inf, 0] uT", "`-inf` is not a finite number", "-inf"),
        (Kind::FIELD, "1e999 uT", "`1e999` is too large", "1e999"),
        (Kind::FIELD, "1e305 T", "`1e305 T` is too large", "1e305"),
        (Kind::FIELD, "±5 uT", "`±` is unexpected here: write the number alone", "±"),
        (Kind::FIELD, "1,5 uT", "write decimals with a point", ","),
        (Kind::FIELD, "1.5.2 uT", "`.` is unexpected here", "."),
        (Kind::FIELD, "- uT", "`-` is unexpected here: a number is required", "-"),
        (Kind::FIELD, "5 uT please", "units are joined by `*` or `/`", "p"),
        (Kind::FIELD, "5 uT)", "`)` is unexpected here", ")"),
        (Kind::FIELD, "5 (uT", "this parenthesis is not closed", "("),
        (Kind::FIELD, "5 uT/", "something is missing at the end", ""),
        (Kind::FIELD, "5 uT^", "a power is a small whole number", "^"),
        (Kind::FIELD, "5 uT^99", "a power is a small whole number", "^99"),
        (Kind::FIELD, "5 uT^9/uT^-9^9", "`^` is unexpected here", "^"),
        (Kind::FIELD, "5 √√Hz", "a unit is required", "√"),
        (Kind::FIELD, "5 √rtHz", "has a power that no unit has", "√rtHz"),
        (Kind::FIELD, "5 m s^-2", "units are joined", "s"),
        (Kind::ACCELERATION, "5 m*s-2", "a power is written as in `s^-1`", "-"),
        (Kind::FIELD, "[1, 2] uT", "a vector has 3 values, not 2", "[1, 2]"),
        (Kind::FIELD, "[1, 2, 3, 4] uT", "values, not 4", "[1, 2, 3, 4]"),
        (Kind::FIELD, "[1 uT, 2 uT, 3 uT]", "one unit follows the bracket", "u"),
        (Kind::FIELD, "[1, 2", "a vector is written as in", ""),
        (Kind::FIELD, "[]", "a number is required", "]"),
        (Kind::FIELD, "[1, 2, 3] uT", "is a vector, but a magnetic field with one value", "[1, 2, 3]"),
        (Kind::FIELD, "1/0 uT", "a fraction cannot have denominator 0", "1/0"),
        (Kind::MAG_VARIANCE, "-1 uT^2", "is negative, but a magnetometer noise variance", "-1"),
        (Kind::RATE, "0 Hz", "is not above zero", "0"),
    ] {
        let error = match kind.scalar(text) {
            Ok(value) => panic!("{text} was read as {value:?}"),
            Err(error) => error,
        };
        let said = error.to_string();
        assert!(said.contains(message), "{text}: {said}");
        assert_eq!(&text[error.span()], part, "{text}: {said}");
        assert_eq!(error.offset(), error.span().start);
    }
}

#[test]
fn parentheses_nest_only_so_far() {
    let nested = |depth| format!("1 {}Hz{}", "(".repeat(depth), ")".repeat(depth));
    assert!(Kind::FREQUENCY.scalar(&nested(8)).is_ok());
    let deep = Kind::FREQUENCY.scalar(&nested(100_000)).unwrap_err();
    assert!(deep.to_string().contains("too many parentheses"));
}

#[test]
fn a_rate_is_an_exact_fraction() {
    for (text, fraction) in [
        ("1 kHz", (1000, 1)),
        ("1125 Hz", (1125, 1)),
        ("1.125kHz", (1125, 1)),
        ("400/3 Hz", (400, 3)),
        ("800/6 Hz", (400, 3)),
        ("133.333 Hz", (133_333, 1000)),
        ("0.5 Hz", (1, 2)),
        ("1 MHz", (1_000_000, 1)),
        ("1e6 Hz", (1_000_000, 1)),
        ("1e-9 Hz", (1, 1_000_000_000)),
        ("60 /min", (1, 1)),
        ("1/3 /s", (1, 3)),
    ] {
        assert_eq!(rate(text), Ok(fraction), "{text}");
    }
    for (text, message) in [
        ("2.5 ms", "`2.5 ms` is a time, but a rate is required: write \"400 Hz\""),
        ("3 ms", "write \"1000/3 Hz\""),
        ("0 s", "is a time, but a rate"),
        ("100", "`100` has no unit: write \"100 Hz\" or \"100 kHz\""),
        ("60 rpm", "is an angular rate, but a rate is required"),
        ("0 Hz", "is not above zero"),
        ("-5 Hz", "is not above zero"),
        ("1.000001 MHz", "is above 1 MHz"),
        ("1e300 Hz", "is above 1 MHz"),
        ("133.3333333333 Hz", "write a fraction, such as \"400/3 Hz\""),
        ("1e-300 Hz", "too many digits"),
        ("[1, 2, 3] Hz", "is a vector, but a rate with one value"),
    ] {
        let said = rate(text).unwrap_err().to_string();
        assert!(said.contains(message), "{text}: {said}");
    }
}

#[test]
fn a_duration_is_exact_to_the_nanosecond() {
    for (text, nanoseconds) in [
        ("5 s", 5_000_000_000),
        ("5s", 5_000_000_000),
        ("0.1 s", 100_000_000),
        ("0.3 s", 300_000_000),
        ("1.5 min", 90_000_000_000),
        ("1h", 3_600_000_000_000),
        ("1 day", 86_400_000_000_000),
        ("2.5 µs", 2500),
        ("0.4 ns", 0),
        ("0.5 ns", 1),
        ("-0.5 ns", -1),
        ("1.499999999 ns", 1),
        ("-3 ms", -3_000_000),
        ("1/3 s", 333_333_333),
        ("9223372036.854775807 s", i64::MAX),
        ("9223372036854775807 ns", i64::MAX),
        // Too many digits for a fraction of whole numbers, not for a double-double.
        ("0.10000000000000000000000000000000000000000000000001 s", 100_000_000),
        ("1e-200 s", 0),
    ] {
        assert_eq!(duration_ns(text, Sign::Any), Ok(nanoseconds), "{text}");
    }
    for (text, sign, message) in [
        ("-1 s", Sign::NonNegative, "is negative, but a time here must be 0 or above"),
        ("0 s", Sign::Positive, "is not above zero"),
        ("5", Sign::Any, "has no unit"),
        ("5 Hz", Sign::Any, "is a frequency, but a time is required"),
        ("9223372036854775808 ns", Sign::Any, "292 years"),
        ("1e30 s", Sign::Any, "292 years"),
        ("[1, 2, 3] s", Sign::Any, "is a vector"),
    ] {
        let said = duration_ns(text, sign).unwrap_err().to_string();
        assert!(said.contains(message), "{text}: {said}");
    }
}

#[test]
fn a_resolution_may_be_given_either_way_up_or_in_bits() {
    let step = |kind: Kind, text| match kind.resolution(text) {
        Ok(Resolution::Step(step)) => step.to_f64(),
        other => panic!("{text}: {other:?}"),
    };
    let near = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 4e-16, "{a} for {b}");
    near(step(Kind::GYRO_RESOLUTION, "131 LSB/(deg/s)"), DEG / 131.0);
    near(step(Kind::GYRO_RESOLUTION, "131 LSB/(°/s)"), DEG / 131.0);
    near(step(Kind::GYRO_RESOLUTION, "131 LSB/dps"), DEG / 131.0);
    near(step(Kind::GYRO_RESOLUTION, "8.75 mdps/LSB"), 0.00875 * DEG);
    near(step(Kind::GYRO_RESOLUTION, "8.75 mdps/digit"), 0.00875 * DEG);
    near(step(Kind::GYRO_RESOLUTION, "8.75 mdps"), 0.00875 * DEG);
    near(step(Kind::ACCEL_RESOLUTION, "16384 LSB/g"), G / 16384.0);
    near(step(Kind::ACCEL_RESOLUTION, "0.061 mg/LSB"), 0.061e-3 * G);
    near(step(Kind::MAG_RESOLUTION, "0.15 µT/LSB"), 0.15);
    near(step(Kind::MAG_RESOLUTION, "1000 count/G"), 0.1);
    assert_eq!(Kind::GYRO_RESOLUTION.resolution("16 bit"), Ok(Resolution::Bits(16)));
    assert_eq!(Kind::MAG_RESOLUTION.resolution("14bits"), Ok(Resolution::Bits(14)));
    for (text, message) in [
        ("131 LSB/deg/s", "is in "),
        ("131", "\"131 LSB/(deg/s)\" or \"131 bit\""),
        ("0 LSB/(deg/s)", "is not above zero"),
        ("1e-310 LSB/(rad/s)", "too large a step"),
        ("15.5 bit", "is not a whole number of bits"),
        ("65 bit", "from 1 to 64"),
        ("2048 LSB/g", "is an accelerometer resolution, but a gyro resolution is required"),
        ("[1, 1, 1] dps", "is a vector"),
    ] {
        let said = Kind::GYRO_RESOLUTION.resolution(text).unwrap_err().to_string();
        assert!(said.contains(message), "{text}: {said}");
    }
}

#[test]
fn a_unit_alone_is_read_for_columns() {
    assert_eq!(Kind::ANGULAR_RATE.unit("deg/s"), Ok(Double::PI_OVER_180));
    assert_eq!(Kind::ANGULAR_RATE.unit(" rad/s "), Ok(Double::ONE));
    let said = Kind::ANGULAR_RATE.unit("deg").unwrap_err().to_string();
    assert_eq!(said, "`deg` is an angle, but an angular rate is required, such as `rad/s` or `deg/s`");
    assert!(Kind::ANGULAR_RATE.unit("").is_err());
    assert!(Kind::ANGULAR_RATE.unit("5 deg/s").is_err());
}

#[test]
fn every_kind_reads_its_own_example_and_units() {
    for kind in Kind::ALL {
        let example = kind.quantity(kind.example());
        assert!(example.is_ok(), "{}: {example:?}", kind.name());
        for unit in kind.units() {
            assert!(kind.unit(unit).is_ok(), "{}: {unit}", kind.name());
        }
        let inside = kind.unit(kind.units()[0]).unwrap();
        let scaled = matches!(kind.name(), "ratio" | "ratio per kelvin");
        assert!(scaled || inside == Double::ONE, "{}", kind.name());
    }
}

#[test]
fn a_dimension_is_shown_in_a_form_that_reads_back() {
    for (unit, shown) in [
        ("deg", "rad"),
        ("deg/s/√Hz", "rad/√s"),
        ("deg/s/√s", "rad/s/√s"),
        ("m/s^2", "m/s^2"),
        ("kHz", "Hz"),
        ("√Hz", "√Hz"),
        ("/min^2", "Hz^2"),
        ("/m", "m^-1"),
        ("uT*√s*s", "uT*s*√s"),
        ("LSB/(deg/s)", "LSB*s/rad"),
        ("LSB/g", "LSB*s^2/m"),
        ("%", ""),
    ] {
        let read = Quantity::parse(&format!("1 {unit}")).unwrap().dimension;
        assert_eq!(read.to_string(), shown, "{unit}");
        let again = Quantity::parse(&format!("1 {shown}")).unwrap().dimension;
        assert_eq!(again, read, "{unit}");
    }
}

#[test]
fn text_is_as_short_as_it_can_be() {
    for (value, unit, text) in [
        (0.1, "rad/s", "0.1 rad/s"),
        (-4.0, "rad/s", "-4 rad/s"),
        (1e-7, "rad/s", "1e-7 rad/s"),
        (20.0 * DEG, "deg/s", "20 deg/s"),
        (0.01 * DEG, "deg/s/√Hz", "0.01 deg/s/√Hz"),
        (-PI, "deg", "-180 deg"),
        (G, "g", "1 g"),
        (0.5, "ms", "500 ms"),
        (-0.0, "deg", "-0 deg"),
        (0.03, "%", "3 %"),
        (0.03, "", "0.03"),
        (5.0, "furlong", "5 furlong"),
        (5e-324, "deg", "5e-324 rad"),
        (f64::INFINITY, "rad", "inf rad"),
    ] {
        assert_eq!(text_scalar(value, unit), text);
    }
    assert_eq!(text_vector([0.0, 0.5 * DEG, -2.0 * DEG], "deg/s"), "[0, 0.5, -2] deg/s");
    assert_eq!(text_vector([0.0, 5e-324, 1.0], "deg"), "[0, 5e-324, 1] rad");
    assert_eq!(text_vector([1.0, 2.5, -3e20], "uT"), "[1, 2.5, -3e20] uT");
}

const SPELLINGS: [(&str, Kind); 12] = [
    ("rad/s", Kind::ANGULAR_RATE),
    ("deg/s", Kind::ANGULAR_RATE),
    ("rpm", Kind::ANGULAR_RATE),
    ("mg", Kind::ACCELERATION),
    ("uT", Kind::FIELD),
    ("nT", Kind::FIELD),
    ("deg/√h", Kind::ANGLE_RANDOM_WALK),
    ("µg/√Hz", Kind::ACCEL_DENSITY),
    ("deg^2/s^2", Kind::GYRO_VARIANCE),
    ("%", Kind::RATIO),
    ("", Kind::RATIO),
    ("km/h", Kind::SPEED),
];

fn finite() -> impl Strategy<Value = f64> {
    let ordinary = (-1e3_f64..1e3, -12_i32..6).prop_map(|(m, e)| m * 10_f64.powi(e));
    prop_oneof![any::<f64>().prop_filter("finite", |value| value.is_finite()), ordinary]
}

proptest! {
    #[test]
    fn a_written_number_reads_back_to_the_same_bits(value in finite(), which in 0..SPELLINGS.len()) {
        let (unit, kind) = SPELLINGS[which];
        let kind = kind.signed(Sign::Any);
        let text = text_scalar(value, unit);
        let read = kind.scalar(&text);
        prop_assert_eq!(read.clone().map(|d| d.to_f64().to_bits()), Ok(value.to_bits()), "{}", text);
    }

    #[test]
    fn a_short_decimal_is_written_as_it_was_read(
        digits in 1_u32..100_000,
        power in -12_i32..8,
        which in 0..SPELLINGS.len(),
    ) {
        let (unit, kind) = SPELLINGS[which];
        let value = kind.scalar(&format!("{digits}e{power} {unit}")).unwrap();
        let text = text_scalar(value.to_f64(), unit);
        let number: f64 = text.split(' ').next().unwrap().parse().unwrap();
        prop_assert_eq!(number, format!("{digits}e{power}").parse::<f64>().unwrap(), "{}", text);
    }

    #[test]
    fn a_written_vector_reads_back_to_the_same_bits(
        values in [finite(), finite(), finite()],
        which in 0..SPELLINGS.len(),
    ) {
        let (unit, kind) = SPELLINGS[which];
        let text = text_vector(values, unit);
        let read = kind.signed(Sign::Any).vector(&text);
        let bits = |v: [f64; 3]| v.map(f64::to_bits);
        prop_assert_eq!(read.map(|v| bits(v.map(Double::to_f64))), Ok(bits(values)), "{}", text);
    }

    #[test]
    fn no_text_panics_and_every_error_points_into_it(
        text in prop_oneof![
            any::<String>(),
            "[-−+0-9./eE,\\[\\] ]{0,8}[a-zA-Zµμ°√%²³⁻¹*/^() ·0-9]{0,16}",
            "[0-9]{1,3}(\\.[0-9]{1,40})?(e[-−]?[0-9]{1,3})? ?((deg|rad|s|√Hz|h|g|uT|LSB|\\(|\\)|/|\\*|\\^[0-9]|²|rt)){0,9}",
        ],
    ) {
        let check = |error: &QuantityError| {
            let span = error.span();
            text.get(span).is_some() && !error.to_string().is_empty()
        };
        for kind in Kind::ALL {
            if let Err(error) = kind.vector(&text) {
                prop_assert!(check(&error), "{:?}", error);
            }
        }
        prop_assert!(Quantity::parse(&text).err().is_none_or(|error| check(&error)));
        prop_assert!(Kind::ANGLE.unit(&text).err().is_none_or(|error| check(&error)));
        prop_assert!(Kind::GYRO_RESOLUTION.resolution(&text).err().is_none_or(|error| check(&error)));
        prop_assert!(rate(&text).err().is_none_or(|error| check(&error)));
        prop_assert!(duration_ns(&text, Sign::Any).err().is_none_or(|error| check(&error)));
    }

    #[test]
    fn a_duration_agrees_with_its_decimal(seconds in -9_000_000_000_i64..9_000_000_000, part in 0..1_000_000_000_i64) {
        let sign = if seconds < 0 { -1 } else { 1 };
        let text = format!("{seconds}.{part:09} s");
        prop_assert_eq!(duration_ns(&text, Sign::Any), Ok(seconds * 1_000_000_000 + sign * part));
    }

    #[test]
    fn a_rate_agrees_with_its_fraction(numerator in 1_u64..1_000_000, denominator in 1_u64..1_000_000) {
        let (a, b) = rate(&format!("{numerator}/{denominator} Hz")).unwrap();
        prop_assert_eq!(a * denominator, b * numerator);
        prop_assert!((1..=b).filter(|d| *d > 1 && *d < 2000).all(|d| a % d != 0 || b % d != 0));
    }
}
