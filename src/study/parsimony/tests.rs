use super::parts::{What, parts};
use super::*;
use crate::motion::Wants;
use crate::player::{BLOCK, Player};
use crate::sensor::SensorKind;
use std::collections::BTreeSet;

/// Turns about every axis for a while.
const MOTION: &str = "[[motion]]\nkind = \"hold\"\nduration = \"1 s\"\n\
     [[motion]]\nkind = \"rotate\"\nangular_rate = \"[30, -40, 50] deg/s\"\nduration = \"3 s\"\n";

fn plan(sensors: &str) -> Plan {
    Plan::parse(&format!("seed = 4\n{MOTION}{sensors}"), "test", "test", &[])
        .unwrap_or_else(|e| panic!("{e}"))
}

/// Of a clock that stands still: costs are zero.
fn study(plan: &Plan, seeds: u64) -> Parsimony {
    let effort = Effort { seeds, seconds: 60, rounds: 1, ticks: 100 };
    run(plan, effort, 2, &|| Duration::ZERO, &|_, _| ()).unwrap_or_else(|error| panic!("{error}"))
}

fn row<'f>(found: &'f Parsimony, sensor: &str, term: &str) -> &'f Row {
    let is_it = |row: &&Row| row.sensor == sensor && row.term == term;
    found.rows.iter().find(is_it).unwrap_or_else(|| panic!("no {term} of {sensor}: {:?}", found.rows))
}

/// What each sensor of a plan reads, column by column.
type Heard = Vec<(Vec<Vec<u64>>, Vec<bool>)>;

/// All readings of a plan, bit for bit.
fn readings(plan: &Plan) -> Heard {
    let mut all: Heard = vec![(vec![Vec::new(); 6], Vec::new()); plan.sensors.len()];
    let mut player = Player::new(plan, plan.duration, BLOCK);
    while let Some(columns) = player.play_columns(Wants::NONE) {
        for ((columns, missing), block) in all.iter_mut().zip(columns.sensors()) {
            for (all, new) in columns.iter_mut().zip(block.reading.iter().chain(&block.velocity)) {
                all.extend(new.iter().map(|x| x.to_bits()));
            }
            missing.extend(&block.missing);
            missing.resize(columns[0].len(), false);
        }
    }
    all
}

#[test]
fn a_bias_of_so_many_counts_changes_readings_by_so_many_counts_and_noises() {
    for counts in [0.25, 3.0, 40.0] {
        let sensors = format!(
            "[gyro]\nrate = \"50 Hz\"\nresolution = \"0.1 deg/s\"\nrange = \"250 deg/s\"\nnoise_std = \"0.2 deg/s\"\n\
             bias = \"[0, {}, 0] deg/s\"\n",
            counts / 10.0
        );
        let found = study(&plan(&sensors), 2);
        let bias = row(&found, "gyro", "bias");
        for (measured, expected) in [
            (bias.rms_counts, counts),
            (bias.largest_counts, counts),
            (bias.rms_of_noise, counts / 2.0),
            (bias.largest_of_noise, counts / 2.0),
        ] {
            let measured = measured.unwrap();
            assert!((measured / expected - 1.0).abs() < 1e-9, "{measured} for {expected}");
        }
        // No filter reads a gyro alone: its readings decide.
        let verdict = if counts < 0.5 { Verdict::BelowResolution } else { Verdict::Needed };
        assert_eq!((bias.verdict, bias.filter.as_deref()), (verdict, None));
    }
}

#[test]
fn rounding_changes_by_half_a_count_at_most_and_noise_by_its_own_size() {
    let found =
        study(&plan("[gyro]\nrate = \"500 Hz\"\nresolution = \"0.1 deg/s\"\nnoise_std = \"0.2 deg/s\"\n"), 2);
    let rounding = row(&found, "gyro", "resolution");
    let most = rounding.largest_counts.unwrap();
    assert!(most <= 0.5 + 1e-6 && most > 0.45, "{most}");
    // Uniform over a count: 1/√12. Of 6000 numbers the RMS is known to about 1 %.
    assert!((rounding.rms_counts.unwrap() * libm::sqrt(12.0) - 1.0).abs() < 0.03, "{rounding:?}");
    let noise = row(&found, "gyro", "white_noise");
    // The largest of three axes of 2000 numbers each: σ/√4000 apart.
    assert!((noise.rms_of_noise.unwrap() - 1.0).abs() < 4.0 / libm::sqrt(4000.0), "{noise:?}");
}

const LARGE: &str = "[gyro]\nrate = \"50 Hz\"\nnoise_std = \"0.1 deg/s\"\nbias = \"[3, 0, -2] deg/s\"\nrange = \"2000 deg/s\"\n\
     [accel]\nrate = \"50 Hz\"\nnoise_std = \"0.01 m/s^2\"\n\
     [mag]\nrate = \"25 Hz\"\nnoise_std = \"0.2 uT\"\nhard_iron = \"[0, 15, 0] uT\"\n";

