//! The checker of explanations: it uses the graph, certificates and lines, and no part of the search.

use super::{BlockedConvex, Blocking, ConvexExplanation, ConvexGate, ConvexPath, ConvexProof};
use crate::explanation::{Barrier, Sight};
use sightlines_cells::{CellGraph, CellId, Convex, Point3, Portal3};
use sightlines_sightline::{Line3, Verdict};
use std::collections::HashMap;

/// Most gates followed: enough for any explanation that the search finds.
const MOST_FOLLOWED: u64 = 10_000_000;

pub(super) fn holds(explanation: &ConvexExplanation, graph: &CellGraph<Convex>, from: CellId, to: CellId) -> bool {
    let exists = |cell: CellId| cell.idx() < graph.n_cells();
    if !exists(from) || !exists(to) {
        return false;
    }
    match explanation {
        Verdict::Visible(Sight::SameCell) => from == to,
        Verdict::Visible(Sight::Along(ConvexPath { gates, line })) => {
            are_there(gates, graph)
                && is_chain(gates, graph, from, to)
                && gates.iter().all(|gate| line.passes(&gate.shape(graph)))
                && gates.windows(2).all(|pair| may_meet(line, [pair[0].shape(graph), pair[1].shape(graph)]))
        }
        Verdict::Hidden(Barrier::NotConnected) => from != to && are_all_stopped(graph, from, to, &[]),
        Verdict::Hidden(Barrier::Blocked(ConvexProof { start, blocked })) => {
            let goal = if *start == from { to } else { from };
            from != to
                && (*start == from || *start == to)
                && blocked.iter().all(|b| is_blocked(b, graph))
                && are_all_stopped(graph, *start, goal, blocked)
        }
        Verdict::Undecided(_) => false,
    }
}

fn are_there(gates: &[ConvexGate], graph: &CellGraph<Convex>) -> bool {
    gates.iter().all(|gate| gate.portal.idx() < graph.portals().len())
}

/// Whether a line that passes two portals may meet the first before the second, as far as their corners are off their
/// planes. If the cell between is convex, it does.
fn may_meet(line: &Line3, portals: [Portal3; 2]) -> bool {
    let way: Point3 = [0, 1, 2].map(|k| line.b[k] - line.a[k]);
    let [[from, _], [_, to]] = portals.map(|portal| {
        let corners = || portal.corners().iter().chain([&line.a, &line.b]).flatten();
        let off = portal.unevenness() + 2f64.powi(-40) * corners().fold(0.0, |m: f64, x| m.max(x.abs()));
        let (normal, corner) = (portal.normal(), portal.corners()[0]);
        let dot = |a: Point3| (0..3).map(|k| a[k] * normal[k]).sum::<f64>();
        let (at, off) = (dot([0, 1, 2].map(|k| corner[k] - line.a[k])), off * dot(normal).sqrt());
        let along = dot(way);
        if along > 0.0 { [(at - off) / along, (at + off) / along] } else { [f64::NEG_INFINITY, f64::INFINITY] }
    });
    from <= to
}

/// Whether gates lead from one cell to another, and into no cell twice.
fn is_chain(gates: &[ConvexGate], graph: &CellGraph<Convex>, from: CellId, to: CellId) -> bool {
    let mut met = vec![from];
    for gate in gates {
        let [before, behind] = gate.cells(graph);
        if met.last() != Some(&before) || met.contains(&behind) {
            return false;
        }
        met.push(behind);
    }
    met.len() > 1 && met.last() == Some(&to)
}

/// Whether no line passes the gates in order.
fn is_blocked(blocked: &BlockedConvex, graph: &CellGraph<Convex>) -> bool {
    if blocked.gates.is_empty() || !are_there(&blocked.gates, graph) {
        return false;
    }
    let shapes: Vec<Portal3> = blocked.gates.iter().map(|gate| gate.shape(graph)).collect();
    match (&blocked.reason, &shapes[..]) {
        (Blocking::Certificate(certificate), shapes) => certificate.holds(&shapes.iter().collect::<Vec<_>>()),
        (Blocking::Behind, [first, second]) => {
            let corners = first.corners().iter().chain(second.corners()).flatten();
            // Twice the tolerance of the search, as rounding may make the two disagree.
            let near = 2f64.powi(-43) * corners.fold(0.0, |m: f64, x| m.max(x.abs()));
            highest(second, first, 1.0) <= near || highest(first, second, -1.0) <= near
        }
        (Blocking::Behind, _) => false,
    }
}

/// The height of the highest corner of a polygon over the plane through the middle of another's corners, or, with the
/// sign -1, the depth of the deepest.
fn highest(polygon: &Portal3, plane: &Portal3, sign: f64) -> f64 {
    let normal = plane.normal();
    let dot = |a: Point3| (0..3).map(|k| a[k] * normal[k]).sum::<f64>();
    let length = dot(normal).sqrt();
    let n = plane.corners().len() as f64;
    let middle: Point3 = [0, 1, 2].map(|k| plane.corners().iter().map(|p| p[k]).sum::<f64>() / n);
    let height = |p: &Point3| sign * dot([0, 1, 2].map(|k| p[k] - middle[k])) / length;
    let heights = polygon.corners().iter().map(height);
    // A plane without a direction decides nothing.
    heights.fold(f64::NEG_INFINITY, |m, h| if h.is_nan() { f64::INFINITY } else { m.max(h) })
}

