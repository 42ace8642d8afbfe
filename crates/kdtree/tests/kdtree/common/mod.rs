//! Scenes on small grids, and oracles that look at every unit square or cube of them.
//!
//! The oracles do not use trees. They return what is wrong as text, so that impostors can be shown to fail.

use proptest::prelude::*;
use sightlines_geometry::Aabb;
use sightlines_kdtree::{AxialCell, AxialFace, AxialPortal, AxialTree, KdOptions, subdivide};

/// Side of the square that planar scenes are in.
pub(crate) const SIDE_2D: u32 = 6;
/// Side of the cube that spatial scenes are in.
pub(crate) const SIDE_3D: u32 = 4;

/// Faces with integer coordinates in the square or cube of side `n`, some of them sticking out by one.
pub(crate) fn faces<const D: usize>(n: u32, most: usize) -> impl Strategy<Value = Vec<AxialFace<D>>> {
    let ends = move || prop::array::uniform::<_, D>(-1..=n as i32 + 1);
    let face = (0..D, ends(), ends()).prop_map(|(axis, p, q)| {
        let (mut min, mut max) = (p, q);
        for k in 0..D {
            (min[k], max[k]) = (p[k].min(q[k]), p[k].max(q[k]));
        }
        max[axis] = min[axis];
        AxialFace::new(axis, min.map(f64::from), max.map(f64::from))
    });
    prop::collection::vec(face, 0..most)
}

/// Many short walls: each unit wall of the square is there or not.
pub(crate) fn unit_walls(n: u32) -> impl Strategy<Value = Vec<AxialFace<2>>> {
    prop::collection::vec(0..3u8, (2 * n * n) as usize).prop_map(move |present| {
        let unit = |i: u32| [f64::from(i / 2 / n), f64::from(i / 2 % n)];
        let wall = |i: u32| match (unit(i), i % 2) {
            ([x, y], 0) => AxialFace::new(0, [x, y], [x, y + 1.0]),
            ([x, y], _) => AxialFace::new(1, [x, y], [x + 1.0, y]),
        };
        (0u32..).zip(present).filter(|&(_, p)| p > 0).map(|(i, _)| wall(i)).collect()
    })
}

/// The square or cube of side `n`.
pub(crate) fn grid<const D: usize>(n: u32) -> Aabb<D> {
    Aabb { min: [0.0; D], max: [f64::from(n); D] }
}

/// The subdivision of a scene on the grid.
pub(crate) fn cut<const D: usize>(faces: &[AxialFace<D>], n: u32, tau: f64) -> AxialTree<D> {
    subdivide(faces, grid(n), &KdOptions { tau, ..KdOptions::default() }).expect("the scene is good")
}

/// Centres of all unit cubes of the grid.
pub(crate) fn centres<const D: usize>(n: u32) -> Vec<[f64; D]> {
    let digit = |i: u32, k: usize| f64::from(i / n.pow(k as u32) % n) + 0.5;
    (0..n.pow(D as u32)).map(|i| std::array::from_fn(|k| digit(i, k))).collect()
}

/// The next unit cube on an axis, and the middle of what the two share.
pub(crate) fn step<const D: usize>(centre: [f64; D], axis: usize) -> ([f64; D], [f64; D]) {
    let (mut next, mut between) = (centre, centre);
    next[axis] += 1.0;
    between[axis] += 0.5;
    (next, between)
}

/// Whether a middle point (one integer coordinate, that of `axis`) is on a face.
pub(crate) fn on_face<const D: usize>(faces: &[AxialFace<D>], axis: usize, p: [f64; D]) -> bool {
    faces.iter().any(|f| f.axis == axis && Aabb { min: f.min, max: f.max }.contains(p))
}

/// Which of `n` things are connected, as the least index of each one's component.
pub(crate) fn components(n: usize, links: impl Iterator<Item = (usize, usize)>) -> Vec<usize> {
    let mut label: Vec<usize> = (0..n).collect();
    for (a, b) in links {
        let (from, to) = (label[a].max(label[b]), label[a].min(label[b]));
        label.iter_mut().filter(|l| **l == from).for_each(|l| *l = to);
    }
    label
}

/// Index of the one cell that contains a unit cube's centre.
pub(crate) fn cell_at<const D: usize>(cells: &[AxialCell<D>], centre: [f64; D]) -> Result<usize, String> {
    let mut around = (0..cells.len()).filter(|&i| cells[i].bounds.contains(centre));
    match (around.next(), around.next()) {
        (Some(cell), None) => Ok(cell),
        (first, second) => Err(format!("{centre:?} is in cells {first:?} and {second:?}")),
    }
}

