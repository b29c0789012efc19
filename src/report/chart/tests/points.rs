//! Named points: what they say, and that no label lies on anything.

use super::*;

/// Any numbers as points, levels and error bars, on every kind of axis.
pub(super) fn of_numbers(numbers: &[(f64, f64)], y_floor: Option<f64>) -> [String; 4] {
    let point = |&(x, y): &(f64, f64)| Point { name: "a".into(), group: 9, x, y, spread: Some((x, y)) };
    let input = |log: (bool, bool)| Points {
        x_linear: log.0,
        y_linear: log.1,
        y_floor,
        points: numbers.iter().map(point).collect(),
        levels: numbers.iter().map(|n| Level { name: "l".into(), y: n.1 }).collect(),
        front: true,
        ..Points::default()
    };
    let kinds = [(false, false), (false, true), (true, false), (true, true)];
    kinds.map(|kind| points(&input(kind)))
}

/// Filters as they might lie: names of several lengths, some beside each other, two at one place, one on the floor.
fn example() -> Points {
    let point = |name: &str, group, x: f64, y: f64| Point {
        name: name.into(),
        group,
        x,
        y,
        spread: (y > 0.0).then_some((0.7 * y, 1.5 * y)),
    };
    Points {
        title: "Filters: error against cost".into(),
        subtitle: "median of ten runs".into(),
        x_label: "cost (ns a sample)".into(),
        y_label: "error (deg)".into(),
        x_linear: false,
        y_linear: false,
        y_floor: Some(1e-3),
        groups: ["six axes", "nine axes", "dead reckoning"].map(String::from).to_vec(),
        points: vec![
            point("madgwick", 0, 40.0, 1.2),
            point("mahony", 0, 38.0, 1.25),
            point("fusion", 0, 55.0, 0.9),
            point("madgwick with its own initial alignment and a long name", 1, 60.0, 1.1),
            point("vqf", 0, 300.0, 0.3),
            point("vqf with magnetometer", 1, 300.0, 0.3),
            point("eskf", 1, 900.0, 0.28),
            point("integration", 2, 12.0, 40.0),
            point("coning", 2, 14.0, 39.0),
            point("exact", 2, 2000.0, 0.0),
            point("", 2, 500.0, 3.0),
        ],
        levels: vec![
            Level { name: "noise alone".into(), y: 0.25 },
            Level { name: "a bias left in".into(), y: 0.24 },
            Level { name: "usable".into(), y: 1.0 },
        ],
        front: true,
        notes: vec!["The bars are the tenth and the ninetieth percentile.".into()],
    }
}

/// The areas of marks: circles, squares and polygons of at most 12 pixels.
fn marks(elements: &[Element]) -> Vec<(f64, f64, f64, f64)> {
    let corners = |e: &Element| match e.name.as_str() {
        "polygon" => e.points(),
        "circle" => {
            let (x, y, r) = (e.number("cx") / UNITS, e.number("cy") / UNITS, e.number("r") / UNITS);
            vec![(x - r, y - r), (x + r, y + r)]
        }
        "rect" if e.get("fill") != "#FFFFFF" => {
            let (x, y) = (e.number("x") / UNITS, e.number("y") / UNITS);
            vec![(x, y), (x + e.number("width") / UNITS, y + e.number("height") / UNITS)]
        }
        _ => vec![],
    };
    elements.iter().map(corners).filter(|c| !c.is_empty()).map(|c| bounds(&c)).collect()
}

fn bounds(points: &[(f64, f64)]) -> (f64, f64, f64, f64) {
    let first = (f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY);
    points.iter().fold(first, |b, p| (b.0.min(p.0), b.1.min(p.1), b.2.max(p.0), b.3.max(p.1)))
}

/// The lines that are not of the grid, in short pieces, each as the rectangle around it.
fn lines(elements: &[Element]) -> Vec<(f64, f64, f64, f64)> {
    let mut areas = Vec::new();
    let drawn = |e: &&Element| e.attributes.iter().any(|a| a.0 == "stroke" && a.1 != "#DDDDDD");
    for line in elements.iter().filter(|e| matches!(e.name.as_str(), "polyline" | "line")).filter(drawn) {
        let at = |x, y| (line.number(x) / UNITS, line.number(y) / UNITS);
        let ends = if line.name == "line" { vec![at("x1", "y1"), at("x2", "y2")] } else { line.points() };
        for pair in ends.windows(2) {
            let on = |i: i32| {
                let part = f64::from(i) / 200.0;
                (pair[0].0 + (pair[1].0 - pair[0].0) * part, pair[0].1 + (pair[1].1 - pair[0].1) * part)
            };
            areas.extend((0..200).map(|i| bounds(&[on(i), on(i + 1)])));
        }
    }
    areas
}

/// What lies under the text `name`: marks, and lines.
fn under(svg: &str, name: &str) -> usize {
    let elements = check(svg);
    let text = elements.iter().find(|e| e.name == "text" && e.text == name);
    let a = extent(text.unwrap_or_else(|| panic!("no {name}")));
    let over = |b: &(f64, f64, f64, f64)| a.2 > b.0 && b.2 > a.0 && a.3 > b.1 && b.3 > a.1;
    marks(&elements).iter().filter(|b| over(b)).count() + lines(&elements).iter().filter(|b| over(b)).count()
}

