//! The stab trees of all cells in one graph against the plain tree of each: equal where nothing is cut; where something
//! is, nothing is missing and nothing is cut without need.

use proptest::prelude::*;
use sightlines_cells::{Axial, AxialDoor, BoxCell, CellGraph, CellId, Convex, Plan, Planar, Portal};
use sightlines_geometry::{Aabb, Adaptive, Point2, Portal2};
use sightlines_kdtree::{AxialFace, AxialPortal, KdOptions, subdivide};
use sightlines_pvs::{BitMatrix, StabParts};
use sightlines_scenes::world::{BspWorldOptions, World, bsp_world, world_families};
use sightlines_sightline::{AxialStabber, ConvexStabber, Funnel, Line3, StabLimits, Verdict};
use sightlines_stabtree::{
    ConvexOptions, ConvexSearch, Network, SearchOptions, StabTree, StabTreesOptions, StabTreesSummary, Zones, gate_of,
    planar_visibility, portal_of, stab_trees_axial, stab_trees_convex, stab_trees_planar, visible_zones,
};
use std::cell::Cell;
use std::collections::{BTreeMap, BTreeSet};

const MAX_NODES: usize = 20_000;
/// Budgets that cut, and one that does not.
const BUDGETS: [usize; 6] = [1, 2, 7, 30, 200, MAX_NODES];

type Sequence = Vec<u32>;
/// Sequences of gates out of a cell, the empty one included, and whether others may follow.
type Unfolded = BTreeMap<Sequence, bool>;

fn options(max_nodes: usize, threads: usize) -> StabTreesOptions<'static> {
    StabTreesOptions { max_nodes, threads, ..StabTreesOptions::default() }
}

/// All paths from the roots of a cell.
fn unfold(forest: &StabParts, cell: CellId) -> Unfolded {
    fn list(forest: &StabParts, nodes: &[u32], sequence: &mut Sequence, all: &mut Unfolded) {
        for &node in nodes {
            let node = node as usize;
            sequence.push(forest.gates[node]);
            let old = all.insert(sequence.clone(), forest.open[node]);
            assert_eq!(old, None, "a sequence is one way through the graph");
            let children = &forest.children[forest.first_child[node] as usize..forest.first_child[node + 1] as usize];
            assert!(children.iter().all(|&child| (child as usize) < node), "children come before their parents");
            assert!(children.is_sorted_by(|a, b| a < b), "children ascend");
            list(forest, children, sequence, all);
            sequence.pop();
        }
    }
    let mut all = Unfolded::new();
    all.insert(Vec::new(), forest.root_open[cell.idx()]);
    let roots = forest.first_root[cell.idx()] as usize..forest.first_root[cell.idx() + 1] as usize;
    list(forest, &forest.roots[roots], &mut Vec::new(), &mut all);
    all
}

/// The sequences of a plain tree.
fn plain_sequences<C: sightlines_cells::Space>(
    graph: &CellGraph<C>,
    root: CellId,
    tree: &StabTree,
) -> BTreeSet<Sequence> {
    let sequence = |node: usize| {
        let mut at = root;
        let step = |portal| {
            let exit = graph.exits(at).iter().find(|e| e.portal == portal).expect("the tree goes along exits");
            at = exit.to;
            gate_of(exit)
        };
        tree.portals_to(node).into_iter().map(step).collect::<Sequence>()
    };
    (0..tree.nodes().len()).map(sequence).collect()
}

