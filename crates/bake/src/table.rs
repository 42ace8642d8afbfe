//! The parts of tables, from cell graphs.

use crate::objects::{cell_objects, object_lists};
use sightlines_cells::{Axial, AxialDoor, CellGraph, ConvexCell2, PlanObject, Planar, graph::Portal};
use sightlines_formats::SceneInfo;
use sightlines_formats::scene::{BackFaces, LengthUnit, SceneReadOptions};
use sightlines_geometry::{Aabb, Point2, Portal2};
use sightlines_pvs::{
    BitMatrix, CellRecord, Locator, ObjectRecord, PortalRecord, Table, TableError, TableKind, TableParts,
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
        // Where lines disagree, the cell has the first group.
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
/// [`TableError`] if the parts do not fit together, which is a defect of the caller.
pub fn table_of(graph: &CellGraph<Planar>, rows: BitMatrix, options: TableOptions<'_>) -> Result<Table, TableError> {
    Table::new(planar_parts(graph, rows, options))
}

/// What [`table_of`] makes a table of.
pub(crate) fn planar_parts(graph: &CellGraph<Planar>, rows: BitMatrix, options: TableOptions<'_>) -> TableParts {
    let cells: Vec<CellRecord> = graph.cells().iter().map(cell_record).collect();
    let bounds: Vec<([f64; 3], [f64; 3])> = cells.iter().map(|c| (c.min, c.max)).collect();
    let record =
        |o: &PlanObject| ObjectRecord { name: o.name.clone(), min: lift(o.bounds.min), max: lift(o.bounds.max) };
    let mut info = options.info;
    info.sort();
    TableParts {
        portals: graph.portals().iter().map(portal_record).collect(),
        rows,
        objects: options.objects.iter().map(record).collect(),
        cell_objects: object_lists(cell_objects(graph.cells(), options.objects)),
        locator: Locator::build(&bounds, 2),
        cells,
        info,
        ..TableParts::empty(2, options.kind)
    }
}

/// Adds the axes and units that the file of a scene states.
pub(crate) fn state_file(parts: &mut TableParts, file: Option<&SceneInfo>) {
    let Some(file) = file else { return };
    parts.up = Some(file.up);
    parts.info.push(("up".to_owned(), ["x", "y", "z"][file.up.idx()].to_owned()));
    if file.unit == LengthUnit::Metre {
        parts.info.push(("unit".to_owned(), "metre".to_owned()));
    }
    // Whoever checks the table reads the scene likewise.
    let SceneReadOptions { opaque, see_through, still, backs, scene } = &file.read_with;
    if *backs != BackFaces::default() {
        parts.info.push(("backs".to_owned(), backs.name().to_owned()));
    }
    parts.info.extend(scene.iter().map(|scene| ("scene".to_owned(), scene.clone())));
    for (key, patterns) in [("opaque", opaque), ("see-through", see_through), ("still", still)] {
        if !patterns.is_empty() {
            let lines: Vec<String> = patterns.iter().map(ToString::to_string).collect();
            parts.info.push((key.to_owned(), lines.join("\n")));
        }
    }
    parts.info.sort();
}

/// The record of a box.
pub(crate) fn box_record(b: &Aabb<3>) -> CellRecord {
    CellRecord { min: b.min, max: b.max, group: None, polygon: Vec::new() }
}

/// The record of an object by its box; one without triangles is at the origin.
pub(crate) fn object_record(name: &str, b: &Aabb<3>) -> ObjectRecord {
    let b = if b.is_empty() { Aabb { min: [0.0; 3], max: [0.0; 3] } } else { *b };
    ObjectRecord { name: name.to_owned(), min: b.min, max: b.max }
}

/// The corners counter-clockwise as seen from the first cell: the normal by the right-hand rule points
/// towards the viewer.
pub(crate) fn axial_portal_record(portal: &Portal<Axial>) -> PortalRecord {
    let AxialDoor { extent: Aabb { min, max }, axis, forward } = portal.shape;
    let a = usize::from(axis);
    let (b, c) = ((a + 1) % 3, (a + 2) % 3);
    let corner = |high_b: bool, high_c: bool| {
        let mut p = min;
        p[b] = if high_b { max[b] } else { min[b] };
        p[c] = if high_c { max[c] } else { min[c] };
        p
    };
    // By the right-hand rule, the turn from b to c gives the axis; a crossing forwards begins on its low side.
    let mut points = vec![corner(false, false), corner(false, true), corner(true, true), corner(true, false)];
    if !forward {
        points.reverse();
    }
    PortalRecord { cells: portal.cells, sides: portal.sides, points }
}
