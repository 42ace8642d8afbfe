//! Lower bounds in space: what random rays were seen to reach.
//!
//! What a ray reaches is visible, so a table that calls it hidden is wrong; what no ray reaches may
//! still be visible through a slit. A ray counts only if it is robust, which is a rule for choosing
//! samples and decides nothing else: rounding must not make a witness of a line that grazes an edge, or
//! slips through a crack as wide as the last place of a coordinate.

use crate::bvh::{Bvh, Ray};
use crate::rays::{Hit, RayScene, length, sub};
use sightlines_cells::Point3;
use sightlines_geometry::Aabb;
use std::collections::BTreeSet;

/// A ray is shifted by the scene's size over this.
const SHIFT: f64 = (1 << 20) as f64;

/// SplitMix64's finaliser over a counter: every ray has numbers of its own, whichever thread casts it.
struct Random(u64);

impl Random {
    fn new(seed: u64, ray: u64) -> Self {
        Self(Self(Self(seed).next() ^ ray).next())
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// Strictly between 0 and 1.
    fn unit(&mut self) -> f64 {
        ((self.next() >> 12) as f64 + 0.5) / (1u64 << 52) as f64
    }

    fn point(&mut self, b: &Aabb<3>) -> Point3 {
        [0, 1, 2].map(|k| b.min[k] + (b.max[k] - b.min[k]) * self.unit())
    }

    /// Uniform over the sphere, of length 1.
    fn direction(&mut self) -> Point3 {
        loop {
            let d = [0; 3].map(|_| 2.0 * self.unit() - 1.0);
            let l = length(d);
            if (0.1..=1.0).contains(&l) {
                return d.map(|x| x / l);
            }
        }
    }
}

/// A line through the open air, and its four parallels.
struct Line {
    direction: Point3,
    /// First the line itself.
    origins: [Point3; 5],
    /// First hits of the line itself, forwards and backwards.
    hits: [Option<Hit>; 2],
}

impl RayScene {
    /// How far a ray is shifted in order to see whether it is robust: 2^-20 of the scene's size.
    pub fn shift(&self) -> f64 {
        self.size() / SHIFT
    }

    /// Objects that rays from random points inside `cell` first hit: a lower bound of what is visible
    /// from the cell.
    ///
    /// From each of `n_rays` points, a line is followed both ways. It is left out if its point lies in
    /// solid matter or on a wall: if one way it first hits a back, or anything within [`Self::shift`].
    /// A hit counts if it is on a front, and if the line's four parallels at that distance first hit
    /// fronts of the same object too. The same seed gives the same objects with any number of threads.
    pub fn witness_objects(&self, cell: Aabb<3>, seed: u64, n_rays: u64) -> BTreeSet<u32> {
        if cell.is_empty() {
            return BTreeSet::new();
        }
        in_parallel(n_rays, |ray, seen| {
            if let Some(line) = self.line(&cell, Random::new(seed, ray)) {
                let hits = [1.0, -1.0].into_iter().zip(line.hits);
                seen.extend(hits.filter_map(|(way, hit)| self.robust(&line, way, hit?.object)));
            }
        })
    }

    /// Pairs of `cells`, lower index first, that clear segments join: a lower bound of which cells see
    /// each other. Cells that overlap see each other.
    ///
    /// From each of `n_rays` points in each cell, a line is followed both ways up to the first hit, as
    /// in [`Self::witness_objects`]; all cells that it and its four parallels pass through on the way,
    /// more than [`Self::shift`] from the cells' borders, see each other.
    pub fn witness_cells(&self, cells: &[Aabb<3>], seed: u64, n_rays: u64) -> BTreeSet<(u32, u32)> {
        let shift = self.shift();
        let shrunk = |b: &Aabb<3>| Aabb { min: b.min.map(|x| x + shift), max: b.max.map(|x| x - shift) };
        let inner: Vec<Aabb<3>> = cells.iter().map(shrunk).collect();
        let bvh = Bvh::new(cells, shift);
        let n_cells = u64::try_from(cells.len()).expect("sizes have 64 bits");
        in_parallel(n_rays.saturating_mul(n_cells), |ray, seen| {
            let cell = &inner[usize::try_from(ray % n_cells).expect("an index of a cell")];
            if cell.is_empty() {
                return;
            }
            let Some(line) = self.line(cell, Random::new(seed, ray)) else { return };
            let Some([back, forth]) = self.clear_stretch(&line) else { return };
            // Seen from the far end, the clear stretch begins at 0.
            let from = step(line.origins[0], line.direction, -back.min(1e3 * self.size()));
            let mut passed = Vec::new();
            bvh.visit(&Ray { origin: from, direction: line.direction }, f64::INFINITY, |i| {
                let b = &inner[i as usize];
                let meets = |o: &Point3| {
                    let range = Ray { origin: *o, direction: line.direction }.within(b);
                    range.is_some_and(|[s, t]| s.max(shift - back) + shift < t.min(forth - shift))
                };
                if !b.is_empty() && line.origins.iter().all(meets) {
                    passed.push(i);
                }
                f64::INFINITY
            });
            passed.sort_unstable();
            for (k, &i) in passed.iter().enumerate() {
                seen.extend(passed[k + 1..].iter().map(|&j| (i, j)));
            }
        })
    }

