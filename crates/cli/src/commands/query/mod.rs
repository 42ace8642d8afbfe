//! `query`: what may be seen from a point.

pub(crate) mod sight;

use crate::command::{Done, Verbosity};
use crate::error::{ErrorAbout, Result};
use crate::output::{JsonSchema, Serialize, count};
use crate::place::Point;
use crate::tables::{self, CACHE, Cells, Opened};
use crate::view::lifted;
use sight::ViewerArgs;
use sightlines::pvs::{CellId, ObjectId, PlaceBuffer};
use sightlines::report::ObjectPlace;
use std::collections::BTreeSet;
use std::fmt;
use std::ops::Range;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub(crate) struct QueryArgs {
    /// The table, plain or packed
    #[arg(value_name = "FILE")]
    table: PathBuf,
    /// The eye, in scene units; exit code 1 outside every cell, where everything may be visible
    #[arg(long, help_heading = "Viewer", value_name = "X,Y[,Z]", allow_hyphen_values = true)]
    eye: Point,
    #[command(flatten)]
    sight: ViewerArgs,
    /// Print the result as JSON; `cell` is null outside every cell
    #[arg(long, help_heading = "Output")]
    json: bool,
}

pub(crate) fn run(args: &QueryArgs, _: Verbosity) -> Result<Done> {
    match tables::open(&args.table, CACHE)? {
        Opened::Plain(cells) => ask(&cells, args),
        Opened::Packed(cells) => ask(&cells, args),
    }
}

fn ask<C: Cells>(cells: &C, args: &QueryArgs) -> Result<Done> {
    let path = &args.table;
    cells.refuse_without_places(path)?;
    let eye = args.eye.coordinates(cells.n_dimensions(), path)?;
    let mut buffer = PlaceBuffer::new();
    let place = cells.cells_at(lifted(eye), &mut buffer).in_file(path)?;
    // Outside, the answer says so and names no cells.
    let at = place.inside().unwrap_or_default();
    let done = if args.sight.is_given() {
        Done::new(args.json, sight::look(cells, path, eye, at, &args.sight)?)
    } else {
        Done::new(args.json, rows(cells, eye, at).in_file(path)?)
    };
    Ok(done.answering_whether(!at.is_empty()))
}

/// What the table lists for the cells at a point.
fn rows<C: Cells>(cells: &C, eye: &[f64], at: &[CellId]) -> Result<Found> {
    let (mut visible, mut objects) = (BTreeSet::new(), BTreeSet::new());
    let (mut some_cells, mut some_objects) = (Vec::new(), Vec::new());
    for &cell in at {
        cells.visible(cell, &mut some_cells)?;
        cells.objects_seen(cell, &mut some_objects)?;
        visible.extend(some_cells.iter().map(|cell| cell.0));
        objects.extend(some_objects.iter().copied());
    }
    Ok(Found {
        place: Place::new(cells, eye, at)?,
        visible: visible.into_iter().collect(),
        objects: named(cells, objects, at)?,
        all: cells.counts(),
    })
}

/// Objects with their names, and with what is seen of them from cells.
fn named<C: Cells>(cells: &C, objects: impl IntoIterator<Item = ObjectId>, at: &[CellId]) -> Result<Vec<Object>> {
    let mut seen = Vec::new();
    for &cell in at {
        seen.extend(cells.visible_ranges(cell)?.into_iter().filter_map(|(object, range)| Some((object, range?))));
    }
    seen.sort_unstable_by_key(|(object, range)| (*object, range.start));
    let object = |id: ObjectId| {
        let source = cells.source_of(id)?.map(ObjectPlace::from);
        let mut triangles: Vec<[u32; 2]> = Vec::new();
        let first = seen.partition_point(|(object, _)| *object < id);
        for (_, Range { start, end }) in seen[first..].iter().take_while(|(object, _)| *object == id) {
            match triangles.last_mut().filter(|last| *start <= last[1]) {
                Some(last) => last[1] = last[1].max(*end),
                None => triangles.push([*start, *end]),
            }
        }
        Ok(Object { id: id.0, name: cells.object_name(id)?, source, triangles })
    };
    objects.into_iter().map(object).collect()
}

