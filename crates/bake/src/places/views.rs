//! What the places of a box see, by rays, and where a cut of it pays.

use sightlines_cells::Scene;
use sightlines_geometry::vector::{dot, length, normal};
use sightlines_geometry::{Aabb, BoxTree, Point3, Random};
use sightlines_multifocal::RaySampler;
use std::cmp::Ordering;
use std::collections::BTreeMap;

/// Rays from each box. With half as many, places of real scenes saw a twentieth more; with twice as many, as much.
const N_RAYS: u32 = 1024;

/// Places of a cut along each axis, apart from walls.
const N_CUTS: u32 = 16;

/// Planes of walls that are looked at along each axis: those with the largest area in the box.
const N_WALLS: usize = 16;

/// A half has at least this share of a box: thinner slices pay once, and leave long boxes.
const LEAST_SHARE: f64 = 0.1;

/// An axis is cut if the box is at least this share as long along it as along its longest side.
const LEAST_SIDE: f64 = 0.5;

/// Points of a box from which it is found out whether viewers are there.
const N_VIEWERS: u32 = 256;

/// Rays from each of them.
const RAYS_OF_A_VIEWER: usize = 8;

/// So many of them see mostly backs, and none mostly fronts, where nobody is.
const ENOUGH: usize = 8;

/// What blocks rays and stands along axes in a scene.
pub(super) struct Views {
    /// All triangles are one object of the sampler.
    rays: RaySampler,
    /// The object of each triangle.
    object: Vec<u32>,
    /// For each axis its walls.
    walls: [Walls; 3],
    /// Whether backs are seen like fronts: in scenes that show mostly backs.
    backs: bool,
    /// For each triangle whether nobody sees its back.
    single_sided: Vec<bool>,
}

/// Triangles perpendicular to an axis.
struct Walls {
    boxes: Vec<Aabb<3>>,
    areas: Vec<f64>,
    tree: BoxTree<3>,
}

/// A cut.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Cut {
    pub(super) axis: usize,
    pub(super) at: f64,
    /// Whether it is along a wall.
    pub(super) wall: bool,
    /// How many objects fewer a viewer in the box sees on average, as rays estimate.
    pub(super) gain: f64,
}

/// Where the rays to an object began.
struct Seen {
    n: u32,
    min: Point3,
    max: Point3,
}

/// Each box has random numbers of its own.
fn seed(b: &Aabb<3>) -> u64 {
    [b.min, b.max].as_flattened().iter().fold(0u64, |seed, x| seed.rotate_left(11) ^ x.to_bits())
}

impl Views {
    pub(super) fn of(scene: &Scene, region: &Aabb<3>) -> Self {
        let (mut triangles, mut object, mut single_sided) = (Vec::new(), Vec::new(), Vec::new());
        for (id, o) in scene.occluders().chain(scene.fronts()) {
            triangles.extend(o.corners());
            object.resize(triangles.len(), id);
            single_sided.resize(triangles.len(), scene.is_single_sided(id) || scene.hides_from_front(id));
        }
        let walls = std::array::from_fn(|axis| Walls::of(axis, &triangles));
        let rays = RaySampler::of(triangles);
        let mut views = Self { rays, object, walls, backs: true, single_sided };
        let mut random = Random::new(0);
        let fronts = (0..N_RAYS).filter_map(|_| views.ray(region, &mut random)).filter(|hit| hit.front).count();
        let all = (0..N_RAYS).filter_map(|_| views.ray(region, &mut random)).count();
        views.backs = 4 * fronts < all;
        views
    }

    /// What a ray from anywhere in a box hits.
    fn ray(&self, b: &Aabb<3>, random: &mut Random) -> Option<Hit> {
        let (origin, way) = (random.point(b), random.direction());
        let triangle = self.rays.first_triangle(origin, way)? as usize;
        let front = dot(normal(self.rays.triangles()[triangle]), way) < 0.0;
        Some(Hit { object: self.object[triangle], origin, front })
    }

