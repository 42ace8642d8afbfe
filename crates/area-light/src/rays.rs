//! Rays from a light, in doubles: they save work, and estimate the share of a light where nothing is proven.

use crate::Side;
use crate::hull::{Hull, Light};
use sightlines_geometry::vector::sub;
use sightlines_geometry::{Aabb, BoxTree, Point3, Random, orient3d, ray_box, ray_triangle};
use sightlines_multifocal::Volume;
use sightlines_visible_surface::Faces;
use std::cell::Cell;

/// Faces in a leaf.
const PER_LEAF: usize = 4;
/// A hit within this share of a ray from either end is where the ray begins or ends: a lamp on a ceiling, a surface that
/// touches the lit one. Rays prove nothing, so this decides nothing.
const ENDS: f64 = 1e-9;

/// The faces of a scene that have an area, in a tree: all of them block.
#[derive(Debug)]
pub(crate) struct Blockers<'a> {
    faces: &'a Faces,
    ids: Vec<u32>,
    boxes: Vec<Aabb<3>>,
    tree: BoxTree<3>,
}

impl<'a> Blockers<'a> {
    /// O(n log² n).
    pub(crate) fn build(faces: &'a Faces) -> Self {
        let ids: Vec<u32> = faces.ids().filter(|&f| faces.has_area(f)).collect();
        let boxes: Vec<Aabb<3>> = ids.iter().map(|&f| faces.bounds(f)).collect();
        Self { faces, ids, tree: BoxTree::build(&boxes, PER_LEAF), boxes }
    }

    /// A face that may meet the interior of a hull; `hint` is tested first. `None` if certainly none does.
    pub(crate) fn any_in(&self, hull: &Hull<'_>, own: u32, hint: Option<u32>, n_asked: &mut u64) -> Option<u32> {
        if let Some(hint) = hint {
            *n_asked += 1;
            if hint != own && !hull.misses(self.faces.of(hint)) {
                return Some(hint);
            }
        }
        let found = Cell::new(None);
        self.tree.visit(
            |b| found.get().is_none() && !hull.misses_box(b),
            |i| {
                let face = self.ids[i as usize];
                if found.get().is_none() && face != own && !hull.misses_box(&self.boxes[i as usize]) {
                    *n_asked += 1;
                    if !hull.misses(self.faces.of(face)) {
                        found.set(Some(face));
                    }
                }
            },
        );
        found.get()
    }

    /// Whether the way between two points is blocked by another face than `own`.
    pub(crate) fn is_blocked(&self, from: Point3, to: Point3, own: u32) -> bool {
        let way = sub(to, from);
        // An axis along which nothing changes is looked at on its own, so that sides of boxes count as inside.
        let inverse = way.map(|x| if x == 0.0 { f64::NAN } else { 1.0 / x });
        let is_between = |b: &Aabb<3>, k: usize| b.min[k] <= from[k] && from[k] <= b.max[k];
        let passes = |b: &Aabb<3>| {
            let [first, last] = ray_box(b, from, inverse);
            first.max(0.0) <= last.min(1.0) + ENDS && (0..3).all(|k| way[k] != 0.0 || is_between(b, k))
        };
        let blocked = Cell::new(false);
        self.tree.visit(
            |b| !blocked.get() && passes(b),
            |i| {
                let face = self.ids[i as usize];
                if !blocked.get() && face != own && passes(&self.boxes[i as usize]) {
                    blocked.set(crosses(self.faces.of(face), from, way));
                }
            },
        );
        blocked.get()
    }

    /// The share of a light that lights a point of a face's side, by `n` rays to points that fill the light evenly, from 0 to 1.
    ///
    /// * `seed`: which of the points; neighbours with different seeds have noise instead of steps
    pub(crate) fn share(&self, light: &Volume, p: Point3, face: u32, side: Side, n: u32, seed: u64) -> f64 {
        let [a, b, c] = side.turned(*self.faces.of(face));
        let n = n.max(1);
        let arrives = |i: &u32| {
            let from = point_of(light, *i, seed);
            orient3d(a, b, c, from) > 0.0 && !self.is_blocked(from, p, face)
        };
        (0..n).filter(arrives).count() as f64 / f64::from(n)
    }