#[test]
fn a_large_term_is_needed_and_one_of_no_effect_is_not() {
    let found = study(&plan(LARGE), 5);
    for (sensor, term) in [("gyro", "bias"), ("mag", "hard_iron")] {
        let row = row(&found, sensor, term);
        assert!(row.verdict == Verdict::Needed && row.times_noticed.unwrap() > 1.0, "{row:?}");
        let (change, half, margin) = (row.change_deg, row.interval_deg, row.margin_deg);
        assert!(change.unwrap().abs() - half.unwrap() > margin.unwrap(), "{row:?}");
        assert!(found.lean.kept.contains(&format!("{sensor}.{term}")), "{:?}", found.lean);
    }
    let range = row(&found, "gyro", "range");
    // Without counts it is set against the noise alone.
    assert_eq!((range.verdict, range.largest_of_noise), (Verdict::BelowNoise, Some(0.0)));
    assert_eq!((range.times_noticed, range.change_deg), (Some(0.0), Some(0.0)));
    assert!(found.lean.left_out.contains(&"gyro.range".to_string()), "{:?}", found.lean);
    assert!(found.rows.iter().all(|row| row.ns_per_sample == 0.0), "a clock that stands measures nothing");
}

#[test]
fn a_lean_scene_that_is_not_the_same_is_refused_and_gets_its_terms_back_the_largest_first() {
    let plan = plan(LARGE);
    let base = Base::of(&plan).unwrap();
    let part = |sensor, name| Part { sensor: Some(sensor), what: What::Term(name) };
    let wrong = [
        (part(SensorKind::Mag, "hard_iron"), 9.0),
        (part(SensorKind::Gyro, "range"), 0.0),
        (part(SensorKind::Gyro, "bias"), 5.0),
    ];
    let candidate = |(part, margins)| Candidate { part, margins, why: "as claimed".into() };
    let runs = scores::runs(&plan);
    let trials = Trials { runs: &runs, seeds: 0..4, end: plan.duration, threads: 2 };
    let lean = lean::search(&base, &wrong.map(candidate), &trials, &|_, _| ()).unwrap();
    let names: Vec<_> = lean.put_back.iter().map(|(part, _)| part.name()).collect();
    assert_eq!(names, ["hard_iron", "bias"]);
    assert_eq!(lean.left_out, [(part(SensorKind::Gyro, "range"), "as claimed".to_string())]);
    assert!(
        lean.filters.len() == runs.len() && lean.filters.iter().all(|filter| filter.finding == Finding::Same)
    );
}

/// Almost every term on three sensors, and effects of the scene.
const RICH: &str = "[[force]]\nstart = \"1 s\"\nduration = \"1 s\"\nacceleration = \"[0, 1, 0] m/s^2\"\n\
     [[force]]\nstart = \"2 s\"\nduration = \"0.5 s\"\nacceleration = \"[2, 0, 0] m/s^2\"\n\
     [earth]\nwind = \"[3, 1, 0] m/s\"\n\
     [[fault]]\nsensor = \"mag\"\nkind = \"intermittent\"\nstart = \"2 s\"\n\
     [[fault]]\nsensor = \"gyro\"\nkind = \"spike\"\nsize = \"5 deg/s\"\nstart = \"1 s\"\n\
     [[fault]]\nkind = \"drop\"\nshare = \"1 %\"\n\
     [gyro]\npart = \"MPU-9250\"\nrate = \"100 Hz\"\nsampling = \"average\"\nflicker = true\nbias_instability = \"10 deg/h\"\n\
     temperature = { ambient = \"25 degC\", rise = \"12 K\", time_constant = \"6 s\" }\ng_sensitivity = \"0.1 deg/s/g\"\n\
     vibration = { frequency = \"37 Hz\", amplitude = \"2 deg/s\" }\nfilter = \"20 Hz\"\n\
     clock_error = { offset = \"50 ppm\", jitter = \"20 us\" }\n\
     [accel]\npart = \"MPU-9250\"\nrate = \"50 Hz\"\nlever_arm = \"[0.1, 0, 0] m\"\ndelay = \"3 ms\"\n\
     bias_instability = \"1 mg\"\ncorrelation_time = \"9 s\"\nbias_random_walk = \"5 µg/√s\"\n\
     [mag]\npart = \"MPU-9250\"\nrate = \"25 Hz\"\nhard_iron = \"[1, 2, 3] uT\"\nsoft_iron = [[1.02, 0.01, 0], [0.01, 0.98, 0], [0, 0, 1.01]]\n\
     clock_error = \"20 ppm\"\n\
     [airspeed]\nrate = \"10 Hz\"\nnoise_std = \"2 Pa\"\n\
     [gps]\nnoise_std = \"1 m\"\nvelocity_noise_std = \"0.1 m/s\"\n";

