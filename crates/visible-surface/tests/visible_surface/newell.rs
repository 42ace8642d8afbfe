//! The depth sort against rays shot at every face, and its order against a relation that is decided in another way.

use crate::hides::{Grid, hides, is_circular};
use crate::oracle::look;
use crate::soups::{Triangle, cameras, triangles};
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;
use sightlines_cells::Scene;
use sightlines_scenes::{
    SurfaceOptions, coplanar, cycles, depth_pairs, interleaved, lattice, slivers, soup, split_worst, surfaces,
};
use sightlines_visible_surface::{
    Camera, Counters, DepthFormat, FaceMask, Faces, Fragment, Newell, RenderInput, RenderOutput, VisibleSurface,
    ZBuffer, compare,
};
use std::cell::Cell;
use std::collections::BTreeMap;

const SIDE: u32 = 16;

/// An order that is given.
#[derive(Debug)]
struct Given(Vec<Fragment>);

impl VisibleSurface for Given {
    fn name(&self) -> &'static str {
        "given"
    }

    fn see(&self, _: &RenderInput<'_>, _: &mut Counters) -> RenderOutput {
        RenderOutput::BackToFront(self.0.clone())
    }
}

fn sent(faces: &Faces, camera: &Camera) -> (Vec<Fragment>, Counters) {
    let chosen = FaceMask::all(faces);
    let mut counters = Counters::default();
    match Newell.see(&RenderInput { faces, camera, mask: &chosen }, &mut counters) {
        RenderOutput::BackToFront(fragments) => (fragments, counters),
        _ => panic!("the depth sort is from back to front"),
    }
}

/// The first pair of an order of whole faces in which the earlier one hides the later one.
fn fault(grid: &Grid, order: &[u32]) -> Option<[u32; 2]> {
    let after = |i: usize| order[i + 1..].iter().map(move |&q| [order[i], q]);
    (0..order.len()).flat_map(after).find(|&[p, q]| hides(grid, p, q))
}

/// Triangles with small whole coordinates, before an eye that sees all of them.
fn grids() -> impl Strategy<Value = Grid> {
    let corner = || [0..=4i128, 0..=4i128, 0..=4i128];
    let random = proptest::collection::vec([corner(), corner(), corner()], 2..8);
    // In parallel planes, so that overlaps without a cut are common.
    let layers = proptest::collection::vec(([corner(), corner(), corner()], 0..=3i128), 2..12)
        .prop_map(|all| all.into_iter().map(|(t, at)| t.map(|[x, y, _]| [x, y, at])).collect());
    // With a small slope, so that circles without a cut are too.
    let sloped = proptest::collection::vec(([corner(), corner(), corner()], [0..=1i128, 0..=1i128, 0..=1i128]), 3..7)
        .prop_map(|all| all.into_iter().map(|(t, z)| [0, 1, 2].map(|k| [t[k][0], t[k][1], 2 + z[k]])).collect());
    let eye = [0..=4i128, 0..=4i128, -10..=-4i128];
    (prop_oneof![random, layers, sloped], eye).prop_map(|(triangles, eye)| Grid { triangles, eye })
}

/// The faces, and the eye with all of them in pictures of any size.
fn seen_whole(grid: &Grid, side: u32) -> (Faces, Camera) {
    let real = |p: [i128; 3]| p.map(|x| x as f64);
    let faces = Faces::new(grid.triangles.iter().map(|t| t.map(real)).collect()).unwrap();
    let pixel = 2.5 / f64::from(side);
    let rays = [[-1.25, -1.25, 1.0], [pixel, 0.0, 0.0], [0.0, pixel, 0.0]];
    (faces, Camera::new(real(grid.eye), rays[0], rays[1], rays[2], [side; 2]).unwrap())
}

proptest! {
    /// Invariant: every pixel shows what the ray through its centre meets first, of any of the faces.
    #[test]
    fn newell_pictures_are_those_of_rays(soup in triangles(12), camera in cameras(SIDE), keep in any::<u16>()) {
        let faces = Faces::new(soup).unwrap();
        let mut chosen = FaceMask::all(&faces);
        chosen.retain(|f| keep >> f & 1 == 1);
        for chosen in [FaceMask::all(&faces), chosen] {
            let truth = look(&faces, &camera, &chosen);
            let (image, counters) = Newell.picture(&RenderInput { faces: &faces, camera: &camera, mask: &chosen });
            prop_assert_eq!(truth.wrong(&image), vec![], "{:?}", counters);
            prop_assert!(counters.polygons <= chosen.len() as u64);
        }
    }
}

