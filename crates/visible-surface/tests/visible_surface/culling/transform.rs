//! Planes, normals and back faces under matrices.

use crate::culling::oracle::{Chance, Eye, P, cross, dot, minus, real};
use proptest::prelude::*;
use sightlines_geometry::{Point3, orient3d};
use sightlines_visible_surface::cull::transform::{
    Matrix, determinant_sign, facing_in_projection, normal, plane, plane_of, point, projection, triangle,
};
use sightlines_visible_surface::cull::{Facing, facing};

type M = [[i128; 4]; 4];

fn determinant(m: &M) -> i128 {
    let others = |k: usize| [0, 1, 2, 3].into_iter().filter(move |&i| i != k).collect::<Vec<_>>();
    let minor = |c: usize| {
        let c = others(c);
        let row = |r: usize| [m[r][c[0]], m[r][c[1]], m[r][c[2]]];
        dot(row(1), cross(row(2), row(3)))
    };
    m[0][0] * minor(0) - m[0][1] * minor(1) + m[0][2] * minor(2) - m[0][3] * minor(3)
}

fn doubles(m: &M) -> Matrix {
    m.map(|row| row.map(|x| x as f64))
}

fn number() -> impl Strategy<Value = i128> + Clone {
    (-3i32..4).prop_map(i128::from)
}

fn any_point() -> impl Strategy<Value = P> {
    [number(), number(), number()]
}

fn any_matrix() -> impl Strategy<Value = M> {
    let row = [number(), number(), number(), number()];
    [row.clone(), row.clone(), row.clone(), row]
}

/// Scales, shears and reflections among them.
fn affine() -> impl Strategy<Value = M> {
    any_matrix().prop_map(|mut m| {
        m[3] = [0, 0, 0, 1];
        m
    })
}

fn sign(x: f64) -> i32 {
    i32::from(x > 0.0) - i32::from(x < 0.0)
}

