//! Tables from cell graphs, and back.

use crate::objects::cell_objects;
use crate::scene;
use sightlines_cells::{Axial, AxialDoor, BoxCell, CellGraph, ConvexCell2, PlanObject, Planar, graph::Portal};
use sightlines_geometry::{Aabb, Point2, Portal2, check_coordinate};
use sightlines_pvs::{
    BitMatrix, CellId, CellRecord, Locator, ObjectRecord, PortalRecord, Table, TableError, TableKind, TableParts,
};

/// What goes into a table beside cells and rows.
#[derive(Debug, Clone)]
pub struct TableOptions<'a> {
    /// Objects of the scene.
    pub objects: &'a [PlanObject],
    /// What kind of table it is.
    pub kind: TableKind,
    /// Keys and values for people; sorted here.
    pub info: Vec<(String, String)>,
}

impl TableOptions<'_> {
    /// A table of a kind, without objects and texts.
    pub fn new(kind: TableKind) -> Self {
        Self { objects: &[], kind, info: Vec::new() }
    }
}

fn lift([x, y]: [f64; 2]) -> [f64; 3] {
    [x, y, 0.0]
}

fn point(p: Point2) -> [f64; 3] {
    [p.x, p.y, 0.0]
}

fn cell_record(cell: &ConvexCell2) -> CellRecord {
    let bounds = cell.bounds();
    CellRecord {
        min: lift(bounds.min),
        max: lift(bounds.max),
        // Where lines disagree, the first group speaks for the cell.
        group: cell.groups.first().copied(),
        polygon: cell.polygon.iter().map(|p| [p.x, p.y]).collect(),
    }
}

fn portal_record(portal: &Portal<Planar>) -> PortalRecord {
    let Portal2 { left, right } = portal.shape;
    PortalRecord { cells: portal.cells, sides: portal.sides, points: vec![point(left), point(right)] }
}

/// The table of a planar graph whose cells see each other as `rows` says.
///
/// # Errors
/// [`TableError`] if the parts do not fit together, which is a defect of who made them.
pub fn table_of(graph: &CellGraph<Planar>, rows: BitMatrix, options: TableOptions<'_>) -> Result<Table, TableError> {
    let cells: Vec<CellRecord> = graph.cells().iter().map(cell_record).collect();
    let bounds: Vec<([f64; 3], [f64; 3])> = cells.iter().map(|c| (c.min, c.max)).collect();
    let record =
        |o: &PlanObject| ObjectRecord { name: o.name.clone(), min: lift(o.bounds.min), max: lift(o.bounds.max) };
    let mut info = options.info;
    info.sort();
    Table::new(TableParts {
        portals: graph.portals().iter().map(portal_record).collect(),
        rows,
        objects: options.objects.iter().map(record).collect(),
        cell_objects: cell_objects(graph.cells(), options.objects),
        locator: Locator::build(&bounds, 2),
        cells,
        info,
        ..TableParts::empty(2, options.kind)
    })
}

/// The planar graph that a table stores, with at most one group for each cell; `None` if the table is not planar, its geometry was stripped,
/// or the stored cells and portals do not fit together.
pub fn graph_of(table: &Table) -> Option<CellGraph<Planar>> {
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

/// The graph of boxes that a table of a scene in space stores; `None` if the table is none, or the stored
/// cells and portals do not fit together. Portals are those that the table was made with, exact pieces or
/// the rectangles around them.
pub fn axial_graph_of(table: &Table) -> Option<CellGraph<Axial>> {
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
        (scene::portal_record(&portal) == *p).then_some(portal)
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
