//! Sequences of convex portals, extended and shortened by one.

use super::follow::Follower;
use crate::convex::Gates;
use sightlines_cells::{CellGraph, Convex, Portal3};
use sightlines_sightline::{ConvexSequence, Line3, StabLimits};
use std::borrow::Borrow;
use std::sync::Arc;

/// Follows sequences of convex portals. Undecided ones count as passed.
#[derive(Debug, Clone)]
pub struct ByPolygons {
    gates: Arc<Gates>,
    stabber: ConvexSequence<Gate>,
    sequence: Vec<u32>,
}

/// The shape of a gate.
#[derive(Debug, Clone)]
struct Gate {
    gates: Arc<Gates>,
    gate: u32,
}

impl Borrow<Portal3> for Gate {
    fn borrow(&self) -> &Portal3 {
        self.gates.shape(self.gate)
    }
}

impl ByPolygons {
    /// For the portals of a graph; `limits` are those of each push.
    pub fn new(graph: &CellGraph<Convex>, limits: StabLimits) -> Self {
        Self { gates: Arc::new(Gates::new(graph)), stabber: ConvexSequence::new(limits), sequence: Vec::new() }
    }

    fn shape(&self, gate: u32) -> Gate {
        Gate { gates: Arc::clone(&self.gates), gate }
    }
}

impl Follower for ByPolygons {
    type Note = Option<Line3>;

    /// Cost: a few linear programs, unless the line of the shorter sequence passes the gate too.
    fn push(&mut self, gate: u32) -> Option<Option<Line3>> {
        // What the planes of portals hide is hidden in the table's rows too.
        if !self.sequence.iter().all(|&before| self.gates.may_follow(before, gate)) {
            return None;
        }
        self.stabber.extend(self.shape(gate))?;
        self.sequence.push(gate);
        Some(self.stabber.known_line())
    }

    fn push_again(&mut self, gate: u32, line: Option<Line3>) {
        self.stabber.push_known(self.shape(gate), line);
        self.sequence.push(gate);
    }

    fn pop(&mut self) {
        if self.sequence.pop().is_some() {
            self.stabber.pop();
        }
    }

    fn n_undecided(&self) -> u64 {
        self.stabber.n_undecided()
    }
}
