//! Stab trees that a table is to have, and what those of a table are.

use crate::error::{ErrorAbout, Result};
use crate::kept::Kept;
use crate::output::{JsonSchema, Serialize, percent, seconds_of};
use crate::progress::Bar;
use sightlines::bake::{Baked, StabOptions, StabReport};
use sightlines::pvs::Table;
use sightlines::report::StabFacts;
use std::fmt;
use std::path::Path;

/// Adds stab trees to what was baked from `path`, if they are wanted; `wanted` may limit the nodes of a tree.
pub(super) fn add(
    path: &Path,
    baked: Baked,
    wanted: Option<Option<u32>>,
    threads: usize,
    kept: &Kept<'_>,
    show_progress: bool,
) -> Result<(Baked, Option<Added>)> {
    let Some(max_nodes) = wanted else { return Ok((baked, None)) };
    let bar = Bar::new("stab trees", show_progress);
    let max_nodes = max_nodes.map(|n| n as usize);
    let units = kept.units();
    let with = baked.with_stab_trees(&StabOptions { max_nodes, threads, progress: Some(&bar), units });
    drop(bar);
    let (baked, report) = with.in_file(path)?;
    let added = Added::new(&baked.table, &report);
    Ok((baked, Some(added)))
}

/// Stab trees that were added.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct Added {
    #[serde(flatten)]
    facts: StabFacts,
    /// Limit of nodes for the tree of one cell, before equal subtrees are merged.
    max_nodes: usize,
    /// Nodes of the largest tree, before equal subtrees are merged.
    n_largest: u64,
    /// Cells whose tree was truncated.
    n_cut_cells: u64,
    /// Sequences at which a tree was truncated.
    n_open: u64,
    /// Sequences that count as passable because they were not decided.
    n_undecided: u64,
    /// Seconds to build the trees.
    stab_seconds: f64,
    #[serde(skip)]
    cut_share: f64,
}

impl Added {
    fn new(table: &Table, report: &StabReport) -> Self {
        let did = &report.trees;
        Self {
            facts: StabFacts::of(table).unwrap_or_default(),
            max_nodes: report.max_nodes,
            n_largest: did.n_largest,
            n_cut_cells: did.n_cut_cells,
            n_open: did.n_open,
            n_undecided: did.n_undecided,
            stab_seconds: report.time.as_secs_f64(),
            cut_share: did.n_cut_cells as f64 / table.n_cells().max(1) as f64,
        }
    }
}

impl fmt::Display for Added {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.facts)?;
        if self.n_cut_cells > 0 {
            let [cells, nodes] = [self.n_cut_cells, self.max_nodes as u64];
            writeln!(f, "cut trees      {cells}, {} of all, at {nodes} nodes each", percent(self.cut_share))?;
        }
        writeln!(f, "stab time      {}", seconds_of(self.stab_seconds))
    }
}
