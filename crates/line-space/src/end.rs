//! One end of a set of lines: a rectangle across an axis, or a triangle.

use crate::orient::{height, sign};
use sightlines_geometry::{Aabb, Point3, check_coordinate};
use std::num::NonZeroI32;

/// A convex piece of a plane on which lines begin or end.
///
/// Rectangles are exact. A triangle that was cut out of a larger one has corners that were rounded; `radius` bounds how
/// far each true corner is from the stored one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct End {
    corners: [Point3; 4],
    n: u8,
    radius: Point3,
    /// Around the true corners.
    bounds: Aabb<3>,
    /// Where it was cut by planes of triangles.
    sides: [Option<PlaneSide>; MOST_SIDES],
}

/// The side of the plane of a triangle of the surface on which all of an end is. In few bytes: the number of the triangle, from 1 on, with the sign.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct PlaneSide(NonZeroI32);

impl PlaneSide {
    /// None for numbers that are too large.
    fn new(triangle: u32, sign: i8) -> Option<Self> {
        let number = i32::try_from(triangle).ok()?.checked_add(1)?;
        NonZeroI32::new(number * i32::from(sign)).map(Self)
    }

    pub(crate) fn triangle(self) -> u32 {
        self.0.get().unsigned_abs() - 1
    }

    /// The sign of `orient3d` of the triangle and points of the end.
    pub(crate) fn sign(self) -> i8 {
        if self.0.get() > 0 { 1 } else { -1 }
    }
}

/// So many planes are remembered, the last ones.
const MOST_SIDES: usize = 3;

/// Where a plane is crossed at a part of a side that is less certain than this, nothing is cut.
const UNCERTAIN: f64 = 1.0 / (1u64 << 12) as f64;

/// What rounding a point `a + (b - a) t` costs at most, as a share of `|a| + |b|`: three roundings of 2^-53 each, of
/// numbers of at most twice that size.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// The rounding error of a coordinate of the point where a segment crosses a plane, if its ends have the coordinates `x` and `y`. The parameter
/// is rounded three times, which [`ROUNDING`] does not count.
pub(crate) fn crossing_error(x: f64, y: f64) -> f64 {
    2.0 * ROUNDING * (x.abs() + y.abs())
}

impl End {
    /// The rectangle of a box that is flat along `axis`; none if it is flat along another axis, too.
    pub(crate) fn rectangle(b: &Aabb<3>, axis: usize) -> Option<Self> {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        if !(b.min[u] < b.max[u] && b.min[v] < b.max[v]) {
            return None;
        }
        let corner = |x: f64, y: f64| {
            let mut p = b.min;
            (p[u], p[v]) = (x, y);
            p
        };
        let ([x, y], [x1, y1]) = ([b.min[u], b.min[v]], [b.max[u], b.max[v]]);
        let corners = [corner(x, y), corner(x1, y), corner(x1, y1), corner(x, y1)];
        Some(Self { corners, n: 4, radius: [0.0; 3], bounds: *b, sides: [None; MOST_SIDES] })
    }

    /// A triangle of the input.
    pub(crate) fn triangle(corners: [Point3; 3]) -> Self {
        Self::rounded(corners, [0.0; 3])
    }

    /// A triangle whose true corners are within `radius` along each axis.
    fn rounded([a, b, c]: [Point3; 3], radius: Point3) -> Self {
        let mut bounds = Aabb::around([a, b, c]);
        for k in (0..3).filter(|&k| radius[k] > 0.0) {
            bounds.min[k] = (bounds.min[k] - radius[k]).next_down();
            bounds.max[k] = (bounds.max[k] + radius[k]).next_up();
        }
        Self { corners: [a, b, c, c], n: 3, radius, bounds, sides: [None; MOST_SIDES] }
    }