    /// A box without the sides of it that are behind the backs of single-sided faces, such as the ground seen from below; none if all of
    /// it is. Nobody sees such backs, so no viewer is there.
    ///
    /// By rays: a viewer in what is left out by chance is in no cell, and sees everything. In scenes that show mostly backs they say nothing.
    pub(super) fn before_fronts(&self, b: &Aabb<3>) -> Option<Aabb<3>> {
        if self.backs || !self.single_sided.contains(&true) {
            return Some(*b);
        }
        let mut random = Random::new(seed(b) ^ 1);
        let (mut before, mut behind) = (Vec::new(), Vec::new());
        for _ in 0..N_VIEWERS {
            let viewer = random.point(b);
            let (mut fronts, mut backs) = (0, 0);
            for way in [0; RAYS_OF_A_VIEWER].map(|_| random.direction()) {
                let Some(triangle) = self.rays.first_triangle(viewer, way).map(|t| t as usize) else { continue };
                let shows_back = dot(normal(self.rays.triangles()[triangle]), way) >= 0.0;
                *if shows_back && self.single_sided[triangle] { &mut backs } else { &mut fronts } += 1;
            }
            match fronts.cmp(&backs) {
                Ordering::Less => behind.push(viewer),
                Ordering::Greater => before.push(viewer),
                // Nothing around, or both: such a viewer says nothing.
                Ordering::Equal => {}
            }
        }
        if before.is_empty() && behind.len() >= ENOUGH {
            return None;
        }
        let mut place = *b;
        for axis in 0..3 {
            let side = b.max[axis] - b.min[axis];
            let at = |i: u32| b.min[axis] + side * (f64::from(i) / f64::from(N_CUTS));
            let n_behind = |from: f64, to: f64| behind.iter().filter(|p| from <= p[axis] && p[axis] <= to).count();
            let is_behind = |from: f64, to: f64| {
                !before.iter().any(|p| from <= p[axis] && p[axis] <= to) && n_behind(from, to) >= ENOUGH
            };
            let low = (1..N_CUTS).rev().map(at).find(|&at| is_behind(b.min[axis], at));
            let high = (1..N_CUTS).map(at).find(|&at| is_behind(at, b.max[axis]));
            let (low, high) = (low.unwrap_or(b.min[axis]), high.unwrap_or(b.max[axis]));
            if low < high {
                (place.min[axis], place.max[axis]) = (low, high);
            }
        }
        Some(place)
    }

    /// The cut of a box that pays most; none if none pays.
    ///
    /// A cut spares the viewers on one side all objects that only the other side sees. An object that n rays hit may be hit
    /// from one side alone by chance; what is expected of rays that see it from everywhere is taken away.
    pub(super) fn best_cut(&self, b: &Aabb<3>) -> Option<Cut> {
        let mut random = Random::new(seed(b));
        let mut seen: BTreeMap<u32, Seen> = BTreeMap::new();
        for hit in (0..N_RAYS).filter_map(|_| self.ray(b, &mut random)).filter(|hit| hit.front || self.backs) {
            let nothing = Seen { n: 0, min: [f64::INFINITY; 3], max: [f64::NEG_INFINITY; 3] };
            let of = seen.entry(hit.object).or_insert(nothing);
            of.n += 1;
            of.min = std::array::from_fn(|k| of.min[k].min(hit.origin[k]));
            of.max = std::array::from_fn(|k| of.max[k].max(hit.origin[k]));
        }
        let side = |k: usize| b.max[k] - b.min[k];
        let longest = (0..3).map(side).fold(0.0, f64::max);
        let mut best: Option<Cut> = None;
        for axis in (0..3).filter(|&axis| side(axis) >= LEAST_SIDE * longest) {
            let even = (1..N_CUTS).map(|i| (b.min[axis] + side(axis) * (f64::from(i) / f64::from(N_CUTS)), false));
            let walls = self.walls[axis].largest(axis, b).into_iter().map(|at| (at, true));
            // Of equal cuts the first is taken, so walls come first.
            for (at, wall) in walls.chain(even) {
                let below = (at - b.min[axis]) / side(axis);
                if !(LEAST_SHARE..=1.0 - LEAST_SHARE).contains(&below) {
                    continue;
                }
                let (gain, variance) = seen.values().filter(|of| of.n > 1).fold((0.0, 0.0), |sum, of| {
                    let [gain, variance] = spared(of, axis, at, below);
                    (sum.0 + gain, sum.1 + variance)
                });
                let pays = gain >= LEAST_GAIN && gain * gain > DEVIATIONS * DEVIATIONS * variance;
                if pays && best.is_none_or(|best| gain > best.gain) {
                    best = Some(Cut { axis, at, wall, gain });
                }
            }
        }
        best
    }

    /// Coordinates strictly inside a box at which walls stand, ascending.
    pub(super) fn walls_in(&self, axis: usize, b: &Aabb<3>) -> Vec<f64> {
        let mut at = self.walls[axis].largest(axis, b);
        at.sort_by(f64::total_cmp);
        at
    }
}

/// A cut that spares a viewer less than half an object on average is not worth a cell.
const LEAST_GAIN: f64 = 0.5;

/// So many standard deviations of what chance alone makes a cut seem to spare are no reason to cut: the best of a hundred cuts is chosen.
const DEVIATIONS: f64 = 3.0;

struct Hit {
    object: u32,
    origin: Point3,
    /// Whether the front of the triangle was hit.
    front: bool,
}

