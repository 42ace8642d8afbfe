//! Points and lines in integers: `i128` where a bound shows that nothing overflows, `BigInt` elsewhere.

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{One, Signed, ToPrimitive};
use sightlines_geometry::Point2;
use std::fmt::Debug;

/// The integers that an oracle computes in.
pub(crate) trait Int: Clone + Ord + Signed + From<i64> + Debug {
    /// -1, 0 or 1.
    fn sign(&self) -> i32 {
        i32::from(self.is_positive()) - i32::from(self.is_negative())
    }
}

impl Int for i128 {}
impl Int for BigInt {}

/// Some points times one power of two, so that all coordinates are integers. Exact for every `f64`.
///
/// # Panics
/// If a coordinate is not finite.
pub(crate) fn scaled(points: &[Point2]) -> Vec<[BigInt; 2]> {
    let exact = |x: f64| BigRational::from_float(x).expect("coordinates are finite");
    let points: Vec<[BigRational; 2]> = points.iter().map(|p| [exact(p.x), exact(p.y)]).collect();
    // All denominators are powers of two, so the largest is a multiple of the others.
    let scale = points.iter().flatten().map(BigRational::denom).max().cloned().unwrap_or_else(BigInt::one);
    points.iter().map(|p| p.each_ref().map(|x| x.numer() * (&scale / x.denom()))).collect()
}

/// The same points in `i128`, if no coordinate is above `bound` in magnitude.
pub(crate) fn small(points: &[[BigInt; 2]], bound: i128) -> Option<Vec<[i128; 2]>> {
    let fits = |x: &BigInt| x.to_i128().filter(|x| x.abs() <= bound);
    points.iter().map(|[x, y]| Some([fits(x)?, fits(y)?])).collect()
}

/// A point in homogeneous coordinates, `w > 0`.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Hp<T> {
    pub(crate) x: T,
    pub(crate) y: T,
    pub(crate) w: T,
}

impl<T: Int> Hp<T> {
    /// An integer point.
    pub(crate) fn new([x, y]: [T; 2]) -> Self {
        Self { x, y, w: T::one() }
    }

    /// The mean of two points with positive weights, in lowest terms.
    pub(crate) fn mean(p: &Self, weight_p: &T, q: &Self, weight_q: &T) -> Self {
        let sum = |a: &T, b: &T| a.clone() * weight_p.clone() + b.clone() * weight_q.clone();
        let (x, y, w) = (sum(&p.x, &q.x), sum(&p.y, &q.y), sum(&p.w, &q.w));
        let divisor = gcd(gcd(x.abs(), y.abs()), w.clone());
        Self { x: x / divisor.clone(), y: y / divisor.clone(), w: w / divisor }
    }
}

fn gcd<T: Int>(a: T, b: T) -> T {
    if b.is_zero() { a } else { gcd(b.clone(), a % b) }
}

/// The linear form `a x + b y + c w`: a directed line with its positive side on the left, and
/// direction `(b, -a)`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Form<T> {
    pub(crate) a: T,
    pub(crate) b: T,
    pub(crate) c: T,
}

impl<T: Int> Form<T> {
    /// The line from `p` to `q`; zero if they are one point.
    pub(crate) fn through(p: &Hp<T>, q: &Hp<T>) -> Self {
        let minor = |p1: &T, q2: &T, p2: &T, q1: &T| p1.clone() * q2.clone() - p2.clone() * q1.clone();
        Self { a: minor(&p.y, &q.w, &p.w, &q.y), b: minor(&p.w, &q.x, &p.x, &q.w), c: minor(&p.x, &q.y, &p.y, &q.x) }
    }

    /// Positive on the left.
    pub(crate) fn at(&self, p: &Hp<T>) -> T {
        self.a.clone() * p.x.clone() + self.b.clone() * p.y.clone() + self.c.clone() * p.w.clone()
    }

    /// The form whose value divided by `w` grows along the line.
    pub(crate) fn along(&self) -> Self {
        Self { a: self.b.clone(), b: -self.a.clone(), c: T::zero() }
    }
}

/// A place along a line: a fraction with a positive denominator.
#[derive(Debug, Clone)]
pub(crate) struct Place<T> {
    num: T,
    den: T,
}

impl<T: Int> Place<T> {
    /// Where `p` lies along a line.
    pub(crate) fn of(along: &Form<T>, p: &Hp<T>) -> Self {
        Self { num: along.at(p), den: p.w.clone() }
    }
}

impl<T: Int> PartialEq for Place<T> {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl<T: Int> Eq for Place<T> {}

impl<T: Int> PartialOrd for Place<T> {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl<T: Int> Ord for Place<T> {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        (self.num.clone() * other.den.clone()).cmp(&(other.num.clone() * self.den.clone()))
    }
}

/// Where a line crosses the segment from `u` to `v`, if it has them strictly on different sides, and
/// whether `u` is on its left.
pub(crate) fn crossing<T: Int>(line: &Form<T>, along: &Form<T>, u: &Hp<T>, v: &Hp<T>) -> Option<(Place<T>, bool)> {
    let (at_u, at_v) = (line.at(u), line.at(v));
    if at_u.sign() * at_v.sign() >= 0 {
        return None;
    }
    // The weights make the form vanish; both are positive, so the denominator is.
    let (weight_u, weight_v) = (at_v.abs(), at_u.abs());
    let mean = |a: T, b: T| weight_u.clone() * a + weight_v.clone() * b;
    let place = Place { num: mean(along.at(u), along.at(v)), den: mean(u.w.clone(), v.w.clone()) };
    Some((place, at_u.is_positive()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scaling_is_exact_and_common() {
        let p = scaled(&[Point2::new(0.5, -3.0), Point2::new(0.125, 2.0)]);
        assert_eq!(small(&p, 24), Some(vec![[4, -24], [1, 16]]));
        assert_eq!(small(&p, 23), None);
    }

    #[test]
    fn lines_have_their_left_and_their_direction() {
        let p = |x: i128, y: i128| Hp::new([x, y]);
        let line = Form::through(&p(0, 0), &p(3, 0));
        assert!(line.at(&p(1, 2)) > 0 && line.at(&p(1, -2)) < 0);
        let along = line.along();
        assert!(along.at(&p(2, 5)) > along.at(&p(1, 7)));
        let (place, left) = crossing(&line, &along, &p(4, 1), &p(6, -1)).unwrap();
        assert!(left && place == Place::of(&along, &p(5, 0)) && place > Place::of(&along, &p(4, 0)));
        assert!(crossing(&line, &along, &p(4, 1), &p(6, 0)).is_none());
    }
}
