//! Tables of clusters, and the way back to their graph.

use sightlines_cells::{CellGraph, CellId, Convex, Portal, Portal3};
use sightlines_formats::quake::Prt;
use sightlines_geometry::check_coordinate;
use sightlines_pvs::{Axis, BitMatrix, CellRecord, Locator, PortalRecord, Table, TableKind, TableParts};

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
        ..TableParts::empty(3, TableKind::QuakePortalFile)
    }
}

/// Tables have corners counter-clockwise as seen from the first cell, portals about the direction of crossing,
/// which points away from there.
fn portal_record(portal: &Portal<Convex>) -> PortalRecord {
    let points = portal.shape.reversed().corners().to_vec();
    PortalRecord { cells: portal.cells, sides: portal.sides, points }
}

/// The graph of clusters that a table of a portal file, or of a map, stores: the one that the table was made from, to the
/// bit. `None` if the table was made from something else ([`sightlines_pvs::TableKind::is_quake`]), or its portals were stripped, or have coordinates that predicates do
/// not bear or corners that go round nothing. That portals are convex and flat is believed, as bits of rows are.
pub fn convex_graph_of(table: &Table) -> Option<CellGraph<Convex>> {
    // Cells that see each other are joined by portals, so without any they were stripped.
    let joined = (0u32..).take(table.n_cells()).map(CellId).any(|cell| table.visible(cell).any(|other| other != cell));
    if table.dimension() != 3 || !table.kind().is_quake() || (table.portals().is_empty() && joined) {
        return None;
    }
    let portal = |p: &PortalRecord| {
        let in_range = p.points.as_flattened().iter().all(|&x| check_coordinate(x).is_ok());
        let shape = Portal3::of_corners(p.points.iter().rev().copied().collect()).filter(|_| in_range)?;
        Some((p.cells, shape))
    };
    let portals: Option<Vec<_>> = table.portals().iter().map(portal).collect();
    Some(CellGraph::of_portals(table.n_cells(), portals?))
}
