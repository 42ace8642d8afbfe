//! The search through convex portals in generated worlds, against what follows no portals: lines shot at what is
//! solid, sections of what is solid, and corridors whose answer is known.

use sightlines::pvs::{BitMatrix, CellId};
use sightlines::scenes::world::{
    BspWorldOptions, QuakeLikeOptions, World, bsp_world, corridor, corridor_sees, quake_like, world_families,
};
use sightlines::stabtree::{ConvexOptions, ConvexSearch, ConvexVisibility};
use sightlines_testkit::convex::{Sight, seen_by_rays, sight_by_solids};

fn search(world: &World, options: ConvexOptions) -> ConvexVisibility {
    let mut search = ConvexSearch::new(&world.graph, options);
    while search.advance() {}
    search.finish()
}

fn exact(world: &World) -> ConvexVisibility {
    search(world, ConvexOptions::default())
}

fn random(seed: u64, leafs: u32, tilted_percent: u32) -> World {
    bsp_world(BspWorldOptions { seed, leafs, solid_percent: 45, tilted_percent }).expect("options within their ranges")
}

fn pairs(n: usize) -> impl Iterator<Item = [u32; 2]> {
    let n = u32::try_from(n).expect("ids have 32 bits");
    (0..n).flat_map(move |a| (a + 1..n).map(move |b| [a, b]))
}

fn sees(cells: &BitMatrix, [a, b]: [u32; 2]) -> bool {
    cells.get(a as usize, b as usize)
}

/// What every table has to be: symmetric, with a full diagonal, its undecided pairs visible and in order.
fn check_table(name: &str, world: &World, seen: &ConvexVisibility) {
    let n = world.graph.n_cells();
    assert_eq!((seen.cells.n_rows(), seen.cells.n_cols()), (n, n), "{name}");
    assert!((0..n).all(|a| seen.cells.get(a, a)), "{name}: a cell sees itself");
    assert!(pairs(n).all(|[a, b]| sees(&seen.cells, [a, b]) == sees(&seen.cells, [b, a])), "{name}: symmetric");
    assert!(
        seen.undecided.is_sorted() && seen.undecided.iter().all(|&[a, b]| a < b && sees(&seen.cells, [a, b])),
        "{name}"
    );
    for portal in world.graph.portals() {
        assert!(sees(&seen.cells, portal.cells.map(|c| c.0)), "{name}: neighbours see each other");
    }
}

/// Pairs that lines show and the table hides.
fn missing(world: &World, cells: &BitMatrix, n_lines: usize, seed: u64) -> (usize, Vec<[u32; 2]>) {
    let seen = seen_by_rays(world, n_lines, seed).pairs;
    let n = seen.len();
    (n, seen.into_iter().filter(|&pair| !sees(cells, pair)).collect())
}

/// Pairs that are proven to be hidden, and those of them that the table shows.
fn surplus(world: &World, cells: &BitMatrix, margin: f64, budget: usize) -> (usize, Vec<[u32; 2]>) {
    let hidden = pairs(world.graph.n_cells()).filter(|pair| {
        let [a, b] = pair.map(CellId);
        sight_by_solids(world, a, b, margin, budget).sight == Sight::Hidden
    });
    let hidden: Vec<[u32; 2]> = hidden.collect();
    (hidden.len(), hidden.into_iter().filter(|&pair| sees(cells, pair)).collect())
}

#[test]
fn nothing_that_lines_show_is_hidden() {
    let mut n_seen = 0;
    let mut look = |name: &str, world: &World, n_lines: usize| {
        let seen = exact(world);
        check_table(name, world, &seen);
        let (n, missing) = missing(world, &seen.cells, n_lines, 7);
        assert!(missing.is_empty(), "{name}: {missing:?}");
        n_seen += n;
    };
    for (name, world) in world_families() {
        look(name, &world, 2000);
    }
    for seed in 0..6 {
        look("random", &random(seed, 40, 60), 3000);
        look("axial", &random(seed, 40, 0), 3000);
        look("far", &random(seed, 25, 60).moved([1e6, -1e6, 1e6]), 2000);
        look("noise", &random(seed, 25, 60).jittered(seed, 1e-13), 2000);
    }
    for seed in 0..3 {
        let level = quake_like(QuakeLikeOptions { seed, rooms_x: 2, rooms_y: 2, floors: 2 }).expect("few rooms");
        look("level", &level, 3000);
    }
    assert!(n_seen > 5000, "{n_seen}");
}

