//! Baking a plan: subdivide, see, tabulate.

use crate::mirrors;
use crate::table::{TableOptions, table_of};
use sightlines_cells::{CellGraph, Plan, PlanError, Planar};
use sightlines_progress::{Cancelled, Observer};
use sightlines_pvs::{Table, TableError, TableKind, TableParts};
use sightlines_stabtree::{SearchOptions, Zones, plan_visibility};
use sightlines_triangulation::TriangulationError;
use std::fmt;
use std::str::FromStr;
use std::time::{Duration, Instant};

/// How a plan is cut into cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Subdivide {
    /// By the k-d tree if every line is parallel to an axis and no line names a group, else by
    /// triangulation.
    #[default]
    Auto,
    /// By a k-d tree along the walls. Walls that are not parallel to an axis do not block.
    KdTree,
    /// By a constrained triangulation.
    Triangulation,
}

impl fmt::Display for Subdivide {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Auto => "auto",
            Self::KdTree => "kd",
            Self::Triangulation => "triangulation",
        })
    }
}

/// Not the name of a subdivision.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("'{0}' is no subdivision: use auto, kd or triangulation")]
pub struct ParseSubdivideError(pub String);

impl FromStr for Subdivide {
    type Err = ParseSubdivideError;

    fn from_str(s: &str) -> Result<Self, Self::Err> {
        match s {
            "auto" => Ok(Self::Auto),
            "kd" => Ok(Self::KdTree),
            "triangulation" => Ok(Self::Triangulation),
            _ => Err(ParseSubdivideError(s.to_owned())),
        }
    }
}

/// How to bake.
#[derive(Clone, Copy)]
pub struct BakeOptions<'a> {
    /// How to cut.
    pub subdivide: Subdivide,
    /// For the k-d tree: the least share of a cell's cross-section that walls on a plane must cover for
    /// the plane to split the cell, 0 to 1. With 0 every wall blocks; above, walls that are left over
    /// do not.
    pub tau: f64,
    /// Number of threads; 0 for one for each core. Changes nothing but the time.
    pub threads: usize,
    /// Chords shot through each exit before the search. Changes nothing but the time.
    pub chords: u32,
    /// Called with the number of finished cells and their total.
    pub progress: Option<&'a dyn Observer>,
}

impl Default for BakeOptions<'_> {
    fn default() -> Self {
        let search = SearchOptions::default();
        let (threads, chords) = (search.threads, search.chords);
        Self { subdivide: Subdivide::Auto, tau: 0.0, threads, chords, progress: None }
    }
}

impl fmt::Debug for BakeOptions<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("BakeOptions")
            .field("subdivide", &self.subdivide)
            .field("tau", &self.tau)
            .field("threads", &self.threads)
            .field("chords", &self.chords)
            .finish_non_exhaustive()
    }
}

