//! One end of a set of lines: a rectangle across an axis, or a triangle.

use sightlines_geometry::{Aabb, Point3, check_coordinate};

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
}

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
        Some(Self { corners, n: 4, radius: [0.0; 3], bounds: *b })
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
        Self { corners: [a, b, c, c], n: 3, radius, bounds }
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
        Some([first, second].map(|corners| Self::rounded(corners, radius)))
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
    }
}
