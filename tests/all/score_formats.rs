//! `ratetable score` on datasets without CSV: the same figures from every format, and a reason where there are none.

#![cfg(all(feature = "parquet", feature = "mcap"))]

use ratetable::dataset::read::{self, RecordedTruth};
use ratetable::sensor::SensorKind;
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn ratetable(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_ratetable")).args(arguments).output().unwrap()
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// A dataset in these formats, of gyro and accel at rates of their own or at the same one, with a magnetometer.
fn flight(home: &Path, formats: &str, accel: &str, axes: &str) -> PathBuf {
    let scene = home.join("scene.toml");
    fs::write(
        &scene,
        format!(
            "axes = \"{axes}\"\nduration = \"3 s\"\n[[motion]]\nkind = \"cone\"\nhalf_angle = \"20 deg\"\nfrequency = \"0.3 Hz\"\nduration = \"3 s\"\n\
             [gyro]\nrate = \"400 Hz\"\nnoise_std = \"0.1 deg/s\"\n[accel]\nrate = \"{accel}\"\nnoise_std = \"5 mg\"\n\
             [mag]\nrate = \"100 Hz\"\nnoise_std = \"0.2 uT\"\n"
        ),
    )
    .unwrap();
    let dir = home.join(formats.replace(',', "-"));
    let output = ratetable(&[
        "generate",
        scene.to_str().unwrap(),
        "--out",
        dir.to_str().unwrap(),
        "--force",
        "--format",
        formats,
    ]);
    assert!(output.status.success(), "{}", said(&output));
    assert_eq!(dir.join("truth.csv").exists(), formats.contains("csv"));
    dir
}

fn score(dir: &Path, more: &[&str]) -> (Value, String, Option<i32>) {
    let output = ratetable(&[&["score", dir.to_str().unwrap(), "--json"], more].concat());
    (serde_json::from_slice(&output.stdout).unwrap_or(Value::Null), said(&output), output.status.code())
}

/// Attitudes and readings are the same to the last bit, but for the field where it went through teslas.
fn same(a: &Path, b: &Path, exactly: bool) {
    let [one, other]: [RecordedTruth; 2] = [a, b].map(|dir| read::truth(dir).unwrap());
    assert_eq!(one, other, "{}", b.display());
    assert!(one.attitudes.len() > 1000);
    for kind in SensorKind::TRIADS {
        let [one, other] = [a, b].map(|dir| read::readings(dir, kind).unwrap());
        if kind != SensorKind::Mag || exactly {
            assert_eq!(one, other, "{kind} of {}", b.display());
        }
        assert_eq!(one.len(), other.len());
        for ((t, value), (other_t, other)) in one.iter().zip(&other) {
            assert_eq!(t, other_t);
            assert!((*value - *other).length() <= 1e-15 * value.length(), "{kind} at {t}");
        }
    }
}

#[test]
fn every_format_gives_the_truth_the_readings_and_the_figures_of_csv() {
    for (accel, axes) in [("400 Hz", "ned-frd"), ("160 Hz", "enu-flu")] {
        let home = tempfile::tempdir().unwrap();
        let csv = flight(home.path(), "csv", accel, axes);
        let filters = ["vqf", "mahony-6d"];
        let (expected, told, code) = score(&csv, &filters);
        assert_eq!(code, Some(0), "{told}");
        for format in ["npy", "mat", "parquet", "mcap", "mcap,tum", "csv,npy"] {
            let dir = flight(home.path(), format, accel, axes);
            same(&csv, &dir, !format.contains("mcap"));
            let (report, told, code) = score(&dir, &filters);
            assert_eq!(code, Some(0), "{format}: {told}");
            for (i, filter) in filters.iter().enumerate() {
                for field in ["rms_deg", "max_deg", "inclination_rms_deg", "heading_rms_deg", "samples"] {
                    let [one, other] = [&expected, &report].map(|report| {
                        report["estimates"][i][field].as_f64().unwrap_or_else(|| panic!("{report}"))
                    });
                    assert!(
                        (one - other).abs() <= 1e-9 * one.abs(),
                        "{format} {filter} {field}: {other} of {one}"
                    );
                }
            }
        }
        // Negative control: another dataset is not the same.
        let other = flight(home.path(), "npy", if accel == "400 Hz" { "200 Hz" } else { "400 Hz" }, axes);
        assert_ne!(
            read::readings(&csv, SensorKind::Accel).unwrap(),
            read::readings(&other, SensorKind::Accel).unwrap()
        );
    }
}

#[test]
fn an_estimate_is_scored_on_any_format_and_a_filter_is_refused_where_there_are_attitudes_alone() {
    let home = tempfile::tempdir().unwrap();
    let csv = flight(home.path(), "csv", "400 Hz", "ned-frd");
    let truth = fs::read_to_string(csv.join("truth.csv")).unwrap();
    let mine: Vec<&str> = truth.lines().step_by(4).collect();
    let mine_path = home.path().join("mine.csv");
    fs::write(&mine_path, [truth.lines().next().unwrap(), &mine[1..].join("\n")].join("\n")).unwrap();
    let mine = mine_path.to_str().unwrap();
    for format in ["npy", "mat", "parquet", "mcap", "tum"] {
        let dir = flight(home.path(), format, "400 Hz", "ned-frd");
        let (report, told, code) = score(&dir, &[mine]);
        assert_eq!(code, Some(0), "{format}: {told}");
        let rms = report["estimates"][0]["rms_deg"].as_f64().unwrap();
        assert!(rms < 1e-6, "{format}: {rms}");
    }
    let tum = home.path().join("tum");
    let (_, told, code) = score(&tum, &["vqf"]);
    assert!(code == Some(2) && told.contains("only attitudes") && told.contains("--format"), "{told}");
}

#[test]
fn a_file_that_is_cut_or_changed_is_one_message() {
    let home = tempfile::tempdir().unwrap();
    for format in ["npy", "mat", "parquet", "mcap", "tum"] {
        let dir = flight(home.path(), format, "400 Hz", "ned-frd");
        let name = if format == "mcap" { "dataset.mcap".into() } else { format!("truth.{format}") };
        let file = dir.join(&name);
        let bytes = fs::read(&file).unwrap();
        let mut spoilt = vec![bytes[..bytes.len() * 2 / 3 + 3].to_vec(), Vec::new(), vec![0x55; 200]];
        if format == "tum" {
            // A trajectory that ends early is one all the same.
            spoilt = vec![[&bytes[..], b"1 2 3\n"].concat(), vec![0x55; 200]];
        }
        for bytes in spoilt {
            fs::write(&file, &bytes).unwrap();
            let (_, told, code) = score(&dir, &["vqf"]);
            assert!(code == Some(2) && told.contains(&name), "{format}, {} bytes: {told}", bytes.len());
        }
        fs::write(&file, &bytes).unwrap();
        fs::remove_file(dir.join("manifest.json")).unwrap();
        let (_, told, code) = score(&dir, &["vqf"]);
        assert!(code == Some(2) && told.contains("manifest.json"), "{format}: {told}");
    }
}
