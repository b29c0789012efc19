//! `ratetable timing` as its users run it: what the report says is what `timing.csv` holds, and nothing goes missing
//! unsaid. No figure of time is judged here: machines differ.

use serde_json::Value;
use std::collections::BTreeMap;
use std::process::{Command, Output};

fn ratetable(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_ratetable")).args(arguments).output().unwrap()
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// A line of `timing.csv`.
#[derive(Clone, Copy, Debug)]
struct Line {
    k: i64,
    due: i64,
    sent: Option<i64>,
    received: Option<i64>,
}

/// The lines by sensor, in order of k.
fn lines(text: &str) -> BTreeMap<String, Vec<Line>> {
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some("sensor,k,due_ns,sent_ns,received_ns"));
    let mut found = BTreeMap::<String, Vec<Line>>::new();
    for line in lines {
        let cells: Vec<_> = line.split(',').collect();
        let number = |i: usize| cells[i].parse::<i64>().ok();
        let line =
            Line { k: number(1).unwrap(), due: number(2).unwrap(), sent: number(3), received: number(4) };
        found.entry(cells[0].to_string()).or_default().push(line);
    }
    found.values_mut().for_each(|lines| lines.sort_by_key(|line| line.k));
    found
}

/// The value that a share of the values does not exceed, as a report's percentiles are.
fn quantile(values: &mut [i64], share: f64) -> f64 {
    values.sort();
    let rank = (share * values.len() as f64).ceil() as usize;
    values[rank.clamp(1, values.len()) - 1] as f64 / 1000.0
}

/// Within what the histogram tells apart.
fn same(reported: &Value, computed: f64, what: &str) {
    let reported = reported.as_f64().unwrap_or_else(|| panic!("{what} is no number: {reported}"));
    assert!((reported - computed).abs() <= 1e-3 * computed.abs() + 1e-3, "{what}: {reported} for {computed}");
}

/// (n − 1)/(t_last − t_first) over stretches in which due times go on as ticks do, Hz.
fn rate(lines: &[Line], hz: f64, time: impl Fn(&Line) -> Option<i64>) -> f64 {
    let period = (1e9 / hz) as i64;
    let (mut count, mut span) = (0, 0);
    for pair in lines.windows(2) {
        let goes_on = pair[1].due - pair[0].due < 3 * period / 2 && pair[1].k == pair[0].k + 1;
        if let (true, Some(before), Some(after)) = (goes_on, time(&pair[0]), time(&pair[1])) {
            count += 1;
            span += after - before;
        }
    }
    f64::from(count) / (span as f64 * 1e-9)
}

