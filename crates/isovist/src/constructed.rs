//! Points where a ray meets a wall, rounded once to the nearest doubles.

use crate::corner::{Exact, fractions};
use num_traits::{ToPrimitive, Zero};
use sightlines_exact::BigRational;
use sightlines_geometry::{Point2, Segment2};

/// A number as the sum of two doubles, the second at most half a unit in the last place of the first.
#[derive(Debug, Clone, Copy)]
struct Double2 {
    hi: f64,
    lo: f64,
}

/// A sum and its rounding error. Knuth.
#[inline(always)]
fn two_sum(a: f64, b: f64) -> Double2 {
    let hi = a + b;
    let part = hi - a;
    Double2 { hi, lo: (a - (hi - part)) + (b - part) }
}

/// The same for `|a| >= |b|`. Dekker.
#[inline(always)]
fn quick_sum(a: f64, b: f64) -> Double2 {
    let hi = a + b;
    Double2 { hi, lo: b - (hi - a) }
}

/// A product and its rounding error. Dekker, with Veltkamp's splitting.
#[inline(always)]
fn two_product(a: f64, b: f64) -> Double2 {
    let split = |x: f64| {
        let c = 134_217_729.0 * x;
        let high = c - (c - x);
        (high, x - high)
    };
    let hi = a * b;
    let ((a1, a2), (b1, b2)) = (split(a), split(b));
    Double2 { hi, lo: ((a1 * b1 - hi) + a1 * b2 + a2 * b1) + a2 * b2 }
}

impl Double2 {
    #[inline(always)]
    fn times(self, other: Self) -> Self {
        let p = two_product(self.hi, other.hi);
        quick_sum(p.hi, p.lo + (self.hi * other.lo + self.lo * other.hi))
    }

    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        let (s, t) = (two_sum(self.hi, other.hi), two_sum(self.lo, other.lo));
        let u = quick_sum(s.hi, s.lo + t.hi);
        quick_sum(u.hi, u.lo + t.lo)
    }

    #[inline(always)]
    fn minus(self, other: Self) -> Self {
        self.plus(Self { hi: -other.hi, lo: -other.lo })
    }

    #[inline(always)]
    fn over(self, other: Self) -> Self {
        let first = self.hi / other.hi;
        let rest = self.minus(other.times(Self { hi: first, lo: 0.0 }));
        let second = rest.hi / other.hi;
        let rest = rest.minus(other.times(Self { hi: second, lo: 0.0 }));
        let third = rest.hi / other.hi;
        let sum = quick_sum(first, second);
        sum.plus(Self { hi: third, lo: 0.0 })
    }
}

/// A corner for constructions: its coordinates as sums of two doubles, and in exact form.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Target {
    pub(crate) at: Point2,
    /// What is added to `at`; with it, each coordinate is within 2^-100 of itself.
    pub(crate) low: Point2,
    pub(crate) exact: Exact,
}

/// The second parts of a crossing's coordinates, behind the first parts `at`.
pub(crate) fn low_part(e: Exact, at: Point2) -> Point2 {
    let (x, y) = fractions(e);
    let rest = |f: BigRational, hi: f64| {
        let hi = BigRational::from_float(hi).expect("coordinates are finite");
        (f - hi).to_f64().unwrap_or(0.0)
    };
    Point2::new(rest(x, at.x), rest(y, at.y))
}

/// Bound on the relative error of an operation on sums of two doubles, and of a difference by that of its terms: 2^-98, where 2^-100 would do. A
/// corner's own error of 2^-100 of its coordinates may be more than that of its difference to the eye, so it is counted by coordinates.
const UNIT: f64 = f64::from_bits((1023 - 98) << 52);