/// The defect, if any, of an unfolded tree, which may be cut, compared with all sequences that lines pass.
fn defect(cut: &Unfolded, all: &BTreeSet<Sequence>, max_nodes: usize) -> Option<String> {
    let is_covered = |s: &Sequence| (0..=s.len()).any(|n| cut.get(&s[..n]).is_some_and(|&open| open || n == s.len()));
    if let Some(lost) = all.iter().find(|s| !is_covered(s)) {
        return Some(format!("{lost:?} is lost"));
    }
    // The tightness twin: nothing more than there is, open only where something follows, no less than fits.
    if let Some(wrong) = cut.keys().find(|s| !all.contains(*s)) {
        return Some(format!("{wrong:?} is passed by no line"));
    }
    let n_after = |s: &[u32]| all.iter().filter(|t| t.len() == s.len() + 1 && t.starts_with(s)).count();
    let mut overflows = Vec::new();
    for (s, _) in cut.iter().filter(|(_, open)| **open) {
        match n_after(s) {
            0 => return Some(format!("{s:?} is open and nothing follows")),
            n => overflows.push((s.len(), n)),
        }
    }
    let longest = cut.keys().map(Vec::len).max().unwrap_or(0);
    if let Some((at, _)) = overflows.iter().find(|(at, _)| at + 1 < longest) {
        return Some(format!("cut after {at} gates, though there are sequences of {longest}"));
    }
    // What was cut first did not fit: the widest of the shortest cannot have been less.
    let fits = overflows.iter().map(|&(_, n)| n).max().is_some_and(|n| cut.len() + n <= max_nodes);
    (fits || cut.len() > max_nodes).then(|| format!("{} of {max_nodes} nodes, and some were left out", cut.len()))
}

/// What a run of comparisons examined.
#[derive(Debug, Default)]
struct Counts {
    sequences: Cell<u64>,
    cut: Cell<u64>,
    shared: Cell<u64>,
}

impl Counts {
    fn add(&self, summary: &StabTreesSummary, forest: &StabParts) {
        self.sequences.set(self.sequences.get() + summary.n_sequences);
        self.cut.set(self.cut.get() + summary.n_cut_cells);
        self.shared.set(self.shared.get() + summary.n_sequences - forest.gates.len() as u64);
    }
}

/// Compares the graph with plain trees for all budgets. `forest_of` takes a budget and a number of threads.
fn compare(
    plain: &[BTreeSet<Sequence>],
    forest_of: impl Fn(usize, usize) -> (StabParts, StabTreesSummary),
    counts: &Counts,
) -> Result<(), TestCaseError> {
    for max_nodes in BUDGETS {
        let (forest, summary) = forest_of(max_nodes, 1);
        let (mut n_cut, mut n_open, mut n_sequences) = (0, 0, 0);
        for (cell, all) in (0u32..).map(CellId).zip(plain) {
            let cut = unfold(&forest, cell);
            let wrong = defect(&cut, all, max_nodes);
            prop_assert!(wrong.is_none(), "cell {}, {} nodes: {:?}", cell, max_nodes, wrong);
            if all.len() <= max_nodes {
                prop_assert!(cut.keys().eq(all) && cut.values().all(|open| !open), "what fits is whole");
            }
            n_cut += u64::from(cut.values().any(|&open| open));
            n_open += cut.iter().filter(|(s, open)| !s.is_empty() && **open).count() as u64;
            n_sequences += cut.len() as u64 - 1;
        }
        prop_assert_eq!((summary.n_cut_cells, summary.n_open, summary.n_sequences), (n_cut, n_open, n_sequences));
        prop_assert_eq!(&forest_of(max_nodes, 3), &(forest.clone(), summary), "threads change nothing");
        counts.add(&summary, &forest);
    }
    Ok(())
}

/// Walls between points of a small grid, inside a box with room around them.
fn plan() -> impl Strategy<Value = Plan> {
    let point = || (0i32..7, 0i32..7).prop_map(|(x, y)| Point2::new(f64::from(x), f64::from(y)));
    let wall = (point(), point()).prop_filter("walls have two ends", |(a, b)| a != b);
    proptest::collection::vec(wall, 1..7).prop_map(|mut walls| {
        let corners = [(-1., -1.), (7., -1.), (7., 7.), (-1., 7.)].map(|(x, y)| Point2::new(x, y));
        walls.extend((0..4).map(|i| (corners[i], corners[(i + 1) % 4])));
        Plan::from_walls(walls).expect("the walls are valid")
    })
}

