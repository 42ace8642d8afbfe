//! The painter, which is wrong on known cases, and any order, which is right for convex objects.

use crate::oracle::look;
use crate::soups::{Triangle, cameras, cube};
use proptest::prelude::*;
use sightlines_geometry::Point3;
use sightlines_scenes::{SurfaceOptions, coplanar, cycles, interleaved, lattice, surfaces};
use sightlines_visible_surface::{
    AnyOrder, BspOptions, Camera, DepthFormat, FaceBsp, FaceMask, Faces, Image, Newell, Painter, RayCaster,
    RenderInput, Schumacker, SchumackerOptions, VisibleSurface, ZBuffer, is_convex,
};

fn picture(method: &dyn VisibleSurface, faces: &Faces, camera: &Camera) -> Image {
    method.picture(&RenderInput { faces, camera, mask: &FaceMask::all(faces) }).0
}

fn n_wrong(method: &dyn VisibleSurface, faces: &Faces, camera: &Camera) -> usize {
    look(faces, camera, &FaceMask::all(faces)).wrong(&picture(method, faces, camera)).len()
}

/// A long face that leads away from the eye and a short one before its far end: by mid-points the wrong one is farther.
/// Three in a circle, a lattice and faces in one plane are wrong too.
#[test]
fn the_painter_is_wrong_where_mid_points_mislead_and_the_others_are_right() {
    let camera = Camera::look_at(surfaces::EYE, surfaces::AT, surfaces::UP, surfaces::ANGLE, [64, 48]).unwrap();
    let some = SurfaceOptions { triangles: 12, ..SurfaceOptions::default() };
    for scene in [interleaved(2), cycles(3), lattice(60), coplanar(some)] {
        let faces = Faces::of_scene(&scene.unwrap()).unwrap();
        let n = n_wrong(&Painter, &faces, &camera);
        assert!(n > 5, "{n} {}", faces.len());
        let bsp = FaceBsp::build(&faces, &BspOptions::default());
        let schumacker = Schumacker::build(&faces, &SchumackerOptions::default());
        let (zbuffer, rays) = (ZBuffer::new(DepthFormat::Exact), RayCaster::build(&faces));
        let others: [&dyn VisibleSurface; 5] = [&Newell, &bsp, &schumacker, &zbuffer, &rays];
        for method in others {
            assert_eq!(n_wrong(method, &faces, &camera), 0, "{}", method.name());
        }
    }
    // Of the pair it is exactly the short one that is missing.
    let faces = Faces::of_scene(&interleaved(2).unwrap()).unwrap();
    let truth = look(&faces, &camera, &FaceMask::all(&faces));
    let wrong = truth.wrong(&picture(&Painter, &faces, &camera));
    assert!(wrong.iter().all(|&(_, seen, shown)| (seen, shown) == (Some(1), Some(0))));
    assert_eq!(wrong.len(), truth.faces.iter().filter(|&&f| f == Some(1)).count());
}

/// Tightness: faces across the view behind each other are what the painter is right for, whatever their ids.
#[test]
fn the_painter_is_right_for_faces_across_the_view() {
    let camera = Camera::look_at([0.0; 3], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0], 60.0, [64, 64]).unwrap();
    let at = |k: usize| {
        let (x, z) = (k as f64 * 0.25 - 1.0, 4.0 + (k * 5 % 8) as f64);
        [[x - 2.0, -2.0, z], [x + 2.0, -2.0, z], [x, 2.0, z]]
    };
    let faces = Faces::new((0..8).map(at).chain((0..8).map(at)).collect()).unwrap();
    assert_eq!(n_wrong(&Painter, &faces, &camera), 0);
}

fn octahedron(size: f64) -> Vec<Triangle> {
    let axis = |k: usize, up: bool| [0, 1, 2].map(|j| if j == k { if up { size } else { -size } } else { 0.0 });
    (0..8)
        .map(|i| {
            let [a, b, c] = [0, 1, 2].map(|k| axis(k, i >> k & 1 == 1));
            // Mirroring along one axis turns the way round.
            if i32::count_ones(i) % 2 == 1 { [a, b, c] } else { [a, c, b] }
        })
        .collect()
}

/// A tetrahedron that is turned outwards.
fn tetrahedron([a, b, c, d]: [Point3; 4]) -> Vec<Triangle> {
    let outwards = vec![[a, b, c], [a, c, d], [a, d, b], [b, d, c]];
    if sightlines_geometry::orient3d(a, b, c, d) > 0.0 {
        outwards.into_iter().map(|[a, b, c]| [a, c, b]).collect()
    } else {
        outwards
    }
}