/// Where the line from an eye through a corner meets the line of a wall, each coordinate rounded to the nearest double.
///
/// Computed in sums of two doubles with a bound on the error; where that leaves the rounding open, in fractions. The lines are
/// not parallel.
pub(crate) fn meet(eye: Point2, through: &Target, wall: &Segment2) -> Point2 {
    let difference = |hi: f64, lo: f64, from: f64| {
        let d = two_sum(hi, -from);
        quick_sum(d.hi, d.lo + lo)
    };
    let dx = difference(through.at.x, through.low.x, eye.x);
    let dy = difference(through.at.y, through.low.y, eye.y);
    let (wx, wy) = (two_sum(wall.a.x, -eye.x), two_sum(wall.a.y, -eye.y));
    let corner = if through.low == Point2::ZERO { Point2::ZERO } else { through.at.abs() };
    // On a wall along an axis one coordinate is known, and gives the share of the way.
    let known = [0, 1].map(|k| (wall.a[k] == wall.b[k]).then_some(wall.a[k]));
    let (t, relative) = match known {
        [Some(_), _] => (wx.over(dx), UNIT * (2.0 + corner.x / dx.hi.abs())),
        [_, Some(_)] => (wy.over(dy), UNIT * (2.0 + corner.y / dy.hi.abs())),
        [None, None] => {
            let (ux, uy) = (two_sum(wall.b.x, -wall.a.x), two_sum(wall.b.y, -wall.a.y));
            let (n1, n2) = (wx.times(uy), wy.times(ux));
            let (d1, d2) = (dx.times(uy), dy.times(ux));
            let (n, d) = (n1.minus(n2), d1.minus(d2));
            let error_n = UNIT * (n1.hi.abs() + n2.hi.abs());
            let by_corner = corner.x * uy.hi.abs() + corner.y * ux.hi.abs();
            let error_d = UNIT * (d1.hi.abs() + d2.hi.abs() + by_corner);
            (n.over(d), error_n / n.hi.abs() + error_d / d.hi.abs() + UNIT)
        }
    };
    // A relative error of the denominator near one would make the quotient's first-order bound wrong.
    if relative < 1e-6 {
        let place = |from: f64, step: Double2, own: f64| {
            let move_by = t.times(step);
            let sum = Double2 { hi: from, lo: 0.0 }.plus(move_by);
            let error = 2.0 * (move_by.hi.abs() * relative + UNIT * (from.abs() + own * t.hi.abs()));
            let surely = sum.hi + (sum.lo + error) == sum.hi && sum.hi + (sum.lo - error) == sum.hi;
            surely.then_some(sum.hi)
        };
        let x = known[0].or_else(|| place(eye.x, dx, corner.x));
        let y = known[1].or_else(|| place(eye.y, dy, corner.y));
        if let (Some(x), Some(y)) = (x, y) {
            return Point2::new(x + 0.0, y + 0.0);
        }
    }
    in_fractions(eye, through, wall)
}

#[cold]
#[inline(never)]
fn in_fractions(eye: Point2, through: &Target, wall: &Segment2) -> Point2 {
    let exact = |x: f64| BigRational::from_float(x).expect("coordinates are finite");
    let (px, py) = (exact(eye.x), exact(eye.y));
    let (rx, ry) = fractions(through.exact);
    let (dx, dy) = (rx - &px, ry - &py);
    let (ax, ay) = (exact(wall.a.x), exact(wall.a.y));
    let (ux, uy) = (exact(wall.b.x) - &ax, exact(wall.b.y) - &ay);
    let d = &dx * &uy - &dy * &ux;
    if d.is_zero() {
        return through.at;
    }
    let t = ((ax - &px) * uy - (ay - &py) * ux) / d;
    let round = |x: BigRational| x.to_f64().unwrap_or(0.0) + 0.0;
    Point2::new(round(px + &t * dx), round(py + t * dy))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn number() -> impl Strategy<Value = f64> {
        prop_oneof![
            (-9i32..10).prop_map(f64::from),
            (-1000i32..1000).prop_map(|x| f64::from(x) * 0.01 + 500_000.0),
            -1e3..1e3
        ]
    }

    proptest! {
        /// Invariant: sums of two doubles round as fractions do.
        #[test]
        fn meetings_are_rounded_once(c in prop::array::uniform8(number())) {
            let p = |k: usize| Point2::new(c[k], c[k + 1]);
            let through = Target { at: p(2), low: Point2::ZERO, exact: Exact::Point(p(2)) };
            let wall = Segment2::new(p(4), p(6));
            if sightlines_geometry::orient2d(p(0), p(2), p(0) + (p(6) - p(4))) == 0.0 {
                return Ok(());
            }
            let (quick, slow) = (meet(p(0), &through, &wall), in_fractions(p(0), &through, &wall));
            prop_assert_eq!(quick, slow);
        }

        /// The same through crossings of lines.
        #[test]
        fn meetings_through_crossings_are_rounded_once(c in prop::array::uniform14(-20i32..20)) {
            let p = |k: usize| Point2::new(f64::from(c[k]) * 0.1, f64::from(c[k + 1]));
            let (l, m) = (Segment2::new(p(0), p(2)), Segment2::new(p(4), p(6)));
            if !l.crosses(&m) {
                return Ok(());
            }
            let exact = Exact::Crossing(l, m);
            let at = crate::corner::Corner::crossing(l, m).at;
            let through = Target { at, low: low_part(exact, at), exact };
            let wall = Segment2::new(p(10), p(12));
            let slow = in_fractions(p(8), &through, &wall);
            if slow != through.at {
                prop_assert_eq!(meet(p(8), &through, &wall), slow);
            }
        }
    }

    /// The impostor: the plain formula rounds more than once.
    #[test]
    fn plain_doubles_round_more_than_once() {
        let wrong = (1..1000u32).filter(|&i| {
            let (eye, at) = (Point2::new(0.1, 0.3), Point2::new(0.7, 0.1 * f64::from(i)));
            let wall = Segment2::new(Point2::new(11.3, -50.1), Point2::new(12.9, 60.7));
            let (d, u, w) = (at - eye, wall.b - wall.a, wall.a - eye);
            let plain = eye + d * (w.perp_dot(u) / d.perp_dot(u));
            plain != meet(eye, &Target { at, low: Point2::ZERO, exact: Exact::Point(at) }, &wall)
        });
        assert!(wrong.count() > 100);
    }
}
