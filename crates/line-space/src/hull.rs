//! The convex hull of the two ends of a cell of line space, as half-spaces.
//!
//! A line from an inner point of one end to an inner point of the other stays, between its ends, strictly inside of every
//! half-space found here. An edge with both ends outside or on the border of the same half-space is therefore never met by such a line.

use crate::cell::Cell;
use crate::orient::orient;
use sightlines_geometry::Point3;
use sightlines_geometry::vector::{cross, dot, sub};

/// The most half-spaces: one for each end, one for each side of each end.
const MOST: usize = 10;

/// A half-space: points `p` with `orient3d(a, b, c, p)` of one sign.
#[derive(Debug, Clone, Copy, Default)]
struct HalfSpace {
    through: [Point3; 3],
    /// The normal, turned inwards; rounded.
    normal: Point3,
    /// For each axis the sum of the magnitudes of the two products in `normal`.
    weight: Point3,
    /// How far outside a point has to be, for the true ends to be strictly inside.
    margin: f64,
    /// 1 if the sign of `orient3d` is positive inside, else -1.
    sign: f64,
}

/// Rounding of `normal · (p - a)`, as a share of the sum of magnitudes.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

impl HalfSpace {
    fn new(through: [Point3; 3], sign: f64, radius: Point3) -> Self {
        let [a, b, c] = through;
        let (u, v) = (sub(b, a), sub(c, a));
        let normal = cross(u, v).map(|x| x * sign);
        let part = |i: usize, j: usize| (u[i] * v[j]).abs() + (u[j] * v[i]).abs();
        let weight = [part(1, 2), part(2, 0), part(0, 1)];
        let margin = (0..3).map(|k| 1.01 * (normal[k].abs() + ROUNDING * weight[k]) * radius[k]).sum();
        Self { through, normal, weight, margin, sign }
    }

    fn is_far_inside(&self, p: Point3) -> bool {
        let d = sub(p, self.through[0]);
        let sum = self.weight[0] * d[0].abs() + self.weight[1] * d[1].abs() + self.weight[2] * d[2].abs();
        dot(self.normal, d) > ROUNDING * sum + self.margin
    }

    /// Whether a point is certainly outside (-1), on the border (0), or perhaps inside (1).
    fn side(&self, p: Point3) -> i8 {
        let [a, b, c] = self.through;
        let d = sub(p, a);
        let value = dot(self.normal, d);
        let bound =
            ROUNDING * (self.weight[0] * d[0].abs() + self.weight[1] * d[1].abs() + self.weight[2] * d[2].abs());
        if value > bound {
            return 1;
        }
        if value < -(bound + self.margin) {
            return -1;
        }
        if self.margin > 0.0 {
            return 1;
        }
        let exact = self.sign * orient(a, b, c, p);
        i8::from(exact > 0.0) - i8::from(exact < 0.0)
    }
}

/// The half-spaces side by side, so that all of them are tested at once. Bounds on rounding hold for points within a given reach; a
/// point so near to a border that rounding may matter is left to the [`HalfSpace`].
#[derive(Debug, Clone, Copy)]
struct Quick {
    /// `normal[0] x + normal[1] y + normal[2] z + offset` is how far inside a point is.
    normal: [[f64; MOST]; 3],
    offset: [f64; MOST],
    /// Above this value it is inside.
    inside: [f64; MOST],
    /// Below this value it is outside.
    outside: [f64; MOST],
}

impl Quick {
    /// Without half-spaces everything is inside.
    const NONE: Self =
        Self { normal: [[0.0; MOST]; 3], offset: [0.0; MOST], inside: [-1.0; MOST], outside: [-1.0; MOST] };

    /// Sets half-space `i`. `normal · (p - a)` is off by at most `ROUNDING · weight · (|p| + |a|)`; summed in this order it has four more
    /// roundings of terms of that size, for which twice the bound is enough.
    fn set(&mut self, i: usize, space: &HalfSpace, reach: Point3) {
        let a = space.through[0];
        let bound = 2.0 * ROUNDING * (0..3).map(|k| space.weight[k] * (reach[k] + a[k].abs())).sum::<f64>();
        (0..3).for_each(|k| self.normal[k][i] = space.normal[k]);
        self.offset[i] = -dot(space.normal, a);
        (self.inside[i], self.outside[i]) = (bound, -(bound + space.margin));
    }

