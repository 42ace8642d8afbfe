//! Tables of clusters.

use sightlines_cells::{CellGraph, Convex, Portal};
use sightlines_formats::quake::Prt;
use sightlines_pvs::{Axis, BitMatrix, CellRecord, Locator, PortalRecord, TableKind, TableParts};

/// The key of the text that names the file's format and dialect, for people.
pub(super) const SOURCE_KEY: &str = "source";

/// What a table of a graph of clusters is made of, without where they are.
pub(super) fn parts_of_clusters(prt: &Prt, graph: &CellGraph<Convex>, rows: BitMatrix, fast: bool) -> TableParts {
    let cell = |bounds: sightlines_geometry::Aabb<3>| {
        // A cell without portals is nowhere that is known.
        let (min, max) = if bounds.is_empty() { ([0.0; 3], [0.0; 3]) } else { (bounds.min, bounds.max) };
        CellRecord { min, max, group: None, polygon: Vec::new() }
    };
    let cells: Vec<CellRecord> = graph.cells().iter().map(|c| cell(c.bounds)).collect();
    let bounds: Vec<([f64; 3], [f64; 3])> = cells.iter().map(|c| (c.min, c.max)).collect();
    let pair = |k: &str, v: String| (k.to_owned(), v);
    // Ascending keys.
    let info = vec![
        pair("search", if fast { "fast" } else { "full" }.to_owned()),
        pair(SOURCE_KEY, format!("portal file {}", prt.dialect())),
        pair("up", "z".to_owned()),
    ];
    TableParts {
        portals: graph.portals().iter().map(portal_record).collect(),
        rows,
        cell_objects: vec![Vec::new(); cells.len()],
        locator: Locator::build(&bounds, 3),
        cells,
        info,
        up: Some(Axis::Z),
        digest: Some(graph.digest()),
        ..TableParts::empty(3, TableKind::QuakePortalFile)
    }
}

/// Tables have corners counter-clockwise as seen from the first cell, portals about the direction of crossing,
/// which points away from there.
fn portal_record(portal: &Portal<Convex>) -> PortalRecord {
    let points = portal.shape.reversed().corners().to_vec();
    PortalRecord { cells: portal.cells, sides: portal.sides, points }
}