fn cut_plan(plan: &Plan) -> CellGraph<Planar> {
    sightlines_triangulation::subdivide(plan).expect("a box has a region").0
}

fn rows_of_plan(graph: &CellGraph<Planar>) -> BitMatrix {
    let options = SearchOptions { threads: 1, ..SearchOptions::default() };
    planar_visibility(graph, &Zones::cells(graph), &options).expect("nobody cancels").0
}

/// The plain trees of all cells; `None` if one is too large to compare.
fn plain_planar(graph: &CellGraph<Planar>) -> Option<Vec<BTreeSet<Sequence>>> {
    let mut funnel = Funnel::new(Adaptive);
    let tree = |cell| {
        let crossing = |e: &_| -> Portal2 { graph.crossing(e) };
        let tree = StabTree::build(graph, cell, &mut funnel, crossing, 1_000).ok()?;
        Some(plain_sequences(graph, cell, &tree))
    };
    graph.cell_ids().map(tree).collect()
}

fn runner() -> (proptest::test_runner::TestRunner, u64) {
    let config =
        ProptestConfig { cases: ProptestConfig::default().cases / 2 + 1, ..ProptestConfig::with_source_file(file!()) };
    let cases = u64::from(config.cases);
    (proptest::test_runner::TestRunner::new(config), cases)
}

/// Invariant: in the plane the graph unfolds to the plain trees, or to what a budget leaves of them.
#[test]
fn plans_unfold_to_plain_trees() {
    let counts = Counts::default();
    let (mut runner, cases) = runner();
    let result = runner.run(&plan(), |plan| {
        let graph = cut_plan(&plan);
        let Some(plain) = plain_planar(&graph) else { return Ok(()) };
        let rows = rows_of_plan(&graph);
        compare(
            &plain,
            |max_nodes, threads| {
                stab_trees_planar(&graph, &rows, &options(max_nodes, threads)).expect("nobody cancels")
            },
            &counts,
        )?;
        // Rows that hide nothing affect only the time.
        let n = graph.n_cells();
        let mut all = BitMatrix::new(n, n);
        (0..n).for_each(|i| (0..n).for_each(|j| all.set(i, j, true)));
        let [narrow, wide] =
            [&rows, &all].map(|rows| stab_trees_planar(&graph, rows, &options(MAX_NODES, 1)).expect("nobody cancels"));
        prop_assert_eq!(narrow, wide);
        Ok(())
    });
    result.unwrap_or_else(|e| panic!("plans_unfold_to_plain_trees: {e}"));
    assert!(
        counts.sequences.get() > 100 * cases && counts.cut.get() > cases && counts.shared.get() > cases,
        "{counts:?}"
    );
}

/// Cuts a cube along faces.
fn cut_cube(faces: &[AxialFace<3>]) -> CellGraph<Axial> {
    let tree =
        subdivide(faces, Aabb { min: [0.0; 3], max: [4.0; 3] }, &KdOptions::default()).expect("the scene is good");
    let cells = tree.cells().iter().map(|cell| BoxCell { bounds: cell.bounds }).collect();
    let portal = |p: &AxialPortal<3>| {
        let axis = p.axis as u8;
        let shape = AxialDoor { extent: Aabb { min: p.min, max: p.max }, axis, forward: true };
        Portal { cells: p.cells, sides: [2 * u32::from(axis) + 1, 2 * u32::from(axis)], shape }
    };
    CellGraph::<Axial>::new(cells, tree.portals().iter().map(portal).collect())
}

