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

/// What it prints as JSON.
fn printed(arguments: &[&str]) -> serde_json::Value {
    serde_json::from_slice(&study(arguments).assert().success().get_output().stdout).unwrap()
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
        "lean.toml",
        "filters-glance.svg",
        "filters-stability.csv",
        "filters-stability.svg",
        "filters.csv",
        "filters.json",
        "filters.svg",
        "manifest.json",
        "report.html",
        "normals.csv",
        "normals.json",
        "normals.svg",
        "parsimony.csv",
        "parsimony.json",
        "parsimony.svg",
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
    let results = printed(&arguments);
    assert!(results["stability"].is_null() && results["quick"] == true, "{results}");
    assert_eq!(
        files(&out),
        [
            "accuracy-glance.svg",
            "accuracy.csv",
            "accuracy.json",
            "accuracy.svg",
            "manifest.json",
            "report.html"
        ]
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
        ["manifest.json", "report.html", "stability.csv", "stability.json", "stability.svg"]
            .map(String::from)
            .into()
    );
}

#[test]
fn a_word_that_is_neither_a_study_nor_a_scene_is_refused_and_so_is_a_bad_scene() {
    for (arguments, says) in [
        (
            &["acuracy"][..],
            "`acuracy` is neither a study (accuracy, stability, filters, cost, normals, allan, parsimony, all) nor a scene, built in or a file; did you mean `accuracy`?",
        ),
        (
            &["acuracy", "coning"],
            "`acuracy` is not a study (accuracy, stability, filters, cost, normals, allan, parsimony, all); did you mean `accuracy`?",
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
    let cost = printed(&arguments);
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
    assert_eq!(
        files(&out),
        ["cost.csv", "cost.json", "cost.svg", "manifest.json", "report.html"].map(String::from).into()
    );
    let table = std::fs::read_to_string(out.join("cost.csv")).unwrap();
    assert_eq!(table.lines().next(), Some("term,ns_per_sample"));
    assert_eq!(table.lines().count(), 1 + names.len());
    // Without noise there is no floor to be set against.
    let quiet = folder.path().join("quiet.toml");
    std::fs::write(&quiet, "duration = \"1 s\"\n[gyro]\nrate = \"1 kHz\"\n").unwrap();
    let cost = printed(&["cost", quiet.to_str().unwrap(), "--quick", "--json"]);
    assert!(cost["ratio"].is_null() && cost["nine_axis_samples_per_s"].as_f64().unwrap() > 0.0, "{cost}");
}

/// Two sensors for three seconds: a bias that every filter notices, and a range that nothing reaches.
const SHORT: &str = "name = \"short\"\nseed = 2\n[[motion]]\nkind = \"hold\"\nduration = \"1 s\"\n\
     [[motion]]\nkind = \"rotate\"\nroll = \"20 deg/s\"\nduration = \"2 s\"\n\
     [gyro]\npart = \"MPU-9250\"\nrate = \"50 Hz\"\nbias = \"[5, 0, 0] deg/s\"\nnonlinearity = \"0 %\"\n\
     [accel]\nrate = \"50 Hz\"\nnoise_std = \"0.02 m/s^2\"\n";

#[test]
fn a_scene_is_told_what_it_needs_and_gets_a_leaner_one_that_plays() {
    let folder = tempfile::tempdir().unwrap();
    let (scene, out) = (folder.path().join("short.toml"), folder.path().join("study"));
    std::fs::write(&scene, SHORT).unwrap();
    let arguments = ["parsimony", scene.to_str().unwrap(), "--quick", "--out", out.to_str().unwrap()];
    let done = study(&arguments).assert().success();
    let text = String::from_utf8(done.get_output().stdout.clone()).unwrap();
    let line = |begins: &[&str]| {
        let is_it = |line: &&str| line.split_whitespace().collect::<Vec<_>>().starts_with(begins);
        text.lines().find(is_it).unwrap_or_else(|| panic!("{begins:?} in\n{text}")).to_string()
    };
    assert!(line(&["gyro", "bias"]).ends_with("needed"), "{text}");
    assert!(line(&["gyro", "range"]).ends_with("below resolution"), "{text}");
    assert!(text.contains("lean.toml has ") && text.contains("ns a nine-axis sample before"), "{text}");

    let names =
        ["lean.toml", "manifest.json", "report.html", "parsimony.csv", "parsimony.json", "parsimony.svg"];
    assert_eq!(files(&out), names.map(String::from).into());
    let (heading, rows) = rows(&out.join("parsimony.csv"));
    assert_eq!(
        heading,
        [
            "sensor",
            "term",
            "ns_per_sample",
            "rms_counts",
            "largest_counts",
            "rms_of_noise",
            "largest_of_noise",
            "filter",
            "change_deg",
            "standard_error_deg",
            "interval_deg",
            "margin_deg",
            "times_noticed",
            "verdict",
            "seeds_to_decide",
        ]
    );
    let json = std::fs::read(out.join("parsimony.json")).unwrap();
    let json: serde_json::Value = serde_json::from_slice(&json).unwrap();
    let json = &json["parsimony"];
    assert_eq!(json["rows"].as_array().unwrap().len(), rows.len());
    // Every filter, without a magnetometer.
    assert_eq!(json["filters"][0].as_array().unwrap().len(), ratetable::filters::FILTERS.len());
    let kept = json["lean"]["kept"].as_array().unwrap();
    assert!(
        kept.iter().any(|name| name == "gyro.bias") && !kept.iter().any(|name| name == "gyro.range"),
        "{json}"
    );
    for filter in json["lean"]["filters"].as_array().unwrap() {
        let number = |field: &str| filter[field].as_f64().unwrap();
        assert!(number("mean").abs() + number("half") <= number("margin_deg"), "{filter}");
    }
    let drawn = words_of_svg(&out.join("parsimony.svg"));
    assert!(drawn.contains("gyro bias") && drawn.contains("below: nothing is noticed"), "{drawn}");

    // It is a scene with exactly the terms that were kept.
    let lean = out.join("lean.toml");
    let mut check = Command::cargo_bin("ratetable").unwrap();
    let checked = check.args(["check", lean.to_str().unwrap()]).assert().success();
    let checked = String::from_utf8(checked.get_output().stdout.clone()).unwrap();
    assert!(checked.starts_with("short-lean: 3 s"), "{checked}");
    let mut play = Command::cargo_bin("ratetable").unwrap();
    play.args(["generate", lean.to_str().unwrap(), "--out", folder.path().join("played").to_str().unwrap()]);
    play.assert().success();
}

#[test]
fn a_scene_that_no_filter_reads_is_judged_by_its_readings_and_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("still.toml");
    std::fs::write(&scene, "duration = \"1 s\"\n[accel]\nrate = \"50 Hz\"\nbias = \"1 m/s^2\"\nrange = \"20 m/s^2\"\nresolution = \"0.01 m/s^2\"\n").unwrap();
    let done = study(&["parsimony", scene.to_str().unwrap(), "--quick"]).assert().success();
    let text = String::from_utf8(done.get_output().stdout.clone()).unwrap();
    assert!(text.contains("no filter reads these sensors"), "{text}");
}

#[test]
fn filters_are_measured_on_scenes_and_through_what_breaks_them() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("study");
    let arguments = ["filters", "coning-mems", "--quick", "--json", "--out", out.to_str().unwrap()];
    let results = printed(&arguments);
    let names = [
        "filters-glance.svg",
        "filters-stability.csv",
        "filters-stability.svg",
        "filters.csv",
        "filters.json",
        "filters.svg",
        "manifest.json",
        "report.html",
    ];
    assert_eq!(files(&out), names.map(String::from).into());
    let (table, grid) = (out.join("filters.csv"), out.join("filters-stability.csv"));
    assert_eq!(results["filters"].as_array().unwrap().len(), rows(&table).1.len());
    assert_eq!(results["filters_stability"].as_array().unwrap().len(), rows(&grid).1.len());
    let filters = ["vqf", "fusion", "madgwick", "mahony"];
    let filters = filters.into_iter().flat_map(|name| [name.to_string(), format!("{name}-6d")]).collect();
    assert_eq!(column(&table, "filter"), filters);
    assert_eq!(column(&grid, "filter"), filters);
    let scenes = ["still", "level-then-turn", "magnetic-disturbance", "coning-mems"].map(String::from);
    assert_eq!(column(&table, "scene"), scenes.clone().into(), "the scene joins the built-in ones");
    assert_eq!(column(&table, "rate_hz"), ["100", "1000"].map(String::from).into());
    for row in results["filters"].as_array().unwrap() {
        assert!(
            row["error_deg"].as_f64().unwrap() > 0.0 && row["ns_per_update"].as_f64().unwrap() > 0.0,
            "{row}"
        );
    }
    let drawn = words_of_svg(&out.join("filters.svg"));
    assert!(scenes.iter().all(|scene| drawn.contains(scene.as_str())), "{drawn}");
    assert!(words_of_svg(&out.join("filters-stability.svg")).contains("start-upside-down"));
    assert!(words_of_svg(&out.join("filters-glance.svg")).contains("vqf"));

    let bare = folder.path().join("bare.toml");
    std::fs::write(&bare, "duration = \"10 s\"\n[gyro]\nrate = \"100 Hz\"\n").unwrap();
    let why = refusal(&["filters", bare.to_str().unwrap(), "--quick"]);
    assert!(why.contains("has no [accel]"), "{why}");
}
