//! Free lines, by rays in doubles: cells that see an object. They only choose what is asked.

use super::tiling::Tiling;
use rayon::prelude::*;
use sightlines_geometry::{Point3, Random, ray_triangle};
use sightlines_multifocal::RaySampler;
use sightlines_progress::{Cancelled, Counter, Observer};

/// Rays from each cell in both directions of a line.
const N_LINES: u32 = 192;

/// So many times its direction a ray goes that meets nothing.
const FAR: f64 = 1e6;

/// A ray back starts this share of the way before the end, so that it does not hit the surface there. Rays only choose; nothing is hidden by them.
const BEFORE: f64 = 1.0 / (1u64 << 20) as f64;

/// Cells whose rays are in memory at once.
const CHUNK: usize = 1024;

/// Where a cell sees an object.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Sight {
    pub(super) cell: u32,
    pub(super) at: Point3,
}

/// For each object the cells that lines in any direction find to see it, each once.
///
/// # Errors
/// [`Cancelled`] by the observer.
pub(super) fn sights(
    tiling: &Tiling,
    rays: &RaySampler,
    n_objects: usize,
    observer: Option<&dyn Observer>,
) -> Result<Vec<Vec<Sight>>, Cancelled> {
    let counter = Counter::new(observer, "rays", tiling.len());
    let mut found: Vec<Vec<Sight>> = vec![Vec::new(); n_objects];
    let mut known = vec![0u64; (tiling.len() * n_objects).div_ceil(64)];
    let cells: Vec<u32> = (0..tiling.len() as u32).collect();
    for chunk in cells.chunks(CHUNK) {
        let lines_of = |&cell: &u32| {
            counter.step()?;
            Ok(lines_of(tiling, rays, cell))
        };
        let lines = chunk.par_iter().map(lines_of).collect::<Result<Vec<_>, Cancelled>>()?;
        for line in lines.into_iter().flatten() {
            let mut note = |cell: u32, (object, at): (Option<u32>, Point3)| {
                let Some(object) = object else { return };
                let bit = cell as usize * n_objects + object as usize;
                if known[bit / 64] >> (bit % 64) & 1 == 0 {
                    known[bit / 64] |= 1 << (bit % 64);
                    found[object as usize].push(Sight { cell, at });
                }
            };
            for k in 0..2 {
                let (here, beyond) = (line.ends[k], line.ends[1 - k]);
                tiling.passed(line.origin, here.1, |cell| {
                    note(cell, here);
                    if line.is_free_back[k] {
                        note(cell, beyond);
                    }
                });
            }
        }
    }
    Ok(found)
}

/// A free line through a point of a cell.
struct Line {
    origin: Point3,
    /// What is seen in both directions, and where.
    ends: [(Option<u32>, Point3); 2],
    /// Whether the line is also free from these ends back to the origin.
    is_free_back: [bool; 2],
}

fn lines_of(tiling: &Tiling, rays: &RaySampler, cell: u32) -> Vec<Line> {
    let b = &tiling.boxes()[cell as usize];
    let mut random = Random::new(u64::from(cell));
    let is_one_way = rays.is_one_way();
    let lines = (0..N_LINES).filter_map(|_| {
        let (origin, way) = (random.point(b), random.direction());
        let ends = [way, way.map(|x| -x)].map(|way| hit(rays, origin, way));
        if ends.iter().all(|end| end.0.is_none()) {
            return None;
        }
        let is_free_back = ends.map(|(_, end)| !is_one_way || is_free_back(rays, origin, end));
        Some(Line { origin, ends, is_free_back })
    });
    lines.collect()
}

/// Whether a segment that is free from `origin` to `end` is also free from `end` to `origin`: a wall that the ray passed from behind may hide from its
/// front.
pub(super) fn is_free_back(rays: &RaySampler, origin: Point3, end: Point3) -> bool {
    let near: Point3 = std::array::from_fn(|k| end[k] + BEFORE * (origin[k] - end[k]));
    let way: Point3 = std::array::from_fn(|k| origin[k] - near[k]);
    rays.first_triangle(near, way).is_none_or(|t| ray_triangle(&rays.triangles()[t as usize], near, way)[2] >= 1.0)
}

/// What somebody sees first, and where; far away if it is nothing.
pub(super) fn hit(rays: &RaySampler, origin: Point3, way: Point3) -> (Option<u32>, Point3) {
    let along = |t: f64| std::array::from_fn(|k| origin[k] + t * way[k]);
    match rays.first_triangle(origin, way) {
        None => (None, along(FAR)),
        Some(triangle) => {
            let [_, _, t] = ray_triangle(&rays.triangles()[triangle as usize], origin, way);
            (rays.shows(triangle, way).then(|| rays.object_of(triangle)), along(t))
        }
    }
}
