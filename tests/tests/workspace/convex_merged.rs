//! The search through portals between clusters that are not convex, because leafs were merged. Against the search among the leafs, whose
//! cells are convex: a cluster sees what any of its leafs sees. Inside of a cluster nothing hides, so it may see more; how much is counted,
//! and the checker of explanations, which shares no code with the search, has the last word on it.

use sightlines::bake::quake::bake_map;
use sightlines::bake::{BakedMap, PrtOptions};
use sightlines::cells::{CellGraph, CellId, Convex, Portal3};
use sightlines::formats::quake::prt::{LeafList, parse_prt, write_prt};
use sightlines::formats::quake::{Bsp, BspFormat, Prt};
use sightlines::geometry::Aabb;
use sightlines::pvs::{BitMatrix, Table};
use sightlines::scenes::world::{BspWorldOptions, QuakeLikeOptions, World, bsp_world, quake_like, world_families};
use sightlines::sightline::Verdict;
use sightlines::stabtree::{ConvexExplainer, ConvexOptions, ConvexSearch, check_convex};
use sightlines::verify::{MapTree, Truth, VerifyOptions, verify};
use sightlines_testkit::Random;
use sightlines_tests::merged::{Merged, exact};
use sightlines_tests::world_files::bsp_bytes;

fn random(seed: u64, leafs: u32, tilted_percent: u32) -> World {
    bsp_world(BspWorldOptions { seed, leafs, solid_percent: 45, tilted_percent }).expect("options within their ranges")
}

fn worlds(n_seeds: u64) -> Vec<World> {
    let level = |seed| quake_like(QuakeLikeOptions { seed, rooms_x: 2, rooms_y: 2, floors: 1 }).expect("few rooms");
    let seeds = (0..n_seeds).flat_map(|seed| [random(seed, 30, 0), random(seed, 30, 60), level(seed)]);
    world_families()
        .into_iter()
        .map(|(_, world)| world)
        .chain(seeds)
        .filter(|w| (3..60).contains(&w.graph.n_cells()))
        .collect()
}

fn n_pairs(cells: &BitMatrix) -> usize {
    (0..cells.n_rows()).map(|a| cells.iter_ones(a).filter(|&b| b < a).count()).sum()
}

/// How many pairs of `these` are not in `those`.
fn n_lost(these: &BitMatrix, those: &BitMatrix) -> usize {
    (0..these.n_rows()).map(|a| these.iter_ones(a).filter(|&b| b < a && !those.get(a, b)).count()).sum()
}

/// Nothing is hidden that a leaf sees, whether it is searched for exactly or not; the impostor, which takes clusters for convex, hides some of it.
#[test]
fn clusters_see_what_their_leafs_see() {
    let (mut n_seen, mut n_surplus, mut n_caught, mut n_bent) = (0, 0, 0, 0);
    for (k, world) in worlds(12).iter().enumerate() {
        let leafs = exact(&world.graph);
        for turn in 0..4 {
            let merged = Merged::at_random(&world.graph, &mut Random::new(k as u64, turn), turn % 2 == 0);
            let truth = merged.seen_by_leafs(&leafs);
            let seen = exact(&merged.graph).cells;
            assert_eq!(n_lost(&truth, &seen), 0, "world {k}, turn {turn}");
            let mut fast = ConvexSearch::new(&merged.graph, ConvexOptions { fast: true, threads: 1 });
            fast.run(None).expect("nobody cancels");
            assert_eq!(n_lost(&seen, &fast.finish().cells), 0, "world {k}, turn {turn}");
            n_seen += n_pairs(&truth);
            n_surplus += n_lost(&seen, &truth);
            let impostor = merged.as_if_convex();
            n_bent += usize::from(impostor.portals().len() < merged.graph.portals().len());
            n_caught += usize::from(n_lost(&truth, &exact(&impostor).cells) > 0);
        }
    }
    let counts = format!("{n_seen} pairs, {n_surplus} beyond, {n_bent} with bent clusters, {n_caught} impostors");
    eprintln!("{counts}");
    assert!(n_seen > 20_000 && n_surplus * 20 < n_seen && n_bent > 100 && n_caught > 80, "{counts}");
}

