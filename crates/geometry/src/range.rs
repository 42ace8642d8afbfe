//! Ranges of numbers, rounded outwards: what is computed of them holds for every number in them.

use crate::coordinate::MIN_MAGNITUDE;
use crate::{Aabb, Point3, check_coordinate};

/// All numbers from `low` to `high`, in any unit. Not a number in either end makes it all numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    /// The smallest.
    pub low: f64,
    /// The largest.
    pub high: f64,
}

/// A range for each axis.
pub type RangeBox = [Range; 3];

impl Range {
    /// All numbers.
    pub const ALL: Self = Self { low: f64::NEG_INFINITY, high: f64::INFINITY };

    /// One number.
    pub const fn of(x: f64) -> Self {
        Self { low: x, high: x }
    }

    /// Rounded outwards by one unit in the last place, which is more than the rounding of one operation.
    fn outwards(low: f64, high: f64) -> Self {
        if low.is_nan() || high.is_nan() { Self::ALL } else { Self { low: low.next_down(), high: high.next_up() } }
    }

    /// The smallest range with both.
    pub fn with(self, other: Self) -> Self {
        if [self.low, self.high, other.low, other.high].iter().any(|x| x.is_nan()) {
            return Self::ALL;
        }
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    /// The part that is also in `other`; `self` if there is none, which rounding could cause.
    pub fn within(self, other: Self) -> Self {
        let (low, high) = (self.low.max(other.low), self.high.min(other.high));
        if low <= high { Self { low, high } } else { self }
    }

    /// With all numbers that are at most `by` away.
    pub fn wider(self, by: f64) -> Self {
        Self::outwards(self.low - by, self.high + by)
    }

    /// Sums.
    pub fn plus(self, other: Self) -> Self {
        Self::outwards(self.low + other.low, self.high + other.high)
    }

    /// Differences.
    pub fn minus(self, other: Self) -> Self {
        Self::outwards(self.low - other.high, self.high - other.low)
    }

    /// Products.
    pub fn times(self, other: Self) -> Self {
        Self::around([self.low * other.low, self.low * other.high, self.high * other.low, self.high * other.high])
    }

    /// Around results of one operation each.
    fn around(results: [f64; 4]) -> Self {
        if results.iter().any(|x| x.is_nan()) {
            return Self::ALL;
        }
        let low = results.into_iter().fold(f64::INFINITY, f64::min);
        Self::outwards(low, results.into_iter().fold(f64::NEG_INFINITY, f64::max))
    }

    /// Squares, none below 0.
    pub fn square(self) -> Self {
        let [a, b] = [self.low * self.low, self.high * self.high];
        let low = if self.low <= 0.0 && self.high >= 0.0 { 0.0 } else { a.min(b) };
        let all = Self::outwards(low, a.max(b));
        Self { low: all.low.max(0.0), ..all }
    }

    /// The quotient by numbers above 0.
    pub fn over(self, divisor: Self) -> Self {
        let Self { low, high } = divisor;
        Self::around([self.low / low, self.low / high, self.high / low, self.high / high])
    }

    /// Whether both ends are numbers.
    pub fn is_finite(self) -> bool {
        self.low.is_finite() && self.high.is_finite()
    }
}

/// A point as a box.
pub fn box_of(p: Point3) -> RangeBox {
    p.map(Range::of)
}

/// The smallest box with both.
pub fn united(a: RangeBox, b: RangeBox) -> RangeBox {
    [a[0].with(b[0]), a[1].with(b[1]), a[2].with(b[2])]
}

/// The box as one of a scene, if its coordinates can be some of a scene.
pub fn bounded(b: RangeBox) -> Option<Aabb<3>> {
    // Numbers that are too small for a coordinate are rounded outwards too.
    let low = |x: f64| {
        if x.abs() >= MIN_MAGNITUDE {
            x
        } else if x < 0.0 {
            -MIN_MAGNITUDE
        } else {
            0.0
        }
    };
    let found = Aabb { min: b.map(|range| low(range.low)), max: b.map(|range| -low(-range.high)) };
    let mut ends = found.min.into_iter().chain(found.max);
    ends.all(|x| check_coordinate(x).is_ok()).then_some(found)
}

/// Where the rows of an affine map put a box.
pub fn mapped(rows: &[[Range; 4]; 3], b: RangeBox) -> RangeBox {
    rows.map(|row| row[0].times(b[0]).plus(row[1].times(b[1])).plus(row[2].times(b[2])).plus(row[3]))
}

/// The rotations of all quaternions in a box, of any length but zero; all rotations if one of them may be zero.
pub fn rotations([x, y, z, w]: [Range; 4]) -> [[Range; 3]; 3] {
    const ANY: Range = Range { low: -1.0, high: 1.0 };
    let [xx, yy, zz, ww] = [x.square(), y.square(), z.square(), w.square()];
    let length = xx.plus(yy).plus(zz).plus(ww);
    if !(length.low > 0.0 && length.is_finite()) {
        return [[ANY; 3]; 3];
    }
    let (one, two) = (Range::of(1.0), Range::of(2.0));
    // Three ways to write the same; each is tighter elsewhere.
    let diagonal = |plus: Range, a: Range, b: Range| {
        let (more, less) = (ww.plus(plus), a.plus(b));
        let by_difference = more.minus(less).over(length);
        let from_above = one.minus(two.times(less).over(length));
        let from_below = two.times(more).over(length).minus(one);
        by_difference.within(from_above).within(from_below).within(ANY)
    };
    let off = |a: Range, b: Range| two.times(a.plus(b)).over(length).within(ANY);
    let minus = |a: Range| Range::of(0.0).minus(a);
    let [xy, xz, yz] = [x.times(y), x.times(z), y.times(z)];
    let [wx, wy, wz] = [w.times(x), w.times(y), w.times(z)];
    [
        [diagonal(xx, yy, zz), off(xy, minus(wz)), off(xz, wy)],
        [off(xy, wz), diagonal(yy, xx, zz), off(yz, minus(wx))],
        [off(xz, minus(wy)), off(yz, wx), diagonal(zz, xx, yy)],
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn range(low: f64, high: f64) -> Range {
        Range { low, high }
    }

    fn holds(range: Range, x: f64) -> bool {
        range.low <= x && x <= range.high
    }

    #[test]
    fn what_is_computed_holds_for_all_numbers() {
        let (a, b) = (range(-1.0, 3.0), range(2.0, 5.0));
        for (x, y) in [(-1.0, 2.0), (-1.0, 5.0), (3.0, 5.0), (0.0, 3.5), (3.0, 2.0)] {
            assert!(holds(a.plus(b), x + y) && holds(a.minus(b), x - y) && holds(a.times(b), x * y));
            assert!(holds(a.square(), x * x) && holds(a.over(b), x / y) && holds(a.with(b), x) && holds(a.with(b), y));
        }
        // And not for many more.
        assert!(
            !holds(a.plus(b), 8.1) && !holds(a.times(b), -5.1) && !holds(a.square(), -0.1) && !holds(a.over(b), 1.6)
        );
        assert_eq!(range(0.0, 1.0).times(Range::ALL), Range::ALL);
        assert_eq!(bounded([a, b, Range::ALL]), None);
        assert_eq!(bounded([a, b, a]).unwrap().max, [3.0, 5.0, 3.0]);
        let tiny = bounded([range(-1e-300, 1e-300), range(1e-300, 1.0), range(-1.0, -1e-300)]).unwrap();
        assert_eq!((tiny.min, tiny.max), ([-MIN_MAGNITUDE, 0.0, -1.0], [MIN_MAGNITUDE, 1.0, 0.0]));
        assert_eq!(a.within(range(0.0, 9.0)), range(0.0, 3.0));
    }

    /// Against fractions, for numbers of all magnitudes, denormal ones among them: the true result of one operation lies within the next doubles of the
    /// rounded one, and mostly not on it.
    #[test]
    fn one_operation_is_within_the_next_doubles() {
        use num_rational::BigRational;
        use num_traits::Zero;
        let exact = |x: f64| BigRational::from_float(x).unwrap();
        let mut random = crate::Random::new(7);
        let mut number = |k: usize| {
            let exponents =
                [random.bits() % 2047, 1018 + random.bits() % 10, random.bits() % 3, 480 + random.bits() % 80];
            f64::from_bits(random.bits() >> 63 << 63 | exponents[k % 4] << 52 | random.bits() >> 12)
        };
        let (mut n_held, mut n_rounded) = (0, 0);
        for k in 0..4000 {
            let [x, y] = [number(k), number(k / 4)];
            let ([a, b], [p, q]) = ([x, y].map(Range::of), [exact(x), exact(y)]);
            let mut results = vec![(a.plus(b), x + y, &p + &q), (a.minus(b), x - y, &p - &q)];
            results.extend([(a.times(b), x * y, &p * &q), (a.square(), x * x, &p * &p)]);
            if y > 0.0 {
                results.push((a.over(b), x / y, &p / &q));
            }
            for (range, rounded, truth) in results {
                let is_below = |x: f64| if x.is_finite() { exact(x) <= truth } else { x < 0.0 };
                let is_above = |x: f64| if x.is_finite() { exact(x) >= truth } else { x > 0.0 };
                assert!(is_below(range.low) && is_above(range.high), "{x:e} {y:e} {range:?}");
                n_held += 1;
                n_rounded += usize::from(rounded.is_finite() && !(exact(rounded) - &truth).is_zero());
            }
        }
        assert!(n_held > 15_000 && n_rounded > n_held / 4, "{n_rounded} of {n_held}");
    }

    #[test]
    fn rotations_of_a_quaternion_are_tight_and_those_of_many_are_held() {
        let h = std::f64::consts::FRAC_1_SQRT_2;
        let quarter = rotations([0.0, h, 0.0, h].map(Range::of));
        let expected = [[0., 0., 1.], [0., 1., 0.], [-1., 0., 0.]];
        for (row, right) in quarter.iter().zip(expected) {
            for (range, x) in row.iter().zip(right) {
                assert!(holds(*range, x) && range.high - range.low < 1e-14, "{range:?} {x}");
            }
        }
        // From rest to a quarter about y, in any length.
        let some = rotations([Range::of(0.0), range(0.0, 1.5), Range::of(0.0), range(0.7, 2.0)]);
        for k in 0..=10 {
            let angle = std::f64::consts::FRAC_PI_2 * f64::from(k) / 10.0;
            assert!(holds(some[0][0], angle.cos()) && holds(some[0][2], angle.sin()) && holds(some[1][1], 1.0));
        }
        assert_eq!(rotations([range(-1.0, 1.0); 4])[0][0], range(-1.0, 1.0));
    }
}