/// Invariant: coordinates of any size change nothing, and nothing panics where they are mixed.
#[test]
fn newell_is_right_at_any_scale() {
    let (n_covered, n_mixed) = (Cell::new(0), Cell::new(0));
    let exponent = -130..=190i32;
    let scales = ([exponent.clone(), exponent.clone(), exponent], any::<bool>());
    let run = TestRunner::default().run(&(triangles(8), scales), |(soup, (exponents, same))| {
        let scale = [0, 1, 2].map(|k| 2f64.powi(exponents[if same { 0 } else { k }]));
        let scaled = |p: [f64; 3]| [0, 1, 2].map(|k| p[k] * scale[k]);
        let faces = Faces::new(soup.into_iter().map(|t: Triangle| t.map(scaled)).collect()).unwrap();
        // Components of rays go from 2^-100 to 2^100.
        let unit = scale.map(|x| x.clamp(2f64.powi(-95), 2f64.powi(95)));
        let ray = |v: [f64; 3]| [0, 1, 2].map(|k| v[k] * unit[k]);
        let [corner, across, down] = [[-1.0, -1.0, 1.0], [0.25, 0.0, 0.0], [0.0, 0.25, 0.0]].map(ray);
        let camera = Camera::new(scaled([1.5, 2.5, -3.0]), corner, across, down, [8; 2]).unwrap();
        let chosen = FaceMask::all(&faces);
        let truth = look(&faces, &camera, &chosen);
        let image = Newell.picture(&RenderInput { faces: &faces, camera: &camera, mask: &chosen }).0;
        prop_assert_eq!(truth.wrong(&image), vec![]);
        n_covered.set(n_covered.get() + truth.n_covered());
        n_mixed.set(n_mixed.get() + usize::from(!same && truth.n_covered() > 0));
        Ok(())
    });
    assert_eq!(run, Ok(()));
    assert!(n_covered.get() > 300 && n_mixed.get() > 5, "{} {}", n_covered.get(), n_mixed.get());
}

/// Pieces whose corners are products of numbers near the smallest double were once lost.
#[test]
fn newell_keeps_pieces_of_tiny_faces() {
    let soup = [
        [[1.0, 0.0, 1.0], [3.0, 4.0, 1.0], [3.0, 4.0, 2.0]],
        [[1.0, 4.0, 1.0], [3.0, 3.0, 5.0], [3.0, 2.0, 5.0]],
        [[1.0, 3.0, 5.0], [3.0, 0.0, 1.0], [3.0, 0.0, 2.0]],
        [[2.0, 0.0, 4.0], [2.0, 4.0, 2.0], [3.0, 0.0, 0.0]],
        [[1.0, 4.0, 1.0], [0.0, 1.0, 2.0], [4.0, 1.0, 4.0]],
    ];
    let times = |v: [f64; 3], exponent: i32| v.map(|x| x * 2f64.powi(exponent));
    let faces = Faces::new(soup.map(|t: Triangle| t.map(|p| times(p, -127))).to_vec()).unwrap();
    let [corner, across, down] = [[-1.0, -1.0, 1.0], [0.25, 0.0, 0.0], [0.0, 0.25, 0.0]].map(|v| times(v, -95));
    let camera = Camera::new(times([1.5, 2.5, -3.0], -127), corner, across, down, [8; 2]).unwrap();
    let chosen = FaceMask::all(&faces);
    let truth = look(&faces, &camera, &chosen);
    let (image, counters) = Newell.picture(&RenderInput { faces: &faces, camera: &camera, mask: &chosen });
    assert_eq!((truth.wrong(&image), truth.n_covered()), (vec![], 6));
    assert!(counters.splits > 0);
}

