//! Sequences of convex portals, made longer and shorter by one.

use super::gates::Gates;
use crate::tree::Follower;
use sightlines_cells::{CellGraph, Convex};
use sightlines_sightline::{ConvexStabber, Line3, StabLimits, Stabbing3};
use std::sync::Arc;

/// Follows sequences of convex portals. What is not decided counts as passed.
#[derive(Debug, Clone)]
pub struct ByPolygons {
    gates: Arc<Gates>,
    stabber: ConvexStabber,
    sequence: Vec<u32>,
    /// For each gate of the sequence, a line up to there, if one is known.
    lines: Vec<Option<Line3>>,
    n_undecided: u64,
}

impl ByPolygons {
    /// For the portals of a graph; `limits` are those of each question.
    pub fn new(graph: &CellGraph<Convex>, limits: StabLimits) -> Self {
        let (gates, stabber) = (Arc::new(Gates::new(graph)), ConvexStabber::new(limits));
        Self { gates, stabber, sequence: Vec::new(), lines: Vec::new(), n_undecided: 0 }
    }
}

impl Follower for ByPolygons {
    type Note = Option<Line3>;

    /// Cost: a linear program or some, unless the line of the sequence before passes the gate too.
    fn push(&mut self, gate: u32) -> Option<Option<Line3>> {
        // What portals' planes hide is hidden from the search that made the table's rows too.
        if !self.sequence.iter().all(|&before| self.gates.may_follow(before, gate)) {
            return None;
        }
        let shapes: Vec<_> = self.sequence.iter().chain([&gate]).map(|&g| self.gates.shape(g)).collect();
        let hint = self.lines.last().copied().flatten();
        let line = match self.stabber.stab(&shapes, hint.as_ref()) {
            Stabbing3::Visible(line) => Some(line),
            Stabbing3::Undecided => {
                self.n_undecided += 1;
                None
            }
            Stabbing3::Hidden(_) => return None,
        };
        self.push_again(gate, line);
        Some(line)
    }

    fn push_again(&mut self, gate: u32, line: Option<Line3>) {
        self.sequence.push(gate);
        self.lines.push(line);
    }

    fn pop(&mut self) {
        self.sequence.pop();
        self.lines.pop();
    }

    fn n_undecided(&self) -> u64 {
        self.n_undecided
    }
}
