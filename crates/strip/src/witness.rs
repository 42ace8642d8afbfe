//! Free segments from eyes to what they see: found by rays in doubles, decided exactly.

use crate::eyes::{Eyes, around};
use crate::space::Stations;
use sightlines_cells::Scene;
use sightlines_from_region::may_meet;
use sightlines_geometry::vector::{length, sub};
use sightlines_geometry::{Aabb, BoxTree, Point3, Random, check_coordinate, orient3d, ray_triangle};
use sightlines_multifocal::{RaySampler, Volume};
use std::cell::Cell;
use std::ops::Range;

/// How far a segment goes on behind what it sees, as a share of its length: the larger is tried first. A segment that ends on a triangle to within
/// rounding would prove nothing.
const BEYOND: [f64; 2] = [1.0 / (1u64 << 30) as f64, 1.0 / (1u64 << 40) as f64];

/// How far rays are from a free segment that they are near to, as shares of its length.
const NEAR: [f64; 4] = [0.3, 0.1, 0.02, 0.003];

/// What is looked at: an object, or one of its triangles.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Aim<'t> {
    pub(crate) object: u32,
    /// The triangle that has to be seen, if any of the object is not enough.
    pub(crate) only: Option<u32>,
    /// All triangles of the object, or the sides of the box that it does not leave.
    pub(crate) triangles: &'t [[Point3; 3]],
}

impl Aim<'_> {
    /// One of its triangles.
    pub(crate) fn one(&self, triangle: usize) -> Self {
        Self { only: Some(triangle as u32), ..*self }
    }
}

/// The triangles that hide, for rays and segments.
#[derive(Debug)]
pub(crate) struct Walls<'s> {
    scene: &'s Scene,
    bounds: Aabb<3>,
    rays: RaySampler,
    /// For each object the place of its first triangle among all.
    first: Vec<u32>,
    tree: BoxTree<3>,
}

/// Whether an object hides at all.
fn hides(scene: &Scene, object: u32) -> bool {
    scene.is_opaque(object) || scene.hides_from_front(object)
}

impl<'s> Walls<'s> {
    /// O(n log n).
    pub(crate) fn new(scene: &'s Scene) -> Self {
        let triangles_of = |(object, of): (u32, &sightlines_cells::SceneObject)| -> Vec<[Point3; 3]> {
            if hides(scene, object) { of.corners().collect() } else { Vec::new() }
        };
        let objects: Vec<Vec<[Point3; 3]>> = (0..).zip(scene.objects()).map(triangles_of).collect();
        let mut first = vec![0];
        objects.iter().for_each(|of| first.push(first[first.len() - 1] + of.len() as u32));
        let rays = RaySampler::new(objects.iter().map(Vec::as_slice))
            .with_single_sided(|object| scene.is_single_sided(object))
            .with_front_occluders(|object| scene.hides_from_front(object));
        let boxes: Vec<Aabb<3>> = rays.triangles().iter().map(|t| Aabb::around(*t)).collect();
        Self { scene, bounds: scene.bounds(), rays, first, tree: BoxTree::build(&boxes, 4) }
    }

    /// A free segment to what is looked at, by so many rays from eyes towards points of some of its triangles.
    pub(crate) fn find(
        &self,
        eyes: &Eyes,
        aim: &Aim<'_>,
        among: Range<usize>,
        n_rays: u32,
        random: &mut Random,
    ) -> Option<[Point3; 2]> {
        (0..n_rays).find_map(|_| {
            let t = aim.triangles[among.start + random.below(among.len())];
            let (u, v) = (random.open_unit(), random.open_unit());
            let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
            let point = [0, 1, 2].map(|k| t[0][k] + u * (t[1][k] - t[0][k]) + v * (t[2][k] - t[0][k]));
            let towards = random.direction();
            let eye = eyes.any(&self.bounds, point, towards, random);
            self.along(eyes, aim, &t, [eye, point])
        })
    }

    /// The segment from an eye towards a point of a triangle, if what is looked at is seen along it.
    ///
    /// * `at`: the triangle that has the point
    pub(crate) fn along(
        &self,
        eyes: &Eyes,
        aim: &Aim<'_>,
        at: &[Point3; 3],
        [eye, point]: [Point3; 2],
    ) -> Option<[Point3; 2]> {
        let is_joined = || eyes.stations_near(eye).into_iter().any(|from| self.is_way([from, eye]));
        if !eyes.holds(&self.bounds, eye) && !is_joined() {
            return None;
        }
        let way = sub(point, eye);
        let hit = self.rays.first_triangle(eye, way);
        let far = |t: u32| ray_triangle(&self.rays.triangles()[t as usize], eye, way)[2];
        let (seen, end) = if hides(self.scene, aim.object) {
            let hit = hit?;
            let is_aim = self.rays.object_of(hit) == aim.object
                && aim.only.is_none_or(|only| self.first[aim.object as usize] + only == hit);
            (is_aim.then(|| self.rays.triangles()[hit as usize])?, far(hit))
        } else {
            (hit.is_none_or(|hit| far(hit) > 1.0).then_some(*at)?, 1.0)
        };
        let is_own = |t: u32| {
            let object = self.rays.object_of(t);
            object == aim.object && aim.only.is_none_or(|only| self.first[object as usize] + only == t)
        };
        let ends =
            BEYOND.map(|beyond| -> Point3 { std::array::from_fn(|k| eye[k] + way[k] * (end + beyond * end.max(1.0))) });
        let proves = |end: &Point3| {
            if end.iter().any(|&x| check_coordinate(x).is_err()) {
                return false;
            }
            let side = passes(&seen, [eye, *end]);
            let is_shown = if self.scene.is_single_sided(aim.object) { side > 0.0 } else { side != 0.0 };
            is_shown && self.is_free([eye, *end], is_own)
        };
        ends.into_iter().find(proves).map(|end| [eye, end])
    }