/// Each answer is proven: by a line that meets its portals in order, or by what stops every chain of portals.
#[test]
fn what_clusters_see_is_proven() {
    let (mut n_visible, mut n_hidden, mut n_open) = (0, 0, 0);
    for (k, world) in worlds(4).iter().filter(|world| world.graph.n_cells() < 40).enumerate() {
        for turn in 0..2 {
            let Merged { graph, .. } = Merged::at_random(&world.graph, &mut Random::new(k as u64, turn), turn == 0);
            let (seen, explainer) = (exact(&graph), ConvexExplainer::new(&graph));
            for (a, b) in (0..graph.n_cells() as u32).flat_map(|a| (0..a).map(move |b| (a, b))) {
                let explanation = explainer.explain(CellId(a), CellId(b), 10_000);
                if matches!(explanation, Verdict::Undecided(_)) || seen.undecided.contains(&[b, a]) {
                    n_open += 1;
                    continue;
                }
                let listed = seen.cells.get(a as usize, b as usize);
                assert_eq!(explanation.is_visible(), listed, "world {k}, turn {turn}, clusters {b} and {a}");
                assert!(check_convex(&graph, CellId(a), CellId(b), &explanation), "clusters {b} and {a}");
                (n_visible, n_hidden) = (n_visible + usize::from(listed), n_hidden + usize::from(!listed));
            }
        }
    }
    let counts = format!("{n_visible} visible, {n_hidden} hidden, {n_open} open");
    eprintln!("{counts}");
    assert!(n_visible > 2_500 && n_hidden > 700 && n_open * 50 < n_visible, "{counts}");
}

/// Boxes that make a box: such clusters are convex, and see what their leafs see and no more.
#[test]
fn convex_clusters_see_no_more_than_their_leafs() {
    let (mut n_merged, mut n_seen) = (0, 0);
    for seed in 0..40 {
        let world = random(seed, 40, 0);
        let leafs = world.cells();
        let mut names: Vec<u32> = (0..leafs.len() as u32).collect();
        let volume = |b: &Aabb<3>| (0..3).map(|k| b.max[k] - b.min[k]).product::<f64>();
        let around = |names: &[u32], pair: [u32; 2]| {
            let of = leafs.iter().zip(names).filter(|(_, name)| pair.contains(name)).map(|(leaf, _)| leaf.bounds());
            let parts: Vec<Aabb<3>> = of.collect();
            let whole = parts.iter().fold(Aabb::EMPTY, |b, part| b.with(part.min).with(part.max));
            volume(&whole) == parts.iter().map(volume).sum::<f64>()
        };
        for portal in world.graph.portals() {
            let pair = portal.cells.map(|cell| names[cell.idx()]);
            if pair[0] != pair[1] && around(&names, pair) {
                names.iter_mut().filter(|name| **name == pair[0]).for_each(|name| *name = pair[1]);
                n_merged += 1;
            }
        }
        let merged = Merged::new(&world.graph, &names);
        let seen = exact(&merged.graph);
        assert!(seen.undecided.is_empty(), "seed {seed}");
        assert_eq!(seen.cells, merged.seen_by_leafs(&exact(&world.graph)), "seed {seed}");
        n_seen += n_pairs(&seen.cells);
    }
    assert!(n_merged > 40 && n_seen > 1_000, "{n_merged} merged, {n_seen} pairs");
}

/// A window in the plane `x`, passed towards larger `x`.
fn window(x: f64, [y0, y1]: [f64; 2]) -> Portal3 {
    Portal3::around(&[[x, y0, 0.0], [x, y1, 0.0], [x, y1, 4.0], [x, y0, 4.0]]).expect("a rectangle")
}

fn sees(graph: &CellGraph<Convex>, [a, b]: [usize; 2]) -> bool {
    let seen = exact(graph);
    assert!(seen.undecided.is_empty());
    seen.cells.get(a, b)
}

/// Clusters in a row: 0, then 1 and 2 by turns, then 3. A line from 0 to 3 is twice in each of the two.
#[test]
fn a_line_meets_a_cluster_more_than_once() {
    let row = |ys: [[f64; 2]; 5]| {
        let between = [[0, 1], [1, 2], [2, 1], [1, 2], [2, 3]].map(|pair| pair.map(CellId));
        let windows = (0..5).map(|k| (between[k], window(8.0 * k as f64, ys[k])));
        CellGraph::of_portals(4, windows.collect())
    };
    assert!(sees(&row([[0.0, 4.0]; 5]), [0, 3]));
    // The windows in the middle are beside all lines through the others. Nothing hides inside of a cluster, so they need not be passed.
    let beside = |last: f64| row([[0.0, 4.0], [90.0, 94.0], [0.0, 4.0], [90.0, 94.0], [last, last + 4.0]]);
    assert!(sees(&beside(120.0), [0, 3]) && !sees(&beside(0.0), [0, 3]));
    // A ring around a pillar that can be seen through: 0 is west of it, 3 east.
    let side = |y: f64| Portal3::around(&[[9.0, y, 0.0], [9.0, y, 4.0], [11.0, y, 4.0], [11.0, y, 0.0]]).expect("one");
    let ring =
        [([0, 1], window(0.0, [0.0, 4.0])), ([1, 2], window(9.0, [1.0, 3.0])), ([2, 1], window(11.0, [1.0, 3.0]))];
    let ring = ring.into_iter().chain([([1, 2], side(1.0)), ([2, 1], side(3.0)), ([1, 3], window(20.0, [0.0, 4.0]))]);
    let ring = CellGraph::of_portals(4, ring.map(|(pair, shape)| (pair.map(CellId), shape)).collect());
    assert!((0..4).all(|a| (0..4).all(|b| sees(&ring, [a, b]))));
}

