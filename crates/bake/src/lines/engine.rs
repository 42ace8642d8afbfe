//! Explains pairs of cells in whichever kind of graph.

use super::{Obstacle, Pair, SightLine, ends_in_plan};
use crate::graph::TableGraph;
use sightlines_cells::{CellGraph, CellId, Convex, Planar, PortalId};
use sightlines_geometry::Aabb;
use sightlines_sightline::{Branch, Line3, Verdict};
use sightlines_stabtree::{
    AxialExplainer, AxialPath, AxialProof, Barrier, ConvexExplainer, ConvexGate, ConvexPath, ConvexProof, PlanarPath,
    Sight, explain,
};

/// Cells entered in a plan, linear programs in space, and sequences of portals of a Quake map, after which a pair is given up. Fewer than
/// where one pair is asked for alone.
const MAX_VISITS: u64 = 100_000;
const MAX_PROGRAMS: u32 = 2_000;
const MAX_QUESTIONS: u64 = 1_000;

/// The most walls that are named.
const MAX_WALLS: usize = 12;

pub(super) enum Engine<'a> {
    Plan(&'a CellGraph<Planar>),
    Space(AxialExplainer<'a>),
    Convex(&'a CellGraph<Convex>, ConvexExplainer),
}

type Found = Verdict<SightLine, Obstacle, ()>;

impl<'a> Engine<'a> {
    /// None for cells without portals.
    pub(super) fn new(graph: &'a TableGraph) -> Option<Self> {
        match graph {
            TableGraph::Planar(graph) => Some(Self::Plan(graph)),
            // The table does not record what was left out beside its cells, and no answer depends on it.
            TableGraph::Axial(graph) => Some(Self::Space(AxialExplainer::new(graph, &[]))),
            TableGraph::Convex(graph) => Some(Self::Convex(graph, ConvexExplainer::new(graph))),
            TableGraph::Boxes(_) => None,
        }
    }

    pub(super) fn line(&self, pair: Pair) -> Option<SightLine> {
        match self.explain(pair) {
            Verdict::Visible(line) => Some(line),
            _ => None,
        }
    }

    pub(super) fn obstacle(&self, pair: Pair) -> Option<Obstacle> {
        match self.explain(pair) {
            Verdict::Hidden(obstacle) => Some(obstacle),
            _ => None,
        }
    }

    fn explain(&self, pair: Pair) -> Found {
        let [from, to] = pair.map(CellId);
        match self {
            Self::Plan(graph) => found(
                explain(graph, from, to, 1, MAX_VISITS),
                |path| plan_line(graph, [from, to], &path),
                |proof| proof.blocked.into_iter().next().map(|way| Obstacle::Portals(way.portals)),
            ),
            Self::Space(explainer) => {
                let line = |path: AxialPath| Some(space_line(from, path));
                found(explainer.explain(from, to, MAX_PROGRAMS), line, |proof| Some(Obstacle::Walls(walls(&proof))))
            }
            Self::Convex(graph, explainer) => found(
                explainer.explain(from, to, MAX_QUESTIONS),
                |path| Some(convex_line(graph, &path)),
                |proof: ConvexProof| {
                    let first = proof.blocked.into_iter().next()?;
                    Some(Obstacle::Portals(first.gates.iter().map(|gate| gate.portal).collect()))
                },
            ),
        }
    }
}

fn found<Path, Proof, Doubt>(
    explanation: Verdict<Sight<Path>, Barrier<Proof>, Doubt>,
    line: impl FnOnce(Path) -> Option<SightLine>,
    obstacle: impl FnOnce(Proof) -> Option<Obstacle>,
) -> Found {
    match explanation {
        Verdict::Visible(Sight::Along(path)) => line(path).map_or(Verdict::Undecided(()), Verdict::Visible),
        Verdict::Hidden(Barrier::NotConnected) => Verdict::Hidden(Obstacle::NotConnected),
        Verdict::Hidden(Barrier::Blocked(proof)) => obstacle(proof).map_or(Verdict::Undecided(()), Verdict::Hidden),
        Verdict::Visible(Sight::SameCell) | Verdict::Undecided(_) => Verdict::Undecided(()),
    }
}

fn plan_line(graph: &CellGraph<Planar>, [from, to]: [CellId; 2], path: &PlanarPath) -> Option<SightLine> {
    let mut cells = vec![from];
    for portal in &path.portals {
        let [a, b] = graph.portal(*portal).cells;
        cells.push(if cells.last() == Some(&a) { b } else { a });
    }
    let polygons = [from, to].map(|cell| &graph.cell(cell).polygon[..]);
    let ends = ends_in_plan(polygons, &path.doors, &path.witness);
    let ends = ends.map(|ends| ends.map(|p| [p.x, p.y, 0.0]));
    Some(SightLine { cells, portals: path.portals.clone(), ends })
}

fn space_line(from: CellId, path: AxialPath) -> SightLine {
    // Without points in the cells, those in the first and the last portal.
    let crossing = |k: usize| path.witness.crossing(&path.doors[k]);
    let ends = path.ends.or_else(|| Some([crossing(0)?, crossing(path.doors.len() - 1)?]));
    SightLine { cells: std::iter::once(from).chain(path.cells).collect(), portals: path.portals, ends }
}

fn convex_line(graph: &CellGraph<Convex>, ConvexPath { gates, line }: &ConvexPath) -> SightLine {
    let first = gates.iter().take(1).map(|gate| gate.cells(graph)[0]);
    let cells = first.chain(gates.iter().map(|gate| gate.cells(graph)[1])).collect();
    let portals: Vec<PortalId> = gates.iter().map(|gate| gate.portal).collect();
    SightLine { cells, portals, ends: convex_ends(graph, gates, line) }
}

/// A little beyond the first and the last portal: clusters have no points of their own.
fn convex_ends(graph: &CellGraph<Convex>, gates: &[ConvexGate], line: &Line3) -> Option<[[f64; 3]; 2]> {
    let [first, last] = [gates.first()?, gates.last()?].map(|gate| gate.crossing(graph, line));
    let step: [f64; 3] = std::array::from_fn(|k| line.b[k] - line.a[k]);
    let length = step.iter().map(|x| x * x).sum::<f64>().sqrt();
    let size = |gate: &ConvexGate| {
        let shape = &graph.portal(gate.portal).shape;
        let corner = shape.corners().first()?;
        Some(
            shape
                .corners()
                .iter()
                .map(|p| (0..3).map(|k| (p[k] - corner[k]).abs()).fold(0.0, f64::max))
                .fold(0.0, f64::max),
        )
    };
    let beyond = |p: [f64; 3], far: f64| std::array::from_fn(|k| p[k] + far * step[k] / length);
    let ends = [beyond(first, -0.25 * size(gates.first()?)?), beyond(last, 0.25 * size(gates.last()?)?)];
    ends.iter().flatten().all(|x| x.is_finite()).then_some(ends)
}

/// The walls of a proof, those that it goes past most often first.
fn walls(AxialProof { proof, walls, .. }: &AxialProof) -> Vec<Aabb<3>> {
    fn count(branch: &Branch, n: &mut [usize]) {
        if let Branch::Past { rectangle, ways, .. } = branch {
            n[*rectangle as usize] += 1;
            ways.iter().for_each(|(_, branch)| count(branch, n));
        }
    }
    let mut n = vec![0; walls.len()];
    proof.octants.iter().for_each(|(_, branch)| count(branch, &mut n));
    let mut order: Vec<usize> = (0..walls.len()).collect();
    order.sort_by_key(|&k| std::cmp::Reverse(n[k]));
    order.into_iter().take(MAX_WALLS).map(|k| walls[k]).collect()
}
