//! Free lines, by rays in doubles: cells that see an object. They only choose what is asked.

use super::tiling::Tiling;
use rayon::prelude::*;
use sightlines_geometry::{Point3, Random, ray_triangle};
use sightlines_multifocal::RaySampler;
use sightlines_progress::{Cancelled, Counter, Observer};

/// Rays from each box in both directions of a line.
const N_LINES: u32 = 192;

/// So many times its direction a ray goes that meets nothing.
const FAR: f64 = 1e6;

/// Boxes whose rays are in memory at once.
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
            let ends = [(line.object, line.at), (line.behind.0, line.behind.1)];
            let mut note = |cell: u32| {
                for (object, at) in ends {
                    let Some(object) = object else { continue };
                    let bit = cell as usize * n_objects + object as usize;
                    if known[bit / 64] >> (bit % 64) & 1 == 0 {
                        known[bit / 64] |= 1 << (bit % 64);
                        found[object as usize].push(Sight { cell, at });
                    }
                }
            };
            tiling.walk(line.cell, line.origin, line.at, &mut note);
            tiling.walk(line.cell, line.origin, line.behind.1, &mut note);
        }
    }
    Ok(found)
}

/// A free line through a point of a cell, with what it ends at.
struct Line {
    cell: u32,
    origin: Point3,
    object: Option<u32>,
    at: Point3,
    behind: (Option<u32>, Point3),
}

fn lines_of(tiling: &Tiling, rays: &RaySampler, cell: u32) -> Vec<Line> {
    let b = &tiling.boxes()[cell as usize];
    let mut random = Random::new(u64::from(cell));
    let lines = (0..N_LINES).filter_map(|_| {
        let (origin, way) = (random.point(b), random.direction());
        let ahead = hit(rays, origin, way);
        let behind = hit(rays, origin, way.map(|x| -x));
        if ahead.0.is_none() && behind.0.is_none() {
            return None;
        }
        Some(Line { cell, origin, object: ahead.0, at: ahead.1, behind })
    });
    lines.collect()
}

/// What a ray hits first, and where; far away if it is nothing.
pub(super) fn hit(rays: &RaySampler, origin: Point3, way: Point3) -> (Option<u32>, Point3) {
    let along = |t: f64| std::array::from_fn(|k| origin[k] + t * way[k]);
    match rays.first_triangle(origin, way) {
        None => (None, along(FAR)),
        Some(triangle) => {
            let [_, _, t] = ray_triangle(&rays.triangles()[triangle as usize], origin, way);
            (Some(rays.object_of(triangle)), along(t))
        }
    }
}
