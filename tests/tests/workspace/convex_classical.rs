//! The search through convex portals beside the classical walk with planes between portals: what ours shows with a line
//! the walk shows too, and what the walk shows beyond that is little, but something.

use sightlines::scenes::world::{BspWorldOptions, QuakeLikeOptions, World, bsp_world, quake_like, world_families};
use sightlines::stabtree::{ConvexOptions, ConvexSearch};
use sightlines_testkit::convex::{ClassicalLevel, ClassicalOptions, ClassicalSeen, classical};

/// The walk with a tolerance that is above rounding and below everything else.
fn walk(world: &World) -> ClassicalSeen {
    let bounds = world.bounds();
    let size = (0..3).map(|k| bounds.max[k] - bounds.min[k]).fold(0.0, f64::max);
    let options = ClassicalOptions { level: ClassicalLevel::Symmetric, tolerance: size * 2f64.powi(-24) };
    classical(&world.graph, options, || false)
}

fn worlds() -> Vec<(&'static str, World)> {
    let random = |seed, tilted_percent| {
        bsp_world(BspWorldOptions { seed, leafs: 60, solid_percent: 45, tilted_percent }).expect("within their ranges")
    };
    let level = |seed| quake_like(QuakeLikeOptions { seed, rooms_x: 2, rooms_y: 2, floors: 2 }).expect("few rooms");
    let mut worlds = world_families();
    // Windows of slivers are thinner than the tolerance.
    worlds.retain(|(name, _)| *name != "slivers");
    worlds.extend((0..10).flat_map(|seed| [("axial", random(seed, 0)), ("tilted", random(seed, 60))]));
    worlds.extend((0..3).map(|seed| ("level", level(seed))));
    worlds
}

#[test]
fn two_methods_agree_but_for_what_only_exact_ones_decide() {
    let (mut n_shown, mut n_surplus, mut n_thin, mut n_worlds) = (0, 0, 0, 0);
    for (name, world) in worlds() {
        let mut search = ConvexSearch::new(&world.graph, ConvexOptions { fast: false, threads: 1 });
        while search.advance() {}
        let exact = search.finish();
        let walked = walk(&world);
        for a in 0..world.graph.n_cells() {
            for b in 0..a {
                let is_open = exact.undecided.contains(&[b as u32, a as u32]);
                let (ours, theirs) = (exact.cells.get(a, b), walked.sees(a, b));
                // Noise, and corners that are rounded, open windows that are thinner than the tolerance.
                let is_thin = ours && !theirs && !is_open;
                let is_rounded = name == "tilted" || name.ends_with("-with-noise");
                assert!(!is_thin || is_rounded, "{name}: cells {b} and {a}");
                n_thin += usize::from(is_thin);
                n_shown += usize::from(ours);
                n_surplus += usize::from(theirs && !ours);
            }
        }
        n_worlds += 1;
    }
    assert!(n_worlds > 35 && n_shown > 10_000, "{n_worlds} worlds, {n_shown} pairs");
    assert!(n_thin > 0 && n_thin * 500 < n_shown, "{n_thin} pairs through thin windows, of {n_shown}");
    assert!(n_surplus > 0 && n_surplus * 50 < n_shown, "{n_surplus} pairs beyond {n_shown}");
}
