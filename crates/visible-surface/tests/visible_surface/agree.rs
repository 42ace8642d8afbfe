//! The methods against each other and against brute force, on small grids where everything degenerate is common.

use proptest::prelude::*;
use sightlines_geometry::Point3;
use sightlines_visible_surface::{
    BspOptions, Camera, Comparison, DepthFormat, FaceBsp, FaceMask, Faces, Newell, Painter, RayCaster, RenderInput,
    Schumacker, SchumackerOptions, VisibleSurface, ZBuffer, compare,
};
use std::cell::Cell;

/// All methods that are right by their promise.
fn exact_methods(faces: &Faces) -> Vec<Box<dyn VisibleSurface>> {
    let bsp = FaceBsp::build(faces, &BspOptions::default());
    vec![
        Box::new(ZBuffer::new(DepthFormat::Exact)),
        Box::new(RayCaster::build(faces)),
        Box::new(Newell),
        Box::new(bsp.clone()),
        Box::new(bsp.front_to_back()),
        Box::new(Schumacker::build(faces, &SchumackerOptions::default())),
    ]
}

/// Points of a grid, some a unit in the last place beside it, scaled.
fn point(range: i32) -> impl Strategy<Value = Point3> {
    let ulps = prop::sample::select(vec![0i64, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, -1]);
    let one = (-range..=range, ulps).prop_map(|(x, ulps)| {
        let x = f64::from(x) * 0.125;
        if x == 0.0 { 0.0 } else { f64::from_bits(x.to_bits().wrapping_add_signed(ulps)) }
    });
    [one.clone(), one.clone(), one]
}

/// Rays through points of the grid, looking along an axis or aslant; some see a range of depths only.
fn camera() -> impl Strategy<Value = Camera> {
    let rays = prop::sample::select(vec![
        [[-0.4375, 0.4375, -0.5], [0.125, 0.0, 0.0], [0.0, -0.125, 0.0]],
        [[-0.5, 0.5, 0.5], [0.0, 0.0, -0.125], [0.0, -0.125, 0.0]],
        [[-0.5, 0.25, -0.5], [0.125, 0.0, 0.125], [0.0, -0.125, 0.0625]],
        [[0.0, 0.5, -0.5], [0.1, 0.0, 0.1], [0.03, -0.125, -0.07]],
    ]);
    let depths =
        prop::sample::select(vec![[0.0, f64::INFINITY], [0.0, f64::INFINITY], [0.5, 1.5], [0.3, f64::INFINITY]]);
    (point(4), rays, depths).prop_map(|(eye, [corner, across, down], [near, far])| {
        let camera = Camera::new(eye, corner, across, down, [8, 8]).expect("rays that span space");
        camera.with_depths(near, far).expect("a range of depths")
    })
}

/// Few triangles of all shapes; slivers, coplanar ones, shared corners and no area at all are common.
fn faces() -> impl Strategy<Value = Faces> {
    prop::collection::vec([point(4), point(4), point(4)], 1..12).prop_map(|corners| Faces::new(corners).expect("small"))
}

/// Invariant: every exact method shows the face that brute force finds, in every pixel but those whose ray meets the line in which two
/// faces of different planes meet.
#[test]
fn exact_methods_show_what_is_seen() {
    let (covered, on_edge, ties) = (Cell::new(0), Cell::new(0), Cell::new(0));
    let mut runner = proptest::test_runner::TestRunner::default();
    let run = runner.run(&(faces(), camera()), |(faces, camera)| {
        let chosen = FaceMask::all(&faces);
        let input = RenderInput { faces: &faces, camera: &camera, mask: &chosen };
        let truth = crate::oracle::look(&faces, &camera, &chosen);
        for method in exact_methods(&faces) {
            let (image, counters) = method.picture(&input);
            prop_assert_eq!(truth.wrong(&image), vec![], "{}", method.name());
            prop_assert_eq!(counters.covered as usize, truth.n_covered(), "{}", method.name());
        }
        covered.set(covered.get() + truth.n_covered());
        on_edge.set(on_edge.get() + truth.on_edge.iter().filter(|e| **e).count());
        ties.set(ties.get() + truth.n_in_doubt());
        Ok(())
    });
    assert_eq!(run, Ok(()));
    // The property covers hard cases, and few are left out.
    assert!(covered.get() > 100 && on_edge.get() > 10, "{} {}", covered.get(), on_edge.get());
    assert!(ties.get() * 10 < covered.get(), "{} of {}", ties.get(), covered.get());
}

