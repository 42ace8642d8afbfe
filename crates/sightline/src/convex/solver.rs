//! The decision for one sequence: lines by turns, the relaxed program, boxes cut in two.

use super::ConvexVerdict;
use super::certificate::{BoxProof, ConvexCertificate, ConvexNode};
use super::chart::{Chart, Plate};
use super::counters::ConvexStabberCounters;
use super::fine::{self, Fine, FineLine3};
use super::hull::{self, N_HULL};
use super::line::Line3;
use super::planes::stopping;
use super::rows::{self, Edge, on_box, range};
use super::simplex::Program;
use super::vector::{along, dot};
use super::verify::{named, refutes};
use super::witness::alternate;
use crate::{LimitReached, Verdict};
use sightlines_geometry::Portal3;

/// A bound on the margin, in units of the chart, below which a box is refuted without seeking the least bound.
const CLEARLY_HIDDEN: f64 = -1e-6;
/// A bound on the margin below which cutting is given up: what is left is within the rounding of checks.
const WITHIN_ROUNDING: f64 = 1e-11;
/// Largest number of portals of a sequence among which planes are sought.
const MOST_SUSPECTS: usize = 12;
/// Number of pairs of portals that are tried in numbers of two doubles. In maps the first decides three quarters of what is
/// decided so, and those after the twelfth a hundredth.
const MOST_CHARTS: usize = 12;
/// The range of places, from 0 to 1 across a box, at which it is cut.
const CUT: [f64; 2] = [0.2, 0.8];

/// Limits on the effort of one query.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StabLimits {
    /// Boxes of lines after which it is given up; each takes one program of nine unknowns.
    pub boxes: u32,
    /// Turns for one line, each a program of three unknowns.
    pub turns: u32,
}

impl Default for StabLimits {
    fn default() -> Self {
        Self { boxes: 200, turns: 8 }
    }
}

/// A part of all lines that is not refuted yet.
#[derive(Debug, Clone, Copy)]
struct Part {
    low: [f64; 4],
    high: [f64; 4],
    /// No line of the part has a larger margin, up to rounding.
    bound: f64,
    /// The relaxed line: u, v, s, t and products, in coordinates of the part.
    relaxed: [f64; 8],
    /// Its node of the certificate.
    node: usize,
}

impl Part {
    /// The coordinates of the relaxed line in the chart.
    fn relaxed_line(&self) -> [f64; 4] {
        [0, 1, 2, 3].map(|i| self.low[i] + (self.high[i] - self.low[i]) * self.relaxed[i].clamp(0.0, 1.0))
    }

    /// Where to cut it: an axis of the product that is relaxed most, near the relaxed line.
    fn cut(&self, chart: &Chart) -> (usize, f64) {
        let length = |i: usize| {
            let edge = chart.blocks[i / 2].edges[i % 2];
            dot(edge, edge).sqrt() * (self.high[i] - self.low[i])
        };
        let x = &self.relaxed;
        let mut worst = (f64::NEG_INFINITY, 0, 2);
        for (k, (i, j)) in [(0, 2), (0, 3), (1, 2), (1, 3)].into_iter().enumerate() {
            let gap = ((x[4 + k] - x[i] * x[j]).abs() + 1e-9) * length(i) * length(j);
            if gap > worst.0 {
                worst = (gap, i, j);
            }
        }
        let (_, i, j) = worst;
        let axis = if length(i) >= length(j) { i } else { j };
        let at = self.low[axis] + (self.high[axis] - self.low[axis]) * x[axis].clamp(CUT[0], CUT[1]);
        (axis, at)
    }
}

/// A convex polygon with what the solver needs of it, found once: for portals that many sequences pass.
#[derive(Debug, Clone)]
pub struct KnownPortal {
    shape: Portal3,
    /// `None` if it has no extent.
    plate: Option<Plate>,
}

impl KnownPortal {
    /// Cost: O(corners).
    pub fn new(shape: Portal3) -> Self {
        Self { plate: Plate::around(&shape), shape }
    }

    /// The polygon.
    pub const fn shape(&self) -> &Portal3 {
        &self.shape
    }
}

/// Decides about sequences of convex polygons. Holds scratch memory; use one for each thread.
#[derive(Debug, Clone)]
pub struct ConvexStabber {
    limits: StabLimits,
    counters: ConvexStabberCounters,
    plates: Vec<Plate>,
    edges: Vec<Edge>,
    /// Edges of the program's rows after those of the hull.
    kept: Vec<usize>,
    support: Vec<(usize, f64)>,
    wide: Program<9>,
    narrow: Program<3>,
}

impl ConvexStabber {
    /// A solver with limits for each query.
    pub fn new(limits: StabLimits) -> Self {
        Self {
            limits,
            counters: ConvexStabberCounters::default(),
            plates: Vec::new(),
            edges: Vec::new(),
            kept: Vec::new(),
            support: Vec::new(),
            wide: Program::new(),
            narrow: Program::new(),
        }
    }

    /// Work counts since this was created.
    pub const fn counters(&self) -> ConvexStabberCounters {
        self.counters
    }

