//! Cells of line space: all lines from one end to another, and how an edge passes them.

use crate::end::End;
use crate::orient::orient;
use sightlines_geometry::Point3;
use sightlines_geometry::vector::{cross, dot, sub};

/// The lines from every point of `from` to every point of `to`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Cell {
    pub(crate) from: End,
    pub(crate) to: End,
}

/// Rounding of `det(b - a, x - a, y - a)` in doubles, as a share of the sum of the magnitudes of its six products: three
/// differences, three products and five sums round at most a dozen times by 2^-53.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// More than the bound of a product with one rounded factor.
const MORE: f64 = 1.01;

/// Which sides of an edge the lines of a cell pass on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Passing {
    /// All lines between inner points pass on one side.
    OneSide,
    /// Some may pass on the one side and some on the other.
    Both,
}

impl Cell {
    /// How the lines pass the line through `x` and `y`.
    ///
    /// The side is `orient3d(a, b, x, y)`, which is affine in `a` and in `b`. So its value for inner points `a` and `b` is a sum of its
    /// values at pairs of corners with positive weights: if none of these is negative and one is positive, it is positive. Exact
    /// for exact ends; for others a value that is not certain counts as both sides.
    pub(crate) fn passing(&self, x: Point3, y: Point3) -> Passing {
        let (rounding, is_exact) = (self.rounding(x, y), self.to.is_exact());
        let (mut positive, mut negative) = (false, false);
        for &a in self.from.corners() {
            let here = rounding.of_lines_from(a, x, y);
            for &b in self.to.corners() {
                let value = here.value(b);
                let sign = if value.abs() > here.error {
                    value
                } else if is_exact {
                    orient(a, b, x, y)
                } else {
                    return Passing::Both;
                };
                positive |= sign > 0.0;
                negative |= sign < 0.0;
                if positive && negative {
                    return Passing::Both;
                }
            }
        }
        if positive || negative { Passing::OneSide } else { Passing::Both }
    }

    /// How far off the sides on which lines between corners pass an edge may be.
    pub(crate) fn rounding(&self, x: Point3, y: Point3) -> Rounding {
        let mut extent = [0.0f64; 3];
        let (mut low, mut high) = (x, x);
        for p in self.from.corners().iter().chain(self.to.corners()).chain([&y]) {
            for k in 0..3 {
                low[k] = low[k].min(p[k]);
                high[k] = high[k].max(p[k]);
                extent[k] = high[k] - low[k];
            }
        }
        let bound = ROUNDING * 6.0 * extent[0] * extent[1] * extent[2];
        Rounding { extent, bound, radius: self.to.radius(), is_exact: self.to.is_exact() }
    }
}

/// What rounding costs for an edge, as [`Cell::rounding`] finds it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Rounding {
    /// Of the box around both ends and the edge.
    extent: Point3,
    /// Of the determinant in doubles.
    bound: f64,
    /// Of the corners of the second end.
    radius: Point3,
    is_exact: bool,
}

/// The sides on which lines from one corner pass an edge.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LinesFrom {
    corner: Point3,
    normal: Point3,
    /// How far a value may be from that of the true corner.
    pub(crate) error: f64,
}

impl Rounding {
    /// Lines from `a`, a corner of the first end, and the edge from `x` to `y`.
    pub(crate) fn of_lines_from(&self, a: Point3, x: Point3, y: Point3) -> LinesFrom {
        let normal = cross(sub(x, a), sub(y, a));
        let slack = if self.is_exact {
            0.0
        } else {
            let extent = &self.extent;
            let size = |i: usize, j: usize| {
                (normal[3 - i - j].abs() + ROUNDING * extent[i] * extent[j]) * self.radius[3 - i - j]
            };
            MORE * (size(0, 1) + size(1, 2) + size(0, 2))
        };
        LinesFrom { corner: a, normal, error: self.bound + slack }
    }
}

