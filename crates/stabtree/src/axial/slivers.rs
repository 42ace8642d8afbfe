//! Cells so thin that programs in doubles cannot separate their sides.
//!
//! In real buildings, coordinates that should be equal differ by rounding, and an exact subdivision has cells of that
//! thickness. No eye is ever in one, but it must not be reported hidden wrongly. Every line through a cell, unless it
//! lies wholly in the cell, comes through a portal from a neighbour, so the visible set of a sliver is the union of its
//! neighbours' visible sets: slivers inherit their neighbours' visibility.

use sightlines_cells::{Axial, CellGraph, CellId};
use sightlines_geometry::Aabb;
use sightlines_pvs::BitMatrix;

/// A cell thinner than this share of the longest side of the box around all cells is a sliver. The rule for slivers is
/// sound for any value; doubles resolve 2^-52 of the box, and programs lose some twenty bits of them.
pub(super) const THIN: f64 = 1.0 / (1u64 << 32) as f64;

/// Which cells are slivers.
pub(super) fn find(extents: &[Aabb<3>]) -> Vec<bool> {
    let all = Aabb::<3>::around(extents.iter().flat_map(|b| [b.min, b.max]));
    let size = |b: &Aabb<3>| [0, 1, 2].map(|k| b.max[k] - b.min[k]);
    let thin = size(&all).into_iter().fold(0.0, f64::max) * THIN;
    extents.iter().map(|b| size(b).into_iter().any(|x| x < thin)).collect()
}

/// For each cell the objects that touch it or a sliver that lines from it enter.
///
/// A line that reaches an object in a sliver entered that sliver from a neighbour; so testing only the neighbours
/// misses nothing.
pub(super) fn within_reach(graph: &CellGraph<Axial>, slivers: &[bool], touching: &[Vec<u32>]) -> Vec<Vec<u32>> {
    let mut reach = touching.to_vec();
    for sliver in (0..slivers.len()).filter(|&cell| slivers[cell]) {
        for cell in neighbours(graph, &|cell| slivers[cell], sliver) {
            reach[cell].extend(&touching[sliver]);
        }
    }
    for objects in &mut reach {
        objects.sort_unstable();
        objects.dedup();
    }
    reach
}

/// Fills in the rows and columns of slivers from those of all other cells.
pub(super) fn fill(
    graph: &CellGraph<Axial>,
    is_sliver: impl Fn(usize) -> bool,
    touching: &[Vec<u32>],
    cells: &mut BitMatrix,
    objects: &mut BitMatrix,
) {
    let slivers: Vec<usize> = (0..graph.n_cells()).filter(|&cell| is_sliver(cell)).collect();
    let around: Vec<Vec<usize>> = slivers.iter().map(|&cell| neighbours(graph, &is_sliver, cell)).collect();
    for &sliver in &slivers {
        touching[sliver].iter().for_each(|&o| objects.set(sliver, o as usize, true));
    }
    // The surroundings of a sliver: all slivers connected with it, and the cells around those.
    for (&sliver, around) in slivers.iter().zip(&around) {
        for &cell in around {
            cells.or_into(sliver, cell);
            objects.or_into(sliver, cell);
        }
    }
    // A sliver sees another if a neighbour does: so first everything that neighbours see, then the slivers.
    for _ in 0..2 {
        for &sliver in &slivers {
            let seen: Vec<usize> = cells.iter_ones(sliver).collect();
            seen.into_iter().for_each(|cell| cells.set(cell, sliver, true));
        }
        for (&sliver, around) in slivers.iter().zip(&around) {
            around.iter().for_each(|&cell| cells.or_into(sliver, cell));
        }
    }
    for &sliver in &slivers {
        let seen: Vec<usize> = cells.iter_ones(sliver).collect();
        seen.into_iter().for_each(|cell| cells.set(cell, sliver, true));
    }
}

/// The neighbours of a sliver beyond other slivers, and those slivers.
fn neighbours(graph: &CellGraph<Axial>, is_sliver: &impl Fn(usize) -> bool, cell: usize) -> Vec<usize> {
    let mut found = vec![cell];
    let mut next = 0;
    while let Some(&at) = found.get(next) {
        next += 1;
        if !is_sliver(at) {
            continue;
        }
        for exit in graph.exits(CellId(at as u32)) {
            if !found.contains(&exit.to.idx()) {
                found.push(exit.to.idx());
            }
        }
    }
    found.retain(|&other| other != cell);
    found
}
