//! Oracle: what does a point among boxes see?
//!
//! Method: what a ray meets changes only where the plane through the eye and an edge of a box is crossed. Edges run
//! along the axes, so in logarithms of a direction's coordinates these planes are lines of three kinds, and the
//! planar map that they make has a crossing at the rim of each of its faces: rays are shot all around each
//! crossing. No cells' portals, polygons or cones are known here.
//!
//! In doubles: faces narrower than some 10^-6 are not found, and eyes should not be in a plane with two edges at once.

use sightlines_geometry::{Aabb, Point3};

/// How far from a crossing rays are shot, in logarithms.
const STEP: f64 = 1e-6;

/// What a ray meets.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BoxHit {
    /// The place of the box among the solid ones.
    pub solid: usize,
    /// Distance as a multiple of the direction; 0 if the eye is on the box and looks into it.
    pub t: f64,
}

/// The range of a ray within a box, which may be flat; `None` if it passes by, or only touches an edge.
pub fn range_in_box(b: &Aabb<3>, eye: Point3, direction: Point3) -> Option<[f64; 2]> {
    let mut range = [f64::NEG_INFINITY, f64::INFINITY];
    for k in 0..3 {
        if direction[k] == 0.0 {
            if !(b.min[k] <= eye[k] && eye[k] <= b.max[k]) {
                return None;
            }
            continue;
        }
        let [s, t] = [b.min[k], b.max[k]].map(|x| (x - eye[k]) / direction[k]);
        range = [range[0].max(s.min(t)), range[1].min(s.max(t))];
    }
    (range[0] <= range[1]).then_some(range)
}

/// The first of some boxes that a ray meets; a flat one that the eye is in does not count.
pub fn first_box(solids: &[Aabb<3>], eye: Point3, direction: Point3) -> Option<BoxHit> {
    let hit = |(solid, b): (usize, &Aabb<3>)| {
        let [from, to] = range_in_box(b, eye, direction)?;
        (to > 0.0).then_some(BoxHit { solid, t: from.max(0.0) })
    };
    solids.iter().enumerate().filter_map(hit).min_by(|a, b| a.t.total_cmp(&b.t))
}

/// Directions of which at least one lies in each open set of directions in which a ray from `eye` passes the edges of
/// all boxes on the same sides. O(n²) for n boxes.
pub fn directions_among_boxes(boxes: &[Aabb<3>], eye: Point3) -> Vec<Point3> {
    let mut directions = Vec::new();
    for octant in 0..8 {
        let signs = [0, 1, 2].map(|k| if octant >> k & 1 == 1 { 1.0 } else { -1.0 });
        // By the axis along which the edges run: ln |d_b| - ln |d_a| for the two others. A line that is no edge's
        // makes sure that there are crossings.
        let ratios = [0, 1, 2].map(|axis| {
            let (a, b) = ((axis + 1) % 3, (axis + 2) % 3);
            let mut ratios = vec![0.123 + 0.1 * axis as f64];
            for corners in boxes.iter().map(|b| [b.min, b.max]) {
                for [p, q] in [[0, 0], [0, 1], [1, 0], [1, 1]] {
                    let [along, up] = [signs[a] * (corners[p][a] - eye[a]), signs[b] * (corners[q][b] - eye[b])];
                    if along > 0.0 && up > 0.0 {
                        ratios.push(up.ln() - along.ln());
                    }
                }
            }
            ratios.sort_by(f64::total_cmp);
            ratios.dedup_by(|a, b| (*a - *b).abs() < 1e-12);
            ratios
        });
        // Ratios of y to x, of z to y; that of x to z follows.
        let pairs = |p: &[f64], q: &[f64], at: &dyn Fn(f64, f64) -> [f64; 2]| -> Vec<[f64; 2]> {
            p.iter().flat_map(|&p| q.iter().map(move |&q| (p, q))).map(|(p, q)| at(p, q)).collect()
        };
        let [zy, xz, yx] = &ratios;
        let crossings =
            [pairs(yx, zy, &|u, v| [u, v]), pairs(yx, xz, &|u, w| [u, -w - u]), pairs(zy, xz, &|v, w| [-w - v, v])];
        for [u, v] in crossings.concat() {
            for k in 0..12 {
                // Along none of the lines, which run at 0, 90 and 135 degrees.
                let (sin, cos) = f64::from(10 + 30 * k).to_radians().sin_cos();
                let (u, v) = (u + STEP * cos, v + STEP * sin);
                let logarithms = [0.0, u, u + v];
                let most = logarithms.iter().fold(f64::NEG_INFINITY, |m: f64, x| m.max(*x));
                directions.push([0, 1, 2].map(|k| signs[k] * (logarithms[k] - most).exp()));
            }
        }
    }
    directions
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    fn cube(x: f64, y: f64, z: f64, size: f64) -> Aabb<3> {
        Aabb { min: [x, y, z], max: [x + size, y + size, z + size] }
    }

    /// The boxes that are first in some direction.
    fn seen(solids: &[Aabb<3>], eye: Point3) -> BTreeSet<usize> {
        let directions = directions_among_boxes(solids, eye);
        directions.iter().filter_map(|&d| first_box(solids, eye, d)).map(|hit| hit.solid).collect()
    }

    #[test]
    fn boxes_behind_boxes_are_not_seen() {
        let eye = [0.1, 0.2, 0.3];
        let [near, far, beside] = [cube(2., -1., -1., 2.), cube(6., -0.5, -0.5, 1.), cube(6., 4., 0., 1.)];
        assert_eq!(seen(&[near, far, beside], eye), BTreeSet::from([0, 2]));
        assert_eq!(seen(&[far], eye), BTreeSet::from([0]));
        // Through a slit of a thousandth, into a corner behind it.
        let wall = |min: f64, max: f64| Aabb { min: [3., min, -50.], max: [3.0001, max, 50.] };
        let slit = [wall(-50., 0.7), wall(0.701, 50.), cube(20., 3.5, 0., 1.), cube(20., 6., 0., 1.)];
        assert_eq!(seen(&slit, eye), BTreeSet::from([0, 1, 2]));
    }

    #[test]
    fn rays_meet_what_is_in_the_way() {
        let solids = [cube(2., 0., 0., 1.), Aabb { min: [1., 0., 0.], max: [1., 1., 1.] }];
        let at = |eye, d| first_box(&solids, eye, d);
        assert_eq!(at([0., 0.5, 0.5], [2., 0., 0.]), Some(BoxHit { solid: 1, t: 0.5 }));
        assert_eq!(at([1., 0.5, 0.5], [1., 0., 0.]), Some(BoxHit { solid: 0, t: 1.0 }));
        assert_eq!(at([2., 0.5, 0.5], [1., 0., 0.]), Some(BoxHit { solid: 0, t: 0.0 }));
        assert_eq!(at([0., 2., 0.5], [1., 0., 0.]), None);
        assert_eq!(range_in_box(&solids[0], [2.5, 0.5, 0.5], [0., 1., 0.]), Some([-0.5, 0.5]));
    }

    /// The impostor: directions around the edges of one box only miss what shows between two others.
    #[test]
    fn directions_of_too_few_edges_miss_a_slit() {
        let eye = [0.1, 0.2, 0.3];
        let wall = |min: f64, max: f64| Aabb { min: [3., min, -50.], max: [3.0001, max, 50.] };
        let solids = [wall(-50., 0.7), wall(0.701, 50.), cube(20., 3.5, 0., 1.)];
        let some = directions_among_boxes(&solids[2..], eye);
        assert!(some.iter().filter_map(|&d| first_box(&solids, eye, d)).all(|hit| hit.solid != 2));
    }
}