    /// What a ray near a free segment hits, if it is in question: the object, the triangle, and the free segment to it.
    ///
    /// * `is_open`: whether a triangle of an object is in question
    /// * `counts`: whether triangles of an object count one by one
    pub(crate) fn near(
        &self,
        eyes: &Eyes,
        [eye, end]: [Point3; 2],
        random: &mut Random,
        is_open: &impl Fn(u32, u32) -> bool,
        counts: impl Fn(u32) -> bool,
    ) -> Option<(u32, u32, [Point3; 2])> {
        let reach = length(sub(end, eye)) * NEAR[random.below(NEAR.len())];
        let mut moved = |p: Point3| -> Point3 { [0, 1, 2].map(|k| p[k] + reach * (2.0 * random.unit() - 1.0)) };
        // Who walks looks from where a way was found to.
        let (eye, end) = (if eyes.are_joined() { eye } else { moved(eye) }, moved(end));
        if !eyes.holds(&self.bounds, eye) {
            return None;
        }
        let hit = self.rays.first_triangle(eye, sub(end, eye))?;
        let object = self.rays.object_of(hit);
        let t = hit - self.first[object as usize];
        if !is_open(object, t) {
            return None;
        }
        let aim = Aim { object, only: counts(object).then_some(t), triangles: &[] };
        let free = self.along(eyes, &aim, &self.rays.triangles()[hit as usize], [eye, end])?;
        Some((object, t, free))
    }

    /// Points that ways lead to from some boxes.
    pub(crate) fn stations(&self, boxes: &[Volume], random: &mut Random) -> Stations {
        let outside = around(&self.bounds);
        let far = (0..3).map(|k| outside.max[k] - outside.min[k]).fold(0.0, f64::max);
        Stations::find(boxes, random, |from, towards, share| {
            // As far as something is, or the other end of the scene.
            let way = towards.map(|x| x * far);
            let hit = self.rays.first_triangle(from, way);
            let end = hit.map_or(1.0, |t| ray_triangle(&self.rays.triangles()[t as usize], from, way)[2].min(1.0));
            let to: Point3 = std::array::from_fn(|k| from[k] + way[k] * end * share);
            (outside.contains(to) && self.is_way([from, to])).then_some(to)
        })
    }

    /// Whether a segment leads from one place of the eye to another.
    fn is_way(&self, [from, to]: [Point3; 2]) -> bool {
        to.iter().all(|&x| check_coordinate(x).is_ok()) && self.is_free([from, to], |_| false)
    }

    /// Whether no triangle that hides touches a segment, but for those that are passed from behind, and `but`. Exact, but that it may be
    /// no where a triangle is in a plane with the segment.
    fn is_free(&self, segment: [Point3; 2], but: impl Fn(u32) -> bool) -> bool {
        let [eye, end] = segment;
        let line = [eye, end, end];
        let around = Aabb::around(segment);
        let near =
            |b: &Aabb<3>| (0..3).all(|k| b.min[k] <= around.max[k] && around.min[k] <= b.max[k]) && may_meet(&line, b);
        let is_free = Cell::new(true);
        self.tree.visit(
            |b| is_free.get() && near(b),
            |t| {
                let triangle = &self.rays.triangles()[t as usize];
                let passed = || {
                    let [a, b, c] = *triangle;
                    self.scene.hides_from_front(self.rays.object_of(t)) && orient3d(a, b, c, eye) < 0.0
                };
                is_free.set(is_free.get() && (but(t) || is_apart(segment, triangle) || passed()));
            },
        );
        is_free.get()
    }
}

/// Whether a segment certainly touches a triangle nowhere. Exact.
fn is_apart([p, q]: [Point3; 2], &[a, b, c]: &[Point3; 3]) -> bool {
    let [from, to] = [p, q].map(|e| orient3d(a, b, c, e));
    if (from > 0.0 && to > 0.0) || (from < 0.0 && to < 0.0) {
        return true;
    }
    let turns = [[a, b], [b, c], [c, a]].map(|[x, y]| orient3d(p, q, x, y));
    turns.iter().any(|&s| s > 0.0) && turns.iter().any(|&s| s < 0.0)
}

/// Whether a segment passes through the inside of a triangle: above 0 if from its front, below if from its back, else 0. Exact.
fn passes(&[a, b, c]: &[Point3; 3], [p, q]: [Point3; 2]) -> f64 {
    let [from, to] = [p, q].map(|e| orient3d(a, b, c, e));
    let turns = [[a, b], [b, c], [c, a]].map(|[x, y]| orient3d(p, q, x, y));
    let is_inside = turns.iter().all(|&s| s > 0.0) || turns.iter().all(|&s| s < 0.0);
    let is_across = (from > 0.0 && to < 0.0) || (from < 0.0 && to > 0.0);
    if is_inside && is_across { from.signum() } else { 0.0 }
}
