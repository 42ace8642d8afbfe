//! What an eye sees in a building in space: the volume of its isovist, and how much of each object, estimated by rays.
//!
//! In space there is no short exact form: an isovist has as many faces as there are silhouettes in view. So rays estimate, and each estimate
//! comes with an interval; what a table proves to be hidden is 0 without rays.

use sightlines_cells::Scene;
use sightlines_geometry::vector::{add, cross, dot, length, scale, sub};
use sightlines_geometry::{Aabb, BoxTree, Point3, Random, ray_box, ray_triangle};
use sightlines_pvs::{ObjectId, Place, Table};
use std::cell::Cell;

/// Faces in a leaf.
const PER_LEAF: usize = 4;
/// A hit within this share of the way before a point is on the surface that the point is on. Rays prove nothing, so this decides nothing.
const END: f64 = 1e-9;
/// Of a normal distribution, 95 % lie within so many standard deviations.
const Z: f64 = 1.96;

/// An estimate, and the interval in which the truth lies with a probability of 95 %.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// The estimate.
    pub value: f64,
    /// Lower end of the interval.
    pub low: f64,
    /// Upper end of the interval.
    pub high: f64,
}

impl Estimate {
    /// What needs no rays.
    const fn exact(value: f64) -> Self {
        Self { value, low: value, high: value }
    }

    /// The mean of values with this variance among `n` of them.
    fn of_mean(mean: f64, variance: f64, n: f64) -> Self {
        let half = Z * (variance / n).sqrt();
        Self { value: mean, low: (mean - half).max(0.0), high: mean + half }
    }

    /// A share of `n` (which may be a fraction, for weights). Wilson's interval, which holds near 0 and 1 too.
    ///
    /// # Source
    /// Wilson, "Probable inference, the law of succession, and statistical inference", J. American Statistical Association 22, 1927.
    fn of_share(share: f64, n: f64) -> Self {
        let (z, share) = (Z * Z / n, share.clamp(0.0, 1.0));
        let middle = (share + 0.5 * z) / (1.0 + z);
        let half = (z * (share * (1.0 - share) + 0.25 * z)).sqrt() / (1.0 + z);
        Self { value: share, low: (middle - half).max(0.0).min(share), high: (middle + half).min(1.0).max(share) }
    }
}

/// The faces of a scene, prepared for rays.
#[derive(Debug)]
pub struct Surroundings<'a> {
    scene: &'a Scene,
    bounds: Aabb<3>,
    faces: Vec<Face>,
    tree: BoxTree<3>,
    boxes: Vec<Aabb<3>>,
}

/// A triangle that blocks, and from which side.
#[derive(Debug)]
struct Face {
    corners: [Point3; 3],
    object: u32,
    /// It is passed from behind: its front is the side that it runs counter-clockwise on.
    single_sided: bool,
}

impl<'a> Surroundings<'a> {
    /// Prepares a scene: O(n log² n) for n triangles.
    pub fn new(scene: &'a Scene) -> Self {
        let mut faces = Vec::new();
        for (object, o) in scene.occluders().chain(scene.fronts()) {
            let single_sided = scene.is_single_sided(object) || scene.hides_from_front(object);
            faces.extend(o.corners().map(|corners| Face { corners, object, single_sided }));
        }
        let boxes: Vec<Aabb<3>> = faces.iter().map(|face| Aabb::around(face.corners)).collect();
        Self { scene, bounds: scene.bounds(), tree: BoxTree::build(&boxes, PER_LEAF), boxes, faces }
    }

    /// The nearest hit of a ray that passes a test: its multiple of the direction, below `limit`.
    fn nearest(&self, from: Point3, way: Point3, limit: f64, takes: impl Fn(&Face) -> bool) -> Option<f64> {
        // An axis along which nothing changes is looked at on its own, so that sides of boxes count as inside.
        let inverse = way.map(|x| if x == 0.0 { f64::NAN } else { 1.0 / x });
        let best = Cell::new(limit);
        let is_between = |b: &Aabb<3>, k: usize| b.min[k] <= from[k] && from[k] <= b.max[k];
        let passes = |b: &Aabb<3>| {
            let [first, last] = ray_box(b, from, inverse);
            first.max(0.0) <= last.min(best.get()) && (0..3).all(|k| way[k] != 0.0 || is_between(b, k))
        };
        self.tree.visit(
            |b| passes(b),
            |i| {
                let face = &self.faces[i as usize];
                if passes(&self.boxes[i as usize]) && takes(face) {
                    let [x, y, t] = ray_triangle(&face.corners, from, way);
                    let is_hit = x >= 0.0 && y >= 0.0 && x + y <= 1.0 && t > 0.0 && t < best.get();
                    if is_hit && !(face.single_sided && dot(normal(&face.corners), way) > 0.0) {
                        best.set(t);
                    }
                }
            },
        );
        (best.get() < limit).then(|| best.get())
    }

