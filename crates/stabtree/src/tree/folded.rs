//! The tree of one cell with equal nodes shared, and as bytes.

use super::gate_graph::GateGraph;
use super::grow::Grown;
use super::share::Shared;
use sightlines_cells::CellId;
use sightlines_progress::{Kept, write_list};

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
#[derive(Debug)]
pub(super) struct Folded {
    pub(super) shared: Shared,
    pub(super) roots: Vec<u32>,
    pub(super) root_open: bool,
    pub(super) counts: StabTreesSummary,
}

impl Folded {
    pub(super) fn new(tree: &Grown) -> Self {
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
        Self::of(shared, roots, tree.open[0], tree.n_undecided)
    }

    /// Counts the nodes of the unfolded tree.
    fn of(shared: Shared, roots: Vec<u32>, root_open: bool, n_undecided: u64) -> Self {
        // Nodes, and open ones, below and with each node.
        let mut below: Vec<[u64; 2]> = Vec::with_capacity(shared.len());
        let sum = |below: &[[u64; 2]], nodes: &[u32], first: [u64; 2]| {
            nodes
                .iter()
                .map(|&node| below[node as usize])
                .fold(first, |[n, open], [m, more]| [n.saturating_add(m), open.saturating_add(more)])
        };
        for node in 0..shared.len() as u32 {
            let first = [1, u64::from(shared.open[node as usize])];
            below.push(sum(&below, shared.children(node), first));
        }
        let [n_sequences, n_open] = sum(&below, &roots, [0, 0]);
        let counts = StabTreesSummary {
            n_sequences,
            n_open,
            n_cut_cells: u64::from(n_open > 0 || root_open),
            n_largest: n_sequences.saturating_add(1),
            n_undecided,
        };
        Self { shared, roots, root_open, counts }
    }

    /// Nodes with children before their parents, then the root.
    pub(super) fn to_bytes(&self) -> Vec<u8> {
        let mut out = Vec::new();
        self.shared.len().write(&mut out);
        for node in 0..self.shared.len() as u32 {
            let (gate, open) = (self.shared.gates[node as usize], self.shared.open[node as usize]);
            (u64::from(gate) << 1 | u64::from(open)).write(&mut out);
            write_list(self.shared.children(node), &mut out);
        }
        self.roots.write(&mut out);
        self.root_open.write(&mut out);
        self.counts.n_undecided.write(&mut out);
        out
    }

    /// `None` if these are no bytes of a tree of a cell, of at most so many nodes. Memory in proportion to the bytes.
    pub(super) fn from_bytes(mut bytes: &[u8], ways: &GateGraph<'_>, cell: CellId, max_nodes: usize) -> Option<Self> {
        let mut shared = Shared::default();
        let mut nodes = Vec::new();
        for node in 0..u64::read(&mut bytes)? {
            let gate = u64::read(&mut bytes)?;
            let (gate, open) = (u32::try_from(gate >> 1).ok()?, gate & 1 == 1);
            let here = ways.ends(gate)?[1];
            read_nodes(&mut bytes, &shared, ways, here, &mut nodes)?;
            if u64::from(shared.id(gate, open, &nodes)) != node {
                return None;
            }
        }
        read_nodes(&mut bytes, &shared, ways, cell, &mut nodes)?;
        let (root_open, n_undecided) = <(bool, u64)>::from_bytes(bytes)?;
        let folded = Self::of(shared, nodes, root_open, n_undecided);
        (folded.counts.n_largest <= max_nodes as u64).then_some(folded)
    }
}

/// Reads ascending nodes whose gates lead out of a cell.
fn read_nodes(
    bytes: &mut &[u8],
    shared: &Shared,
    ways: &GateGraph<'_>,
    from: CellId,
    nodes: &mut Vec<u32>,
) -> Option<()> {
    nodes.clear();
    for _ in 0..u64::read(bytes)? {
        let node = u32::read(bytes).filter(|node| (*node as usize) < shared.len())?;
        let is_next = nodes.last().is_none_or(|last| *last < node);
        if !is_next || ways.ends(shared.gates[node as usize])?[0] != from {
            return None;
        }
        nodes.push(node);
    }
    Some(())
}

impl std::ops::AddAssign for StabTreesSummary {
    fn add_assign(&mut self, other: Self) {
        self.n_sequences += other.n_sequences;
        self.n_open += other.n_open;
        self.n_cut_cells += other.n_cut_cells;
        self.n_largest = self.n_largest.max(other.n_largest);
        self.n_undecided = self.n_undecided.saturating_add(other.n_undecided);
    }
}
