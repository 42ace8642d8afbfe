//! Clusters with fixed orders against rays shot at every face.

use crate::oracle::{Swapped, look};
use crate::soups::{Triangle, cameras, cube, cycle, objects, triangles};
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;
use sightlines_visible_surface::schumacker::{Schumacker, SchumackerOptions};
use sightlines_visible_surface::{Camera, FaceMask, Faces, RenderInput, VisibleSurface};

const SIDE: u32 = 16;

proptest! {
    /// Invariant: every pixel shows what the ray through its centre meets first, either way, for any objects and any of the faces.
    #[test]
    fn schumacker_pictures_are_those_of_rays(
        soup in triangles(10),
        camera in cameras(SIDE),
        n_objects in 1..6usize,
        max_faces in prop_oneof![Just(1usize), Just(4), Just(64)],
        keep in any::<u16>(),
    ) {
        let faces = objects(&soup, |k| k * n_objects / soup.len().max(1));
        let clusters = Schumacker::build(&faces, &SchumackerOptions { max_faces });
        let stats = clusters.stats();
        prop_assert_eq!(stats.fragments as u64, FaceMask::all(&faces).len() as u64 + stats.splits);
        crate::oracle::check(&faces, &camera, |f| keep >> f & 1 == 1, &[&clusters, &clusters.clone().front_to_back()]);
    }
}

#[test]
fn orders_within_clusters_are_put_to_use_and_swapped_ones_are_caught() {
    let mut runner = TestRunner::deterministic();
    let (mut n_covered, mut n_doubt, mut n_caught, mut n_runs, mut n_ordered, mut n_cyclic) = (0, 0, 0, 0, 0, 0);
    for _ in 0..200 {
        let soup = triangles(10).new_tree(&mut runner).unwrap().current();
        let faces = objects(&soup, |k| k / 4);
        let camera = cameras(SIDE).new_tree(&mut runner).unwrap().current();
        let chosen = FaceMask::all(&faces);
        let truth = look(&faces, &camera, &chosen);
        let input = RenderInput { faces: &faces, camera: &camera, mask: &chosen };
        let clusters = Schumacker::build(&faces, &SchumackerOptions::default());
        assert_eq!(truth.wrong(&clusters.picture(&input).0), []);
        let stats = clusters.stats();
        n_ordered += stats.clusters - stats.convex;
        n_cyclic += stats.cyclic;
        n_caught += u32::from(!truth.wrong(&Swapped(clusters.front_to_back()).picture(&input).0).is_empty());
        n_covered += truth.n_covered();
        n_doubt += truth.n_in_doubt();
        n_runs += 1;
    }
    eprintln!(
        "{n_runs} pictures, {n_covered} pixels covered, {n_doubt} in doubt, {n_caught} caught; \
         {n_ordered} orders of clusters that are not convex, {n_cyclic} clusters cut for cycles"
    );
    assert!(n_covered > 5000 && n_doubt * 20 < n_covered);
    assert!(n_ordered > 50 && n_cyclic > 50, "orders within clusters are hardly tested");
    assert!(n_caught * 4 > n_runs, "swapped orders would not be noticed");
}

fn stats(faces: &Faces) -> sightlines_visible_surface::schumacker::SchumackerStats {
    Schumacker::build(faces, &SchumackerOptions::default()).stats()
}

#[test]
fn boxes_apart_are_parted_by_planes_that_cut_none() {
    let place = |k: usize| [k % 4, k / 4 % 4, k / 16].map(|x| x as f64 * 2.0);
    // They touch each other.
    let soup: Vec<Triangle> = (0..32).flat_map(|k| cube(place(k), 2.0)).collect();
    let stats = stats(&objects(&soup, |k| k / 12));
    // Faces between two boxes lie in the planes that part them, and end up there.
    assert_eq!((stats.objects, stats.clusters, stats.convex), (32, 32, 32));
    assert_eq!((stats.planes, stats.clean, stats.splits), (31, 31, 0));
}

