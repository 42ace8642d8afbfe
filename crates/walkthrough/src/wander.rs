//! A random walk through a scene, for measuring.

use sightlines_eye_to_cell::CellSource;
use sightlines_geometry::{Aabb, BoxTree, Random};
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
/// If no cell has a portal, as where cells were given, the walk goes from box to box where two touch on an area (in a plane, on a length), and
/// from place to place in a cell that touches no other. A place in the box of a planar cell may be outside of the cell.
///
/// The same arguments give the same walk on every machine. Empty if there are no cells.
///
/// # Errors
/// The first error of the source.
pub fn wander<S: CellSource + ?Sized>(
    source: &S,
    n_frames: usize,
    step: f64,
    seed: u64,
) -> Result<Vec<CameraPose>, S::Error> {
    let mut frames = stroll(source, &Ways::Portals, n_frames, step, seed)?;
    if frames.is_empty() {
        frames = stroll(source, &Ways::between_boxes(source)?, n_frames, step, seed)?;
    }
    if let Some(frame) = source.frame() {
        frames.iter_mut().for_each(|pose| {
            *pose = CameraPose { eye: frame.to_scene(pose.eye), dir: frame.to_scene(pose.dir) };
        });
    }
    Ok(frames)
}

/// A walk along the axes of the source.
fn stroll<S: CellSource + ?Sized>(
    source: &S,
    ways: &Ways,
    n_frames: usize,
    step: f64,
    seed: u64,
) -> Result<Vec<CameraPose>, S::Error> {
    let mut chance = Random::new(seed);
    let mut frames = Vec::with_capacity(n_frames);
    let n_cells = source.n_cells();
    // Consecutive attempts without a place to begin at, or without a frame.
    let mut n_failed = 0;
    while frames.len() < n_frames && n_failed < 16 * n_cells {
        let mut cell = CellId(below(&mut chance, n_cells) as u32);
        let mut here = ways.out_of(source, cell)?;
        let Some(mut place) = here.middle else {
            n_failed += 1;
            continue;
        };
        let n_before = frames.len();
        let mut came_by = None;
        let mut dir = [0.0; 3];
        for _ in 0..40 {
            let others: Vec<&Door> = here.doors.iter().filter(|door| Some(door.way) != came_by).collect();
            let &next = match (others.len(), here.doors.len()) {
                (0, 0) => {
                    let goal = ways.place_in(cell, &mut chance).unwrap_or(place);
                    go(&mut place, &mut dir, goal, step, n_frames, &mut frames);
                    continue;
                }
                (0, n) => &here.doors[below(&mut chance, n)],
                (n, _) => others[below(&mut chance, n)],
            };
            (cell, came_by) = (next.to, Some(next.way.back(cell)));
            here = ways.out_of(source, cell)?;
            let inside = here.middle.unwrap_or(next.at);
            for goal in [next.at, inside] {
                go(&mut place, &mut dir, goal, step, n_frames, &mut frames);
            }
        }
        n_failed = if frames.len() == n_before { n_failed + 1 } else { 0 };
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

/// How cells are left.
enum Ways {
    /// Through portals.
    Portals,
    /// Where boxes touch: the boxes of all cells, and their tree.
    Boxes(Vec<Aabb<3>>, BoxTree<3>),
}

/// What is left by: a portal, or the border to another cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Way {
    Portal(PortalId),
    To(CellId),
}

impl Way {
    /// The way back into `from`.
    fn back(self, from: CellId) -> Self {
        match self {
            Self::Portal(portal) => Self::Portal(portal),
            Self::To(_) => Self::To(from),
        }
    }
}

/// A way out of a cell.
#[derive(Debug, Clone, Copy)]
struct Door {
    way: Way,
    to: CellId,
    /// Its middle.
    at: [f64; 3],
}

/// The ways out of a cell.
struct Exits {
    doors: Vec<Door>,
    /// A point of the cell: between its portals, which is on none of them if there are several on different sides, or in the middle of its
    /// box. `None` without a portal, or without a box.
    middle: Option<[f64; 3]>,
}

impl Ways {
    fn between_boxes<S: CellSource + ?Sized>(source: &S) -> Result<Self, S::Error> {
        let boxes: Result<Vec<_>, _> = (0..source.n_cells() as u32).map(|cell| source.cell_box(CellId(cell))).collect();
        let boxes = boxes?;
        let tree = BoxTree::build(&boxes, 4);
        Ok(Self::Boxes(boxes, tree))
    }

    fn out_of<S: CellSource + ?Sized>(&self, source: &S, cell: CellId) -> Result<Exits, S::Error> {
        let mut doors = Vec::new();
        let Self::Boxes(boxes, tree) = self else {
            source.portal_edges(cell, &mut |edge| {
                if let Some(at) = mean(edge.corners.iter().copied()) {
                    doors.push(Door { way: Way::Portal(edge.portal), to: edge.to, at });
                }
            })?;
            let middle = mean(doors.iter().map(|door| door.at));
            return Ok(Exits { doors, middle });
        };
        let here = boxes[cell.idx()];
        let most_flat = if source.dimension() == 2 { 2 } else { 1 };
        let touching = |other: &Aabb<3>| !common(&here, other).is_empty();
        tree.visit(touching, |other| {
            let border = common(&here, &boxes[other as usize]);
            let n_flat = (0..3).filter(|&k| border.min[k] == border.max[k]).count();
            if other != cell.0 && !border.is_empty() && n_flat <= most_flat {
                let to = CellId(other);
                doors.extend(mean([border.min, border.max].into_iter()).map(|at| Door { way: Way::To(to), to, at }));
            }
        });
        doors.sort_unstable_by_key(|door| door.to);
        let middle = mean([here.min, here.max].into_iter()).filter(|_| !here.is_empty());
        Ok(Exits { doors, middle })
    }

    /// Any place in the box of a cell.
    fn place_in(&self, cell: CellId, chance: &mut Random) -> Option<[f64; 3]> {
        let Self::Boxes(boxes, _) = self else { return None };
        Some(chance.point(&boxes[cell.idx()]))
    }
}

/// What two boxes have in common; empty if that is nothing.
fn common(a: &Aabb<3>, b: &Aabb<3>) -> Aabb<3> {
    Aabb { min: std::array::from_fn(|k| a.min[k].max(b.min[k])), max: std::array::from_fn(|k| a.max[k].min(b.max[k])) }
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
