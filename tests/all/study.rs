//! `ratetable study` as a process: its files, its columns, its refusals. With `--quick`: 0.6 s for the accuracy of four
//! motions and 10 s for the stability (a tenth of the steps of drift) of one processor, which a study shares among all.

use assert_cmd::Command;
use std::collections::BTreeSet;
use std::path::Path;

fn study(arguments: &[&str]) -> Command {
    let mut command = Command::cargo_bin("ratetable").unwrap();
    command.arg("study").args(arguments);
    command
}

/// What it says when it refuses.
fn refusal(arguments: &[&str]) -> String {
    let output = study(arguments).assert().code(2).stdout("").get_output().stderr.clone();
    String::from_utf8(output).unwrap()
}

fn rows(file: &Path) -> (Vec<String>, Vec<Vec<String>>) {
    let mut reader = csv::Reader::from_path(file).unwrap();
    let heading = reader.headers().unwrap().iter().map(str::to_string).collect();
    let rows = reader.records().map(|row| row.unwrap().iter().map(str::to_string).collect());
    (heading, rows.collect())
}

fn column(file: &Path, name: &str) -> BTreeSet<String> {
    let (heading, rows) = rows(file);
    let at = heading.iter().position(|column| column == name).unwrap();
    rows.into_iter().map(|row| row[at].clone()).collect()
}

/// The text of a drawing, every element of it.
fn words_of_svg(file: &Path) -> String {
    let text = std::fs::read_to_string(file).unwrap();
    let drawing =
        roxmltree::Document::parse(&text).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
    assert_eq!(drawing.root_element().tag_name().name(), "svg");
    assert_eq!(drawing.root_element().tag_name().namespace(), Some("http://www.w3.org/2000/svg"));
    drawing.descendants().filter_map(|node| node.text()).collect::<Vec<_>>().join(" ")
}

fn files(folder: &Path) -> BTreeSet<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
}

#[test]
fn all_studies_of_a_scene_write_their_tables_and_charts() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("study");
    let done = study(&["coning", "--quick", "--out", out.to_str().unwrap()]).assert().success();
    let text = String::from_utf8(done.get_output().stdout.clone()).unwrap();
    assert!(text.contains("coning") && text.contains("magnus-4"), "{text}");

    let names = [
        "accuracy-glance.svg",
        "accuracy.csv",
        "accuracy.json",
        "accuracy.svg",
        "allan.csv",
        "allan.json",
        "allan.svg",
        "cost.csv",
        "cost.json",
        "cost.svg",
        "manifest.json",
        "stability.csv",
        "stability.json",
        "stability.svg",
    ];
    assert_eq!(files(&out), names.map(String::from).into());
    let (accuracy, stability) = (out.join("accuracy.csv"), out.join("stability.csv"));
    let columns = [
        "method",
        "motion",
        "rate_hz",
        "precision",
        "error_deg",
        "norm_error",
        "ns_per_step",
        "ns_per_simulated_s",
    ];
    assert_eq!(rows(&accuracy).0, columns);
    assert_eq!(rows(&stability).0, ["method", "case", "verdict", "figure", "first_failing_step"]);

    let motions = ["A", "B", "C", "D", "coning"].map(String::from);
    assert_eq!(column(&accuracy, "motion"), motions.clone().into(), "the scene joins the built-in motions");
    let methods = column(&accuracy, "method");
    assert!(methods.len() == 15 && methods == column(&stability, "method"), "{methods:?}");
    assert_eq!(column(&stability, "verdict"), ["stable", "degraded", "fails"].map(String::from).into());
    let drawn = words_of_svg(&out.join("accuracy.svg"));
    for word in motions.iter().chain(&methods) {
        assert!(drawn.contains(word.as_str()), "{word} in {drawn}");
    }
    assert!(words_of_svg(&out.join("accuracy-glance.svg")).contains("what the paper prints"));
    assert!(words_of_svg(&out.join("stability.svg")).contains("paper"));
}