    /// The parts of a triangle where coordinate `k` is above `at`, or with `upward` false below: none, the whole, or one or two pieces whose
    /// new corners were rounded along the other axes.
    pub(crate) fn beyond(triangle: [Point3; 3], k: usize, at: f64, upward: bool) -> impl Iterator<Item = Self> {
        let inside = |p: &Point3| if upward { p[k] > at } else { p[k] < at };
        let outside = |p: &Point3| if upward { p[k] < at } else { p[k] > at };
        let mut pieces = [None; 2];
        if !triangle.iter().any(outside) {
            pieces[0] = triangle.iter().any(inside).then(|| Self::triangle(triangle));
            return pieces.into_iter().flatten();
        }
        let (mut ring, mut n, mut radius) = ([[0.0; 3]; 4], 0, [0.0f64; 3]);
        for i in 0..3 {
            let [a, b] = [triangle[i], triangle[(i + 1) % 3]];
            if !outside(&a) && n < 4 {
                (ring[n], n) = (a, n + 1);
            }
            if inside(&a) && outside(&b) || outside(&a) && inside(&b) {
                let t = (at - a[k]) / (b[k] - a[k]);
                let mut p = [0, 1, 2].map(|j| a[j] + (b[j] - a[j]) * t);
                p[k] = at;
                for j in (0..3).filter(|&j| j != k && a[j] != b[j]) {
                    radius[j] = radius[j].max(crossing_error(a[j], b[j]));
                }
                if n < 4 {
                    (ring[n], n) = (p, n + 1);
                }
            }
        }
        let piece = |a: usize, b: usize, c: usize| Self::rounded([ring[a], ring[b], ring[c]], radius);
        if n >= 3 && ring[..n].iter().any(inside) {
            pieces = [Some(piece(0, 1, 2)), (n == 4).then(|| piece(0, 2, 3))];
        }
        pieces.into_iter().flatten()
    }

    /// The corners, around.
    pub(crate) fn corners(&self) -> &[Point3] {
        &self.corners[..usize::from(self.n)]
    }

    /// How far true corners may be from the stored ones, along each axis.
    pub(crate) fn radius(&self) -> Point3 {
        self.radius
    }

    /// Whether the corners are the true ones.
    pub(crate) fn is_exact(&self) -> bool {
        self.radius == [0.0; 3]
    }

    /// A box around the true corners.
    pub(crate) fn bounds(&self) -> &Aabb<3> {
        &self.bounds
    }

    /// How many directions it can be cut across: the sides of a triangle, two adjacent sides of a rectangle. Side `i` runs from
    /// corner `i` to the next one.
    pub(crate) fn n_sides_to_cut(&self) -> usize {
        if self.n == 4 { 2 } else { 3 }
    }

    /// The two ends of a side.
    pub(crate) fn side(&self, i: usize) -> [Point3; 2] {
        let corners = self.corners();
        [corners[i], corners[(i + 1) % corners.len()]]
    }

    /// A point inside, at about these weights of the corners; rounded for triangles, by at most the radius that comes with it. None
    /// for a rectangle so thin that no double lies inside.
    pub(crate) fn inner(&self, weights: [f64; 4]) -> Option<(Point3, Point3)> {
        if self.n == 4 {
            // Doubles between those of two opposite corners are points of the rectangle.
            let [low, high] = [self.corners[0], self.corners[2]];
            let mut parts =
                [weights[0] / (weights[0] + weights[1]), weights[2] / (weights[2] + weights[3])].into_iter();
            let mut at = low;
            for k in (0..3).filter(|&k| low[k] != high[k]) {
                at[k] = check_coordinate(low[k] + (high[k] - low[k]) * parts.next()?).ok()?;
                if !(low[k] < at[k] && at[k] < high[k]) {
                    return None;
                }
            }
            return Some((at, [0.0; 3]));
        }
        let sum = weights[0] + weights[1] + weights[2];
        let corners = self.corners();
        let at =
            |k: usize| (corners[0][k] * weights[0] + corners[1][k] * weights[1] + corners[2][k] * weights[2]) / sum;
        let size = |k: usize| corners.iter().map(|c| c[k].abs()).fold(0.0, f64::max);
        let same = |k: usize| corners[0][k] == corners[1][k] && corners[1][k] == corners[2][k];
        let point = std::array::from_fn(|k| if same(k) { corners[0][k] } else { at(k) });
        let rounding =
            std::array::from_fn(|k| if same(k) { self.radius[k] } else { self.radius[k] + 4.0 * ROUNDING * size(k) });
        Some((point, rounding))
    }

