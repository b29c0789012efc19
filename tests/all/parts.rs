//! Every line of every datasheet, measured on the emulated part, and `docs/parts.md`, which says so.
//!
//! `RATETABLE_WRITE=1 cargo test --test all parts::` writes the page.

mod bench;
mod document;
mod sheet;

use document::Line;
use ratetable::sensor::{SensorKind, parts};
use std::fs;

const PAGE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/parts.md");

#[test]
fn every_line_of_every_datasheet_is_met_and_the_page_says_so() {
    let all = document::all();
    let wrong: Vec<String> = all
        .iter()
        .flat_map(|(part, lines)| lines.iter().map(move |line| (part.names[0], line)))
        .filter_map(|(part, line)| {
            let wrong = line.wrong.as_ref()?;
            Some(format!(
                "{part} {} {}: {} should be {}: {wrong}",
                line.kind, line.what, line.sheet, line.bound
            ))
        })
        .collect();
    assert!(wrong.is_empty(), "\n{}\n", wrong.join("\n"));
    let unmeasured: Vec<_> = all.iter().flat_map(|(part, lines)| document::unmeasured(part, lines)).collect();
    assert_eq!(unmeasured, [""; 0], "keys of a part's file without a line");
    let page = document::page(&all);
    if std::env::var_os("RATETABLE_WRITE").is_some() {
        fs::write(PAGE, &page).expect("docs/parts.md written");
    }
    let committed = fs::read_to_string(PAGE).unwrap_or_default();
    assert!(
        committed == page,
        "docs/parts.md is not what was measured: RATETABLE_WRITE=1 cargo test --test all parts::"
    );
}

fn measured(part: &str, kind: SensorKind, doctored: f64, more: &str) -> Vec<Line> {
    document::lines(parts::find(part, kind).expect("a part"), kind, doctored, more)
}

/// Negative controls: each line of a sheet that is a fifth off fails, in either direction.
#[test]
fn a_sheet_that_is_a_fifth_off_fails_on_every_line() {
    for (part, kind) in
        [("MPU-6050", SensorKind::Gyro), ("ADIS16470", SensorKind::Accel), ("LSM9DS1", SensorKind::Mag)]
    {
        for doctored in [0.8, 1.2] {
            let lines = measured(part, kind, doctored, "");
            let of_sheet = lines.iter().filter(|line| !line.what.starts_with("filter"));
            let passed: Vec<_> = of_sheet.filter(|line| line.wrong.is_none()).collect();
            assert!(passed.is_empty(), "{part} {kind} by {doctored}: {passed:?}");
        }
    }
}

/// And a part with one value doctored fails on the line of that value alone.
#[test]
fn a_part_with_one_value_doctored_fails_on_its_line() {
    for (more, fails) in [
        ("noise_density = \"0.012 deg/s/√Hz\"", "noise density"),
        ("bias = { uniform = [\"-6 deg/s\", \"6 deg/s\"] }", "zero offset"),
        ("bias = { uniform = [\"-4 deg/s\", \"4 deg/s\"] }", "zero offset"),
        ("bias = { uniform = [\"-2 deg/s\", \"5 deg/s\"] }", "zero offset"),
        ("scale_error = { uniform = [\"-3.6 %\", \"3.6 %\"] }", "scale error"),
        ("misalignment = { uniform = [\"-0.016 rad\", \"0.016 rad\"] }", "cross-axis sensitivity"),
        ("nonlinearity = { uniform = [\"-0.12 %\", \"0.12 %\"] }", "non-linearity"),
        (
            "bias_temperature = { uniform = [\"-0.37 deg/s/K\", \"0.37 deg/s/K\"] }",
            "zero offset by temperature",
        ),
        ("scale_temperature = { uniform = [\"-738 ppm/K\", \"738 ppm/K\"] }", "scale error by temperature"),
        ("resolution = \"16 LSB/(deg/s)\"", "full scale and counts"),
    ] {
        let lines = measured("MPU-9250", SensorKind::Gyro, 1.0, more);
        let mut failing: Vec<_> =
            lines.iter().filter(|line| line.wrong.is_some()).map(|line| line.what.as_str()).collect();
        failing.dedup();
        assert_eq!(failing, [fails], "{more}");
    }
}
