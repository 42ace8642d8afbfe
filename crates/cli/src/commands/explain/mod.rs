//! `explain`: the line of sight between two cells, or why there is none.

mod boxes;
mod convex;
mod error;
mod plan;
mod report;
mod space;
mod space_picture;

use crate::Answer;
use crate::error::InputError;
use crate::picture::{PictureKind, draw_plan, save_picture};
use crate::place::Place;
use crate::surfaces::SurfaceArgs;
use crate::{input, output};
use boxes::BoxReason;
use convex::ClusterQuery;
use error::Error;
use plan::PlanReason;
use report::{ExplanationReport, Outside};
use sightlines::bake::from_table::{axial_graph, convex_graph};
use sightlines::bake::lines::ends_in_plan;
use sightlines::cells::{CellGraph, Convex, Planar};
use sightlines::formats::InputKind;
use sightlines::formats::quake::{graph_of_prt, read_prt};
use sightlines::pvs::{CellId, Table, TableKind};
use sightlines::report::{DrawOptions, View};
use sightlines::sightline::Verdict;
use sightlines::stabtree::{Barrier, MOST_EXPLAINED, PlanarExplanation, Sight, explain, explain_axial};
use space::SpaceReason;
use std::path::PathBuf;

/// Cells entered on the way in a plan before the search is given up.
const MAX_VISITS: u64 = 20_000_000;

/// Linear programs in space before it is given up.
const MAX_PROGRAMS: u32 = 20_000;

/// Arguments of `explain`.
#[derive(Debug, clap::Args)]
pub(crate) struct ExplainArgs {
    /// The table, or the portal file of a Quake map
    #[arg(value_name = "FILE.pvs|MAP.prt")]
    table: PathBuf,
    /// The viewer: a cell id, a point X,Y[,Z], or the number of a cluster in a portal file
    #[arg(value_name = "A", allow_hyphen_values = true)]
    from: Place,
    /// The target, given like the viewer; exit code 1 if it is hidden
    #[arg(value_name = "B", allow_hyphen_values = true)]
    to: Place,
    /// Plans: stop after entering this many cells [default: 20000000]
    #[arg(long, help_heading = "Method", value_name = "N")]
    max_visits: Option<u64>,
    /// Scenes in space: stop after this many linear programs [default: 20000]
    #[arg(long, help_heading = "Method", value_name = "N")]
    max_programs: Option<u32>,
    /// Portal files: stop after testing this many sequences of portals [default: 100000]
    #[arg(long, help_heading = "Method", value_name = "N")]
    max_questions: Option<u64>,
    /// Cells without portals, such as those that were given or cut where views differ: the scene that the table was made of, to look for a line
    /// between them
    #[arg(long, help_heading = "Method", value_name = "SCENE")]
    scene: Option<PathBuf>,
    /// With --scene: rays to aim from each cell at the other [default: 4096]
    #[arg(long, help_heading = "Method", value_name = "N", requires = "scene")]
    rays: Option<u32>,
    /// Plans and scenes with portals: draw the line, or what blocks it; in space from above and as an isometric view
    #[arg(long, help_heading = "Output", value_name = "OUT.svg|OUT.png")]
    draw: Option<PathBuf>,
    /// If hidden: how many blocked ways, sequences or walls to show
    #[arg(long, help_heading = "Output", value_name = "N", default_value_t = 3)]
    proofs: usize,
    /// Print the result as JSON
    #[arg(long, help_heading = "Output")]
    json: bool,
}

pub(crate) fn run(args: &ExplainArgs) -> Result<Answer, Error> {
    if let Some(out) = &args.draw {
        PictureKind::of(out)?;
        output::check(&[&args.table], &[out])?;
    }
    if input::kind_of(&args.table)? == Some(InputKind::Prt) {
        args.refuse_meaningless(Of::Portals, "a portal file")?;
        let graph = graph_of_prt(&read_prt(&args.table)?);
        return args.query(&graph).answer(|_, _| None);
    }
    let table = input::table(&args.table)?;
    let (of, found) = Of::table(&table);
    args.refuse_meaningless(of, found)?;
    match of {
        Of::Plan => args.pair(&table)?.map_or(Ok(Answer::No), |pair| in_plan(args, &table, pair)),
        Of::Space => args.pair(&table)?.map_or(Ok(Answer::No), |pair| in_space(args, &table, pair)),
        Of::Boxes => args.pair(&table)?.map_or(Ok(Answer::No), |pair| in_boxes(args, &table, pair)),
        Of::Portals => in_clusters(args, &table),
    }
}

