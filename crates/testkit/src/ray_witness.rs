//! Lower bounds in space: what random rays were seen to reach.
//!
//! What a ray reaches is visible, so a table that calls it hidden is wrong; what no ray reaches may
//! still be visible through a slit. A ray counts only if it is robust, which is a rule for choosing
//! samples and decides nothing else: rounding must not make a witness of a line that grazes an edge, or
//! slips through a crack as wide as the last place of a coordinate.

mod random;

pub use random::Random;

use crate::bvh::{Bvh, Ray};
use crate::rays::{Hit, RayScene, length, sub};
use sightlines_cells::Point3;
use sightlines_geometry::Aabb;
use std::collections::BTreeSet;

/// A ray is shifted by the scene's size over this.
const SHIFT: f64 = (1 << 20) as f64;

/// A line through the open air, and its four parallels.
struct Line {
    direction: Point3,
    /// First the line itself.
    origins: [Point3; 5],
    /// First hits of the line itself, forwards and backwards.
    hits: [Option<Hit>; 2],
}

/// A line through the open air, up to the first thing both ways; its four parallels, one
/// [`RayScene::shift`] beside it, are in the open air too.
#[derive(Debug, Clone)]
pub struct ClearLine {
    /// Of length 1.
    pub direction: Point3,
    /// First the origin of the line itself.
    origins: [Point3; 5],
    /// How far the line and its parallels are clear, backwards and forwards; infinite where nothing is hit.
    pub clear: [f64; 2],
    /// The object that the line and its parallels all first hit on fronts, backwards and forwards.
    pub ends: [Option<u32>; 2],
}

impl ClearLine {
    /// A point on the line, in the open air.
    pub fn origin(&self) -> Point3 {
        self.origins[0]
    }
}

/// Boxes of cells, prepared to find those that a line passes through.
#[derive(Debug)]
pub struct CellIndex {
    /// Without what is within a shift of the borders.
    inner: Vec<Aabb<3>>,
    bvh: Bvh,
    shift: f64,
    /// No clear line is followed farther back.
    far: f64,
}

