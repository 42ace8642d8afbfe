//! Triangles that hide from their fronts only.

use super::weld::Mesh;
use crate::Occluder;
use sightlines_geometry::{Aabb, Point3, orient3d};
use std::collections::HashMap;

impl Mesh {
    /// Welds triangles that hide from both sides, and others that hide from their fronts only, where their corners go around
    /// counterclockwise. Two of these at one place with opposite fronts are one that hides from both sides. Costs as [`Self::weld`].
    pub fn weld_with_fronts(both_sides: &[[Point3; 3]], fronts: &[[Point3; 3]]) -> Self {
        if fronts.is_empty() {
            return Self::weld(both_sides);
        }
        // Of triangles with the same corners the first stays.
        let mut triangles = both_sides.to_vec();
        triangles.extend(with_both_fronts(fronts).into_iter().map(|k| fronts[k]));
        let n_both_sides = triangles.len() as u32;
        triangles.extend(fronts);
        let mut mesh = Self::weld(&triangles);
        let n = mesh.triangles().len() as u32;
        mesh.front_only = (0..n).map(|t| mesh.source(t) >= n_both_sides).collect();
        mesh
    }

    /// Whether a triangle hides from its front only.
    pub fn is_front_only(&self, triangle: u32) -> bool {
        self.front_only.get(triangle as usize) == Some(&true)
    }

    /// For each triangle whether it hides from its front only; empty if all hide from both sides.
    pub fn front_only(&self) -> &[bool] {
        &self.front_only
    }

    /// Whether no point of a box is behind a triangle, and some are before it. Exact.
    pub fn is_in_front(&self, triangle: u32, volume: &Aabb<3>) -> bool {
        let [a, b, c] = self.corners(triangle);
        let sides = volume.corners().map(|eye| orient3d(a, b, c, eye));
        sides.iter().all(|&side| side >= 0.0) && sides.iter().any(|&side| side > 0.0)
    }

    /// An occluder, as hiding from the sides that a triangle of it does.
    pub(super) fn sided(&self, triangle: u32, occluder: Occluder) -> Occluder {
        if self.is_front_only(triangle) { occluder.from_front() } else { occluder }
    }
}

/// Of triangles that lie on another one with the opposite front, the first of each such pair, by index.
fn with_both_fronts(triangles: &[[Point3; 3]]) -> Vec<usize> {
    let bits = |p: Point3| p.map(|x| (x + 0.0).to_bits());
    // From the least corner on, the direction tells the front.
    let key = |t: &[Point3; 3]| {
        let [p, q, r] = t.map(bits);
        let turns = [[p, q, r], [q, r, p], [r, p, q]];
        turns.into_iter().min().unwrap_or([p, q, r])
    };
    let mut first: HashMap<[[u64; 3]; 3], usize> = HashMap::new();
    (0..).zip(triangles).for_each(|(k, t)| _ = first.entry(key(t)).or_insert(k));
    let is_first = |k: usize| {
        let [p, q, r] = key(&triangles[k]);
        first[&[p, q, r]] == k && first.get(&[p, r, q]).is_some_and(|&opposite| k < opposite)
    };
    (0..triangles.len()).filter(|&k| is_first(k)).collect()
}