    /// For each of some rays from inner points of a light to inner points of a piece whether it arrives.
    pub(crate) fn probe(&self, light: &Light, turned: &[Point3; 3], corners: &[Point3; 3], own: u32) -> Probe {
        const WEIGHTS: [[f64; 3]; 4] = [[1.0 / 3.0; 3], [0.9, 0.05, 0.05], [0.05, 0.9, 0.05], [0.05, 0.05, 0.9]];
        let [a, b, c] = *turned;
        let mut probe = Probe::default();
        for (i, weights) in (0..).zip(WEIGHTS) {
            let from = point_of(&light.volume, i, 0);
            let to = crate::vector::weighted(corners, weights);
            // From behind nothing arrives, which does not mean that anything blocks.
            if orient3d(a, b, c, from) > 0.0 {
                let blocked = self.is_blocked(from, to, own);
                probe.any_blocked |= blocked;
                probe.any_free |= !blocked;
            }
        }
        probe
    }
}

/// What some rays did.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Probe {
    pub(crate) any_free: bool,
    pub(crate) any_blocked: bool,
}

/// Point `i` of a sequence that fills a light evenly, moved round by what `seed` says.
///
/// Source: sums of one irrational step: Kronecker's sequence, with the fractions of roots of primes; moved: Cranley and Patterson,
/// "Randomization of number theoretic methods for multiple integration", SIAM J. Numerical Analysis 13(6), 1976.
pub(crate) fn point_of(light: &Volume, i: u32, seed: u64) -> Point3 {
    const STEPS: Point3 = [0.414_213_562_373_095, 0.732_050_807_568_877, 0.236_067_977_499_790];
    let b = light.bounds();
    let mut state = seed;
    std::array::from_fn(|k| {
        state = Random::new(state).bits();
        let start = (state >> 11) as f64 / (1u64 << 53) as f64;
        let part = (start + f64::from(i) * STEPS[k]).fract();
        (b.min[k] + (b.max[k] - b.min[k]) * part).clamp(b.min[k], b.max[k])
    })
}

/// Whether a triangle is met, not at the very ends of the way.
fn crosses(triangle: &[Point3; 3], from: Point3, way: Point3) -> bool {
    let [x, y, t] = ray_triangle(triangle, from, way);
    x >= 0.0 && y >= 0.0 && x + y <= 1.0 && t > ENDS && t < 1.0 - ENDS
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_fill_a_light() {
        let light = Volume::new(Aabb { min: [0.0, 0.0, 2.0], max: [4.0, 1.0, 2.0] }).unwrap();
        for seed in 0..3 {
            let mut counts = [0; 4];
            for i in 0..400 {
                let p = point_of(&light, i, seed);
                assert!(light.bounds().contains(p));
                counts[p[0] as usize % 4] += 1;
            }
            assert!(counts.iter().all(|&n| (90..=110).contains(&n)), "{counts:?}");
        }
        assert_ne!(point_of(&light, 0, 1), point_of(&light, 0, 2));
    }

    #[test]
    fn ways_are_blocked_in_between_only() {
        let faces = Faces::new(vec![[[-4., -4., 1.], [4., -4., 1.], [0., 8., 1.]]]).unwrap();
        let blockers = Blockers::build(&faces);
        assert!(blockers.is_blocked([0.0; 3], [0., 0., 2.], 9));
        assert!(!blockers.is_blocked([0.0; 3], [0., 0., 2.], 0));
        assert!(!blockers.is_blocked([0.0; 3], [0., 0., 1.], 9));
        assert!(!blockers.is_blocked([0., 0., 1.], [0., 0., 2.], 9));
        assert!(!blockers.is_blocked([0.0; 3], [9., 0., 2.], 9));
    }
}
