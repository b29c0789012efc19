use super::*;
use crate::dataset::FORMATS;
use std::collections::{BTreeMap, BTreeSet};

const SCENE: &str = r#"
seed = 5
duration = "0.1 s"
[[motion]]
kind = "rotate"
yaw = "30 deg/s"
duration = "1 s"
[gyro]
rate = "200 Hz"
noise_std = "0.001 rad/s"
bias_std = "1 deg/s"
[accel]
rate = "100 Hz"
range = "9.81 m/s^2"
noise_std = "0.01 m/s^2"
[reference]
[sweep]
gyro.noise_std = ["0.001 rad/s", "0.002 rad/s", "0.003 rad/s"]
earth.gravity = { uniform = ["9.78 m/s^2", "9.83 m/s^2"] }
"#;

fn scene() -> Runs {
    Runs::parse(SCENE, "test", "test", &[]).unwrap()
}

/// Makes a share of seven runs, in two formats.
fn make(dir: &Path, shard: &str, threads: usize) -> Result<Made, DatasetError> {
    make_of(&scene(), dir, shard, threads, false)
}

fn make_of(scene: &Runs, dir: &Path, shard: &str, threads: usize, force: bool) -> Result<Made, DatasetError> {
    let go = AtomicBool::new(false);
    let shard = shard.parse().unwrap();
    write_runs(scene, dir, &RunOptions { shard, force, threads, ..seven(&|_, _| (), &go) })
}

fn seven<'a>(progress: parallel::Progress<'a>, stop: &'a AtomicBool) -> RunOptions<'a> {
    RunOptions {
        runs: 7,
        shard: Shard::WHOLE,
        force: false,
        formats: FORMATS[..2].to_vec(),
        draw: None,
        threads: 1,
        progress,
        stop,
    }
}

/// Every file below a folder, by its path.
fn tree(dir: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut files = BTreeMap::new();
    let mut folders = vec![dir.to_path_buf()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else {
                files.insert(path.strip_prefix(dir).unwrap().to_path_buf(), fs::read(&path).unwrap());
            }
        }
    }
    files
}

#[test]
fn shares_in_any_order_on_any_number_of_threads_are_together_the_whole() {
    let home = tempfile::tempdir().unwrap();
    let whole = home.path().join("whole");
    assert_eq!(make(&whole, "0/1", 1).unwrap(), Made { written: 7, kept: 0 });
    let whole = tree(&whole);
    assert_eq!(whole.keys().filter(|path| path.ends_with("gyro.csv")).count(), 7);
    for (name, shards, threads) in
        [("three", vec!["2/3", "3/3", "1/3"], 2), ("five", vec!["4/5", "0/5", "3/5", "1/5", "2/5"], 7)]
    {
        let dir = home.path().join(name);
        let made: u64 = shards.iter().map(|shard| make(&dir, shard, threads).unwrap().written).sum();
        assert_eq!(made, 7);
        assert!(tree(&dir) == whole, "{name}");
    }
    let readings: BTreeSet<_> =
        whole.iter().filter(|(path, _)| path.ends_with("gyro.csv")).map(|it| it.1).collect();
    assert_eq!(readings.len(), 7, "no two runs are alike");
}

#[test]
fn a_share_holds_its_runs_and_no_others() {
    let home = tempfile::tempdir().unwrap();
    make(home.path(), "2/3", 2).unwrap();
    assert_eq!(complete(home.path()).unwrap(), [2, 5]);
    for wrong in ["", "3", "4/3", "1/0", "-1/3", "1/x"] {
        assert!(wrong.parse::<Shard>().unwrap_err().contains("write I/N"), "{wrong}");
    }
}

#[test]
fn a_runs_own_scene_plays_to_the_same_numbers() {
    let home = tempfile::tempdir().unwrap();
    make(home.path(), "0/1", 2).unwrap();
    let (run, again) = (home.path().join("run-000004"), home.path().join("again"));
    let plan = Plan::load(run.join("scene.toml").to_str().unwrap(), &[]).unwrap();
    write(&plan, plan.duration, &again, Options::new(&mut |_| {})).unwrap();
    for name in ["gyro.csv", "accel.csv", "truth.csv", "reference.csv", "scene.toml"] {
        assert!(fs::read(run.join(name)).unwrap() == fs::read(again.join(name)).unwrap(), "{name}");
    }
}