    /// The volume of the isovist of an eye, in cubic units of the scene: all that is seen within the box around the scene, by `n` rays.
    ///
    /// See-through objects are looked through, and single-sided faces from behind. 0 for an eye outside of the box. The same eye, `n` and `seed` give the
    /// same bits on every machine.
    pub fn volume(&self, eye: Point3, n: u32, seed: u64) -> Estimate {
        if !self.bounds.contains(eye) {
            return Estimate::exact(0.0);
        }
        let mut random = Random::new(seed);
        let n = n.max(2);
        // In units of the scene's diagonal, so that no power leaves the range of doubles.
        let unit = length(sub(self.bounds.max, self.bounds.min));
        if unit == 0.0 {
            return Estimate::exact(0.0);
        }
        let (mut sum, mut squares) = (0.0, 0.0);
        for _ in 0..n {
            let direction = random.direction();
            let inverse = direction.map(|x| if x == 0.0 { f64::NAN } else { 1.0 / x });
            let [_, leaves] = ray_box(&self.bounds, eye, inverse);
            let radius = self.nearest(eye, direction, leaves, |_| true).unwrap_or(leaves);
            let share = radius / unit;
            let cube = share * share * share;
            sum += cube;
            squares += cube * cube;
        }
        let n = f64::from(n);
        let mean = sum / n;
        let variance = ((squares - n * mean * mean) / (n - 1.0)).max(0.0);
        let sphere = 4.0 / 3.0 * std::f64::consts::PI * unit * unit * unit;
        let Estimate { value, low, high } = Estimate::of_mean(mean, variance, n);
        Estimate { value: sphere * value, low: sphere * low, high: sphere * high }
    }

    /// How much of each object an eye sees: of what would be seen of it if it stood alone, the share that nothing else covers, by solid angle; by
    /// `n` rays for each object.
    ///
    /// With a table of the scene, objects that it does not list for the cells of the eye are 0 without rays; an eye outside every cell is as
    /// without a table. An object without area, and one that the eye sees only from behind, is 0.
    pub fn visible_shares(&self, eye: Point3, table: Option<&Table>, n: u32, seed: u64) -> Vec<Estimate> {
        let listed = table.and_then(|table| match table.place_at(eye) {
            Place::Inside(here) => Some(here.visible_objects()),
            _ => None,
        });
        let n_objects = self.scene.objects().len();
        let is_listed = |object: u32| listed.as_ref().is_none_or(|list| list.binary_search(&ObjectId(object)).is_ok());
        let share = |object: u32| match is_listed(object) {
            true => self.visible_share(eye, object, n.max(2), seed),
            false => Estimate::exact(0.0),
        };
        (0..n_objects as u32).map(share).collect()
    }

    fn visible_share(&self, eye: Point3, object: u32, n: u32, seed: u64) -> Estimate {
        let triangles: Vec<[Point3; 3]> = self.scene.objects()[object as usize].corners().collect();
        let single_sided = self.scene.is_single_sided(object);
        let mut up_to = Vec::with_capacity(triangles.len());
        let mut total = 0.0;
        for triangle in &triangles {
            total += length(normal(triangle));
            up_to.push(total);
        }
        if total == 0.0 {
            return Estimate::exact(0.0);
        }
        let is_own = |face: &Face| face.object == object;
        let mut random = Random::new(seed ^ (u64::from(object) << 32));
        let (mut all, mut seen, mut squares) = (0.0, 0.0, 0.0);
        for _ in 0..n {
            let place = random.unit() * total;
            let chosen = up_to.partition_point(|&x| x <= place).min(triangles.len() - 1);
            let [a, b, c] = triangles[chosen];
            let (mut u, mut v) = (random.unit(), random.unit());
            if u + v > 1.0 {
                (u, v) = (1.0 - u, 1.0 - v);
            }
            let p = add(a, add(scale(sub(b, a), u), scale(sub(c, a), v)));
            let way = sub(p, eye);
            let facing = dot(normal(&triangles[chosen]), way);
            let distance = length(way);
            if distance == 0.0 || (single_sided && facing > 0.0) || self.nearest(eye, way, 1.0 - END, is_own).is_some()
            {
                continue;
            }
            // Solid angle of a part of the surface: its area times the cosine, over the square of the distance.
            let weight = facing.abs() / (length(normal(&triangles[chosen])) * distance * distance * distance);
            all += weight;
            squares += weight * weight;
            if self.nearest(eye, way, 1.0 - END, |face| !is_own(face)).is_none() {
                seen += weight;
            }
        }
        if all > 0.0 { Estimate::of_share(seen / all, all * all / squares) } else { Estimate::exact(0.0) }
    }
}

/// Perpendicular to a triangle, as long as twice its area.
fn normal([a, b, c]: &[Point3; 3]) -> Point3 {
    cross(sub(*b, *a), sub(*c, *a))
}
