//! `query`: what may be seen from a point.

use crate::Answer;
use crate::error::CliError;
use crate::input;
use crate::output::{self, count};
use crate::place::Point;
use serde::Serialize;
use std::fmt;
use std::path::PathBuf;

/// Arguments of `query`.
#[derive(Debug, clap::Args)]
pub(crate) struct QueryArgs {
    /// The table
    #[arg(value_name = "FILE.pvs")]
    table: PathBuf,
    /// Where the viewer is, in scene units; exit code 1 if that is outside every cell
    #[arg(long, value_name = "X,Y[,Z]", allow_hyphen_values = true)]
    eye: Point,
    /// Print the result as JSON; `cell` is null outside every cell
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(args: &QueryArgs) -> Result<Answer, CliError> {
    let table = input::table(&args.table)?;
    input::refuse_without_places(&table, &args.table, "no cell can be found at a point")?;
    let eye = args.eye.of(&table, &args.table)?;
    let cells: Vec<u32> = table.locate(eye).iter().map(|cell| cell.0).collect();
    let seen = table.visible_from(eye);
    let object = |id: u32| Object { id, name: table.objects()[id as usize].name.clone() };
    let found = Found {
        eye: eye.to_vec(),
        cell: cells.first().copied(),
        cells,
        visible: seen.iter().map(|cell| cell.0).collect(),
        objects: table.visible_objects_from(eye).into_iter().map(object).collect(),
        all: [table.n_cells(), table.objects().len()],
    };
    output::print(args.json, &found)?;
    Ok(if found.cell.is_some() { Answer::Yes } else { Answer::No })
}

/// What was found at a point.
#[derive(Debug, Serialize)]
struct Found {
    eye: Vec<f64>,
    /// The first of `cells`.
    cell: Option<u32>,
    /// All cells that contain the point: several on a border.
    cells: Vec<u32>,
    visible: Vec<u32>,
    objects: Vec<Object>,
    /// Number of cells and of objects of the table.
    #[serde(skip)]
    all: [usize; 2],
}

#[derive(Debug, Serialize)]
struct Object {
    id: u32,
    name: String,
}

impl fmt::Display for Found {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let eye: Vec<String> = self.eye.iter().map(f64::to_string).collect();
        let eye = eye.join(", ");
        let ids = |ids: &[u32]| ids.iter().map(u32::to_string).collect::<Vec<_>>().join(" ");
        match self.cells[..] {
            [] => return writeln!(f, "the point ({eye}) is outside every cell"),
            [cell] => writeln!(f, "the point ({eye}) is in cell {cell}")?,
            _ => writeln!(f, "the point ({eye}) is on the border of cells {}", ids(&self.cells))?,
        }
        let [n_cells, n_objects] = self.all;
        writeln!(f, "sees {} of {}: {}", self.visible.len(), count(n_cells as u64, "cell"), ids(&self.visible))?;
        if n_objects > 0 {
            let end = if self.objects.is_empty() { "" } else { ":" };
            writeln!(f, "sees {} of {}{end}", self.objects.len(), count(n_objects as u64, "object"))?;
        }
        self.objects.iter().try_for_each(|object| writeln!(f, "  {:>5} {}", object.id, object.name))
    }
}