/// Where the viewer is.
#[derive(Debug, Serialize, JsonSchema)]
struct Place {
    /// The eye.
    eye: Vec<f64>,
    /// The first of `cells`; null outside every cell.
    cell: Option<u32>,
    /// The cells that contain the eye: several on a border, none outside, where everything may be visible.
    cells: Vec<u32>,
    /// Their names, if the cells have names and the eye is in one.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    cell_names: Vec<String>,
}

impl Place {
    fn new<C: Cells>(table: &C, eye: &[f64], at: &[CellId]) -> Result<Self> {
        let cells: Vec<u32> = at.iter().map(|cell| cell.0).collect();
        // Either all cells of a table have names or none has.
        let names: Option<Vec<String>> = at.iter().map(|&cell| table.cell_name(cell)).collect::<Result<_, _>>()?;
        Ok(Self { eye: eye.to_vec(), cell: cells.first().copied(), cells, cell_names: names.unwrap_or_default() })
    }

    /// The cells by their numbers, each with its name if it has one.
    fn named_cells(&self) -> String {
        let cell = |(k, id): (usize, &u32)| match self.cell_names.get(k) {
            // As a Rust string: a name may hold anything, and the place should stay one line.
            Some(name) => format!("{id} ({name:?})"),
            None => id.to_string(),
        };
        self.cells.iter().enumerate().map(cell).collect::<Vec<_>>().join(" ")
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let eye: Vec<String> = self.eye.iter().map(f64::to_string).collect();
        let eye = eye.join(", ");
        match self.cells[..] {
            [] => write!(f, "the point ({eye}) is outside every cell"),
            [_] => write!(f, "the point ({eye}) is in cell {}", self.named_cells()),
            _ => write!(f, "the point ({eye}) is on the border of cells {}", self.named_cells()),
        }
    }
}

fn ids(ids: &[u32]) -> String {
    ids.iter().map(u32::to_string).collect::<Vec<_>>().join(" ")
}

#[derive(Debug, Serialize, JsonSchema)]
struct Object {
    /// Number of the object.
    id: u32,
    /// Name of the object.
    name: String,
    /// If it is known.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    source: Option<ObjectPlace>,
    /// If the object was cut into parts: what may be seen of it from these cells, as ranges of its triangles in the order of the file, the first
    /// and the one behind the last of each. Absent as well if no part of it is, though its box touches the cells.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    triangles: Vec<[u32; 2]>,
}

/// Without an option that describes the view. Exit code 1 outside every cell.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct Found {
    #[serde(flatten)]
    place: Place,
    /// Cells that may be visible from any place in `cells`; empty outside.
    visible: Vec<u32>,
    /// Objects that may be visible from there; empty outside.
    objects: Vec<Object>,
    /// Number of cells and of objects of the table.
    #[serde(skip)]
    all: [usize; 2],
}

impl fmt::Display for Found {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}", self.place)?;
        if self.place.cells.is_empty() {
            return Ok(());
        }
        write_seen(f, &self.visible, &self.objects, self.all)
    }
}

/// The lines that list cells and objects.
fn write_seen(
    f: &mut fmt::Formatter<'_>,
    visible: &[u32],
    objects: &[Object],
    [n_cells, n_objects]: [usize; 2],
) -> fmt::Result {
    writeln!(f, "sees {} of {}: {}", visible.len(), count(n_cells as u64, "cell"), ids(visible))?;
    if n_objects > 0 {
        let end = if objects.is_empty() { "" } else { ":" };
        writeln!(f, "sees {} of {}{end}", objects.len(), count(n_objects as u64, "object"))?;
    }
    objects.iter().try_for_each(|object| {
        write!(f, "  {:>5} {}", object.id, object.name)?;
        object.source.iter().try_for_each(|source| write!(f, ", {source}"))?;
        if !object.triangles.is_empty() {
            let ranges: Vec<String> = object.triangles.iter().map(|[start, end]| format!("{start}..{end}")).collect();
            write!(f, ", triangles {}", ranges.join(" "))?;
        }
        writeln!(f)
    })
}