fn faces() -> impl Strategy<Value = Vec<AxialFace<3>>> {
    let ends = || prop::array::uniform3(0..=4i32);
    let face = (0..3usize, ends(), ends()).prop_map(|(axis, p, mut q)| {
        q[axis] = p[axis];
        let corner = |pick: fn(i32, i32) -> i32| [0, 1, 2].map(|k| f64::from(pick(p[k], q[k])));
        AxialFace::new(axis, corner(i32::min), corner(i32::max))
    });
    prop::collection::vec(face, 1..5)
}

/// Invariant: the same in space, for boxes.
#[test]
fn boxes_unfold_to_plain_trees() {
    let counts = Counts::default();
    let (mut runner, cases) = runner();
    let result = runner.run(&faces(), |faces| {
        let graph = cut_cube(&faces);
        let mut stabber = AxialStabber::new();
        let tree = |cell| {
            let tree = StabTree::build(&graph, cell, &mut stabber, |e| graph.door(e), 300).ok()?;
            Some(plain_sequences(&graph, cell, &tree))
        };
        let Some(plain) = graph.cell_ids().map(tree).collect::<Option<Vec<_>>>() else { return Ok(()) };
        let network = Network::axial(&graph, &Zones::cells(&graph), &[]);
        let search = SearchOptions { threads: 1, ..SearchOptions::default() };
        let rows = visible_zones(&network, &AxialStabber::new(), &BitMatrix::identity(graph.n_cells()), &search)
            .expect("nobody cancels")
            .zones;
        compare(
            &plain,
            |max_nodes, threads| stab_trees_axial(&graph, &rows, &options(max_nodes, threads)).expect("nobody cancels"),
            &counts,
        )
    });
    result.unwrap_or_else(|e| panic!("boxes_unfold_to_plain_trees: {e}"));
    assert!(counts.sequences.get() > 10 * cases && counts.cut.get() > cases / 2, "{counts:?}");
}

/// The sequences out of a cell that are not proven to be blocked: depth first, each decided from scratch.
fn plain_convex(graph: &CellGraph<Convex>, root: CellId, stabber: &mut ConvexStabber) -> Option<BTreeSet<Sequence>> {
    let shape = |gate: u32| {
        let (portal, forward) = portal_of(gate);
        let shape = &graph.portal(portal).shape;
        if forward { shape.clone() } else { shape.reversed() }
    };
    let mut all = BTreeSet::from([Vec::new()]);
    let mut waiting = vec![(Vec::new(), vec![root], None::<Line3>)];
    while let Some((sequence, met, _)) = waiting.pop() {
        for exit in graph.exits(met[met.len() - 1]).iter().filter(|e| !met.contains(&e.to)) {
            let longer = [&sequence[..], &[gate_of(exit)]].concat();
            let shapes: Vec<_> = longer.iter().map(|&gate| shape(gate)).collect();
            match stabber.stab(&shapes.iter().collect::<Vec<_>>(), None) {
                Verdict::Hidden(_) => continue,
                Verdict::Undecided(_) => return None,
                Verdict::Visible(line) => {
                    all.insert(longer.clone());
                    waiting.push((longer, [&met[..], &[exit.to]].concat(), Some(line)));
                }
            }
            if all.len() > 400 {
                return None;
            }
        }
    }
    Some(all)
}

fn rows_of_world(graph: &CellGraph<Convex>) -> BitMatrix {
    let mut search = ConvexSearch::new(graph, ConvexOptions { threads: 1, ..ConvexOptions::default() });
    while search.advance() {}
    search.finish().cells
}

