//! What a viewer has to draw, on average.

use crate::summary::size;
use serde::Serialize;
use sightlines_pvs::{CellId, ObjectId, Table};
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
        let share = |part: u64, whole: u64| if whole > 0 { part as f64 / whole as f64 } else { 0.0 };
        let ends: BTreeMap<ObjectId, u32> = table.object_parts().iter().map(|part| (part.object, part.end)).collect();
        let mut mean = Self { cells: 0.0, objects: 0.0, polygons: 0.0 };
        for (cell, size) in (0u32..).map(CellId).zip(sizes).filter(|_| all > 0.0) {
            let weight = size / all;
            let objects = table.visible_objects(cell);
            let whole: u64 = objects.iter().filter_map(|&o| polygons.get(o.idx())).sum();
            // Of objects in parts, what is not seen.
            let hidden: f64 = if ends.is_empty() { 0.0 } else { unseen(table, cell, &objects, polygons, &ends) };
            let n_cells: u64 = table.row(cell).iter().map(|word| u64::from(word.count_ones())).sum();
            mean.cells += weight * share(n_cells, table.n_cells() as u64);
            mean.objects += weight * share(objects.len() as u64, table.objects().len() as u64);
            mean.polygons += weight * share(whole, n_polygons);
            mean.polygons -= if n_polygons > 0 { weight * hidden / n_polygons as f64 } else { 0.0 };
        }
        mean
    }
}

/// How many polygons of the objects that a cell sees are in parts that it does not see, by the triangles of the parts.
///
/// * `ends`: of each object in parts the end of the last one
fn unseen(table: &Table, cell: CellId, objects: &[ObjectId], polygons: &[u64], ends: &BTreeMap<ObjectId, u32>) -> f64 {
    let mut n_seen: BTreeMap<ObjectId, u32> = BTreeMap::new();
    for (object, range) in table.visible_ranges(cell) {
        *n_seen.entry(object).or_default() += range.map_or(0, |range| range.end - range.start);
    }
    let of = |object: &ObjectId| {
        let end = f64::from(*ends.get(object)?);
        let seen = f64::from(n_seen.get(object).copied().unwrap_or(0));
        Some(*polygons.get(object.idx())? as f64 * (1.0 - seen / end))
    };
    objects.iter().filter_map(of).sum()
}