    /// For each half-space a bit if the point is outside, and a bit if that is not certain.
    fn sides(&self, p: Point3) -> [u16; 2] {
        let [x, y, z] = &self.normal;
        let value: [f64; MOST] = std::array::from_fn(|i| x[i] * p[0] + y[i] * p[1] + z[i] * p[2] + self.offset[i]);
        let (mut outside, mut open) = (0, 0);
        for (i, value) in value.into_iter().enumerate() {
            let is_outside = value < self.outside[i];
            outside |= u16::from(is_outside) << i;
            open |= u16::from(!is_outside && value <= self.inside[i]) << i;
        }
        [outside, open]
    }
}

/// The half-spaces of a cell.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Hull {
    spaces: [HalfSpace; MOST],
    quick: Quick,
    n: usize,
    /// Whether the first one is that of the end where lines begin.
    begins: bool,
}

/// Where a point is: a bit for each half-space that it is outside or on the border of, and whether it is strictly behind the
/// end where lines begin.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Code(u16);

/// The bit of a point strictly behind the end where lines begin.
const BEHIND: u16 = 1 << 15;

impl Hull {
    /// * `reach`: the largest magnitudes of coordinates of points that are asked about
    pub(crate) fn of(cell: &Cell, reach: Point3) -> Self {
        let mut hull = Self { spaces: [HalfSpace::default(); MOST], quick: Quick::NONE, n: 0, begins: false };
        let (from, to) = (cell.from.corners(), cell.to.corners());
        let radius = cell.to.radius();
        hull.begins = hull.add([from[0], from[1], from[2]], cell, radius);
        hull.add([to[0], to[1], to[2]], cell, radius);
        for (one, other) in [(from, to), (to, from)] {
            for i in 0..one.len() {
                let [a, b, third] = [0, 1, 2].map(|k| one[(i + k) % one.len()]);
                // Turned about the side until it supports the other end, too.
                let mut best = other[0];
                for &p in &other[1..] {
                    let inner = orient(a, b, best, third);
                    if orient(a, b, best, p) * inner < 0.0 {
                        best = p;
                    }
                }
                hull.add([a, b, best], cell, radius);
            }
        }
        for (i, space) in hull.spaces[..hull.n].iter().enumerate() {
            hull.quick.set(i, space, reach);
        }
        hull
    }

    /// Adds the half-space whose border goes through three points and that contains both ends; says whether there is one.
    fn add(&mut self, through: [Point3; 3], cell: &Cell, radius: Point3) -> bool {
        let [a, b, c] = through;
        // The plane where lines begin is the first one, and has a rule of its own.
        let begins_here = |p: &Point3| through.contains(p) || orient(a, b, c, *p) == 0.0;
        if self.begins && cell.from.corners().iter().all(begins_here) {
            return false;
        }
        let (mut positive, mut negative) = (false, false);
        for &p in cell.from.corners().iter().chain(cell.to.corners()) {
            if through.contains(&p) {
                continue;
            }
            let side = orient(a, b, c, p);
            positive |= side > 0.0;
            negative |= side < 0.0;
        }
        // Of a border that contains both ends nothing is strictly inside.
        if positive == negative || self.n == MOST {
            return false;
        }
        let mut space = HalfSpace::new(through, if positive { 1.0 } else { -1.0 }, radius);
        // Where every corner that was rounded is farther inside than it was rounded, the border is exact.
        if !cell.to.corners().iter().any(|p| through.contains(p))
            && cell.to.corners().iter().all(|&p| space.is_far_inside(p))
        {
            space.margin = 0.0;
        }
        self.spaces[self.n] = space;
        self.n += 1;
        true
    }

    /// Where a point is.
    pub(crate) fn code(&self, p: Point3) -> Code {
        let [mut code, mut open] = self.quick.sides(p);
        if self.begins && code & 1 != 0 {
            code |= BEHIND;
        }
        while open != 0 {
            let i = open.trailing_zeros() as usize;
            open &= open - 1;
            let side = self.spaces[i].side(p);
            code |= u16::from(side <= 0) << i;
            if i == 0 && self.begins && side < 0 {
                code |= BEHIND;
            }
        }
        Code(code)
    }

