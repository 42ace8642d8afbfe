//! What closed surfaces hide from eyes outside of them, or inside: exactly, target by target.
//!
//! # Why it is hidden
//! Let a set of triangles pass every edge an even number of times. Then the number of its triangles that a ray from a point crosses is odd or even
//! for all rays, and it is the same all along a path that does not meet the set. So if it is odd at a target and even at the eye, or the other way
//! round, every segment between them meets a triangle of the set; and if the target does not meet the set, before its end.
//!
//! Triangles that hide from their front only count if the surface is closed with its fronts outwards ([`is_closed_outwards`]) and the eye is outside
//! of the box around it. Then each piece of the surface winds around a point once or not at all, and around the eye not at all. A segment to
//! a point inside passes more of its triangles from the front than from the back, so at least one; and whatever passes a triangle of a piece from its back has
//! passed one of the same piece from its front before: to such an eye all of the surface hides ([`ClosedSurfaces::walls`]).

use crate::parity::Parity;
use crate::surface::{Chain, chains};
use sightlines_cells::closed::is_closed_outwards;
use sightlines_cells::{Scene, SceneObject};
use sightlines_geometry::{Aabb, Point3};

/// The closed surfaces of a scene.
#[derive(Debug, Clone)]
pub struct ClosedSurfaces {
    parity: Parity,
    /// How many of them hide from both sides; those behind them in the order do from their fronts.
    n_both: usize,
    /// Of those that hide from their fronts, the triangles and the box around them.
    fronts: Vec<(Vec<[Point3; 3]>, Aabb<3>)>,
}

/// On which sides of closed surfaces the eyes of a box are.
#[derive(Debug, Clone, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct EyeSides {
    /// Those that all eyes are inside of, unless they are in `unknown`; ascending.
    odd: Vec<u32>,
    /// Those that hide nothing from these eyes, as far as is known; ascending.
    unknown: Vec<u32>,
}

impl EyeSides {
    /// Eyes outside of the box around the scene.
    pub const OUTSIDE: Self = Self { odd: Vec::new(), unknown: Vec::new() };
}

impl ClosedSurfaces {
    /// Finds them: for each object, and for all together, the pieces of what hides that hang together by edges and are closed. Corners hang
    /// together where they are equal. O(n log n).
    pub fn new(scene: &Scene) -> Self {
        let are_closed = |chain: &Chain| chain.holes.is_empty();
        let mut all: Vec<Chain> = chains(&scene.opaque_part(), 0.0).into_iter().filter(are_closed).collect();
        let n_both = all.len();
        let fronts = Scene::new(scene.fronts().map(|(_, object)| object.clone()).collect());
        let fronts = fronts.expect("it is a part of a scene");
        let is_outwards = |chain: &Chain| are_closed(chain) && is_closed_outwards(&object_of(&chain.triangles));
        all.extend(chains(&fronts, 0.0).into_iter().filter(is_outwards));
        let around = |chain: &Chain| Aabb::around(chain.triangles.iter().flatten().copied());
        let fronts = all[n_both..].iter().map(|chain| (chain.triangles.clone(), around(chain))).collect();
        Self { parity: Parity::new(&all), n_both, fronts }
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.n_both + self.fronts.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Where eyes in a closed box are.
    pub fn sides_of(&self, volume: &Aabb<3>) -> EyeSides {
        let mut unknown = self.parity.meeting(volume);
        let near = |k: &usize| !is_outside(volume, &self.fronts[*k].1);
        unknown.extend((0..self.fronts.len()).filter(near).map(|k| (self.n_both + k) as u32));
        unknown.sort_unstable();
        unknown.dedup();
        EyeSides { odd: self.parity.odd_at(volume.min), unknown }
    }

    /// Where eyes are that go from a closed box wherever surfaces that hide from both sides let them: on the same sides of those as in the box.
    pub fn sides_of_joined(&self, volume: &Aabb<3>) -> EyeSides {
        let mut sides = self.sides_of(volume);
        sides.unknown.retain(|c| (*c as usize) < self.n_both);
        sides.unknown.extend((self.n_both..self.len()).map(|c| c as u32));
        sides
    }

    /// Whether every segment from the eyes to the triangle is blocked before it ends. Never wrongly yes; no for what touches a surface
    /// around it. Costs a ray and what is near the triangle, and for each item of `eyes` the surfaces around both.
    pub fn hide(&self, eyes: &[EyeSides], triangle: &[Point3; 3]) -> bool {
        if self.is_empty() || eyes.is_empty() {
            return false;
        }
        let odd = self.parity.odd_at(triangle[0]);
        if odd.is_empty() && eyes.iter().any(|eyes| eyes.odd.is_empty()) {
            return false;
        }
        let met = self.parity.meeting_triangle(triangle);
        let has = |list: &[u32], c: u32| list.binary_search(&c).is_ok();
        eyes.iter().all(|eyes| {
            odd.iter()
                .chain(&eyes.odd)
                .any(|&c| has(&odd, c) != has(&eyes.odd, c) && !has(&met, c) && !has(&eyes.unknown, c))
        })
    }

    /// The triangles of surfaces that hide from their fronts, of which all hide from eyes in all of these boxes; with no box, from eyes outside of the box around
    /// the scene.
    pub fn walls<'a>(&'a self, volumes: &'a [Aabb<3>]) -> impl Iterator<Item = &'a [Point3; 3]> {
        let is_wall = |(_, around): &&(Vec<_>, Aabb<3>)| volumes.iter().all(|volume| is_outside(volume, around));
        self.fronts.iter().filter(is_wall).flat_map(|(triangles, _)| triangles)
    }
}

fn is_outside(volume: &Aabb<3>, around: &Aabb<3>) -> bool {
    (0..3).any(|k| volume.max[k] < around.min[k] || around.max[k] < volume.min[k])
}

fn object_of(triangles: &[[Point3; 3]]) -> SceneObject {
    let indices = (0..triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    SceneObject { name: String::new(), vertices: triangles.as_flattened().to_vec(), triangles: indices }
}