/// How likely a viewer does not see an object after a cut that leaves them the share `below` on the lower side, less what
/// chance alone makes it seem; and the variance of that chance.
fn spared(of: &Seen, axis: usize, at: f64, below: f64) -> [f64; 2] {
    let above = 1.0 - below;
    let [by_chance_above, by_chance_below] = [power(above, of.n), power(below, of.n)];
    let share = |yes: bool| f64::from(u8::from(yes));
    let only_above = share(of.min[axis] >= at) - by_chance_above;
    let only_below = share(of.max[axis] <= at) - by_chance_below;
    let variance = below * below * by_chance_above * (1.0 - by_chance_above)
        + above * above * by_chance_below * (1.0 - by_chance_below);
    [below * only_above + above * only_below, variance]
}

/// x^n by products, the same on every machine.
fn power(x: f64, n: u32) -> f64 {
    let (mut square, mut n, mut out) = (x, n, 1.0);
    while n > 0 {
        if n % 2 == 1 {
            out *= square;
        }
        square *= square;
        n /= 2;
    }
    out
}

impl Walls {
    fn of(axis: usize, triangles: &[[Point3; 3]]) -> Self {
        let flat = |t: &&[Point3; 3]| t[0][axis] == t[1][axis] && t[1][axis] == t[2][axis];
        let (boxes, areas): (Vec<Aabb<3>>, Vec<f64>) =
            triangles.iter().filter(flat).map(|t| (Aabb::around(*t), length(normal(*t)) / 2.0)).unzip();
        let tree = BoxTree::build(&boxes, 8);
        Self { boxes, areas, tree }
    }

    /// The coordinates strictly inside a box at which most area lies in it, largest first.
    fn largest(&self, axis: usize, b: &Aabb<3>) -> Vec<f64> {
        let inside = |of: &Aabb<3>| of.max[axis] > b.min[axis] && of.min[axis] < b.max[axis];
        let meets = |of: &Aabb<3>| (0..3).all(|k| of.min[k] <= b.max[k] && b.min[k] <= of.max[k]) && inside(of);
        let mut found: Vec<u32> = Vec::new();
        self.tree.visit(meets, |i| found.extend(meets(&self.boxes[i as usize]).then_some(i)));
        found.sort_unstable();
        // By coordinate; the bits of numbers of different signs are in no order, which does not matter here.
        let mut area: BTreeMap<u64, f64> = BTreeMap::new();
        for i in found {
            let of = &self.boxes[i as usize];
            let share = |k: usize| {
                let side = of.max[k] - of.min[k];
                if side > 0.0 { (of.max[k].min(b.max[k]) - of.min[k].max(b.min[k])).max(0.0) / side } else { 1.0 }
            };
            let here = self.areas[i as usize] * (0..3).filter(|&k| k != axis).map(share).product::<f64>();
            *area.entry(of.min[axis].to_bits()).or_insert(0.0) += here;
        }
        let mut planes: Vec<(f64, f64)> = area.into_iter().map(|(at, area)| (f64::from_bits(at), area)).collect();
        planes.sort_by(|p, q| q.1.total_cmp(&p.1).then(p.0.total_cmp(&q.0)));
        planes.into_iter().take(N_WALLS).map(|(at, _)| at).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sightlines_cells::SceneObject;

    /// A rectangle of two triangles, as an object.
    fn wall(corners: [Point3; 4]) -> SceneObject {
        SceneObject { name: String::new(), vertices: corners.to_vec(), triangles: vec![[0, 1, 2], [0, 2, 3]] }
    }

    /// A wall across the middle of a box, and things on both sides; or the same without the wall.
    fn halves(divided: bool) -> Option<Cut> {
        let mut objects = Vec::new();
        for i in 0..8 {
            let x = f64::from(i);
            objects.push(wall([[x, 0.0, 0.0], [x + 1.0, 0.0, 0.0], [x + 1.0, 4.0, 0.0], [x, 4.0, 0.0]]));
        }
        if divided {
            objects.push(wall([[3.0, 0.0, 0.0], [3.0, 4.0, 0.0], [3.0, 4.0, 4.0], [3.0, 0.0, 4.0]]));
        }
        let b = Aabb { min: [0.0; 3], max: [8.0, 4.0, 4.0] };
        Views::of(&Scene::new(objects).expect("a scene"), &b).best_cut(&b)
    }

    #[test]
    fn a_cut_goes_along_the_wall_that_divides_what_is_seen() {
        let cut = halves(true).expect("a wall divides");
        assert_eq!((cut.axis, cut.at, cut.wall), (0, 3.0, true), "{cut:?}");
        // Of the eight things a viewer loses three or five.
        assert!(cut.gain > 3.0 && cut.gain < 5.0, "{cut:?}");
        // All see all, but what is far off is hit by few rays.
        assert!(halves(false).is_none_or(|cut| cut.gain < 1.0), "nothing divides");
    }

    #[test]
    fn powers_are_products() {
        assert_eq!((power(0.5, 0), power(0.5, 3), power(3.0, 5), power(0.0, 2)), (1.0, 0.125, 243.0, 0.0));
    }
}
