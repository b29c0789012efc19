use super::charts::at_best;
use super::*;
use crate::cli::study::picture::Picture;
use crate::scene::Plan;
use crate::study::filters::stability::Verdict;

fn row(filter: &str, scene: &str, rate_hz: u32, error_deg: Option<f64>) -> Row {
    Row {
        filter: filter.into(),
        scene: scene.into(),
        rate_hz,
        error_deg,
        inclination_deg: error_deg,
        heading_deg: error_deg,
        spread_deg: None,
        ns_per_update: 50.0,
        ns_per_simulated_s: 50.0 * f64::from(rate_hz),
    }
}

fn rows() -> Vec<Row> {
    vec![
        row("vqf", "still", 100, Some(0.5)),
        row("vqf", "pirouette", 100, Some(1.5)),
        row("vqf", "still", 1000, Some(0.25)),
        row("vqf", "pirouette", 1000, None),
        row("vqf-6d", "still", 100, Some(3.0)),
    ]
}

#[test]
fn the_table_for_machines_has_the_columns_it_is_known_by() {
    let outcome = Outcome::of("filters", &rows(), String::new()).unwrap().csv(&rows()).unwrap();
    let table = String::from_utf8_lossy(&outcome.files[0].1).into_owned();
    assert!(
        table.starts_with(
            "filter,scene,rate_hz,error_deg,inclination_deg,heading_deg,spread_deg,ns_per_update,ns_per_simulated_s\n\
             vqf,still,100,0.5,0.5,0.5,,50.0,5000.0\n"
        ),
        "{table}"
    );
}

#[test]
fn a_person_reads_the_errors_the_best_filter_and_the_verdicts() {
    let scenes = scenes::built_in(true).unwrap();
    let failed = stability::Row {
        filter: "vqf".into(),
        case: "nan-gyro",
        verdict: Verdict::Fails,
        figure_deg: 180.0,
        first_failing_step: Some(1001),
    };
    let text = text::all(&rows(), &scenes, std::slice::from_ref(&failed));
    for line in ["vqf      0.50", "vqf 1000 Hz: 0.25 deg", "vqf-6d 100 Hz: 3.00 deg", "X fails"] {
        assert!(text.contains(line), "{line} in\n{text}");
    }
    let drawn = charts::verdicts(&[failed]).svg();
    assert!(drawn.contains("#1001") && drawn.contains("not run (") && drawn.contains("nan-gyro"));
    assert!(charts::rates(&rows(), &scenes, 2).svg().contains("mean of 2 seeds"));
}

#[test]
fn at_a_glance_a_filter_is_at_the_rate_with_its_least_median_where_it_is_never_lost() {
    let best = at_best(&rows(), "vqf").unwrap();
    assert_eq!((best.rate_hz, best.error_deg, best.range_deg), (100, 1.0, (0.5, 1.5)));
    assert_eq!(at_best(&rows(), "fusion"), None);
    assert!(charts::glance(&rows()).svg().contains("vqf-6d, 100 Hz"));
}

#[test]
fn medians_are_in_the_middle() {
    assert_eq!(median(vec![3.0, 1.0, 2.0]), Some(2.0));
    assert_eq!(median(vec![4.0, 1.0]), Some(2.5));
    assert_eq!(median(vec![]), None);
}

#[test]
fn a_scene_joins_and_one_that_is_built_in_comes_last() {
    let joined = |name: &str| {
        let plan = Plan::load(name, &[]).unwrap();
        let request = Request { quick: true, scene: Some(&plan), source: Some(name), is_alone: true };
        let scenes = scenes(&request).unwrap();
        scenes.iter().map(|scene| scene.name.clone()).collect::<Vec<_>>()
    };
    assert_eq!(joined("coning"), ["still", "level-then-turn", "magnetic-disturbance", "coning"]);
    assert_eq!(joined("still"), ["level-then-turn", "magnetic-disturbance", "still"]);
}

#[test]
fn a_scene_that_suits_no_filter_is_refused_unless_other_studies_run_too() {
    let gyro = "[gyro]\nrate = \"100 Hz\"\n";
    for (text, says) in [
        (format!("duration = \"10 s\"\n{gyro}"), "has no [accel]"),
        (format!("duration = \"2 s\"\n{gyro}[accel]\nrate = \"100 Hz\"\n"), "lasts 2 s"),
    ] {
        let plan = Plan::parse(&text, "bare.toml", "bare", &[]).unwrap();
        let request =
            |is_alone| Request { quick: true, scene: Some(&plan), source: Some("bare.toml"), is_alone };
        let why = scenes(&request(true)).unwrap_err().0;
        assert!(why.contains(says), "{why}");
        assert_eq!(scenes(&request(false)).unwrap().len(), 3);
    }
}