proptest! {
    #[test]
    fn planes_go_with_their_points(m in any_matrix(), face in [any_point(), any_point(), any_point()], p in any_point()) {
        let det = determinant(&m);
        prop_assert_eq!(determinant_sign(&doubles(&m)), Some(det.signum() as i32));
        let before = plane_of(&face.map(real));
        let Some(after) = plane(&doubles(&m), before) else {
            prop_assert_eq!(det, 0);
            return Ok(());
        };
        let [x, y, z] = real(p);
        let value = |plane: [f64; 4], p: [f64; 4]| (0..4).map(|k| plane[k] * p[k]).sum::<f64>();
        // Whole numbers this small are not rounded.
        let moved = point(&doubles(&m), [x, y, z, 1.0]);
        prop_assert_eq!(value(after, moved), det.abs() as f64 * value(before, [x, y, z, 1.0]));
    }

    #[test]
    fn the_front_stays_the_front(m in affine(), face in [any_point(), any_point(), any_point()], eye in any_point()) {
        let corners = face.map(real);
        let [a, b, c] = corners;
        let Some([p, q, r]) = triangle(&doubles(&m), &corners) else {
            prop_assert_eq!(determinant(&m), 0);
            return Ok(());
        };
        let [x, y, z] = real(eye);
        let [x, y, z, _] = point(&doubles(&m), [x, y, z, 1.0]);
        let moved = [x, y, z];
        prop_assert_eq!(sign(orient3d(p, q, r, moved)), sign(orient3d(a, b, c, real(eye))));
        prop_assert_eq!(facing(&[p, q, r], [moved]), facing(&corners, [real(eye)]));
        // The plane of the transformed corners is the transformed plane.
        let (direct, through) = (plane_of(&[p, q, r]), plane(&doubles(&m), plane_of(&corners)).unwrap());
        prop_assert_eq!(direct, through);
    }

    #[test]
    fn normals_are_at_right_angles_and_of_length_1(m in affine(), face in [any_point(), any_point(), any_point()]) {
        let corners = face.map(real);
        let [a, b, c] = face;
        let n = cross(minus(b, a), minus(c, a));
        let Some(after) = normal(&doubles(&m), real(n)) else {
            prop_assert!(determinant(&m) == 0 || n == [0; 3]);
            return Ok(());
        };
        let length = |v: Point3| v.iter().map(|x| x * x).sum::<f64>().sqrt();
        prop_assert!((length(after) - 1.0).abs() < 1e-14);
        // The true normal is one of whole numbers, so the unit one differs from it by its roundings.
        let of = triangle(&doubles(&m), &corners).unwrap();
        let true_normal = plane_of(&of);
        for k in 0..3 {
            let want = true_normal[k] / length([true_normal[0], true_normal[1], true_normal[2]]);
            prop_assert!((after[k] - want).abs() < 1e-14);
        }
    }

    /// The sign of the z coefficient in projection space is the exact sign at the eye, whatever the face passes through.
    #[test]
    fn projection_space_agrees_with_object_space(seed in any::<u64>(), face in [any_point(), any_point(), any_point()]) {
        let eye = Eye::any(&mut Chance(seed));
        let camera = eye.camera();
        let corners = face.map(real);
        let want = facing(&corners, [real(eye.eye)]);
        prop_assert_eq!(facing_in_projection(&projection(&camera), &corners), want);
        // Reversed depth, and one that is negative in front as some use, are perspectives of the same eye.
        let mut reversed = projection(&camera);
        reversed[2] = std::array::from_fn(|k| reversed[3][k] - reversed[2][k]);
        prop_assert_eq!(facing_in_projection(&reversed, &corners), want);
        let negative = projection(&camera).map(|row| row.map(|x| -x));
        prop_assert_eq!(facing_in_projection(&negative, &corners), want);
    }

    /// A third way: the order in which the corners go round in the picture, where they are all in front of the eye.
    #[test]
    fn corners_go_round_as_the_face_is_turned(seed in any::<u64>(), face in [any_point(), any_point(), any_point()]) {
        let eye = Eye::any(&mut Chance(seed));
        let m = projection(&eye.camera());
        let place = |p: P| {
            let [x, y, z] = real(p);
            point(&m, [x, y, z, 1.0])
        };
        // What is behind the eye is sent through it.
        let face = face.map(|p| if place(p)[3] < 0.0 { [0, 1, 2].map(|k| 2 * eye.eye[k] - p[k]) } else { p });
        let places = face.map(place);
        if places.iter().any(|p| p[3] == 0.0) {
            return Ok(());
        }
        // Times the product of all w, which is positive: no division.
        let row = |k: usize| places.map(|p| p[k] as i128);
        let area = dot(row(0), cross(row(1), row(3)));
        // To the right and down the front goes round clockwise, unless the picture is mirrored.
        let mirrored = dot(eye.rays[1], cross(eye.rays[2], eye.rays[0])) < 0;
        let front = if mirrored { area > 0 } else { area < 0 };
        let got = facing_in_projection(&m, &face.map(real));
        prop_assert_eq!(got, if front { Facing::Front } else { Facing::Back });
    }

    /// Of a parallel projection the eye is infinitely far away where z is least.
    #[test]
    fn parallel_projections_look_along_z(m in affine(), face in [any_point(), any_point(), any_point()]) {
        let det = determinant(&m);
        // What is sent to (0, 0, z): the cross product of rows 0 and 1, which z grows along or against.
        let [x, y, z] = [0, 1, 2].map(|k| [m[k][0], m[k][1], m[k][2]]);
        let ahead = cross(x, y).map(|v| v * dot(z, cross(x, y)).signum());
        let [a, b, c] = face;
        let want = match dot(cross(minus(b, a), minus(c, a)), ahead) {
            _ if det == 0 => Facing::Mixed,
            x if x < 0 => Facing::Front,
            _ => Facing::Back,
        };
        prop_assert_eq!(facing_in_projection(&doubles(&m), &face.map(real)), want);
    }
}

