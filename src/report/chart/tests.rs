//! Every chart is read back: as a document, as its text, and as its drawing.

use super::axis::{Axis, Options, superscript};
use super::canvas::{Font, INK};
use super::series::{spread, thin};
use super::*;

mod bars;
mod points;

/// Units of a document to a pixel.
const UNITS: f64 = 4.0;

/// An element as written: its name, its attributes, and its text.
#[derive(Debug, Default)]
struct Element {
    name: String,
    attributes: Vec<(String, String)>,
    text: String,
}

impl Element {
    fn get(&self, name: &str) -> &str {
        let found = self.attributes.iter().find(|a| a.0 == name);
        found.map_or_else(|| panic!("no {name} in {self:?}"), |a| a.1.as_str())
    }

    fn number(&self, name: &str) -> f64 {
        self.get(name).parse().unwrap()
    }

    /// The corners of a polyline or polygon, in pixels.
    fn points(&self) -> Vec<(f64, f64)> {
        let pair = |p: &str| {
            let (x, y) = p.split_once(',').unwrap();
            (x.parse::<f64>().unwrap() / UNITS, y.parse::<f64>().unwrap() / UNITS)
        };
        self.get("points").split_whitespace().map(pair).collect()
    }
}

/// Resolves the five XML entities; any other `&` is an error.
fn unescaped(text: &str) -> String {
    let mut plain = String::new();
    let mut rest = text;
    while let Some((before, after)) = rest.split_once('&') {
        let (entity, after) = after.split_once(';').expect("an entity ends");
        plain.push_str(before);
        plain.push_str(match entity {
            "lt" => "<",
            "gt" => ">",
            "amp" => "&",
            "quot" => "\"",
            "apos" => "'",
            other => panic!("unknown entity {other}"),
        });
        rest = after;
    }
    plain + rest
}

fn element(tag: &str) -> Element {
    let (name, mut rest) = tag.split_once(' ').unwrap_or((tag, ""));
    let mut element = Element { name: name.to_owned(), ..Element::default() };
    while let Some((key, after)) = rest.split_once("=\"") {
        let (value, after) = after.split_once('"').expect("a closing quote");
        assert!(!value.contains('<'), "{tag}");
        element.attributes.push((key.trim().to_owned(), unescaped(value)));
        rest = after;
    }
    assert!(rest.trim().is_empty(), "left over in {tag}: {rest}");
    element
}

/// Reads a well-formed document with one root; panics otherwise.
fn read(svg: &str) -> Vec<Element> {
    assert!(svg.chars().all(|c| c == '\n' || !c.is_control()), "a control character");
    let (mut elements, mut open): (Vec<Element>, Vec<usize>) = (Vec::new(), Vec::new());
    let mut rest = svg;
    while let Some((text, after)) = rest.split_once('<') {
        match open.last() {
            Some(&i) => elements[i].text.push_str(unescaped(text).trim()),
            None => assert!(text.trim().is_empty(), "text outside the root"),
        }
        let (tag, after) = after.split_once('>').expect("a closing bracket");
        rest = after;
        if let Some(name) = tag.strip_prefix('/') {
            let i = open.pop().expect("an open element");
            assert_eq!(elements[i].name, name);
            continue;
        }
        assert!(elements.is_empty() || !open.is_empty(), "a second root");
        elements.push(element(tag.trim_end_matches('/')));
        if !tag.ends_with('/') {
            open.push(elements.len() - 1);
        }
    }
    assert!(open.is_empty() && rest.trim().is_empty());
    assert_eq!(elements[0].name, "svg");
    elements
}

/// Left, top, right and bottom of a text, in pixels, by the upper estimate of [`Font`].
fn extent(text: &Element) -> (f64, f64, f64, f64) {
    let size = text.number("font-size") / UNITS;
    let bold = text.attributes.iter().any(|a| a.0 == "font-weight");
    let font = Font::new(size, INK);
    let font = if bold { font.bold() } else { font };
    let (x, y) = (text.number("x") / UNITS, text.number("y") / UNITS);
    let (long, half) = (font.width(&text.text), size * 0.45);
    let start = match text.get("text-anchor") {
        "start" => 0.0,
        "middle" => -long / 2.0,
        _ => -long,
    };
    if text.attributes.iter().any(|a| a.0 == "transform") {
        return (x - half, y - start - long, x + half, y - start);
    }
    (x + start, y - half, x + start + long, y + half)
}