/// Invariant: the same for convex cells, where every sequence is decided.
#[test]
fn worlds_unfold_to_plain_trees() {
    let counts = Counts::default();
    let random = |seed| -> World {
        let leafs = 6 + seed as u32;
        bsp_world(BspWorldOptions { seed, leafs, solid_percent: 40, tilted_percent: 50 }).expect("options in range")
    };
    let worlds = world_families().into_iter().map(|(_, world)| world).chain((0..12).map(random));
    let mut n_worlds = 0;
    for world in worlds {
        let graph = &world.graph;
        let mut stabber = ConvexStabber::new(StabLimits::default());
        let plain: Option<Vec<_>> = graph.cell_ids().map(|cell| plain_convex(graph, cell, &mut stabber)).collect();
        let Some(plain) = plain else { continue };
        let rows = rows_of_world(graph);
        let forest_of = |max_nodes, threads| {
            stab_trees_convex(graph, &rows, StabLimits::default(), &options(max_nodes, threads))
                .expect("nobody cancels")
        };
        compare(&plain, forest_of, &counts).unwrap_or_else(|e| panic!("world {n_worlds}: {e}"));
        n_worlds += 1;
    }
    assert!(n_worlds > 8 && counts.sequences.get() > 2_000 && counts.cut.get() > 50, "{n_worlds} {counts:?}");
}

/// A plan of a room with four pillars.
fn pillars() -> CellGraph<Planar> {
    let p = Point2::new;
    let corners = [p(0., 0.), p(9., 0.), p(9., 6.), p(0., 6.)];
    let mut walls: Vec<_> = (0..4).map(|i| (corners[i], corners[(i + 1) % 4])).collect();
    walls.extend([(2., 2.), (5., 1.), (3., 4.), (6., 4.)].map(|(x, y)| (p(x, y), p(x + 1., y + 1.))));
    cut_plan(&Plan::from_walls(walls).expect("the walls are valid"))
}

/// The impostors of the comparison: a child removed, a mark removed, a mark too many, a sequence too many.
#[test]
fn damaged_trees_are_noticed() {
    let graph = pillars();
    let plain = plain_planar(&graph).expect("a small plan");
    let (forest, _) = stab_trees_planar(&graph, &rows_of_plan(&graph), &options(MAX_NODES, 1)).expect("nobody cancels");
    let wrong = |forest: &StabParts, max_nodes| {
        let defects = graph.cell_ids().map(|c| defect(&unfold(forest, c), &plain[c.idx()], max_nodes));
        defects.flatten().collect::<Vec<_>>()
    };
    assert_eq!(wrong(&forest, MAX_NODES), Vec::<String>::new());

    let parent = (0..forest.gates.len()).rfind(|&n| forest.first_child[n] < forest.first_child[n + 1]);
    let parent = parent.expect("some sequence has two gates");
    let mut childless = forest.clone();
    childless.children.remove(forest.first_child[parent] as usize);
    childless.first_child[parent + 1..].iter_mut().for_each(|end| *end -= 1);
    assert!(wrong(&childless, MAX_NODES).iter().any(|w| w.ends_with("is lost")));

    let leaf = (0..forest.gates.len()).find(|&n| forest.first_child[n] == forest.first_child[n + 1]);
    let mut too_open = forest.clone();
    too_open.open[leaf.expect("trees have leaves")] = true;
    assert!(wrong(&too_open, MAX_NODES).iter().any(|w| w.ends_with("nothing follows")));

    let mut turned = forest.clone();
    turned.gates[parent] ^= 1;
    assert!(!wrong(&turned, MAX_NODES).is_empty());

    let max_nodes = 3;
    let (cut, summary) =
        stab_trees_planar(&graph, &rows_of_plan(&graph), &options(max_nodes, 1)).expect("nobody cancels");
    assert!(summary.n_cut_cells > 0 && wrong(&cut, max_nodes).is_empty(), "{:?}", wrong(&cut, max_nodes));
    let mut closed = cut.clone();
    closed.open.fill(false);
    closed.root_open.fill(false);
    assert!(wrong(&closed, max_nodes).iter().any(|w| w.ends_with("is lost")));
    // A tree that stops sooner than it has to.
    let (short, _) = stab_trees_planar(&graph, &rows_of_plan(&graph), &options(1, 1)).expect("nobody cancels");
    assert!(wrong(&short, MAX_NODES).iter().any(|w| w.ends_with("left out")));
}