#[test]
fn nothing_that_is_proven_hidden_is_shown() {
    let mut n_hidden = 0;
    for seed in 0..16 {
        for tilted_percent in [0, 60] {
            let world = random(seed, 18, tilted_percent);
            // Corners of axial worlds are exact; in the others a slit may be there that only rounding made.
            let margin = if tilted_percent == 0 { -1e-9 } else { 1e-6 };
            let seen = exact(&world);
            let (n, surplus) = surplus(&world, &seen.cells, margin, 600);
            assert!(surplus.is_empty(), "seed {seed}, {tilted_percent} % tilted: {surplus:?} of {n}");
            n_hidden += n;
        }
    }
    assert!(n_hidden > 100, "{n_hidden}");
}

#[test]
fn corridors_are_seen_as_far_as_is_known() {
    let (mut n_hidden, mut n_visible, mut n_grazing) = (0, 0, 0);
    for (bends, width) in [([0, 0], 16), ([1, 0], 4), ([1, 0], 9), ([1, 2], 13), ([3, 1], 6), ([1, 0], 17)] {
        let world = corridor(11, bends, width).expect("a short corridor");
        let places: Vec<u32> = world.cells().iter().map(|leaf| (leaf.bounds().max[0] / 32.0) as u32).collect();
        let variants = [
            world.clone(),
            world.moved([1e6, -3e6, 1e6]),
            world.scaled(2f64.powi(-40)),
            world.sheared([[1, 2, 0], [1, 3, 0], [1, 0, 1]]),
        ];
        for world in variants {
            let seen = exact(&world);
            check_table("corridor", &world, &seen);
            for pair in pairs(places.len()) {
                let boxes = pair.map(|cell| places[cell as usize]);
                let known = corridor_sees(bends, width, boxes);
                // Where lines only graze it may say that it does not know.
                let says = sees(&seen.cells, pair) && !seen.undecided.contains(&pair);
                assert_eq!(says, known, "{bends:?} {width}: boxes {boxes:?}");
                let grazes = !known && corridor_sees(bends, width + 1, boxes);
                assert!(grazes || !seen.undecided.contains(&pair), "{bends:?} {width}: boxes {boxes:?}");
                n_visible += usize::from(known);
                n_hidden += usize::from(!known);
                n_grazing += usize::from(grazes);
            }
        }
    }
    assert!(n_hidden > 100 && n_visible > 500 && n_grazing > 20, "{n_hidden} {n_visible} {n_grazing}");
}

#[test]
fn where_a_world_lies_and_how_large_it_is_changes_nothing() {
    let mut n_pairs = 0;
    for seed in 0..6 {
        // Exact corners stay exact when they move by whole numbers.
        let axial = random(seed, 30, 0);
        let seen = exact(&axial);
        assert_eq!(exact(&axial.moved([1e6, 2e6, -1e6])).cells, seen.cells, "axial, seed {seed}");
        assert_eq!(exact(&axial.sheared([[1, 1, 0], [0, 1, 0], [0, 2, 1]])).cells, seen.cells, "axial, seed {seed}");
        let tilted = random(seed, 30, 60);
        let seen = exact(&tilted);
        for power in [-30, 1, 10] {
            assert_eq!(exact(&tilted.scaled(2f64.powi(power))).cells, seen.cells, "seed {seed}, 2^{power}");
        }
        n_pairs += seen.cells.count_ones();
    }
    assert!(n_pairs > 500, "{n_pairs}");
}

#[test]
fn options_change_no_more_than_they_say() {
    for seed in 0..4 {
        let world = random(seed, 60, 60);
        let seen = exact(&world);
        for threads in [1, 2, 8] {
            assert_eq!(
                search(&world, ConvexOptions { threads, ..ConvexOptions::default() }),
                seen,
                "{threads} threads"
            );
        }
        let fast = search(&world, ConvexOptions { fast: true, ..ConvexOptions::default() });
        check_table("fast", &world, &fast);
        assert!(pairs(world.graph.n_cells()).all(|pair| !sees(&seen.cells, pair) || sees(&fast.cells, pair)));
    }
}

/// The impostors: a table with a pair less is found out, and so is one that shows everything.
#[test]
fn comparisons_can_fail() {
    let world = random(1, 18, 0);
    let n = world.graph.n_cells();
    let all = {
        let mut all = BitMatrix::identity(n);
        pairs(n).for_each(|[a, b]| {
            all.set(a as usize, b as usize, true);
            all.set(b as usize, a as usize, true);
        });
        all
    };
    assert!(!surplus(&world, &all, -1e-9, 600).1.is_empty());
    let none = BitMatrix::identity(n);
    assert!(!missing(&world, &none, 1000, 1).1.is_empty());
    assert!(missing(&world, &all, 1000, 1).1.is_empty() && surplus(&world, &none, -1e-9, 600).1.is_empty());
}
