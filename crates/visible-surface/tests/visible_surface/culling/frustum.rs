//! The view volume against exact answers.

use crate::culling::oracle::{Chance, Eye, P, aabb, along, any_box, cross, dot, faces_of, minus, real};
use proptest::prelude::*;
use sightlines_visible_surface::FaceMask;
use sightlines_visible_surface::cull::{self, Cover, Frustum};

/// The eight corners of a volume with a nearest and a farthest depth.
fn corners(eye: &Eye) -> Vec<P> {
    let [width, height] = eye.size.map(i128::from);
    let edges = [(0, 0), (width, 0), (0, height), (width, height)].map(|(x, y)| eye.ray(1, x, y));
    let depths = [eye.near, eye.far.expect("a farthest depth")];
    edges.iter().flat_map(|&d| depths.map(|t| along(eye.eye, t, d))).collect()
}

fn corners_of([min, max]: &[P; 2]) -> Vec<P> {
    (0..8).map(|i| [0, 1, 2].map(|k| if i >> k & 1 == 0 { min[k] } else { max[k] })).collect()
}

/// Normals of the sides of the volume, inwards.
fn sides(eye: &Eye) -> [P; 5] {
    let [width, height] = eye.size.map(i128::from);
    let [corner, across, down] = eye.rays;
    let sign = dot(across, cross(down, corner)).signum();
    let depth = cross(across, down).map(|v| v * sign);
    let (x, y) = (cross(down, corner).map(|v| v * sign), cross(corner, across).map(|v| v * sign));
    [x, y, minus(depth.map(|v| v * width), x), minus(depth.map(|v| v * height), y), depth]
}

/// Whether closed convex sets are apart, exactly: some axis among the normals of both and the products of their edges separates.
fn apart(eye: &Eye, b: &[P; 2]) -> bool {
    let (volume, corners_b) = (corners(eye), corners_of(b));
    let [width, height] = eye.size.map(i128::from);
    let units = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
    let edges = [
        eye.ray(1, 0, 0),
        eye.ray(1, width, 0),
        eye.ray(1, 0, height),
        eye.ray(1, width, height),
        eye.rays[1],
        eye.rays[2],
    ];
    let products = edges.iter().flat_map(|&d| units.map(|u| cross(u, d)));
    units.into_iter().chain(sides(eye)).chain(products).any(|axis| {
        let range = |points: &[P]| {
            let all = points.iter().map(|&p| dot(axis, p));
            (all.clone().min().unwrap(), all.max().unwrap())
        };
        let (a, b) = (range(&volume), range(&corners_b));
        a.1 < b.0 || b.1 < a.0
    })
}

/// Whether all points are strictly inside of the volume.
fn strictly_inside(eye: &Eye, points: &[P]) -> bool {
    let [x, y, right, bottom, depth] = sides(eye);
    let volume = dot(depth, eye.rays[0]);
    points.iter().map(|&p| minus(p, eye.eye)).all(|way| {
        let t = dot(depth, way);
        [x, y, right, bottom].iter().all(|&n| dot(n, way) > 0)
            && (eye.near == 0 || t > eye.near * volume)
            && eye.far.is_none_or(|far| t < far * volume)
    })
}

proptest! {
    /// No face goes that a ray of the picture meets, edges of the picture included.
    #[test]
    fn no_face_goes_that_is_seen(seed in any::<u64>()) {
        let mut chance = Chance(seed);
        let eye = Eye::any(&mut chance);
        let corners: Vec<[P; 3]> = (0..12).map(|_| [0; 3].map(|_| chance.point(6))).collect();
        let faces = faces_of(&corners);
        let mut chosen = FaceMask::all(&faces);
        let before = chosen.clone();
        let gone = cull::frustum(&faces, &eye.camera(), &mut chosen);
        prop_assert_eq!(gone as usize, before.len() - chosen.len());
        for (face, corners) in (0..).zip(&corners).filter(|(f, _)| before.has(*f) && !chosen.has(*f)) {
            for (times, ray) in eye.fan(2) {
                prop_assert_eq!(eye.hit(times, ray, corners), None, "face {}", face);
            }
        }
    }

    #[test]
    fn balls_are_outside_only_if_they_are(seed in any::<u64>()) {
        let mut chance = Chance(seed);
        let mut eye = Eye::any(&mut chance);
        eye.far = Some(eye.far.unwrap_or(9));
        let frustum = Frustum::of(&eye.camera());
        let (centre, radius) = (chance.point(9), chance.below(5) as i128);
        let cover = frustum.of_sphere(real(centre), radius as f64);
        let square = |v: P| dot(v, v);
        // Points of the volume in the ball, or out of it.
        for (_, ray) in eye.fan(1) {
            for t in eye.near..=eye.far.unwrap() {
                let off = square(minus(along(eye.eye, t, ray), centre));
                prop_assert!(cover != Cover::Outside || off > radius * radius);
            }
        }
        // Surely beyond a side through the eye, by more than the radius: then it must be said.
        let way = minus(centre, eye.eye);
        if sides(&eye).iter().any(|&n| dot(n, way) < 0 && dot(n, way).pow(2) > radius * radius * square(n)) {
            prop_assert_eq!(cover, Cover::Outside);
        }
        // Inside means that no side is nearer than the radius.
        let deep = sides(&eye).iter().all(|&n| dot(n, way) > 0 && dot(n, way).pow(2) > radius * radius * square(n));
        prop_assert!(cover != Cover::Inside || deep);
    }
}