    /// A random line through a point of `cell`; `None` if the point is not in the open air.
    fn line(&self, cell: &Aabb<3>, mut random: Random) -> Option<Line> {
        let (origin, direction) = (random.point(cell), random.direction());
        let hits = [self.first_hit(origin, direction), self.first_hit(origin, direction.map(|x| -x))];
        if hits.iter().flatten().any(|h| !h.front_facing || h.t <= self.shift()) {
            return None;
        }
        // Two directions across: the axis that the line is least along, without its part along the line.
        let axis = (0..3).min_by(|&a, &b| direction[a].abs().total_cmp(&direction[b].abs()))?;
        let mut across = direction.map(|x| -x * direction[axis]);
        across[axis] += 1.0;
        let u = across.map(|x| x / length(across));
        let [a, b] = [direction, u];
        let v = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
        let s = self.shift();
        let origins = [origin, step(origin, u, s), step(origin, u, -s), step(origin, v, s), step(origin, v, -s)];
        Some(Line { direction, origins, hits })
    }

    /// `object`, if the parallels of a line first hit its front as well.
    fn robust(&self, line: &Line, way: f64, object: u32) -> Option<u32> {
        let direction = line.direction.map(|x| way * x);
        let same = |o: &Point3| self.first_hit(*o, direction).is_some_and(|h| h.object == object && h.front_facing);
        line.origins[1..].iter().all(same).then_some(object)
    }