    /// Whether an open set of directed lines passes `portals` in order.
    ///
    /// * `portals`: in one common frame, scene units, as a chain of convex cells gives them; coordinates
    ///   that [`check_coordinate`](sightlines_geometry::check_coordinate) accepts.
    /// * `hint`: a line that may pass, or nearly does.
    /// * Returns a line that passes, verified exactly; or a certificate that none does, verified with
    ///   bounds on rounding; or that neither was found. The answer depends on nothing but the arguments
    ///   and the limits.
    ///
    /// Cost: some programs with a row for each edge; see the [module](super).
    pub fn stab(&mut self, portals: &[&Portal3], hint: Option<&Line3>) -> ConvexVerdict {
        self.stab_by(portals, hint, |portal| Plate::around(portals[portal]))
    }

    /// The same answer as [`stab`](Self::stab), a little sooner.
    pub fn stab_known(&mut self, portals: &[&KnownPortal], hint: Option<&Line3>) -> ConvexVerdict {
        let shapes: Vec<&Portal3> = portals.iter().map(|portal| portal.shape()).collect();
        self.stab_by(&shapes, hint, |portal| portals[portal].plate)
    }

    /// Decides sequences that [`stab`](Self::stab) leaves open because of rounding: a line in numbers of two doubles that passes,
    /// or a certificate that none does, both checked exactly; or that neither was found.
    ///
    /// Cost: some tenths of a millisecond for each of at most twelve pairs of portals. Meant for what was left open only.
    pub fn stab_finely(&mut self, portals: &[&Portal3]) -> Verdict<FineLine3, ConvexCertificate, LimitReached> {
        self.counters.n_finely += 1;
        self.plates.clear();
        self.plates.extend(portals.iter().map_while(|portal| Plate::around(portal)));
        if self.plates.len() < portals.len() {
            return Verdict::Undecided(LimitReached);
        }
        for pair in Chart::several(&self.plates, MOST_CHARTS) {
            let chart = Chart::between(&self.plates, pair, true);
            rows::edges(portals, &chart, &mut self.edges);
            match fine::decide(portals, pair, &self.edges) {
                Some(Fine::Open(line)) => {
                    self.counters.n_by_fine += 1;
                    return Verdict::Visible(line);
                }
                Some(Fine::Blocked(proof)) => {
                    self.counters.n_hidden_fine += 1;
                    return Verdict::Hidden(ConvexCertificate::Hulls(proof));
                }
                None => {}
            }
        }
        Verdict::Undecided(LimitReached)
    }

    fn stab_by(
        &mut self,
        portals: &[&Portal3],
        hint: Option<&Line3>,
        plate: impl Fn(usize) -> Option<Plate>,
    ) -> ConvexVerdict {
        self.counters.n_asked += 1;
        if let Some(line) = hint.filter(|line| passes(line, portals)) {
            self.counters.n_by_hint += 1;
            return Verdict::Visible(*line);
        }
        if let [portal] = portals
            && let Some(line) = across(portal)
        {
            self.counters.n_by_turns += 1;
            return Verdict::Visible(line);
        }
        self.plates.clear();
        self.plates.extend((0..portals.len()).map_while(plate));
        let chart = if self.plates.len() == portals.len() { Chart::best(&self.plates) } else { None };
        let answer = chart.and_then(|chart| self.decide(&chart, portals, hint));
        answer.unwrap_or_else(|| {
            self.counters.n_undecided += 1;
            Verdict::Undecided(LimitReached)
        })
    }

    fn decide(&mut self, chart: &Chart, portals: &[&Portal3], hint: Option<&Line3>) -> Option<ConvexVerdict> {
        rows::edges(portals, chart, &mut self.edges);
        let start = hint.map_or([0.5, 0.5], |line| chart.coordinates(line.a, line.b));
        if let Some(line) = self.by_turns(chart, portals, start) {
            self.counters.n_by_turns += 1;
            return Some(Verdict::Visible(line));
        }
        let mut proof =
            BoxProof { portals: chart.portals, blocks: chart.blocks, nodes: vec![ConvexNode::Leaf(Vec::new())] };
        let Some(whole) = self.refute(chart, [0.0; 4], [1.0; 4], 0, &mut proof.nodes) else {
            if self.wide.support().all(|(k, _)| k >= N_HULL) {
                self.counters.n_hidden_free += 1;
            } else {
                self.counters.n_hidden_bounded += 1;
            }
            return Some(Verdict::Hidden(ConvexCertificate::Boxes(proof)));
        };
        let at = whole.relaxed_line();
        if let Some(line) = self.by_turns(chart, portals, [at[0], at[1]]) {
            self.counters.n_by_relaxed += 1;
            return Some(Verdict::Visible(line));
        }
        if self.limits.boxes <= 1 {
            return None;
        }
        if let Some(plane) = stopping(portals, &self.suspects(chart, portals.len())) {
            self.counters.n_hidden_plane += 1;
            return Some(Verdict::Hidden(ConvexCertificate::Plane(plane)));
        }
        self.cut(chart, portals, whole, proof)
    }