/// Sound and tight at once: counts against the exact answer.
#[test]
fn boxes_are_outside_only_if_they_are_and_mostly_then() {
    let mut chance = Chance(3);
    let (mut n_apart, mut n_outside, mut n_inside, mut n_said_inside, mut n) = (0, 0, 0, 0, 0);
    for _ in 0..20_000 {
        let mut eye = Eye::any(&mut chance);
        eye.far = Some(eye.far.unwrap_or(9));
        let mut b = any_box(&mut chance, 9);
        if n % 2 == 0 {
            // Small ones, of which some are inside.
            b[1] = [0, 1, 2].map(|k| b[1][k].min(b[0][k] + 1));
        }
        let frustum = Frustum::of(&eye.camera());
        let (cover, exact) = (frustum.of_box(&aabb(&b)), apart(&eye, &b));
        assert!(cover != Cover::Outside || exact, "{eye:?} {b:?}");
        let corners = corners_of(&b);
        let inside = strictly_inside(&eye, &corners);
        assert!(cover != Cover::Inside || inside, "{eye:?} {b:?}");
        // The hull of the same corners is the same set.
        let hull: Vec<_> = corners.iter().map(|&p| real(p)).collect();
        assert_eq!(frustum.of_hull(&hull), cover, "{eye:?} {b:?}");
        n += 1;
        n_apart += usize::from(exact);
        n_outside += usize::from(cover == Cover::Outside);
        n_inside += usize::from(inside);
        n_said_inside += usize::from(cover == Cover::Inside);
    }
    eprintln!("{n} boxes: {n_outside} of {n_apart} called outside, {n_said_inside} of {n_inside} inside");
    assert!(n_apart > 5000 && n_inside > 50, "both happen");
    assert!(n_outside * 100 >= n_apart * 97, "{n_outside} of {n_apart}");
    assert_eq!(n_said_inside, n_inside);
}

#[test]
fn the_smallest_box_alone_would_not_do() {
    // The impostor: sides left out. A box beside the volume is in the box around it.
    let eye = Eye { far: Some(10), ..Eye::ahead([0; 3], [4, 4]) };
    let frustum = Frustum::of(&eye.camera());
    let beside = aabb(&[[30, 0, 2], [31, 1, 3]]);
    let around = frustum.bounds();
    assert!((0..3).all(|k| beside.min[k] > around.min[k] && beside.max[k] < around.max[k]));
    assert_eq!(frustum.of_box(&beside), Cover::Outside);
    // And sides alone keep what is behind a large box's corner: the box around the volume is what drops it.
    let behind = aabb(&[[-100, -100, -3], [100, 100, -1]]);
    assert_eq!(frustum.of_box(&behind), Cover::Outside);
}

/// A ball behind the eye is outside of no side of a wide picture by its radius; it is behind all the same.
#[test]
fn balls_behind_the_eye_are_outside() {
    let mut eye = Eye::ahead([0; 3], [4, 4]);
    eye.rays[0] = [-4, 4, 1];
    let frustum = Frustum::of(&eye.camera());
    let ball = |z: f64| frustum.of_sphere([0.0, 0.0, z], 2.0);
    assert_eq!([-3.0, -1.0, 1.0, 30.0].map(ball), [Cover::Outside, Cover::Across, Cover::Across, Cover::Inside]);
}

#[test]
fn nonsense_is_kept() {
    let frustum = Frustum::of(&Eye::ahead([0; 3], [4, 4]).camera());
    for bad in [f64::NAN, f64::INFINITY, 1e300] {
        let mut b = aabb(&[[0, 0, -9], [1, 1, -8]]);
        assert_eq!(frustum.of_box(&b), Cover::Outside);
        b.max[1] = bad;
        assert_eq!(frustum.of_box(&b), Cover::Across);
        assert_eq!(frustum.of_hull(&[[0.0, bad, -9.0]]), Cover::Across);
        assert_eq!(frustum.of_sphere([0.0, bad, -9.0], 1.0), Cover::Across);
        assert_eq!(frustum.of_sphere([0.0, 0.0, -9.0], bad), Cover::Across);
    }
    assert_eq!(frustum.of_hull(&[]), Cover::Outside);
    assert_eq!(frustum.of_box(&sightlines_geometry::Aabb::EMPTY), Cover::Outside);
    assert_eq!(frustum.of_sphere([0.0, 0.0, 9.0], -1.0), Cover::Inside);
}

#[test]
fn objects_are_kept_by_a_table() {
    let corners = [[[0, 0, 1], [1, 0, 1], [0, 1, 1]]; 6];
    let faces = faces_of(&corners);
    let mut chosen = FaceMask::all(&faces);
    assert_eq!(cull::objects(&faces, &mut chosen, |object| object % 3 == 0), 4);
    assert_eq!(chosen.iter().collect::<Vec<_>>(), [0, 3]);
    assert_eq!(cull::objects(&faces, &mut chosen, |_| false), 2);
}