#[test]
fn everything_in_the_report_can_be_computed_again_from_its_lines() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("timing");
    let output = ratetable(&["timing", "--for", "2s", "--json", "--out", out.to_str().unwrap()]);
    let report: Value =
        serde_json::from_slice(&output.stdout).unwrap_or_else(|_| panic!("{}", said(&output)));
    let text = std::fs::read_to_string(out.join("timing.csv")).unwrap();
    let lines = lines(&text);
    assert_eq!(report["received_by"], "a reader on the pty");
    assert_eq!(report["unrecorded"], 0);
    for (sensor, hz, made) in [("gyro", 1000.0, 2000), ("accel", 1000.0, 2000), ("mag", 100.0, 200)] {
        let of = report["sensors"].as_array().unwrap().iter().find(|found| found["name"] == sensor).unwrap();
        let count = |name: &str| of[name].as_u64().unwrap_or_else(|| panic!("{sensor}.{name}: {of}"));
        assert_eq!(count("made"), made);
        assert_eq!(count("made"), count("sent") + count("dropped") + count("queued"));
        let lines = &lines[sensor];
        let ks: Vec<_> = lines.iter().map(|line| line.k).collect();
        assert_eq!(ks, (0..made as i64).collect::<Vec<_>>(), "every sample has its line");
        assert_eq!(lines.iter().filter(|line| line.sent.is_some()).count() as u64, count("sent"));
        assert_eq!(lines.iter().filter(|line| line.received.is_some()).count() as u64, count("received"));
        assert_eq!(count("received") + count("missed"), made);
        let mut late: Vec<_> = lines.iter().filter_map(|line| Some(line.sent? - line.due)).collect();
        assert!(late.iter().all(|&late| late >= 0), "nothing is early");
        let overdue = late.iter().filter(|&&late| late > (1e9 / hz) as i64).count() as u64;
        assert_eq!(count("overdue"), overdue);
        let mut transit: Vec<_> = lines.iter().filter_map(|line| Some(line.received? - line.sent?)).collect();
        assert!(transit.iter().all(|&transit| transit > 0), "nothing arrives before it is sent");
        for (name, share) in [("p50", 0.5), ("p99", 0.99), ("max", 1.0)] {
            same(&of["late_us"][name], quantile(&mut late, share), &format!("{sensor} late {name}"));
            same(&of["transit_us"][name], quantile(&mut transit, share), &format!("{sensor} transit {name}"));
        }
        if count("dropped") == 0 {
            let sent_hz = rate(lines, hz, |line| line.sent);
            assert!((of["sent_hz"].as_f64().unwrap() / sent_hz - 1.0).abs() < 1e-9);
            let ppm = (sent_hz / hz - 1.0) * 1e6;
            assert!((of["sent_ppm"].as_f64().unwrap() - ppm).abs() < 1e-2);
        }
        if count("missed") == 0 {
            let received_hz = rate(lines, hz, |line| line.received);
            assert!((of["received_hz"].as_f64().unwrap() / received_hz - 1.0).abs() < 1e-9);
        }
    }
    // Slices of 0.5, 1 and 1 s come before those of the stream.
    let mut bare: Vec<_> = lines["baseline"].iter().map(|line| line.sent.unwrap() - line.due).collect();
    assert_eq!((bare.len(), &report["baseline"]["wakes"]), (2500, &Value::from(2500)));
    let p99 = quantile(&mut bare, 0.99);
    same(&report["baseline"]["late_us"]["p99"], p99, "baseline p99");
    let mut gyro: Vec<_> = lines["gyro"].iter().filter_map(|line| Some(line.sent? - line.due)).collect();
    let ratio = quantile(&mut gyro, 0.99) / p99;
    assert!((report["ratio_p99"].as_f64().unwrap() / ratio - 1.0).abs() < 3e-3);
    let written: Value = serde_json::from_slice(&std::fs::read(out.join("report.json")).unwrap()).unwrap();
    assert_eq!(written, report);
    let picture = std::fs::read_to_string(out.join("timing.svg")).unwrap();
    assert!(picture.contains("bare timer") && picture.contains("Lateness over time"));
    let lost = report["sensors"].as_array().unwrap().iter().any(|sensor| sensor["missed"] != 0);
    assert_eq!(output.status.code(), Some(i32::from(lost)), "{}", said(&output));
}

#[test]
fn the_host_and_the_pacing_thread_are_in_the_report() {
    let output = ratetable(&["timing", "--for", "100ms", "--json"]);
    let report: Value =
        serde_json::from_slice(&output.stdout).unwrap_or_else(|_| panic!("{}", said(&output)));
    let host = &report["host"];
    let spin = host["spin_us"].as_f64().unwrap();
    assert!((15.0..=80.0).contains(&spin), "{spin}");
    let share = host["pacing_cpu"].as_f64().unwrap();
    assert!(share > 0.0 && share <= 1.0, "{share}");
}