impl LinesFrom {
    /// `orient3d(a, b, x, y)` for a corner of the second end, rounded.
    pub(crate) fn value(&self, b: Point3) -> f64 {
        dot(self.normal, sub(b, self.corner))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::truth::{Exact, cut_triangle, cuts, det, exact, mix};
    use num_rational::BigRational;
    use num_traits::Signed;
    use proptest::prelude::*;
    use sightlines_geometry::{Aabb, check_coordinate};

    fn point() -> impl Strategy<Value = Point3> {
        [-4i32..5, -4i32..5, -4i32..5].prop_map(|p| p.map(|x| f64::from(x) * 0.3))
    }

    /// Some are so large that a point lies within rounding of a corner or a side.
    fn weight() -> impl Strategy<Value = u64> {
        prop_oneof![1u64..9, Just(1 << 60)]
    }

    fn sign(a: &Exact, b: &Exact, x: &Exact, y: &Exact) -> i32 {
        let det = det(a, b, x, y);
        i32::from(det.is_positive()) - i32::from(det.is_negative())
    }

    proptest! {
        /// Invariant: if a cell is said to pass on one side, exact lines between inner points do, also after cuts that were
        /// rounded: the true corners of pieces are followed in fractions.
        #[test]
        fn all_inner_lines_pass_on_the_side_that_is_reported(
            low in point(), size in [1i32..4, 1i32..4], triangle in [point(), point(), point()], x in point(), y in point(),
            cuts in cuts(4),
            shift in prop_oneof![Just(0.0), Just(1e6)],
            near in prop::option::of((0usize..3, [-2i8..3, -2i8..3, -2i8..3])),
            weights in prop::collection::vec([weight(), weight(), weight(), weight(), weight()], 12),
        ) {
            let moved = |p: Point3| p.map(|x| x + shift);
            let (low, triangle, x, y) = (moved(low), triangle.map(moved), moved(x), moved(y));
            let high = [low[0] + f64::from(size[0]), low[1] + f64::from(size[1]), low[2]];
            let from = End::rectangle(&Aabb { min: low, max: high }, 2).expect("it has an area");
            let (to, truth) = cut_triangle(triangle, cuts);
            // An edge may end at a corner, but for a few units in the last place.
            let step = |x: f64, n: i8| (0..n.abs()).fold(x, |x, _| if n > 0 { x.next_up() } else { x.next_down() });
            let x = near.map_or(x, |(i, by)| std::array::from_fn(|k| step(to.corners()[i][k], by[k])));
            if x.iter().any(|&x| check_coordinate(x).is_err()) {
                return Ok(());
            }
            let cell = Cell { from, to };
            let mut signs = [0; 2];
            for [a, b, c, d, e] in weights {
                let part = |a: u64, b: u64| BigRational::new(a.into(), (a + b).into());
                let (low, high) = (exact(low), exact(high));
                let at = |k: usize, t: BigRational| &low[k] + (&high[k] - &low[k]) * t;
                let eye = [at(0, part(a, b)), at(1, part(b, c)), low[2].clone()];
                let s = sign(&eye, &mix(&truth, &[c, d, e]), &exact(x), &exact(y));
                signs[0] |= i32::from(s <= 0);
                signs[1] |= i32::from(s >= 0);
            }
            if cell.passing(x, y) == Passing::OneSide {
                prop_assert!(signs != [1, 1], "{:?} {:?} {:?}", cell, x, y);
            }
        }
    }

    #[test]
    fn edges_beside_and_across() {
        let from = End::rectangle(&Aabb { min: [0.0; 3], max: [1.0, 1.0, 0.0] }, 2).expect("an area");
        let to = End::rectangle(&Aabb { min: [0.0, 0.0, 2.0], max: [1.0, 1.0, 2.0] }, 2).expect("an area");
        let cell = Cell { from, to };
        assert_eq!(cell.passing([2.0, 0.0, 1.0], [2.0, 1.0, 1.0]), Passing::OneSide);
        assert_eq!(cell.passing([1.0, 0.0, 1.0], [1.0, 5.0, 1.0]), Passing::OneSide, "on the border");
        assert_eq!(cell.passing([0.9, 0.0, 1.0], [0.9, 1.0, 1.0]), Passing::Both);
        assert_eq!(cell.passing([0.5, 0.0, 0.0], [0.5, 1.0, 0.0]), Passing::Both, "in the plane of an end");
        assert_eq!(cell.passing([3.0, 3.0, 3.0], [3.0, 3.0, 3.0]), Passing::Both, "no edge at all");
    }
}
