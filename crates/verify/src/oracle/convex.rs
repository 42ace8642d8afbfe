//! Portals alone: a line sees on through portals, in their order along it.

use super::{RayOracle, Sample, at, dot, extreme, length, scale_of, sub};
use crate::exact::{segment_crosses_polygon, snapped};
use crate::sight::{SightSegment, Target};
use sightlines_cells::{CellGraph, CellId, Convex};
use sightlines_geometry::{Point3, Portal3, Random, orient3d};
use sightlines_pvs::{PortalRecord, Table};

mod thread;

/// The portals of a map, for lines.
#[derive(Debug)]
pub(crate) struct PortalWorld {
    /// For each cell its ways out: where to, and the portal as it is crossed.
    gates: Vec<Vec<Gate>>,
    next: Vec<Vec<u32>>,
    /// How far from the edges of a portal a line has to pass, in scene units, before its slope to the portal is taken into account.
    margin: f64,
    size: f64,
}

#[derive(Debug)]
struct Gate {
    to: u32,
    shape: Portal3,
    /// Of unit length, in the direction of crossing; rounded.
    normal: Point3,
    /// The middle of its corners, and how far the farthest of them is from there; rounded.
    middle: Point3,
    size: f64,
    /// For each edge a corner, and the direction inwards, of unit length; rounded.
    edges: Vec<(Point3, Point3)>,
}

impl Gate {
    fn new(to: CellId, shape: Portal3) -> Self {
        let n = shape.normal();
        let largest = scale_of(n);
        let n = n.map(|x| x / largest);
        let normal = n.map(|x| x / length(n));
        let middle = crate::shapes::middle(shape.corners());
        let size = shape.corners().iter().map(|&p| length(sub(p, middle))).fold(0.0, f64::max);
        // Inwards from an edge that goes round counter-clockwise about the direction of crossing.
        let inwards = |[a, b]: [Point3; 2]| {
            let e = sub(b, a);
            let n = normal;
            let across = [n[1] * e[2] - n[2] * e[1], n[2] * e[0] - n[0] * e[2], n[0] * e[1] - n[1] * e[0]];
            (a, across.map(|x| x / length(e)))
        };
        let edges = shape.edges().map(inwards).collect();
        Self { to: to.0, normal, middle, size, edges, shape }
    }
}

/// More portals are not passed by one line.
const LONGEST: usize = 4096;

impl PortalWorld {
    pub(crate) fn new(graph: &CellGraph<Convex>) -> Self {
        let mut gates: Vec<Vec<Gate>> = (0..graph.n_cells()).map(|_| Vec::new()).collect();
        for portal in graph.portals() {
            let [a, b] = portal.cells;
            gates[a.idx()].push(Gate::new(b, portal.shape.clone()));
            gates[b.idx()].push(Gate::new(a, portal.shape.reversed()));
        }
        let next = gates
            .iter()
            .map(|list| {
                let mut next: Vec<u32> = list.iter().map(|g| g.to).collect();
                next.sort_unstable();
                next.dedup();
                next
            })
            .collect();
        let shapes = || graph.portals().iter().map(|p| &p.shape);
        let scale = scale_of(shapes().flat_map(|s| s.corners().iter().flatten().copied()));
        let uneven = shapes().map(Portal3::unevenness).fold(0.0, f64::max);
        // Portals of files are uneven by rounding, and corners nearer to a portal's plane than 2^-44 of the largest
        // coordinate count as on it (ARCHITECTURE, 'What holds'). Four times that is clear of it.
        let margin = 4.0 * uneven.max(scale * 2f64.powi(-44));
        Self { gates, next, margin, size: 4.0 * scale }
    }

    /// Where the line `p + t d` passes a gate in its direction, as `t`; `None` if it does not, or is near an edge.
    ///
    /// Seen against the plane the line is as steep as its cosine says, so a corner that is off by some height is off by that divided by
    /// the cosine where the line is.
    fn pass(&self, gate: &Gate, p: Point3, d: Point3) -> Option<f64> {
        let corner = gate.shape.corners()[0];
        let along = dot(gate.normal, d);
        let cosine = along / length(d);
        if cosine <= 0.0 {
            return None;
        }
        let t = dot(gate.normal, sub(corner, p)) / along;
        let (q, margin) = (at(p, d, t), self.margin / cosine);
        let far = at(p, d, t + 1.0);
        let clear = gate.edges.iter().all(|(a, inwards)| dot(*inwards, sub(q, *a)) > margin)
            && gate.shape.edges().all(|[a, b]| orient3d(p, far, a, b) != 0.0);
        clear.then_some(t)
    }

    /// Whether the line `p + t d` passes a gate from one cell into another, clear of its edges, with `t` in a range.
    pub(super) fn joins(&self, [from, to]: [u32; 2], p: Point3, d: Point3, [low, high]: [f64; 2]) -> bool {
        let passes = |gate: &Gate| self.pass(gate, p, d).is_some_and(|t| low <= t && t <= high);
        self.gates[from as usize].iter().any(|gate| gate.to == to && passes(gate))
    }

    /// Follows a line from a cell through gates behind `p`; `visit` gets each cell with the points where the line
    /// enters and leaves it, and returns whether to continue.
    fn follow(&self, from: u32, p: Point3, d: Point3, mut visit: impl FnMut(u32, f64, Option<f64>) -> bool) {
        let (mut cell, mut enters) = (from, 0.0);
        for _ in 0..LONGEST {
            let passed = self.gates[cell as usize].iter().filter_map(|g| Some((self.pass(g, p, d)?, g.to)));
            let first = passed.filter(|&(t, _)| t > enters).min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            if !visit(cell, enters, first.map(|(t, _)| t)) {
                return;
            }
            let Some((t, to)) = first else { return };
            (cell, enters) = (to, t);
        }
    }