/// Why a plan could not be baked.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BakeError {
    /// The triangulation has nothing to cut.
    #[error(transparent)]
    Triangulation(#[from] TriangulationError),
    /// The k-d tree refused the plan or its options.
    #[error(transparent)]
    KdTree(#[from] sightlines_kdtree::KdError),
    /// The lines of a map do not make a plan.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// The observer cancelled the search.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// The parts of the table do not fit together: a defect of this crate.
    #[error("the table is inconsistent: {0}")]
    Table(#[from] TableError),
}

/// A table, and how it came about.
#[derive(Debug, Clone, PartialEq)]
pub struct Baked {
    /// The table.
    pub table: Table,
    /// What was done.
    pub summary: BakeSummary,
}

/// What baking did. Times and search counts vary from run to run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct BakeSummary {
    /// The subdivision that was used; never [`Subdivide::Auto`].
    pub subdivide: Subdivide,
    /// Cells.
    pub n_cells: usize,
    /// Portals.
    pub n_portals: usize,
    /// Unordered pairs of different cells that see each other.
    pub n_visible_pairs: u64,
    /// Walls that do not block because the k-d tree cannot follow them.
    pub n_ignored_walls: usize,
    /// Crossings whose point had to be rounded.
    pub n_rounded_crossings: usize,
    /// Pieces of walls that were given up, towards visible.
    pub n_dropped_pieces: usize,
    /// Cells in regions whose lines disagree about the group.
    pub n_disputed_cells: usize,
    /// Parts of mirrors on borders of cells.
    pub n_mirror_parts: usize,
    /// Mirrors of which a part is on no border of a cell, and does not reflect.
    pub n_lost_mirrors: usize,
    /// Time to cut the plan.
    pub cut_time: Duration,
    /// Time to compute the visibility.
    pub see_time: Duration,
    /// Portals pushed by the search.
    pub n_pushes: u64,
    /// Cells entered by the search.
    pub n_visits: u64,
}

/// Cuts a plan, decides which cells see which, and makes the table.
///
/// Exact for plans without rounded crossings (see the triangulation's notes on noding); errs towards
/// visible elsewhere.
///
/// # Errors
/// [`BakeError`] for plans without lines or without a region, and for a `tau` outside 0 to 1.
pub fn bake_plan(plan: &Plan, options: &BakeOptions<'_>) -> Result<Baked, BakeError> {
    let start = Instant::now();
    let (graph, mut summary) = cut(plan, options)?;
    summary.cut_time = start.elapsed();
    let search = SearchOptions { threads: options.threads, chords: options.chords, progress: options.progress };
    let start = Instant::now();
    let (rows, found) = plan_visibility(&graph, &Zones::cells(&graph), &search)?;
    summary.see_time = start.elapsed();
    summary.n_cells = graph.n_cells();
    summary.n_portals = graph.portals().len();
    summary.n_visible_pairs = (rows.count_ones() - graph.n_cells() as u64) / 2;
    (summary.n_pushes, summary.n_visits) = (found.n_pushes, found.n_visits);
    let kind = match summary.subdivide {
        Subdivide::KdTree => TableKind::PlanKdTree,
        Subdivide::Triangulation => TableKind::PlanTriangulation,
        Subdivide::Auto => unreachable!("a plan was cut by one of the two"),
    };
    let mut info = vec![("subdivide".to_owned(), summary.subdivide.to_string())];
    if summary.subdivide == Subdivide::KdTree {
        info.push(("tau".to_owned(), options.tau.to_string()));
    }
    let mut table = table_of(&graph, rows, TableOptions { objects: plan.objects(), kind, info })?;
    if !plan.mirrors().is_empty() {
        let mirrors = mirrors::of_plan(&graph, plan);
        (summary.n_mirror_parts, summary.n_lost_mirrors) = (mirrors.parts.len(), mirrors.n_lost);
        table = Table::new(TableParts { mirrors: mirrors.parts, ..table.into_parts() })?;
    }
    Ok(Baked { table, summary })
}

fn cut(plan: &Plan, options: &BakeOptions<'_>) -> Result<(CellGraph<Planar>, BakeSummary), BakeError> {
    if !(0.0..=1.0).contains(&options.tau) {
        return Err(sightlines_kdtree::KdError::Tau(options.tau).into());
    }
    let follows_axes = plan.is_axial() && plan.n_groups() == 0;
    let by_tree = match options.subdivide {
        Subdivide::Auto => follows_axes,
        Subdivide::KdTree => true,
        Subdivide::Triangulation => false,
    };
    if by_tree {
        let cut = sightlines_kdtree::subdivide_plan(
            plan,
            &sightlines_kdtree::Options { tau: options.tau, ..Default::default() },
        )?;
        let n_ignored_walls = cut.left_over.len();
        Ok((cut.graph, BakeSummary { subdivide: Subdivide::KdTree, n_ignored_walls, ..BakeSummary::default() }))
    } else {
        let (graph, did) = sightlines_triangulation::subdivide(plan)?;
        let summary = BakeSummary {
            subdivide: Subdivide::Triangulation,
            n_rounded_crossings: did.n_rounded_crossings,
            n_dropped_pieces: did.n_dropped_pieces,
            n_disputed_cells: did.n_disputed_cells,
            ..BakeSummary::default()
        };
        Ok((graph, summary))
    }
}
