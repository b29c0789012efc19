//! Bars: their axis, and a line that crosses no figure.

use super::*;

fn example(line: f64) -> Bars {
    let bar = |name: &str, value, added| Bar { name: name.into(), value, added };
    Bars {
        title: "What a sample costs".into(),
        subtitle: "one thread".into(),
        x_label: "cost (ns per sample)".into(),
        unit: "ns".into(),
        bars: vec![bar("truth", 20.0, 20.0), bar("noise", 75.0, 55.0), bar("range", 74.5, -0.5)],
        line: Some(("noise alone".into(), line)),
    }
}

#[test]
fn bars_say_their_figures_and_have_an_axis() {
    let svg = bars(&example(30.0));
    assert_says(&svg, &["What a sample costs", "one thread", "cost (ns per sample)", "noise alone"]);
    assert_says(&svg, &["20 ns (+20)", "75 ns (+55)", "74.5 ns (−0.5)", "0 10 20 30 40 50 60 70"]);
    // From zero: a bar's length is its value.
    let lengths: Vec<f64> = read(&svg)
        .iter()
        .filter(|e| e.name == "rect" && e.get("fill") == "#0072B2")
        .map(|e| e.number("width"))
        .collect();
    assert!((lengths[1] / lengths[3] - 20.0 / 55.0).abs() < 0.01, "{lengths:?}");
}

#[test]
fn the_line_crosses_no_figure_wherever_it_is() {
    for line in [0.0, 21.0, 30.0, 76.0, 400.0] {
        let elements = check(&bars(&example(line)));
        let dashes = elements.iter().filter(|e| e.name == "polyline" && e.get("stroke") == "#222222");
        let x = dashes.flat_map(Element::points).map(|p| p.0).fold(0.0, f64::max);
        assert!(x > 0.0);
        for text in elements.iter().filter(|e| e.text.contains("ns (")) {
            assert!(extent(text).0 > x, "{} at {line}", text.text);
        }
    }
}