impl ExplainArgs {
    /// Refuses options that mean nothing for such a file.
    fn refuse_meaningless(&self, of: Of, found: &'static str) -> Result<(), Error> {
        let given = [
            (self.draw.is_some() && of != Of::Space, "--draw", Of::Plan, "plans and scenes with portals"),
            (self.max_visits.is_some(), "--max-visits", Of::Plan, "plans"),
            (self.max_programs.is_some(), "--max-programs", Of::Space, "scenes in space"),
            (self.max_questions.is_some(), "--max-questions", Of::Portals, "portal files"),
            (self.scene.is_some(), "--scene", Of::Boxes, "cells without portals"),
        ];
        match given.into_iter().find(|&(is_given, _, meant, _)| is_given && meant != of) {
            Some((_, option, _, meant)) => {
                Err(InputError::Option { path: self.table.clone(), option: option.to_owned(), meant, found }.into())
            }
            None => Ok(()),
        }
    }

    /// The cells of the query; none, with a message, if a point is outside every cell.
    fn pair(&self, table: &Table) -> Result<Option<(CellId, CellId)>, Error> {
        let from = self.from.cells(table, &self.table)?;
        let to = self.to.cells(table, &self.table)?;
        for (place, cells) in [(&self.from, &from), (&self.to, &to)] {
            if cells.is_empty() {
                output::print(self.json, &Outside::new(place))?;
                return Ok(None);
            }
        }
        Ok(Some(choose(table, &from, &to)))
    }

    /// The report on two cells of a table.
    fn report<R>(&self, table: &Table, [a, b]: [CellId; 2], reason: R) -> ExplanationReport<R> {
        let listed = Some(table.sees(a, b));
        let has_regions = matches!(table.kind(), TableKind::SceneKdTree { hidden_by } if hidden_by.from_region);
        ExplanationReport { from: a.0, to: b.0, listed, has_regions, checked: None, reason, n_shown: self.proofs }
    }

    fn query<'a>(&'a self, graph: &'a CellGraph<Convex>) -> ClusterQuery<'a> {
        ClusterQuery {
            path: &self.table,
            graph,
            places: [&self.from, &self.to],
            limit: self.max_questions.unwrap_or(MOST_EXPLAINED),
            n_shown: self.proofs,
            json: self.json,
        }
    }
}

/// The kind of a file, which decides the engine.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Of {
    Plan,
    Space,
    /// Cells of a scene in space without portals.
    Boxes,
    Portals,
}

impl Of {
    /// By the kind of a table; by its dimension if that is not stated. With the words that errors have for it.
    fn table(table: &Table) -> (Self, &'static str) {
        match table.kind() {
            TableKind::QuakeMap => (Self::Portals, "the table of a Quake map"),
            TableKind::QuakePortalFile => (Self::Portals, "the table of a portal file"),
            TableKind::PlanKdTree | TableKind::PlanTriangulation => (Self::Plan, "the table of a plan"),
            TableKind::SceneKdTree { .. } => (Self::Space, "the table of a scene in space"),
            TableKind::SceneGivenCells { .. } => (Self::Boxes, "the table of cells without portals"),
            _ if table.dimension() == 2 => (Self::Plan, "the table of a plan"),
            _ => (Self::Space, "the table of a scene in space"),
        }
    }
}