/// Flood filling the unit grid and walking through portals reach the same places.
pub(crate) fn check_connectivity<const D: usize>(
    faces: &[AxialFace<D>],
    n: u32,
    cells: &[AxialCell<D>],
    portals: &[AxialPortal<D>],
) -> Result<(), String> {
    let centres = centres::<D>(n);
    let index = |p: [f64; D]| centres.iter().position(|&c| c == p);
    let mut links = Vec::new();
    for (i, &centre) in centres.iter().enumerate() {
        for axis in 0..D {
            let (next, between) = step(centre, axis);
            links.extend(index(next).filter(|_| !on_face(faces, axis, between)).map(|j| (i, j)));
        }
    }
    let flood = components(centres.len(), links.into_iter());
    let walk = components(cells.len(), portals.iter().map(|p| (p.cells[0].idx(), p.cells[1].idx())));
    for (i, &a) in centres.iter().enumerate() {
        for (j, &b) in centres.iter().enumerate() {
            let walked = walk[cell_at(cells, a)?] == walk[cell_at(cells, b)?];
            if walked != (flood[i] == flood[j]) {
                return Err(format!("flood fill and portals disagree whether {a:?} leads to {b:?}"));
            }
        }
    }
    Ok(())
}

/// Every middle point on the border of two cells is in exactly one portal of the two if it is on no
/// face, else in none; and portals are nowhere else.
pub(crate) fn check_openings<const D: usize>(
    faces: &[AxialFace<D>],
    n: u32,
    cells: &[AxialCell<D>],
    portals: &[AxialPortal<D>],
) -> Result<(), String> {
    let mut n_open = 0.0;
    for centre in centres::<D>(n) {
        for axis in 0..D {
            let (next, between) = step(centre, axis);
            if next[axis] > f64::from(n) {
                continue;
            }
            let pair = [cell_at(cells, centre)?, cell_at(cells, next)?];
            let through = |p: &AxialPortal<D>| {
                p.axis == axis && p.cells.map(|c| c.idx()) == pair && Aabb { min: p.min, max: p.max }.contains(between)
            };
            let found = portals.iter().filter(|p| through(p)).count();
            let open = pair[0] != pair[1] && !on_face(faces, axis, between);
            if found != usize::from(open) {
                return Err(format!("{found} portals lead through {between:?}, open: {open}"));
            }
            n_open += f64::from(u8::from(open));
        }
    }
    // Each unit of measure of a portal was found at some middle point, so nothing is left elsewhere.
    let measure = |p: &AxialPortal<D>| (0..D).filter(|&k| k != p.axis).map(|k| p.max[k] - p.min[k]).product::<f64>();
    let total: f64 = portals.iter().map(measure).sum();
    if total == n_open { Ok(()) } else { Err(format!("portals measure {total}, openings {n_open}")) }
}

/// All walls that two cells share, as if no face were there: an enumeration that forgets faces.
pub(crate) fn all_shared_walls<const D: usize>(tree: &AxialTree<D>) -> Vec<AxialPortal<D>> {
    let cells = tree.cells();
    let mut out = Vec::new();
    for (a, low) in (0u32..).map(sightlines_pvs::CellId).zip(cells) {
        for (b, high) in (0u32..).map(sightlines_pvs::CellId).zip(cells) {
            let (low, high) = (low.bounds, high.bounds);
            let min: [f64; D] = std::array::from_fn(|k| low.min[k].max(high.min[k]));
            let max: [f64; D] = std::array::from_fn(|k| low.max[k].min(high.max[k]));
            for axis in 0..D {
                let wide = (0..D).all(|k| k == axis || min[k] < max[k]);
                if wide && low.max[axis] == high.min[axis] {
                    out.push(AxialPortal { cells: [a, b], axis, at: min[axis], min, max });
                }
            }
        }
    }
    out
}

/// Rooms on both sides of a corridor, each with a door, a desk and a window bay.
pub(crate) fn office(n_rooms: u32) -> Vec<AxialFace<2>> {
    let (width, mut walls) = (f64::from(n_rooms) * 8.0, Vec::new());
    let mut level = |y: f64, x0: f64, x1: f64| walls.push(AxialFace::new(1, [x0, y], [x1, y]));
    for y in [0.0, 18.0] {
        level(y, 0.0, width);
    }
    for x in (0..n_rooms).map(|i| f64::from(i) * 8.0) {
        for (corridor, desk) in [(8.0, 3.0), (10.0, 14.0)] {
            level(corridor, x, x + 3.0);
            level(corridor, x + 4.0, x + 8.0);
            level(desk, x + 2.0, x + 4.0);
        }
    }
    for x in (0..=n_rooms).map(|i| f64::from(i) * 8.0) {
        walls.push(AxialFace::new(0, [x, 0.0], [x, 8.0]));
        walls.push(AxialFace::new(0, [x, 10.0], [x, 18.0]));
        walls.push(AxialFace::new(0, [x, 8.0], [x, 8.5]));
    }
    walls
}
