//! Worlds in which a search through convex portals once hid what can be seen, each with its line.

use sightlines::cells::{CellGraph, CellId, Convex, Portal3};
use sightlines::formats::quake::graph_of_prt;
use sightlines::formats::quake::prt::parse_prt;
use sightlines::scenes::world::{QuakeLikeOptions, quake_like};
use sightlines::sightline::{Line3, Verdict, convex};
use sightlines::stabtree::{ConvexOptions, ConvexSearch, ConvexVisibility};

/// A cut leaves a speck of a portal; a later beam through the whole of it is not within that speck.
const WITHIN: &str = "\
PRT1\n\
5\n\
5\n\
4 4 3 (4 30 8 ) (4 34 8 ) (4 34 24 ) (4 30 24 )\n\
3 4 3 (4 22 8 ) (4 30 24 ) (4 22 24 )\n\
4 1 2 (1 31 8 ) (1.5 32 8 ) (2 31 8 ) (1.5 30 8 )\n\
3 1 4 (2 30 8 ) (2 38 8 ) (2 38 8.000244140625 )\n\
3 3 0 (5 22 16 ) (5 30 16 ) (5 30 16.00048828125 )\n";

/// Two gates that straddle each other's planes can be passed in either order; what is proven for one order does not
/// hold for the other.
const SWAPPED: &str = "\
PRT1\n\
19\n\
24\n\
3 0 1 (-400 -600 -300 ) (-400 300 -300 ) (-400 -312 323 )\n\
4 1 2 (-200 -200 -300 ) (-200 0 -300 ) (-200 0 -1 ) (-200 -200 -1 )\n\
4 1 9 (-200 -200 11 ) (-200 0 11 ) (-200 0 500 ) (-200 -200 500 )\n\
4 1 2 (-200 0 -300 ) (-200 200 -300 ) (-200 200 -1 ) (-200 0 -1 )\n\
4 2 3 (-200 -200 -1 ) (0 -200 -1 ) (0 0 -1 ) (-200 0 -1 )\n\
4 3 4 (0 -10 -1 ) (0 10 -1 ) (0 10 1 ) (0 -10 1 )\n\
4 4 5 (0 -200 1 ) (200 -200 1 ) (200 0 1 ) (0 0 1 )\n\
4 5 7 (0 -200 9 ) (200 -200 9 ) (200 0 9 ) (0 0 9 )\n\
4 7 8 (-10 0 9 ) (-10 0 11 ) (60 0 11 ) (60 0 9 )\n\
4 8 10 (30 0 11 ) (200 0 11 ) (200 200 11 ) (30 200 11 )\n\
4 9 7 (-20 0 11 ) (0 0 11 ) (0 -20 11 ) (-20 -20 11 )\n\
4 8 6 (-12 12 9 ) (0 12 9 ) (0 0 9 ) (-12 0 9 )\n\
4 6 3 (-12 12 1 ) (0 12 1 ) (0 0 1 ) (-12 0 1 )\n\
4 4 11 (0 15 -1 ) (5 15 -1 ) (5 0 -1 ) (0 0 -1 )\n\
4 10 12 (200 0 11 ) (200 100 11 ) (200 100 300 ) (200 0 300 )\n\
4 11 12 (200 0 -600 ) (200 450 -600 ) (200 450 -1 ) (200 0 -1 )\n\
4 10 12 (200 100 11 ) (200 200 11 ) (200 200 300 ) (200 100 300 )\n\
4 12 13 (200 -300 20 ) (200 -210 20 ) (200 -210 0 ) (200 -300 0 )\n\
4 12 14 (200 -300 40 ) (200 -210 40 ) (200 -210 20 ) (200 -300 20 )\n\
4 12 15 (200 -300 60 ) (200 -210 60 ) (200 -210 40 ) (200 -300 40 )\n\
4 12 16 (200 -300 80 ) (200 -210 80 ) (200 -210 60 ) (200 -300 60 )\n\
4 2 17 (-160 200 -200 ) (-160 200 -100 ) (-110 200 -100 ) (-110 200 -200 )\n\
4 17 18 (400 2500 -200 ) (400 3000 -200 ) (400 3000 -100 ) (400 2500 -100 )\n\
3 12 18 (400 -300 28 ) (400 326 -321 ) (400 600 28 )\n";

