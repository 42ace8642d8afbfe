//! Convex polygons in space, as who passes through them sees them.

use crate::{Point2, Point3, orient2d, orient3d};

/// An open convex polygon in space, with the direction in which it is crossed.
///
/// Its corners go round counter-clockwise about the direction of crossing (right-hand rule). It is as flat
/// as its coordinates are: those of files carry rounding errors. What passes it is therefore said of its
/// edges: a directed line passes if it has every edge, directed from corner to corner, strictly on its
/// inner side.
#[derive(Debug, Clone, PartialEq)]
pub struct Portal3 {
    corners: Vec<Point3>,
}

impl Portal3 {
    /// The convex polygon around `points`, which are given in turn. Corners that are left keep their order, and the
    /// first of them stays the first.
    ///
    /// A point is left out only if no line needs it: every line that has all edges of the polygon on its inner side
    /// has those of the smaller one there too. With `o` the line seen along itself, the corners' directions from `o`
    /// go round once, so that `o` is inside their hull as it is seen. Were the step over a corner left out a half turn
    /// or more, all other corners would be in the rest of the turn, and `o` outside of their hull; which cannot be if
    /// that corner lies in the hull of the others in space. So this leaves out exactly
    ///
    /// * repeated points, and points between two others on a straight line;
    /// * if all points are on one plane, exactly, whatever is not a corner of their hull.
    ///
    /// Of points that are not on one plane, a corner may turn inwards as seen from one side and outwards as seen
    /// from another. If the turn is by rounding (below `2^-20`, seen along the axis that the polygon faces most) it
    /// stays. If it is more, the points are those of no convex polygon, and it is left out: that widens what passes by
    /// the dent, but for lines nearly in the plane. O(n log n).
    ///
    /// `None` if no area is left, or if the points go round nothing, so that no direction is the crossing one.
    pub fn around(points: &[Point3]) -> Option<Self> {
        let mut points = points.to_vec();
        points.dedup();
        while points.len() > 1 && points.first() == points.last() {
            points.pop();
        }
        let view = View::along(newell_normal(&points))?;
        let hull = hull(&points, &view);
        if hull.len() < 3 {
            return None;
        }
        let is_in_turn = hull.windows(2).all(|pair| pair[0] < pair[1]);
        let kept = if is_in_turn && !are_on_one_plane(&points) { with_bends(&points, &hull, &view) } else { hull };
        Some(Self { corners: kept.into_iter().map(|i| points[i]).collect() })
    }

    /// The portal with these corners, all of them and as they are. For corners that [`Portal3::around`] has left once
    /// before. O(n).
    ///
    /// `None` if they are less than three, or go round nothing.
    pub fn of_corners(corners: Vec<Point3>) -> Option<Self> {
        let has_direction = View::along(newell_normal(&corners)).is_some();
        (corners.len() >= 3 && has_direction).then_some(Self { corners })
    }

    /// The corners, at least three.
    pub fn corners(&self) -> &[Point3] {
        &self.corners
    }

    /// The edges, from corner to corner.
    pub fn edges(&self) -> impl ExactSizeIterator<Item = [Point3; 2]> + '_ {
        let n = self.corners.len();
        (0..n).map(move |i| [self.corners[i], self.corners[(i + 1) % n]])
    }

    /// The same portal for a viewer who crosses it the other way.
    #[must_use]
    pub fn reversed(&self) -> Self {
        Self { corners: self.corners.iter().rev().copied().collect() }
    }

    /// The direction of crossing: twice the area long, rounded.
    pub fn normal(&self) -> Point3 {
        newell_normal(&self.corners)
    }

    /// How far the farthest corner is from the plane through their middle across the normal, rounded; 0 for a
    /// triangle. O(n).
    pub fn unevenness(&self) -> f64 {
        if self.corners.len() == 3 {
            return 0.0;
        }
        let normal = self.normal();
        let largest = normal.into_iter().fold(0.0, |m: f64, x| m.max(x.abs()));
        // Squares of what is far from 1 would not be doubles.
        let normal = normal.map(|x| x / largest);
        let length = normal.into_iter().map(|x| x * x).sum::<f64>().sqrt();
        let first = self.corners[0];
        let height = |p: &Point3| (0..3).map(|k| normal[k] * (p[k] - first[k])).sum::<f64>() / length;
        let middle = self.corners.iter().map(height).sum::<f64>() / self.corners.len() as f64;
        self.corners.iter().map(|p| (height(p) - middle).abs()).fold(0.0, f64::max)
    }
}

/// Space seen along an axis, so that what goes round the normal goes round counter-clockwise.
struct View {
    axes: [usize; 2],
}

impl View {
    /// Along the axis that the normal is nearest to; `None` if that says nothing.
    fn along(normal: Point3) -> Option<Self> {
        let axis = (0..3).max_by(|&i, &j| normal[i].abs().total_cmp(&normal[j].abs()))?;
        if !normal[axis].is_finite() || normal[axis] == 0.0 {
            return None;
        }
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        Some(Self { axes: if normal[axis] > 0.0 { [u, v] } else { [v, u] } })
    }

