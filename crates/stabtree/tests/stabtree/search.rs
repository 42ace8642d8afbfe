//! The search against full enumeration, and the funnel against convex hulls on every sequence that
//! enumeration meets.

use proptest::prelude::*;
use sightlines_cells::{CellGraph, Exit, Plan, Planar};
use sightlines_geometry::{Aabb, Adaptive, Point2, Portal2, orient2d};
use sightlines_pvs::BitMatrix;
use sightlines_sightline::{Funnel, FunnelUndo, PlanarCertificate, PlanarVerdict, PlanarWitness, Stabber, Verdict};
use sightlines_stabtree::{
    Barrier, Network, PlanarPath, PlanarProof, SearchLimit, SearchOptions, Sight, StabTree, Zones, explain,
    planar_visibility, visible_zones,
};
use std::cell::Cell;
use std::convert::Infallible;

const MAX_NODES: usize = 20_000;

/// Walls between points of a small grid, inside a box with room around them.
fn plan() -> impl Strategy<Value = Plan> {
    let point = || (0i32..9, 0i32..9).prop_map(|(x, y)| Point2::new(f64::from(x), f64::from(y)));
    let wall = (point(), point()).prop_filter("walls have two ends", |(a, b)| a != b);
    proptest::collection::vec(wall, 1..10).prop_map(|mut walls| {
        let corners = [(-1., -1.), (9., -1.), (9., 9.), (-1., 9.)].map(|(x, y)| Point2::new(x, y));
        walls.extend((0..4).map(|i| (corners[i], corners[(i + 1) % 4])));
        Plan::from_walls(walls).expect("the walls are valid")
    })
}

fn cut(plan: &Plan) -> CellGraph<Planar> {
    let (graph, _) = sightlines_triangulation::subdivide(plan).expect("a box has a region");
    graph.assert_well_formed();
    graph
}

/// The funnel, with every answer compared with whether the hulls of the ends meet.
#[derive(Clone)]
struct Checked {
    funnel: Funnel<Adaptive>,
    doors: Vec<Portal2>,
    pushes: u64,
}

impl Stabber for Checked {
    type Portal = Portal2;
    type Bounds = Aabb<2>;
    type Undo = FunnelUndo;
    type Line = PlanarWitness;
    type Proof = PlanarCertificate;
    type Doubt = Infallible;

    fn start(&mut self, portal: Portal2) {
        self.doors = vec![portal];
        self.funnel.start(portal);
    }

    fn push(&mut self, portal: Portal2) -> Option<FunnelUndo> {
        self.doors.push(portal);
        self.pushes += 1;
        let undo = self.funnel.push(portal);
        let certificate = PlanarCertificate::find(&self.doors);
        assert_eq!(undo.is_some(), certificate.is_none(), "{:?}", self.doors);
        match certificate {
            Some(certificate) => {
                assert!(certificate.holds(&self.doors), "{certificate:?} of {:?}", self.doors);
                self.doors.pop();
            }
            None => {
                let witness = self.funnel.witness();
                assert!(self.doors.iter().all(|&d| witness.passes(d)), "{:?}", self.doors);
            }
        }
        undo
    }

    fn undo(&mut self, undo: FunnelUndo) {
        self.doors.pop();
        self.funnel.undo(undo);
    }

    fn may_meet(&self, bounds: &Aabb<2>) -> bool {
        self.funnel.may_meet(bounds)
    }

    fn in_front(&self, portal: &Portal2, bounds: &Aabb<2>) -> bool {
        self.funnel.in_front(portal, bounds)
    }

    fn line(&mut self) -> Option<PlanarWitness> {
        self.funnel.line()
    }

    fn decide(&mut self, portals: &[Portal2]) -> PlanarVerdict {
        self.funnel.decide(portals)
    }
}

/// Visibility by full enumeration; `None` if a tree is too large to enumerate.
fn enumerate<S: Stabber<Portal = Portal2>>(graph: &CellGraph<Planar>, stabber: &mut S) -> Option<BitMatrix> {
    let mut rows = BitMatrix::new(graph.n_cells(), graph.n_cells());
    for cell in graph.cell_ids() {
        let crossing = |e: &Exit| graph.crossing(e);
        let tree = StabTree::build(graph, cell, stabber, crossing, MAX_NODES).ok()?;
        for seen in tree.cells() {
            rows.set(cell.idx(), seen.idx(), true);
        }
    }
    Some(rows)
}

fn search(graph: &CellGraph<Planar>, threads: usize, chords: u32) -> BitMatrix {
    let options = SearchOptions { threads, chords, ..SearchOptions::default() };
    planar_visibility(graph, &Zones::cells(graph), &options).expect("nobody cancels").0
}