    /// Weights for [`Self::inner`] of a point near a corner: those of other corners are `others`, if that of this one is 1.
    pub(crate) fn weights_near(&self, corner: usize, others: f64) -> [f64; 4] {
        let mut weights = [1.0; 4];
        if self.n == 4 {
            let [low, high] = [self.corners[0], self.corners[2]];
            for (i, k) in (0..3).filter(|&k| low[k] != high[k]).enumerate().take(2) {
                weights[2 * i + usize::from(self.corners[corner][k] == high[k])] = others;
            }
        } else {
            weights = [others; 4];
            weights[corner] = 1.0;
        }
        weights
    }

    /// Cuts it across side `i` at about the part `t` of that side, between 0 and 1; none where doubles leave no room.
    ///
    /// The two pieces cover it, and share the border between them.
    pub(crate) fn cut(&self, i: usize, t: f64) -> Option<[Self; 2]> {
        let [a, b] = self.side(i);
        if self.n == 4 {
            let k = (0..3).find(|&k| a[k] != b[k])?;
            let at = check_coordinate(a[k] + (b[k] - a[k]) * t).ok()?;
            if !(a[k].min(b[k]) < at && at < a[k].max(b[k])) {
                return None;
            }
            return Some(self.cut_at(k, a[k], at));
        }
        // Few binary digits, so that the point is often exact.
        let t = ((t * 32.0).round() / 32.0).clamp(1.0 / 32.0, 31.0 / 32.0);
        let mut middle = [0.0; 3];
        let mut radius = self.radius;
        for k in 0..3 {
            middle[k] = check_coordinate(a[k] + (b[k] - a[k]) * t).ok()?;
            if !is_exact(a[k], b[k], t) {
                radius[k] += ROUNDING * (a[k].abs() + b[k].abs());
            }
        }
        if middle == a || middle == b {
            return None;
        }
        let [x, y, z, _] = self.corners;
        let (mut first, mut second) = ([x, y, z], [x, y, z]);
        (first[(i + 1) % 3], second[i]) = (middle, middle);
        Some([first, second].map(|corners| Self { sides: self.sides, ..Self::rounded(corners, radius) }))
    }

