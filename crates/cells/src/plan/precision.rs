//! How precise the coordinates of a plan are, by their digits.

use super::Plan;

/// The share of a plan's longer side that the precision of decimals is at most: 2^-10, two centimetres of 20 metres. Coarser grids were chosen by
/// who drew the plan, and tell nothing of rounding. A choice, not derived.
const COARSEST: f64 = 1.0 / 1024.0;

/// From how many significant digits on a number was written as a double in full.
const FULL: usize = 16;

impl Plan {
    /// The same plan, with a precision that its source states, in units of the plan; `None` if it states none.
    #[must_use]
    pub fn with_precision(self, precision: Option<f64>) -> Self {
        Self { precision: precision.filter(|p| *p >= 0.0), ..self }
    }

    /// What the source of the plan states of its precision: that of a scene it was cut from, or 0 for formats of integers.
    pub const fn stated_precision(&self) -> Option<f64> {
        self.precision
    }

    /// How precise the coordinates are, in units of the plan: openings up to this width may be due to rounding.
    ///
    /// It is what the source [states](Self::stated_precision), and at least the [least gap](Self::least_gap) where that is not 0. Else it follows from the digits of the ends of opaque lines. If three of four
    /// coordinates have at most k decimals, k > 0, they were rounded to units u = 10^-k: an end and a line that it was meant to lie on, or two
    /// ends that were meant to be one, are off by at most u / √2 each, √2 u together; the precision is 1.5 u. That holds only if it is at most
    /// 2^-10 of the longer side. Otherwise numbers were written in full (16 digits and more) or drawn on a grid by hand, and the precision is
    /// that least gap. O(n) for n lines.
    pub fn precision(&self) -> f64 {
        match self.precision {
            Some(0.0) => 0.0,
            stated => self.least_gap().max(stated.or_else(|| self.decimal_precision()).unwrap_or(0.0)),
        }
    }

    /// What is left of a plan that was turned and shifted in doubles: 2^-45 M, where M is the largest coordinate of an opaque line.
    ///
    /// A product is off by 2^-53 M, a sum of two and a shift by less than 2^-51 M, along each axis; an end and a line together by less than
    /// 2^-49 M. The rest is for plans that went through several programs, and for what the search for [joints](Self::joined) does not decide.
    pub fn least_gap(&self) -> f64 {
        self.largest() / (1u64 << 45) as f64
    }

    /// What is left of a plan whose coordinates were rounded to single precision: 2^-20 M, as for scenes in space.
    pub fn single_precision(&self) -> f64 {
        self.largest() / f64::from(1u32 << 20)
    }

    /// The largest coordinate of an opaque line.
    pub(super) fn largest(&self) -> f64 {
        self.opaque_ends().flat_map(|p| [p.x, p.y]).fold(0.0, |m, x| f64::max(m, x.abs()))
    }

    /// The longer side of the box around all lines; 0 without any.
    pub(super) fn longer_side(&self) -> f64 {
        let bounds = self.bounds();
        if bounds.is_empty() { 0.0 } else { (bounds.max[0] - bounds.min[0]).max(bounds.max[1] - bounds.min[1]) }
    }

    fn decimal_precision(&self) -> Option<f64> {
        let mut decimals: Vec<Option<usize>> = self.opaque_ends().flat_map(|p| [p.x, p.y]).map(decimals).collect();
        // Those in full come last.
        let key = |k: &Option<usize>| k.unwrap_or(usize::MAX);
        let place = (3 * decimals.len()).div_ceil(4).checked_sub(1)?;
        let k = (*decimals.select_nth_unstable_by_key(place, key).1).filter(|&k| k > 0)?;
        let width: f64 = format!("1.5e-{k}").parse().ok()?;
        (width <= COARSEST * self.longer_side()).then_some(width)
    }
}

/// The decimals of the shortest number that means a double; `None` if that has as many digits as doubles in full.
fn decimals(x: f64) -> Option<usize> {
    let text = format!("{x:e}");
    let (mantissa, exponent) = text.split_once('e')?;
    let n_digits = mantissa.bytes().filter(u8::is_ascii_digit).count();
    let exponent: i64 = exponent.parse().ok()?;
    let places = n_digits as i64 - 1 - exponent;
    (n_digits < FULL).then(|| usize::try_from(places).unwrap_or(0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use sightlines_geometry::Point2;

    /// A room, and a wall in it, turned by 30 degrees and shifted.
    fn plan(round: impl Fn(f64) -> f64, shift: f64) -> Plan {
        let (sin, cos) = (0.5, 0.75f64.sqrt());
        let at = |x: f64, y: f64| Point2::new(round(shift + cos * x - sin * y), round(shift + sin * x + cos * y));
        let corners = [at(0., 0.), at(8., 0.), at(8., 6.), at(0., 6.)];
        let walls = (0..4).map(|k| (corners[k], corners[(k + 1) % 4]));
        Plan::from_walls(walls.chain([(at(3., 0.), at(3., 6.))])).unwrap()
    }

    #[test]
    fn the_precision_is_that_of_the_digits() {
        let milli = |x: f64| (x * 1e3).round() / 1e3;
        assert_eq!(decimals(0.1), Some(1));
        assert_eq!(decimals(5_123_456.75), Some(2));
        assert_eq!([decimals(0.1 + 0.2), decimals(1e300), decimals(0.0)], [None, Some(0), Some(0)]);
        for shift in [0.0, 5e5, 5e6] {
            assert_eq!(plan(milli, shift).precision(), 1.5e-3);
            let full = plan(|x| x, shift);
            assert_eq!(full.precision(), full.least_gap());
            assert!(full.precision() < 4e-13 * (8.0 + shift) && full.precision() > 0.0);
        }
        // Coarse grids, and whole numbers, were chosen by hand.
        for round in [|x: f64| (x * 10.0).round() / 10.0, f64::round] {
            let coarse = plan(round, 0.0);
            assert_eq!(coarse.precision(), coarse.least_gap());
        }
        // What is stated is taken.
        let stated = plan(milli, 0.0).with_precision(Some(0.0));
        assert_eq!((stated.precision(), stated.stated_precision()), (0.0, Some(0.0)));
        assert_eq!(Plan::default().precision(), 0.0);
    }
}
