//! What a viewer has to draw, on average.

use crate::summary::size;
use serde::Serialize;
use sightlines_pvs::{CellId, ObjectId, Table, TriangleRange};
use std::collections::BTreeMap;

/// Shares of a scene that a viewer sees, from 0 to 1, averaged over the places where a viewer may be: each
/// cell counts by its size.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
pub struct ViewerShare {
    /// Of the cells, the viewer's own among them.
    pub cells: f64,
    /// Of the objects.
    pub objects: f64,
    /// Of the polygons: objects, and parts of objects, by the number of polygons that each has.
    pub polygons: f64,
}

impl ViewerShare {
    /// Averages.
    ///
    /// * `polygons`: for each object of the table how many polygons it has; objects without a number have
    ///   none.
    ///
    /// A share of nothing is 0. O(pairs of cells that see each other, and of cells and objects).
    pub fn of(table: &Table, polygons: &[u64]) -> Self {
        let sizes: Vec<f64> = table.cells().iter().map(|cell| size(cell, table.dimension())).collect();
        let all: f64 = sizes.iter().sum();
        let n_polygons: u64 = polygons.iter().take(table.objects().len()).sum();
        let share = |part: f64, whole: u64| if whole > 0 { part / whole as f64 } else { 0.0 };
        let ends: BTreeMap<ObjectId, u32> = table.object_parts().iter().map(|part| (part.object, part.end)).collect();
        let mut mean = Self { cells: 0.0, objects: 0.0, polygons: 0.0 };
        for (cell, size) in (0u32..).map(CellId).zip(sizes).filter(|_| all > 0.0) {
            let weight = size / all;
            let objects = table.visible_objects(cell);
            let polygons_in = |(object, range): TriangleRange| {
                let all = polygons.get(object.idx()).copied().unwrap_or(0) as f64;
                range.map_or(all, |range| all * f64::from(range.end - range.start) / f64::from(ends[&object]))
            };
            let seen: f64 = table.visible_ranges(cell).into_iter().map(polygons_in).sum();
            let n_cells: u64 = table.row(cell).iter().map(|word| u64::from(word.count_ones())).sum();
            mean.cells += weight * share(n_cells as f64, table.n_cells() as u64);
            mean.objects += weight * share(objects.len() as f64, table.objects().len() as u64);
            mean.polygons += weight * share(seen, n_polygons);
        }
        mean
    }
}