    /// Whether no line between inner points meets the edge between points with these codes, except at its ends.
    ///
    /// An edge in the plane where lines begin is met by lines that begin there.
    pub(crate) fn misses(&self, p: Code, q: Code) -> bool {
        let common = p.0 & q.0 & !BEHIND;
        let lateral = if self.begins { common & !1 } else { common };
        lateral != 0 || common != 0 && (p.0 | q.0) & BEHIND != 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::end::End;
    use crate::truth::{Exact, cut_triangle, cuts, det, exact};
    use num_rational::BigRational;
    use num_traits::Zero;
    use proptest::prelude::*;
    use sightlines_geometry::{Aabb, check_coordinate};

    fn point() -> impl Strategy<Value = Point3> {
        [-4i32..5, -4i32..5, -4i32..5].prop_map(|p| p.map(|x| f64::from(x) * 0.3))
    }

    /// How far inside of the stored border of a half-space a point is, in some unit.
    fn depth(space: &HalfSpace, p: &Exact) -> BigRational {
        let [a, b, c] = space.through.map(exact);
        let det = det(&a, &b, &c, p);
        if space.sign > 0.0 { det } else { -det }
    }

    proptest! {
        /// Invariant: a point that is said to be on or outside of a border is no deeper inside than any true corner of the ends, which are
        /// followed in fractions through cuts that were rounded.
        #[test]
        fn true_ends_are_inside_of_what_excludes_a_point(
            low in point(), size in [1i32..4, 1i32..4], triangle in [point(), point(), point()], shift in prop_oneof![Just(0.0), Just(1e6)],
            cuts in cuts(5), others in prop::collection::vec(point(), 6),
            ulps in prop::collection::vec([-3i8..4, -3i8..4, -3i8..4], 8),
        ) {
            let [low, triangle, others] = [vec![low], triangle.to_vec(), others].map(|all| -> Vec<Point3> {
                all.into_iter().map(|p| p.map(|x| x + shift)).collect()
            });
            let (low, triangle) = (low[0], [triangle[0], triangle[1], triangle[2]]);
            let high = [low[0] + f64::from(size[0]), low[1] + f64::from(size[1]), low[2]];
            let from = End::rectangle(&Aabb { min: low, max: high }, 2).expect("it has an area");
            let (to, truth) = cut_triangle(triangle, cuts);
            let points = || others.iter().chain(from.corners()).chain(to.corners());
            let reach = [0, 1, 2].map(|k| points().map(|p| p[k].abs().next_up().next_up().next_up()).fold(0.0, f64::max));
            let hull = Hull::of(&Cell { from, to }, reach);
            let near = |p: &Point3, by: &[i8; 3]| -> Point3 {
                std::array::from_fn(|k| (0..by[k].abs()).fold(p[k], |x, _| if by[k] > 0 { x.next_up() } else { x.next_down() }))
            };
            let corners: Vec<Point3> = from.corners().iter().chain(to.corners()).copied().collect();
            let mut nearby: Vec<Point3> = corners.iter().zip(&ulps).map(|(p, by)| near(p, by)).collect();
            nearby.retain(|p| p.iter().all(|&x| check_coordinate(x).is_ok()));
            for p in others.iter().chain(&corners).chain(&nearby) {
                let sides: Vec<i8> = hull.spaces[..hull.n].iter().map(|space| space.side(*p)).collect();
                let outside = sides.iter().enumerate().map(|(i, side)| u16::from(*side <= 0) << i).sum::<u16>();
                let is_behind = hull.begins && sides[0] < 0;
                prop_assert_eq!(hull.code(*p), Code(outside | if is_behind { BEHIND } else { 0 }));
            }
            for space in &hull.spaces[..hull.n] {
                let least = from.corners().iter().map(|&p| exact(p)).chain(truth.clone()).map(|p| depth(space, &p)).min();
                let least = least.expect("there are corners");
                prop_assert!(space.margin > 0.0 || least >= BigRational::zero());
                for p in others.iter().chain(&corners).chain(&nearby) {
                    let depth = depth(space, &exact(*p));
                    match space.side(*p) {
                        1 => {}
                        0 => prop_assert!(depth <= least && depth.is_zero(), "{:?} {:?}", space, p),
                        _ => prop_assert!(depth < least, "{:?} {:?}", space, p),
                    }
                }
            }
        }
    }
}
