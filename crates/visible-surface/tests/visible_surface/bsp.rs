//! Trees of planes against rays shot at every face.

use crate::oracle::{Swapped, look};
use crate::soups::{cameras, cube, cycle, triangles};
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;
use sightlines_visible_surface::bsp::{BspOptions, FaceBsp, Heuristic};
use sightlines_visible_surface::{
    Camera, Counters, FaceMask, Faces, Fragment, InputPlane, Relation, RenderInput, RenderOutput, VisibleSurface,
};

const SIDE: u32 = 16;

fn options() -> impl Strategy<Value = BspOptions> {
    let heuristic = prop_oneof![
        Just(Heuristic::FirstFace),
        any::<u64>().prop_map(|seed| Heuristic::Random { seed }),
        Just(Heuristic::FewestSplits),
        Just(Heuristic::Balanced),
        Just(BspOptions::default().heuristic),
    ];
    (heuristic, 1..20usize, prop_oneof![Just(0), Just(4), Just(usize::MAX)])
        .prop_map(|(heuristic, candidates, axis_above)| BspOptions { heuristic, candidates, axis_above })
}

/// Straight ahead from far away, down the z axis.
fn from_above(side: u32) -> Camera {
    Camera::look_at([2.1, 2.2, 60.0], [2.0, 2.0, 0.0], [0.0, 1.0, 0.0], 5.0, [side; 2]).unwrap()
}

proptest! {
    /// Invariant: every pixel shows what the ray through its centre meets first, walked either way, with any choice of planes, of any
    /// of the faces; and as many fragments are drawn as lie there.
    #[test]
    fn bsp_pictures_are_those_of_rays(
        soup in triangles(10),
        camera in cameras(SIDE),
        options in options(),
        keep in any::<u16>(),
    ) {
        let faces = Faces::new(soup).unwrap();
        let bsp = FaceBsp::build(&faces, &options);
        let stats = bsp.stats();
        prop_assert_eq!(stats.fragments as u64, stats.faces as u64 + stats.splits);
        crate::oracle::check(&faces, &camera, |f| keep >> f & 1 == 1, &[&bsp, &bsp.clone().front_to_back()]);
    }

    /// Invariant: a walk limited to some faces sends those alone, all of them that are not edge-on, and enters no more nodes than
    /// a walk for all.
    #[test]
    fn bsp_walks_send_exactly_the_chosen(
        soup in triangles(16),
        camera in cameras(4),
        options in options(),
        keep in any::<u16>(),
    ) {
        let faces = Faces::new(soup).unwrap();
        let bsp = FaceBsp::build(&faces, &options);
        let all = FaceMask::all(&faces);
        let mut chosen = all.clone();
        chosen.retain(|f| keep >> f & 1 == 1);
        let sent = |chosen: &FaceMask| {
            let mut counters = Counters::default();
            match bsp.see(&RenderInput { faces: &faces, camera: &camera, mask: chosen }, &mut counters) {
                RenderOutput::BackToFront(fragments) => (fragments, counters),
                _ => panic!("walks are from back to front"),
            }
        };
        let (fragments, counters) = sent(&chosen);
        let (everything, all_counters) = sent(&all);
        let mut ids: Vec<u32> = fragments.iter().map(Fragment::face).collect();
        let limited: Vec<u32> = everything.iter().map(Fragment::face).filter(|&f| chosen.has(f)).collect();
        prop_assert_eq!(&ids, &limited);
        ids.sort_unstable();
        ids.dedup();
        let eye = camera.eye();
        let faced = |f: u32| sightlines_visible_surface::InputPlane::of(&faces, f).side(&faces, eye) != 0;
        prop_assert_eq!(ids, chosen.iter().filter(|&f| faced(f)).collect::<Vec<_>>());
        prop_assert!(counters.tests["nodes visited"] <= all_counters.tests["nodes visited"]);
        prop_assert_eq!(all_counters.tests["subtrees skipped"], 0);
    }
}

