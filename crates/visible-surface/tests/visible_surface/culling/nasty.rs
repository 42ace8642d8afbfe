//! Coordinates at the ends of their range, faces through the eye's plane, slivers: nothing panics, and no pixel changes.

use crate::culling::oracle::Chance;
use proptest::prelude::*;
use sightlines_geometry::{Aabb, Point3};
use sightlines_visible_surface::cull::{self, Frustum};
use sightlines_visible_surface::hierarchical::{self, DepthPyramid};
use sightlines_visible_surface::{Camera, FaceMask, Faces, RayCaster, RenderInput, VisibleSurface};

fn coordinate(chance: &mut Chance, scale: i32) -> f64 {
    match chance.below(12) {
        0 => 0.0,
        1 => 2f64.powi(200),
        2 => -(2f64.powi(200)),
        3 => 2f64.powi(-140),
        _ => chance.within(40) as f64 / 8.0 * 2f64.powi(scale),
    }
}

fn scene(chance: &mut Chance) -> (Camera, Vec<[Point3; 3]>) {
    let scale = [0, 0, 190, -130][chance.below(4) as usize];
    let unit = 2f64.powi(scale);
    let mut corners: Vec<[Point3; 3]> =
        (0..24).map(|_| [0; 3].map(|_| [0; 3].map(|_| coordinate(chance, scale)))).collect();
    // A wall of two, slivers, and what passes through the eye's plane.
    let [a, b, c, d] =
        [[-9., -9., 2.], [9., -9., 2.], [9., 9., 2.5], [-9., 9., 2.5]].map(|p: Point3| p.map(|x| x * unit));
    corners.extend([[a, b, c], [a, c, d], [a, c, c.map(|x| x + x * 1e-15)], [a, b, [0.0, 0.0, -unit]]]);
    let size = [1 + chance.below(20) as u32, 1 + chance.below(20) as u32];
    let eye = [0; 3].map(|_| chance.within(8) as f64 / 8.0 * unit);
    let tilt = [0; 3].map(|_| chance.within(8) as f64 / 16.0);
    let rays = [
        [-1.0 + tilt[0], 1.0 + tilt[1], 1.0],
        [2.0 / f64::from(size[0]), tilt[2] / 32.0, 0.0],
        [0.0, -2.0 / f64::from(size[1]), 0.01],
    ];
    let camera = Camera::new(eye, rays[0], rays[1], rays[2], size).expect("these rays span space");
    let [near, far] = [[0.0, f64::INFINITY], [unit / 8.0, 8.0 * unit], [0.0, 3.0 * unit], [unit, f64::INFINITY]]
        [chance.below(4) as usize];
    (camera.with_depths(near, far).expect("near is less than far"), corners)
}

proptest! {
    #[test]
    fn no_pixel_changes(seed in any::<u64>()) {
        let mut chance = Chance(seed);
        let (camera, corners) = scene(&mut chance);
        let faces = Faces::new(corners).unwrap();
        let caster = RayCaster::build(&faces);
        let all = FaceMask::all(&faces);
        let picture = |chosen: &FaceMask| caster.picture(&RenderInput { faces: &faces, camera: &camera, mask: chosen }).0;
        let whole = picture(&all);
        let mut left = all.clone();
        cull::frustum(&faces, &camera, &mut left);
        prop_assert_eq!(&picture(&left), &whole, "outside of the volume");
        for pyramid in [DepthPyramid::sampled(&faces, &camera, &whole), DepthPyramid::conservative(&faces, &camera, &all)] {
            let mut left = all.clone();
            hierarchical::cull(&faces, &mut left, &pyramid);
            prop_assert_eq!(&picture(&left), &whole, "hidden: {:?}", pyramid.rays());
            // What the conservative one hides is hidden from the centres too.
            let frustum = Frustum::of(&camera);
            for _ in 0..8 {
                let points = [0; 2].map(|_| [0; 3].map(|_| coordinate(&mut chance, 0)));
                let b = Aabb::around(points);
                let _ = (pyramid.hides(&b), frustum.of_box(&b), frustum.of_sphere(b.min, b.max[0].abs()));
            }
        }
    }
}

/// So far away that doubles of places say nothing: what is not known is visible.
#[test]
fn far_away_and_close_by() {
    for scale in [-130, 0, 150] {
        let unit = 2f64.powi(scale);
        let at = |p: Point3| p.map(|x| x * unit);
        let camera = Camera::look_at([0.0; 3], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0], 90.0, [40, 30]).unwrap();
        let [a, b, c, d] = [[-9., -9., 2.], [9., -9., 2.], [9., 9., 2.], [-9., 9., 2.]].map(at);
        let faces = Faces::new(vec![[a, b, c], [a, c, d]]).unwrap();
        let all = FaceMask::all(&faces);
        let image = RayCaster::build(&faces).picture(&RenderInput { faces: &faces, camera: &camera, mask: &all }).0;
        for pyramid in
            [DepthPyramid::sampled(&faces, &camera, &image), DepthPyramid::conservative(&faces, &camera, &all)]
        {
            let hides = |min, max| pyramid.hides(&Aabb { min: at(min), max: at(max) });
            assert!(hides([-1., -1., 2.001], [1., 1., 3.]), "2^{scale}");
            assert!(!hides([-1., -1., 1.999], [1., 1., 3.]), "2^{scale}");
            assert!(!hides([-1., -1., 2.], [1., 1., 3.]), "2^{scale}");
            // The whole picture at once.
            assert!(hides([-99., -99., 2.001], [99., 99., 3.]), "2^{scale}");
        }
    }
}
