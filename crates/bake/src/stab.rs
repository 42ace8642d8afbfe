//! Stab trees for a finished table.

use crate::{axial_graph_of, convex_graph_of, graph_of};
use sightlines_progress::{Cancelled, Observer};
use sightlines_pvs::{BitMatrix, StabError, StabParts, StabTrees, Table, TableError};
use sightlines_sightline::StabLimits;
use sightlines_stabtree::{StabTreesOptions, StabTreesSummary, stab_trees_axial, stab_trees_convex, stab_trees_planar};
use std::fmt;
use std::time::{Duration, Instant};

/// How to add stab trees to a table.
#[derive(Clone, Copy, Default)]
pub struct StabOptions<'a> {
    /// The most nodes of the tree of one cell, before equal ones are put together; beyond, it is cut, the nearest
    /// sequences stay, and what may go on is marked. `None`: what [`most_nodes`] says.
    pub max_nodes: Option<usize>,
    /// Number of threads; 0 for one for each core. Changes nothing but the time.
    pub threads: usize,
    /// Called with the number of finished trees and their total.
    pub progress: Option<&'a dyn Observer>,
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
    /// The table does not have the cells and portals that it was made from.
    #[error("stab trees need the cells and portals that the table was made from, and it does not have them")]
    NoGraph,
    /// The observer cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// The trees do not fit the table: a defect of this crate.
    #[error("the stab trees are inconsistent: {0}")]
    Stab(#[from] StabError),
    /// The table with trees is no table: a defect of this crate.
    #[error("the table is inconsistent: {0}")]
    Table(#[from] TableError),
}

/// A table with stab trees, and how they came about.
#[derive(Debug, Clone, PartialEq)]
pub struct BakedStab {
    /// The table.
    pub table: Table,
    /// The most nodes that a tree was allowed.
    pub max_nodes: usize,
    /// What the trees are, before equal ones are put together.
    pub trees: StabTreesSummary,
    /// Time to find them.
    pub time: Duration,
}

/// The graph of a table, whichever it is.
enum Graph {
    Planar(sightlines_cells::CellGraph<sightlines_cells::Planar>),
    Axial(sightlines_cells::CellGraph<sightlines_cells::Axial>),
    Convex(sightlines_cells::CellGraph<sightlines_cells::Convex>),
}

impl Graph {
    fn of(table: &Table) -> Option<Self> {
        // A table of a portal file is in space, too, but its cells are no boxes.
        let convex = || convex_graph_of(table).map(Self::Convex);
        let axial = || axial_graph_of(table).map(Self::Axial);
        graph_of(table).map(Self::Planar).or_else(convex).or_else(axial)
    }

    /// Default maximum number of nodes of a tree.
    fn most_nodes(&self) -> usize {
        match self {
            Self::Planar(_) => 65_536,
            Self::Axial(_) => 16_384,
            Self::Convex(_) => 4_096,
        }
    }

    fn trees(
        &self,
        rows: &BitMatrix,
        options: &StabTreesOptions<'_>,
    ) -> Result<(StabParts, StabTreesSummary), Cancelled> {
        match self {
            Self::Planar(graph) => stab_trees_planar(graph, rows, options),
            Self::Axial(graph) => stab_trees_axial(graph, rows, options),
            Self::Convex(graph) => stab_trees_convex(graph, rows, StabLimits::default(), options),
        }
    }
}

/// Default maximum number of nodes of a cell's tree in this table: 65,536 in the plane, 16,384 for boxes, 4,096 for
/// convex cells. A sequence takes some hundred nanoseconds in the plane, ten times as long for boxes, a hundred times
/// for polygons. Of the scenes that were measured (the bench `stab_trees`), the limits cut no tree of a plan, up to an
/// eighth of those of boxes, and up to half of those of a Quake map; less than that saves time, but fewer bytes than
/// sequences, as trees that are cut are seldom equal. `None` if the table does not have the cells and portals that it
/// was made from.
pub fn most_nodes(table: &Table) -> Option<usize> {
    Graph::of(table).map(|graph| graph.most_nodes())
}

/// Adds the stab trees of all cells to a table, or replaces those that it has. Everything else stays.
///
/// They are of the portals that the table stores, without mirrors. Conservative for every limit; see
/// [`sightlines_stabtree::stab_trees`] for what that means, and for the cost.
///
/// # Errors
/// [`StabBakeError::NoGraph`] for tables whose geometry was stripped.
pub fn with_stab_trees(table: Table, options: &StabOptions<'_>) -> Result<BakedStab, StabBakeError> {
    let start = Instant::now();
    let graph = Graph::of(&table).ok_or(StabBakeError::NoGraph)?;
    let max_nodes = options.max_nodes.unwrap_or_else(|| graph.most_nodes());
    let how = StabTreesOptions { max_nodes, threads: options.threads, progress: options.progress };
    let mut parts = table.into_parts();
    let (trees, summary) = graph.trees(&parts.rows, &how)?;
    let time = start.elapsed();
    parts.stab = Some(StabTrees::new(trees, &parts.portals, parts.cells.len())?);
    Ok(BakedStab { table: Table::new(parts)?, max_nodes, trees: summary, time })
}
