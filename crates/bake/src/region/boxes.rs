//! View cells that are given as boxes.

use sightlines_formats::ViewCells;
use sightlines_formats::view_cells::ViewCell;
use sightlines_geometry::Aabb;
use sightlines_pvs::{BitMatrix, CellId, Table};

/// No cells along an axis of a grid, or more than a table should have.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("a grid of {0} x {1} x {2} view cells; there have to be from 1 to 65536 in all")]
pub struct GridError(pub u32, pub u32, pub u32);

/// A grid of `n` boxes along each axis that fills `region`. Neighbours share their borders exactly.
///
/// # Errors
/// [`GridError`]
pub fn grid(region: &Aabb<3>, n: [u32; 3]) -> Result<ViewCells, GridError> {
    let all = n.iter().try_fold(1u32, |all, &n| all.checked_mul(n));
    if !all.is_some_and(|all| (1..=1 << 16).contains(&all)) {
        return Err(GridError(n[0], n[1], n[2]));
    }
    let border = |axis: usize, i: u32| {
        let (low, high) = (region.min[axis], region.max[axis]);
        if i == n[axis] { high } else { low + (high - low) * (f64::from(i) / f64::from(n[axis])) }
    };
    let mut cells = Vec::new();
    for z in 0..n[2] {
        for y in 0..n[1] {
            for x in 0..n[0] {
                let at = [x, y, z];
                let min = std::array::from_fn(|k| border(k, at[k]));
                let max = std::array::from_fn(|k| border(k, at[k] + 1));
                cells.push(ViewCell { id: format!("g_{x}_{y}_{z}"), bounds: Aabb { min, max } });
            }
        }
    }
    Ok(ViewCells { cells })
}

/// What boxes see of each other and of objects, if each sees what the cells of `table` that it touches see. A box that
/// touches no cell sees everything.
pub(super) fn seen_by_touched(boxes: &[Aabb<3>], table: &Table, n_objects: usize) -> (BitMatrix, BitMatrix) {
    let meet = |a: &Aabb<3>, b: &Aabb<3>| (0..3).all(|k| a.min[k] <= b.max[k] && b.min[k] <= a.max[k]);
    let cells: Vec<Aabb<3>> = table.cells().iter().map(|c| Aabb { min: c.min, max: c.max }).collect();
    let touched = |b: &Aabb<3>| -> Vec<usize> { (0..cells.len()).filter(|&c| meet(b, &cells[c])).collect() };
    let touched: Vec<Vec<usize>> = boxes.iter().map(touched).collect();
    let (mut rows, mut objects) = (BitMatrix::identity(boxes.len()), BitMatrix::new(boxes.len(), n_objects));
    for (a, of_a) in touched.iter().enumerate() {
        let mut sees = vec![of_a.is_empty(); cells.len()];
        for &c in of_a {
            table.visible(CellId(c as u32)).for_each(|seen| sees[seen.idx()] = true);
            table.visible_objects(CellId(c as u32)).into_iter().for_each(|o| objects.set(a, o as usize, true));
        }
        for (b, of_b) in touched.iter().enumerate() {
            if of_a.is_empty() || of_b.is_empty() || of_b.iter().any(|&c| sees[c]) {
                rows.set(a, b, true);
                rows.set(b, a, true);
            }
        }
        if of_a.is_empty() {
            (0..n_objects).for_each(|o| objects.set(a, o, true));
        }
    }
    (rows, objects)
}
