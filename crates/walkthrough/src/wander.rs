//! A random walk through a scene, for measuring.

use sightlines_eye_to_cell::CellSource;
use sightlines_geometry::{Aabb, Random};
use sightlines_pvs::{CellId, PortalId};

/// The position and direction of the viewer in a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CameraPose {
    /// The eye, in scene units; z is 0 in a plane.
    pub eye: [f64; 3],
    /// The direction of view; any non-zero vector.
    pub dir: [f64; 3],
}

/// The share of its old direction that a view keeps in each frame.
const INERTIA: f64 = 0.875;

/// Walks through a scene for `n_frames` frames: from the middle of a cell through a portal into the next, seldom back,
/// looking ahead, with smooth turns; now and then the walk restarts elsewhere, so that long walks see most of a scene.
/// `step` is the distance between frames in scene units.
///
/// The same arguments give the same walk on every machine. Empty if no cell has a portal.
///
/// # Errors
/// The first error of the source.
pub fn wander<S: CellSource + ?Sized>(
    source: &S,
    n_frames: usize,
    step: f64,
    seed: u64,
) -> Result<Vec<CameraPose>, S::Error> {
    let mut chance = Random::new(seed);
    let mut frames = Vec::with_capacity(n_frames);
    let n_cells = source.n_cells();
    // Consecutive attempts without finding a portal.
    let mut n_failed = 0;
    while frames.len() < n_frames && n_failed < 16 * n_cells {
        let mut cell = CellId(below(&mut chance, n_cells) as u32);
        let mut doors = doors(source, cell)?;
        let Some(mut place) = middle(&doors) else {
            n_failed += 1;
            continue;
        };
        n_failed = 0;
        let mut came_by = None;
        let mut dir = [0.0; 3];
        for _ in 0..40 {
            let others: Vec<&Door> = doors.iter().filter(|door| Some(door.portal) != came_by).collect();
            let &next = match others.len() {
                0 => &doors[below(&mut chance, doors.len())],
                n => others[below(&mut chance, n)],
            };
            (cell, came_by) = (next.to, Some(next.portal));
            doors = self::doors(source, cell)?;
            let inside = middle(&doors).unwrap_or(next.at);
            for goal in [next.at, inside] {
                go(&mut place, &mut dir, goal, step, n_frames, &mut frames);
            }
        }
    }
    if let Some(frame) = source.frame() {
        frames.iter_mut().for_each(|pose| {
            *pose = CameraPose { eye: frame.to_scene(pose.eye), dir: frame.to_scene(pose.dir) };
        });
    }
    Ok(frames)
}

/// A distance between frames that suits a scene: a 400th of the diagonal of the box around all cells. O(cells).
///
/// # Errors
/// The first error of the source.
pub fn usual_step<S: CellSource + ?Sized>(source: &S) -> Result<f64, S::Error> {
    let mut all = Aabb::<3>::around([]);
    for cell in (0..source.n_cells() as u32).map(CellId) {
        let bounds = source.cell_box(cell)?;
        for k in 0..3 {
            if bounds.min[k] <= bounds.max[k] {
                (all.min[k], all.max[k]) = (all.min[k].min(bounds.min[k]), all.max[k].max(bounds.max[k]));
            }
        }
    }
    let diagonal = (0..3).map(|k| (all.max[k] - all.min[k]).powi(2)).sum::<f64>().sqrt();
    // Without cells there is no walk, whatever the step is.
    Ok(if diagonal.is_finite() && diagonal > 0.0 { diagonal / 400.0 } else { 1.0 })
}

/// Goes straight to `goal`, one frame per step.
fn go(
    place: &mut [f64; 3],
    dir: &mut [f64; 3],
    goal: [f64; 3],
    step: f64,
    n_frames: usize,
    frames: &mut Vec<CameraPose>,
) {
    let way: [f64; 3] = std::array::from_fn(|k| goal[k] - place[k]);
    let length = way.iter().map(|x| x * x).sum::<f64>().sqrt();
    if !(length > 0.0 && length.is_finite() && step > 0.0) {
        return;
    }
    let n = (length / step).ceil().clamp(1.0, 1e6);
    let start = *place;
    for k in 1..=n as usize {
        if frames.len() == n_frames {
            return;
        }
        *dir = std::array::from_fn(|i| INERTIA * dir[i] + (1.0 - INERTIA) * way[i] / length);
        // The last step ends exactly at the goal, without rounding.
        *place = if k as f64 == n { goal } else { std::array::from_fn(|i| start[i] + way[i] * (k as f64 / n)) };
        let looks = if dir.iter().all(|x| x.abs() < 1e-3) { way } else { *dir };
        frames.push(CameraPose { eye: *place, dir: looks });
    }
}

/// A portal out of a cell.
#[derive(Debug, Clone, Copy)]
struct Door {
    portal: PortalId,
    to: CellId,
    /// Its middle.
    at: [f64; 3],
}

fn doors<S: CellSource + ?Sized>(source: &S, cell: CellId) -> Result<Vec<Door>, S::Error> {
    let mut doors = Vec::new();
    source.portal_edges(cell, &mut |way| {
        if let Some(at) = mean(way.corners.iter().copied()) {
            doors.push(Door { portal: way.portal, to: way.to, at });
        }
    })?;
    Ok(doors)
}

/// A point of the convex cell between its portals. Not on a portal if there are several on different sides.
fn middle(doors: &[Door]) -> Option<[f64; 3]> {
    mean(doors.iter().map(|door| door.at))
}

fn mean(points: impl ExactSizeIterator<Item = [f64; 3]>) -> Option<[f64; 3]> {
    let n = points.len() as f64;
    let sum = points.fold([0.0; 3], |sum: [f64; 3], p| std::array::from_fn(|k| sum[k] + p[k]));
    (n > 0.0).then(|| sum.map(|x| x / n))
}

/// An integer from 0 to before `n`.
fn below(chance: &mut Random, n: usize) -> usize {
    ((u128::from(chance.bits()) * n as u128) >> 64) as usize
}
