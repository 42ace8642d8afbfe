//! Why one convex cell sees another, or why it does not.
//!
//! # What proves that a cell is hidden
//! A line that joins two cells passes from cell to cell, through each once, along a chain of gates (portals with a
//! direction). (If it comes back into a cell that is not convex, the gates in between are left out: nothing hides inside of
//! a cell.) A [`BlockedConvex`] is a list of gates with a proof that no line passes all of them in this order,
//! whatever lies between. A [`ConvexProof`] is a set of these lists: it proves that `to` is hidden from `from` if
//! **every chain of gates from one to the other that visits each cell at most once contains one of the lists in
//! order**. Whether that holds is a question about the graph alone; [`check_convex`] answers it by following all chains
//! that are not stopped, and stops a chain only where
//!
//! * its gates contain a blocked list, or
//! * the target can no longer be reached from the last cell, through cells that the chain has not visited and gates
//!   that do not complete a blocked list.
//!
//! # How it is found
//! Chains are followed depth first from one of the two cells. Each keeps the gates into the target that lines through
//! the chain can reach (chain and gate, without what is between, have a line): a chain without any is abandoned, and
//! the reason why its last one is blocked is learnt. So only chains in the shaft between the cells are followed. Each
//! query of the stabber is for a chain with one more gate; the certificate names the few gates that matter, and every
//! later chain with these gates is stopped without a query. A line that is found is followed through the graph, as it
//! may lead to the target by itself.
//!
//! Through open space there may be very many chains. So there is a limit, and [`ConvexDoubt::Limit`].
//!
//! Source: ours; learning from blocked lists is the idea of nogoods in constraint search.

mod check;
mod search;

use super::gates::Gates;
use crate::explanation::{Explanation, SearchLimit, Sight};
use search::Search;
use sightlines_cells::{CellGraph, CellId, Convex, Point3, Portal3, PortalId};
use sightlines_sightline::{ConvexCertificate, Line3, Verdict};

/// A portal and the direction in which it is crossed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ConvexGate {
    /// The portal.
    pub portal: PortalId,
    /// Whether it is crossed from its first cell into its second.
    pub forward: bool,
}

impl ConvexGate {
    /// The cells before and behind it.
    pub fn cells(self, graph: &CellGraph<Convex>) -> [CellId; 2] {
        let [a, b] = graph.portal(self.portal).cells;
        if self.forward { [a, b] } else { [b, a] }
    }

    /// Its shape, oriented for crossing it.
    pub fn shape(self, graph: &CellGraph<Convex>) -> Portal3 {
        let shape = &graph.portal(self.portal).shape;
        if self.forward { shape.clone() } else { shape.reversed() }
    }

    /// Where a line crosses it, rounded: in the plane through the middle of its corners.
    pub fn crossing(self, graph: &CellGraph<Convex>, line: &Line3) -> Point3 {
        let shape = &graph.portal(self.portal).shape;
        let (normal, n) = (shape.normal(), shape.corners().len() as f64);
        let dot = |a: Point3, b: Point3| (0..3).map(|k| a[k] * b[k]).sum::<f64>();
        let middle = [0, 1, 2].map(|k| shape.corners().iter().map(|p| p[k]).sum::<f64>() / n);
        let step = [0, 1, 2].map(|k| line.b[k] - line.a[k]);
        let share = dot(normal, [0, 1, 2].map(|k| middle[k] - line.a[k])) / dot(normal, step);
        [0, 1, 2].map(|k| line.a[k] + share * step[k])
    }
}

/// Gates that no line passes in this order, whatever is between them.
#[derive(Debug, Clone, PartialEq)]
pub struct BlockedConvex {
    /// The gates, only those that the proof needs.
    pub gates: Vec<ConvexGate>,
    /// Why.
    pub reason: Blocking,
}

/// Why no line passes some gates in order.
#[derive(Debug, Clone, PartialEq)]
pub enum Blocking {
    /// Exactly: a certificate that names all the gates.
    Certificate(Box<ConvexCertificate>),
    /// The second of two gates does not reach in front of the plane of the first, or the first not behind that of the
    /// second: mostly portals of a cell that lie side by side.
    ///
    /// This allows for rounding, as the search does: cells are convex, so that a line crosses the plane of a portal
    /// once, but corners in files are off their planes, and so what is nearer to a plane than `2^-44` of the largest
    /// coordinate of the two portals counts as on it. (If corners are exactly on one plane, it is exact.)
    Behind,
}

/// The explanation for two convex cells. [`check_convex`] checks it independently.
pub type ConvexExplanation = Explanation<ConvexPath, ConvexProof, ConvexDoubt>;

