//! The orientation predicate: on which side of a directed line does a point lie?
//!
//! Two implementations answer alike. [`Adaptive`] is exact for every accepted coordinate: a floating
//! filter first, Shewchuk's adaptive expansions (the `robust` crate) when the filter cannot tell.
//! [`SmallGrid`] is for points on a small grid (integers below 2^25, as in Doom maps, or multiples of an eighth), where plain
//! doubles make no rounding error, so that even collinear points are decided by the plain formula.
//!
//! Source: Shewchuk, "Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric
//! Predicates", Discrete Comput. Geom. 18, 1997, section 4.

use crate::{Point2, check_coordinate};

/// Decides orientations; the sign is exact.
///
/// Implementors are zero-sized or tiny, so that hot loops can be generic over them.
pub trait Orient2d: Copy + Send + Sync + std::fmt::Debug {
    /// Positive if `c` lies to the left of the directed line `a` to `b`, negative if to the right,
    /// zero if the three are collinear. Only the sign means anything.
    fn orient(self, a: Point2, b: Point2, c: Point2) -> f64;
}

/// The determinant in plain doubles.
#[inline(always)]
fn plain(a: Point2, b: Point2, c: Point2) -> (f64, f64) {
    ((a.x - c.x) * (b.y - c.y), (a.y - c.y) * (b.x - c.x))
}

/// Exact for every coordinate that [`crate::check_coordinate`] accepts.
#[derive(Debug, Clone, Copy, Default)]
pub struct Adaptive;

impl Orient2d for Adaptive {
    #[inline(always)]
    fn orient(self, a: Point2, b: Point2, c: Point2) -> f64 {
        let (left, right) = plain(a, b, c);
        let determinant = left - right;
        // Shewchuk's bound A: the rounding error is below (3 + 16 u) u (|left| + |right|), u = 2^-53.
        const BOUND: f64 = (3.0 + 8.0 * f64::EPSILON) * (0.5 * f64::EPSILON);
        if determinant.abs() > BOUND * (left.abs() + right.abs()) {
            return determinant;
        }
        exact(a, b, c)
    }
}

#[cold]
#[inline(never)]
fn exact(a: Point2, b: Point2, c: Point2) -> f64 {
    let coord = |p: Point2| robust::Coord { x: p.x, y: p.y };
    robust::orient2d(coord(a), coord(b), coord(c))
}

/// Exact for points on a small grid; made by [`SmallGrid::covering`] only, which checks them.
#[derive(Debug, Clone, Copy)]
pub struct SmallGrid {
    _checked: (),
}

impl SmallGrid {
    /// The grid predicate, if all points are on one square grid and less than 2^25 steps from the
    /// origin, for some power of two as step.
    ///
    /// Differences are then integers below 2^26 (in steps), products below 2^52, and the determinant
    /// below 2^53: all are doubles, so no operation rounds.
    pub fn covering(points: impl IntoIterator<Item = Point2> + Clone) -> Option<Self> {
        let coordinates = || points.clone().into_iter().flat_map(|p| [p.x, p.y]);
        let largest = coordinates().fold(0.0, |m: f64, x| m.max(x.abs()));
        let accepted = coordinates().all(|x| check_coordinate(x).is_ok());
        // The power of two that is not above the largest coordinate, by its exponent bits.
        let power = f64::from_bits(largest.to_bits() & (0x7ff << 52));
        let step = power / f64::from(1u32 << 24);
        let on_grid = |x: f64| (x / step).fract() == 0.0;
        (accepted && (largest == 0.0 || coordinates().all(on_grid))).then_some(Self { _checked: () })
    }
}

impl Orient2d for SmallGrid {
    #[inline(always)]
    fn orient(self, a: Point2, b: Point2, c: Point2) -> f64 {
        let (left, right) = plain(a, b, c);
        left - right
    }
}

/// [`Adaptive`]'s predicate as a function.
#[inline]
pub fn orient2d(a: Point2, b: Point2, c: Point2) -> f64 {
    Adaptive.orient(a, b, c)
}

