//! Why one cell of a plan sees another, or why it does not.

use crate::explanation::{Barrier, Explanation, SearchLimit, Sight};
use sightlines_cells::{CellGraph, CellId, Exit, Planar, PortalId, Space};
use sightlines_geometry::{Adaptive, Portal2};
use sightlines_sightline::{Funnel, PlanarCertificate, PlanarWitness, Verdict};

/// A sequence of portals that no open set of lines passes, though one passes all but the last.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BlockedSequence {
    /// The portals, in order.
    pub portals: Vec<PortalId>,
    /// Why.
    pub certificate: PlanarCertificate,
}

/// The explanation for two cells of a plan.
pub type PlanarExplanation = Explanation<PlanarPath, PlanarProof>;

/// How one cell of a plan sees another.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanarPath {
    /// The portals between them, in order.
    pub portals: Vec<PortalId>,
    /// The same portals, oriented for crossing them in this order.
    pub doors: Vec<Portal2>,
    /// A line through all of them.
    pub witness: Box<PlanarWitness>,
}

/// Why one cell of a plan does not see another: every sequence of portals towards the target ends at a blocked one.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PlanarProof {
    /// Number of blocked sequences.
    pub n_blocked: u64,
    /// The first of them, as many as requested.
    pub blocked: Vec<BlockedSequence>,
}

/// Searches for a line from `from` to `to`, with at most `max_visits` cells entered; keeps the proofs of
/// the first `max_proofs` blocked sequences. Exact.
pub fn explain(
    graph: &CellGraph<Planar>,
    from: CellId,
    to: CellId,
    max_proofs: usize,
    max_visits: u64,
) -> PlanarExplanation {
    if from == to {
        return Verdict::Visible(Sight::SameCell);
    }
    let useful = reaching(graph, to);
    if !useful[from.idx()] {
        return Verdict::Hidden(Barrier::NotConnected);
    }
    let mut search = Search { graph, useful, to, max_proofs, path: Vec::new(), n_blocked: 0, blocked: Vec::new() };
    let mut funnel = Funnel::new(Adaptive);
    let mut visits = 0u64;
    for exit in graph.exits(from) {
        if !search.useful[exit.to.idx()] {
            continue;
        }
        funnel.start(graph.crossing(exit));
        search.path.push(*exit);
        let mut stack = vec![(0usize, None)];
        while let Some((next, undo)) = stack.last_mut() {
            let here = *search.path.last().expect("one exit for each stack entry");
            if here.to == to {
                return search.visible(&funnel);
            }
            let Some(exit) = graph.exits(here.to).get(*next) else {
                if let Some(undo) = undo.take() {
                    funnel.undo(undo);
                }
                stack.pop();
                search.path.pop();
                continue;
            };
            *next += 1;
            if exit.side == here.entry_side || !search.useful[exit.to.idx()] {
                continue;
            }
            search.path.push(*exit);
            if let Some(undo) = funnel.push(graph.crossing(exit)) {
                stack.push((0, Some(undo)));
                visits += 1;
                if visits > max_visits {
                    return Verdict::Undecided(SearchLimit(max_visits));
                }
            } else {
                search.note_blocked();
                search.path.pop();
            }
        }
    }
    Verdict::Hidden(Barrier::Blocked(PlanarProof { n_blocked: search.n_blocked, blocked: search.blocked }))
}

struct Search<'a> {
    graph: &'a CellGraph<Planar>,
    useful: Vec<bool>,
    to: CellId,
    max_proofs: usize,
    path: Vec<Exit>,
    n_blocked: u64,
    blocked: Vec<BlockedSequence>,
}

impl Search<'_> {
    fn doors(&self) -> Vec<Portal2> {
        self.path.iter().map(|e| self.graph.crossing(e)).collect()
    }

    fn portals(&self) -> Vec<PortalId> {
        self.path.iter().map(|e| e.portal).collect()
    }

    fn visible(&self, funnel: &Funnel<Adaptive>) -> PlanarExplanation {
        debug_assert!(self.path.last().is_some_and(|e| e.to == self.to));
        let (portals, doors) = (self.portals(), self.doors());
        Verdict::Visible(Sight::Along(PlanarPath { portals, doors, witness: Box::new(funnel.witness()) }))
    }

    fn note_blocked(&mut self) {
        self.n_blocked += 1;
        if self.blocked.len() < self.max_proofs {
            let certificate = PlanarCertificate::find(&self.doors()).expect("what the funnel blocks has meeting hulls");
            self.blocked.push(BlockedSequence { portals: self.portals(), certificate });
        }
    }
}

/// Cells from which a chain of portals leads to `to`.
pub(crate) fn reaching<S: Space>(graph: &CellGraph<S>, to: CellId) -> Vec<bool> {
    let mut reached = vec![false; graph.n_cells()];
    reached[to.idx()] = true;
    let mut stack = vec![to];
    while let Some(cell) = stack.pop() {
        for exit in graph.exits(cell) {
            if !std::mem::replace(&mut reached[exit.to.idx()], true) {
                stack.push(exit.to);
            }
        }
    }
    reached
}