/// Whether every chain of gates from `start` to `goal` contains one of the lists in order.
fn are_all_stopped(graph: &CellGraph<Convex>, start: CellId, goal: CellId, lists: &[BlockedConvex]) -> bool {
    let mut walk = Walk::new(graph, goal, lists);
    let mut n_followed = 0u64;
    // For each cell on the way: the next exit, and the number of notes on entering it.
    let mut way = vec![(start, 0usize, 0usize)];
    walk.is_met[start.idx()] = true;
    if !walk.reaches(start) {
        return true;
    }
    while let Some((here, next, n_notes)) = way.last_mut() {
        let Some(exit) = graph.exits(*here).get(*next) else {
            walk.is_met[here.idx()] = false;
            walk.forget(*n_notes);
            way.pop();
            continue;
        };
        *next += 1;
        let gate = ConvexGate { portal: exit.portal, forward: exit.forward };
        if walk.is_met[exit.to.idx()] || walk.completes(gate) {
            continue;
        }
        if exit.to == goal {
            return false;
        }
        n_followed += 1;
        if n_followed > MOST_FOLLOWED {
            return false;
        }
        let n_notes = walk.notes.len();
        walk.pass(gate);
        walk.is_met[exit.to.idx()] = true;
        if walk.reaches(exit.to) {
            way.push((exit.to, 0, n_notes));
        } else {
            walk.is_met[exit.to.idx()] = false;
            walk.forget(n_notes);
        }
    }
    true
}

/// A chain of gates, and how far each list is contained in it.
struct Walk<'a> {
    graph: &'a CellGraph<Convex>,
    goal: CellId,
    lists: &'a [BlockedConvex],
    /// The places of each gate in lists.
    places: HashMap<ConvexGate, Vec<(usize, usize)>>,
    /// How many gates of each list the chain contains, in order.
    n_contained: Vec<usize>,
    /// How many lists lack only this gate.
    n_lacking: HashMap<ConvexGate, usize>,
    /// Lists that gained a contained gate, in order.
    notes: Vec<usize>,
    is_met: Vec<bool>,
    /// The last search for a path that reached each cell.
    seen: Vec<u64>,
    n_searches: u64,
}

impl<'a> Walk<'a> {
    fn new(graph: &'a CellGraph<Convex>, goal: CellId, lists: &'a [BlockedConvex]) -> Self {
        let mut places: HashMap<ConvexGate, Vec<(usize, usize)>> = HashMap::new();
        let mut n_lacking: HashMap<ConvexGate, usize> = HashMap::new();
        for (list, blocked) in lists.iter().enumerate() {
            for (place, &gate) in blocked.gates.iter().enumerate() {
                places.entry(gate).or_default().push((list, place));
            }
            if let [only] = blocked.gates[..] {
                *n_lacking.entry(only).or_default() += 1;
            }
        }
        Self {
            graph,
            goal,
            lists,
            places,
            n_contained: vec![0; lists.len()],
            n_lacking,
            notes: Vec::new(),
            is_met: vec![false; graph.n_cells()],
            seen: vec![0; graph.n_cells()],
            n_searches: 0,
        }
    }

    /// Whether the chain with this gate contains a whole list.
    fn completes(&self, gate: ConvexGate) -> bool {
        self.n_lacking.get(&gate).is_some_and(|&n| n > 0)
    }

    /// The gate that a list lacks, if it is the last one.
    fn lacking(&self, list: usize) -> Option<ConvexGate> {
        let gates = &self.lists[list].gates;
        (self.n_contained[list] + 1 == gates.len()).then(|| gates[gates.len() - 1])
    }

    fn pass(&mut self, gate: ConvexGate) {
        let Some(places) = self.places.get(&gate) else { return };
        for &(list, place) in places {
            if self.n_contained[list] == place {
                self.n_contained[list] += 1;
                self.notes.push(list);
                if let Some(last) = self.lacking(list) {
                    *self.n_lacking.entry(last).or_default() += 1;
                }
            }
        }
    }

    fn forget(&mut self, n_notes: usize) {
        while self.notes.len() > n_notes {
            let Some(list) = self.notes.pop() else { return };
            if let Some(n) = self.lacking(list).and_then(|last| self.n_lacking.get_mut(&last)) {
                *n -= 1;
            }
            self.n_contained[list] -= 1;
        }
    }

    /// Whether any path leads from a cell to the goal, through unvisited cells and gates that complete no list.
    fn reaches(&mut self, from: CellId) -> bool {
        self.n_searches += 1;
        let mut waiting = vec![from];
        while let Some(cell) = waiting.pop() {
            for exit in self.graph.exits(cell) {
                let gate = ConvexGate { portal: exit.portal, forward: exit.forward };
                if self.is_met[exit.to.idx()] || self.seen[exit.to.idx()] == self.n_searches || self.completes(gate) {
                    continue;
                }
                if exit.to == self.goal {
                    return true;
                }
                self.seen[exit.to.idx()] = self.n_searches;
                waiting.push(exit.to);
            }
        }
        false
    }
}
