//! How much of a scene a viewer has to draw.

use sightlines::cells::Scene;
use sightlines::pvs::{CellId, Table};

/// The number of triangles of each object.
pub fn triangles_of(scene: &Scene) -> Vec<u64> {
    scene.objects().iter().map(|o| o.triangles.len() as u64).collect()
}

/// Which share of all triangles belongs to `objects`; 0 for a scene without triangles.
pub fn share_of(triangles: &[u64], objects: impl IntoIterator<Item = u32>) -> f64 {
    let all = triangles.iter().sum::<u64>().max(1);
    objects.into_iter().map(|o| triangles[o as usize]).sum::<u64>() as f64 / all as f64
}

/// The mean over cells of the share of triangles that `seen` lists for each, weighted by volume: what a
/// viewer draws who may be anywhere in the cells.
pub fn mean_share<I: IntoIterator<Item = u32>>(table: &Table, triangles: &[u64], seen: impl Fn(CellId) -> I) -> f64 {
    let (mut sum, mut all) = (0.0, 0.0);
    for (cell, record) in (0u32..).map(CellId).zip(table.cells()) {
        let volume: f64 = (0..3).map(|k| record.max[k] - record.min[k]).product();
        sum += volume * share_of(triangles, seen(cell));
        all += volume;
    }
    if all > 0.0 { sum / all } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sightlines::pvs::ObjectId;
    use sightlines::pvs::{BitMatrix, CellRecord, Locator, ObjectRecord, TableKind, TableParts};

    #[test]
    fn large_cells_count_more() {
        let cell = |x: f64, wide: f64| CellRecord {
            min: [x, 0.0, 0.0],
            max: [x + wide, 1.0, 1.0],
            group: None,
            polygon: Vec::new(),
        };
        let object = |at: f64| ObjectRecord { name: String::new(), min: [at; 3], max: [at; 3] };
        let cells = vec![cell(0.0, 1.0), cell(1.0, 3.0)];
        let table = Table::new(TableParts {
            locator: Locator::build(&[(cells[0].min, cells[0].max), (cells[1].min, cells[1].max)], 3),
            cells,
            rows: BitMatrix::identity(2),
            objects: vec![object(0.5), object(0.5)],
            cell_objects: vec![vec![ObjectId(0), ObjectId(1)], vec![]],
            ..TableParts::empty(3, TableKind::Unspecified)
        });
        let table = table.unwrap();
        assert_eq!(share_of(&[3, 1], [1]), 0.25);
        assert_eq!(mean_share(&table, &[3, 1], |cell| table.visible_objects(cell).into_iter().map(|o| o.0)), 0.25);
        assert_eq!(mean_share(&table, &[3, 1], |_| [1]), 0.25);
        assert_eq!(share_of(&[], []), 0.0);
    }
}