#[test]
fn leaving_a_part_out_takes_that_part_and_no_other_out_of_the_scene() {
    let plan = plan(RICH);
    let base = Base::of(&plan).unwrap();
    let all = parts(&plan);
    assert_eq!(parts(&base.whole().plan(0).unwrap()), all, "the study plays the scene");
    assert!(readings(&base.whole().plan(0).unwrap()) == readings(&plan), "bit for bit");
    let names: BTreeSet<String> = all.iter().map(Part::name).collect();
    for name in ["faults", "averaging", "force 1", "force 2", "wind", "clock_error", "flicker", "lever_arm"] {
        assert!(names.contains(name), "{name} in {names:?}");
    }
    for &part in &all {
        let variant = base.without_all(&[part]);
        if part.is_term("range") && part.sensor != Some(SensorKind::Mag) {
            // The datasheet's non-linearity is of full scale.
            assert!(variant.plan(0).is_err(), "{part:?}");
            assert!(readings(&base.without(part).plan(0).unwrap()) == readings(&plan), "its keys stay");
            continue;
        }
        let left = variant.plan(0).unwrap_or_else(|error| panic!("{part:?}: {error}"));
        let goes = |other: &Part| {
            let warmth = part.is_term("temperature") && part.sensor == other.sensor;
            *other == part || warmth && other.name().ends_with("_temperature")
        };
        let rest = match part.what {
            // The forces that stay are counted anew.
            What::Force(_) => all.iter().copied().filter(|other| other.what != What::Force(1)).collect(),
            _ => all.iter().copied().filter(|other| !goes(other)).collect::<Vec<_>>(),
        };
        assert_eq!(parts(&left), rest, "without {part:?}");
        // And no other sensor reads anything else, for its noise streams are its own.
        let others = readings(&left).into_iter().zip(readings(&plan)).zip(&plan.sensors);
        for ((left, whole), sensor) in
            others.filter(|(_, sensor)| part.sensor.is_some_and(|it| it != sensor.kind))
        {
            assert!(left == whole, "without {part:?} {} reads something else", sensor.kind);
        }
    }
}

#[test]
fn leaving_out_by_key_is_leaving_out_of_the_chain() {
    let plan = plan(RICH);
    let base = Base::of(&plan).unwrap();
    let mut compared = 0;
    for part in parts(&plan) {
        let (Some(kind), What::Term(name)) = (part.sensor, part.what) else { continue };
        // These say something to other terms: the range to non-linearity, the low-pass to vibration; a clock's offset
        // is no term.
        if ["range", "filter", "delay", "clock_error"].contains(&name) {
            continue;
        }
        let by_key = base.without(part).plan(0).unwrap();
        let mut player = Player::built(&plan, plan.duration, BLOCK, |sensor| {
            plan.build_without(sensor, if sensor.kind == kind { std::slice::from_ref(&name) } else { &[] })
        });
        let mut keyed = Player::new(&by_key, plan.duration, BLOCK);
        while let (Some(chain), Some(keyed)) =
            (player.play_columns(Wants::NONE), keyed.play_columns(Wants::NONE))
        {
            for (chain, keyed) in chain.sensors().zip(keyed.sensors()) {
                assert!(chain.reading == keyed.reading && chain.velocity == keyed.velocity, "{part:?}");
            }
        }
        compared += 1;
    }
    assert!(compared > 15, "{compared}");
}

#[test]
fn the_lean_scene_parses_has_the_terms_that_were_kept_and_plays_what_was_tested() {
    for sensors in [LARGE, RICH] {
        let plan = plan(sensors);
        let base = Base::of(&plan).unwrap();
        let candidate = |part| Candidate { part, margins: 0.0, why: "a trial".into() };
        // Without filters everything goes that can go together.
        let trials = Trials { runs: &[], seeds: 0..2, end: plan.duration, threads: 1 };
        let every = |odd: usize| parts(&plan).into_iter().enumerate().filter(move |(i, _)| i % 3 != odd);
        for odd in 0..4 {
            let candidates: Vec<_> = every(odd).map(|(_, part)| candidate(part)).collect();
            let lean = lean::search(&base, &candidates, &trials, &|_, _| ()).unwrap();
            let text = lean::text(&plan, &lean, "A trial");
            let read = Plan::parse(&text, "lean", "lean", &[]).unwrap_or_else(|e| panic!("{e}\n{text}"));
            assert_eq!(parts(&read), lean.kept, "{text}");
            assert_eq!(lean.kept.len() + lean.left_out.len(), parts(&plan).len(), "{text}");
            assert!(readings(&read) == readings(&lean.variant.plan(0).unwrap()), "{text}");
            assert!(text.starts_with("# A trial\n") && text.contains("left out, a trial: "), "{text}");
        }
    }
}

