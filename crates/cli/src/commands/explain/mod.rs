//! `explain`: the line of sight between two cells, or why there is none.

mod picture;
pub(crate) mod report;
mod text;

use crate::command::{Answer, Done, JsonArg, Verbosity};
use crate::error::{ErrorAbout, Result, anyhow};
use crate::picture::{PictureKind, save_picture};
use crate::place::Place;
use crate::refuse::is_for;
use crate::surfaces::SurfaceArgs;
use crate::{input, output};
use report::{Outside, Report};
use sightlines::bake::GraphKind;
use sightlines::bake::explain::{ExplainOptions, Explainer, explain};
use sightlines::formats::InputKind;
use sightlines::formats::quake::{graph_of_prt, read_prt};
use sightlines::pvs::{CellId, Table, TableKind};
use std::path::PathBuf;

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
    #[command(flatten)]
    json: JsonArg,
}

pub(crate) fn run(args: &ExplainArgs, _: Verbosity) -> Result<Done> {
    if let Some(out) = &args.draw {
        PictureKind::of(out)?;
        output::check(&[&args.table], &[out])?;
    }
    if input::kind_of(&args.table)? == Some(InputKind::Prt) {
        args.refuse_meaningless(GraphKind::Convex, "a portal file")?;
        let graph = graph_of_prt(&read_prt(&args.table)?);
        let pair = args.clusters(graph.n_cells())?;
        let explainer = Explainer::new(&graph).expect("portals join clusters");
        let explanation = explainer.explain(pair, &args.options(GraphKind::Convex));
        return Ok(Report::new(None, pair, &explanation, args.proofs).done(args.json));
    }
    let table = input::table(&args.table)?;
    let kind = GraphKind::of(&table);
    args.refuse_meaningless(kind, in_words(&table))?;
    let has_numbers_only = kind == GraphKind::Convex && table.planes().is_none();
    let pair = if has_numbers_only { Ok(args.clusters(table.n_cells())?) } else { args.pair(&table)? };
    let pair = match pair {
        Ok(pair) => pair,
        Err(outside) => return Ok(Done::new(args.json, outside).answering(Answer::No)),
    };
    let read = |path: &PathBuf| input::scene(path, &SurfaceArgs::default().options_with(table.info()));
    let file = args.scene.as_ref().map(read).transpose()?;
    let explanation =
        explain(&table, file.as_ref().map(|file| &file.scene), pair, &args.options(kind)).in_file(&args.table)?;
    if table.frame().is_some() && (kind != GraphKind::Boxes || file.is_some()) {
        tracing::warn!("{}: places are along the axes of the table's frame", args.table.display());
    }
    if let Some(out) = &args.draw {
        save_picture(&picture::svg(&args.table, &table, pair, &explanation)?, out)?;
    }
    Ok(Report::new(Some(&table), pair, &explanation, args.proofs).done(args.json))
}

impl ExplainArgs {
    fn refuse_meaningless(&self, kind: GraphKind, found: &'static str) -> Result<()> {
        let given = [
            (
                self.draw.is_some() && kind != GraphKind::Axial,
                "--draw",
                GraphKind::Planar,
                "plans and scenes with portals",
            ),
            (self.max_visits.is_some(), "--max-visits", GraphKind::Planar, "plans"),
            (self.max_programs.is_some(), "--max-programs", GraphKind::Axial, "scenes in space"),
            (self.max_questions.is_some(), "--max-questions", GraphKind::Convex, "portal files"),
            (self.scene.is_some(), "--scene", GraphKind::Boxes, "cells without portals"),
        ];
        match given.into_iter().find(|&(is_given, _, meant, _)| is_given && meant != kind) {
            Some((_, option, _, meant)) => Err(is_for(&self.table, option, meant, found)),
            None => Ok(()),
        }
    }

    fn options(&self, kind: GraphKind) -> ExplainOptions {
        let default = ExplainOptions::default();
        ExplainOptions {
            max_visits: self.max_visits.unwrap_or(default.max_visits),
            max_programs: self.max_programs.unwrap_or(default.max_programs),
            max_questions: self.max_questions.unwrap_or(default.max_questions),
            n_rays: self.rays.unwrap_or(default.n_rays),
            // All are a proof for programs.
            max_blocked: if kind == GraphKind::Convex { usize::MAX } else { self.proofs },
            check: true,
        }
    }

    /// The cells of the query, unless a point is outside every cell.
    fn pair(&self, table: &Table) -> Result<Result<[CellId; 2], Outside>> {
        let from = self.from.cells(table, &self.table)?;
        let to = self.to.cells(table, &self.table)?;
        for (place, cells) in [(&self.from, &from), (&self.to, &to)] {
            if cells.is_empty() {
                return Ok(Err(Outside::new(place)));
            }
        }
        Ok(Ok(choose(table, &from, &to)))
    }

    /// The clusters of the query, by their numbers.
    fn clusters(&self, n_clusters: usize) -> Result<[CellId; 2]> {
        let cluster = |place: &Place| match *place {
            Place::Cell(id) if (id as usize) < n_clusters => Ok(CellId(id)),
            Place::Cell(cluster) => {
                Err(anyhow!("{}: there is no cluster {cluster}: there are {n_clusters}", self.table.display()))
            }
            Place::Point(_) => Err(anyhow!(
                "{}: a portal file does not say where its clusters are: name them by their numbers",
                self.table.display()
            )),
        };
        Ok([cluster(&self.from)?, cluster(&self.to)?])
    }
}

/// What a table is of, in the words of errors.
fn in_words(table: &Table) -> &'static str {
    match (table.kind(), GraphKind::of(table)) {
        (TableKind::QuakeMap, _) => "the table of a Quake map",
        (TableKind::QuakePortalFile, _) => "the table of a portal file",
        (_, GraphKind::Planar) => "the table of a plan",
        (_, GraphKind::Boxes) => "the table of cells without portals",
        (_, GraphKind::Axial | GraphKind::Convex) => "the table of a scene in space",
    }
}

/// One cell of each place, which see each other if any do: a point on a border is in several cells.
fn choose(table: &Table, from: &[CellId], to: &[CellId]) -> [CellId; 2] {
    let pairs = || from.iter().flat_map(|&a| to.iter().map(move |&b| [a, b]));
    let same = pairs().find(|[a, b]| a == b);
    same.or_else(|| pairs().find(|&[a, b]| table.sees(a, b))).unwrap_or([from[0], to[0]])
}
