//! Why one convex cell sees another, or why it does not.
//!
//! # What proves that a cell is hidden
//! A line that joins two cells goes from cell to cell, each once, through a chain of gates (portals with a direction).
//! A [`BlockedConvex`] is a list of gates with a proof that no line passes all of them in this order, whatever lies
//! between. A list of these proves that `to` is hidden from `from` if **every chain of gates from one to the
//! other, with each cell once, contains one of them in order**. Whether that is so is a question about the graph
//! alone; [`ConvexExplanation::check`] answers it by following all chains that are not stopped, and leaves a chain
//! only where
//!
//! * its gates contain a blocked list, or
//! * the target cannot be reached any more, from the last cell on, through cells that the chain has not met and gates
//!   that do not complete a blocked list.
//!
//! # How it is found
//! Chains are followed depth first from one of the two cells. For each, the gates into the target are kept that lines
//! through the chain can reach (chain and gate, without what is between, have a line): a chain without any is left,
//! and what blocked its last one is learnt. So only chains in the shaft between the cells are followed. Each question
//! of the stabber is for a chain with one more gate; the certificate names the few gates of it that matter, and
//! whatever chain meets these again is stopped without a question. A line that is found is followed through the graph,
//! for it may lead to the target by itself.
//!
//! Through open space there may be very many chains. So there is a limit, and [`ConvexExplanation::TooMany`].
//!
//! Source: ours; that blocked lists are learnt from is the idea of nogoods in constraint search.

mod check;
mod search;

use super::gates::Gates;
use search::Search;
use sightlines_cells::{CellGraph, CellId, Convex, Point3, Portal3, PortalId};
use sightlines_sightline::{ConvexCertificate, Line3};

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

    /// Its shape, as who crosses it sees it.
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
    /// The gates, no more than it takes.
    pub gates: Vec<ConvexGate>,
    /// Why.
    pub reason: Blocking,
}

/// Why no line passes some gates in order.
#[derive(Debug, Clone, PartialEq)]
pub enum Blocking {
    /// Exactly: a certificate that names all the gates.
    Certificate(Box<ConvexCertificate>),
    /// Of two gates the second does not reach in front of the plane of the first, or the first not behind that of the
    /// second: portals of a cell that lie side by side, for the most part.
    ///
    /// That is up to rounding, as the search takes it too: cells are convex, so that a line crosses the plane of a
    /// portal once, but corners of files are off their planes, and so what is nearer to a plane than `2^-44` of the
    /// largest coordinate of the two portals counts as on it. (Where corners are exactly on one plane, it is exact.)
    Behind,
}

/// The answer for two convex cells.
#[derive(Debug, Clone, PartialEq)]
pub enum ConvexExplanation {
    /// They are one cell.
    Same,
    /// They see each other.
    Visible {
        /// The gates from the first cell to the second, at least one.
        gates: Vec<ConvexGate>,
        /// A line that passes them all.
        line: Line3,
    },
    /// They do not.
    Hidden {
        /// From which of the two the chains of gates are followed, to the other.
        start: CellId,
        /// What stops them. Empty if no chain of portals joins the cells.
        blocked: Vec<BlockedConvex>,
    },
    /// There are more chains than the limit allowed to follow.
    TooMany {
        /// Questions that were allowed.
        limit: u64,
    },
    /// Of all chains that lines might pass none is known to be passed, and of this one (from the first cell to the
    /// second) it could not be decided.
    Undecided {
        /// The gates of the chain.
        gates: Vec<ConvexGate>,
    },
}

/// Default number of queries after which [`explain_convex`] gives up.
pub const MOST_EXPLAINED: u64 = 100_000;

/// Finds explanations for the cells of one graph.
#[derive(Debug)]
pub struct ConvexExplainer {
    gates: Gates,
}

impl ConvexExplainer {
    /// Makes ready for this graph. O(portals).
    pub fn new(graph: &CellGraph<Convex>) -> Self {
        Self { gates: Gates::new(graph) }
    }

    /// Why `from` sees `to`, or why not; gives up after about `limit` questions about sequences of gates. It does not
    /// depend on anything else, and a lower limit gives no other answer but [`ConvexExplanation::TooMany`].
    ///
    /// Cost: a question takes from microseconds to a millisecond, and each step into a cell takes a walk through the
    /// graph.
    ///
    /// # Panics
    /// If there are no such cells.
    pub fn explain(&self, from: CellId, to: CellId, limit: u64) -> ConvexExplanation {
        let n_cells = self.gates.n_cells();
        assert!(from.idx() < n_cells && to.idx() < n_cells, "cells {from} and {to} of {n_cells}");
        if from == to {
            return ConvexExplanation::Same;
        }
        // From which side there is less to follow is not known before: both are tried, with more and more questions.
        let mut left = limit;
        let mut share = (limit / 256).max(64);
        while left > 0 {
            for start in [from, to] {
                let goal = if start == from { to } else { from };
                let search = Search::new(&self.gates, start.0, goal.0, share.min(left));
                match search.run() {
                    ConvexExplanation::TooMany { .. } => left -= share.min(left),
                    answer if start == from => return answer,
                    answer => return answer.turned(),
                }
            }
            share = share.saturating_mul(4);
        }
        ConvexExplanation::TooMany { limit }
    }
}

/// Why one cell sees another, or why not: [`ConvexExplainer::explain`] for one pair.
pub fn explain_convex(graph: &CellGraph<Convex>, from: CellId, to: CellId, limit: u64) -> ConvexExplanation {
    ConvexExplainer::new(graph).explain(from, to, limit)
}

impl ConvexExplanation {
    /// Whether it proves what it says of two cells, by code that shares nothing with what finds explanations: for
    /// a line, exactly, that the gates lead from one cell to the other, through each cell at most once, and that the
    /// line passes them; for what blocks, that every certificate holds, and that every chain of gates is stopped. What
    /// proves nothing ([`ConvexExplanation::TooMany`], [`ConvexExplanation::Undecided`]) is `false`.
    ///
    /// `false` too for cells or portals that the graph does not have, and after ten million gates followed.
    /// Cost: that of the certificates, and a walk through the graph for each gate followed.
    pub fn check(&self, graph: &CellGraph<Convex>, from: CellId, to: CellId) -> bool {
        check::proves(self, graph, from, to)
    }

    /// The same, said from the other cell.
    fn turned(self) -> Self {
        let back = |gates: Vec<ConvexGate>| -> Vec<ConvexGate> {
            gates.into_iter().rev().map(|g| ConvexGate { forward: !g.forward, ..g }).collect()
        };
        match self {
            Self::Visible { gates, line } => Self::Visible { gates: back(gates), line: line.reversed() },
            Self::Undecided { gates } => Self::Undecided { gates: back(gates) },
            other => other,
        }
    }
}