/// For collinear points: whether `q` lies at `to` or beyond it, seen from `from`.
///
/// Compares coordinates and computes none, so it is exact. `from != to` is the caller's duty; for equal points the answer is `true`.
#[inline]
pub fn along(from: Point2, to: Point2, q: Point2) -> bool {
    let beyond = |f: f64, t: f64, q: f64| if t > f { q >= t } else { q <= t };
    if from.x != to.x {
        beyond(from.x, to.x, q.x)
    } else if from.y != to.y {
        beyond(from.y, to.y, q.y)
    } else {
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_bigint::BigInt;
    use num_rational::BigRational;
    use num_traits::Signed;
    use proptest::prelude::*;

    fn rational(x: f64) -> BigRational {
        BigRational::from_float(x).unwrap()
    }

    /// The oracle: the determinant in rational arithmetic.
    fn sign(a: Point2, b: Point2, c: Point2) -> i32 {
        let d = |p: f64, q: f64| rational(p) - rational(q);
        let det = d(a.x, c.x) * d(b.y, c.y) - d(a.y, c.y) * d(b.x, c.x);
        let zero = BigRational::from(BigInt::from(0));
        if det.is_positive() { 1 } else { -i32::from(det < zero) }
    }

    fn sign_of(x: f64) -> i32 {
        i32::from(x > 0.0) - i32::from(x < 0.0)
    }

    /// Small integers and the largest ones that the grid takes, so that nothing but the last bit decides.
    fn fine() -> impl Strategy<Value = Point2> {
        let top = (1i32 << 25) - 1;
        let coordinate = prop_oneof![-4i32..5, top - 3..=top, -top..4 - top, -top..top];
        (coordinate.clone(), coordinate).prop_map(|(x, y)| Point2::new(f64::from(x), f64::from(y)))
    }

    /// Points a few ulps around a coarse grid, some of them of extreme magnitude.
    fn nasty() -> impl Strategy<Value = Point2> {
        let coordinate = (-4i32..5, -2i64..3, -3i32..4).prop_map(|(g, ulps, scale)| {
            let x = f64::from(g) * 0.1;
            let bits = x.to_bits().wrapping_add_signed(ulps);
            let x = if x == 0.0 { 0.0 } else { f64::from_bits(bits) };
            x * 2f64.powi(scale * 100)
        });
        (coordinate.clone(), coordinate).prop_map(|(x, y)| Point2::new(x, y))
    }

    proptest! {
        #[test]
        fn orientation_small_grid_is_exact(a in fine(), b in fine(), c in fine(), k in -60i32..60) {
            let s = 2f64.powi(k);
            let (a, b, c) = (a * s, b * s, c * s);
            let grid = SmallGrid::covering([a, b, c]).unwrap();
            prop_assert_eq!(sign_of(grid.orient(a, b, c)), sign(a, b, c));
            prop_assert_eq!(sign_of(orient2d(a, b, c)), sign(a, b, c));
        }

        #[test]
        fn orientation_adaptive_is_exact(a in nasty(), b in nasty(), c in nasty()) {
            prop_assert_eq!(sign_of(orient2d(a, b, c)), sign(a, b, c), "{:?} {:?} {:?}", a, b, c);
        }
    }

    /// The impostor: the plain formula fails somewhere, so the tests above can fail.
    #[test]
    fn orientation_plain_doubles_are_not_exact() {
        let wrong = (0..1000u32).filter(|&i| {
            let t = f64::from(i) * 1e-3;
            let (a, b) = (Point2::new(0.1, 0.1), Point2::new(12.3, 45.6));
            let c = a + (b - a) * t;
            let (l, r) = plain(a, b, c);
            sign_of(l - r) != sign(a, b, c)
        });
        assert!(wrong.count() > 0);
    }

    #[test]
    fn small_grid_refuses_what_it_cannot_decide() {
        let p = Point2::new;
        assert!(SmallGrid::covering([p(0.0, 0.0)]).is_some());
        assert!(SmallGrid::covering([p(0.125, -7.0)]).is_some());
        assert!(SmallGrid::covering([p(33_554_431.0, -7.0)]).is_some());
        assert!(SmallGrid::covering([p(33_554_432.0, -7.0)]).is_none());
        assert!(SmallGrid::covering([p(33_554_432.0, -8.0)]).is_some(), "a step of 2");
        assert!(SmallGrid::covering([p(0.1, 0.0)]).is_none());
        assert!(SmallGrid::covering([p(1.0, f64::NAN)]).is_none());
    }

    #[test]
    fn along_orders_collinear_points() {
        let p = Point2::new;
        assert!(along(p(0.0, 0.0), p(1.0, 1.0), p(1.0, 1.0)));
        assert!(along(p(0.0, 0.0), p(1.0, 1.0), p(2.0, 2.0)));
        assert!(!along(p(0.0, 0.0), p(1.0, 1.0), p(0.5, 0.5)));
        assert!(along(p(0.0, 0.0), p(0.0, -1.0), p(0.0, -3.0)));
        assert!(!along(p(0.0, 0.0), p(0.0, -1.0), p(0.0, 3.0)));
    }
}
