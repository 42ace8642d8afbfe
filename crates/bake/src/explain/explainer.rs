//! The searches behind explanations, one for each kind of graph.

use super::ExplainOptions;
use super::answer::{Answer, BlockedWay, Blocks, Corner, ExactLine, Explanation, Reason, SightLine, Way, lifted};
use super::ends::{ends_in_plan, ends_of_gates};
use crate::graph::{GraphKind, GraphRef};
use sightlines_cells::{CellGraph, CellId, Convex, Planar, PortalId};
use sightlines_geometry::Portal2;
use sightlines_sightline::{End, Verdict};
use sightlines_stabtree::{
    AxialExplainer, AxialPath, Barrier, BlockedSequence, ConvexDoubt, ConvexExplainer, ConvexGate, ConvexPath,
    ConvexProof, PlanarPath, PlanarProof, SearchLimit, Sight, check_convex, explain,
};

/// Explains pairs of cells that portals join.
#[derive(Debug)]
pub struct Explainer<'a>(Search<'a>);

#[derive(Debug)]
enum Search<'a> {
    Planar(&'a CellGraph<Planar>),
    Axial(AxialExplainer<'a>),
    Convex(&'a CellGraph<Convex>, ConvexExplainer),
}

impl<'a> Explainer<'a> {
    /// For the cells of a graph; `None` for cells without portals. O(portals log portals).
    pub fn new(graph: impl Into<GraphRef<'a>>) -> Option<Self> {
        Some(Self(match graph.into() {
            GraphRef::Planar(graph) => Search::Planar(graph),
            // A table does not record what was left out beside its cells, and no answer depends on it.
            GraphRef::Axial(graph) => Search::Axial(AxialExplainer::new(graph, &[])),
            GraphRef::Convex(graph) => Search::Convex(graph, ConvexExplainer::new(graph)),
            GraphRef::Boxes(_) => return None,
        }))
    }

    /// Why the first cell sees the second, or not: [`explain`](super::explain) documents it. Depends on nothing that was asked before.
    ///
    /// # Panics
    /// If there are no such cells.
    pub fn explain(&self, pair: [CellId; 2], options: &ExplainOptions) -> Explanation {
        let [from, to] = pair;
        let mut checked = None;
        let (cells, answer) = match &self.0 {
            Search::Planar(graph) => {
                let found = explain(graph, from, to, options.max_blocked, options.max_visits);
                let reason = |PlanarProof { n_blocked, blocked }| {
                    let blocked = blocked.iter().map(|way| blocked_in_plan(graph, from, way)).collect();
                    Reason::Blocked { start: from, n_blocked, blocked }
                };
                (GraphKind::Planar, answer(found, |path| in_plan(graph, pair, path), reason, given_up))
            }
            Search::Axial(explainer) => {
                let found = explainer.explain(from, to, options.max_programs);
                (GraphKind::Axial, answer(found, |path| in_space(from, path), Reason::Walls, given_up))
            }
            Search::Convex(graph, explainer) => {
                let found = explainer.explain(from, to, options.max_questions);
                checked = options.check.then(|| check_convex(graph, from, to, &found));
                let reason = |ConvexProof { start, blocked }| {
                    let n_blocked = blocked.len() as u64;
                    let blocked = blocked.into_iter().take(options.max_blocked).map(|blocked| BlockedWay {
                        way: way_of_gates(graph, &blocked.gates),
                        proof: Blocks::Convex(blocked.reason),
                    });
                    Reason::Blocked { start, n_blocked, blocked: blocked.collect() }
                };
                let doubt = |doubt| match doubt {
                    ConvexDoubt::Limit(limit) => given_up(limit),
                    ConvexDoubt::Chain(gates) => Answer::Undecided(way_of_gates(graph, &gates)),
                };
                (GraphKind::Convex, answer(found, |path| between_clusters(graph, &path), reason, doubt))
            }
        };
        Explanation { cells, answer, checked }
    }
}

const fn given_up(SearchLimit(limit): SearchLimit) -> Answer {
    Answer::GivenUp(limit)
}

fn answer<Path, Proof, Doubt>(
    found: Verdict<Sight<Path>, Barrier<Proof>, Doubt>,
    line: impl FnOnce(Path) -> Answer,
    reason: impl FnOnce(Proof) -> Reason,
    doubt: impl FnOnce(Doubt) -> Answer,
) -> Answer {
    match found {
        Verdict::Visible(Sight::SameCell) => Answer::Same,
        Verdict::Visible(Sight::Along(path)) => line(path),
        Verdict::Hidden(Barrier::NotConnected) => Answer::Hidden(Reason::NotConnected),
        Verdict::Hidden(Barrier::Blocked(proof)) => Answer::Hidden(reason(proof)),
        Verdict::Undecided(why) => doubt(why),
    }
}

/// The first cell and those behind portals.
fn passed(from: CellId, behind: impl IntoIterator<Item = CellId>) -> Vec<CellId> {
    std::iter::once(from).chain(behind).collect()
}

/// The cells that are entered by going from `from` through `portals`, and the portals as they are crossed.
fn walk(graph: &CellGraph<Planar>, from: CellId, portals: &[PortalId]) -> (Vec<CellId>, Vec<Portal2>) {
    let mut here = from;
    let step = |id: &PortalId| {
        let portal = graph.portal(*id);
        let forward = portal.cells[0] == here;
        here = portal.cells[usize::from(forward)];
        (here, if forward { portal.shape } else { portal.shape.reversed() })
    };
    portals.iter().map(step).unzip()
}

fn in_plan(graph: &CellGraph<Planar>, pair: [CellId; 2], path: PlanarPath) -> Answer {
    let PlanarPath { portals, doors, witness } = path;
    let cells = passed(pair[0], walk(graph, pair[0], &portals).0);
    let ends = ends_in_plan(pair.map(|cell| &graph.cell(cell).polygon[..]), &doors, &witness);
    let line = SightLine { cells, portals, ends: ends.map(|ends| ends.map(lifted)) };
    Answer::Visible(line, ExactLine::Planar(witness, doors))
}

fn blocked_in_plan(graph: &CellGraph<Planar>, from: CellId, sequence: &BlockedSequence) -> BlockedWay {
    let BlockedSequence { portals, certificate } = sequence;
    let (cells, doors) = walk(graph, from, portals);
    let corner = |end: &End| {
        let door = doors[end.portal];
        Corner { portal: portals[end.portal], point: if end.left { door.left } else { door.right } }
    };
    let [lefts, rights] = [&certificate.lefts, &certificate.rights].map(|ends| ends.iter().map(corner).collect());
    BlockedWay { way: Way { portals: portals.clone(), cells }, proof: Blocks::Corners { lefts, rights } }
}

fn in_space(from: CellId, path: AxialPath) -> Answer {
    let AxialPath { portals, cells, doors, witness, ends } = path;
    let line = SightLine { cells: passed(from, cells), portals, ends };
    Answer::Visible(line, ExactLine::Axial(witness, doors))
}

fn way_of_gates(graph: &CellGraph<Convex>, gates: &[ConvexGate]) -> Way {
    let (portals, cells) = gates.iter().map(|gate| (gate.portal, gate.cells(graph)[1])).unzip();
    Way { portals, cells }
}

fn between_clusters(graph: &CellGraph<Convex>, ConvexPath { gates, line }: &ConvexPath) -> Answer {
    let Way { portals, cells } = way_of_gates(graph, gates);
    let from = gates[0].cells(graph)[0];
    let sight = SightLine { cells: passed(from, cells), portals, ends: ends_of_gates(graph, gates, line) };
    let crossings = gates.iter().map(|gate| gate.crossing(graph, line)).collect();
    Answer::Visible(sight, ExactLine::Convex([line.a, line.b], crossings))
}
