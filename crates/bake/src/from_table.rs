//! The way back: the cell graph that a stored table was made from.
//!
//! For tables that come from a file. Whoever has just baked a table has its graph ([`Baked::graph`](crate::Baked::graph)),
//! and needs nothing here.

use crate::graph::{GraphKind, TableGraph};
use crate::table::axial_portal_record;
use sightlines_cells::graph::Portal;
use sightlines_cells::{Axial, AxialDoor, BoxCell, CellGraph, CellId, Convex, ConvexCell2, Planar, Portal3};
use sightlines_geometry::{Aabb, Point2, Portal2, check_coordinate};
use sightlines_pvs::{CellRecord, PortalRecord, Table};

/// The graph that a table stores, by its [kind](GraphKind::of): [`planar_graph`], [`convex_graph`], [`axial_graph`], or its boxes. `None` where
/// those say so.
pub fn graph(table: &Table) -> Option<TableGraph> {
    match GraphKind::of(table) {
        GraphKind::Convex => convex_graph(table).map(TableGraph::Convex),
        GraphKind::Planar => planar_graph(table).map(TableGraph::Planar),
        GraphKind::Boxes => {
            Some(TableGraph::Boxes(table.cells().iter().map(|c| Aabb { min: c.min, max: c.max }).collect()))
        }
        GraphKind::Axial => axial_graph(table).map(TableGraph::Axial),
    }
}

/// The planar graph that a table stores, with at most one group for each cell; `None` if the table is not planar, its geometry was stripped,
/// or the stored cells and portals do not fit together.
pub fn planar_graph(table: &Table) -> Option<CellGraph<Planar>> {
    let stored = table.dimension() == 2 && table.cells().iter().all(|c| !c.polygon.is_empty());
    if !stored {
        return None;
    }
    let corner = |&[x, y]: &[f64; 2]| Point2::new(x, y);
    let cell = |c: &CellRecord| ConvexCell2 {
        polygon: c.polygon.iter().map(corner).collect(),
        groups: c.group.into_iter().collect(),
    };
    let portal = |p: &PortalRecord| match p.points[..] {
        [[lx, ly, _], [rx, ry, _]] => {
            let shape = Portal2 { left: Point2::new(lx, ly), right: Point2::new(rx, ry) };
            Some(Portal { cells: p.cells, sides: p.sides, shape })
        }
        _ => None,
    };
    let portals: Option<Vec<Portal<Planar>>> = table.portals().iter().map(portal).collect();
    let graph = CellGraph::new(table.cells().iter().map(cell).collect(), portals?);
    graph.check_well_formed().is_ok().then_some(graph)
}

/// The graph of boxes that a table of a scene in space stores; `None` if the table is of another kind, its portals were
/// stripped, or the stored cells and portals do not fit together. Portals are those that the table was made with, exact
/// pieces or the rectangles around them.
pub fn axial_graph(table: &Table) -> Option<CellGraph<Axial>> {
    // Cells that see each other are joined by portals, so without any they were stripped.
    let joined = (0u32..).take(table.n_cells()).map(CellId).any(|cell| table.visible(cell).any(|other| other != cell));
    let stripped = table.portals().is_empty() && joined;
    if table.dimension() != 3 || stripped {
        return None;
    }
    let cells: Vec<BoxCell> =
        table.cells().iter().map(|c| BoxCell { bounds: Aabb { min: c.min, max: c.max } }).collect();
    let portal = |p: &PortalRecord| {
        let extent = Aabb::<3>::around(p.points.iter().copied());
        let axis = u8::try_from(p.sides[0] / 2).ok().filter(|axis| *axis < 3)?;
        let shape = AxialDoor { extent, axis, forward: p.sides[0] % 2 == 1 };
        let portal = Portal { cells: p.cells, sides: p.sides, shape };
        // Other points than the corners of a rectangle would not come back.
        (axial_portal_record(&portal) == *p).then_some(portal)
    };
    let portals: Option<Vec<Portal<Axial>>> = table.portals().iter().map(portal).collect();
    // Portals lie within cells, which is checked below.
    let in_range = |b: &Aabb<3>| b.min.into_iter().chain(b.max).all(|x| check_coordinate(x).is_ok());
    if !cells.iter().all(|c| in_range(&c.bounds)) {
        return None;
    }
    let graph = CellGraph::<Axial>::new(cells, portals?);
    graph.check_well_formed().is_ok().then_some(graph)
}

/// The graph of clusters that a table of a portal file, or of a map, stores: the one that the table was made from, to the
/// bit. `None` if the table is of another kind ([`TableKind::is_quake`](sightlines_pvs::TableKind::is_quake)), its portals were stripped, or have coordinates out
/// of range or corners without an area. That portals are convex and flat is not checked.
pub fn convex_graph(table: &Table) -> Option<CellGraph<Convex>> {
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