/// The window from 1 to 2 lies behind the one from 0 to 1, and both lead the same way: a line through both was in 2 before it was in 0, and there is a
/// wall between these.
#[test]
fn windows_in_the_wrong_order_show_nothing() {
    let towards = |x: f64| {
        let windows =
            vec![([CellId(0), CellId(1)], window(0.0, [0.0, 4.0])), ([CellId(1), CellId(2)], window(x, [0.0, 4.0]))];
        CellGraph::of_portals(3, windows)
    };
    assert!(!sees(&towards(-8.0), [0, 2]) && sees(&towards(8.0), [0, 2]));
}

/// Maps with such clusters are read, and no ray contradicts the tables that are made of them. Some portals are left out, as at the surface of
/// opaque water: then neighbours are joined in one place and not in another. The impostor hides a pair.
#[test]
fn tables_of_maps_with_merged_clusters_hold() {
    let (mut n_cells, mut n_caught) = (0, 0);
    for seed in 0..6 {
        let level = quake_like(QuakeLikeOptions { seed, rooms_x: 2, rooms_y: 2, floors: 1 }).expect("few rooms");
        let world = if seed % 2 == 0 { level } else { random(seed, 40, 0) };
        let mut random = Random::new(seed, 9);
        let kept = world.graph.portals().iter().filter(|_| random.below(4) > 0).map(|p| (p.cells, p.shape.clone()));
        let kept = CellGraph::of_portals(world.graph.n_cells(), kept.collect());
        let (all, cut) = (world.bounds(), 3.0);
        let place = |b: Aabb<3>, k: usize| ((b.min[k] + b.max[k]) / 2.0 - all.min[k]) / (all.max[k] - all.min[k]) * cut;
        let name = |b: Aabb<3>| (0..3).fold(0, |name, k| 4 * name + place(b, k) as u32);
        let names: Vec<u32> = world.cells().iter().map(|leaf| name(leaf.bounds())).collect();
        let merged = Merged::new(&kept, &names);
        let mut prt = Prt::new(merged.graph.n_cells() as u32).expect("clusters");
        for portal in merged.graph.portals() {
            prt.push_portal(portal.cells.map(|cell| cell.0), portal.shape.corners()).expect("portals of the world");
        }
        let prt = prt.with_leafs(LeafList::PerCluster, merged.of.clone()).expect("each leaf is in a cluster");
        let prt = parse_prt(write_prt(&prt).as_bytes()).expect("corners go round the right way");
        let bsp = Bsp::parse(bsp_bytes(&world, BspFormat::Bsp29)).expect("a map");
        let BakedMap { table, graph, .. } = bake_map(&bsp, &prt, PrtOptions::default()).expect("portals of the map");
        let tree = MapTree::of_map(&bsp, &prt).expect("a map");
        let options = VerifyOptions { rays: 20_000, pairs: 300, segments: 100, ..VerifyOptions::default() };
        let check = |table: &Table| verify(table, &Truth::World(&graph, &tree), &options).expect("nobody cancels");
        let found = check(&table);
        assert!(found.is_true(), "seed {seed}: {:?}", found.violations);
        n_cells += found.n_cells;
        let mut parts = table.into_parts();
        let pair = graph.portals()[0].cells;
        for [a, b] in [pair, [pair[1], pair[0]]] {
            parts.rows.set(a.idx(), b.idx(), false);
        }
        n_caught += usize::from(!check(&Table::new(parts).expect("a symmetric table")).is_true());
    }
    assert!(n_cells > 60 && n_caught == 6, "{n_cells} cells, {n_caught} impostors");
}
