//! The classical method on worlds, against lines and corridors whose answer is known.

use super::*;
use crate::convex::seen_by_rays;
use sightlines_scenes::world::{
    BspWorldOptions, QuakeLikeOptions, World, bsp_world, corridor, corridor_sees, quake_like, world_families,
};

/// Below the clearance of lines, above the rounding of coordinates and the noise of worlds.
fn tolerance(world: &World) -> f64 {
    let bounds = world.bounds();
    (0..3).map(|k| bounds.max[k] - bounds.min[k]).fold(0.0, f64::max) * 2f64.powi(-24)
}

fn look(world: &World, level: ClassicalLevel, tolerance: f64) -> ClassicalSeen {
    classical(&world.graph, ClassicalOptions { level, tolerance }, || false)
}

/// Ordered pairs that the first shows and the second does not.
fn beyond(a: &ClassicalSeen, b: &ClassicalSeen) -> usize {
    let words = a.rows.iter().flatten().zip(b.rows.iter().flatten());
    words.map(|(a, b)| (a & !b).count_ones() as usize).sum()
}

fn worlds() -> Vec<World> {
    let random = |seed, tilted_percent| {
        bsp_world(BspWorldOptions { seed, leafs: 60, solid_percent: 45, tilted_percent }).unwrap()
    };
    let level = |seed| quake_like(QuakeLikeOptions { seed, rooms_x: 2, rooms_y: 2, floors: 2 }).unwrap();
    let families = world_families().into_iter().map(|(_, world)| world);
    families.chain((0..8).flat_map(|seed| [random(seed, 0), random(seed, 60)])).chain((0..2).map(level)).collect()
}

#[test]
fn what_lines_show_is_seen_on_every_level() {
    let (mut n_seen, mut n_steps, mut n_dropped, mut n_one_way) = (0, 0, 0, 0);
    for (k, world) in worlds().iter().enumerate() {
        let [base, walked, symmetric] = [ClassicalLevel::Base, ClassicalLevel::Separators, ClassicalLevel::Symmetric]
            .map(|level| look(world, level, tolerance(world)));
        let rays = seen_by_rays(world, 2000, 5).pairs;
        for pair in &rays {
            let [a, b] = pair.map(|cell| cell as usize);
            assert!(symmetric.sees(a, b) && symmetric.sees(b, a), "world {k}: {pair:?}");
        }
        assert_eq!([beyond(&symmetric, &walked), beyond(&walked, &base)], [0, 0], "world {k}");
        assert_eq!(walked.symmetric(), symmetric, "world {k}");
        assert!((0..world.graph.n_cells()).all(|cell| symmetric.sees(cell, cell)), "world {k}");
        assert_eq!([walked.n_finished, base.n_finished], [walked.n_gates; 2], "world {k}");
        n_seen += rays.len();
        n_steps += walked.steps;
        n_dropped += beyond(&base, &walked);
        n_one_way += beyond(&walked, &symmetric);
    }
    assert!(n_seen > 5000 && n_steps > 10_000 && n_dropped > 1000, "{n_seen} {n_steps} {n_dropped}");
    assert!(n_one_way > 0, "pairs that only one end sees are common, and taken out");
}

/// With a bend in one direction only, planes between portals decide; with two they hide nothing that is seen.
#[test]
fn corridors_are_seen_as_far_as_is_known() {
    let (mut n_visible, mut n_hidden) = (0, 0);
    for (bends, width) in [([0, 0], 16), ([1, 0], 4), ([1, 0], 9), ([0, 2], 13), ([1, 2], 13), ([3, 1], 7)] {
        let world = corridor(11, bends, width).unwrap();
        let places: Vec<u32> = world.cells().iter().map(|leaf| (leaf.bounds().max[0] / 32.0) as u32).collect();
        let seen = look(&world, ClassicalLevel::Symmetric, 1e-9);
        for (a, &i) in places.iter().enumerate() {
            for (b, &j) in places.iter().enumerate().take(a) {
                let known = corridor_sees(bends, width, [i, j]);
                assert!(!known || seen.sees(a, b), "{bends:?} {width}: boxes {i} {j}");
                assert!(known || bends.iter().all(|b| *b > 0) || !seen.sees(a, b), "{bends:?} {width}: boxes {i} {j}");
                n_visible += usize::from(known);
                n_hidden += usize::from(!seen.sees(a, b));
            }
        }
    }
    assert!(n_visible > 100 && n_hidden > 100, "{n_visible} {n_hidden}");
}

/// The impostor: what lines pass by less than the tolerance is hidden, though it is known to be seen.
#[test]
fn a_tolerance_hides_what_is_thinner() {
    // Boxes with four portals between the first and the last see each other by 1 unit of 65.
    let large = corridor(9, [16, 0], 65).unwrap();
    let n_hidden = |scale: i32| {
        let world = large.scaled(2f64.powi(-scale));
        let [exact, tolerant] = [1e-9, 0.1].map(|tolerance| look(&world, ClassicalLevel::Separators, tolerance));
        beyond(&exact, &tolerant)
    };
    assert_eq!(n_hidden(0), 0);
    assert!(n_hidden(5) > 0);
}

#[test]
fn a_walk_that_is_stopped_keeps_its_bounds() {
    let world = quake_like(QuakeLikeOptions { seed: 1, rooms_x: 3, rooms_y: 2, floors: 2 }).unwrap();
    let options = ClassicalOptions { level: ClassicalLevel::Separators, tolerance: 0.001 };
    let mut n_asked = 0;
    let done = classical(&world.graph, options, || {
        n_asked += 1;
        false
    });
    assert!(n_asked > 2 && done.n_finished == done.n_gates, "{n_asked}");
    let stopped = classical(&world.graph, options, || true);
    assert!(0 < stopped.n_finished && stopped.n_finished < stopped.n_gates, "{}", stopped.n_finished);
    assert!(stopped.steps < done.steps);
    // Bounds have shrunk by what finished gates do not see, but never below what is seen.
    let base = look(&world, ClassicalLevel::Base, 0.001);
    assert!(beyond(&done, &stopped) == 0 && beyond(&stopped, &done) > 0 && beyond(&stopped, &base) == 0);
}
