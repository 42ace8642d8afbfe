//! Grids of boxes as view cells.

use sightlines_formats::ViewCells;
use sightlines_formats::view_cells::ViewCell;
use sightlines_geometry::Aabb;

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
    Ok(ViewCells { cells, axes: None })
}
