//! The stab trees of all cells, in one graph.

use super::by_polygons::ByPolygons;
use super::folded::{Folded, StabTreesSummary};
use super::follow::{ByStabber, Follower};
use super::gate_graph::GateGraph;
use super::grow::grow;
use super::share::Shared;
use crate::convex::Workers;
use sightlines_cells::{Axial, CellGraph, CellId, Convex, Planar, Space};
use sightlines_geometry::{Adaptive, AxialDoor, Portal2};
use sightlines_progress::{Counter, Halt, Observer, Phase, Units, shares_of};
use sightlines_pvs::{BitMatrix, StabParts};
use sightlines_sightline::{AxialStabber, Funnel, StabLimits};

/// Cells whose trees are in memory at a time, for each one being grown.
const BATCH: usize = 64;
/// Most nodes, and most children, of the whole graph, so that ids have 32 bits with a bit to spare. Trees beyond are
/// left out.
const MOST: usize = 1 << 31;

/// The phase of units of work: each cell is one.
const PHASE: &str = "stab-trees";

/// Limits on trees.
#[derive(Clone, Copy)]
pub struct StabTreesOptions<'a> {
    /// The most nodes of one tree, unfolded, the root included. Larger trees are cut breadth first: the nearest
    /// sequences stay, and nodes that may continue are marked open. At least 1; 0 counts as 1.
    pub max_nodes: usize,
    /// Number of threads; 0 for one per core. Affects only the time.
    pub threads: usize,
    /// Receives a report for each finished tree, and may cancel.
    pub progress: Option<&'a dyn Observer>,
    /// Where the tree of each cell is kept, to go on after a stop or to share the work among processes.
    pub units: Units<'a>,
}

impl Default for StabTreesOptions<'_> {
    fn default() -> Self {
        Self { max_nodes: 16_384, threads: 0, progress: None, units: Units::default() }
    }
}

impl std::fmt::Debug for StabTreesOptions<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut out = f.debug_struct("StabTreesOptions");
        out.field("max_nodes", &self.max_nodes).field("threads", &self.threads).finish_non_exhaustive()
    }
}

impl Shared {
    /// Adds the nodes of another graph and returns their ids here, in ascending order of the ids there.
    fn absorb(&mut self, other: &Self) -> Vec<u32> {
        let mut ids: Vec<u32> = Vec::with_capacity(other.len());
        let mut children = Vec::new();
        for node in 0..other.len() as u32 {
            children.clear();
            children.extend(other.children(node).iter().map(|&child| ids[child as usize]));
            children.sort_unstable();
            ids.push(self.id(other.gates[node as usize], other.open[node as usize], &children));
        }
        ids
    }
}

