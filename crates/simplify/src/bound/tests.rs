use super::*;
use proptest::prelude::*;
use sightlines_geometry::Random;

/// The share that a triangle takes up for an eye.
///
/// Van Oosterom and Strackee, "The solid angle of a plane triangle", IEEE Trans. Biomed. Eng. 30(2), 1983; the bound
/// uses no part of this.
fn exact(triangle: &[Point3; 3], eye: Point3) -> f64 {
    let [a, b, c] = triangle.map(|p| [0, 1, 2].map(|k| p[k] - eye[k]));
    let dot = |a: Point3, b: Point3| (0..3).map(|k| a[k] * b[k]).sum::<f64>();
    let cross = [b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]];
    let [x, y, z] = [a, b, c].map(|v| dot(v, v).sqrt());
    let below = x * y * z + dot(a, b) * z + dot(b, c) * x + dot(c, a) * y;
    2.0 * dot(a, cross).abs().atan2(below) / (4.0 * std::f64::consts::PI)
}

/// The largest share for eyes at the corners of the box and some inside.
fn largest(triangle: &[Point3; 3], eyes: &Aabb<3>, random: &mut Random) -> f64 {
    let corners = (0..8).map(|i| [0, 1, 2].map(|k| if i >> k & 1 == 0 { eyes.min[k] } else { eyes.max[k] }));
    let inside: Vec<Point3> = (0..32).map(|_| random.point(eyes)).collect();
    corners.chain(inside).map(|eye| exact(triangle, eye)).fold(0.0, f64::max)
}

fn point(size: f64) -> impl Strategy<Value = Point3> {
    // Small integers make flat and touching cases.
    prop_oneof![
        prop::array::uniform3(-size..size),
        prop::array::uniform3((-4i32..5).prop_map(move |x| f64::from(x) * size / 4.0))
    ]
}

fn boxes(size: f64) -> impl Strategy<Value = Aabb<3>> {
    [point(size), point(size)].prop_map(|[p, q]| Aabb::around([p, q]))
}

proptest! {
    #[test]
    fn no_eye_sees_more(
        a in point(4.0),
        b in point(4.0),
        c in point(4.0),
        mut eyes in boxes(1.0),
        away in 0.0..20.0f64,
        moved in prop_oneof![Just(0.0), Just(1e6), Just(-1e9)],
        depth in 0u32..5,
        seed: u64,
    ) {
        let mut triangle = [a, b, c];
        triangle.iter_mut().for_each(|p| *p = p.map(|x| x + moved));
        eyes.min = eyes.min.map(|x| x + moved);
        eyes.max = eyes.max.map(|x| x + moved);
        (eyes.min[0], eyes.max[0]) = (eyes.min[0] + away, eyes.max[0] + away);
        let bound = share(&triangle, &eyes, depth);
        let seen = largest(&triangle, &eyes, &mut Random::new(seed));
        // The oracle uses plain doubles: differences of coordinates are exact here except for their last bits.
        prop_assert!(seen <= bound * (1.0 + 1e-9) + 1e-13, "{} {}", seen, bound);
        prop_assert!((0.0..=0.5).contains(&bound));
    }

    #[test]
    fn bounds_are_tight_where_the_triangle_is_far(a in point(1.0), b in point(1.0), c in point(1.0), seed: u64) {
        let eyes = Aabb { min: [40.0, -1.0, -1.0], max: [41.0, 1.0, 1.0] };
        let seen = largest(&[a, b, c], &eyes, &mut Random::new(seed));
        let bound = share(&[a, b, c], &eyes, 4);
        // Seen from 39 to 42 units away and turned by a few degrees: cos(theta) varies by the box's size over the
        // distance.
        let area = PlaneOf::new(&[a, b, c], &eyes).area;
        prop_assert!(bound <= seen * 1.2 + area / (39.0 * 39.0 * SPHERE) * 0.12 + 1e-15, "{} {}", seen, bound);
    }

    #[test]
    fn cutting_does_not_make_bounds_worse(a in point(4.0), b in point(4.0), c in point(4.0), eyes in boxes(1.0)) {
        let bounds: Vec<f64> = (0..5).map(|depth| share(&[a, b, c], &eyes, depth)).collect();
        prop_assert!(bounds.windows(2).all(|w| w[1] <= w[0] * (1.0 + 1e-9)), "{:?}", bounds);
    }
}

/// Bounds with typical mistakes.
#[test]
fn the_oracle_tells_wrong_bounds() {
    let triangle = [[3.0, -1.0, -1.0], [3.0, 1.0, -1.0], [3.0, 0.0, 1.0]];
    let eyes = Aabb { min: [0.0, -0.5, -0.5], max: [2.0, 0.5, 0.5] };
    let seen = largest(&triangle, &eyes, &mut Random::new(5));
    assert!(seen <= share(&triangle, &eyes, 4));
    // For the middle of the box only; for one distance, as if it were the whole; of half the triangle.
    let middle = Aabb { min: [1.0, 0.0, 0.0], max: [1.0, 0.0, 0.0] };
    let far = Aabb { min: [0.0, -0.5, -0.5], max: [0.0, 0.5, 0.5] };
    let half = [triangle[0], triangle[1], [3.0, 0.0, -1.0]];
    for wrong in [share(&triangle, &middle, 4), share(&triangle, &far, 4), share(&half, &eyes, 4)] {
        assert!(seen > wrong, "{seen} {wrong}");
    }
}

#[test]
fn bounds_of_known_shapes() {
    // A triangle of a cube's face takes up a twelfth of the sphere for the middle.
    let face = [[1.0, -1.0, -1.0], [1.0, 1.0, -1.0], [1.0, 1.0, 1.0]];
    let middle = Aabb { min: [0.0; 3], max: [0.0; 3] };
    let bounds: Vec<f64> = (0..9).map(|depth| share(&face, &middle, depth)).collect();
    assert!((1.0 / 12.0..=1.0 / 12.0 * 1.2).contains(&bounds[8]), "{bounds:?}");
    // A triangle that touches the eyes may take up half of the sphere, one without area nearly nothing.
    assert_eq!(share(&face, &Aabb { min: [0.0; 3], max: [1.0; 3] }, 8), 0.5);
    assert!(share(&[[1.0; 3], [2.0; 3], [3.0; 3]], &middle, 4) < 1e-14);
    // Very large, very small, and far out.
    let huge = face.map(|p| p.map(|x| x * 1e60));
    assert!(share(&huge, &middle, 8) >= 1.0 / 12.0 && share(&huge, &middle, 8) < 0.11);
    let tiny = face.map(|p| p.map(|x| x * 1e-40));
    assert!(share(&tiny, &middle, 8) >= 1.0 / 12.0);
    assert!(share(&tiny, &Aabb { min: [1.0; 3], max: [2.0; 3] }, 8) < 1e-75);
}