    fn of(&self, p: &Point3) -> Point2 {
        Point2::new(p[self.axes[0]], p[self.axes[1]])
    }
}

/// The corners of the convex hull in a view, counter-clockwise, as indices; the least index first. Exact.
fn hull(points: &[Point3], view: &View) -> Vec<usize> {
    let flat: Vec<Point2> = points.iter().map(|p| view.of(p)).collect();
    let mut sorted: Vec<usize> = (0..points.len()).collect();
    sorted.sort_by(|&i, &j| flat[i].x.total_cmp(&flat[j].x).then(flat[i].y.total_cmp(&flat[j].y)).then(i.cmp(&j)));
    sorted.dedup_by(|i, j| flat[*i] == flat[*j]);
    let mut corners: Vec<usize> = Vec::with_capacity(sorted.len() + 1);
    // Lower chain forwards, upper chain backwards.
    for pass in 0..2 {
        let start = corners.len();
        let mut extend = |&p: &usize| {
            while let [.., a, b] = corners[start..] {
                if orient2d(flat[a], flat[b], flat[p]) > 0.0 {
                    break;
                }
                corners.pop();
            }
            corners.push(p);
        };
        if pass == 0 {
            sorted.iter().for_each(&mut extend);
        } else {
            sorted.iter().rev().for_each(&mut extend);
        }
        corners.pop();
    }
    let least = (0..corners.len()).min_by_key(|&k| corners[k]).unwrap_or(0);
    corners.rotate_left(least);
    corners
}

/// The corners of the hull, and of the points between two of them those where the way bends by no more than rounding
/// does; but not those on a straight line.
fn with_bends(points: &[Point3], hull: &[usize], view: &View) -> Vec<usize> {
    let mut kept = Vec::with_capacity(points.len());
    for (k, &from) in hull.iter().enumerate() {
        let to = hull[(k + 1) % hull.len()];
        let chord = view.of(&points[to]) - view.of(&points[from]);
        let along = |i: usize, j: usize| {
            let step = view.of(&points[j]) - view.of(&points[i]);
            chord.perp_dot(step).abs() <= BEND * chord.dot(step)
        };
        kept.push(from);
        let between = (from + 1..if to > from { to } else { points.len() }).chain(0..if to > from { 0 } else { to });
        for i in between {
            let last = kept[kept.len() - 1];
            let steps = view.of(&points[last]) != view.of(&points[i]) && view.of(&points[i]) != view.of(&points[to]);
            let is_bend = steps && along(last, i) && along(i, to);
            if is_bend && !are_on_one_line([points[last], points[i], points[to]]) {
                kept.push(i);
            }
        }
    }
    // In turn from the first point on, which may be a bend.
    kept.sort_unstable();
    kept
}

/// What a corner may turn inwards by, as a tangent, to be one of a convex polygon all the same.
const BEND: f64 = 1.0 / (1 << 20) as f64;

/// Whether three points are, exactly.
fn are_on_one_line([a, b, c]: [Point3; 3]) -> bool {
    [(0, 1), (1, 2), (2, 0)].into_iter().all(|(u, v)| {
        let [a, b, c] = [a, b, c].map(|p| Point2::new(p[u], p[v]));
        orient2d(a, b, c) == 0.0
    })
}

/// Whether all points are, exactly.
fn are_on_one_plane(points: &[Point3]) -> bool {
    let Some((&a, rest)) = points.split_first() else { return true };
    let Some(&b) = rest.iter().find(|&&p| p != a) else { return true };
    let Some(&c) = rest.iter().find(|&&p| !are_on_one_line([a, b, p])) else { return true };
    points.iter().all(|&p| orient3d(a, b, c, p) == 0.0)
}

