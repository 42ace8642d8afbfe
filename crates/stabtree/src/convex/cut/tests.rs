//! Planes and cuts against exact arithmetic.

use super::*;
use num_rational::BigRational;
use num_traits::{One, Signed, Zero};
use proptest::prelude::*;

type Exact = [BigRational; 3];

fn exact(x: f64) -> BigRational {
    BigRational::from_float(x).unwrap()
}

fn point(p: Point3) -> Exact {
    p.map(exact)
}

/// The point `a + share (b - a)`.
fn towards(a: &Exact, b: &Exact, share: &BigRational) -> Exact {
    [0, 1, 2].map(|k| &a[k] + share * (&b[k] - &a[k]))
}

/// The value of a plane, evaluated without rounding.
fn value(plane: &Plane, x: &Exact) -> BigRational {
    let (n, o) = (point(plane.normal), point(plane.origin));
    (0..3).map(|k| &n[k] * (&x[k] - &o[k])).sum::<BigRational>() + exact(plane.offset)
}

/// A point of the convex hull of a part, by weights.
fn inside(part: &[Vertex], weights: &[u8]) -> Exact {
    let weight = |i: usize| exact(f64::from(weights[i % weights.len()]));
    let total = (0..part.len()).map(weight).sum::<BigRational>();
    let sum = |k: usize| part.iter().enumerate().map(|(i, v)| exact(v.at[k]) * weight(i)).sum::<BigRational>();
    [0, 1, 2].map(|k| sum(k) / &total)
}

const LARGEST: f64 = 4096.0;

/// A convex polygon on the grid, in a plane that is perpendicular to an axis or oblique, and its first cuts.
#[derive(Debug, Clone)]
struct Start {
    part: Part,
    cuts: Vec<Plane>,
}

fn start(at: i32) -> impl Strategy<Value = Start> {
    let corner = (-6i32..=6, -6i32..=6);
    let polygon = (proptest::collection::vec(corner, 3..7), -2i32..=2, -2i32..=2);
    let cut = ([-3i32..=3, -3i32..=3, -3i32..=3], -4i32..=4, 1i32..4);
    (polygon, proptest::collection::vec(cut, 0..3)).prop_filter_map("an area", move |((flat, u, v), cuts)| {
        let lift =
            |(y, z): (i32, i32)| [f64::from(16 * at + u * y + v * z) * 4.0, f64::from(y) * 37.0, f64::from(z) * 29.0];
        let points: Vec<Point3> = flat.into_iter().map(lift).collect();
        let portal = hull(&points)?;
        let clearance = Cutter::new(LARGEST).eps;
        let part: Part = portal.into_iter().map(|at| Vertex { at, clearance, exact: true, cut: false }).collect();
        let cut = |(n, offset, by): ([i32; 3], i32, i32)| {
            let normal = n.map(f64::from);
            let length = dot(normal, normal).sqrt();
            (length > 0.0).then(|| Plane {
                normal: scale(normal, 1.0 / length),
                origin: [f64::from(64 * at), 0.0, 0.0],
                offset: f64::from(offset) * 13.0 / f64::from(by),
            })
        };
        Some(Start { part, cuts: cuts.into_iter().filter_map(cut).collect() })
    })
}

/// Corners of a polygon that is crossed towards larger x.
fn hull(points: &[Point3]) -> Option<Vec<Point3>> {
    let mut best = sightlines_geometry::Portal3::around(points);
    if best.as_ref().is_some_and(|p| p.normal()[0] < 0.0) {
        best = best.map(|p| p.reversed());
    }
    Some(best?.corners().to_vec()).filter(|_| points.len() > 2)
}

/// The part after its cuts; `None` if nothing is left.
fn cut(start: &Start, cutter: &mut Cutter) -> Option<Part> {
    let mut part = start.part.clone();
    start.cuts.iter().all(|plane| cutter.cut(&mut part, plane)).then_some(part)
}