#[test]
fn one_study_writes_its_own_files_and_an_existing_folder_is_refused_before_anything_runs() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("study");
    let arguments = ["accuracy", "--quick", "--json", "--out", out.to_str().unwrap()];
    let done = study(&arguments).assert().success();
    let results: serde_json::Value = serde_json::from_slice(&done.get_output().stdout).unwrap();
    assert!(results["stability"].is_null() && results["quick"] == true, "{results}");
    assert_eq!(
        files(&out),
        ["accuracy-glance.svg", "accuracy.csv", "accuracy.json", "accuracy.svg", "manifest.json"]
            .map(String::from)
            .into()
    );
    let rows = rows(&out.join("accuracy.csv")).1;
    assert_eq!(results["accuracy"].as_array().unwrap().len(), rows.len(), "the same rows for all");

    std::fs::write(out.join("accuracy.csv"), "mine").unwrap();
    let why = refusal(&arguments);
    assert!(why.contains(out.to_str().unwrap()) && why.contains("--force"), "{why}");
    assert_eq!(std::fs::read_to_string(out.join("accuracy.csv")).unwrap(), "mine", "nothing was touched");
}

#[test]
fn the_study_of_stability_writes_its_own_files() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("study");
    study(&["stability", "--quick", "--out", out.to_str().unwrap()]).assert().success();
    assert_eq!(
        files(&out),
        ["manifest.json", "stability.csv", "stability.json", "stability.svg"].map(String::from).into()
    );
}

#[test]
fn a_word_that_is_neither_a_study_nor_a_scene_is_refused_and_so_is_a_bad_scene() {
    for (arguments, says) in [
        (
            &["acuracy"][..],
            "`acuracy` is neither a study (accuracy, stability, cost, allan, all) nor a scene, built in or a file; did you mean `accuracy`?",
        ),
        (
            &["acuracy", "coning"],
            "`acuracy` is not a study (accuracy, stability, cost, allan, all); did you mean `accuracy`?",
        ),
        (&["coning", "still"], "`coning` is a scene, so `still` is a second one"),
        (&["accuracy", "nowhere.toml"], "neither a scene file"),
    ] {
        let why = refusal(arguments);
        assert!(why.contains(says), "{arguments:?}: {why}");
    }
    let folder = tempfile::tempdir().unwrap();
    let bad = folder.path().join("bad.toml");
    std::fs::write(&bad, "duration = \"10 s\"\n[gyro]\nrate = 100\n").unwrap();
    for arguments in [&["all", bad.to_str().unwrap()][..], &[bad.to_str().unwrap()]] {
        let why = refusal(arguments);
        assert!(why.contains("bad.toml:3:") && why.contains("has no unit"), "{why}");
    }
}

#[test]
fn the_cost_of_a_scene_is_told_term_by_term() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("study");
    let arguments = ["cost", "mpu-9250", "--quick", "--json", "--out", out.to_str().unwrap()];
    let done = study(&arguments).assert().success();
    let cost: serde_json::Value = serde_json::from_slice(&done.get_output().stdout).unwrap();
    assert_eq!(cost["scene"], "mpu-9250");
    for field in ["samples", "nine_axis_samples_per_s", "floor_samples_per_s", "ratio", "normals_per_sample"]
    {
        assert!(cost[field].as_f64().unwrap() > 0.0, "{field}: {cost}");
    }
    let one = std::thread::available_parallelism().map_or(1, usize::from) == 1;
    assert!(one && cost["cores"].is_null() || cost["cores"]["times_one"].as_f64().unwrap() > 0.0, "{cost}");
    let terms = cost["terms"].as_array().unwrap();
    let names: Vec<_> = terms.iter().map(|term| term["term"].as_str().unwrap()).collect();
    assert!(names[0] == "truth" && names.contains(&"white_noise"), "{names:?}");
    assert!(terms.iter().all(|term| term["ns_per_sample"].as_f64().unwrap() > 0.0));
    assert_eq!(files(&out), ["cost.csv", "cost.json", "cost.svg", "manifest.json"].map(String::from).into());
    let table = std::fs::read_to_string(out.join("cost.csv")).unwrap();
    assert_eq!(table.lines().next(), Some("term,ns_per_sample"));
    assert_eq!(table.lines().count(), 1 + names.len());
    // Without noise there is no floor to be set against.
    let quiet = folder.path().join("quiet.toml");
    std::fs::write(&quiet, "duration = \"1 s\"\n[gyro]\nrate = \"1 kHz\"\n").unwrap();
    let done = study(&["cost", quiet.to_str().unwrap(), "--quick", "--json"]).assert().success();
    let cost: serde_json::Value = serde_json::from_slice(&done.get_output().stdout).unwrap();
    assert!(cost["ratio"].is_null() && cost["nine_axis_samples_per_s"].as_f64().unwrap() > 0.0, "{cost}");
}