#[test]
fn points_say_every_label_once_and_none_lies_on_a_point_or_a_line() {
    let input = example();
    let svg = points(&input);
    assert_says(&svg, &["Filters: error against cost", "median of ten runs", "cost (ns a sample)"]);
    assert_says(&svg, &["error (deg)", "≤ 0.001", "six axes", "nine axes", "dead reckoning", "the front"]);
    assert_says(&svg, &["noise alone", "a bias left in", "usable", "ninetieth percentile"]);
    for point in input.points.iter().filter(|point| !point.name.is_empty()) {
        assert_says(&svg, &[&point.name]);
        if point.name.len() < 30 {
            assert_eq!(under(&svg, &point.name), 0, "{}", point.name);
        }
    }
    for level in &input.levels {
        assert_eq!(under(&svg, &level.name), 0, "{}", level.name);
    }
    assert_eq!(svg, points(&input), "the same bytes");
    assert!(read(&svg)[0].number("width") <= 820.0);
}

#[test]
fn what_lies_under_a_label_is_noticed() {
    let text = "<text x=\"40\" y=\"80\" text-anchor=\"start\" font-size=\"48\">label</text>";
    let sheet = |body: &str| format!("<svg width=\"200\" height=\"100\">{body}{text}</svg>");
    assert_eq!(under(&sheet(""), "label"), 0);
    assert_eq!(under(&sheet("<circle cx=\"80\" cy=\"80\" r=\"20\"/>"), "label"), 1);
    assert!(under(&sheet("<line stroke=\"#000000\" x1=\"0\" y1=\"78\" x2=\"400\" y2=\"78\"/>"), "label") > 0);
}

#[test]
fn a_crowd_makes_the_picture_grow_and_keeps_every_label() {
    let crowd = |count: usize| Points {
        points: (0..count)
            .map(|i| Point {
                name: format!("method number {i}"),
                group: i % 5,
                x: 10.0 + (i % 3) as f64,
                y: 1.0 + (i % 2) as f64 * 0.1,
                spread: None,
            })
            .collect(),
        front: true,
        ..Points::default()
    };
    let height = |count: usize| {
        let input = crowd(count);
        let svg = points(&input);
        let names: Vec<&str> = input.points.iter().map(|point| point.name.as_str()).collect();
        assert_says(&svg, &names);
        read(&svg)[0].number("height")
    };
    assert!(height(60) > height(3));
}

#[test]
fn a_group_has_a_colour_and_a_shape_of_its_own() {
    let elements = check(&points(&example()));
    let fill = |name: &str| {
        let text = elements.iter().find(|e| e.name == "text" && e.text == name);
        text.unwrap_or_else(|| panic!("no {name}")).get("fill").to_owned()
    };
    assert_eq!(fill("vqf"), fill("fusion"));
    assert_ne!(fill("vqf"), fill("eskf"));
    let count = |name: &str, fill: &str| {
        elements
            .iter()
            .filter(|e| e.name == name && e.attributes.contains(&("fill".into(), fill.into())))
            .count()
    };
    // Each group's points and its sign in the legend.
    assert_eq!(count("circle", "#0072B2"), 4 + 1);
    assert_eq!(count("rect", "#D55E00"), 3 + 1);
    assert_eq!(count("polygon", "#009E73"), 4 + 1);
}

#[test]
fn a_front_is_drawn_only_where_it_is_asked_for() {
    let broad = |front: bool| {
        let svg = points(&Points { front, ..example() });
        let broad = |e: &&Element| e.attributes.contains(&("stroke-width".into(), "20".into()));
        read(&svg).iter().filter(broad).count()
    };
    assert_eq!((broad(false), broad(true)), (0, 2), "the front, and its sign in the legend");
}

#[test]
fn error_bars_and_levels_widen_the_axis_and_end_where_they_should() {
    let point = Point { x: 1.0, y: 5.0, spread: Some((1.0, 10.0)), ..Point::default() };
    let levels = vec![Level { name: "zero".into(), y: 0.0 }];
    let input = Points { x_linear: true, y_linear: true, points: vec![point], levels, ..Points::default() };
    let elements = check(&points(&input));
    let bar = |e: &&Element| e.name == "line" && e.get("stroke") == "#0072B2" && e.get("x1") == e.get("x2");
    let bar = elements.iter().find(bar).expect("a bar");
    let mark = elements.iter().find(|e| e.name == "circle").expect("a mark");
    let (low, high) = (bar.number("y1").max(bar.number("y2")), bar.number("y1").min(bar.number("y2")));
    // 1, 5 and 10 on a linear axis.
    assert!(((mark.number("cy") - low) / (high - low) - 4.0 / 9.0).abs() < 0.01);
    let zero = extent(elements.iter().find(|e| e.text == "zero").unwrap());
    assert!(zero.3 > low / UNITS, "the level lies below the bar");
}