fn in_clusters(args: &ExplainArgs, table: &Table) -> Result<Answer, Error> {
    let graph = convex_graph(table).ok_or_else(|| InputError::Stripped(args.table.clone()))?;
    let listed = |a, b| Some(table.sees(a, b));
    if table.planes().is_none() {
        return args.query(&graph).answer(listed);
    }
    let Some((a, b)) = args.pair(table)? else { return Ok(Answer::No) };
    let [from, to] = [a, b].map(|cell| Place::Cell(cell.0));
    ClusterQuery { places: [&from, &to], ..args.query(&graph) }.answer(listed)
}

fn in_space(args: &ExplainArgs, table: &Table, (a, b): (CellId, CellId)) -> Result<Answer, Error> {
    let graph = axial_graph(table).ok_or_else(|| InputError::Stripped(args.table.clone()))?;
    if table.frame().is_some() {
        tracing::warn!("{}: places are along the axes of the table's frame", args.table.display());
    }
    // The table does not record what was left out beside its cells, and no answer depends on it.
    let explanation = explain_axial(&graph, &[], a, b, args.max_programs.unwrap_or(MAX_PROGRAMS));
    let reason = SpaceReason::new(explanation);
    if let Some(out) = &args.draw {
        save_picture(&space_picture::svg(&args.table, table, [a, b], &reason)?, out)?;
    }
    Ok(args.report(table, [a, b], reason).print(args.json)?)
}

/// Rays from each of two cells without portals.
const N_RAYS: u32 = 4096;

fn in_boxes(args: &ExplainArgs, table: &Table, (a, b): (CellId, CellId)) -> Result<Answer, Error> {
    let read = |path: &PathBuf| input::scene(path, &SurfaceArgs::default().options_with(table.info()));
    let file = args.scene.as_ref().map(read).transpose()?;
    if table.frame().is_some() && file.is_some() {
        tracing::warn!("{}: places are along the axes of the table's frame", args.table.display());
    }
    let scene = file.as_ref().map(|file| &file.scene);
    let reason = BoxReason::find(table, scene, [a, b], args.rays.unwrap_or(N_RAYS));
    let failed = |source| Error::OtherScene { table: args.table.clone(), source };
    Ok(args.report(table, [a, b], reason.map_err(failed)?).print(args.json)?)
}

fn in_plan(args: &ExplainArgs, table: &Table, (a, b): (CellId, CellId)) -> Result<Answer, Error> {
    let graph = input::graph(table, &args.table)?;
    let explanation = explain(&graph, a, b, args.proofs, args.max_visits.unwrap_or(MAX_VISITS));
    if let Some(out) = &args.draw {
        let svg = draw_plan(&args.table, table, &options(&graph, [a, b], &explanation))?;
        save_picture(&svg, out)?;
    }
    Ok(args.report(table, [a, b], PlanReason::new(&graph, a, &explanation)).print(args.json)?)
}

/// One cell of each place, which see each other if any do: a point on a border is in several cells.
fn choose(table: &Table, from: &[CellId], to: &[CellId]) -> (CellId, CellId) {
    let pairs = || from.iter().flat_map(|&a| to.iter().map(move |&b| (a, b)));
    let same = pairs().find(|(a, b)| a == b);
    same.or_else(|| pairs().find(|&(a, b)| table.sees(a, b))).unwrap_or((from[0], to[0]))
}

/// The picture of an explanation: what A sees, B, the line through the portals or the first blocked way.
fn options(graph: &CellGraph<Planar>, [a, b]: [CellId; 2], explanation: &PlanarExplanation) -> DrawOptions<'static> {
    let mut options = DrawOptions { view: View::Cell(a), target: Some(b), ..DrawOptions::default() };
    match explanation {
        Verdict::Visible(Sight::Along(path)) => {
            options.marked_portals = path.portals.iter().map(|p| p.idx()).collect();
            options.line = ends_in_plan([&graph.cell(a).polygon, &graph.cell(b).polygon], &path.doors, &path.witness);
        }
        Verdict::Hidden(Barrier::Blocked(proof)) => {
            let first = proof.blocked.first().map_or(&[][..], |way| &way.portals);
            options.marked_portals = first.iter().map(|p| p.idx()).collect();
        }
        _ => {}
    }
    options
}
