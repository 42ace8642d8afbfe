//! What a table begins with before any from-region query: cells, and what may be visible.

use crate::graph::TableGraph;
use crate::mirrors;
use crate::stated::DETAIL_BELOW;
use crate::table::{axial_portal_record, box_record};
use sightlines_cells::{Axial, CellGraph, Scene};
use sightlines_formats::{ViewCell, ViewCells};
use sightlines_geometry::Aabb;
use sightlines_kdtree::SceneSubdivision;
use sightlines_pvs::{BitMatrix, Locator, SceneMethods, TableKind, TableParts};

/// What is known before the first query.
pub(super) struct Start {
    pub(super) graph: TableGraph,
    /// The parts of the table, but for what is visible.
    pub(super) parts: TableParts,
    pub(super) cells: Vec<Aabb<3>>,
    /// Which cells may see each other: symmetric, with ones on the diagonal.
    pub(super) rows: BitMatrix,
    /// Which objects the cells may see.
    pub(super) objects: BitMatrix,
}

/// A matrix of ones.
pub(super) fn ones(n_rows: usize, n_cols: usize) -> BitMatrix {
    let mut all = BitMatrix::new(n_rows, n_cols);
    (0..n_rows).for_each(|row| (0..n_cols).for_each(|col| all.set(row, col, true)));
    all
}

/// The cells of a k-d tree, with what sightlines leave visible.
pub(super) fn of_seen(graph: CellGraph<Axial>, mut parts: TableParts) -> Start {
    let cells = graph.cells().iter().map(|cell| cell.bounds).collect();
    let objects = parts.objects_seen.take().expect("sightlines decide which objects are visible");
    Start { cells, rows: parts.rows.clone(), objects, parts, graph: graph.into() }
}

/// The cells of a k-d tree, of which everything may see everything.
pub(super) fn of_cut(scene: &Scene, cut: SceneSubdivision, n_objects: usize) -> Start {
    let cells: Vec<Aabb<3>> = cut.graph.cells().iter().map(|cell| cell.bounds).collect();
    let info = vec![
        (DETAIL_BELOW.to_owned(), cut.summary.detail_below.to_string()),
        ("subdivide".to_owned(), "kd".to_owned()),
    ];
    let parts = TableParts {
        portals: cut.graph.portals().iter().map(axial_portal_record).collect(),
        mirrors: mirrors::of_scene(&cut.graph, scene).parts,
        info,
        ..parts_of(&cells, TableKind::SceneKdTree { hidden_by: SceneMethods::default() })
    };
    all_visible(cut.graph.into(), parts, cells, n_objects)
}

/// Given boxes, and the parts of their table but for what is visible.
pub(super) fn boxes_alone(boxes: &[ViewCell]) -> (Vec<Aabb<3>>, TableParts) {
    let cells: Vec<Aabb<3>> = boxes.iter().map(|b| b.bounds).collect();
    let parts = TableParts {
        cell_names: boxes.iter().map(|b| b.id.clone()).collect(),
        info: vec![("subdivide".to_owned(), "boxes".to_owned())],
        ..parts_of(&cells, TableKind::SceneGivenCells { hidden_by: SceneMethods::default() })
    };
    (cells, parts)
}

/// Cells that were cut, and the parts of their table but for what is visible.
pub(super) fn places_alone(cells: Vec<Aabb<3>>, how: &str) -> (Vec<Aabb<3>>, TableParts) {
    let parts = TableParts {
        info: vec![("subdivide".to_owned(), how.to_owned())],
        ..parts_of(&cells, TableKind::SceneGivenCells { hidden_by: SceneMethods::default() })
    };
    (cells, parts)
}

/// Cells without portals, of which everything may see everything; with a number of objects, each only that many of the last ones.
pub(super) fn of_alone((cells, parts): (Vec<Aabb<3>>, TableParts), n_objects: usize, n_wanted: Option<usize>) -> Start {
    let graph = TableGraph::Boxes(cells.clone());
    let Some(n_wanted) = n_wanted else { return all_visible(graph, parts, cells, n_objects) };
    let n = cells.len();
    let mut objects = BitMatrix::new(n, n_objects);
    (0..n).for_each(|row| (n_objects - n_wanted..n_objects).for_each(|column| objects.set(row, column, true)));
    Start { graph, parts, cells, rows: BitMatrix::identity(n), objects }
}

fn parts_of(cells: &[Aabb<3>], kind: TableKind) -> TableParts {
    let bounds: Vec<_> = cells.iter().map(|b| (b.min, b.max)).collect();
    TableParts {
        cells: cells.iter().map(box_record).collect(),
        locator: Locator::build(&bounds, 3),
        ..TableParts::empty(3, kind)
    }
}

fn all_visible(graph: TableGraph, parts: TableParts, cells: Vec<Aabb<3>>, n_objects: usize) -> Start {
    let n = cells.len();
    Start { graph, parts, cells, rows: ones(n, n), objects: ones(n, n_objects) }
}

/// Boxes along the axes of the scene around view cells that may stand along others.
pub(crate) fn upright(cells: &ViewCells) -> Vec<ViewCell> {
    let Some(axes) = cells.axes else { return cells.cells.clone() };
    // What was turned into axes of the file is taken back into those of the scene, widened by the rounding. Along the axes of the scene
    // in another order or with other signs nothing is rounded.
    let is_exact = |k: usize| {
        let parts = axes.map(|axis| axis[k].abs());
        parts.iter().all(|&x| x == 0.0 || x == 1.0) && parts.iter().filter(|&&x| x > 0.0).count() < 2
    };
    let turn = |cell: &ViewCell| {
        let (min, max) = (cell.bounds.min, cell.bounds.max);
        let (mut low, mut high) = ([0.0; 3], [0.0; 3]);
        for k in 0..3 {
            let mut size = 0.0;
            for i in 0..3 {
                let ends = [axes[i][k] * min[i], axes[i][k] * max[i]];
                low[k] += ends[0].min(ends[1]);
                high[k] += ends[0].max(ends[1]);
                size += ends[0].abs().max(ends[1].abs());
            }
            if !is_exact(k) {
                low[k] -= size * (8.0 * f64::EPSILON);
                high[k] += size * (8.0 * f64::EPSILON);
            }
        }
        ViewCell { id: cell.id.clone(), bounds: Aabb { min: low, max: high } }
    };
    cells.cells.iter().map(turn).collect()
}