#[test]
fn few_pixels_are_in_doubt_and_swapped_children_are_caught() {
    let mut runner = TestRunner::deterministic();
    let (mut n_covered, mut n_doubt, mut n_on_edge, mut n_caught, mut n_runs) = (0, 0, 0, 0, 0);
    for _ in 0..200 {
        let faces = Faces::new(triangles(10).new_tree(&mut runner).unwrap().current()).unwrap();
        let camera = cameras(SIDE).new_tree(&mut runner).unwrap().current();
        let chosen = FaceMask::all(&faces);
        let truth = look(&faces, &camera, &chosen);
        let input = RenderInput { faces: &faces, camera: &camera, mask: &chosen };
        let bsp = FaceBsp::build(&faces, &BspOptions::default());
        assert_eq!(truth.wrong(&bsp.picture(&input).0), []);
        let impostor = Swapped(bsp.front_to_back());
        n_caught += u32::from(!truth.wrong(&impostor.picture(&input).0).is_empty());
        n_covered += truth.n_covered();
        n_doubt += truth.n_in_doubt();
        n_on_edge += truth.on_edge.iter().filter(|e| **e).count();
        n_runs += 1;
    }
    eprintln!(
        "{n_runs} pictures, {n_covered} pixels covered, {n_on_edge} on edges, {n_doubt} in doubt, {n_caught} caught"
    );
    assert!(n_covered > 5000 && n_on_edge > 500, "the pictures show too little");
    assert!(n_doubt * 20 < n_covered, "too much is left out of the comparison");
    assert!(n_caught * 4 > n_runs, "swapped children would not be noticed");
}

fn all_heuristics() -> [Heuristic; 5] {
    [
        Heuristic::FirstFace,
        Heuristic::Random { seed: 1 },
        Heuristic::FewestSplits,
        Heuristic::Balanced,
        BspOptions::default().heuristic,
    ]
}

#[test]
fn convex_objects_are_not_split() {
    let octahedron: Vec<crate::soups::Triangle> = (0..8)
        .map(|i| {
            [0, 1, 2].map(|k| {
                [0, 1, 2].map(|j| {
                    if j != k {
                        0.0
                    } else if i >> k & 1 == 1 {
                        3.0
                    } else {
                        -3.0
                    }
                })
            })
        })
        .collect();
    for (soup, n_planes) in [(octahedron, 8), (cube([0.0; 3], 3.0), 6)] {
        let faces = Faces::new(soup).unwrap();
        for heuristic in all_heuristics() {
            let options = BspOptions { heuristic, axis_above: usize::MAX, ..BspOptions::default() };
            let stats = FaceBsp::build(&faces, &options).stats();
            assert_eq!((stats.splits, stats.nodes), (0, n_planes), "{heuristic:?}");
        }
    }
}

#[test]
fn boxes_apart_are_parted_without_splits() {
    let soup = (0..4).flat_map(|x| (0..4).flat_map(move |y| cube([f64::from(x) * 3.0, f64::from(y) * 3.0, 0.0], 2.0)));
    let faces = Faces::new(soup.collect()).unwrap();
    let stats = FaceBsp::build(&faces, &BspOptions::default()).stats();
    assert_eq!((stats.faces, stats.splits), (192, 0));
}

#[test]
fn heuristics_do_what_they_are_named_for() {
    // The plane of the first cuts the second, not the other way round.
    let tee = vec![[[0., 0., 0.], [4., 0., 0.], [0., 0., 4.]], [[0., -2., -1.], [4., 2., -1.], [0., 2., -1.]]];
    let faces = Faces::new(tee).unwrap();
    let splits = |faces: &Faces, heuristic| {
        let options = BspOptions { heuristic, axis_above: usize::MAX, ..BspOptions::default() };
        FaceBsp::build(faces, &options).stats()
    };
    assert_eq!(splits(&faces, Heuristic::FirstFace).splits, 1);
    assert_eq!(splits(&faces, Heuristic::FewestSplits).splits, 0);
    // Parallel faces, the lowest first.
    let stack = |n: i32| {
        let z = (0..n).map(f64::from);
        Faces::new(z.map(|z| [[0., 0., z], [4., 0., z], [0., 4., z]]).collect()).unwrap()
    };
    assert_eq!(splits(&stack(31), Heuristic::FirstFace).depth, 31);
    assert!(splits(&stack(31), Heuristic::Balanced).depth <= 8);
    // Nothing recurses: as deep as there are faces.
    assert_eq!(splits(&stack(3000), Heuristic::FirstFace).depth, 3000);
    let large = FaceBsp::build(&stack(3000), &BspOptions::default()).stats();
    assert!(large.depth < 40 && large.splits == 0, "{large:?}");
}

#[test]
fn what_must_be_split_is_split_once() {
    // Two faces through each other, and three in a circle.
    let crossing = vec![[[0., 0., 0.], [4., 0., 0.], [2., 4., 0.]], [[2., 1., -2.], [2., 1., 2.], [2., 3., 1.]]];
    for soup in [crossing, cycle([0.0; 3], 0, false)] {
        let faces = Faces::new(soup).unwrap();
        let options = BspOptions { heuristic: Heuristic::FewestSplits, ..BspOptions::default() };
        assert_eq!(FaceBsp::build(&faces, &options).stats().splits, 1);
    }
}

