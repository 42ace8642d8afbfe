//! Shadows over faces against segments that are traced, and against the question about whole cells.

use super::lines::sights;
use super::solve::Propagation;
use super::tiling::Tiling;
use proptest::prelude::*;
use sightlines_geometry::{Aabb, Random};
use sightlines_line_space::{FaceTarget, LineSpace, Outcome, Surface};
use sightlines_multifocal::RaySampler;
use sightlines_testkit::draw;
use sightlines_testkit::meshes::{Soup, boxes, free_segment, scene, soup};
use std::sync::Arc;

const WORLD: Aabb<3> = Aabb { min: [-5.0; 3], max: [14.0; 3] };

/// Boxes that tile the world, with sides that meet in part only.
fn tiles(n: usize, seed: u64) -> Vec<Aabb<3>> {
    let mut random = Random::new(seed);
    let mut tiles = vec![WORLD];
    while tiles.len() < n {
        let longest = |b: &Aabb<3>| (0..3).map(|k| b.max[k] - b.min[k]).fold(0.0, f64::max);
        let k = (0..tiles.len()).max_by(|&i, &j| longest(&tiles[i]).total_cmp(&longest(&tiles[j]))).unwrap_or(0);
        let b = tiles.swap_remove(k);
        let axis = (0..3).find(|&axis| b.max[axis] - b.min[axis] == longest(&b)).unwrap_or(0);
        let at = b.min[axis] + (b.max[axis] - b.min[axis]) * (0.3 + 0.4 * random.unit());
        // Often on the lattice of the meshes.
        let at =
            if random.unit() < 0.5 && b.min[axis] < at.round() && at.round() < b.max[axis] { at.round() } else { at };
        let (mut low, mut high) = (b, b);
        (low.max[axis], high.min[axis]) = (at, at);
        tiles.extend([low, high]);
    }
    tiles
}

/// The boxes of a tiling that are found hidden from targets.
fn hidden(soup: &Soup, tiles: &[Aabb<3>], targets: &[Aabb<3>], fault: bool) -> Vec<Vec<u32>> {
    let rays = RaySampler::of(soup.clone());
    let mut propagation =
        Propagation::new(tiles.to_vec(), &rays, Arc::new(Surface::new(soup)), 1, None).expect("nobody cancels");
    if fault {
        propagation.close();
    }
    let of = |target: &Aabb<3>| {
        let target = FaceTarget::of_box(target).expect("a box");
        let solved = propagation.solve(None, &target, false, &[]);
        solved.hidden.into_iter().flatten().collect()
    };
    targets.iter().map(of).collect()
}

fn wrong(soup: &Soup, tiles: &[Aabb<3>], targets: &[Aabb<3>], found: &[Vec<u32>], seed: u64) -> Option<String> {
    let rays = scene(soup);
    let pairs = targets.iter().zip(found).flat_map(|(target, found)| found.iter().map(move |&k| (target, k)));
    pairs.into_iter().find_map(|(target, k)| {
        let free = free_segment(&rays, &tiles[k as usize], target, seed, 40)?;
        Some(format!("{:?} sees {target:?}: {free:?}", tiles[k as usize]))
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, ..ProptestConfig::default() })]

    /// Invariant: no segment is free from a cell to a target that is found hidden from it, in tilings with and without gaps.
    #[test]
    fn nothing_that_is_seen_is_hidden(
        soup in soup(), pairs in prop::collection::vec(boxes(), 3), n in 2usize..60, gaps in 0usize..6, seed in any::<u64>(),
    ) {
        let mut tiles = tiles(n, seed);
        tiles.drain(..gaps.min(n - 1));
        let targets: Vec<Aabb<3>> = pairs.into_iter().map(|[_, target]| target).collect();
        let found = hidden(&soup, &tiles, &targets, false);
        prop_assert_eq!(wrong(&soup, &tiles, &targets, &found, seed), None);
    }
}

/// The tightness twin: what is found cell by cell is found as well over faces, but for little. And the impostor: where gaps between cells count as hidden,
/// segments find it out.
#[test]
fn faces_find_what_whole_cells_do_and_gaps_let_lines_pass() {
    let [mut whole, mut both, mut faces, mut n_wrong, mut n_faulty] = [0; 5];
    for (seed, (soup, pairs)) in (0..).zip(draw(&(soup(), prop::collection::vec(boxes(), 4)), 60)) {
        let mut tiles = tiles(40, seed);
        let targets: Vec<Aabb<3>> = pairs.into_iter().map(|[_, target]| target).collect();
        let mut lines = LineSpace::new(&soup);
        for (target, found) in targets.iter().zip(hidden(&soup, &tiles, &targets, false)) {
            for (k, tile) in (0u32..).zip(&tiles) {
                let by_whole = lines.see_box(tile, target, 400) == Outcome::Hidden;
                whole += usize::from(by_whole);
                both += usize::from(by_whole && found.contains(&k));
            }
            faces += found.len();
        }
        tiles.drain(..20);
        let found = hidden(&soup, &tiles, &targets, true);
        n_faulty += 1;
        n_wrong += usize::from(wrong(&soup, &tiles, &targets, &found, seed).is_some());
    }
    eprintln!("whole {whole}, both {both}, faces {faces}; {n_wrong} of {n_faulty} impostors caught");
    assert!(whole > 500 && both * 10 > whole * 8, "whole {whole}, both {both}, faces {faces}");
    assert!(n_wrong * 2 > n_faulty, "{n_wrong} of {n_faulty}");
}

/// A wall that hides from its front only stands between two screens: lines through it are free in one direction, and count in that one alone. The twin:
/// that direction is found, also by lines that begin behind the wall's other side.
#[test]
fn lines_past_backs_are_free_in_one_direction() {
    let across = |x: f64| {
        let [a, b, c, d] = [[x, -9.0, -9.0], [x, 20.0, -9.0], [x, 20.0, 20.0], [x, -9.0, 20.0]];
        vec![[a, b, c], [a, c, d]]
    };
    let (behind, before, wall) = (across(-4.5), across(13.5), across(4.0));
    let rays = RaySampler::new([&behind[..], &before, &wall]).with_front_occluders(|object| object == 2);
    let tiles = tiles(200, 1);
    let seen = sights(&Tiling::new(tiles.clone()), &rays, 3, None).expect("nobody cancels");
    let of = |object: usize| seen[object].iter().map(|sight| &tiles[sight.cell as usize]);
    assert_eq!(of(0).find(|b| b.min[0] >= 4.0), None, "sees through the front of the wall");
    let past_back = of(1).filter(|b| b.max[0] <= 4.0).count();
    let all = tiles.iter().filter(|b| b.max[0] <= 4.0 && b.max[0] > -4.5).count();
    assert!(past_back == all && all > 50, "{past_back} of {all}");
}
