use super::*;
use num_rational::BigRational;
use num_traits::Signed;
use proptest::prelude::*;
use sightlines_geometry::Point3;

type R3 = [BigRational; 3];

fn point() -> impl Strategy<Value = Point3> + Clone {
    let one = prop::sample::select(vec![-3i32, -1, 0, 0, 1, 2]).prop_map(|x| f64::from(x) * 0.125);
    // Many lie in one plane.
    (one.clone(), one, prop::sample::select(vec![0.0, 0.0, 0.0, 0.125])).prop_map(|(x, y, z)| [x, y, z])
}

fn rational(p: Point3) -> R3 {
    p.map(|x| BigRational::from_float(x).expect("finite"))
}

fn sub(a: &R3, b: &R3) -> R3 {
    [0, 1, 2].map(|k| &a[k] - &b[k])
}

fn dot(a: &R3, b: &R3) -> BigRational {
    &a[0] * &b[0] + &a[1] * &b[1] + &a[2] * &b[2]
}

/// The function of a face's plane, by its corners.
fn side(face: &[Point3; 3], p: &R3) -> BigRational {
    let [a, b, c] = face.map(rational);
    let (u, v) = (sub(&b, &a), sub(&c, &a));
    let n = [(1, 2), (2, 0), (0, 1)].map(|(i, j)| &u[i] * &v[j] - &u[j] * &v[i]);
    dot(&n, &sub(p, &a))
}

/// The oracle: a polygon with corners in fractions, cut as Sutherland and Hodgman do.
fn cut(polygon: &[R3], face: &[Point3; 3], positive: bool) -> Vec<R3> {
    let values: Vec<BigRational> =
        polygon.iter().map(|p| if positive { side(face, p) } else { -side(face, p) }).collect();
    let mut out = Vec::new();
    for i in 0..polygon.len() {
        let j = (i + 1) % polygon.len();
        if !values[i].is_negative() {
            out.push(polygon[i].clone());
        }
        if (&values[i] * &values[j]).is_negative() {
            let t = &values[i] / (&values[i] - &values[j]);
            out.push([0, 1, 2].map(|k| &polygon[i][k] + &t * (&polygon[j][k] - &polygon[i][k])));
        }
    }
    out
}

fn relation(polygon: &[R3], face: &[Point3; 3]) -> Relation {
    let values: Vec<BigRational> = polygon.iter().map(|p| side(face, p)).collect();
    match (values.iter().any(Signed::is_positive), values.iter().any(Signed::is_negative)) {
        (true, true) => Relation::Across,
        (true, false) => Relation::Front,
        (false, true) => Relation::Behind,
        (false, false) => Relation::In,
    }
}

/// Coordinates near both ends of what is accepted, some next to each other there.
fn extreme() -> impl Strategy<Value = Point3> + Clone {
    let power = |k: i32| 2f64.powi(k);
    let ends =
        [power(-139), power(-139) + power(-191), power(-139) - power(-192), power(-60), 1.0, power(60), power(200)];
    let one = (prop::sample::select(ends.to_vec()), prop::sample::select(vec![1.0, 1.0, 0.0, -1.0]));
    let one = one.prop_map(|(x, sign): (f64, f64)| x * sign + 0.0);
    [one.clone(), one.clone(), one]
}

#[test]
fn fragments_lie_and_are_cut_as_in_fractions() {
    let seen = cut_and_compare(point());
    assert!(seen.iter().all(|&n| n > 0), "kinds that never came: {seen:?}");
}

#[test]
fn fragments_of_any_size_are_cut_as_in_fractions() {
    let seen = cut_and_compare(extreme());
    assert!([0, 1, 3, 4].iter().all(|&k| seen[k] > 0), "kinds that never came: {seen:?}");
}