#[test]
fn a_limit_that_is_broken_is_exit_code_1_and_says_how() {
    let output = ratetable(&["timing", "--for", "100ms", "--limit", "baseline.wakes<1"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(said(&output).contains("FAILED: baseline.wakes = 500 >= 1"), "{}", said(&output));
}

#[test]
fn over_a_link_without_a_reader_of_ours_the_sending_end_is_measured_and_the_report_says_so() {
    let output = ratetable(&["timing", "--for", "100ms", "--to", "csv@file:/dev/null", "--json"]);
    let report: Value =
        serde_json::from_slice(&output.stdout).unwrap_or_else(|_| panic!("{}", said(&output)));
    assert_eq!(report["received_by"], Value::Null);
    let gyro = &report["sensors"][0];
    assert_eq!(
        (&gyro["sent"], &gyro["received"], &gyro["missed"]),
        (&Value::from(100), &Value::Null, &Value::Null)
    );
    assert!(said(&output).contains("the sending end alone"), "{}", said(&output));
    assert_eq!(output.status.code(), Some(0));
}

/// A port whose TX is connected to its RX, or not: the slave of a pty whose master gives back what it is given.
fn port(plug: bool) -> (String, std::thread::JoinHandle<()>) {
    use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
    let master = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY).unwrap();
    grantpt(&master).unwrap();
    unlockpt(&master).unwrap();
    let path = ptsname(&master, Vec::new()).unwrap().into_string().unwrap();
    let slave = std::fs::File::open(&path).unwrap();
    let echo = move || {
        let mut bytes = [0; 4096];
        // The last packets are given back before the slave closes, and then reading fails.
        drop_when_opened(slave);
        while let Ok(count @ 1..) = rustix::io::read(&master, &mut bytes) {
            if plug {
                rustix::io::write(&master, &bytes[..count]).unwrap();
            }
        }
    };
    (path, std::thread::spawn(echo))
}

/// Keeps the slave open until somebody else has had the time to open it.
fn drop_when_opened(slave: std::fs::File) {
    std::thread::spawn(move || {
        std::thread::sleep(std::time::Duration::from_secs(3));
        drop(slave);
    });
}

#[test]
fn a_loopback_plug_brings_the_stream_back_and_its_absence_is_no_loss() {
    for plug in [true, false] {
        let (path, echo) = port(plug);
        let to = format!("mpu@serial:{path},921600");
        let output = ratetable(&["timing", "--for", "200ms", "--to", &to, "--json"]);
        let report: Value =
            serde_json::from_slice(&output.stdout).unwrap_or_else(|_| panic!("{}", said(&output)));
        let gyro = &report["sensors"][0];
        assert_eq!(gyro["sent"], 200);
        if plug {
            assert_eq!(report["received_by"], "the port itself, through a loopback plug");
            assert!(gyro["received"].as_u64().unwrap() > 0, "{gyro}");
            assert_eq!(gyro["received"].as_u64().unwrap() + gyro["missed"].as_u64().unwrap(), 200);
            assert!(gyro["transit_us"]["p50"].as_f64().unwrap() > 0.0);
        } else {
            assert_eq!((&report["received_by"], &gyro["missed"]), (&Value::Null, &Value::Null));
            assert_eq!(output.status.code(), Some(0), "{}", said(&output));
        }
        echo.join().unwrap();
    }
}

#[test]
fn what_cannot_be_measured_says_what_would_be_right() {
    let folder = tempfile::tempdir().unwrap();
    let full = folder.path().join("full");
    std::fs::create_dir(&full).unwrap();
    std::fs::write(full.join("precious"), "").unwrap();
    let two = folder.path().join("two.toml");
    std::fs::write(
        &two,
        "duration = \"1 s\"\n[gyro]\nrate = \"1 kHz\"\n[[output]]\nto = \"mpu@pty\"\n[[output]]\nto = \"csv@file:/tmp/x\"\n",
    )
    .unwrap();
    for (arguments, says) in [
        (vec!["timing", "stil"], "still"),
        (vec!["timing", "--to", "mpu"], "mpu"),
        (vec!["timing", "--to", "csv@-", "--json"], "leave out one"),
        (vec!["timing", "--limit", "ratio<1"], "`ratio` does not exist"),
        (vec!["timing", "--cpu", "9999"], "can use only processors"),
        (vec!["timing", "--for", "10"], "unit"),
        (vec!["timing", "--out", full.to_str().unwrap()], "--force"),
        (vec!["timing", two.to_str().unwrap()], "one link, and the scene has 2"),
    ] {
        let output = ratetable(&arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(said(&output).contains(says), "{arguments:?}: {}", said(&output));
    }
}
