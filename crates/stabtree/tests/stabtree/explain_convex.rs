//! Explanations for convex cells: they agree with the search, and the checker accepts them, but no damaged ones.

use sightlines_cells::{CellGraph, CellId, Convex, Portal3};
use sightlines_scenes::world::{
    BspWorldOptions, QuakeLikeOptions, World, bsp_world, corridor, corridor_sees, quake_like, world_families,
};
use sightlines_sightline::{BoxProof, ConvexCertificate, ConvexNode, Line3, Verdict};
use sightlines_stabtree::{
    Barrier, BlockedConvex, Blocking, ConvexDoubt, ConvexExplainer, ConvexExplanation, ConvexOptions, ConvexPath,
    ConvexProof, ConvexSearch, ConvexVisibility, MOST_EXPLAINED, SearchLimit, Sight, check_convex, explain_convex,
};
use sightlines_testkit::convex::seen_by_rays;

fn searched(graph: &CellGraph<Convex>) -> ConvexVisibility {
    let mut search = ConvexSearch::new(graph, ConvexOptions { threads: 1, ..ConvexOptions::default() });
    while search.advance() {}
    search.finish()
}

fn random(seed: u64, leafs: u32, tilted_percent: u32) -> World {
    bsp_world(BspWorldOptions { seed, leafs, solid_percent: 45, tilted_percent }).expect("options within their ranges")
}

fn pairs(n: usize) -> impl Iterator<Item = [CellId; 2]> {
    let n = u32::try_from(n).expect("ids have 32 bits");
    (0..n).flat_map(move |a| (0..n).filter(move |&b| a != b).map(move |b| [CellId(a), CellId(b)]))
}

/// Counts of the explanations.
#[derive(Debug, Default)]
struct Counts {
    visible: usize,
    hidden: usize,
    undecided: usize,
    lists: usize,
}

/// Explains every pair of a world and compares with the table of the search.
fn explain_all(name: &str, graph: &CellGraph<Convex>, counts: &mut Counts) {
    let seen = searched(graph);
    let explainer = ConvexExplainer::new(graph);
    for [a, b] in pairs(graph.n_cells()) {
        let listed = seen.cells.get(a.idx(), b.idx());
        let open = seen.undecided.contains(&[a.0.min(b.0), a.0.max(b.0)]);
        let explanation = explainer.explain(a, b, MOST_EXPLAINED);
        let holds = check_convex(graph, a, b, &explanation);
        match &explanation {
            Verdict::Visible(Sight::Along(ConvexPath { gates, .. })) => {
                assert!(listed && holds, "{name}: {a} {b}, {listed} {open} {holds}: {explanation:?}");
                assert_eq!((gates[0].cells(graph)[0], gates[gates.len() - 1].cells(graph)[1]), (a, b), "{name}");
                counts.visible += 1;
            }
            Verdict::Hidden(barrier) => {
                assert!((!listed || open) && holds, "{name}: {a} {b}, {listed} {open} {holds}: {explanation:?}");
                counts.hidden += 1;
                if let Barrier::Blocked(ConvexProof { blocked, .. }) = barrier {
                    counts.lists += blocked.len();
                }
            }
            Verdict::Undecided(ConvexDoubt::Chain(_)) => {
                assert!(listed && !holds, "{name}: {a} {b}, {listed} {open}: {explanation:?}");
                counts.undecided += 1;
            }
            other => panic!("{name}: {a} {b}: {other:?}"),
        }
    }
}

#[test]
fn explanations_say_what_the_search_says() {
    let mut counts = Counts::default();
    for (name, world) in world_families() {
        explain_all(name, &world.graph, &mut counts);
    }
    for seed in 0..6 {
        explain_all("random", &random(seed, 30, 60).graph, &mut counts);
        explain_all("axial", &random(seed, 30, 0).graph, &mut counts);
        explain_all("noise", &random(seed, 20, 60).jittered(seed, 1e-13).graph, &mut counts);
    }
    let level = quake_like(QuakeLikeOptions { seed: 1, rooms_x: 2, rooms_y: 1, floors: 1 }).expect("few rooms");
    explain_all("level", &level.graph, &mut counts);
    assert!(counts.visible > 2000 && counts.hidden > 1000 && counts.lists > 1000, "{counts:?}");
    // Where lines graze, pairs may stay undecided.
    assert!(counts.undecided * 50 < counts.visible + counts.hidden, "{counts:?}");
}

/// The answer for corridors is known without any search.
#[test]
fn corridors_are_explained_as_is_known() {
    let (mut n_hidden, mut n_visible) = (0, 0);
    for (bends, width) in [([2, 0], 5), ([1, 2], 7), ([3, 1], 9), ([1, 0], 17)] {
        let world = corridor(8, bends, width).expect("a short corridor");
        let places: Vec<u32> = world.cells().iter().map(|leaf| (leaf.bounds().max[0] / 32.0) as u32).collect();
        for [a, b] in pairs(places.len()) {
            let known = corridor_sees(bends, width, [a, b].map(|cell| places[cell.idx()]));
            let explanation = explain_convex(&world.graph, a, b, 1000);
            assert!(check_convex(&world.graph, a, b, &explanation), "{bends:?} {width}: {explanation:?}");
            assert_eq!(explanation.is_visible(), known, "{bends:?} {width}");
            n_visible += usize::from(known);
            n_hidden += usize::from(!known);
        }
    }
    assert!(n_hidden > 30 && n_visible > 60, "{n_hidden} {n_visible}");
}