    /// How far a line and its parallels are clear, backwards and forwards; `None` if a parallel is not
    /// in the open air.
    fn clear_stretch(&self, line: &Line) -> Option<[f64; 2]> {
        let mut clear = [line.hits[1], line.hits[0]].map(|h| h.map_or(f64::INFINITY, |h| h.t));
        for (way, clear) in [-1.0, 1.0].into_iter().zip(&mut clear) {
            for origin in &line.origins[1..] {
                if let Some(hit) = self.first_hit(*origin, line.direction.map(|x| way * x)) {
                    if !hit.front_facing {
                        return None;
                    }
                    *clear = clear.min(hit.t);
                }
            }
        }
        Some(clear)
    }
}

fn step(p: Point3, d: Point3, by: f64) -> Point3 {
    sub(p, d.map(|x| -x * by))
}

/// The union of what `job` adds for each number below `n`, found by all processors.
fn in_parallel<T: Ord + Send>(n: u64, job: impl Fn(u64, &mut BTreeSet<T>) + Sync) -> BTreeSet<T> {
    let all = |range: std::ops::Range<u64>| {
        let mut seen = BTreeSet::new();
        range.for_each(|i| job(i, &mut seen));
        seen
    };
    let threads = std::thread::available_parallelism().map_or(1, |n| n.get() as u64).min(n / 64 + 1);
    let bound = |k: u64| n / threads * k + (n % threads).min(k);
    std::thread::scope(|scope| {
        let spawn = |k| {
            scope.spawn({
                let all = &all;
                move || all(bound(k)..bound(k + 1))
            })
        };
        let others: Vec<_> = (1..threads).map(spawn).collect();
        let mut seen = all(bound(0)..bound(1));
        for other in others {
            seen.extend(other.join().expect("a thread that casts rays does not panic"));
        }
        seen
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use sightlines_cells::{Scene, SceneObject};

    /// A closed box; turned inside out it is a room.
    fn cuboid(name: &str, min: Point3, max: Point3, room: bool) -> SceneObject {
        let corner = |i: usize| [0, 1, 2].map(|k| if i >> k & 1 == 1 { max[k] } else { min[k] });
        // Each side as it is seen from outside.
        let sides = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
        let mut triangles: Vec<[u32; 3]> = sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        if room {
            triangles.iter_mut().for_each(|t| t.swap(1, 2));
        }
        SceneObject { name: name.to_owned(), vertices: (0..8).map(corner).collect(), triangles }
    }

    fn cell(min: Point3, max: Point3) -> Aabb<3> {
        Aabb { min, max }
    }

    /// Two rooms in one shell, with a wall between them that leaves a door of the given width.
    fn two_rooms(door: f64) -> RayScene {
        let objects = vec![
            cuboid("shell", [0., 0., 0.], [9., 3., 4.], true),
            cuboid("wall", [4., 0., door], [5., 3., 4.], false),
            cuboid("near", [1., 0., 1.], [2., 1., 2.], false),
            cuboid("far", [7., 0., 1.], [8., 1., 2.], false),
            cuboid("inside the wall", [4.25, 1., 2.], [4.75, 2., 3.], false),
        ];
        RayScene::new(&Scene::new(objects).unwrap())
    }

    #[test]
    fn witnessed_objects_are_those_in_sight() {
        let left = cell([0.; 3], [4., 3., 4.]);
        assert_eq!(two_rooms(1.0).witness_objects(left, 1, 3000), BTreeSet::from([0, 1, 2, 3]));
        assert_eq!(two_rooms(0.0).witness_objects(left, 1, 3000), BTreeSet::from([0, 1, 2]));
        // A crack narrower than the shift is no door: that is the rule for samples.
        let crack = two_rooms(1e-6);
        assert!(crack.shift() > 1e-6);
        assert_eq!(crack.witness_objects(left, 1, 3000), BTreeSet::from([0, 1, 2]));
    }

    #[test]
    fn witnesses_do_not_start_in_solid_matter() {
        let scene = two_rooms(1.0);
        let in_the_wall = cell([4., 0., 1.], [5., 3., 4.]);
        assert_eq!(scene.witness_objects(in_the_wall, 1, 3000), BTreeSet::new());
        let above_the_near_box = scene.witness_objects(cell([1.2; 3], [1.3; 3]), 1, 1000);
        assert_eq!(above_the_near_box, BTreeSet::from([0, 1, 2]));
        assert_eq!(scene.witness_objects(cell([1.2, 0.2, 1.2], [1.3, 0.3, 1.3]), 1, 100), BTreeSet::new());
        assert_eq!(scene.witness_objects(Aabb::EMPTY, 1, 100).len(), 0);
    }

    #[test]
    fn witnessed_cells_are_joined_by_clear_segments() {
        let cells = [
            cell([0.; 3], [4., 3., 4.]),
            cell([4., 0., 0.], [5., 3., 1.]),
            cell([5., 0., 0.], [9., 3., 4.]),
            // Behind the near box as seen from the first cell's corner, and in the wall.
            cell([1., 0., 3.], [2., 1., 4.]),
            cell([4.1, 0.5, 1.5], [4.9, 2.5, 3.5]),
        ];
        let open = two_rooms(1.0).witness_cells(&cells, 1, 3000);
        assert_eq!(open, BTreeSet::from([(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)]));
        // With the door walled up, only what lies on one side is joined.
        let closed = two_rooms(0.0).witness_cells(&cells, 1, 3000);
        assert_eq!(closed, BTreeSet::from([(0, 3)]));
        assert!(two_rooms(0.0).witness_cells(&[], 1, 10).is_empty());
    }

    #[test]
    fn witnesses_can_be_repeated_and_need_no_threads() {
        let (scene, left) = (two_rooms(0.125), cell([0.; 3], [4., 3., 4.]));
        let few = scene.witness_objects(left, 5, 40);
        assert_eq!(few, scene.witness_objects(left, 5, 40));
        assert!(few.is_subset(&scene.witness_objects(left, 5, 4000)), "more rays see no less");
        let one_by_one: BTreeSet<u64> = (0..1000).map(|i| i % 7).collect();
        assert_eq!(in_parallel(1000, |i, seen| seen.extend([i % 7])), one_by_one);
        assert!(in_parallel(0, |i, seen: &mut BTreeSet<u64>| seen.extend([i])).is_empty());
    }

    /// The impostor: a scene that lacks an object is told from the whole one by its witnesses.
    #[test]
    fn witnesses_notice_a_missing_wall() {
        let objects = vec![
            cuboid("shell", [0., 0., 0.], [9., 3., 4.], true),
            cuboid("wall", [4., 0., 0.], [5., 3., 4.], false),
            cuboid("far", [7., 0., 1.], [8., 1., 2.], false),
        ];
        let left = cell([0.; 3], [4., 3., 4.]);
        let whole = RayScene::new(&Scene::new(objects.clone()).unwrap());
        assert!(!whole.witness_objects(left, 1, 2000).contains(&2));
        let mut less = objects;
        less[1].triangles.clear();
        let less = RayScene::new(&Scene::new(less).unwrap());
        assert!(less.witness_objects(left, 1, 2000).contains(&2));
    }
}