#[test]
fn a_range_that_nonlinearity_needs_stays_with_it_and_goes_with_it() {
    let plan = plan(
        "[gyro]\nrate = \"50 Hz\"\nrange = \"250 deg/s\"\nnonlinearity = \"0.1 %\"\n\
         [accel]\nrate = \"50 Hz\"\nrange = \"50 m/s^2\"\n",
    );
    let base = Base::of(&plan).unwrap();
    let trials = Trials { runs: &[], seeds: 0..2, end: plan.duration, threads: 1 };
    let kept = |names: &[&str]| {
        let mine = parts(&plan).into_iter().filter(|part| names.contains(&part.name().as_str()));
        let candidates: Vec<_> =
            mine.map(|part| Candidate { part, margins: 0.0, why: String::new() }).collect();
        let lean = lean::search(&base, &candidates, &trials, &|_, _| ()).unwrap();
        let name = |part: &Part| format!("{}.{}", part.owner(), part.name());
        (lean.kept.iter().map(name).collect::<Vec<_>>(), lean.put_back.len())
    };
    assert_eq!(kept(&["range"]), (vec!["gyro.nonlinearity".into(), "gyro.range".into()], 1));
    assert_eq!(kept(&["range", "nonlinearity"]), (vec![], 0));
}

#[test]
fn with_nothing_to_leave_out_the_lean_scene_is_the_whole_one() {
    let found =
        study(&plan("[gyro]\nrate = \"50 Hz\"\nbias = \"[3, 0, -2] deg/s\"\n[accel]\nrate = \"50 Hz\"\n"), 2);
    assert_eq!(found.lean.kept, ["gyro.bias"]);
    assert!(found.lean.left_out.is_empty() && found.lean.filters.is_empty());
    let whole = plan("[gyro]\nrate = \"50 Hz\"\nbias = \"[3, 0, -2] deg/s\"\n[accel]\nrate = \"50 Hz\"\n");
    let read = Plan::parse(&found.lean.text, "lean", "lean", &[]).unwrap();
    assert_eq!(read.resolved, whole.resolved);
    assert!(found.lean.text.starts_with("# The scene test as it is"), "{}", found.lean.text);
}

#[test]
fn a_sensor_without_counts_or_noise_has_neither_and_a_scene_of_ideal_sensors_has_no_rows() {
    let found = study(&plan("[gyro]\nrate = \"50 Hz\"\nbias = \"3 deg/s\"\n"), 2);
    let bias = row(&found, "gyro", "bias");
    assert_eq!((bias.rms_counts, bias.rms_of_noise, bias.times_noticed), (None, None, None));
    assert_eq!(bias.verdict, Verdict::Needed, "with nothing to set it against it shows");
    let ideal = study(&plan("[gyro]\nrate = \"50 Hz\"\n[accel]\nrate = \"50 Hz\"\n"), 2);
    assert!(ideal.rows.is_empty() && ideal.lean.kept.is_empty(), "{ideal:?}");
}

#[test]
fn missing_samples_are_a_change_that_has_no_size() {
    let found = study(&plan(RICH), 2);
    let faults = row(&found, "mag", "faults");
    assert_eq!(faults.largest_counts, Some(0.0), "the others read the same");
    assert_ne!(faults.verdict, Verdict::BelowResolution);
    // A velocity beside the position has no counts either; no attitude filter reads it.
    let velocity = row(&found, "gps", "velocity_noise");
    assert_eq!((velocity.verdict, velocity.filter.as_deref()), (Verdict::Needed, None));
    assert_eq!(row(&found, "scene", "wind").filter.is_some(), row(&found, "gyro", "bias").filter.is_some());
}

#[test]
fn a_scene_with_a_log_beside_it_is_read_where_that_is() {
    let folder = tempfile::tempdir().unwrap();
    let log: String = (0..50).map(|k| format!("{},0.{},0,0\n", f64::from(k) * 0.1, k % 7)).collect();
    std::fs::write(folder.path().join("rates.csv"), format!("t_s,x_rad_s,y_rad_s,z_rad_s\n{log}")).unwrap();
    let scene = folder.path().join("scene.toml");
    let text =
        "[[motion]]\nkind = \"replay\"\nfile = \"rates.csv\"\n[gyro]\nrate = \"50 Hz\"\nbias = \"1 deg/s\"\n";
    std::fs::write(&scene, text).unwrap();
    let plan = Plan::load(scene.to_str().unwrap(), &[]).unwrap_or_else(|error| panic!("{error}"));
    let found = study(&plan, 2);
    assert_eq!(row(&found, "gyro", "bias").verdict, Verdict::Needed);
}
