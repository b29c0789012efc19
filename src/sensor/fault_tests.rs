//! Each fault on its samples and on no others.

use super::signal_tests::{in_blocks, plan, played};
use super::*;
use crate::geometry::{Body, Vector};
use crate::scene::Plan;

/// A gyro at 100 Hz on a swing with noise, whose sample k is unlike any other, with these faults.
fn scene(more: &str) -> String {
    format!(
        "seed = 4\n[[motion]]\nkind = \"rock\"\namplitude = \"1 rad/s\"\nfrequency = \"0.5 Hz\"\nduration = \"3 s\"\n[gyro]\nrate = \"100 Hz\"\nnoise_std = \"0.01 rad/s\"\nrange = \"4 rad/s\"\n{more}"
    )
}

fn fault(kind: &str, more: &str) -> String {
    scene(&format!(
        "[[fault]]\nsensor = \"gyro\"\nkind = \"{kind}\"\nstart = \"1 s\"\nduration = \"0.5 s\"\n{more}"
    ))
}

/// The samples with the fault and without it, by tick: nothing where one is missing.
fn beside(kind: &str, more: &str) -> Vec<(Option<Vector<Body>>, Vector<Body>)> {
    let with = played(&fault(kind, more));
    let mut with = with.iter().peekable();
    let without = played(&scene(""));
    assert_eq!(without.len(), 300);
    let pairs: Vec<_> = without
        .iter()
        .map(|reading| {
            (
                with.next_if(|with| with.k == reading.k).map(|with| with.body().unwrap().value),
                reading.body().unwrap().value,
            )
        })
        .collect();
    assert!(with.next().is_none());
    for (k, (with, without)) in pairs.iter().enumerate() {
        assert!((100..150).contains(&k) || *with == Some(*without), "{kind}: sample {k} is none of its own");
    }
    pairs
}

#[test]
fn a_fault_that_withholds_samples_leaves_the_others_on_their_ticks() {
    assert!(beside("off", "")[100..150].iter().all(|(with, _)| with.is_none()));
    let kept = |kind, more| -> Vec<usize> {
        let pairs = beside(kind, more);
        (100..150).filter(|&k| pairs[k].0 == Some(pairs[k].1)).collect()
    };
    assert_eq!(kept("slow", "every = 20"), [100, 120, 140]);
    assert_eq!(kept("slow", "").len(), 5);
    // Of 50, half within 4 standard deviations of 3.5; none and all of them at the ends.
    assert!((11..=39).contains(&kept("intermittent", "").len()), "{:?}", kept("intermittent", ""));
    assert_eq!(kept("intermittent", "share = \"0 %\"").len(), 50);
    assert_eq!(kept("intermittent", "share = \"100 %\"").len(), 0);
}

#[test]
fn a_fault_changes_readings_as_its_kind_says() {
    let stuck = beside("stuck", "");
    assert!(stuck[100..150].iter().all(|(with, _)| *with == Some(stuck[99].1)));
    let delayed = beside("delayed", "delay = \"70 ms\"");
    assert!((100..150).all(|k| delayed[k].0 == Some(delayed[k - 7].1)));
    assert!(beside("wrong", "")[100..150].iter().all(|(with, without)| *with == Some(*without * -1.0)));
    let added = |kind, more| -> Vec<Vector<Body>> {
        beside(kind, more)[100..150].iter().map(|(with, without)| with.unwrap() - *without).collect()
    };
    let size = Vector::new(1.0, -2.0, 3.0);
    let near = |a: Vector<Body>, b: Vector<Body>| (a - b).length() < 1e-14;
    assert!(added("step", "size = \"[1, -2, 3] rad/s\"").iter().all(|v| near(*v, size)));
    let ramp = added("ramp", "size = \"[1, -2, 3] rad/s\"");
    assert!(ramp.iter().enumerate().all(|(k, v)| near(*v, size * (k as f64 / 50.0))));
    let spikes = added("spike", "size = \"[1, -2, 3] rad/s\"\nshare = \"30 %\"");
    let hit = spikes.iter().filter(|v| near(**v, size)).count();
    // 15 within 4 standard deviations of 3.2.
    assert!(
        (3..=27).contains(&hit) && spikes.iter().all(|v| near(*v, size) || near(*v, Vector::ZERO)),
        "{hit}"
    );
    let garbage = beside("garbage", "");
    let values: Vec<f64> =
        garbage[100..150].iter().flat_map(|(with, _)| with.unwrap().v.to_array()).collect();
    let variance = values.iter().map(|x| x * x).sum::<f64>() / 150.0;
    // Uniform within the range of ±4: 16/3, and its variance 64·4/45 over 150.
    assert!(
        values.iter().all(|x| x.abs() <= 4.0)
            && (variance / (16.0 / 3.0) - 1.0).abs() < 5.0 * (0.8f64 / 150.0).sqrt()
    );
}

#[test]
fn faults_do_not_care_where_blocks_begin_and_play_again_as_resolved() {
    for (kind, more) in [
        ("off", ""),
        ("stuck", ""),
        ("garbage", ""),
        ("slow", ""),
        ("delayed", "delay = \"70 ms\""),
        ("intermittent", ""),
        ("spike", "size = \"1 rad/s\""),
        ("ramp", "size = \"1 rad/s\""),
    ] {
        let plan = plan(&fault(kind, more));
        let whole = in_blocks(&plan, 256);
        for block in [1, 7, 100] {
            assert_eq!(in_blocks(&plan, block), whole, "{kind} in blocks of {block}");
        }
        assert_eq!(in_blocks(&self::plan(&plan.resolved), 256), whole, "{kind} as resolved");
    }
}

#[test]
fn the_faults_that_acted_are_told_and_mistakes_in_them_are_placed() {
    let plan = plan(&fault("stuck", ""));
    assert_eq!(plan.faults_until(plan.duration), ["gyro stuck from 1 s to 1.5 s"]);
    assert_eq!(plan.faults_until(SimTime(1_000_000_000)), [""; 0], "it had not begun");
    for (table, why) in [
        ("sensor = \"mag\"\nkind = \"off\"", "the scene has no mag"),
        ("sensor = \"gyro\"", "needs its kind"),
        ("sensor = \"gyro\"\nkind = \"step\"", "needs its size"),
        ("sensor = \"gyro\"\nkind = \"stuk\"", "did you mean `stuck`"),
        ("sensor = \"gyro\"\nkind = \"off\"\nsize = \"1 rad/s\"", "`size` is not a key of"),
        ("sensor = \"gyro\"\nkind = \"ramp\"\nsize = \"1 rad/s\"", "needs its duration"),
        ("sensor = \"gyro\"\nkind = \"delayed\"", "needs its delay"),
        ("sensor = \"gyro\"\nkind = \"intermittent\"\nshare = \"120 %\"", "at most 100 %"),
    ] {
        let error =
            Plan::parse(&scene(&format!("[[fault]]\n{table}")), "s", "s", &[]).unwrap_err().to_string();
        assert!(error.contains(why), "{table}: {error}");
    }
}
