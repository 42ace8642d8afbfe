//! The stab trees of all cells, in one graph.

use super::by_polygons::ByPolygons;
use super::follow::{ByStabber, Follower};
use super::gate_graph::GateGraph;
use super::grow::{Grown, grow};
use super::share::Shared;
use crate::convex::Workers;
use sightlines_cells::{Axial, CellGraph, CellId, Convex, Planar, Space};
use sightlines_geometry::{Adaptive, AxialDoor, Portal2};
use sightlines_progress::{Cancelled, Counter, Observer};
use sightlines_pvs::{BitMatrix, StabParts};
use sightlines_sightline::{AxialStabber, Funnel, StabLimits};

/// Cells whose trees are in memory at a time, for each one being grown.
const BATCH: usize = 64;
/// Most nodes, and most children, of the whole graph, so that ids have 32 bits with a bit to spare. Trees beyond are
/// left out.
const MOST: usize = 1 << 31;

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
}

impl Default for StabTreesOptions<'_> {
    fn default() -> Self {
        Self { max_nodes: 16_384, threads: 0, progress: None }
    }
}

impl std::fmt::Debug for StabTreesOptions<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut out = f.debug_struct("StabTreesOptions");
        out.field("max_nodes", &self.max_nodes).field("threads", &self.threads).finish_non_exhaustive()
    }
}

/// Numbers of the trees of all cells, before equal ones are shared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub struct StabTreesSummary {
    /// Sequences of at least one gate: nodes of all trees but their roots.
    pub n_sequences: u64,
    /// Those of them that may continue with sequences that are not in the tree.
    pub n_open: u64,
    /// Cells whose tree was cut.
    pub n_cut_cells: u64,
    /// Nodes of the largest tree, the root included.
    pub n_largest: u64,
    /// Sequences of convex portals that count as passed because they are undecided.
    pub n_undecided: u64,
}

/// One tree with equal nodes shared.
struct Folded {
    shared: Shared,
    roots: Vec<u32>,
    root_open: bool,
    counts: StabTreesSummary,
}

impl Folded {
    fn new(tree: &Grown) -> Self {
        let mut shared = Shared::default();
        let mut ids = vec![0u32; tree.len()];
        let mut children = Vec::new();
        // A parent comes before its children.
        for node in (1..tree.len()).rev() {
            children.clear();
            children.extend_from_slice(&ids[tree.children(node)]);
            children.sort_unstable();
            ids[node] = shared.id(tree.gates[node], tree.open[node], &children);
        }
        let mut roots = ids[tree.children(0)].to_vec();
        roots.sort_unstable();
        let n_open = tree.open[1..].iter().filter(|&&open| open).count() as u64;
        let counts = StabTreesSummary {
            n_sequences: tree.len() as u64 - 1,
            n_open,
            n_cut_cells: u64::from(n_open > 0 || tree.open[0]),
            n_largest: tree.len() as u64,
            n_undecided: tree.n_undecided,
        };
        Self { shared, roots, root_open: tree.open[0], counts }
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
/// [`Cancelled`] by the observer.
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
) -> Result<(StabParts, StabTreesSummary), Cancelled> {
    let n = graph.n_cells();
    assert_eq!((rows.n_rows(), rows.n_cols()), (n, n), "rows are cells by cells");
    let ways = GateGraph::new(graph, rows);
    let workers = Workers::new(options.threads);
    let max_nodes = options.max_nodes.clamp(1, MOST);
    let counter = Counter::new(options.progress, "stab trees", n);
    let one = |follower: &mut F, cell: usize| -> Result<Folded, Cancelled> {
        let folded = Folded::new(&grow(&ways, CellId(cell as u32), follower, max_nodes));
        counter.step()?;
        Ok(folded)
    };
    let mut shared = Shared::default();
    let mut forest = StabParts { first_root: vec![0], ..StabParts::default() };
    let mut summary = StabTreesSummary::default();
    for first in (0..n).step_by(BATCH) {
        // In the order of cells, so that ids do not depend on which finished first.
        for tree in workers.map(first..n.min(first + BATCH), || follower.clone(), one) {
            let tree = tree?;
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
}

impl std::ops::AddAssign for StabTreesSummary {
    fn add_assign(&mut self, other: Self) {
        self.n_sequences += other.n_sequences;
        self.n_open += other.n_open;
        self.n_cut_cells += other.n_cut_cells;
        self.n_largest = self.n_largest.max(other.n_largest);
        self.n_undecided += other.n_undecided;
    }
}

/// [`stab_trees`] of a planar graph: exact.
///
/// # Errors
/// [`Cancelled`] by the observer.
pub fn stab_trees_planar(
    graph: &CellGraph<Planar>,
    rows: &BitMatrix,
    options: &StabTreesOptions<'_>,
) -> Result<(StabParts, StabTreesSummary), Cancelled> {
    let seen = |p: &Portal2, forward: bool| if forward { *p } else { p.reversed() };
    match graph.small_grid() {
        Some(grid) => stab_trees(graph, rows, &ByStabber::new(graph, Funnel::new(grid), seen), options),
        None => stab_trees(graph, rows, &ByStabber::new(graph, Funnel::new(Adaptive), seen), options),
    }
}

/// [`stab_trees`] of a graph of boxes: exact.
///
/// # Errors
/// [`Cancelled`] by the observer.
pub fn stab_trees_axial(
    graph: &CellGraph<Axial>,
    rows: &BitMatrix,
    options: &StabTreesOptions<'_>,
) -> Result<(StabParts, StabTreesSummary), Cancelled> {
    let seen = |p: &AxialDoor, forward: bool| if forward { *p } else { p.reversed() };
    stab_trees(graph, rows, &ByStabber::new(graph, AxialStabber::new(), seen), options)
}

/// [`stab_trees`] of a graph of convex cells. Sequences that are not decided within `limits` count as passed.
///
/// # Errors
/// [`Cancelled`] by the observer.
pub fn stab_trees_convex(
    graph: &CellGraph<Convex>,
    rows: &BitMatrix,
    limits: StabLimits,
    options: &StabTreesOptions<'_>,
) -> Result<(StabParts, StabTreesSummary), Cancelled> {
    stab_trees(graph, rows, &ByPolygons::new(graph, limits), options)
}