impl CellIndex {
    /// Replaces `passed` by the cells that a line and its parallels pass through before they hit anything,
    /// ascending. Only what is more than a shift away from the cells' borders and from the ends counts, so
    /// an eye in any of the cells sees [`ClearLine::ends`], and all of the cells.
    pub fn passed(&self, line: &ClearLine, passed: &mut Vec<u32>) {
        passed.clear();
        let [back, forth] = line.clear;
        let rays = line.origins.map(|o| Ray::new(o, line.direction));
        // Seen from the far end, the clear stretch begins at 0.
        let start = back.min(self.far);
        let from = Ray::new(step(line.origins[0], line.direction, -start), line.direction);
        let limit = start + forth;
        self.bvh.visit(&from, limit, |i| {
            let b = &self.inner[i as usize];
            let meets = |ray: &Ray| {
                let range = ray.within(b);
                range.is_some_and(|[s, t]| s.max(self.shift - back) + self.shift < t.min(forth - self.shift))
            };
            if !b.is_empty() && rays.iter().all(meets) {
                passed.push(i);
            }
            limit
        });
        passed.sort_unstable();
    }
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
        let index = self.cell_index(cells);
        let n_cells = u64::try_from(cells.len()).expect("sizes have 64 bits");
        in_parallel(n_rays.saturating_mul(n_cells), |ray, seen| {
            let cell = &index.inner[usize::try_from(ray % n_cells).expect("an index of a cell")];
            if cell.is_empty() {
                return;
            }
            let mut random = Random::new(seed, ray);
            let Some(line) = self.clear_line(random.point(cell), random.direction()) else { return };
            let mut passed = Vec::new();
            index.passed(&line, &mut passed);
            for (k, &i) in passed.iter().enumerate() {
                seen.extend(passed[k + 1..].iter().map(|&j| (i, j)));
            }
        })
    }

    /// Makes ready to ask which of `cells` (scene units) lines pass through. O(n log n).
    pub fn cell_index(&self, cells: &[Aabb<3>]) -> CellIndex {
        let shift = self.shift();
        let shrunk = |b: &Aabb<3>| Aabb { min: b.min.map(|x| x + shift), max: b.max.map(|x| x - shift) };
        let (inner, bvh) = (cells.iter().map(shrunk).collect(), Bvh::new(cells, shift));
        CellIndex { inner, bvh, shift, far: 1e3 * self.size() }
    }

    /// The line through `origin` along `direction`, of any length but 0, if it can be a witness: its origin
    /// and those of its parallels are in the open air, which is to say that neither way a back is the first
    /// thing hit, nor the line anything within [`Self::shift`].
    pub fn clear_line(&self, origin: Point3, direction: Point3) -> Option<ClearLine> {
        let l = length(direction);
        if l == 0.0 {
            return None;
        }
        let line = self.line_through(origin, direction.map(|x| x / l))?;
        let (clear, ends) = self.clear_stretch(&line)?;
        Some(ClearLine { direction: line.direction, origins: line.origins, clear, ends })
    }

    /// A random line through a point of `cell`; `None` if the point is not in the open air.
    fn line(&self, cell: &Aabb<3>, mut random: Random) -> Option<Line> {
        self.line_through(random.point(cell), random.direction())
    }

    /// The line along a direction of length 1.
    fn line_through(&self, origin: Point3, direction: Point3) -> Option<Line> {
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

    /// How far a line and its parallels are clear, backwards and forwards, and the objects whose fronts all
    /// of them hit there; `None` if a parallel is not in the open air.
    fn clear_stretch(&self, line: &Line) -> Option<([f64; 2], [Option<u32>; 2])> {
        let own = [line.hits[1], line.hits[0]];
        let mut clear = own.map(|h| h.map_or(f64::INFINITY, |h| h.t));
        let mut ends = own.map(|h| h.map(|h| h.object));
        for (k, way) in [-1.0, 1.0].into_iter().enumerate() {
            for origin in &line.origins[1..] {
                let hit = self.first_hit(*origin, line.direction.map(|x| way * x));
                if hit.is_some_and(|h| !h.front_facing) {
                    return None;
                }
                clear[k] = clear[k].min(hit.map_or(f64::INFINITY, |h| h.t));
                ends[k] = ends[k].filter(|&object| hit.is_some_and(|h| h.object == object));
            }
        }
        Some((clear, ends))
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
    fn clear_lines_show_their_ends_to_every_cell_on_the_way() {
        let scene = two_rooms(1.0);
        let cells = [
            cell([0.; 3], [4., 3., 4.]),
            cell([4., 0., 0.], [5., 3., 1.]),
            cell([5., 0., 0.], [9., 3., 4.]),
            cell([0., 2., 0.], [9., 3., 4.]),
        ];
        let index = scene.cell_index(&cells);
        let through_the_door = scene.clear_line([0.5, 0.5, 0.5], [2., 0., 0.]).unwrap();
        assert_eq!((through_the_door.ends, through_the_door.origin()), ([Some(0); 2], [0.5; 3]));
        assert!((through_the_door.clear[0] - 0.5).abs() < 1e-9 && (through_the_door.clear[1] - 8.5).abs() < 1e-9);
        let mut passed = vec![7];
        index.passed(&through_the_door, &mut passed);
        assert_eq!(passed, [0, 1, 2]);
        let at_the_wall = scene.clear_line([0.5, 0.5, 2.5], [1., 0., 0.]).unwrap();
        index.passed(&at_the_wall, &mut passed);
        assert_eq!((at_the_wall.ends, &passed[..]), ([Some(0), Some(1)], &[0][..]));
        // Inside the wall; along nothing; on the wall's edge, where the parallels part.
        assert!(scene.clear_line([4.5, 0.5, 2.5], [1., 0., 0.]).is_none());
        assert!(scene.clear_line([0.5; 3], [0.; 3]).is_none());
        let grazing = scene.clear_line([0.5, 0.5, 1.0], [1., 0., 0.]).unwrap();
        assert_eq!(grazing.ends[1], None);
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

    /// The impostor: the witnesses distinguish a scene that lacks an object from the whole one.
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