/// Soundness and tightness of the order itself: no face is drawn before one that it hides, and something is split
/// exactly if faces hide each other in a circle. The impostor: two faces of which one hides the other, exchanged, are
/// found.
#[test]
fn newell_splits_circles_and_nothing_else() {
    let (mut n_split, mut n_whole, mut n_hidden, mut n_shown) = (0, 0, 0, 0);
    let mut runner = TestRunner::deterministic();
    for _ in 0..1500 {
        let grid = grids().new_tree(&mut runner).unwrap().current();
        // So many pixels that nothing lies between their centres.
        let (faces, camera) = seen_whole(&grid, 16_384);
        let (fragments, counters) = sent(&faces, &camera);
        assert_eq!(counters.splits > 0, is_circular(&grid), "{grid:?}");
        if counters.splits > 0 {
            n_split += 1;
            continue;
        }
        n_whole += 1;
        let order: Vec<u32> = fragments.iter().map(Fragment::face).collect();
        assert_eq!(fault(&grid, &order), None, "{grid:?}");
        let pair =
            (0..order.len()).flat_map(|j| (0..j).map(move |i| [i, j])).find(|&[i, j]| hides(&grid, order[j], order[i]));
        if let Some([i, j]) = pair {
            n_hidden += 1;
            let (mut wrong, mut drawn) = (order.clone(), fragments.clone());
            wrong.swap(i, j);
            drawn.swap(i, j);
            assert!(fault(&grid, &wrong).is_some());
            let camera = seen_whole(&grid, 32).1;
            let chosen = FaceMask::all(&faces);
            let input = RenderInput { faces: &faces, camera: &camera, mask: &chosen };
            let truth = look(&faces, &camera, &chosen);
            assert_eq!(truth.wrong(&Given(fragments).picture(&input).0), []);
            n_shown += u32::from(!truth.wrong(&Given(drawn).picture(&input).0).is_empty());
        }
    }
    eprintln!(
        "{n_split} split, {n_whole} whole, {n_hidden} with something hidden, {n_shown} of which wrong if exchanged"
    );
    assert!(n_split > 300 && n_whole > 300 && n_hidden > 200 && n_shown > 100);
}

fn generated() -> BTreeMap<&'static str, Scene> {
    let some = SurfaceOptions { triangles: 300, ..SurfaceOptions::default() };
    [
        ("soup", soup(some)),
        ("coplanar", coplanar(some)),
        ("slivers", slivers(some)),
        ("cycles", cycles(300)),
        ("interleaved", interleaved(300)),
        ("lattice", lattice(300)),
        ("split_worst", split_worst(60)),
        ("depth_pairs", depth_pairs(Default::default())),
    ]
    .map(|(name, made)| (name, made.unwrap()))
    .into()
}

/// Pictures of generated scenes are those of the exact z-buffer, splits are made where they have to be and nowhere
/// else, and each test is needed by some scene.
#[test]
fn newell_draws_generated_scenes_with_the_splits_that_they_need() {
    let camera = Camera::look_at(surfaces::EYE, surfaces::AT, surfaces::UP, surfaces::ANGLE, [240, 180]).unwrap();
    let mut tests: BTreeMap<&str, u64> = BTreeMap::new();
    for (name, scene) in generated() {
        let faces = Faces::of_scene(&scene).unwrap();
        let chosen = FaceMask::all(&faces);
        let input = RenderInput { faces: &faces, camera: &camera, mask: &chosen };
        let (image, counters) = Newell.picture(&input);
        let reference = ZBuffer::new(DepthFormat::Exact).picture(&input).0;
        assert_eq!(compare(&input, &reference, &image).wrong, [[0; 2]; 0], "{name}");
        assert!(counters.covered > 1000 || name == "slivers", "{name} {}", counters.covered);
        match name {
            "soup" | "slivers" => assert!(counters.splits > 20, "{name}"),
            // One for each circle.
            "cycles" => assert_eq!((counters.splits, counters.fragments), (100, 400)),
            _ => assert_eq!(counters.splits, 0, "{name}"),
        }
        counters.tests.iter().for_each(|(test, n)| *tests.entry(test).or_default() += n);
    }
    assert_eq!(tests.len(), 7);
    assert!(tests.values().all(|&n| n > 1000), "{tests:?}");
}

/// Invariant: the same scene makes the same order, and each face that is not edge-on and lies in the picture is in it.
#[test]
fn newell_orders_are_deterministic_and_complete() {
    let camera = Camera::look_at(surfaces::EYE, surfaces::AT, surfaces::UP, 120.0, [8192; 2]).unwrap();
    let faces = Faces::of_scene(&soup(SurfaceOptions::default()).unwrap()).unwrap();
    let [(first, _), (second, _)] = [sent(&faces, &camera), sent(&faces, &camera)];
    assert_eq!(format!("{first:?}"), format!("{second:?}"));
    let mut ids: Vec<u32> = first.iter().map(Fragment::face).collect();
    ids.sort_unstable();
    ids.dedup();
    assert_eq!(ids.len(), faces.len());
}