/// What holds for every chart: well-formed, letters of 11 px or more, and no text clipped or overlapping another.
fn check(svg: &str) -> Vec<Element> {
    let elements = read(svg);
    let root = &elements[0];
    let (width, height) = (root.number("width"), root.number("height"));
    let texts: Vec<&Element> = elements.iter().filter(|e| e.name == "text").collect();
    for (i, text) in texts.iter().enumerate() {
        assert!(text.number("font-size") / UNITS >= 11.0, "{text:?}");
        let a = extent(text);
        assert!(a.0 >= 0.0 && a.1 >= 0.0 && a.2 <= width && a.3 <= height, "clipped: {text:?}");
        for other in &texts[..i] {
            let b = extent(other);
            let apart = a.2 <= b.0 || b.2 <= a.0 || a.3 <= b.1 || b.3 <= a.1;
            assert!(apart, "{:?} {a:?} is over {:?} {b:?}", text.text, other.text);
        }
    }
    for line in elements.iter().filter(|e| e.name.starts_with("poly")) {
        for (x, y) in line.points() {
            assert!((0.0..=width).contains(&x) && (0.0..=height).contains(&y), "({x}, {y})");
        }
    }
    elements
}

/// All text of a chart, with wrapped lines joined by a space.
fn words(elements: &[Element]) -> String {
    let texts = elements.iter().filter(|e| e.name == "text").map(|e| e.text.as_str());
    texts.collect::<Vec<_>>().join(" ")
}

fn assert_says(svg: &str, labels: &[&str]) {
    let said = words(&check(svg));
    for label in labels {
        assert!(said.contains(label), "{label:?} is not in {said:?}");
    }
}