/// The stab trees of all cells, in one graph in which equal trees are stored once.
///
/// * `rows`: cells by cells, symmetric: pairs that may see each other. Only sequences whose cells are all in each
///   other's rows are followed; rows that hide no visible pair lose none, and tighter rows save work.
/// * `follower`: cloned for each thread.
///
/// Returns the graph with each node once, children and roots ascending; each path from a root of a cell is a sequence
/// of gates, see `gate_of`.
///
/// Conservative for every limit: a sequence that an open set of lines passes is in the graph, or begins with one that
/// ends in an open node (or at an open root). Beyond that it is exact if the follower is: every sequence in the graph
/// is passed, and only nodes that continue are open. Independent of the number of threads.
///
/// Cost: a push for each sequence and about as many again for rejected gates, and for moving the follower from one end
/// of a tree to the other; memory is the graph, and a batch of trees.
///
/// # Errors
/// [`Halt`] by the observer, or by the store of units.
///
/// # Panics
/// If `rows` has another size.
///
/// # Source
/// Teller and Séquin, SIGGRAPH 1991, section 4, for the trees; sharing equal ones, and cutting them, are our own.
pub fn stab_trees<C: Space, F: Follower>(
    graph: &CellGraph<C>,
    rows: &BitMatrix,
    follower: &F,
    options: &StabTreesOptions<'_>,
) -> Result<(StabParts, StabTreesSummary), Halt> {
    let n = graph.n_cells();
    assert_eq!((rows.n_rows(), rows.n_cols()), (n, n), "rows are cells by cells");
    let ways = GateGraph::new(graph, rows);
    let workers = Workers::new(options.threads);
    let max_nodes = options.max_nodes.clamp(1, MOST);
    let units = options.units;
    // What a cell may see bounds the cells of its sequences.
    let costs: Vec<f64> = (0..n).map(|cell| rows.count_row(cell) as f64).collect();
    let shares = shares_of(&costs);
    let counter = Counter::new(options.progress, "stab trees", n);
    let one = |follower: &mut F, cell: usize| -> Result<Option<Folded>, Halt> {
        counter.check()?;
        let id = CellId(cell as u32);
        let (folded, is_kept) = units.value(
            (PHASE, cell, "this bake"),
            || Ok::<_, Halt>(Folded::new(&grow(&ways, id, follower, max_nodes))),
            Folded::to_bytes,
            |bytes| Folded::from_bytes(bytes, &ways, id, max_nodes),
        )?;
        counter.step_by(shares[cell], is_kept)?;
        Ok(folded)
    };
    units.through(&Phase::new(PHASE, &costs), || {
        let mut shared = Shared::default();
        let mut forest = StabParts { first_root: vec![0], ..StabParts::default() };
        let mut summary = StabTreesSummary::default();
        for first in (0..n).step_by(BATCH) {
            // In the order of cells, so that ids do not depend on which finished first.
            for tree in workers.map(first..n.min(first + BATCH), || follower.clone(), one) {
                // Without one that is for another process this ends below.
                let Some(tree) = tree? else { continue };
                let fits = shared.len() + tree.shared.len() <= MOST
                    && shared.children.len() + tree.shared.children.len() <= MOST
                    && forest.roots.len() + tree.roots.len() <= MOST;
                if fits {
                    let ids = shared.absorb(&tree.shared);
                    let from = forest.roots.len();
                    forest.roots.extend(tree.roots.iter().map(|&root| ids[root as usize]));
                    forest.roots[from..].sort_unstable();
                    summary += tree.counts;
                } else {
                    summary += StabTreesSummary { n_cut_cells: 1, n_largest: 1, ..StabTreesSummary::default() };
                }
                forest.root_open.push(tree.root_open || !fits);
                forest.first_root.push(forest.roots.len() as u32);
            }
        }
        forest.first_child = shared.first_child();
        (forest.gates, forest.children, forest.open) = (shared.gates, shared.children, shared.open);
        Ok((forest, summary))
    })
}

/// [`stab_trees`] of a planar graph: exact.
///
/// # Errors
/// [`Halt`] by the observer, or by the store of units.
pub fn stab_trees_planar(
    graph: &CellGraph<Planar>,
    rows: &BitMatrix,
    options: &StabTreesOptions<'_>,
) -> Result<(StabParts, StabTreesSummary), Halt> {
    let seen = |p: &Portal2, forward: bool| if forward { *p } else { p.reversed() };
    match graph.small_grid() {
        Some(grid) => stab_trees(graph, rows, &ByStabber::new(graph, Funnel::new(grid), seen), options),
        None => stab_trees(graph, rows, &ByStabber::new(graph, Funnel::new(Adaptive), seen), options),
    }
}

/// [`stab_trees`] of a graph of boxes: exact.
///
/// # Errors
/// [`Halt`] by the observer, or by the store of units.
pub fn stab_trees_axial(
    graph: &CellGraph<Axial>,
    rows: &BitMatrix,
    options: &StabTreesOptions<'_>,
) -> Result<(StabParts, StabTreesSummary), Halt> {
    let seen = |p: &AxialDoor, forward: bool| if forward { *p } else { p.reversed() };
    stab_trees(graph, rows, &ByStabber::new(graph, AxialStabber::new(), seen), options)
}

/// [`stab_trees`] of a graph of convex cells. Sequences that are not decided within `limits` count as passed.
///
/// # Errors
/// [`Halt`] by the observer, or by the store of units.
pub fn stab_trees_convex(
    graph: &CellGraph<Convex>,
    rows: &BitMatrix,
    limits: StabLimits,
    options: &StabTreesOptions<'_>,
) -> Result<(StabParts, StabTreesSummary), Halt> {
    stab_trees(graph, rows, &ByPolygons::new(graph, limits), options)
}
