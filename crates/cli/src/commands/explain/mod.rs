//! `explain`: the line of sight between two cells of a plan, or why there is none.

mod answer;
mod line;

use crate::Answer;
use crate::commands::draw::{PictureKind, draw_plan, save_picture};
use crate::error::CliError;
use crate::place::Place;
use crate::{input, output};
use answer::{Outside, Told};
use sightlines::cells::{CellGraph, Planar};
use sightlines::pvs::{CellId, Table};
use sightlines::report::{DrawOptions, View};
use sightlines::stabtree::{Explanation, explain};
use std::path::PathBuf;

/// Arguments of `explain`.
#[derive(Debug, clap::Args)]
pub(crate) struct ExplainArgs {
    /// The table
    #[arg(value_name = "FILE.pvs")]
    table: PathBuf,
    /// The viewer: a cell's id, or a point X,Y
    #[arg(value_name = "A", allow_hyphen_values = true)]
    from: Place,
    /// What is looked for: a cell's id, or a point X,Y; exit code 1 if it is hidden
    #[arg(value_name = "B", allow_hyphen_values = true)]
    to: Place,
    /// Draw the line, or what blocks it
    #[arg(long, value_name = "OUT.svg|OUT.png")]
    draw: Option<PathBuf>,
    /// If hidden: how many of the blocked ways to show
    #[arg(long, value_name = "N", default_value_t = 3)]
    proofs: usize,
    /// Give up after so many cells on the way
    #[arg(long, value_name = "N", default_value_t = 20_000_000)]
    max_visits: u64,
    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(args: &ExplainArgs) -> Result<Answer, CliError> {
    if let Some(out) = &args.draw {
        PictureKind::of(out)?;
        output::refuse_same(&args.table, out)?;
    }
    let table = input::table(&args.table)?;
    if table.dimension() != 2 {
        return Err(CliError::ExplainSpace(args.table.clone()));
    }
    let from = args.from.cells(&table, &args.table)?;
    let to = args.to.cells(&table, &args.table)?;
    for (place, cells) in [(&args.from, &from), (&args.to, &to)] {
        if cells.is_empty() {
            output::print(args.json, &Outside::new(place))?;
            return Ok(Answer::No);
        }
    }
    let graph = input::graph(&table, &args.table)?;
    let (a, b) = choose(&table, &from, &to);
    let explanation = explain(&graph, a, b, args.proofs, args.max_visits);
    let told = Told::new(&graph, [a, b], &explanation, table.sees(a, b));
    if let Some(out) = &args.draw {
        let svg = draw_plan(&args.table, &table, &options(&graph, [a, b], &explanation))?;
        save_picture(&svg, out)?;
    }
    output::print(args.json, &told)?;
    Ok(if told.is_visible() { Answer::Yes } else { Answer::No })
}

/// One cell of each place, which see each other if any do: a point on a border is in several cells.
fn choose(table: &Table, from: &[CellId], to: &[CellId]) -> (CellId, CellId) {
    let pairs = || from.iter().flat_map(|&a| to.iter().map(move |&b| (a, b)));
    let same = pairs().find(|(a, b)| a == b);
    same.or_else(|| pairs().find(|&(a, b)| table.sees(a, b))).unwrap_or((from[0], to[0]))
}

/// The picture of an explanation: what A sees, B, the line through the portals or the first blocked way.
fn options(graph: &CellGraph<Planar>, [a, b]: [CellId; 2], explanation: &Explanation) -> DrawOptions {
    let mut options = DrawOptions { view: View::Cell(a), target: Some(b), ..DrawOptions::default() };
    match explanation {
        Explanation::Visible { portals, doors, witness } => {
            options.marked_portals = portals.iter().map(|p| p.idx()).collect();
            options.line = line::between(&graph.cell(a).polygon, &graph.cell(b).polygon, doors, witness);
        }
        Explanation::Hidden { blocked, .. } => {
            let first = blocked.first().map_or(&[][..], |way| &way.portals);
            options.marked_portals = first.iter().map(|p| p.idx()).collect();
        }
        _ => {}
    }
    options
}