    /// On which sides of planes it is known to be.
    pub(crate) fn sides(&self) -> impl Iterator<Item = PlaneSide> + '_ {
        self.sides.iter().copied().flatten()
    }

    /// Whether it is a rectangle of which only the part on known sides of planes counts. A triangle with such sides is all on them.
    pub(crate) fn is_partial(&self) -> bool {
        self.n == 4 && self.sides[0].is_some()
    }

    /// All of it, whatever is known of sides.
    pub(crate) fn whole(&self) -> Self {
        Self { sides: [None; MOST_SIDES], ..*self }
    }

    /// Whether nothing of it counts: all is on the wrong side of a plane, or on it.
    ///
    /// * `plane_of`: the corners of a triangle of the surface
    pub(crate) fn counts_for_nothing(&self, plane_of: impl Fn(u32) -> [Point3; 3]) -> bool {
        self.is_partial()
            && self.sides().any(|side| {
                let [a, b, c] = plane_of(side.triangle());
                self.corners().iter().all(|&p| sign(a, b, c, p, [0.0; 3]) != side.sign())
            })
    }

    /// Cuts an end by the plane of a triangle of the surface, into pieces that know on which side they are. The true corners of those of a triangle
    /// are its own, and where the plane crosses its sides; of a rectangle a piece is a rectangle around a part. None if it is not certain where
    /// that is.
    pub(crate) fn cut_by(&self, triangle: u32, plane: [Point3; 3]) -> Option<[Option<Self>; 3]> {
        if self.n != 3 {
            let part = |sign| self.part_on(PlaneSide::new(triangle, sign)?, plane);
            return Some([Some(part(1)?), Some(part(-1)?), None]);
        }
        let corners = self.corners;
        let heights = [0, 1, 2].map(|i| height(plane, corners[i], self.radius));
        let [a, b, c] = plane;
        let signs = [0, 1, 2].map(|i| sign(a, b, c, corners[i], self.radius));
        let is_certain = |i: usize| signs[i] != 0 || self.is_exact();
        if !(0..3).all(is_certain) || !signs.contains(&1) || !signs.contains(&-1) {
            return None;
        }
        let mut radius = self.radius;
        // The corners of the parts above and below, around.
        let mut rings = [([[0.0; 3]; 4], 0), ([[0.0; 3]; 4], 0)];
        let mut add = |sign: i8, p: Point3| {
            for (ring, side) in rings.iter_mut().zip([1, -1]) {
                if sign != -side && ring.1 < 4 {
                    ring.0[ring.1] = p;
                    ring.1 += 1;
                }
            }
        };
        for i in 0..3 {
            let j = (i + 1) % 3;
            add(signs[i], corners[i]);
            if signs[i] * signs[j] < 0 {
                add(0, self.crossing([corners[i], corners[j]], [heights[i], heights[j]], &mut radius)?);
            }
        }
        let mut pieces = [None; 3];
        let mut n = 0;
        for ((ring, n_ring), sign) in rings.into_iter().zip([1, -1]) {
            let sides = [Some(PlaneSide::new(triangle, sign)?), self.sides[0], self.sides[1]];
            for k in 2..n_ring {
                *pieces.get_mut(n)? = Some(Self { sides, ..Self::rounded([ring[0], ring[k - 1], ring[k]], radius) });
                n += 1;
            }
        }
        Some(pieces)
    }

    /// Of a rectangle one around its part on a side of a plane; none if that is not certain, or it is all on one side.
    fn part_on(&self, side: PlaneSide, plane: [Point3; 3]) -> Option<Self> {
        let (n, corners) = (usize::from(self.n), self.corners());
        let heights: [[f64; 2]; 4] = std::array::from_fn(|i| height(plane, corners[i], self.radius));
        let is_inside = |i: usize| f64::from(side.sign()) * heights[i][0] > 0.0;
        if !(0..n).any(is_inside) || (0..n).all(is_inside) || heights.iter().any(|[h, e]| h.abs() <= *e) {
            return None;
        }
        let mut part = Aabb::EMPTY;
        for (i, &p) in corners.iter().enumerate() {
            let j = (i + 1) % n;
            if is_inside(i) {
                part = part.with(p);
            }
            if is_inside(i) != is_inside(j) {
                let mut radius = [0.0; 3];
                let at = self.crossing([p, corners[j]], [heights[i], heights[j]], &mut radius)?;
                let [low, high] = [-1.0, 1.0].map(|d| std::array::from_fn(|k| at[k] + d * 2.0 * radius[k]));
                part = part.with(low).with(high);
            }
        }
        let axis = (0..3).find(|&k| self.bounds.min[k] == self.bounds.max[k])?;
        let clamp =
            |p: Point3| -> Point3 { std::array::from_fn(|k| p[k].clamp(self.bounds.min[k], self.bounds.max[k])) };
        let part = Self::rectangle(&Aabb { min: clamp(part.min), max: clamp(part.max) }, axis)?;
        Some(Self { sides: [Some(side), self.sides[0], self.sides[1]], ..part })
    }

    /// A point of the part that counts, as [`Self::inner`] has it; none if no double is certainly in it.
    ///
    /// * `plane_of`: the corners of a triangle of the surface
    pub(crate) fn inner_part(
        &self,
        weights: [f64; 4],
        plane_of: impl Fn(u32) -> [Point3; 3],
    ) -> Option<(Point3, Point3)> {
        if !self.is_partial() {
            return self.inner(weights);
        }
        let mut ring: Vec<Point3> = self.corners().to_vec();
        for side in self.sides() {
            let plane = plane_of(side.triangle());
            let heights: Vec<f64> =
                ring.iter().map(|&p| f64::from(side.sign()) * height(plane, p, [0.0; 3])[0]).collect();
            let mut rest = Vec::with_capacity(ring.len() + 1);
            for (i, &p) in ring.iter().enumerate() {
                let j = (i + 1) % ring.len();
                if heights[i] >= 0.0 {
                    rest.push(p);
                }
                if (heights[i] > 0.0) != (heights[j] > 0.0) {
                    let t = heights[i] / (heights[i] - heights[j]);
                    rest.push(std::array::from_fn(|k| p[k] + (ring[j][k] - p[k]) * t));
                }
            }
            ring = rest;
        }
        let sum: f64 = (0..ring.len()).map(|i| weights[i % 4]).sum();
        let at = |k: usize| ring.iter().enumerate().map(|(i, p)| p[k] * weights[i % 4]).sum::<f64>() / sum;
        let mut point = self.corners[0];
        for k in (0..3).filter(|&k| self.bounds.min[k] < self.bounds.max[k]) {
            point[k] = check_coordinate(at(k)).ok()?;
            if !(self.bounds.min[k] < point[k] && point[k] < self.bounds.max[k]) {
                return None;
            }
        }
        let is_inside = |side: PlaneSide| {
            let [a, b, c] = plane_of(side.triangle());
            sign(a, b, c, point, [0.0; 3]) == side.sign()
        };
        self.sides().all(is_inside).then_some((point, [0.0; 3]))
    }

    /// Where a plane crosses a side, from how high its ends are above it, and how far off that may be; the radius grows by how far the true
    /// point may be from it. None if doubles leave no room, or that is not certain enough.
    fn crossing(&self, [a, b]: [Point3; 2], heights: [[f64; 2]; 2], radius: &mut Point3) -> Option<Point3> {
        let [[low_a, high_a], [low_b, high_b]] = heights.map(|[h, e]| [(h.abs() - e).max(0.0), h.abs() + e]);
        let (low, high) = (low_a / (low_a + high_b), high_a / (high_a + low_b));
        if (high - low).is_nan() || high - low > UNCERTAIN {
            return None;
        }
        let t = (low + high) / 2.0;
        let mut p = [0.0; 3];
        for k in 0..3 {
            p[k] = check_coordinate(a[k] + (b[k] - a[k]) * t).ok()?;
            if a[k] != b[k] {
                let rounded = (high - low) * (b[k] - a[k]).abs() + 2.0 * ROUNDING * (a[k].abs() + b[k].abs());
                radius[k] = radius[k].max(self.radius[k] + 1.01 * rounded);
            }
        }
        (p != a && p != b).then_some(p)
    }

    /// Cuts a rectangle where coordinate `k` is `at`; none if that is not inside.
    pub(crate) fn cut_across(&self, k: usize, at: f64) -> Option<[Self; 2]> {
        let [low, high] = [self.corners[0][k], self.corners[2][k]];
        (self.n == 4 && low < at && at < high).then(|| self.cut_at(k, low, at))
    }

    /// Cuts a rectangle where coordinate `k` is `at`; the first half has the corners where it is `first`.
    fn cut_at(&self, k: usize, first: f64, at: f64) -> [Self; 2] {
        let mut halves = [*self, *self];
        for c in 0..4 {
            // The first half keeps its corners there, and has the others moved; so the other way round.
            let is_first = self.corners[c][k] == first;
            halves[usize::from(is_first)].corners[c][k] = at;
        }
        for half in &mut halves {
            half.bounds = Aabb::around(half.corners);
        }
        halves
    }
}