#[test]
fn the_table_has_a_row_a_run_with_what_its_folder_holds() {
    let home = tempfile::tempdir().unwrap();
    make(home.path(), "0/1", 2).unwrap();
    let mut table = csv::Reader::from_path(home.path().join(TABLE)).unwrap();
    let header =
        ["run", "seed", "gyro.noise_std", "earth.gravity", "samples", "clipped", "reference_rms_deg"];
    assert_eq!(table.headers().unwrap(), &header[..]);
    let rows: Vec<_> = table.records().map(Result::unwrap).collect();
    assert_eq!(rows.len(), 7);
    for (index, row) in rows.iter().enumerate() {
        let folder = folder_of(home.path(), index as u64);
        let (seed, swept) = scene().settings(index as u64);
        assert_eq!((&row[0], &row[1]), (&*index.to_string(), &*seed.to_string()));
        assert_eq!((&row[2], &row[3]), (&*swept[0].value, &*swept[1].value));
        assert_eq!(&row[2], ["0.001 rad/s", "0.002 rad/s", "0.003 rad/s"][index % 3]);
        assert_eq!(&row[4], "30");
        // An accelerometer at its range by then.
        let accel = fs::read_to_string(folder.join("accel.csv")).unwrap();
        let clipped = accel.lines().skip(1).filter(|line| line.split(',').nth(3) == Some("-9.81")).count();
        assert_eq!(row[5].parse::<usize>().unwrap(), clipped);
        let error: f64 = row[6].parse().unwrap();
        assert!(error > 0.0 && error < 1e-3, "{error}");
    }
    assert!(rows.iter().any(|row| &row[5] != "0") && rows.iter().any(|row| &row[5] == "0"));
}

#[test]
fn what_was_interrupted_is_made_up_and_what_is_complete_is_kept() {
    let home = tempfile::tempdir().unwrap();
    let (whole, dir) = (home.path().join("whole"), home.path().join("dir"));
    make(&whole, "0/1", 2).unwrap();
    let stop = AtomicBool::new(false);
    let progress = |done, _| stop.store(done == 3, Ordering::Relaxed);
    let stopped = write_runs(&scene(), &dir, &seven(&progress, &stop)).unwrap_err();
    assert!(matches!(stopped, DatasetError::RunsStopped { complete: 3, of: 7 }), "{stopped}");
    assert_eq!(complete(&dir).unwrap(), [0, 1, 2]);
    assert_eq!(fs::read_to_string(dir.join(TABLE)).unwrap().lines().count(), 4);

    // As a killed process leaves it: the run of this share that it was at, and one of another share at work.
    let (ours, others) = (dir.join(".run-000003.incomplete-1"), dir.join(".run-000004.incomplete-1"));
    fs::create_dir(&ours).unwrap();
    fs::create_dir(&others).unwrap();
    assert_eq!(make(&dir, "1/2", 2).unwrap(), Made { written: 2, kept: 1 });
    assert!(!ours.exists() && others.exists());
    assert_eq!(make(&dir, "0/2", 2).unwrap(), Made { written: 2, kept: 2 });
    assert!(tree(&dir) == tree(&whole));
}

#[test]
fn what_is_no_run_of_this_scene_is_refused_and_left_alone() {
    let home = tempfile::tempdir().unwrap();
    let dir = home.path().join("runs");
    make(&dir, "0/1", 2).unwrap();
    let before = tree(&dir);
    let other = Runs::parse(&SCENE.replace("seed = 5", "seed = 6"), "test", "test", &[]).unwrap();
    let refused = make_of(&other, &dir, "0/1", 2, false).unwrap_err();
    assert!(matches!(&refused, DatasetError::OtherRun { .. }), "{refused}");
    assert!(refused.to_string().contains("run-00000") && refused.to_string().contains("--force"));
    assert!(tree(&dir) == before);
    assert_eq!(make_of(&other, &dir, "0/1", 2, true).unwrap(), Made { written: 7, kept: 0 });
    assert!(tree(&dir) != before);

    fs::write(dir.join("thesis.txt"), "mine").unwrap();
    assert!(matches!(make(&dir, "0/1", 1).unwrap_err(), DatasetError::Exists { .. }));
}
