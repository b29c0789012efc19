//! Prepares data for drawing: gaps, wraps, and fewer points.

/// The largest drawable magnitude; beyond it a chart's arithmetic would overflow.
const LARGEST: f64 = 1e300;

/// Whether a number is drawable.
pub(super) fn drawable(v: f64) -> bool {
    v.abs() <= LARGEST
}

/// The minimum and maximum of the drawable numbers.
pub(super) fn range(values: impl IntoIterator<Item = f64>) -> Option<(f64, f64)> {
    values.into_iter().filter(|&v| drawable(v)).fold(None, |range, v| match range {
        None => Some((v, v)),
        Some((lo, hi)) => Some((v.min(lo), v.max(hi))),
    })
}

/// Cuts points into runs of connected points. A non-finite value makes a gap, and so does a step of more than half
/// of `wrap`. Sorts points by `x` if necessary.
pub(super) fn runs(x: &[f64], y: &[f64], wrap: Option<f64>) -> Vec<Vec<(f64, f64)>> {
    let mut points: Vec<(f64, f64)> = x.iter().copied().zip(y.iter().copied()).collect();
    points.retain(|p| drawable(p.0));
    if !points.is_sorted_by(|a, b| a.0 <= b.0) {
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
    }
    let mut runs: Vec<Vec<(f64, f64)>> = Vec::new();
    let mut last: Option<f64> = None;
    for (x, y) in points {
        if !drawable(y) {
            last = None;
            continue;
        }
        let joined = last.is_some_and(|l| wrap.is_none_or(|w| (y - l).abs() <= w / 2.0));
        match runs.last_mut() {
            Some(run) if joined => run.push((x, y)),
            _ => runs.push(vec![(x, y)]),
        }
        last = Some(y);
    }
    runs
}

/// Keeps the highest and the lowest of the points (in pixels) in each pixel column, in order: at most two points in
/// a column, and every spike remains.
pub(super) fn thin(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let column = |p: &(f64, f64)| p.0.floor();
    let mut kept = Vec::new();
    for group in points.chunk_by(|a, b| column(a) == column(b)) {
        let (low, high) = extremes(group);
        kept.push(group[low.min(high)]);
        if low != high {
            kept.push(group[low.max(high)]);
        }
    }
    kept
}

/// Thins every run. If there are more runs than half the pixel columns, one stroke in each column from the lowest
/// to the highest point replaces them.
pub(super) fn thin_runs(runs: &[Vec<(f64, f64)>], columns: f64) -> Vec<Vec<(f64, f64)>> {
    if (runs.len() as f64) <= (columns / 2.0).max(1.0) {
        return runs.iter().map(|run| thin(run)).collect();
    }
    let all: Vec<(f64, f64)> = runs.iter().flatten().copied().collect();
    all.chunk_by(|a, b| a.0.floor() == b.0.floor()).map(thin).collect()
}

fn extremes(group: &[(f64, f64)]) -> (usize, usize) {
    let (mut low, mut high) = (0, 0);
    for (i, p) in group.iter().enumerate() {
        if p.1 < group[low].1 {
            low = i;
        }
        if p.1 > group[high].1 {
            high = i;
        }
    }
    (low, high)
}

/// Moves positions apart until neighbours are `gap` apart, each as little as possible, within `lo..=hi` as far as
/// there is room. Keeps the given order.
pub(super) fn spread(wanted: &[f64], gap: f64, lo: f64, hi: f64) -> Vec<f64> {
    let count = wanted.len();
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by(|&a, &b| wanted[a].total_cmp(&wanted[b]).then(a.cmp(&b)));
    // Isotonic regression of the wanted positions less the gaps: clusters of (sum, count).
    let mut clusters: Vec<(f64, usize)> = Vec::new();
    for (rank, &i) in order.iter().enumerate() {
        let mut cluster = (wanted[i] - rank as f64 * gap, 1);
        while let Some(&(sum, n)) = clusters.last() {
            if sum / n as f64 <= cluster.0 / cluster.1 as f64 {
                break;
            }
            cluster = (cluster.0 + sum, cluster.1 + n);
            clusters.pop();
        }
        clusters.push(cluster);
    }
    let top = lo.max(hi - count.saturating_sub(1) as f64 * gap);
    let means = clusters.iter().flat_map(|&(sum, n)| std::iter::repeat_n(sum / n as f64, n));
    let mut placed = vec![0.0; count];
    for (rank, (mean, &i)) in means.zip(&order).enumerate() {
        placed[i] = mean.clamp(lo, top) + rank as f64 * gap;
    }
    placed
}
