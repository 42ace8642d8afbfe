//! The JSON export, a contract with other programs: its keys and their order do not change within a
//! version.

use crate::outline::corners;
use serde::Serialize;
use serde::ser::{SerializeSeq, Serializer};
use sightlines_pvs::{CellId, CellRecord, ObjectRecord, PortalRecord, Table};
use std::io;

/// Version of the export; a new one if a key changes its meaning or goes.
const VERSION: u32 = 1;
/// Version of the export of a table with a frame: whoever does not read `frame` would take its points for those of the scene.
const VERSION_WITH_FRAME: u32 = 2;

/// A table as JSON text, in one line; see [`write_json`].
///
/// Needs memory for the text: up to some bytes for each pair of cells that see each other.
pub fn export_json(table: &Table) -> String {
    serde_json::to_string(&Export::of(table)).expect("a table has no map keys or numbers that JSON lacks")
}

/// Writes a table as JSON:
///
/// ```json
/// {"format":"sightlines-export","version":1,"dimension":2,
///  "cells":[{"id":0,"min":[0.0,0.0],"max":[4.0,3.0],"polygon":[[0.0,0.0],[4.0,0.0],[4.0,3.0],[0.0,3.0]],"group":7}],
///  "portals":[{"id":0,"cells":[0,1],"points":[[4.0,2.0],[4.0,1.0]]}],
///  "visible":[[0,1],[0,1]],
///  "objects":[{"id":0,"name":"desk","min":[1.0,1.0],"max":[2.0,2.0]}],
///  "cell_objects":[[0],[0]]}
/// ```
///
/// Ids are dense from 0 and equal to the place in their list. Points have `dimension` coordinates, in
/// scene units, in the shortest form that reads back as the same number. If the cells of the table have names, each
/// cell has another key behind `id`, `"name"`, as objects have; else none has it. `polygon`: the corners of a
/// planar cell, counter-clockwise (the corners of its box if it has no others); empty in space.
/// `group`: a sector or the like, or null. `points`: the left end, then the right end, as seen from the
/// first of the two cells; a polygon in space. A table with a frame has another key behind `dimension`, `"frame"`, with its three
/// `axes` as unit vectors of the scene and its `gap`: all points are along these axes, so its `version` is 2. `visible`: for each cell the ids that it may see,
/// ascending, itself included. `cell_objects`: for each cell the objects that it may see,
/// ascending.
///
/// # Errors
/// What `writer` says.
pub fn write_json(table: &Table, writer: impl io::Write) -> io::Result<()> {
    serde_json::to_writer(writer, &Export::of(table)).map_err(io::Error::from)
}

#[derive(Serialize)]
struct Export<'a> {
    format: &'static str,
    version: u32,
    dimension: u8,
    #[serde(skip_serializing_if = "Option::is_none")]
    frame: Option<FrameExport>,
    #[serde(serialize_with = "cells")]
    cells: &'a Table,
    #[serde(serialize_with = "portals")]
    portals: &'a Table,
    #[serde(serialize_with = "visible")]
    visible: &'a Table,
    #[serde(serialize_with = "objects")]
    objects: &'a Table,
    #[serde(serialize_with = "cell_objects")]
    cell_objects: &'a Table,
}

impl<'a> Export<'a> {
    fn of(table: &'a Table) -> Self {
        Self {
            format: "sightlines-export",
            version: if table.frame().is_some() { VERSION_WITH_FRAME } else { VERSION },
            dimension: table.dimension(),
            frame: table.frame().map(|frame| FrameExport { axes: frame.axes(), gap: frame.gap() }),
            cells: table,
            portals: table,
            visible: table,
            objects: table,
            cell_objects: table,
        }
    }
}

#[derive(Serialize)]
struct FrameExport {
    axes: [[f64; 3]; 3],
    gap: f64,
}

#[derive(Serialize)]
struct Cell<'a> {
    id: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    name: Option<&'a str>,
    min: &'a [f64],
    max: &'a [f64],
    polygon: Vec<[f64; 2]>,
    group: Option<u32>,
}

#[derive(Serialize)]
struct Portal<'a> {
    id: usize,
    cells: [u32; 2],
    points: Vec<&'a [f64]>,
}

#[derive(Serialize)]
struct Object<'a> {
    id: usize,
    name: &'a str,
    min: &'a [f64],
    max: &'a [f64],
}

fn cells<S: Serializer>(table: &Table, out: S) -> Result<S::Ok, S::Error> {
    let d = usize::from(table.dimension());
    out.collect_seq(table.cells().iter().enumerate().map(|(id, cell): (usize, &CellRecord)| {
        let polygon = if d == 2 { corners(cell).iter().map(|p| [p.x, p.y]).collect() } else { Vec::new() };
        let name = table.cell_name(CellId(id as u32));
        Cell { id, name, min: &cell.min[..d], max: &cell.max[..d], polygon, group: cell.group }
    }))
}

fn portals<S: Serializer>(table: &Table, out: S) -> Result<S::Ok, S::Error> {
    let d = usize::from(table.dimension());
    out.collect_seq(table.portals().iter().enumerate().map(|(id, portal): (usize, &PortalRecord)| Portal {
        id,
        cells: portal.cells.map(|cell| cell.0),
        points: portal.points.iter().map(|point| &point[..d]).collect(),
    }))
}

fn visible<S: Serializer>(table: &Table, out: S) -> Result<S::Ok, S::Error> {
    let mut rows = out.serialize_seq(Some(table.n_cells()))?;
    for cell in (0u32..).take(table.n_cells()).map(CellId) {
        rows.serialize_element(&table.visible(cell).map(|seen| seen.0).collect::<Vec<_>>())?;
    }
    rows.end()
}

fn objects<S: Serializer>(table: &Table, out: S) -> Result<S::Ok, S::Error> {
    let d = usize::from(table.dimension());
    out.collect_seq(table.objects().iter().enumerate().map(|(id, object): (usize, &ObjectRecord)| Object {
        id,
        name: &object.name,
        min: &object.min[..d],
        max: &object.max[..d],
    }))
}

fn cell_objects<S: Serializer>(table: &Table, out: S) -> Result<S::Ok, S::Error> {
    let objects = |cell| table.visible_objects(CellId(cell)).into_iter().map(|object| object.0).collect::<Vec<u32>>();
    out.collect_seq((0u32..).take(table.n_cells()).map(objects))
}