/// Lines shot through solid leafs follow no portals: what they prove visible is never explained as hidden.
#[test]
fn nothing_that_lines_show_is_explained_away() {
    let mut n_seen = 0;
    for seed in 0..4 {
        let world = random(seed, 30, 60);
        for [a, b] in seen_by_rays(&world, 2000, seed).pairs {
            let explanation = explain_convex(&world.graph, CellId(a), CellId(b), MOST_EXPLAINED);
            assert!(explanation.is_visible(), "seed {seed}: {a} {b}");
            n_seen += 1;
        }
    }
    assert!(n_seen > 200, "{n_seen}");
}

/// The impostors: an explanation with any part removed or changed is refused.
#[test]
fn damaged_explanations_are_refused() {
    let bent = |bends, width| corridor(9, bends, width).expect("a short corridor");
    let worlds = [random(3, 30, 60), random(1, 25, 60), bent([3, 1], 9), bent([1, 2], 7), bent([1, 0], 5)];
    let (mut n_lines, mut n_lists, mut n_certificates, mut n_spare, mut n_lazy, mut n_needed) = (0, 0, 0, 0, 0, 0);
    let pairs = worlds.iter().flat_map(|world| pairs(world.graph.n_cells()).map(move |pair| (&world.graph, pair)));
    for (graph, [a, b]) in pairs {
        let explanation = explain_convex(graph, a, b, MOST_EXPLAINED);
        let refused = |damaged: &ConvexExplanation| !check_convex(graph, a, b, damaged);
        let proof = |start, blocked| Verdict::Hidden(Barrier::Blocked(ConvexProof { start, blocked }));
        match &explanation {
            Verdict::Visible(Sight::Along(ConvexPath { gates, line })) => {
                let with = |gates: &[_], line: Line3| {
                    Verdict::Visible(Sight::Along(ConvexPath { gates: gates.to_vec(), line }))
                };
                assert!(refused(&with(gates, line.reversed())));
                let far = [line.a, line.b].map(|p| [p[0] + 1e4, p[1] - 1e4, p[2] + 3e4]);
                assert!(refused(&with(gates, Line3 { a: far[0], b: far[1] })), "a line moved");
                assert!(refused(&with(&gates[1..], *line)) && refused(&with(&gates[..gates.len() - 1], *line)));
                let mut other = gates.clone();
                other[0].forward = !other[0].forward;
                assert!(refused(&with(&other, *line)));
                other[0].portal.0 = u32::MAX;
                assert!(refused(&with(&other, *line)), "a portal that is not there");
                let there_and_back = [&gates[..], &[other[0]], &gates[..]].concat();
                assert!(refused(&with(&there_and_back, *line)));
                assert!(!check_convex(graph, a, a, &explanation) && !check_convex(graph, b, a, &explanation));
                n_lines += 1;
            }
            Verdict::Hidden(Barrier::Blocked(ConvexProof { start, blocked })) => {
                let with = |blocked: Vec<BlockedConvex>| proof(*start, blocked);
                assert!(refused(&with(Vec::new())), "all lists dropped");
                assert!(refused(&Verdict::Hidden(Barrier::NotConnected)), "portals join them");
                let mut less = blocked.clone();
                while !refused(&with(less.clone())) {
                    less.pop();
                    n_spare += 1;
                }
                n_lists += blocked.len();
                for k in 0..blocked.len() {
                    let mut changed = blocked.clone();
                    changed[k].gates[0].forward = !changed[k].gates[0].forward;
                    let mut without = blocked.clone();
                    without.remove(k);
                    // A plane stops lines both ways, but the chains of this list are no longer stopped.
                    let is_spare = !refused(&with(without));
                    assert!(is_spare || refused(&with(changed)), "a list of other gates");
                    n_needed += usize::from(!is_spare);
                    let mut shorter = blocked.clone();
                    shorter[k].gates.pop();
                    assert!(refused(&with(shorter)), "a list without its last gate");
                    let mut empty = blocked.clone();
                    empty[k].gates.clear();
                    assert!(refused(&with(empty)));
                    let mut weaker = blocked.clone();
                    if let Blocking::Certificate(certificate) = &mut weaker[k].reason
                        && let ConvexCertificate::Boxes(BoxProof { nodes, .. }) = &mut **certificate
                    {
                        let leaf = nodes.iter_mut().rev().find_map(|node| match node {
                            ConvexNode::Leaf(terms) => Some(terms),
                            ConvexNode::Split { .. } => None,
                        });
                        leaf.expect("a proof ends in a leaf").clear();
                        assert!(refused(&with(weaker)), "a certificate without its sum");
                        n_certificates += 1;
                    }
                    let mut lazy = blocked.clone();
                    if !matches!(lazy[k].reason, Blocking::Behind) && lazy[k].gates.len() > 2 {
                        lazy[k].reason = Blocking::Behind;
                        assert!(refused(&with(lazy)), "more than two gates are not behind each other");
                        n_lazy += 1;
                    }
                }
                let nowhere = proof(CellId(u32::MAX), blocked.clone());
                assert!(refused(&nowhere) && !check_convex(graph, a, CellId(u32::MAX), &explanation));
            }
            Verdict::Hidden(Barrier::NotConnected) => {}
            other => panic!("{other:?}"),
        }
        // No empty proof explains a visible pair as hidden.
        if explanation.is_visible() {
            assert!(refused(&proof(a, Vec::new())) && refused(&Verdict::Hidden(Barrier::NotConnected)));
        }
    }
    let counts = format!("{n_lines} {n_lists} {n_certificates} {n_lazy} {n_spare} {n_needed}");
    assert!(n_lines > 100 && n_lists > 500 && n_certificates > 100 && n_lazy > 50 && n_needed > 200, "{counts}");
    // Few lists are superfluous.
    assert!(n_spare * 2 < n_lists, "{counts}");
}