    /// A line from a cell, through a random point of one of its gates and a point of a gate of the next cell or a random one.
    fn line(&self, from: u32, random: &mut Random) -> Option<[Point3; 2]> {
        let list = &self.gates[from as usize];
        let first = list.get(random.below(list.len()))?;
        let on = of_portal(&first.shape, random);
        let behind = &self.gates[first.to as usize];
        let towards = match random.below(3) {
            0 => at(on, random.direction(), 1.0),
            _ => of_portal(&behind.get(random.below(behind.len()))?.shape, random),
        };
        let d = sub(towards, on);
        let d = if dot(d, first.normal) < 0.0 { d.map(|x| -x) } else { d };
        // A little before the gate, which is where the cell is.
        let n = length(d);
        (n > 0.0).then(|| [at(on, d, -1.0 / n), at(on, d, 1.0 / n)])
    }
}

/// A random point of a portal.
fn of_portal(shape: &Portal3, random: &mut Random) -> Point3 {
    let corners = shape.corners();
    let k = 1 + random.below(corners.len() - 2);
    let [a, b, c] = [corners[0], corners[k], corners[k + 1]];
    let (u, v) = (extreme(random), extreme(random));
    let (u, v) = (u.min(v), 1.0 - u.max(v));
    std::array::from_fn(|i| a[i] + (b[i] - a[i]) * u + (c[i] - a[i]) * v)
}

impl RayOracle for PortalWorld {
    const CELLS_ARE_CONVEX: bool = false;

    fn shoot(&self, from: u32, random: &mut Random, visit: &mut dyn FnMut(SightSegment)) -> Option<()> {
        let [p, q] = self.line(from, random)?;
        let d = sub(q, p);
        self.follow(from, p, d, |cell, enters, leaves| {
            if cell != from {
                let t = leaves.map_or(enters + 1.0, |leaves| 0.5 * (enters + leaves));
                let segment = [p, at(p, d, t)].map(snapped);
                visit(SightSegment { from: CellId(from), target: Target::Cell(CellId(cell)), segment });
            }
            true
        });
        Some(())
    }

    fn proves(&self, sight: &SightSegment) -> bool {
        let ([p, q], Target::Cell(to)) = (sight.segment, sight.target) else { return false };
        let mut arrives = false;
        self.follow(sight.from.0, p, sub(q, p), |cell, enters, _| {
            arrives |= cell == to.0 && enters < 1.0;
            !arrives && enters < 1.0
        });
        p != q && arrives
    }

    /// Lines through a gate out of the one cell and a gate into the other, of which the farthest is moved on.
    fn aim(&self, table: &Table, from: u32, target: Target, tries: u32, random: &mut Random) -> Option<SightSegment> {
        let Target::Cell(to) = target else { return None };
        let leads = |cell: u32, other: CellId| {
            let list = self.gates[cell as usize].iter();
            list.filter(|g| table.sees(CellId(g.to), other)).map(|g| &g.shape).collect::<Vec<_>>()
        };
        let (out, into) = (leads(from, to), leads(to.0, CellId(from)));
        if out.is_empty() || into.is_empty() {
            return None;
        }
        if let Some(sight) = self.through_sequences(table, from, to.0, tries, random) {
            return Some(sight);
        }
        let mut best: (f64, Option<[Point3; 2]>) = (0.0, None);
        for _ in 0..tries {
            let [a, b] = match best.1 {
                Some(ends) if random.below(3) > 0 => {
                    let step = self.size * 2f64.powi(-(4 + random.below(24) as i32));
                    ends.map(|p| at(p, random.direction(), step * random.unit()))
                }
                _ => [&out, &into].map(|list| of_portal(list[random.below(list.len())], random)),
            };
            let n = length(sub(b, a));
            if n <= 0.0 {
                continue;
            }
            let (p, q) = (at(a, sub(b, a), -1.0 / n), at(b, sub(b, a), 1.0 / n));
            let mut reached = 0.0;
            let mut there = None;
            self.follow(from, p, sub(q, p), |cell, enters, leaves| {
                reached = leaves.unwrap_or(enters);
                if cell == to.0 {
                    there = Some(leaves.map_or(enters + 1.0, |leaves| 0.5 * (enters + leaves)));
                }
                there.is_none() && enters < 2.0
            });
            if let Some(t) = there {
                let segment = [p, at(p, sub(q, p), t)].map(snapped);
                let sight = SightSegment { from: CellId(from), target, segment };
                if self.proves(&sight) {
                    return Some(sight);
                }
            }
            if reached >= best.0 {
                best = (reached, Some([a, b]));
            }
        }
        None
    }

    const SAMPLES: [bool; 2] = [false, false];

    /// Nothing: clusters that are known by their portals have no places.
    fn sample(&self, _: u32, _: Target, _: &mut Random, _: &dyn Fn(&SightSegment) -> bool) -> Sample {
        Sample::Nowhere
    }

    fn neighbours(&self) -> &[Vec<u32>] {
        &self.next
    }

    fn misses(&self, _: &PortalRecord, _: [Point3; 2]) -> bool {
        // Portals of files are uneven, and lines pass beside them.
        false
    }

    fn crosses(&self, portal: &PortalRecord, [p, q]: [Point3; 2]) -> bool {
        segment_crosses_polygon(p, q, &portal.points)
    }
}
