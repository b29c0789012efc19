//! Free places for labels around their points.

type At = (f64, f64);

/// A rectangle on the sheet, in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Area {
    pub left: f64,
    pub top: f64,
    pub right: f64,
    pub bottom: f64,
}

impl Area {
    /// The rectangle around a centre, by half its width and height.
    pub fn around((x, y): At, (wide, high): (f64, f64)) -> Self {
        Self { left: x - wide, top: y - high, right: x + wide, bottom: y + high }
    }

    /// The rectangle between two corners, wider by `margin` on every side.
    pub fn between(a: At, b: At, margin: f64) -> Self {
        Self {
            left: a.0.min(b.0) - margin,
            top: a.1.min(b.1) - margin,
            right: a.0.max(b.0) + margin,
            bottom: a.1.max(b.1) + margin,
        }
    }

    pub fn middle(&self) -> At {
        ((self.left + self.right) / 2.0, (self.top + self.bottom) / 2.0)
    }

    fn overlaps(&self, other: &Self) -> bool {
        let across = self.left < other.right && other.left < self.right;
        across && self.top < other.bottom && other.top < self.bottom
    }

    fn within(&self, outer: &Self) -> bool {
        let across = self.left >= outer.left && self.right <= outer.right;
        across && self.top >= outer.top && self.bottom <= outer.bottom
    }

    /// The point of the rectangle that is nearest to `at`.
    fn nearest(&self, at: At) -> At {
        (at.0.clamp(self.left, self.right), at.1.clamp(self.top, self.bottom))
    }

    /// Whether a straight line passes through the rectangle.
    fn crossed(&self, (from, to): (At, At)) -> bool {
        let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
        for (a, b, lo, hi) in [(from.0, to.0, self.left, self.right), (from.1, to.1, self.top, self.bottom)] {
            let along = b - a;
            if along.abs() < 1e-9 {
                if a <= lo || a >= hi {
                    return false;
                }
                continue;
            }
            let (near, far) = ((lo - a) / along, (hi - a) / along);
            enter = enter.max(near.min(far));
            leave = leave.min(near.max(far));
        }
        enter < leave
    }
}

/// A label to place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wanted {
    /// Its point.
    pub at: At,
    /// Its width and height.
    pub size: (f64, f64),
}

/// Where a label goes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    pub area: Area,
    /// A line from the point to a label that is not beside it.
    pub leader: Option<(At, At)>,
}

/// Half the side of the square that a point's mark takes.
pub(super) const MARK: f64 = 6.5;
/// Distances of a label from its point, nearest first.
const DISTANCES: [f64; 12] = [9.5, 15.0, 21.0, 28.0, 38.0, 50.0, 65.0, 85.0, 110.0, 140.0, 180.0, 230.0];
/// A label nearer than this has no leader.
const BESIDE: f64 = 10.0;
/// The directions in which a label may be, in degrees clockwise from the right, the most usual first.
const DIRECTIONS: [f64; 24] = [
    0.0, -45.0, 45.0, -90.0, 90.0, 180.0, -135.0, 135.0, -20.0, 20.0, -160.0, 160.0, -65.0, 65.0, -115.0,
    115.0, -33.0, 33.0, -147.0, 147.0, -10.0, 10.0, -170.0, 170.0,
];
/// Points nearer to each other than this stand in each other's way.
const CROWD: f64 = 24.0;

/// Places labels inside `bounds`, each as near its point as it can be, off the marks of all points, off `taken`, and
/// off each other and their leaders. A label without a free place gets none.
pub(super) fn place(wanted: &[Wanted], marks: &[At], taken: &[Area], bounds: &Area) -> Vec<Option<Place>> {
    let mut order: Vec<usize> = (0..wanted.len()).collect();
    let mut nearest = vec![0; wanted.len()];
    let mut best: Vec<Option<Place>> = vec![None; wanted.len()];
    for _ in 0..=DISTANCES.len() {
        let mut sheet = Sheet { marks, taken, bounds, placed: vec![None; wanted.len()] };
        for &i in &order {
            sheet.placed[i] = sheet.find(&wanted[i], nearest[i]);
        }
        if sheet.placed.iter().flatten().count() > best.iter().flatten().count() {
            best.clone_from(&sheet.placed);
        }
        let Some(at) = order.iter().position(|&i| sheet.placed[i].is_none()) else { break };
        // A label that found no place goes first in the next round, and those around it move away from their points.
        let failed = wanted[order[at]].at;
        order[..=at].rotate_right(1);
        for (nearest, wanted) in nearest.iter_mut().zip(wanted) {
            let near = (wanted.at.0 - failed.0).hypot(wanted.at.1 - failed.1) < CROWD;
            *nearest = (*nearest + usize::from(near)).min(DISTANCES.len() - 1);
        }
    }
    best
}

/// What is on the sheet so far.
struct Sheet<'a> {
    marks: &'a [At],
    taken: &'a [Area],
    bounds: &'a Area,
    placed: Vec<Option<Place>>,
}