#[test]
fn slanted_neighbours_are_parted_by_the_plane_of_a_face() {
    // Two wedges of a box: no plane across an axis goes between them.
    let wedge = |p: [[f64; 3]; 3], q: [[f64; 3]; 3]| {
        let mut out = vec![p, [q[0], q[2], q[1]]];
        for k in 0..3 {
            let j = (k + 1) % 3;
            out.extend([[p[k], q[k], p[j]], [p[j], q[k], q[j]]]);
        }
        out
    };
    let up = |t: [[f64; 3]; 3]| t.map(|[x, y, _]| [x, y, 3.0]);
    let (a, b) = ([[0., 0., 0.], [3., 0., 0.], [0., 3., 0.]], [[3., 3., 0.], [0., 3., 0.], [3., 0., 0.]]);
    let soup: Vec<Triangle> = [wedge(a, up(a)), wedge(b, up(b))].concat();
    let stats = stats(&objects(&soup, |k| k / 8));
    assert_eq!((stats.clusters, stats.convex, stats.planes, stats.clean, stats.splits), (2, 2, 1, 1, 0));
}

#[test]
fn convex_objects_of_any_size_are_one_cluster() {
    // A fan of planes around a column.
    let n = 100;
    let at = |k: i32, z: f64| {
        let x = f64::from(k - n / 2);
        [x, x * x, z]
    };
    let soup: Vec<Triangle> = (0..n)
        .flat_map(|k| [[at(k, 0.), at(k + 1, 0.), at(k, 9.)], [at(k + 1, 0.), at(k + 1, 9.), at(k, 9.)]])
        .collect();
    let stats = stats(&objects(&soup, |_| 0));
    assert_eq!((stats.clusters, stats.convex, stats.planes, stats.splits), (1, 1, 0, 0));
}

#[test]
fn what_is_not_convex_may_have_a_fixed_order() {
    // A room with a box in it that stands free: walls seen from inside hide nothing of it.
    let soup: Vec<Triangle> = [cube([0.0; 3], 9.0), cube([3.0; 3], 2.0)].concat();
    let stats = stats(&objects(&soup, |_| 0));
    assert_eq!((stats.clusters, stats.convex, stats.planes, stats.splits), (1, 0, 0, 0));
}

#[test]
fn circles_and_crossings_are_cut() {
    let crossing = vec![[[0., 0., 0.], [4., 0., 0.], [2., 4., 0.]], [[2., 1., -2.], [2., 1., 2.], [2., 3., 1.]]];
    for soup in [crossing, cycle([0.0; 3], 0, false)] {
        let one = stats(&objects(&soup, |_| 0));
        assert_eq!((one.cyclic, one.splits), (1, 1));
        // Every face an object: no plane goes between them.
        let apart = stats(&objects(&soup, |k| k));
        assert_eq!((apart.cyclic, apart.splits), (0, 1));
    }
}

#[test]
fn clusters_of_nothing_draw_nothing() {
    let camera = Camera::look_at([0.0; 3], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0], 60.0, [4, 4]).unwrap();
    for soup in [vec![], vec![[[0.0; 3]; 3]]] {
        let faces = objects(&soup, |_| 0);
        let clusters = Schumacker::build(&faces, &SchumackerOptions::default());
        assert_eq!(clusters.stats(), Default::default());
        let chosen = FaceMask::all(&faces);
        let (image, counters) = clusters.picture(&RenderInput { faces: &faces, camera: &camera, mask: &chosen });
        assert_eq!((image.n_covered(), counters.polygons), (0, 0));
    }
}

#[test]
fn many_and_large_clusters_show_what_rays_meet() {
    let soup = crate::soups::field(9, &mut TestRunner::deterministic());
    // Every face an object; some dozens together; all in one.
    for size in [1, 40, usize::MAX] {
        let faces = objects(&soup, |k| k / size);
        let clusters = Schumacker::build(&faces, &SchumackerOptions::default());
        let stats = clusters.stats();
        assert!(faces.len() > 257 && (size <= 64 || stats.too_large > 0), "{stats:?}");
        let chosen = FaceMask::all(&faces);
        for eye in [[-5.0, -5.0, 9.0], [14.0, 15.0, 40.0], [13.0, 13.0, 2.0]] {
            let camera = Camera::look_at(eye, [16.0, 14.0, 1.0], [0.0, 1.0, 0.0], 60.0, [32, 24]).unwrap();
            let truth = look(&faces, &camera, &chosen);
            let input = RenderInput { faces: &faces, camera: &camera, mask: &chosen };
            assert!(truth.n_covered() > 100);
            assert_eq!(truth.wrong(&clusters.picture(&input).0), [], "{stats:?}");
        }
    }
}