/// How one convex cell sees another.
#[derive(Debug, Clone, PartialEq)]
pub struct ConvexPath {
    /// The gates from the first cell to the second, at least one.
    pub gates: Vec<ConvexGate>,
    /// A line that passes them all.
    pub line: Line3,
}

/// Why one convex cell does not see another: lists of gates stop every chain.
#[derive(Debug, Clone, PartialEq)]
pub struct ConvexProof {
    /// The cell, one of the two, from which the chains of gates lead to the other.
    pub start: CellId,
    /// The lists that stop them.
    pub blocked: Vec<BlockedConvex>,
}

/// Why it is undecided whether one convex cell sees another.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ConvexDoubt {
    /// There are more chains than the limit allowed to follow.
    Limit(SearchLimit),
    /// No line was found, and for this chain of gates, from the first cell to the second, rounding leaves open whether
    /// one passes.
    Chain(Vec<ConvexGate>),
}

/// Default number of queries after which [`explain_convex`] gives up.
pub const MOST_EXPLAINED: u64 = 100_000;

/// Finds explanations for the cells of one graph.
#[derive(Debug)]
pub struct ConvexExplainer {
    gates: Gates,
}

impl ConvexExplainer {
    /// Prepares for this graph. O(portals).
    pub fn new(graph: &CellGraph<Convex>) -> Self {
        Self { gates: Gates::new(graph) }
    }

    /// Why `from` sees `to`, or why not; gives up after about `limit` queries about sequences of gates. The answer
    /// depends on nothing else, and a lower limit can only change it to [`ConvexDoubt::Limit`].
    ///
    /// Cost: a query takes from microseconds to a millisecond, and each step into a cell takes a walk through the
    /// graph.
    ///
    /// # Panics
    /// If there are no such cells.
    pub fn explain(&self, from: CellId, to: CellId, limit: u64) -> ConvexExplanation {
        let n_cells = self.gates.n_cells();
        assert!(from.idx() < n_cells && to.idx() < n_cells, "cells {from} and {to} of {n_cells}");
        if from == to {
            return Verdict::Visible(Sight::SameCell);
        }
        // It is not known in advance which side has fewer chains: both are tried, with ever more queries.
        let mut left = limit;
        // That share does not depend on the limit, or else the answer would.
        let mut share = 256;
        while left > 0 {
            for start in [from, to] {
                let goal = if start == from { to } else { from };
                let search = Search::new(&self.gates, start.0, goal.0, share.min(left));
                match search.run() {
                    Verdict::Undecided(ConvexDoubt::Limit(_)) => left -= share.min(left),
                    answer if start == from => return answer,
                    answer => return reversed(answer),
                }
            }
            share = share.saturating_mul(4);
        }
        Verdict::Undecided(ConvexDoubt::Limit(SearchLimit(limit)))
    }
}

/// Why one cell sees another, or why not: [`ConvexExplainer::explain`] for one pair.
pub fn explain_convex(graph: &CellGraph<Convex>, from: CellId, to: CellId, limit: u64) -> ConvexExplanation {
    ConvexExplainer::new(graph).explain(from, to, limit)
}

/// Whether an explanation holds for two cells, by code that shares nothing with the code that finds explanations. A
/// path holds if the gates lead from one cell to the other, through each cell at most once, and the line passes them,
/// exactly, and in this order as far as rounding shows. A proof holds if every certificate does, and every chain of gates is stopped. Undecided is `false`.
///
/// `false` too for cells or portals that the graph does not have, and after ten million gates followed.
/// Cost: that of the certificates, and a walk through the graph for each gate followed.
pub fn check_convex(graph: &CellGraph<Convex>, from: CellId, to: CellId, explanation: &ConvexExplanation) -> bool {
    check::holds(explanation, graph, from, to)
}

/// The same explanation for the two cells in the opposite order.
fn reversed(explanation: ConvexExplanation) -> ConvexExplanation {
    let back = |gates: Vec<ConvexGate>| -> Vec<ConvexGate> {
        gates.into_iter().rev().map(|g| ConvexGate { forward: !g.forward, ..g }).collect()
    };
    match explanation {
        Verdict::Visible(Sight::Along(ConvexPath { gates, line })) => {
            Verdict::Visible(Sight::Along(ConvexPath { gates: back(gates), line: line.reversed() }))
        }
        Verdict::Undecided(ConvexDoubt::Chain(gates)) => Verdict::Undecided(ConvexDoubt::Chain(back(gates))),
        other => other,
    }
}