proptest! {
    /// With the ball of the portal, cuts leave what they leave without it, and some are saved.
    #[test]
    fn a_ball_saves_cuts_and_changes_none(start in start(0), others in proptest::collection::vec(start(0), 1..6)) {
        let planes: Vec<Plane> = others.iter().flat_map(|other| other.cuts.iter().copied()).collect();
        let center = middle(&start.part);
        let far = |v: &Vertex| dot(sub(v.at, center), sub(v.at, center)).sqrt();
        let radius = start.part.iter().map(far).fold(0.0, f64::max) * (1.0 + 1e-9);
        let ball = Ball { center, radius, clearance: Cutter::new(LARGEST).eps };
        let (mut plain, mut saving) = (Cutter::new(LARGEST), Cutter::new(LARGEST));
        let (mut part, mut same) = (start.part.clone(), start.part.clone());
        let left = planes.iter().all(|plane| plain.cut(&mut part, plane));
        prop_assert_eq!(saving.cut_all(&mut same, &ball, planes.iter()), left);
        prop_assert!(saving.clips <= plain.clips);
        if left {
            prop_assert_eq!(part.len(), same.len());
            prop_assert!(part.iter().zip(&same).all(|(a, b)| a.at == b.at));
        }
        // A ball that is too small is noticed.
        let small = Ball { radius: 0.0, ..ball };
        let across = Plane { normal: [0.0, 1.0, 0.0], origin: center, offset: 1e-3 };
        let (mut cut, mut kept) = (start.part.clone(), start.part.clone());
        prop_assert!(saving.cut(&mut cut, &across) && saving.cut_all(&mut kept, &small, [across].iter()));
        prop_assert!(cut.iter().map(|v| v.at).ne(kept.iter().map(|v| v.at)));
    }

    /// Points of the portal that are above all cuts are within the part, up to the radius of constructed vertices: so
    /// no plane that has the part above it by that much excludes them.
    #[test]
    fn cutting_leaves_everything_above(start in start(0), weights in proptest::collection::vec(1u8..20, 1..6)) {
        let mut cutter = Cutter::new(LARGEST);
        let x = inside(&start.part, &weights);
        prop_assume!(start.cuts.iter().all(|plane| !value(plane, &x).is_negative()));
        let part = cut(&start, &mut cutter);
        prop_assert!(part.is_some(), "the part with {x:?} is gone");
        let part = part.unwrap();
        // In each plane across one of its edges, at most the radius outside.
        let normal = sightlines_geometry::Portal3::around(&start.part.iter().map(|v| v.at).collect::<Vec<_>>()).unwrap().normal();
        let mut last = part[part.len() - 1];
        for b in part {
            let a = std::mem::replace(&mut last, b);
            let inwards = cross(normal, sub(b.at, a.at));
            let length = dot(inwards, inwards).sqrt();
            if length > 1e-3 {
                let plane = Plane { normal: scale(inwards, 1.0 / length), origin: a.at, offset: 0.0 };
                prop_assert!(value(&plane, &x) >= exact(-2.0 * b.clearance), "{x:?} outside of {plane:?}");
            }
        }
    }

    /// A line that passes two parts stays above their separators afterwards: exactly.
    #[test]
    fn separators_hold_for_all_lines(
        first in start(0),
        second in start(3),
        weights in proptest::collection::vec(1u8..20, 1..6),
        others in proptest::collection::vec(1u8..20, 1..6),
        beyond in 0u32..2000,
    ) {
        let mut cutter = Cutter::new(LARGEST);
        let (Some(first), Some(second)) = (cut(&first, &mut cutter), cut(&second, &mut cutter)) else { return Ok(()) };
        let mut planes = Vec::new();
        cutter.separators(&first, &second, &mut planes);
        let (s, p) = (inside(&first, &weights), inside(&second, &others));
        let share = BigRational::one() + exact(f64::from(beyond) / 64.0);
        let t = towards(&s, &p, &share);
        for plane in &planes {
            prop_assert!(!value(plane, &t).is_negative(), "{plane:?} hides {t:?}");
        }
        // All points between two parts are within the planes around them.
        let mut around = Vec::new();
        enclosing(&first, &second, &mut around);
        let between = towards(&s, &p, &exact(f64::from(beyond) / 2000.0));
        for plane in &around {
            // The plane's offset is a sum of roundings of its evaluation.
            prop_assert!(value(plane, &between) >= exact(-cutter.eps), "{plane:?} hides {between:?}");
        }
    }
}

/// The tightness twin and the impostor: separators exist, and separators that are moved inwards by a thousandth hide
/// something.
#[test]
fn separators_are_tight() {
    let clearance = Cutter::new(LARGEST).eps;
    let square = |x: f64, low: f64, high: f64| -> Part {
        let corners = [[x, low, low], [x, high, low], [x, high, high], [x, low, high]];
        corners.map(|at| Vertex { at, clearance, exact: true, cut: false }).to_vec()
    };
    let (first, second) = (square(0.0, 0.0, 8.0), square(10.0, 2.0, 6.0));
    let mut planes = Vec::new();
    Cutter::new(LARGEST).separators(&first, &second, &mut planes);
    assert_eq!(planes.len(), 4, "each edge leans on the parallel one of the other square");
    // The extreme line runs from a corner through the opposite one.
    let (s, p) = (point([0.0, 8.0, 4.0]), point([10.0, 2.0, 4.0]));
    let t = towards(&s, &p, &exact(10.0));
    let least = planes.iter().map(|plane| value(plane, &t)).min().unwrap();
    assert!(!least.is_negative() && least < exact(1e-3), "{least}");
    let hides = |plane: &Plane| value(&Plane { offset: plane.offset - 1e-3, ..*plane }, &t).is_negative();
    assert!(planes.iter().any(hides), "a plane that is moved in hides a line");
    let beyond = towards(&s, &point([10.0, 1.99, 4.0]), &exact(10.0));
    assert!(planes.iter().any(|plane| value(plane, &beyond) < BigRational::zero()), "what is outside is cut off");
}

#[test]
fn parts_within_parts() {
    let clearance = Cutter::new(LARGEST).eps;
    let corners = [[0.0, 0.0, 0.0], [0.0, 8.0, 0.0], [0.0, 8.0, 8.0], [0.0, 0.0, 8.0]];
    let whole: Part = corners.map(|at| Vertex { at, clearance, exact: true, cut: false }).to_vec();
    let mut cutter = Cutter::new(LARGEST);
    let mut half = |z: f64| {
        let mut part = whole.clone();
        assert!(cutter.cut(&mut part, &Plane { normal: [0.0, 0.0, 1.0], origin: [0.0, 0.0, z], offset: 0.0 }));
        part
    };
    let normal = [1.0, 0.0, 0.0];
    let (more, less) = (half(2.0), half(4.0));
    assert!(is_within(&less, &more, normal) && is_within(&more, &whole, normal) && is_within(&less, &less, normal));
    assert!(!is_within(&more, &less, normal) && !is_within(&whole, &more, normal));
    // A cut so near the corner that both of its ends round to the same number decides nothing.
    let end = |cut: bool| Vertex { at: [0.0, 1e-9, 1e-9], clearance: 2.0 * clearance, exact: false, cut };
    let speck = vec![whole[0], end(false), end(true)];
    assert!(!is_within(&whole, &speck, normal) && !is_within(&less, &speck, normal));
}
