//! Convex polygons in space, as who passes through them sees them.

use crate::{Point2, Point3, orient2d};

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
    /// The convex polygon around `points`, which are given in turn.
    ///
    /// Corners that a convex polygon does not have (repeated, on a straight line, or turning inwards by a
    /// rounding error) are left out, so that the polygon only grows: exactly, in the projection along the
    /// axis that the polygon faces most. O(n log n).
    ///
    /// `None` if no area is left, or if the points go round nothing, so that no direction is the crossing one.
    pub fn around(points: &[Point3]) -> Option<Self> {
        let normal = newell_normal(points);
        let axis = (0..3).max_by(|&i, &j| normal[i].abs().total_cmp(&normal[j].abs()))?;
        if !normal[axis].is_finite() || normal[axis] == 0.0 {
            return None;
        }
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        let flat = |p: &Point3| Point2::new(p[u], p[v]);
        let mut sorted: Vec<Point3> = points.to_vec();
        sorted.sort_by(|p, q| p[u].total_cmp(&q[u]).then(p[v].total_cmp(&q[v])).then(p[axis].total_cmp(&q[axis])));
        sorted.dedup_by(|p, q| flat(p) == flat(q));
        // Lower chain forwards, upper chain backwards: counter-clockwise in the projection.
        let mut corners: Vec<Point3> = Vec::with_capacity(sorted.len() + 1);
        for pass in 0..2 {
            let start = corners.len();
            let mut extend = |p: &Point3| {
                while let [.., a, b] = corners[start..] {
                    if orient2d(flat(&a), flat(&b), flat(p)) > 0.0 {
                        break;
                    }
                    corners.pop();
                }
                corners.push(*p);
            };
            if pass == 0 {
                sorted.iter().for_each(&mut extend)
            } else {
                sorted.iter().rev().for_each(&mut extend)
            }
            corners.pop();
        }
        if corners.len() < 3 {
            return None;
        }
        if normal[axis] < 0.0 {
            corners.reverse();
        }
        Some(Self { corners })
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

    #[test]
    fn nothing_is_no_portal() {
        assert!(Portal3::around(&[]).is_none());
        assert!(Portal3::around(&[[0.0; 3], [1.0, 1.0, 1.0], [2.0, 2.0, 2.0]]).is_none());
        let bow = [[0.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        assert!(Portal3::around(&bow).is_none());
        assert!(Portal3::around(&[[f64::NAN; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]).is_none());
    }
}