/// Two portals of a cell side by side: no line enters by one and leaves by the other. The impostors: for a portal that is
/// tilted, or ahead, this is refused.
#[test]
fn portals_side_by_side_block() {
    let door = |y: f64, tilt: f64| {
        Portal3::around(&[[0.0, y, 0.0], [tilt, y + 1.0, 0.0], [tilt, y + 1.0, 1.0], [0.0, y, 1.0]]).expect("a door")
    };
    let graph = |tilt: f64| {
        let doors = vec![([CellId(0), CellId(1)], door(0.0, 0.0)), ([CellId(2), CellId(1)], door(5.0, tilt))];
        CellGraph::of_portals(3, doors)
    };
    let flat = graph(0.0);
    let explanation = explain_convex(&flat, CellId(0), CellId(2), 100);
    let Verdict::Hidden(Barrier::Blocked(ConvexProof { blocked, .. })) = &explanation else {
        panic!("{explanation:?}")
    };
    assert!(blocked.len() == 1 && blocked[0].reason == Blocking::Behind, "{blocked:?}");
    assert!(check_convex(&flat, CellId(0), CellId(2), &explanation));
    // A tilt within rounding is accepted; a larger one is not.
    let checks = [1e-14, 1e-9, 0.5].map(|tilt| check_convex(&graph(tilt), CellId(0), CellId(2), &explanation));
    assert_eq!(checks, [true, false, false]);
    let other = explain_convex(&graph(0.5), CellId(0), CellId(2), 100);
    assert!(check_convex(&graph(0.5), CellId(0), CellId(2), &other), "{other:?}");
}

#[test]
fn limits_are_reported() {
    let world = random(2, 40, 60);
    let graph = &world.graph;
    let mut n_given_up = 0;
    for [a, b] in pairs(graph.n_cells()) {
        let full = explain_convex(graph, a, b, MOST_EXPLAINED);
        for limit in [0, 3, 80] {
            match explain_convex(graph, a, b, limit) {
                Verdict::Undecided(ConvexDoubt::Limit(SearchLimit(reported))) => {
                    assert_eq!(reported, limit);
                    n_given_up += 1;
                }
                // A lower limit gives no other answer.
                other => assert_eq!(std::mem::discriminant(&other), std::mem::discriminant(&full)),
            }
        }
        assert!(!check_convex(graph, a, b, &Verdict::Undecided(ConvexDoubt::Limit(SearchLimit(3)))));
    }
    assert!(n_given_up > 100, "{n_given_up}");
    let same: ConvexExplanation = Verdict::Visible(Sight::SameCell);
    assert_eq!(explain_convex(graph, CellId(1), CellId(1), 0), same);
    assert!(check_convex(graph, CellId(1), CellId(1), &same));
    assert!(!check_convex(graph, CellId(1), CellId(2), &same));
}

/// A row of ten thousand cells: the depth of the search uses no stack.
#[test]
fn long_chains_need_no_stack() {
    let n = 10_000u32;
    let square = |k: u32| {
        let x = f64::from(k);
        Portal3::around(&[[x, 0.0, 0.0], [x, 1.0, 0.0], [x, 1.0, 1.0], [x, 0.0, 1.0]]).expect("a square")
    };
    let doors = (1..n).map(|k| ([CellId(k - 1), CellId(k)], square(k))).collect();
    let graph = CellGraph::of_portals(n as usize, doors);
    let explanation = explain_convex(&graph, CellId(0), CellId(n - 1), 100_000);
    assert!(check_convex(&graph, CellId(0), CellId(n - 1), &explanation));
    let Verdict::Visible(Sight::Along(ConvexPath { gates, .. })) = explanation else { panic!("{explanation:?}") };
    assert_eq!(gates.len(), n as usize - 1);
}
