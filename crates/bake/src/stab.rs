//! Stab trees for a table, from its graph.

use crate::baked::Baked;
use crate::graph::{GraphRef, OtherGraph, TableGraph};
use crate::stopwatch::Stopwatch;
use sightlines_progress::{Cancelled, Halt, Observer, Units};
use sightlines_pvs::{BitMatrix, StabError, StabParts, StabTrees, Table, TableError};
use sightlines_sightline::StabLimits;
use sightlines_stabtree::{StabTreesOptions, StabTreesSummary, stab_trees_axial, stab_trees_convex, stab_trees_planar};
use std::fmt;
use std::time::Duration;

/// How to add stab trees to a table.
#[derive(Clone, Copy, Default)]
pub struct StabOptions<'a> {
    /// The most nodes of the tree of one cell, before equal ones are merged; a larger tree is cut, the nearest
    /// sequences stay, and what may go on is marked. `None`: [`GraphRef::most_nodes`].
    pub max_nodes: Option<usize>,
    /// Number of threads; 0 for one for each core. Changes nothing but the time.
    pub threads: usize,
    /// Receives reports, and may cancel.
    pub progress: Option<&'a dyn Observer>,
    /// Where the trees of cells are kept as results of units of work. Changes nothing but who computes what.
    pub units: Units<'a>,
}

impl fmt::Debug for StabOptions<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut out = f.debug_struct("StabOptions");
        out.field("max_nodes", &self.max_nodes).field("threads", &self.threads).finish_non_exhaustive()
    }
}

/// Why a table cannot have stab trees.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StabBakeError {
    /// There are no portals: the cells are boxes that were given, or the portals were stripped.
    #[error("stab trees need the cells and portals that the table was made from, and it does not have them")]
    NoGraph,
    /// The graph of another table.
    #[error(transparent)]
    OtherGraph(#[from] OtherGraph),
    /// The observer cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// The store of units ends the bake: it keeps what was done, and the rest is for others or later.
    #[error(transparent)]
    Halted(Halt),
    /// The trees do not fit the table: a defect of this crate.
    #[error("the stab trees are inconsistent: {0}")]
    Stab(#[from] StabError),
    /// The table with trees is invalid: a defect of this crate.
    #[error("the table is inconsistent: {0}")]
    Table(#[from] TableError),
}

impl From<Halt> for StabBakeError {
    fn from(halt: Halt) -> Self {
        match halt {
            Halt::Cancelled(cancelled) => cancelled.into(),
            halt => Self::Halted(halt),
        }
    }
}

/// A table with stab trees, and a report on them.
#[derive(Debug, Clone, PartialEq)]
pub struct BakedStab {
    /// The table.
    pub table: Table,
    /// What was added.
    pub report: StabReport,
}

/// A report on stab trees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StabReport {
    /// The most nodes that a tree was allowed.
    pub max_nodes: usize,
    /// The trees in numbers, before equal ones are merged.
    pub trees: StabTreesSummary,
    /// Time to find them.
    pub time: Duration,
}

impl GraphRef<'_> {
    /// How many nodes the stab tree of a cell may have by default: 65,536 in the plane, 16,384 for boxes, 4,096 for convex
    /// cells; `None` for boxes without portals.
    ///
    /// A sequence takes some hundred nanoseconds in the plane, ten times as long for boxes, a hundred times for polygons. Of
    /// the scenes that were measured (the bench `stab_trees`), the limits cut no tree of a plan, up to an eighth of those of
    /// boxes, and up to half of those of a Quake map; a lower limit saves time, but fewer bytes than sequences, as trees that
    /// are cut are seldom equal.
    pub const fn most_nodes(self) -> Option<usize> {
        match self {
            Self::Planar(_) => Some(65_536),
            Self::Axial(_) => Some(16_384),
            Self::Convex(_) => Some(4_096),
            Self::Boxes(_) => None,
        }
    }

    fn trees(
        self,
        rows: &BitMatrix,
        options: &StabTreesOptions<'_>,
    ) -> Result<(StabParts, StabTreesSummary), StabBakeError> {
        match self {
            Self::Planar(graph) => Ok(stab_trees_planar(graph, rows, options)?),
            Self::Axial(graph) => Ok(stab_trees_axial(graph, rows, options)?),
            Self::Convex(graph) => Ok(stab_trees_convex(graph, rows, StabLimits::default(), options)?),
            Self::Boxes(_) => Err(StabBakeError::NoGraph),
        }
    }
}

/// Adds the stab trees of all cells to a table, or replaces those that it has. Everything else stays.
///
/// * `graph`: the one that the table was made from: [`Baked::graph`], or
///   [`from_table::graph`](fn@crate::from_table::graph) of a table from a file
///
/// Conservative for every limit; see [`sightlines_stabtree::stab_trees`] for what that means, and for the cost. Mirrors
/// are ignored.
///
/// # Errors
/// [`StabBakeError::NoGraph`] for boxes without portals, [`StabBakeError::OtherGraph`] for the graph of another table.
pub fn with_stab_trees<'g>(
    table: Table,
    graph: impl Into<GraphRef<'g>>,
    options: &StabOptions<'_>,
) -> Result<BakedStab, StabBakeError> {
    let start = Stopwatch::start();
    let graph = graph.into();
    let max_nodes = options.max_nodes.or(graph.most_nodes()).ok_or(StabBakeError::NoGraph)?;
    graph.check_size(&table)?;
    let StabOptions { threads, progress, units, .. } = *options;
    let how = StabTreesOptions { max_nodes, threads, progress, units };
    let mut parts = table.into_parts();
    let (trees, summary) = graph.trees(&parts.rows, &how)?;
    let time = start.elapsed();
    parts.stab = Some(StabTrees::new(trees, &parts.portals, parts.cells.len())?);
    Ok(BakedStab { table: Table::new(parts)?, report: StabReport { max_nodes, trees: summary, time } })
}

impl<R> Baked<TableGraph, R> {
    /// The same with stab trees in the table ([`with_stab_trees`]), and a report on them.
    ///
    /// # Errors
    /// As [`with_stab_trees`].
    pub fn with_stab_trees(self, options: &StabOptions<'_>) -> Result<(Self, StabReport), StabBakeError> {
        let Self { graph, table, report } = self;
        let BakedStab { table, report: stab } = with_stab_trees(table, &graph, options)?;
        Ok((Self { graph, table, report }, stab))
    }
}