#[test]
fn of_faces_in_one_plane_the_lower_id_is_seen_from_both_sides() {
    let soup: Vec<crate::soups::Triangle> =
        (0..5).map(|k| [[0., 0., 1.], [4. - f64::from(k), 0., 1.], [0., 4., 1.]]).collect();
    let faces = Faces::new(soup.into_iter().rev().collect()).unwrap();
    let chosen = FaceMask::all(&faces);
    let bsp = FaceBsp::build(&faces, &BspOptions::default());
    assert_eq!(bsp.stats().nodes, 1);
    for camera in [from_above(64), from_below()] {
        let input = RenderInput { faces: &faces, camera: &camera, mask: &chosen };
        let truth = look(&faces, &camera, &chosen);
        assert!(truth.n_covered() > 100 && truth.n_in_doubt() == 0);
        for bsp in [bsp.clone(), bsp.clone().front_to_back()] {
            assert_eq!(truth.wrong(&bsp.picture(&input).0), []);
        }
        assert!(!truth.wrong(&Swapped(bsp.clone().front_to_back()).picture(&input).0).is_empty());
    }
}

fn from_below() -> Camera {
    Camera::look_at([2.1, 2.2, -60.0], [2.0, 2.0, 0.0], [0.0, 1.0, 0.0], 5.0, [64; 2]).unwrap()
}

#[test]
fn trees_of_nothing_draw_nothing() {
    for soup in [vec![], vec![[[0.0; 3]; 3]]] {
        let faces = Faces::new(soup).unwrap();
        let bsp = FaceBsp::build(&faces, &BspOptions::default());
        assert_eq!(bsp.stats(), sightlines_visible_surface::bsp::BspStats::default());
        let chosen = FaceMask::all(&faces);
        let (image, counters) = bsp.picture(&RenderInput { faces: &faces, camera: &from_above(4), mask: &chosen });
        assert_eq!((image.n_covered(), counters.polygons), (0, 0));
    }
}

#[test]
fn large_trees_are_cut_across_axes_and_show_what_rays_meet() {
    let faces = Faces::new(crate::soups::field(9, &mut TestRunner::deterministic())).unwrap();
    let bsp = FaceBsp::build(&faces, &BspOptions::default());
    let stats = bsp.stats();
    assert!(stats.faces > 200 && stats.axis_nodes > 2, "{stats:?}");
    let chosen = FaceMask::all(&faces);
    for eye in [[-5.0, -5.0, 9.0], [14.0, 15.0, 40.0], [13.0, 13.0, 2.0]] {
        let camera = Camera::look_at(eye, [16.0, 14.0, 1.0], [0.0, 1.0, 0.0], 60.0, [32, 24]).unwrap();
        let truth = look(&faces, &camera, &chosen);
        let input = RenderInput { faces: &faces, camera: &camera, mask: &chosen };
        assert!(truth.n_covered() > 100);
        for bsp in [bsp.clone(), bsp.clone().front_to_back()] {
            assert_eq!(truth.wrong(&bsp.picture(&input).0), []);
        }
    }
}

/// What was wrong once: products of numbers near both ends of what is accepted vanished, and their bounds with them, so a corner beside a plane
/// counted as on it.
#[test]
fn corners_beside_planes_at_both_ends_of_the_range() {
    let p = |k: i32| 2f64.powi(k);
    let (e, h, d) = (p(-139), p(200), p(-191));
    let (x, y, s) = (0.9375 * e, e - p(-192), p(-141));
    let faces = Faces::new(vec![
        [[e, e, e], [h, e, e + d], [e + d, h, e]],
        [[-4.0, y, -4.0], [-4.0, y, -5.0], [-5.0, y, -4.0]],
        [[e, e, h], [e, e + d, e], [e, e - d, e]],
        [[x, y, e - s], [x, y, e + s], [x, e + s, e - s]],
    ])
    .unwrap();
    let [_, behind] = Fragment::whole(2).split(&faces, &InputPlane::of(&faces, 0)).1.unwrap();
    assert_eq!(behind.relation(&faces, &InputPlane::Axis(1, y)), Relation::Across);
    let eye = [0.0, e - p(-190), e - p(-150)];
    let corner = [1.0, 7.0 * p(-54) - 0.5, p(-11) - 0.5];
    let camera = Camera::new(eye, corner, [0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [1, 1]).unwrap();
    let chosen = FaceMask::all(&faces);
    let input = RenderInput { faces: &faces, camera: &camera, mask: &chosen };
    let truth = crate::oracle::look(&faces, &camera, &chosen);
    assert_eq!((truth.faces[0], truth.n_in_doubt()), (Some(3), 0));
    let options = BspOptions { heuristic: Heuristic::FirstFace, candidates: 1, axis_above: usize::MAX };
    let tree = FaceBsp::build(&faces, &options);
    for method in [&tree, &tree.clone().front_to_back()] {
        assert_eq!(truth.wrong(&method.picture(&input).0), []);
    }
}
