//! Why one cell sees another, or why it does not.

use sightlines_cells::{CellGraph, CellId, Exit, Planar, PortalId, Space};
use sightlines_geometry::{Adaptive, Portal2};
use sightlines_sightline::{Funnel, PlanarCertificate, PlanarWitness};

/// A sequence of portals that no open set of lines passes, though one passes all but the last.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BlockedSequence {
    /// The portals, in order.
    pub portals: Vec<PortalId>,
    /// Why.
    pub certificate: PlanarCertificate,
}

/// The answer for two cells.
#[derive(Debug, Clone, PartialEq)]
pub enum Explanation {
    /// They are one cell.
    Same,
    /// They see each other.
    Visible {
        /// The portals between them, in order; none if they are one cell.
        portals: Vec<PortalId>,
        /// The same portals as who walks through them sees them.
        doors: Vec<Portal2>,
        /// A line through all of them.
        witness: Box<PlanarWitness>,
    },
    /// They do not: every sequence of portals towards the target ends at a blocked one.
    Hidden {
        /// Number of blocked sequences.
        n_blocked: u64,
        /// The first of them, as many as asked for.
        blocked: Vec<BlockedSequence>,
        /// Whether any chain of portals joins the two cells at all.
        connected: bool,
    },
    /// The search met more sequences than allowed.
    TooMany {
        /// How many were allowed.
        limit: u64,
    },
}

/// Searches for a line from `from` to `to`, with at most `max_visits` cells entered; keeps the proofs of
/// the first `max_proofs` blocked sequences. Exact.
pub fn explain(graph: &CellGraph<Planar>, from: CellId, to: CellId, max_proofs: usize, max_visits: u64) -> Explanation {
    if from == to {
        return Explanation::Same;
    }
    let useful = reaching(graph, to);
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
                    return Explanation::TooMany { limit: max_visits };
                }
            } else {
                search.note_blocked();
                search.path.pop();
            }
        }
    }
    let connected = search.useful[from.idx()];
    Explanation::Hidden { n_blocked: search.n_blocked, blocked: search.blocked, connected }
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

    fn visible(&self, funnel: &Funnel<Adaptive>) -> Explanation {
        debug_assert!(self.path.last().is_some_and(|e| e.to == self.to));
        Explanation::Visible { portals: self.portals(), doors: self.doors(), witness: Box::new(funnel.witness()) }
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
