use super::*;
use num_rational::BigRational;
use num_traits::{Signed, Zero};
use proptest::prelude::*;

type R3 = [BigRational; 3];

fn rational(p: Point3) -> R3 {
    p.map(|x| BigRational::from_float(x).expect("finite"))
}

fn sub(a: &R3, b: &R3) -> R3 {
    [0, 1, 2].map(|k| &a[k] - &b[k])
}

fn det(a: &R3, b: &R3, c: &R3) -> BigRational {
    let minor = |i: usize, j: usize| &b[i] * &c[j] - &b[j] * &c[i];
    &a[0] * minor(1, 2) + &a[1] * minor(2, 0) + &a[2] * minor(0, 1)
}

fn sign(x: &BigRational) -> i32 {
    if x.is_zero() {
        0
    } else if x.is_positive() {
        1
    } else {
        -1
    }
}

/// Points of a coarse grid, and some a few units in the last place beside it.
fn point() -> impl Strategy<Value = Point3> {
    let one = (-2i32..3, prop::sample::select(vec![0i64, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, -1])).prop_map(
        |(x, ulps)| {
            let x = f64::from(x) * 0.125;
            if x == 0.0 { 0.0 } else { f64::from_bits(x.to_bits().wrapping_add_signed(ulps)) }
        },
    );
    [one.clone(), one.clone(), one]
}

/// An eye on the grid whose rays pass through points of the grid.
fn camera(eye: Point3) -> Camera {
    Camera::new(eye, [-0.3125, 0.3125, -0.5], [0.125, 0.0, 0.0], [0.0, -0.125, 0.0], [4, 4])
        .expect("rays that span space")
}

fn ray(camera: &Camera, x: u32, y: u32) -> R3 {
    let [c, a, d] = camera.rays().map(rational);
    let half = |n: u32| BigRational::from_float(f64::from(n) + 0.5).expect("finite");
    [0, 1, 2].map(|k| &c[k] + &a[k] * half(x) + &d[k] * half(y))
}

/// How often a sign was 0, so that the property is known to ask about that.
fn zeros(count: &std::cell::Cell<u64>, sign: i32) {
    count.set(count.get() + u64::from(sign == 0));
}

#[test]
fn signs_are_those_of_fractions() {
    let count = std::cell::Cell::new(0);
    let mut runner = proptest::test_runner::TestRunner::default();
    let corners = || [point(), point(), point()];
    let run = runner.run(&(point(), corners(), corners(), 0u32..4, 0u32..4), |(eye, a, b, x, y)| {
        let camera = camera(eye);
        let Ok(faces) = Faces::new(vec![a, b]) else { return Ok(()) };
        let (e, d) = (rational(eye), ray(&camera, x, y));
        // Edges.
        let edge = Side::edge(&camera, a[0], a[1]);
        let want = sign(&det(&sub(&rational(a[0]), &e), &sub(&rational(a[1]), &e), &d));
        prop_assert_eq!(edge.sign(&camera, &faces, x, y), want);
        prop_assert_eq!(Side::edge(&camera, a[1], a[0]).sign(&camera, &faces, x, y), -want);
        prop_assert_eq!(edge.clone().times(-1).sign(&camera, &faces, x, y), -want);
        zeros(&count, want);
        // Exactly one side of a line has a pixel, unless the line is none.
        let other = Side::edge(&camera, a[1], a[0]);
        let both = [edge.has(&camera, &faces, x, y), other.has(&camera, &faces, x, y)];
        let line = [[0, 0], [3, 0], [0, 3]]
            .map(|[x, y]| sign(&det(&sub(&rational(a[0]), &e), &sub(&rational(a[1]), &e), &ray(&camera, x, y))));
        prop_assert_eq!(both[0] != both[1], line != [0; 3], "{:?}", both);
        if !(faces.has_area(0) && faces.has_area(1)) {
            return Ok(());
        }
        // Which plane is met first, and whether before a depth.
        let [first, second] = [0, 1].map(|f| InputPlane::of(&faces, f));
        let depth = |t: [Point3; 3]| {
            let [p, q, r] = t.map(rational);
            let (u, v) = (sub(&q, &p), sub(&r, &p));
            (det(&u, &v, &sub(&p, &e)), det(&u, &v, &d))
        };
        let ((over_a, under_a), (over_b, under_b)) = (depth(a), depth(b));
        let eyes = [&first, &second].map(|p| eye_sign(&camera, &faces, p));
        prop_assert!(eyes[0].abs() == sign(&over_a).abs() && eyes[1].abs() == sign(&over_b).abs());
        let in_front = |over: &BigRational, under: &BigRational| (over * under).is_positive();
        if in_front(&over_a, &under_a) && in_front(&over_b, &under_b) {
            let (t_a, t_b) = (&over_a / &under_a, &over_b / &under_b);
            let got = Side::cut(&camera, &faces, first, second).sign(&camera, &faces, x, y) * eyes[0] * eyes[1];
            prop_assert_eq!(got, sign(&(t_b - &t_a)));
            zeros(&count, got);
            for limit in [0.5, 1.0, 0.3] {
                let got = Side::depth(&camera, &faces, first, limit).sign(&camera, &faces, x, y) * eyes[0];
                prop_assert_eq!(got, sign(&(&t_a - BigRational::from_float(limit).expect("finite"))));
            }
        }
        Ok(())
    });
    assert_eq!(run, Ok(()));
    assert!(count.get() > 0, "too few lines met a pixel's centre: {}", count.get());
}