/// Pseudo-random numbers between −1 and 1, the same everywhere.
fn noise(i: usize) -> f64 {
    let mixed = (i as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let mixed = (mixed ^ (mixed >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    (mixed >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

fn seconds(count: usize) -> Vec<f64> {
    (0..count).map(|i| i as f64 * 1e-3).collect()
}

fn line<'a>(name: &'a str, x: &'a [f64], y: &'a [f64], kind: LineKind) -> Line<'a> {
    Line { name, x, y, kind }
}

fn one_panel(line: Line<'_>, wrap: Option<f64>) -> Panels<'_> {
    let panel =
        Panel { title: "a panel".into(), y_label: "y (m)".into(), lines: vec![line], wrap, log_y: false };
    Panels { title: "a line".into(), x_label: "time (s)".into(), panels: vec![panel], ..Panels::default() }
}

/// The paths of a chart with the colour of the first value.
fn first_paths(svg: &str) -> Vec<Vec<(f64, f64)>> {
    let first =
        |e: &&Element| e.name == "polyline" && e.get("stroke") == "#0072B2" && e.get("opacity") == "1";
    read(svg).iter().filter(first).map(Element::points).collect()
}

const METHODS: [&str; 15] = [
    "euler",
    "paper",
    "paper-normalised",
    "exp-average",
    "exp-midpoint",
    "rk4",
    "crouch-grossman-3",
    "magnus-4",
    "rkmk-4",
    "increment-1",
    "coning-2",
    "coning-3",
    "coning-4",
    "polynomial-fit",
    "euler-f32",
];

fn loglog_example() -> LogLog {
    let method = |motion: usize, k: usize| {
        let point = |r: i32| {
            let rate = 50.0 * 3f64.powi(r);
            let error = 10f64.powf(motion as f64 / 2.0 - 1.0 - (1 + k % 5) as f64 * f64::from(r) / 2.0);
            (rate * (5.0 + 3.0 * k as f64), if motion == 3 && k > 4 { 0.0 } else { error })
        };
        Method { name: METHODS[k].into(), points: (0..5).map(point).collect() }
    };
    let motion = |m: usize| Motion {
        title: format!("motion {m}: coning 10°, 60 s"),
        methods: (0..METHODS.len()).map(|k| method(m, k)).collect(),
    };
    LogLog {
        title: "Cost against error".into(),
        subtitle: "one point a rate".into(),
        x_label: "cost (ns per simulated second)".into(),
        y_label: "error (deg)".into(),
        y_floor: Some(1e-12),
        motions: (0..8).map(motion).collect(),
    }
}

fn grid_example() -> Grid {
    let verdicts = [Verdict::Stable, Verdict::Degraded, Verdict::Fails];
    let cell = |i: usize| Cell {
        verdict: verdicts[i % 3],
        figure: ["", "1.3·10⁻⁴°", "step 12"][i % 3].into(),
    };
    let row = |r: usize| Row { name: METHODS[r].into(), cells: (0..17).map(|c| cell(r * 5 + c)).collect() };
    Grid {
        title: "Where methods fail".into(),
        subtitle: "figure, or first failing step".into(),
        columns: (0..18).map(|c| format!("case {c}: pitch within 10⁻¹² of ±90°")).collect(),
        rows: (0..METHODS.len()).map(row).collect(),
    }
}

fn histogram_example(shape: Shape) -> Histogram {
    let samples = |scale: f64| (0..5000).map(move |i| scale * (3.0 * noise(i)).exp());
    let marker = |x: f64, label: &str, of| Marker { x, label: label.into(), of };
    Histogram {
        title: "How late packets leave".into(),
        subtitle: "write less due".into(),
        x_label: "lateness (µs)".into(),
        shape,
        log_x: true,
        log_y: shape != Shape::Below,
        distributions: vec![
            Distribution::of_samples("gyro", samples(2.0)),
            Distribution::of_samples("accel", samples(3.0)),
            Distribution { name: "baseline".into(), values: vec![(55.0, 4000), (70.0, 900), (300.0, 1)] },
        ],
        markers: vec![
            marker(2.0, "gyro p50 2 µs", Some(0)),
            marker(3.0, "accel p50 3 µs", Some(1)),
            marker(3.1, "another just beside it", None),
            marker(300.0, "limit 300 µs", None),
        ],
    }
}

fn curves_example() -> Curves {
    let taus: Vec<f64> = (0..40).map(|i| 1e-3 * 10f64.powf(f64::from(i) / 8.0)).collect();
    let measured = |name: &str, k: f64| Curve {
        name: name.into(),
        kind: CurveKind::Measured,
        points: taus.iter().map(|t| (*t, k / t.sqrt())).collect(),
        band: taus.iter().map(|t| (*t, 0.8 * k / t.sqrt(), 1.3 * k / t.sqrt())).collect(),
    };
    let theory = Curve {
        name: "white noise N/√τ".into(),
        kind: CurveKind::Theory,
        points: taus.iter().map(|t| (*t, 1e-4 / t.sqrt())).collect(),
        band: vec![],
    };
    Curves {
        title: "Allan deviation".into(),
        subtitle: "4 h at rest".into(),
        x_label: "averaging time τ (s)".into(),
        y_label: "Allan deviation (rad/s)".into(),
        band: "95 % confidence".into(),
        curves: vec![measured("x", 1e-4), measured("y", 1.01e-4), measured("z", 2e-4), theory],
        ..Curves::default()
    }
}

#[test]
fn panels_say_every_label_and_none_is_clipped_or_overlaps() {
    let t = seconds(3000);
    let truth: Vec<f64> = t.iter().map(|t| 9.8 * t.sin()).collect();
    let reading: Vec<f64> = truth.iter().enumerate().map(|(i, v)| v + 0.3 * noise(i)).collect();
    let panel = |title: &str, y_label: &str| Panel {
        title: title.into(),
        y_label: y_label.into(),
        lines: vec![
            line("x", &t, &reading, LineKind::Value),
            line("y", &t, &reading, LineKind::Value),
            line("z", &t, &truth, LineKind::Value),
            line("true value", &t, &truth, LineKind::Truth),
        ],
        ..Panel::default()
    };
    let input = Panels {
        title: "Scene table-1".into(),
        subtitle: "seed 1".into(),
        x_label: "time (s)".into(),
        panels: vec![panel("Gyroscope", "angular rate (rad/s)"), panel("Accelerometer", "force (m/s²)")],
    };
    let svg = panels(&input);
    assert_says(&svg, &["Scene table-1", "seed 1", "time (s)", "Gyroscope", "angular rate (rad/s)"]);
    assert_says(&svg, &["Accelerometer", "force (m/s²)", "x", "y", "z", "true value"]);
    assert_eq!(svg, panels(&input), "the same bytes");
    assert!(svg.len() < 250_000, "{}", svg.len());
}

#[test]
fn cost_against_error_says_every_label_for_fifteen_methods_on_eight_motions() {
    let input = loglog_example();
    let svg = loglog(&input);
    let mut labels = vec!["Cost against error", "one point a rate", "error (deg)", "≤ 10⁻¹²"];
    labels.push("cost (ns per simulated second)");
    labels.extend(METHODS);
    labels.extend(input.motions.iter().map(|m| m.title.as_str()));
    assert_says(&svg, &labels);
    assert_eq!(svg, loglog(&input), "the same bytes");
    // Once in the legend and once beside its line in each plot.
    assert_eq!(words(&read(&svg)).matches("crouch-grossman-3").count(), 9);
    assert!(svg.len() < 300_000, "{}", svg.len());
}

#[test]
fn a_grid_says_every_label_and_tells_verdicts_by_sign_and_number() {
    let svg = grid(&grid_example());
    let mut labels = vec!["Where methods fail", "first failing step", "step 12", "1.3·10⁻⁴°", "of ±90°"];
    labels.extend(METHODS);
    // 15 rows of 17 cells with a third of each verdict, and a missing 18th.
    labels.extend(["stable (85)", "degraded (85)", "fails (85)", "not run (15)"]);
    assert_says(&svg, &labels);
    assert_eq!(svg, grid(&grid_example()), "the same bytes");
}

#[test]
fn every_shape_of_a_distribution_says_its_labels() {
    for shape in [Shape::Bins, Shape::Below, Shape::Above] {
        let input = histogram_example(shape);
        let svg = histogram(&input);
        assert_says(&svg, &["How late packets leave", "write less due", "lateness (µs)"]);
        assert_says(&svg, &["gyro (5000 samples)", "baseline (4901 samples)"]);
        let markers: Vec<&str> = input.markers.iter().map(|m| m.label.as_str()).collect();
        assert_says(&svg, &markers);
        assert_eq!(svg, histogram(&input), "the same bytes");
    }
}

#[test]
fn curves_say_every_label() {
    let svg = curves(&curves_example());
    assert_says(&svg, &["Allan deviation", "4 h at rest", "averaging time τ (s)", "95 % confidence"]);
    assert_says(&svg, &["Allan deviation (rad/s)", "x", "y", "z", "white noise N/√τ"]);
    assert_eq!(svg, curves(&curves_example()), "the same bytes");
}

#[test]
fn a_chart_without_data_says_so() {
    let pictures = [
        panels(&Panels::default()),
        loglog(&LogLog::default()),
        grid(&Grid::default()),
        histogram(&Histogram::default()),
        curves(&Curves::default()),
        points(&Points::default()),
        bars(&Bars::default()),
    ];
    for svg in pictures {
        assert_says(&svg, &["no data"]);
    }
    let nan = [f64::NAN, f64::INFINITY];
    assert_says(&panels(&one_panel(line("gone", &nan, &nan, LineKind::Value), None)), &["no data", "gone"]);
}

#[test]
fn no_numbers_make_a_chart_panic_or_draw_outside() {
    let (nan, inf) = (f64::NAN, f64::INFINITY);
    let cases: [&[f64]; 14] = [
        &[],
        &[1.0],
        &[0.0],
        &[0.0; 5],
        &[-3.5; 4],
        &[nan; 3],
        &[nan, 1.0, inf, 2.0, f64::NEG_INFINITY],
        &[1.0, nan, 2.0, nan, 3.0],
        &[f64::MAX, f64::MIN],
        &[1e300, -1e300],
        &[5e-324, 1e-310],
        &[1e-300, 1e300],
        &[9.80665, 9.80665 + 1e-15],
        &[-5.0, -1.0, -2.0],
    ];
    let plain = [1.0, 2.0, 3.0, 4.0, 5.0];
    for case in cases {
        for (x, y) in [(case, case), (&plain[..], case), (case, &plain[..])] {
            all_charts_of(x, y);
        }
    }
}

/// Draws every kind of chart from the same numbers.
fn all_charts_of(x: &[f64], y: &[f64]) {
    let points: Vec<(f64, f64)> = x.iter().copied().zip(y.iter().copied()).collect();
    for log in [false, true] {
        for wrap in [None, Some(360.0), Some(0.0), Some(f64::NAN)] {
            let mut input = one_panel(line("a", x, y, LineKind::Value), wrap);
            input.panels[0].log_y = log;
            check(&panels(&input));
        }
        let band = points.iter().map(|p| (p.0, p.1, p.0)).collect();
        let curve = Curve { name: "a".into(), points: points.clone(), band, ..Curve::default() };
        check(&curves(&Curves { linear: log, curves: vec![curve], ..Curves::default() }));
        for shape in [Shape::Bins, Shape::Below, Shape::Above] {
            let counted = points.iter().map(|p| (p.0, p.1 as u64)).collect();
            let sampled = Distribution::of_samples("b", y.iter().copied());
            check(&histogram(&Histogram {
                shape,
                log_x: log,
                log_y: !log,
                distributions: vec![Distribution { name: "a".into(), values: counted }, sampled],
                markers: y.iter().map(|&x| Marker { x, label: "m".into(), of: Some(7) }).collect(),
                ..Histogram::default()
            }));
        }
    }
    for y_floor in [None, Some(1e-12), Some(f64::NAN), Some(-1.0)] {
        let method = Method { name: "a".into(), points: points.clone() };
        let motions = vec![Motion { title: "m".into(), methods: vec![method] }];
        check(&loglog(&LogLog { y_floor, motions, ..LogLog::default() }));
        for svg in points::of_numbers(&points, y_floor) {
            check(&svg);
        }
    }
}

#[test]
fn the_check_of_a_picture_refuses_a_bad_one() {
    let text = |x: u32, words: &str| {
        format!("<text x=\"{x}\" y=\"80\" text-anchor=\"start\" font-size=\"48\">{words}</text>")
    };
    let sheet = |body: String| format!("<svg width=\"200\" height=\"100\">{body}</svg>");
    let refused = |svg: String| std::panic::catch_unwind(|| check(&svg)).is_err();
    assert!(!refused(sheet(text(0, "left") + &text(400, "right"))));
    assert!(refused(sheet(text(0, "left") + &text(40, "over it"))));
    assert!(refused(sheet(text(700, "beyond the edge"))));
    assert!(refused(sheet(text(0, "a & b"))));
    assert!(refused(sheet("<g>".into())));
}

#[test]
fn letters_that_xml_reserves_or_forbids_are_written_safely() {
    let name = "a<b> & \"c\" 'd' \u{1b}\u{0}]]>";
    let t = [0.0, 1.0];
    let mut input = one_panel(line(name, &t, &t, LineKind::Value), None);
    input.title = name.into();
    assert_says(&panels(&input), &["a<b> & \"c\" 'd'"]);
}

#[test]
fn long_names_and_titles_widen_or_break_and_are_not_clipped() {
    let long = "a name of fifty letters or somewhat more than that it is";
    let t = [0.0, 1.0];
    let mut input = one_panel(line(long, &t, &t, LineKind::Value), None);
    input.title = [long; 5].join(" ");
    input.subtitle = "x".repeat(200);
    assert_says(&panels(&input), &[&input.title, &input.subtitle, long]);
    let mut input = loglog_example();
    input.motions.truncate(1);
    input.motions[0].methods[0].name = long.into();
    assert_says(&loglog(&input), &[long]);
    let mut input = grid_example();
    input.columns[17] = long.into();
    input.rows[0].name = long.into();
    input.rows[1].cells[1].figure = long.into();
    assert_says(&grid(&input), &[long]);
}

#[test]
fn a_million_samples_draw_two_points_a_column_and_keep_a_spike() {
    let t = seconds(1_000_000);
    let mut y: Vec<f64> = (0..t.len()).map(noise).collect();
    y[654_321] = 50.0;
    let svg = panels(&one_panel(line("a", &t, &y, LineKind::Value), None));
    let paths = first_paths(&svg);
    let drawn: Vec<(f64, f64)> = paths.concat();
    assert!(drawn.len() <= 2 * 801, "{}", drawn.len());
    let top = drawn.iter().copied().min_by(|a, b| a.1.total_cmp(&b.1)).unwrap();
    let (left, right) = (drawn[0].0, drawn[drawn.len() - 1].0);
    let at = left + (right - left) * 0.654_321;
    assert!((top.0 - at).abs() < 1.0, "the spike is at {top:?}, not at x = {at}");
    let others = drawn.iter().filter(|p| p.1 < top.1 + 50.0).count();
    assert_eq!(others, 1, "the spike stands alone");
    assert!(svg.len() < 40_000, "{}", svg.len());
}

#[test]
fn no_line_is_drawn_across_a_wrap() {
    let t = seconds(10_000);
    let angle: Vec<f64> = t.iter().map(|t| (t * 130.0 + 180.0).rem_euclid(360.0) - 180.0).collect();
    let climb = |wrap| {
        let paths = first_paths(&panels(&one_panel(line("roll", &t, &angle, LineKind::Value), wrap)));
        let steps = paths.iter().flat_map(|p| p.windows(2).map(|w| (w[1].1 - w[0].1).abs()));
        (paths.len(), steps.fold(0.0, f64::max))
    };
    let (runs, highest) = climb(Some(360.0));
    assert_eq!(runs, 5, "four wraps in ten seconds");
    assert!(highest < 5.0, "{highest}");
    assert!(climb(None).1 > 100.0, "without it the line does cross");
}

#[test]
fn many_wraps_and_many_gaps_stay_within_two_points_a_column() {
    let t = seconds(200_000);
    let angle: Vec<f64> = (0..t.len()).map(|i| (i as f64 * 97.0).rem_euclid(360.0) - 180.0).collect();
    let gaps: Vec<f64> = (0..t.len()).map(|i| if i % 2 == 0 { noise(i) } else { f64::NAN }).collect();
    for (y, wrap) in [(&angle, Some(360.0)), (&gaps, None)] {
        let svg = panels(&one_panel(line("a", &t, y, LineKind::Value), wrap));
        let drawn: usize = first_paths(&svg).iter().map(Vec::len).sum();
        assert!(drawn <= 2 * 801 && drawn > 800, "{drawn}");
    }
}

#[test]
fn a_gap_in_the_readings_is_a_gap_in_the_line() {
    let t = seconds(300);
    let gap = |i: usize| if (100..200).contains(&i) { f64::NAN } else { 1.0 + i as f64 };
    let y: Vec<f64> = (0..300).map(gap).collect();
    let svg = panels(&one_panel(line("a", &t, &y, LineKind::Value), None));
    assert_eq!(first_paths(&svg).len(), 2);
}

#[test]
fn a_name_keeps_its_colour_from_panel_to_panel() {
    let t = [0.0, 1.0];
    let panel = |names: &[&'static str]| Panel {
        lines: names.iter().map(|n| line(n, &t, &t, LineKind::Value)).collect(),
        ..Panel::default()
    };
    let input = Panels { panels: vec![panel(&["vqf", "fusion"]), panel(&["fusion"])], ..Panels::default() };
    let elements = read(&panels(&input));
    let colors: Vec<&str> = elements.iter().filter(|e| e.text == "fusion").map(|e| e.get("fill")).collect();
    assert_eq!(colors.len(), 2);
    assert_eq!(colors[0], colors[1]);
}

#[test]
fn the_front_holds_the_points_that_nothing_cheaper_beats() {
    let method = |name: &str, points: &[(f64, f64)]| Method { name: name.into(), points: points.to_vec() };
    let motion = Motion {
        title: "one".into(),
        methods: vec![
            method("good", &[(10.0, 1.0), (100.0, 1e-4)]),
            method("dear", &[(20.0, 1.0), (200.0, 1e-4)]),
            method("exact", &[(300.0, 0.0)]),
        ],
    };
    let svg = loglog(&LogLog { motions: vec![motion], ..LogLog::default() });
    let elements = check(&svg);
    let bold = |e: &&Element| e.name == "text" && e.attributes.iter().any(|a| a.0 == "font-weight");
    let bold: Vec<&str> = elements.iter().filter(bold).map(|e| e.text.as_str()).collect();
    assert!(bold.contains(&"good") && bold.contains(&"exact") && !bold.contains(&"dear"), "{bold:?}");
    let rings = elements.iter().filter(|e| e.name == "circle" && e.get("fill") == "none").count();
    assert_eq!(rings, 3 + 1, "three points, and one in the legend");
    assert!(words(&elements).contains("≤ 10"), "the exact one lies on a floor");
}

#[test]
fn ticks_are_round_and_their_labels_short() {
    let labels = |lo: f64, hi: f64, options: Options| {
        let axis = Axis::new([lo, hi], &options);
        let labels: Vec<String> = axis.ticks.iter().map(|t| t.label.clone()).collect();
        (labels.join(" "), axis.power.unwrap_or_default())
    };
    let linear = Options { room: 5, ..Options::default() };
    let angle = Options { wrap: Some(360.0), ..linear };
    let log = Options { log: true, ..linear };
    let floor = Options { floor: Some(1e-12), ..log };
    let cases = [
        (0.0, 10.0, linear, "0 2 4 6 8 10", ""),
        (-1.0, 1.0, linear, "−1.0 −0.5 0.0 0.5 1.0", ""),
        (-180.0, 180.0, angle, "−180 −90 0 90 180", ""),
        (-20.0, 20.0, angle, "−15 0 15", ""),
        (-1.0, 1.0, angle, "−1.0 −0.5 0.0 0.5 1.0", ""),
        (0.0, 8e-4, linear, "0 200 400 600 800", "×10⁻⁶"),
        (0.0, 2e6, linear, "0.0 0.5 1.0 1.5 2.0", "×10⁶"),
        (9.806, 9.807, linear, "9.8060 9.8062 9.8064 9.8066 9.8068 9.8070", ""),
        (1e-2, 1e2, log, "0.01 0.1 1 10 100", ""),
        (1e-9, 1e-1, log, " 10⁻⁸  10⁻⁶  10⁻⁴  10⁻² ", ""),
        (0.0, 1.0, floor, "≤ 10⁻¹²   10⁻⁹   10⁻⁶   10⁻³   10⁰", ""),
    ];
    for (lo, hi, options, expected, power) in cases {
        let (got, out) = labels(lo, hi, options);
        assert_eq!((got.as_str(), out.as_str()), (expected, power), "{lo} to {hi}");
    }
    assert_eq!(superscript(-120), "⁻¹²⁰");
}

#[test]
fn labels_move_apart_no_more_than_they_must() {
    let cases: [(&[f64], &[f64]); 6] = [
        (&[], &[]),
        (&[5.0], &[5.0]),
        (&[10.0, 50.0], &[10.0, 50.0]),
        (&[50.0, 50.0], &[45.0, 55.0]),
        (&[99.0, 98.0], &[100.0, 90.0]),
        (&[0.0, 0.0, 0.0], &[0.0, 10.0, 20.0]),
    ];
    for (wanted, expected) in cases {
        assert_eq!(spread(wanted, 10.0, 0.0, 100.0), expected, "{wanted:?}");
    }
}

#[test]
fn thinning_keeps_the_extremes_of_a_column_in_their_order() {
    let points = [(0.1, 5.0), (0.2, 9.0), (0.5, 1.0), (0.9, 4.0), (1.2, 3.0), (2.5, 2.0), (2.6, 2.5)];
    assert_eq!(thin(&points), [(0.2, 9.0), (0.5, 1.0), (1.2, 3.0), (2.5, 2.0), (2.6, 2.5)]);
    assert_eq!(thin(&[]), []);
}