fn graph(text: &str) -> CellGraph<Convex> {
    graph_of_prt(&parse_prt(text.as_bytes()).expect("a portal file"))
}

fn exact(graph: &CellGraph<Convex>) -> ConvexVisibility {
    let mut search = ConvexSearch::new(graph, ConvexOptions::default());
    while search.advance() {}
    search.finish()
}

/// The portals between cells that follow each other, as seen by who passes them.
fn chain(graph: &CellGraph<Convex>, cells: &[u32]) -> Vec<Portal3> {
    let portal = |pair: &[u32]| {
        let mut exits = graph.exits(CellId(pair[0])).iter();
        let exit = exits.find(|exit| exit.to == CellId(pair[1])).expect("neighbours");
        let shape = &graph.portal(exit.portal).shape;
        if exit.forward { shape.clone() } else { shape.reversed() }
    };
    cells.windows(2).map(portal).collect()
}

#[test]
fn a_beam_is_not_within_a_speck() {
    let graph = graph(WITHIN);
    let way = chain(&graph, &[2, 1, 4, 3, 0]);
    let Verdict::Visible(line) = convex::stab(&way.iter().collect::<Vec<_>>()) else { panic!("no line") };
    assert!(way.iter().all(|portal| line.passes(portal)));
    assert!(exact(&graph).cells.get(0, 2));
}

#[test]
fn what_is_proven_for_gates_in_order_is_used_in_order() {
    let graph = graph(SWAPPED);
    let line = Line3::through([-9.9814, 0.0094, 9.0], [2.4869, 9.9515, -1.0]).expect("two points");
    let passed = graph.portals().iter().filter(|p| line.passes(&p.shape) || line.passes(&p.shape.reversed()));
    assert!(passed.count() >= 7, "the line passes many portals");
    // As numbered, and numbered otherwise: the order in which ways are tried is another each time.
    for turn in 0..24u32 {
        let number = |cell: CellId| CellId((cell.0 * 7 + turn) % 19);
        let portals = graph.portals().iter().map(|p| (p.cells.map(number), p.shape.clone())).collect();
        let seen = exact(&CellGraph::of_portals(19, portals));
        let [home, goal] = [0, 18].map(|cell| number(CellId(cell)).0 as usize);
        assert!(seen.cells.get(home, goal), "turn {turn}");
    }
}

/// A portal far away makes coordinates large, but nothing near by hidden.
#[test]
fn what_is_far_away_hides_nothing() {
    let world = quake_like(QuakeLikeOptions::default()).expect("default options");
    let before = exact(&world.graph);
    let n = world.graph.n_cells();
    for far in [1e6, 1e10, 1e14] {
        let corner = |y: f64, z: f64| [far, y, z];
        let stray = Portal3::around(&[corner(0.0, 0.0), corner(8.0, 0.0), corner(8.0, 8.0)]).expect("a triangle");
        let mut portals: Vec<_> = world.graph.portals().iter().map(|p| (p.cells, p.shape.clone())).collect();
        portals.push(([CellId(n as u32), CellId(n as u32 + 1)], stray));
        let after = exact(&CellGraph::of_portals(n + 2, portals));
        let hidden = (0..n).flat_map(|a| before.cells.iter_ones(a).map(move |b| (a, b)));
        let undecided = |a: usize, b: usize| before.undecided.contains(&[a.min(b) as u32, a.max(b) as u32]);
        let lost: Vec<_> = hidden.filter(|&(a, b)| !after.cells.get(a, b) && !undecided(a, b)).collect();
        assert!(lost.is_empty(), "{far}: {lost:?}");
    }
}
