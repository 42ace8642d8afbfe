//! Exact distances between convex polygons in space.

use super::grid::Integer3;
use num_traits::{One, Zero};
use sightlines_exact::vector::{cross, dot};
use sightlines_exact::{BigInt, Fraction, Sign};
use std::cmp::Ordering;

/// A point with rational coordinates: `x / w`, `w` positive.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Rational3 {
    pub(super) x: Integer3,
    pub(super) w: BigInt,
}

impl From<Integer3> for Rational3 {
    fn from(x: Integer3) -> Self {
        Self { x, w: BigInt::one() }
    }
}

/// `w_a w_b (a - b)`
fn towards(a: &Rational3, b: &Rational3) -> Integer3 {
    [0, 1, 2].map(|k| &a.x[k] * &b.w - &b.x[k] * &a.w)
}

/// The square of the distance between two convex polygons that do not pass through each other, though they may
/// touch.
///
/// Then the nearest two points are a corner of one and a point inside the other, or lie on two edges. The smallest is
/// taken of the distances of such pairs of points, each of which belong to the polygons.
pub(super) fn square_of_distance(a: &[Rational3], b: &[Rational3]) -> Fraction {
    let mut best: Option<Fraction> = None;
    let mut offer = |square: Option<Fraction>| {
        if let Some(square) = square {
            best = Some(match best.take() {
                None => square,
                Some(best) => best.min(square),
            });
        }
    };
    for (points, polygon) in [(a, b), (b, a)] {
        let normal = normal(polygon);
        for p in points {
            offer(normal.as_ref().and_then(|n| above_polygon(p, polygon, n)));
            edges(polygon).for_each(|edge| offer(Some(to_segment(p, edge))));
        }
    }
    for e in edges(a) {
        edges(b).for_each(|f| offer(between_insides(e, f)));
    }
    best.expect("polygons have corners and edges")
}

fn edges(polygon: &[Rational3]) -> impl Iterator<Item = [&Rational3; 2]> {
    polygon.iter().zip(polygon.iter().cycle().skip(1)).map(|(p, q)| [p, q])
}

/// None for what has no area.
fn normal(polygon: &[Rational3]) -> Option<Integer3> {
    let [p, q, r] = polygon.first_chunk()?;
    let n = cross(&towards(q, p), &towards(r, p));
    n.iter().any(|x| !x.is_zero()).then_some(n)
}

/// If the foot of the perpendicular is inside.
fn above_polygon(p: &Rational3, polygon: &[Rational3], n: &Integer3) -> Option<Fraction> {
    let inside = edges(polygon).all(|[q, r]| dot(&cross(&towards(r, q), &towards(p, q)), n).sign() != Sign::Minus);
    inside.then(|| {
        let q = &polygon[0];
        let along = dot(n, &towards(p, q));
        let scale = &p.w * &q.w;
        Fraction::new(&along * &along, dot(n, n) * &scale * &scale)
    })
}

fn to_segment(p: &Rational3, [q, r]: [&Rational3; 2]) -> Fraction {
    let (d, u) = (towards(p, q), towards(r, q));
    let (along, length) = (dot(&d, &u), dot(&u, &u));
    if along.sign() != Sign::Plus {
        to_point(p, q)
    } else if &along * &r.w >= &length * &p.w {
        // With its scales, the foot is at along * w_r / (w_p * length) of the way.
        to_point(p, r)
    } else {
        let across = cross(&d, &u);
        let scale = &p.w * &q.w;
        Fraction::new(dot(&across, &across), length * &scale * &scale)
    }
}

fn to_point(p: &Rational3, q: &Rational3) -> Fraction {
    let d = towards(p, q);
    let scale = &p.w * &q.w;
    Fraction::new(dot(&d, &d), &scale * &scale)
}

/// If the lines through both have their nearest points within both segments.
fn between_insides([p, q]: [&Rational3; 2], [r, s]: [&Rational3; 2]) -> Option<Fraction> {
    let (u, w, d) = (towards(q, p), towards(s, r), towards(r, p));
    let n = cross(&u, &w);
    let nn = dot(&n, &n);
    // The nearest point of the first is at (d × w) · n / (n · n) of the way, that of the second at (d × u) · n / (n · n),
    // before scales are taken off.
    let within = |num: BigInt, den: BigInt| num.sign() != Sign::Minus && num <= den;
    let first = within(dot(&cross(&d, &w), &n) * &q.w, &nn * &r.w);
    let meets = !nn.is_zero() && first && within(dot(&cross(&d, &u), &n) * &s.w, &nn * &p.w);
    meets.then(|| {
        let along = dot(&n, &d);
        let scale = &p.w * &r.w;
        Fraction::new(&along * &along, nn * &scale * &scale)
    })
}

/// The convex hull of points of one plane, with normal `n`; corners only.
pub(super) fn hull(mut points: Vec<Rational3>, n: &Integer3) -> Vec<Rational3> {
    let drop = (0..3).find(|&k| !n[k].is_zero()).expect("a normal is not zero");
    let (i, j) = ((drop + 1) % 3, (drop + 2) % 3);
    let by = |a: &Rational3, b: &Rational3, k: usize| (&a.x[k] * &b.w).cmp(&(&b.x[k] * &a.w));
    points.sort_by(|a, b| by(a, b, i).then_with(|| by(a, b, j)));
    points.dedup_by(|a, b| by(a, b, i).is_eq() && by(a, b, j).is_eq());
    if points.len() < 3 {
        return points;
    }
    let turns_left = |a: &Rational3, b: &Rational3, c: &Rational3| {
        let (u, v) = (towards(b, a), towards(c, a));
        (&u[i] * &v[j]).cmp(&(&u[j] * &v[i])) == Ordering::Greater
    };
    let half = |points: &mut dyn Iterator<Item = &Rational3>| {
        let mut chain: Vec<Rational3> = Vec::new();
        for p in points {
            while let [.., a, b] = chain.as_slice()
                && !turns_left(a, b, p)
            {
                chain.pop();
            }
            chain.push(p.clone());
        }
        chain.pop();
        chain
    };
    let mut around = half(&mut points.iter());
    around.extend(half(&mut points.iter().rev()));
    around
}

/// A polygon with integer corners.
pub(super) fn polygon<'a>(corners: impl IntoIterator<Item = &'a Integer3>) -> Vec<Rational3> {
    corners.into_iter().cloned().map(Rational3::from).collect()
}
