//! Objects hit by rays from a volume: a quick lower bound of what is visible.
//!
//! Only steers the work: what a ray hits need not be tested again when a volume is subdivided. Rays are traced in plain
//! doubles.

use crate::Volume;
use sightlines_geometry::vector::{dot, normal};
use sightlines_geometry::{Aabb, BoxTree, Point3, Random, ray_box, ray_triangle};

/// Most rays towards one object: what they miss is hidden, or hardly visible.
const MOST_FOR_ONE: u32 = 64;

/// Triangles of objects, to be hit by rays.
#[derive(Debug, Clone)]
pub struct RaySampler {
    triangles: Vec<[Point3; 3]>,
    object: Vec<u32>,
    /// For each object the start of its triangles, and the end of the last one's.
    first: Vec<usize>,
    tree: BoxTree<3>,
    is_single_sided: Vec<bool>,
    /// For each object whether rays pass it from behind.
    is_passed_from_behind: Vec<bool>,
}

impl RaySampler {
    /// * `objects`: for each object its triangles
    pub fn new<'a>(objects: impl IntoIterator<Item = &'a [[Point3; 3]]>) -> Self {
        let (mut triangles, mut object, mut first) = (Vec::new(), Vec::new(), vec![0]);
        for (id, of) in (0..).zip(objects) {
            triangles.extend_from_slice(of);
            object.resize(triangles.len(), id);
            first.push(triangles.len());
        }
        Self::build(triangles, object, first)
    }

    /// One object, whose triangles are not copied.
    pub fn of(triangles: Vec<[Point3; 3]>) -> Self {
        let (object, first) = (vec![0; triangles.len()], vec![0, triangles.len()]);
        Self::build(triangles, object, first)
    }

    fn build(triangles: Vec<[Point3; 3]>, object: Vec<u32>, first: Vec<usize>) -> Self {
        let boxes: Vec<Aabb<3>> = triangles.iter().map(|t| Aabb::around(*t)).collect();
        let tree = BoxTree::build(&boxes, 4);
        let is_single_sided = vec![false; first.len() - 1];
        let is_passed_from_behind = is_single_sided.clone();
        Self { triangles, object, first, tree, is_single_sided, is_passed_from_behind }
    }

    /// All triangles, object by object.
    pub fn triangles(&self) -> &[[Point3; 3]] {
        &self.triangles
    }

    /// The same, with objects that are seen from the fronts of their triangles only; rays end at the backs, too.
    pub fn with_single_sided(mut self, is_single_sided: impl Fn(u32) -> bool) -> Self {
        (0..).zip(&mut self.is_single_sided).for_each(|(object, single)| *single = is_single_sided(object));
        self
    }

    /// The same, with objects that hide from the fronts of their triangles only: rays pass the backs.
    pub fn with_front_occluders(mut self, hides_from_front: impl Fn(u32) -> bool) -> Self {
        (0..).zip(&mut self.is_passed_from_behind).for_each(|(object, passed)| *passed = hides_from_front(object));
        self
    }

    /// Marks objects that rays from points of a volume hit first. A quarter of `n_rays` go in any direction; the others are
    /// shared by the objects of `wanted` that were not hit until then, towards points of their triangles. The same for the
    /// same volume.
    ///
    /// # Panics
    /// If the lists are shorter than the objects.
    pub fn see(&self, volume: &Volume, n_rays: u32, wanted: &[bool], seen: &mut [bool]) {
        if self.triangles.is_empty() {
            return;
        }
        let b = volume.bounds();
        let mut random =
            Random::new(b.min[0].to_bits() ^ b.max[1].to_bits().rotate_left(17) ^ b.min[2].to_bits().rotate_left(41));
        let all = Aabb { min: [-1.0; 3], max: [1.0; 3] };
        for _ in 0..n_rays / 4 {
            let origin = random.point(b);
            self.mark(origin, random.point(&all), seen);
        }
        let objects: Vec<usize> = (0..self.first.len() - 1).filter(|&o| wanted[o] && !seen[o]).collect();
        let share = (n_rays - n_rays / 4) / (objects.len() as u32).max(1);
        for o in objects {
            let triangles = &self.triangles[self.first[o]..self.first[o + 1]];
            for _ in 0..share.min(MOST_FOR_ONE) {
                if seen[o] || triangles.is_empty() {
                    break;
                }
                let origin = random.point(b);
                let [p, q, r] = triangles[((random.unit() * triangles.len() as f64) as usize).min(triangles.len() - 1)];
                let (u, v) = (random.unit(), random.unit());
                let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
                let way = std::array::from_fn(|k| p[k] + u * (q[k] - p[k]) + v * (r[k] - p[k]) - origin[k]);
                self.mark(origin, way, seen);
            }
        }
    }

    /// Whether one of `n_rays` segments from points of a volume to points of a box is free. The same for the same
    /// volume and box.
    pub fn sees(&self, volume: &Volume, target: &Aabb<3>, n_rays: u32) -> bool {
        let b = volume.bounds();
        let mut random =
            Random::new(b.min[0].to_bits() ^ target.max[1].to_bits().rotate_left(17) ^ target.min[2].to_bits());
        (0..n_rays).any(|_| {
            let (origin, to) = (random.point(b), random.point(target));
            let way = std::array::from_fn(|k| to[k] - origin[k]);
            self.first_triangle_before(origin, way, 1.0).is_none()
        })
    }

    fn mark(&self, origin: Point3, direction: Point3, seen: &mut [bool]) {
        let Some(triangle) = self.first_triangle(origin, direction) else { return };
        let object = self.object[triangle as usize] as usize;
        seen[object] |= self.shows(triangle, direction);
    }

    /// Whether somebody who looks in a direction sees a triangle, and not only the back of one that is seen from its front.
    pub fn shows(&self, triangle: u32, direction: Point3) -> bool {
        let object = self.object[triangle as usize] as usize;
        !(self.is_single_sided[object] && self.shows_back(triangle, direction))
    }

    /// Whether rays pass some triangles from behind: then a ray may be free in one direction only.
    pub fn is_one_way(&self) -> bool {
        self.is_passed_from_behind.contains(&true)
    }

    fn shows_back(&self, triangle: u32, direction: Point3) -> bool {
        dot(normal(self.triangles[triangle as usize]), direction) >= 0.0
    }

    fn is_passed(&self, triangle: u32, direction: Point3) -> bool {
        self.is_passed_from_behind[self.object[triangle as usize] as usize] && self.shows_back(triangle, direction)
    }

    /// The object that a ray hits first.
    pub fn first_hit(&self, origin: Point3, direction: Point3) -> Option<u32> {
        self.first_triangle(origin, direction).map(|t| self.object[t as usize])
    }

    /// The object of a triangle.
    pub fn object_of(&self, triangle: u32) -> u32 {
        self.object[triangle as usize]
    }

    /// The triangle that a ray hits first, as an index of all.
    pub fn first_triangle(&self, origin: Point3, direction: Point3) -> Option<u32> {
        self.first_triangle_before(origin, direction, f64::INFINITY)
    }

    /// The triangle that a ray hits first, before `end` times its direction.
    fn first_triangle_before(&self, origin: Point3, direction: Point3, end: f64) -> Option<u32> {
        let inverse = direction.map(|d| 1.0 / d);
        let mut best = (end, None);
        let nodes = self.tree.nodes();
        let enter = |n: u32| (enters(&nodes[n as usize].bounds, origin, inverse), n);
        let mut pending = Vec::with_capacity(64);
        pending.push(enter(0));
        while let Some((at, mut n)) = pending.pop() {
            if at >= best.0 {
                continue;
            }
            // Down to a leaf, always into the nearer child.
            while !nodes[n as usize].is_leaf() {
                let [a, b] = self.tree.children(n).map(enter);
                let (near, far) = if a.0 < b.0 { (a, b) } else { (b, a) };
                if far.0 < best.0 {
                    pending.push(far);
                }
                n = near.1;
                if near.0 >= best.0 {
                    break;
                }
            }
            let node = &nodes[n as usize];
            if !node.is_leaf() {
                continue;
            }
            for &i in &self.tree.order()[node.start as usize..node.end as usize] {
                let t = hit(&self.triangles[i as usize], origin, direction);
                if t < best.0 && !self.is_passed(i, direction) {
                    best = (t, Some(i));
                }
            }
        }
        best.1
    }
}

/// Where a ray enters a box; infinity if it does not.
fn enters(b: &Aabb<3>, origin: Point3, inverse: Point3) -> f64 {
    let [first, last] = ray_box(b, origin, inverse);
    let first = first.max(0.0);
    if first <= last { first } else { f64::INFINITY }
}

/// Where a ray meets a triangle; infinity if it does not.
fn hit(triangle: &[Point3; 3], origin: Point3, direction: Point3) -> f64 {
    let [s, t, at] = ray_triangle(triangle, origin, direction);
    if s >= 0.0 && t >= 0.0 && s + t <= 1.0 && at > 0.0 { at } else { f64::INFINITY }
}