/// Coordinates of any size that is accepted, from 2^-140 to 2^200, and eyes among them.
fn extreme() -> impl Strategy<Value = Point3> {
    let power = prop::sample::select(vec![-137i32, -60, -20, 0, 0, 0, 20, 60, 197]);
    let one = (-4i32..=4, power).prop_map(|(x, power)| f64::from(x) * 2f64.powi(power));
    [one.clone(), one.clone(), one]
}

/// Invariant: huge and tiny coordinates, alone and mixed, change nothing of this, and nothing panics, whatever the method.
#[test]
fn coordinates_of_any_size_are_drawn() {
    let covered = Cell::new(0);
    let mut runner = proptest::test_runner::TestRunner::default();
    let mixed = || prop_oneof![3 => point(4), 2 => extreme()];
    let faces = prop::collection::vec([mixed(), mixed(), mixed()], 1..6);
    let eyes = prop_oneof![3 => point(4), 1 => extreme()];
    let powers = prop::sample::select(vec![-90i32, -40, 0, 0, 0, 40, 97]);
    let run = runner.run(&(faces, eyes, camera(), powers, 0..5u32), |(corners, eye, camera, power, wide)| {
        // The same rays with another unit of depth; and now and then a very wide picture of them.
        let [corner, across, down] = camera.rays().map(|ray| ray.map(|x| x * 2f64.powi(power)));
        let (across, size) = if wide == 0 { (across.map(|x| x / 64.0), [400, 2]) } else { (across, [5, 7]) };
        let camera = Camera::new(eye, corner, across, down, size).expect("an eye of any size");
        let faces = Faces::new(corners).expect("accepted coordinates");
        let chosen = FaceMask::all(&faces);
        let input = RenderInput { faces: &faces, camera: &camera, mask: &chosen };
        let truth = crate::oracle::look(&faces, &camera, &chosen);
        for method in exact_methods(&faces) {
            prop_assert_eq!(truth.wrong(&method.picture(&input).0), vec![], "{}", method.name());
        }
        for format in DepthFormat::ALL {
            ZBuffer::new(format).picture(&input);
        }
        Painter.picture(&input);
        covered.set(covered.get() + truth.n_covered());
        Ok(())
    });
    assert_eq!(run, Ok(()));
    assert!(covered.get() > 100, "only {} pixels", covered.get());
}

/// The impostor: a picture with one pixel changed is found out, by the comparison and by the oracle.
#[test]
fn a_wrong_pixel_is_found() {
    let far = [[-9., -9., -3.], [9., -9., -3.], [0., 9., -3.]];
    let faces = Faces::new(vec![far, far.map(|[x, y, _]| [x / 9., y / 9., -2.])]).unwrap();
    let camera = Camera::look_at([0.; 3], [0., 0., -1.], [0., 1., 0.], 90.0, [32, 32]).unwrap();
    let chosen = FaceMask::all(&faces);
    let input = RenderInput { faces: &faces, camera: &camera, mask: &chosen };
    let (truth, reference) =
        (crate::oracle::look(&faces, &camera, &chosen), RayCaster::build(&faces).picture(&input).0);
    assert_eq!(compare(&input, &reference, &reference), Comparison::default());
    assert_eq!((reference.at(16, 16), truth.wrong(&reference)), (1, vec![]));
    for shown in [0, sightlines_visible_surface::NOTHING] {
        let mut wrong = reference.clone();
        wrong.faces_mut()[16 * 32 + 16] = shown;
        assert_eq!(compare(&input, &reference, &wrong), Comparison { wrong: vec![[16, 16]], ties: 0 });
        assert_eq!(truth.wrong(&wrong).len(), 1);
    }
}