proptest! {
    /// Invariant: on sequences from cells, the funnel is passable if and only if the hulls are apart.
    #[test]
    fn funnel_agrees_with_hulls_on_every_sequence(plan in plan()) {
        let graph = cut(&plan);
        let mut checked = Checked { funnel: Funnel::new(Adaptive), doors: vec![], pushes: 0 };
        let rows = enumerate(&graph, &mut checked);
        prop_assume!(rows.is_some());
        prop_assert!(rows.unwrap().is_symmetric());
    }

    /// Invariant: pruning, chords, threads and the predicate change nothing.
    #[test]
    fn search_equals_enumeration(plan in plan()) {
        let graph = cut(&plan);
        let Some(all) = enumerate(&graph, &mut Funnel::new(Adaptive)) else { return Ok(()) };
        for (threads, chords) in [(1, 0), (1, 8), (2, 0), (3, 2)] {
            prop_assert_eq!(&search(&graph, threads, chords), &all, "{} threads, {} chords", threads, chords);
        }
        let zones = Zones::cells(&graph);
        let options = SearchOptions { threads: 1, ..SearchOptions::default() };
        let network = Network::planar(&graph, &zones);
        // With no known pair, and with all of them.
        for known in [&BitMatrix::identity(graph.n_cells()), &all] {
            let seen = visible_zones(&network, &Funnel::new(Adaptive), known, &options).expect("nobody cancels");
            prop_assert_eq!(&seen.zones, &all);
        }
    }

    /// Invariant: an explanation agrees with the table, and proves it.
    #[test]
    fn explanations_agree_with_the_search(plan in plan()) {
        let graph = cut(&plan);
        let rows = search(&graph, 1, 8);
        for a in graph.cell_ids() {
            for b in graph.cell_ids() {
                match explain(&graph, a, b, 3, 100_000) {
                    Verdict::Visible(Sight::SameCell) => prop_assert_eq!(a, b),
                    Verdict::Visible(Sight::Along(PlanarPath { portals, doors, witness })) => {
                        prop_assert!(rows.get(a.idx(), b.idx()), "{} sees {}", a, b);
                        prop_assert_eq!(portals.len(), doors.len());
                        prop_assert!(doors.iter().all(|&d| witness.passes(d)));
                    }
                    Verdict::Hidden(Barrier::NotConnected) => {
                        prop_assert!(!rows.get(a.idx(), b.idx()), "{} does not see {}", a, b);
                    }
                    Verdict::Hidden(Barrier::Blocked(PlanarProof { n_blocked, blocked })) => {
                        prop_assert!(!rows.get(a.idx(), b.idx()), "{} does not see {}", a, b);
                        prop_assert_eq!(n_blocked > 0, !blocked.is_empty());
                    }
                    Verdict::Undecided(SearchLimit(limit)) => prop_assert_eq!(limit, 100_000),
                }
            }
        }
    }
}

/// A stabber that treats every tie as closed, as a careless funnel would.
#[derive(Clone)]
struct CarelessTies {
    funnel: Funnel<Adaptive>,
    misses: std::rc::Rc<Cell<u64>>,
}

impl CarelessTies {
    fn tie(&self, portal: Portal2) -> bool {
        let (a, b) = self.funnel.clockwise_limit();
        let (c, d) = self.funnel.counter_clockwise_limit();
        orient2d(a, b, portal.left) == 0.0 || orient2d(c, d, portal.right) == 0.0
    }
}

/// The impostor of the comparison with hulls: careless ties lose sequences on a plain plan.
#[test]
fn careless_ties_lose_open_sequences() {
    let p = Point2::new;
    let mut walls = vec![];
    let corners = [p(0., 0.), p(8., 0.), p(8., 8.), p(0., 8.)];
    walls.extend((0..4).map(|i| (corners[i], corners[(i + 1) % 4])));
    for (x, y) in [(2., 2.), (4., 4.), (6., 2.), (2., 6.), (5., 5.)] {
        walls.push((p(x, y), p(x + 1., y)));
        walls.push((p(x, y), p(x, y + 1.)));
    }
    let graph = cut(&Plan::from_walls(walls).unwrap());
    let misses = std::rc::Rc::new(Cell::new(0));
    let mut careless = CarelessTies { funnel: Funnel::new(Adaptive), misses: misses.clone() };
    for cell in graph.cell_ids() {
        walk(&graph, cell, &mut careless);
    }
    assert!(misses.get() > 0, "no sequence was lost, so the comparison could not fail");
}

/// Walks all passable sequences and counts those that a careless funnel would have refused.
fn walk(graph: &CellGraph<Planar>, cell: sightlines_cells::CellId, careless: &mut CarelessTies) {
    fn deeper(graph: &CellGraph<Planar>, at: &Exit, careless: &mut CarelessTies, depth: u32) {
        for exit in graph.exits(at.to).iter().filter(|e| e.side != at.entry_side) {
            let portal = graph.crossing(exit);
            let tie = careless.tie(portal);
            if let Some(undo) = careless.funnel.push(portal) {
                careless.misses.set(careless.misses.get() + u64::from(tie));
                if depth < 12 {
                    deeper(graph, exit, careless, depth + 1);
                }
                careless.funnel.undo(undo);
            }
        }
    }
    for exit in graph.exits(cell) {
        careless.funnel.start(graph.crossing(exit));
        deeper(graph, exit, careless, 0);
    }
}

/// The impostor of the comparison with enumeration: a row with one pair removed differs.
#[test]
fn a_removed_pair_is_noticed() {
    let p = Point2::new;
    let corners = [p(0., 0.), p(9., 0.), p(9., 4.), p(0., 4.)];
    let mut walls: Vec<_> = (0..4).map(|i| (corners[i], corners[(i + 1) % 4])).collect();
    walls.push((p(4., 0.), p(5., 3.)));
    let graph = cut(&Plan::from_walls(walls).unwrap());
    let all = enumerate(&graph, &mut Funnel::new(Adaptive)).unwrap();
    let mut rows = search(&graph, 1, 8);
    assert_eq!(rows, all);
    let (a, b) = (0..graph.n_cells())
        .flat_map(|a| (0..a).map(move |b| (a, b)))
        .find(|&(a, b)| rows.get(a, b))
        .expect("some pair sees each other");
    rows.set(a, b, false);
    assert_ne!(rows, all);
    assert!(!rows.is_symmetric());
}