/// The impostor: a normal transformed like a point is wrong, and the tests above would see it.
#[test]
fn transforming_normals_by_the_matrix_is_wrong() {
    let mut chance = Chance(5);
    let (mut n_wrong, mut n_right, mut n) = (0, 0, 0);
    while n < 1000 {
        let mut m: M = [0; 4].map(|_| [0; 4].map(|_| chance.within(3)));
        m[3] = [0, 0, 0, 1];
        let (corners, eye) = ([0; 3].map(|_| real(chance.point(3))), real(chance.point(3)));
        let before = plane_of(&corners);
        let Some([a, b, c]) = triangle(&doubles(&m), &corners).filter(|_| before[..3] != [0.0; 3]) else { continue };
        n += 1;
        let [x, y, z, _] = point(&doubles(&m), [eye[0], eye[1], eye[2], 1.0]);
        let way = [x - a[0], y - a[1], z - a[2]];
        let truth = sign(orient3d(a, b, c, [x, y, z]));
        let [u, v, w] = [0, 1, 2].map(|k| (0..3).map(|i| m[k][i] as f64 * before[i]).sum::<f64>());
        let naive = sign(u * way[0] + v * way[1] + w * way[2]);
        n_wrong += usize::from(naive != truth);
        let rescaled = normal(&doubles(&m), [before[0], before[1], before[2]]).unwrap();
        // The unit normal is rounded, so it may not know edge-on.
        let right = rescaled[0] * way[0] + rescaled[1] * way[1] + rescaled[2] * way[2];
        n_right += usize::from(truth == 0 || sign(right) == truth);
    }
    assert!(n_wrong > 200, "{n_wrong} of {n} are seen from the wrong side");
    assert_eq!(n_right, n);
    // Non-uniform scale: the slope of a roof that is made four times as high.
    let tall: Matrix = [[1., 0., 0., 0.], [0., 1., 0., 0.], [0., 0., 4., 0.], [0., 0., 0., 1.]];
    let n = normal(&tall, [1.0, 0.0, 1.0]).unwrap();
    // The roof rises towards -x: a step along it is (-1, 0, 1), which becomes (-1, 0, 4).
    assert!((-n[0] + 4.0 * n[2]).abs() < 1e-15, "{n:?}");
    assert!((-1.0 + 4.0 * 4.0f64).abs() > 1.0, "by the matrix itself it would be (1, 0, 4)");
    // A reflection leaves a normal that it does not move.
    let mirror: Matrix = [[-1., 0., 0., 0.], [0., 1., 0., 0.], [0., 0., 1., 0.], [0., 0., 0., 1.]];
    assert_eq!(normal(&mirror, [0.0, 3.0, 0.0]), Some([0.0, 1.0, 0.0]));
    assert_eq!(normal(&mirror, [2.0, 0.0, 0.0]), Some([-1.0, 0.0, 0.0]));
}

#[test]
fn signs_are_exact_where_doubles_are_not() {
    // Rows that are nearly the same: the determinant is 1 ulp.
    let up = 1.0f64.next_up();
    let near = |x: f64| [[x, 1., 0., 0.], [1., 1., 0., 0.], [0., 0., 1e-90, 0.], [0., 0., 0., 1e90]];
    let signs = [1.0f64.next_down(), 1.0, up].map(|x| determinant_sign(&near(x)));
    assert_eq!(signs, [Some(-1), Some(0), Some(1)]);
    let tiny = [[1e-150, 0., 0., 0.], [0., 1e-150, 0., 0.], [0., 0., 1e-150, 0.], [0., 0., 0., 1e-150]];
    assert_eq!(determinant_sign(&tiny), Some(1));
    let huge = tiny.map(|row| row.map(|x| x * 1e300));
    assert_eq!(determinant_sign(&huge), Some(1));
    for bad in [f64::NAN, f64::INFINITY] {
        let mut m = near(2.0);
        m[1][2] = bad;
        assert_eq!(determinant_sign(&m), None);
        assert_eq!((plane(&m, [1.0; 4]), normal(&m, [1.0; 3])), (None, None));
        let face = [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.]];
        assert_eq!(facing_in_projection(&m, &face), Facing::Mixed);
        assert_eq!(facing_in_projection(&near(2.0), &[[bad, 0., 0.], face[1], face[2]]), Facing::Mixed);
    }
    assert_eq!(normal(&near(2.0), [f64::NAN, 1.0, 0.0]), None);
}