/// Newell's normal: the sum of the cross products of successive corners, seen from the first.
fn newell_normal(points: &[Point3]) -> Point3 {
    let Some(&o) = points.first() else { return [0.0; 3] };
    let from_first = |p: &Point3| [p[0] - o[0], p[1] - o[1], p[2] - o[2]];
    points.windows(2).fold([0.0; 3], |sum, pair| {
        let (a, b) = (from_first(&pair[0]), from_first(&pair[1]));
        let cross = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
        [sum[0] + cross[0], sum[1] + cross[1], sum[2] + cross[2]]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_convex_polygon_keeps_its_corners_and_its_direction() {
        let square = [[0.0, 0.0, 5.0], [2.0, 0.0, 5.0], [2.0, 2.0, 5.0], [0.0, 2.0, 5.0]];
        let portal = Portal3::around(&square).unwrap();
        assert_eq!(portal.normal(), [0.0, 0.0, 8.0]);
        assert_eq!(portal.corners().len(), 4);
        let turned: Vec<Point3> = square.iter().rev().copied().collect();
        assert_eq!(Portal3::around(&turned).unwrap().normal(), [0.0, 0.0, -8.0]);
        assert_eq!(portal.reversed().normal(), [0.0, 0.0, -8.0]);
        assert_eq!(portal.edges().count(), 4);
    }

    #[test]
    fn corners_that_are_none_are_left_out() {
        let dent = 1e-13;
        let points = [
            [0.0, 0.0, 5.0],
            [1.0, dent, 5.0],
            [2.0, 0.0, 5.0],
            [2.0, 0.0, 5.0],
            [2.0, 1.0, 5.0],
            [2.0, 2.0, 5.0],
            [0.0, 2.0, 5.0],
        ];
        let portal = Portal3::around(&points).unwrap();
        assert_eq!(portal.corners().len(), 4);
        assert_eq!(portal.normal(), [0.0, 0.0, 8.0]);
        // Bent outwards it is a corner.
        let mut points = points;
        points[1][1] = -dent;
        assert_eq!(Portal3::around(&points).unwrap().corners().len(), 5);
    }

    /// Of points on no plane none is left out: what turns inwards seen from one side turns outwards from another.
    #[test]
    fn corners_off_the_plane_stay() {
        let (h, mut n_lines) = (1e-9, 0);
        for (dy, dz) in [(1e-9, h), (1e-9, -h), (0.0, h), (-1e-9, h)] {
            let points =
                [[0.0, 0.0, 5.0], [1.0, dy, 5.0 + dz], [2.0, 0.0, 5.0], [2.0, 2.0, 5.0 + 0.5 * h], [0.0, 2.0, 5.0]];
            let portal = Portal3::around(&points).unwrap();
            assert_eq!(portal.corners(), points, "{dy} {dz}");
            assert!((0.1 * h..h).contains(&portal.unevenness()));
            // A slanted line between the bend and the chord, which one of the two polygons lets pass.
            let without = Portal3::of_corners([&points[..1], &points[2..]].concat()).unwrap();
            let passes = |portal: &Portal3, d: Point3| {
                let a = [1.0, 0.5 * (dy - dz * d[1] / d[2]), 5.0];
                let b = [a[0] + d[0], a[1] + d[1], a[2] + d[2]];
                portal.edges().all(|[e, f]| orient3d(a, b, e, f) > 0.0)
            };
            let narrowed = [[0.0, 8.0, 1.0], [0.0, -8.0, 1.0]].map(|d| passes(&portal, d) && !passes(&without, d));
            n_lines += narrowed.into_iter().filter(|&n| n).count();
        }
        assert_eq!(n_lines, 4, "lines that would be lost without the corner");
    }

    #[test]
    fn the_order_stays_and_doing_it_again_changes_nothing() {
        let points = [[4.0, 0.0, 0.1], [4.0, 3.0, 0.7], [4.0, 5.0, 1.1 - 1e-13], [1.0, 5.0, 2.0], [0.0, 0.0, 0.3]];
        for turn in 0..points.len() {
            let turned = [&points[turn..], &points[..turn]].concat();
            let back: Vec<Point3> = turned.iter().rev().copied().collect();
            for given in [turned, back] {
                let portal = Portal3::around(&given).unwrap();
                assert_eq!(portal.corners()[0], given[0]);
                assert_eq!(Portal3::around(portal.corners()).as_ref(), Some(&portal));
                assert_eq!(Portal3::of_corners(portal.corners().to_vec()).as_ref(), Some(&portal));
            }
        }
    }

    #[test]
    fn dents_are_left_out() {
        let dented = |off: f64| {
            let points = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [2.0, 1.0, off], [4.0, 4.0, 0.0], [0.0, 4.0, -off]];
            Portal3::around(&points).unwrap().corners().len()
        };
        assert_eq!([dented(0.0), dented(1e-13)], [4, 4]);
        // On a straight line, in space as well: exactly.
        let line = [[0.0, 0.0, 0.0], [1.0, 2.0, 4.0], [2.0, 4.0, 8.0], [-4.0, 4.0, 1.0], [-4.0, 1.0, 0.3]];
        assert_eq!(Portal3::around(&line).unwrap().corners().len(), 4);
        let doubled = [line[0], line[0], line[2], line[3], line[4], line[0]];
        assert_eq!(Portal3::around(&doubled).unwrap().corners().len(), 4);
    }

    #[test]
    fn nothing_is_no_portal() {
        assert!(Portal3::of_corners(vec![[0.0; 3], [1.0, 0.0, 0.0]]).is_none());
        assert!(Portal3::of_corners(vec![[0.0; 3], [1.0; 3], [2.0; 3]]).is_none());
        assert!(Portal3::around(&[]).is_none());
        assert!(Portal3::around(&[[0.0; 3], [1.0, 1.0, 1.0], [2.0, 2.0, 2.0]]).is_none());
        let bow = [[0.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        assert!(Portal3::around(&bow).is_none());
        assert!(Portal3::around(&[[f64::NAN; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]).is_none());
    }
}
