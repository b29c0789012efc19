//! The front: the points that no cheaper point beats, and the staircase that joins them.

use super::canvas::{Canvas, INK, Pen};
use super::plot::Frame;

/// The line of a front: broad and pale, so that points on it stay visible.
pub(super) fn pen() -> Pen {
    Pen::new(INK, 5.0).alpha(0.22)
}

/// The points with a smaller error than every point that costs no more, from cheap to expensive.
pub(super) fn best(points: impl IntoIterator<Item = (f64, f64)>) -> Vec<(f64, f64)> {
    let mut points: Vec<_> = points.into_iter().collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let mut front: Vec<(f64, f64)> = Vec::new();
    for point in points {
        if front.last().is_none_or(|best| point.1 < best.1) {
            front.push(point);
        }
    }
    front
}

/// The corners on the sheet of a step line: the smallest error for a cost.
pub(super) fn corners(frame: &Frame, front: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let mut path: Vec<(f64, f64)> = Vec::new();
    for &point in front {
        let (x, y) = frame.at(point);
        if let Some(&(_, above)) = path.last() {
            path.push((x, above));
        }
        path.push((x, y));
    }
    if let Some(last) = path.last().copied() {
        path.push((frame.right(), last.1));
    }
    path
}

/// Draws the step line.
pub(super) fn draw(canvas: &mut Canvas<'_>, frame: &Frame, front: &[(f64, f64)]) {
    if !front.is_empty() {
        canvas.path(&corners(frame, front), &pen());
    }
}