fn convex() -> impl Strategy<Value = Vec<Triangle>> {
    let corner = || [0..=4i8, 0..=4i8, 0..=4i8].prop_map(|p| p.map(f64::from));
    let four = [corner(), corner(), corner(), corner()];
    let solid = four.prop_filter("has no volume", |[a, b, c, d]| sightlines_geometry::orient3d(*a, *b, *c, *d) != 0.0);
    prop_oneof![
        solid.prop_map(tetrahedron),
        (corner(), 1..=4i8).prop_map(|(at, size)| cube(at, f64::from(size))),
        (1..=3i8).prop_map(|size| octahedron(f64::from(size))),
    ]
}

proptest! {
    /// Invariant: a convex object's faces in any order show what is seen from everywhere outside of it; from inside all
    /// face away.
    #[test]
    fn any_order_is_right_for_convex_objects(
        mut object in convex(),
        by in any::<prop::sample::Index>(),
        camera in cameras(16),
    ) {
        let by = by.index(object.len());
        object.rotate_left(by);
        let faces = Faces::new(object).unwrap();
        prop_assert!(is_convex(&faces, faces.ids()));
        let mut front = FaceMask::all(&faces);
        front.retain(|f| sightlines_visible_surface::InputPlane::Face(f).side(&faces, camera.eye()) > 0);
        let truth = look(&faces, &camera, &front);
        prop_assert_eq!(truth.wrong(&picture(&AnyOrder, &faces, &camera)), vec![]);
        // One face fewer, or one the other way round, is no whole boundary.
        prop_assert!(!is_convex(&faces, faces.ids().skip(1)));
        let mut turned = faces.corners().to_vec();
        turned[0].swap(0, 1);
        let turned = Faces::new(turned).unwrap();
        prop_assert!(!is_convex(&turned, turned.ids()));
    }
}

/// The boundary with a corner in the middle of every edge: each triangle becomes four.
fn divided(object: &[Triangle]) -> Vec<Triangle> {
    let middle = |a: Point3, b: Point3| [0, 1, 2].map(|k| (a[k] + b[k]) / 2.0);
    object
        .iter()
        .flat_map(|&[a, b, c]| {
            let [p, q, r] = [middle(a, b), middle(b, c), middle(c, a)];
            [[a, p, r], [p, b, q], [r, q, c], [p, q, r]]
        })
        .collect()
}

#[test]
fn only_whole_boundaries_of_one_convex_object_are_convex() {
    let says = |object: Vec<Triangle>| {
        let faces = Faces::new(object).unwrap();
        is_convex(&faces, faces.ids())
    };
    let box_ = cube([0.0; 3], 2.0);
    assert!(says(box_.clone()) && says(divided(&box_)) && says(octahedron(3.0)) && says(Vec::new()));
    // Both sides of a face are an object without volume, and a face without area is nothing.
    let [a, b, c] = box_[0];
    assert!(says(vec![[a, b, c], [a, c, b]]) && says([box_.clone(), vec![[a, b, b]]].concat()));
    assert!(!says(vec![[a, b, c]]));
    // Turned inwards; two of them; with another inside; and the same boundary twice, once with other corners.
    let inwards = box_.iter().map(|&[a, b, c]| [a, c, b]).collect();
    let others = [cube([5.0; 3], 1.0), cube([0.5; 3], 1.0), divided(&box_), box_.clone()];
    assert!(!says(inwards));
    for other in others {
        assert!(!says([box_.clone(), other].concat()));
    }
    // A dent: one corner of the box moved into it.
    let dented = box_.iter().map(|t| t.map(|p| if p == [2.0; 3] { [0.75; 3] } else { p })).collect();
    assert!(!says(dented));
}

/// The impostor: for an object that is not convex the order matters, and the comparison shows it.
#[test]
fn any_order_is_wrong_for_other_objects() {
    let camera = Camera::look_at([1.0, 1.0, 20.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], 20.0, [32, 32]).unwrap();
    let two = [cube([0.0, 0.0, 3.0], 2.0), cube([0.5, 0.5, 0.0], 2.0)].concat();
    let faces = Faces::new(two).unwrap();
    assert!(!is_convex(&faces, faces.ids()) && n_wrong(&AnyOrder, &faces, &camera) > 50);
    assert_eq!(n_wrong(&Newell, &faces, &camera), 0);
}