/// Cuts faces with such corners again and again, and compares; how often each relation came, and pieces of more than three corners.
fn cut_and_compare(point: impl Strategy<Value = Point3> + Clone) -> [u64; 5] {
    let seen = std::cell::RefCell::new([0u64; 5]);
    let mut runner = proptest::test_runner::TestRunner::default();
    let triangles = prop::collection::vec([point.clone(), point.clone(), point], 5);
    let run = runner.run(&(triangles, prop::collection::vec(any::<bool>(), 4)), |(corners, ways)| {
        let faces = Faces::new(corners.clone()).expect("small numbers");
        if !faces.ids().all(|f| faces.has_area(f)) {
            return Ok(());
        }
        let mut fragment = Fragment::whole(0);
        let mut polygon: Vec<R3> = corners[0].map(rational).to_vec();
        for (face, front) in (1u32..).zip(ways) {
            let plane = InputPlane::Face(face);
            let want = relation(&polygon, &corners[face as usize]);
            let (got, parts) = fragment.split(&faces, &plane);
            prop_assert_eq!(got, want);
            prop_assert_eq!(fragment.relation(&faces, &plane), want);
            // The form that planes across an axis share says the same, up to the side that it calls its front.
            let shared = fragment.relation(&faces, &InputPlane::of(&faces, face));
            let turned = match want {
                Relation::Front => Relation::Behind,
                Relation::Behind => Relation::Front,
                other => other,
            };
            prop_assert!(shared == want || shared == turned);
            seen.borrow_mut()[want as usize] += 1;
            prop_assert_eq!(parts.is_some(), want == Relation::Across);
            if let Some([a, b]) = parts {
                prop_assert!(a.is_cut_by(&plane) && b.is_cut_by(&plane));
                prop_assert_eq!(a.relation(&faces, &plane), Relation::Front);
                prop_assert_eq!(b.relation(&faces, &plane), Relation::Behind);
                polygon = cut(&polygon, &corners[face as usize], front);
                fragment = if front { a } else { b };
                // As many corners, so every edge is a true one.
                prop_assert_eq!(fragment.n_edges(), polygon.len());
                seen.borrow_mut()[4] += u64::from(polygon.len() > 3);
            }
        }
        Ok(())
    });
    assert_eq!(run, Ok(()));
    seen.into_inner()
}

/// Invariant: of a face and the parts that it is cut into, each pixel of the face has exactly one part; extents hold all of them.
#[test]
fn parts_share_the_pixels() {
    let pixels = std::cell::Cell::new(0u64);
    let mut runner = proptest::test_runner::TestRunner::default();
    let triangles = prop::collection::vec([point(), point(), point()], 4);
    let run = runner.run(&(point(), triangles), |(eye, corners)| {
        let faces = Faces::new(corners).expect("small numbers");
        let camera = Camera::new(eye, [-0.25, 0.25, -0.25], [0.0625, 0.0, 0.0], [0.0, -0.0625, 0.0], [8, 8])
            .expect("spans space");
        if !faces.ids().all(|f| faces.has_area(f)) {
            return Ok(());
        }
        let mut parts = vec![Fragment::whole(0)];
        for face in 1..4 {
            let cut = |f: &Fragment| {
                f.split(&faces, &InputPlane::of(&faces, face)).1.map_or_else(|| vec![f.clone()], Vec::from)
            };
            parts = parts.iter().flat_map(cut).collect();
        }
        let mut count = [0i32; 64];
        let mut add = |fragment: &Fragment, n: i32| {
            let extents = fragment.extents(&camera, &faces);
            fragment.spans(&camera, &faces, |y, from, to| {
                for x in from..to {
                    count[(y * 8 + x) as usize] += n;
                    for (k, at) in [x, y].into_iter().enumerate() {
                        let middle = f64::from(at) + 0.5;
                        assert!(extents.pixels[k][0] <= middle && middle <= extents.pixels[k][1]);
                    }
                }
            });
        };
        parts.iter().for_each(|part| add(part, 1));
        pixels.set(pixels.get() + u64::from(parts.len() > 1));
        add(&Fragment::whole(0), -1);
        prop_assert!(count.iter().all(|&n| n == 0), "{:?}", count);
        Ok(())
    });
    assert_eq!(run, Ok(()));
    assert!(pixels.get() > 0);
}