    /// Branch and bound, the part with the largest bound first.
    fn cut(&mut self, chart: &Chart, portals: &[&Portal3], whole: Part, mut proof: BoxProof) -> Option<ConvexVerdict> {
        let mut open = vec![whole];
        let mut boxes = 1;
        while let Some(best) = (0..open.len()).max_by(|&i, &j| open[i].bound.total_cmp(&open[j].bound).then(j.cmp(&i)))
        {
            let part = open.swap_remove(best);
            if boxes + 2 > self.limits.boxes || part.bound < WITHIN_ROUNDING {
                return None;
            }
            boxes += 2;
            let (axis, at) = part.cut(chart);
            if !(part.low[axis] < at && at < part.high[axis]) {
                return None;
            }
            let first = proof.nodes.len();
            proof.nodes[part.node] = ConvexNode::Split { axis: axis as u8, at, parts: [first, first + 1] };
            proof.nodes.extend([ConvexNode::Leaf(Vec::new()), ConvexNode::Leaf(Vec::new())]);
            for side in 0..2 {
                let (mut low, mut high) = (part.low, part.high);
                if side == 0 {
                    high[axis] = at;
                } else {
                    low[axis] = at;
                }
                let Some(part) = self.refute(chart, low, high, first + side, &mut proof.nodes) else { continue };
                let at = part.relaxed_line();
                if let Some(line) = self.by_turns(chart, portals, [at[0], at[1]]) {
                    self.counters.n_by_cutting += 1;
                    return Some(Verdict::Visible(line));
                }
                open.push(part);
            }
        }
        self.counters.n_hidden_cut += 1;
        Some(Verdict::Hidden(ConvexCertificate::Boxes(proof)))
    }

    /// Solves the relaxed program of a box and fills its leaf if that refutes it; else the part.
    fn refute(
        &mut self,
        chart: &Chart,
        low: [f64; 4],
        high: [f64; 4],
        node: usize,
        nodes: &mut [ConvexNode],
    ) -> Option<Part> {
        self.counters.n_boxes += 1;
        hull::start(&mut self.wide);
        self.kept.clear();
        for (k, edge) in self.edges.iter().enumerate() {
            let c = on_box(&edge.row, &low, &high);
            if range(&c)[0] <= 0.0 {
                self.wide.push([-c[1], -c[2], -c[3], -c[4], -c[5], -c[6], -c[7], -c[8], 1.0], c[0]);
                self.kept.push(k);
            }
        }
        let mut enough = CLEARLY_HIDDEN;
        loop {
            let (y, pivots) = self.wide.solve(enough);
            self.counters.n_programs += 1;
            self.counters.n_pivots += pivots;
            let bound = y[8];
            if bound < 0.0 && chart.apart {
                self.support.clear();
                self.support.extend(self.wide.support().filter(|(k, _)| *k >= N_HULL));
                let terms = || {
                    self.support.iter().map(|&(k, weight)| {
                        let edge = &self.edges[self.kept[k - N_HULL]];
                        (edge, weight * edge.scale)
                    })
                };
                if refutes(chart, [&low, &high], terms()) {
                    nodes[node] = ConvexNode::Leaf(named(terms()));
                    return None;
                }
                if enough > f64::NEG_INFINITY {
                    enough = f64::NEG_INFINITY;
                    continue;
                }
            }
            let relaxed = std::array::from_fn(|i| y[i]);
            return Some(Part { low, high, bound, relaxed, node });
        }
    }

    /// The portals with weights in the last relaxed program, and those of the chart; all portals if they are few.
    /// Ascending.
    fn suspects(&self, chart: &Chart, n_portals: usize) -> Vec<usize> {
        if n_portals <= MOST_SUSPECTS {
            return (0..n_portals).collect();
        }
        let rows = self.wide.support().filter(|(k, _)| *k >= N_HULL);
        let named = rows.map(|(k, _)| self.edges[self.kept[k - N_HULL]].portal);
        let mut suspects: Vec<usize> = named.chain(chart.portals).collect();
        suspects.sort_unstable();
        suspects.dedup();
        suspects
    }

    fn by_turns(&mut self, chart: &Chart, portals: &[&Portal3], start: [f64; 2]) -> Option<Line3> {
        let mut found = None;
        let mut counts = [0; 2];
        alternate(&self.edges, start, self.limits.turns, &mut self.narrow, &mut counts, |turn| {
            let [a, b] = chart.points(&turn.at);
            found = Line3::through(a, b).filter(|line| passes(line, portals));
            found.is_some()
        });
        self.counters.n_programs += counts[0];
        self.counters.n_pivots += counts[1];
        found
    }
}

fn passes(line: &Line3, portals: &[&Portal3]) -> bool {
    portals.iter().all(|portal| line.passes(portal))
}

/// A line through the middle of a single portal.
fn across(portal: &Portal3) -> Option<Line3> {
    let n = portal.corners().len() as f64;
    let middle = [0, 1, 2].map(|i| portal.corners().iter().map(|p| p[i]).sum::<f64>() / n);
    let normal = portal.normal();
    let by = 1.0 / dot(normal, normal).sqrt().sqrt();
    Line3::through(along(middle, normal, -by), along(middle, normal, by)).filter(|line| line.passes(portal))
}