impl Sheet<'_> {
    fn find(&self, wanted: &Wanted, nearest: usize) -> Option<Place> {
        let at = |distance: f64| DIRECTIONS.iter().map(move |&way| candidate(wanted, way, distance));
        DISTANCES[nearest..].iter().flat_map(|&far| at(far)).find(|place| self.free(place, wanted.at))
    }

    fn free(&self, place: &Place, own: At) -> bool {
        let area = &place.area;
        let mark = |&at: &At| Area::around(at, (MARK, MARK));
        area.within(self.bounds)
            && !self.marks.iter().any(|at| mark(at).overlaps(area))
            && !self.taken.iter().any(|other| other.overlaps(area))
            && self.placed.iter().flatten().all(|other| apart(place, other))
            && place.leader.is_none_or(|leader| {
                // The mark of a point at the same place is the leader's own.
                let other = |at: &&At| (at.0 - own.0).abs().max((at.1 - own.1).abs()) > MARK;
                !self.marks.iter().filter(other).any(|at| mark(at).crossed(leader))
            })
    }
}

/// Whether neither the labels nor their leaders meet.
fn apart(one: &Place, other: &Place) -> bool {
    let clear = |area: &Area, leader: Option<(At, At)>| leader.is_none_or(|leader| !area.crossed(leader));
    let meet = |a: (At, At), b: (At, At)| {
        let side =
            |p: At, (from, to): (At, At)| (to.0 - from.0) * (p.1 - from.1) - (to.1 - from.1) * (p.0 - from.0);
        side(a.0, b) * side(a.1, b) < 0.0 && side(b.0, a) * side(b.1, a) < 0.0
    };
    let leaders = one.leader.zip(other.leader).is_none_or(|(a, b)| !meet(a, b));
    !one.area.overlaps(&other.area)
        && clear(&one.area, other.leader)
        && clear(&other.area, one.leader)
        && leaders
}

/// The label in one direction from its point, `distance` from it.
fn candidate(wanted: &Wanted, direction: f64, distance: f64) -> Place {
    let half = (wanted.size.0 / 2.0, wanted.size.1 / 2.0);
    let (up, along) = direction.to_radians().sin_cos();
    let beyond = |part: f64, half: f64| part * distance + (part * 2.0).clamp(-1.0, 1.0) * half;
    let middle = (wanted.at.0 + beyond(along, half.0), wanted.at.1 + beyond(up, half.1));
    let area = Area::around(middle, half);
    let end = area.nearest(wanted.at);
    let length = (end.0 - wanted.at.0).hypot(end.1 - wanted.at.1);
    let leader = (distance > BESIDE && length > MARK).then(|| {
        let on = |part: f64| {
            (wanted.at.0 + (end.0 - wanted.at.0) * part, wanted.at.1 + (end.1 - wanted.at.1) * part)
        };
        (on(MARK / length), on(1.0 - 1.0 / length))
    });
    Place { area, leader }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOUNDS: Area = Area { left: 0.0, top: 0.0, right: 400.0, bottom: 300.0 };

    fn label(at: At) -> Wanted {
        Wanted { at, size: (60.0, 14.0) }
    }

    #[test]
    fn a_lone_label_is_right_of_its_point_and_turns_away_from_an_edge() {
        let side = |at: At| {
            let place = place(&[label(at)], &[at], &[], &BOUNDS)[0].expect("a place");
            assert!(place.leader.is_none() && place.area.within(&BOUNDS), "{place:?}");
            place.area.middle().0 - at.0
        };
        assert!(side((100.0, 100.0)) > 30.0);
        assert!(side((395.0, 100.0)) < -30.0);
    }

    #[test]
    fn many_labels_at_one_point_keep_apart_and_off_what_is_taken() {
        let wanted = vec![label((200.0, 150.0)); 14];
        let marks = vec![(200.0, 150.0); 14];
        let line = Area::between((0.0, 140.0), (400.0, 140.0), 2.0);
        let places: Vec<Place> = place(&wanted, &marks, &[line], &BOUNDS).into_iter().flatten().collect();
        assert_eq!(places.len(), 14);
        for (i, one) in places.iter().enumerate() {
            assert!(!one.area.overlaps(&line), "{one:?}");
            assert!(places[..i].iter().all(|other| apart(one, other)), "{one:?}");
        }
        assert!(places.iter().any(|place| place.leader.is_some()));
    }

    #[test]
    fn a_label_without_room_gets_no_place() {
        let small = Area { left: 0.0, top: 0.0, right: 70.0, bottom: 40.0 };
        assert!(place(&[label((35.0, 20.0))], &[(35.0, 20.0)], &[], &small)[0].is_none());
        let wide = Area { right: 80.0, ..small };
        assert!(place(&[label((5.0, 20.0))], &[(5.0, 20.0)], &[], &wide)[0].is_some());
    }

    #[test]
    fn a_line_crosses_a_rectangle_or_passes_it() {
        let area = Area { left: 10.0, top: 10.0, right: 20.0, bottom: 20.0 };
        assert!(area.crossed(((0.0, 0.0), (30.0, 30.0))));
        assert!(area.crossed(((0.0, 15.0), (30.0, 15.0))));
        assert!(!area.crossed(((0.0, 0.0), (9.0, 9.0))));
        assert!(!area.crossed(((0.0, 25.0), (30.0, 25.0))));
        assert!(!area.crossed(((0.0, 12.0), (12.0, 0.0))));
    }
}