/// Whether doubles have `a + (b - a) t` without rounding.
fn is_exact(a: f64, b: f64, t: f64) -> bool {
    let d = b - a;
    let part = d * t;
    let sum = a + part;
    is_sum(b, -a, d) && d.mul_add(t, -part) == 0.0 && is_sum(a, part, sum)
}

/// Whether `x + y` is exactly `sum`, which is their rounded sum (Knuth's two-sum).
fn is_sum(x: f64, y: f64, sum: f64) -> bool {
    let back = sum - x;
    (x - (sum - back)) + (y - back) == 0.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::truth::{Exact, cut_triangle, cuts, det, exact, mix};
    use num_rational::BigRational;
    use num_traits::Signed;
    use proptest::prelude::*;

    #[test]
    fn halves_of_rectangles_cover_them() {
        let b = Aabb { min: [1.0, -2.0, 5.0], max: [4.0, 2.0, 5.0] };
        let end = End::rectangle(&b, 2).expect("it has an area");
        assert_eq!(*end.bounds(), b);
        for side in 0..2 {
            let [p, q] = end.cut(side, 0.25).expect("there is room");
            let (p, q) = (*p.bounds(), *q.bounds());
            let k = if p.max[0] == q.min[0] { 0 } else { 1 };
            assert_eq!((p.max[k], p.with(q.max), p.with(q.min)), (q.min[k], b, p), "{side}");
            assert!(((p.max[k] - b.min[k]) / (b.max[k] - b.min[k]) - 0.25).abs() < 1e-15);
        }
        assert!(End::rectangle(&b, 1).is_none());
        assert!(end.inner([1.0; 4]).is_some());
        for (i, c) in end.corners().iter().enumerate() {
            let (near, _) = end.inner(end.weights_near(i, 1e-3)).expect("it has an area");
            assert!((0..3).all(|k| (near[k] - c[k]).abs() < 0.005), "{i}: {near:?} {c:?}");
        }
        let thin = Aabb { max: [1.0f64.next_up(), 2.0, 5.0], ..b };
        assert_eq!(End::rectangle(&thin, 2).expect("it has an area").inner([1.0; 4]), None);
    }

    #[test]
    fn pieces_of_triangles_know_how_far_they_were_rounded() {
        let small = End::triangle([[0.0, 0.0, 1.0], [8.0, 0.0, 1.0], [0.0, 3.0, 1.0]]);
        let [p, q] = small.cut(0, 0.5).expect("there is room");
        assert!(p.is_exact() && q.is_exact());
        assert_eq!(p.corners(), [[0.0, 0.0, 1.0], [4.0, 0.0, 1.0], [0.0, 3.0, 1.0]]);
        assert_eq!(q.corners(), [[4.0, 0.0, 1.0], [8.0, 0.0, 1.0], [0.0, 3.0, 1.0]]);
        let thirds = End::triangle([[0.1, 0.3, 1.0], [0.7, 0.9, 1.0], [1.0 / 3.0, 1e-9, 1.0]]);
        let [p, _] = thirds.cut(1, 0.4).expect("there is room");
        assert!(!p.is_exact() && p.radius()[2] == 0.0 && p.radius()[0] < 1e-14, "{p:?}");
        let (inner, radius) = p.inner([1.0, 2.0, 3.0, 0.0]).expect("triangles have inner points");
        assert!(inner[2] == 1.0 && radius[2] == 0.0 && radius[0] > 0.0);
        let (near, _) = p.inner(p.weights_near(2, 1e-3)).expect("triangles have inner points");
        assert!((0..3).all(|k| (near[k] - p.corners()[2][k]).abs() < 0.005), "{near:?}");
        let point = End::triangle([[1.0, 1.0, 1.0], [1.0f64.next_up(), 1.0, 1.0], [1.0, 2.0, 1.0]]);
        assert!(point.cut(0, 0.5).is_none());
    }

    fn corner() -> impl Strategy<Value = Point3> {
        [-4i32..5, -4i32..5, -4i32..5].prop_map(|p| p.map(|x| f64::from(x) * 0.3))
    }

    proptest! {
        /// Invariant: pieces beyond a plane have corners of the triangle or crossings of its sides, in fractions, as true corners within
        /// their radius and bounds, and all of these.
        #[test]
        fn pieces_beyond_a_plane_are_near_true_ones(
            triangle in [corner(), corner(), corner()], k in 0usize..3, at in corner(), upward in any::<bool>(),
            shift in prop_oneof![Just(0.0), Just(1e6)],
        ) {
            let moved = |p: Point3| p.map(|x| x + shift);
            let (triangle, at) = (triangle.map(moved), moved(at)[k]);
            let exact = |x: f64| BigRational::from_float(x).expect("finite");
            let inside = |p: &Point3| if upward { p[k] > at } else { p[k] < at };
            let mut truth: Vec<[BigRational; 3]> =
                triangle.iter().filter(|p| inside(p) || p[k] == at).map(|p| p.map(exact)).collect();
            for i in 0..3 {
                let [a, b] = [triangle[i], triangle[(i + 1) % 3]];
                if inside(&a) != inside(&b) && a[k] != at && b[k] != at {
                    let t = (exact(at) - exact(a[k])) / (exact(b[k]) - exact(a[k]));
                    truth.push([0, 1, 2].map(|j| exact(a[j]) + (exact(b[j]) - exact(a[j])) * &t));
                }
            }
            let pieces: Vec<End> = End::beyond(triangle, k, at, upward).collect();
            let is_near = |piece: &End, c: &Point3, p: &[BigRational; 3]| {
                (0..3).all(|j| (exact(c[j]) - &p[j]).abs() <= exact(piece.radius()[j]))
                    && (0..3).all(|j| exact(piece.bounds().min[j]) <= p[j] && p[j] <= exact(piece.bounds().max[j]))
            };
            prop_assert_eq!(pieces.is_empty(), !triangle.iter().any(inside));
            for piece in &pieces {
                prop_assert!(piece.corners().iter().all(|c| truth.iter().any(|p| is_near(piece, c, p))), "{:?}", piece);
            }
            let has = |p: &[BigRational; 3]| pieces.iter().any(|e| e.corners().iter().any(|c| is_near(e, c, p)));
            prop_assert!(pieces.is_empty() || truth.iter().all(has), "{:?} {:?}", pieces, truth);
        }

        /// Invariant: what a plane cuts a triangle into, which may have been cut before, covers it, and each piece is on the side that it knows. True
        /// corners are those of the triangle and where the plane crosses its sides, in fractions; the stored ones are within the radius.
        #[test]
        fn pieces_know_on_which_side_of_a_plane_they_are(
            triangle in [corner(), corner(), corner()], cuts in cuts(3), plane in [corner(), corner(), corner()],
            shift in prop_oneof![Just(0.0), Just(1e6)],
        ) {
            let [triangle, plane] = [triangle, plane].map(|t| t.map(|p| p.map(|x| x + shift)));
            let (end, truth) = cut_triangle(triangle, cuts);
            let Some(pieces) = end.cut_by(7, plane) else { return Ok(()) };
            let [a, b, c] = plane.map(exact);
            let height = |p: &Exact| det(&a, &b, &c, p);
            let mut points = truth.to_vec();
            for i in 0..3 {
                let (p, q) = (&truth[i], &truth[(i + 1) % 3]);
                let (x, y) = (height(p), height(q));
                if x.is_positive() && y.is_negative() || x.is_negative() && y.is_positive() {
                    let t = &x / (&x - &y);
                    points.push([0, 1, 2].map(|k| &p[k] + (&q[k] - &p[k]) * &t));
                }
            }
            let area = |[p, q, r]: [&Exact; 3]| -> [BigRational; 3] {
                let [u, v] = [q, r].map(|x| [0, 1, 2].map(|k| &x[k] - &p[k]));
                [0, 1, 2].map(|k| &u[(k + 1) % 3] * &v[(k + 2) % 3] - &u[(k + 2) % 3] * &v[(k + 1) % 3])
            };
            let mut covered = [0, 1, 2].map(|_| BigRational::from_integer(0.into()));
            let mut signs = Vec::new();
            for piece in pieces.into_iter().flatten() {
                let side = piece.sides().next().expect("it knows the plane");
                prop_assert_eq!(side.triangle(), 7);
                let is_near = |c: &Point3, p: &Exact| (0..3).all(|k| {
                    let [low, high] = [piece.bounds().min[k], piece.bounds().max[k]].map(|x| BigRational::from_float(x).expect("finite"));
                    (exact(*c)[k].clone() - &p[k]).abs() <= exact(piece.radius())[k] && low <= p[k] && p[k] <= high
                });
                let is_on_side = |p: &Exact| if side.sign() > 0 { !height(p).is_negative() } else { !height(p).is_positive() };
                let of = |c: &Point3| points.iter().find(|p| is_on_side(p) && is_near(c, p));
                let corners: Vec<Option<&Exact>> = piece.corners().iter().map(of).collect();
                let [Some(p), Some(q), Some(r)] = corners[..] else {
                    return Err(TestCaseError::fail(format!("{piece:?} of {end:?}")));
                };
                covered.iter_mut().zip(area([p, q, r])).for_each(|(sum, x)| *sum += x);
                signs.push(side.sign());
            }
            prop_assert!(signs.contains(&1) && signs.contains(&-1));
            // Of two points that are within rounding of each other the wrong one may have been taken.
            let slack = BigRational::new(1.into(), 1_000_000.into());
            let whole = area([&truth[0], &truth[1], &truth[2]]);
            prop_assert!(covered.iter().zip(&whole).all(|(x, y)| (x - y).abs() < slack), "{:?} of {:?}", covered, whole);
        }

        /// Invariant: the parts into which planes cut a rectangle are around what counts, and an inner point of a part is on the sides that it knows.
        #[test]
        fn parts_of_rectangles_hold_what_counts(
            low in corner(), size in [1i32..9, 1i32..9], planes in prop::collection::vec([corner(), corner(), corner()], 1..5),
            weights in prop::collection::vec([1u64..20, 1u64..20, 1u64..20, 1u64..20], 20), shift in prop_oneof![Just(0.0), Just(1e6)],
        ) {
            let moved = |p: Point3| p.map(|x| x + shift);
            let (low, planes) = (moved(low), planes.into_iter().map(|t| t.map(moved)).collect::<Vec<_>>());
            let high = [low[0] + f64::from(size[0]) * 0.7, low[1] + f64::from(size[1]) * 0.7, low[2]];
            let whole = End::rectangle(&Aabb { min: low, max: high }, 2).expect("it has an area");
            let plane_of = |t: u32| planes[t as usize];
            let mut parts = vec![whole];
            for t in 0..planes.len() as u32 {
                let cut = |end: End| end.cut_by(t, plane_of(t)).unwrap_or([Some(end), None, None]).into_iter().flatten();
                parts = parts.into_iter().flat_map(cut).collect();
            }
            let corners: Vec<Exact> = whole.corners().iter().map(|&p| exact(p)).collect();
            let signum = |t: u32, p: &Exact| {
                let [a, b, c] = plane_of(t).map(exact);
                let height = det(&a, &b, &c, p);
                i8::from(height.is_positive()) - i8::from(height.is_negative())
            };
            let counts = |part: &End, p: &Exact| part.sides().all(|side| signum(side.triangle(), p) == side.sign());
            for w in &weights {
                let p = mix(&corners, w);
                if (0..planes.len() as u32).any(|t| signum(t, &p) == 0) {
                    continue;
                }
                let has = |part: &&End| {
                    let b = part.bounds();
                    counts(part, &p) && (0..3).all(|k| exact(b.min)[k] <= p[k] && p[k] <= exact(b.max)[k])
                };
                let holding: Vec<&End> = parts.iter().filter(has).collect();
                prop_assert!(!holding.is_empty() && holding.iter().all(|part| !part.counts_for_nothing(plane_of)));
            }
            for part in &parts {
                if let Some((inner, _)) = part.inner_part([1.0, 1.1, 0.9, 1.2], plane_of) {
                    prop_assert!(!part.is_partial() || counts(part, &exact(inner)));
                    prop_assert!((0..2).all(|k| part.bounds().min[k] < inner[k] && inner[k] < part.bounds().max[k]));
                }
            }
        }
    }

    #[test]
    fn planes_cut_triangles_and_rectangles() {
        let plane = [[0.3, 0.0, 0.0], [0.5, 1.0, 0.0], [0.4, 0.0, 7.0]];
        let triangle = End::triangle([[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0]]);
        let pieces = triangle.cut_by(3, plane).expect("it is crossed");
        assert_eq!(pieces.iter().flatten().count(), 3);
        assert!(triangle.cut_by(3, plane.map(|p| [p[0] + 2.0, p[1], p[2]])).is_none(), "a plane beside it");
        assert!(triangle.cut_by(3, [[0.0, 0.0, 1.0], [3.0, 0.0, 1.0], [0.0, 5.0, 1.0]]).is_none(), "its own plane");
        let square = End::rectangle(&Aabb { min: [0.0, 0.0, 1.0], max: [1.0, 1.0, 1.0] }, 2).expect("it has an area");
        let [Some(one), Some(other), None] = square.cut_by(3, plane).expect("it is crossed") else {
            panic!("two parts")
        };
        assert!(one.is_partial() && other.is_partial() && !square.is_partial() && !one.whole().is_partial());
        assert!(!one.counts_for_nothing(|_| plane) && one.inner_part([1.0; 4], |_| plane).is_some());
        // Beyond where the other part ends, nothing of it counts.
        let most = one.bounds().max[0].min(other.bounds().max[0]);
        let rest = [one, other].map(|part| part.cut_across(0, most + 0.1).map(|halves| halves[1]));
        let [Some(rest), None] = rest else { panic!("{rest:?}") };
        assert!(!rest.counts_for_nothing(|_| plane));
        let turned = PlaneSide::new(3, -rest.sides[0].expect("it knows one").sign());
        assert!(End { sides: [turned, None, None], ..rest }.counts_for_nothing(|_| plane));
    }
}
