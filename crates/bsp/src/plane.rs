//! Planes, each once.

use sightlines_geometry::Point3;
use std::collections::HashMap;

/// The points `p` with `normal . p = distance`, in scene units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plane {
    /// Towards the front. Of any length but zero.
    pub normal: Point3,
    /// The distance from the origin, times the length of the normal.
    pub distance: f64,
}

/// Numbers other than 0 whose products of four, and sums of those, are ordinary doubles.
const MAGNITUDES: std::ops::RangeInclusive<f64> = 1e-60..=1e60;

impl Plane {
    /// Whether it is a plane, of numbers that determinants can be made of: each is 0 or from 1e-60 to 1e60, and one of the normal's is not 0.
    pub(crate) fn is_sound(&self) -> bool {
        let is_usable = |x: f64| x == 0.0 || MAGNITUDES.contains(&x.abs());
        self.normal.iter().all(|&x| is_usable(x)) && is_usable(self.distance) && self.normal.iter().any(|&x| x != 0.0)
    }
}

/// One of a set of planes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) struct PlaneId(u32);

/// A plane of a set, as a node of a tree has it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Oriented {
    pub(crate) id: PlaneId,
    /// Whether the node's front is the back of the plane in the set.
    pub(crate) is_flipped: bool,
}

impl Oriented {
    /// The side of a node, 0 for its front, on which a point lies that is on this side of the plane in the set (1: front, -1: back).
    pub(crate) fn side_of(self, sign: i32) -> usize {
        usize::from((sign < 0) != self.is_flipped)
    }

    /// The other way round: 1 or -1 for a side of the node.
    pub(crate) fn sign_of(self, side: usize) -> i32 {
        if (side == 1) == self.is_flipped { 1 } else { -1 }
    }
}

/// Planes without repeats: those with the same numbers, or with all of them negated, are one.
#[derive(Debug, Default)]
pub(crate) struct Planes {
    rows: Vec<[f64; 4]>,
    ids: HashMap<[u64; 4], PlaneId>,
}

impl Planes {
    /// Adds a sound plane, unless it is there.
    pub(crate) fn add(&mut self, plane: Plane) -> Oriented {
        let [x, y, z] = plane.normal;
        let first = [x, y, z].into_iter().find(|&k| k != 0.0).unwrap_or(1.0);
        let is_flipped = first < 0.0;
        let row = [x, y, z, plane.distance].map(|k| if is_flipped { 0.0 - k } else { k + 0.0 });
        let next = PlaneId(self.rows.len() as u32);
        let id = *self.ids.entry(row.map(f64::to_bits)).or_insert(next);
        if id == next {
            self.rows.push(row);
        }
        Oriented { id, is_flipped }
    }

    /// Normal and distance.
    pub(crate) fn row(&self, id: PlaneId) -> &[f64; 4] {
        &self.rows[id.0 as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plane_and_its_opposite_are_one() {
        let mut planes = Planes::default();
        let mut add = |x: f64, y: f64, d: f64| planes.add(Plane { normal: [x, y, 0.0], distance: d });
        let (a, b, c, d) = (add(1.0, 0.0, 5.0), add(-1.0, -0.0, -5.0), add(1.0, 0.0, -5.0), add(0.0, -1.0, 5.0));
        assert_eq!((a.id, a.is_flipped), (b.id, false));
        assert!(b.is_flipped && c.id != a.id && d.is_flipped);
        assert_eq!(planes.row(d.id), &[0.0, 1.0, 0.0, -5.0]);
        for plane in [a, b] {
            for side in [0, 1] {
                assert_eq!(plane.side_of(plane.sign_of(side)), side);
            }
        }
        assert_eq!([a.side_of(1), b.side_of(1), a.side_of(-1), b.side_of(-1)], [0, 1, 1, 0]);
    }

    #[test]
    fn planes_without_a_normal_or_with_wild_numbers_are_none() {
        let sound = |n: [f64; 3], distance: f64| Plane { normal: n, distance }.is_sound();
        assert!(sound([0.0, -0.6, 0.8], 0.0) && sound([0.0, 0.0, 1e-60], -1e60));
        assert!(!sound([0.0; 3], 1.0) && !sound([f64::NAN, 0.0, 1.0], 1.0) && !sound([1.0, 0.0, 0.0], f64::INFINITY));
        assert!(!sound([1e-61, 1.0, 0.0], 0.0) && !sound([1.0, 0.0, 0.0], 1e61));
    }
}
