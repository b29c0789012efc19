//! Several charts one below the other, as one document.

/// Stacks charts of this module, each whole and at its own scale.
#[must_use]
pub fn stacked(charts: &[String]) -> String {
    let sizes: Vec<_> = charts.iter().map(|chart| (size(chart, "width"), size(chart, "height"))).collect();
    let width = sizes.iter().map(|size| size.0).fold(0.0, f64::max);
    let height: f64 = sizes.iter().map(|size| size.1).sum();
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width:.0}\" height=\"{height:.0}\" \
         viewBox=\"0 0 {width:.0} {height:.0}\" role=\"img\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"#FFFFFF\"/>\n"
    );
    let mut y = 0.0;
    for (chart, size) in charts.iter().zip(sizes) {
        text += &format!("<g transform=\"translate(0,{y:.0})\">\n{}</g>\n", chart.trim_end());
        y += size.1;
    }
    text + "</svg>\n"
}

/// A numeric attribute of a document's first element; 0 if absent.
fn size(chart: &str, name: &str) -> f64 {
    let value = chart.split_once(&format!(" {name}=\"")).and_then(|(_, rest)| rest.split('"').next());
    value.and_then(|value| value.parse().ok()).unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::chart::{Histogram, Panels, histogram, panels};

    #[test]
    fn a_stack_is_as_wide_as_the_widest_and_as_high_as_all() {
        let charts = [
            histogram(&Histogram { title: "one".into(), ..Histogram::default() }),
            panels(&Panels { title: "two".into(), ..Panels::default() }),
        ];
        let whole = stacked(&charts);
        let heights = charts.each_ref().map(|chart| size(chart, "height"));
        assert!(heights.iter().all(|&height| height > 100.0));
        assert_eq!(size(&whole, "height"), heights[0] + heights[1]);
        assert_eq!(size(&whole, "width"), size(&charts[0], "width").max(size(&charts[1], "width")));
        assert!(whole.contains(&format!("translate(0,{:.0})", heights[0])));
        assert_eq!(whole.matches("<svg").count(), whole.matches("</svg>").count());
    }
}
