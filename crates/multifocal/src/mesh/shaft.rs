//! The convex hull of two boxes, as half-spaces, and tests of what is certainly outside.
//!
//! Source: Haines and Wallace, "Shaft Culling for Efficient Ray-Traced Radiosity", 1991. The hull of two boxes is
//! exactly the intersection of these half-spaces: a plane that is slanted to all three axes touches each box in one
//! corner only, so every face of the hull is perpendicular to an axis or parallel to one.

use sightlines_geometry::{Aabb, Point2, Point3, orient2d};

/// What one half-space leaves outside: a line parallel to an axis's complement, seen along that axis.
#[derive(Debug, Clone, Copy)]
struct Tilt {
    /// The two axes that it is not parallel to.
    axes: [usize; 2],
    /// The inner side is to the left of the line from `p` to `q`.
    p: Point2,
    q: Point2,
}

/// The convex hull `K` of two boxes.
#[derive(Debug, Clone)]
pub(super) struct Shaft {
    bounds: Aabb<3>,
    tilts: Vec<Tilt>,
}

fn flat(axes: [usize; 2], p: Point3) -> Point2 {
    Point2::new(p[axes[0]], p[axes[1]])
}

impl Shaft {
    /// Of non-empty boxes.
    pub(super) fn new(v: &Aabb<3>, e: &Aabb<3>) -> Self {
        let bounds = v.with(e.min).with(e.max);
        let mut tilts = Vec::with_capacity(6);
        for axes in [[0, 1], [1, 2], [2, 0]] {
            for side in 0..4 {
                let corner = |b: &Aabb<3>| {
                    let [x, y] = [0, 1].map(|k| if side >> k & 1 == 1 { b.max[axes[k]] } else { b.min[axes[k]] });
                    Point2::new(x, y)
                };
                tilts.extend(Tilt::new(axes, [side & 1 == 1, side >> 1 & 1 == 1], corner(v), corner(e), [v, e]));
            }
        }
        Self { bounds, tilts }
    }

    /// One bit for each half-space that `a` is outside of or on the border of. The segment between two points with a
    /// bit in common does not meet the relative interior of `K`.
    ///
    /// Half-spaces whose border contains all of `K` would not imply that: for those only the outside counts.
    pub(super) fn code(&self, a: Point3) -> u32 {
        let mut code = 0;
        for (k, x) in a.into_iter().enumerate() {
            let (low, high) = (self.bounds.min[k], self.bounds.max[k]);
            let is_flat = low == high;
            code |= u32::from(x < low || (x == low && !is_flat)) << (2 * k);
            code |= u32::from(x > high || (x == high && !is_flat)) << (2 * k + 1);
        }
        for (i, tilt) in self.tilts.iter().enumerate() {
            code |= u32::from(orient2d(tilt.p, tilt.q, flat(tilt.axes, a)) <= 0.0) << (6 + i);
        }
        code
    }

    /// Whether the segment from `a` to `b` certainly does not meet `K`: a superset of its part inside all half-spaces
    /// is empty.
    ///
    /// With `g` the affine function that is positive inside of a half-space, `g(a) <= ga` and `g(b) <= gb`, and `ga`
    /// positive, `gb` negative, what is inside lies within the first `ga / (ga - gb)` of the segment.
    pub(super) fn certainly_misses(&self, a: Point3, b: Point3) -> bool {
        // From `a` up to `last`, and from `b` up to `first`, as parts of the segment.
        let (mut last, mut first) = (1.0f64, 1.0f64);
        let mut cut = |ga: f64, gb: f64| {
            // Three roundings of 2^-53 are less than 2^-50.
            const UP: f64 = 1.0 + 4.0 * f64::EPSILON;
            match (ga < 0.0, gb < 0.0) {
                (true, true) => last = -1.0,
                (false, true) => last = last.min(ga / (ga - gb) * UP),
                (true, false) => first = first.min(gb / (gb - ga) * UP),
                (false, false) => {}
            }
            last + first < 1.0 - 4.0 * f64::EPSILON
        };
        for k in 0..3 {
            // A difference has the right sign and is within 2^-53 of its value.
            let up = |d: f64| if d > 0.0 { d * (1.0 + f64::EPSILON) } else { d * (1.0 - f64::EPSILON) };
            let (low, high) = (self.bounds.min[k], self.bounds.max[k]);
            if cut(up(a[k] - low), up(b[k] - low)) || cut(up(high - a[k]), up(high - b[k])) {
                return true;
            }
        }
        self.tilts.iter().any(|t| cut(t.at_most(a), t.at_most(b)))
    }
}

impl Tilt {
    /// The half-space through corners `v` and `e` of the two boxes that are lowest or highest (`upper`) along both
    /// axes; `None` if that is not a face of the hull, or if the whole hull lies on it.
    fn new(axes: [usize; 2], upper: [bool; 2], v: Point2, e: Point2, boxes: [&Aabb<3>; 2]) -> Option<Self> {
        // Left of (p, q) is the direction (-dy, dx); it has to point inwards along both axes.
        let inwards = |p: Point2, q: Point2| {
            let x = if upper[0] { q.y > p.y } else { q.y < p.y };
            let y = if upper[1] { q.x < p.x } else { q.x > p.x };
            x && y
        };
        let [p, q] = if inwards(v, e) {
            [v, e]
        } else if inwards(e, v) {
            [e, v]
        } else {
            return None;
        };
        let tilt = Self { axes, p, q };
        let inner = |b: &&Aabb<3>| {
            let pick = |k: usize| if upper[k] { b.min[axes[k]] } else { b.max[axes[k]] };
            orient2d(p, q, Point2::new(pick(0), pick(1))) > 0.0
        };
        boxes.iter().any(inner).then_some(tilt)
    }

    /// An upper bound of the affine function that is positive inside.
    fn at_most(&self, a: Point3) -> f64 {
        let [p, q, x] = [self.p, self.q, flat(self.axes, a)];
        let (l, r) = ((q.x - p.x) * (x.y - p.y), (q.y - p.y) * (x.x - p.x));
        // Three roundings for each product, one for the sum: below 5 * 2^-53 of both together.
        l - r + 4.0 * f64::EPSILON * (l.abs() + r.abs())
    }
}

/// Whether a triangle certainly avoids a box. Exact, by all axes that can separate the two.
///
/// * `touching`: whether it may touch the border of the box, so long as it does not meet its relative
///   interior
pub fn avoids(t: &[Point3; 3], b: &Aabb<3>, touching: bool) -> bool {
    let around = Aabb::around(*t);
    let apart = |k: usize| {
        let weakly = touching && b.min[k] < b.max[k];
        around.min[k] > b.max[k]
            || around.max[k] < b.min[k]
            || weakly && (around.min[k] == b.max[k] || around.max[k] == b.min[k])
    };
    if (0..3).any(apart) {
        return true;
    }
    let corners = b.corners();
    let [p, q, r] = *t;
    let mut away = Sides::default();
    corners.iter().for_each(|&c| away.count(sightlines_geometry::orient3d(p, q, r, c)));
    if away.clear(touching, true) || away.clear(touching, false) {
        return true;
    }
    (0..3).any(|k| {
        let axes = [(k + 1) % 3, (k + 2) % 3];
        let [p, q, r] = t.map(|c| flat(axes, c));
        [[p, q, r], [q, r, p], [r, p, q]].iter().any(|&[p, q, r]| {
            let inner = orient2d(p, q, r);
            let mut away = Sides::default();
            for c in [0, 1, 2, 3] {
                let [x, y] = [0, 1].map(|i| if c >> i & 1 == 0 { b.min[axes[i]] } else { b.max[axes[i]] });
                away.count(orient2d(p, q, Point2::new(x, y)));
            }
            (inner >= 0.0 && away.clear(touching, false)) || (inner <= 0.0 && away.clear(touching, true))
        })
    })
}

/// Number of corners of a box on each side of a line or plane.
#[derive(Default)]
struct Sides {
    n_positive: u32,
    n_negative: u32,
    n_on: u32,
}

impl Sides {
    fn count(&mut self, side: f64) {
        if side > 0.0 {
            self.n_positive += 1;
        } else if side < 0.0 {
            self.n_negative += 1;
        } else {
            self.n_on += 1;
        }
    }

    /// Whether the box is on one side; with `touching` some corners, but not all, may lie on the border, which the
    /// relative interior of the box then does not meet.
    fn clear(&self, touching: bool, positive: bool) -> bool {
        let [with, against] =
            if positive { [self.n_positive, self.n_negative] } else { [self.n_negative, self.n_positive] };
        against == 0 && with > 0 && (touching || self.n_on == 0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_rational::BigRational;
    use num_traits::{One, Signed, Zero};
    use proptest::prelude::*;

    type Q3 = [BigRational; 3];

    fn exact(p: Point3) -> Q3 {
        p.map(|x| BigRational::from_float(x).unwrap())
    }

    fn boxes() -> impl Strategy<Value = Aabb<3>> {
        ([-3i32..4, -3i32..4, -3i32..4], [0i32..4, 0i32..4, 0i32..4]).prop_map(|(a, size)| Aabb {
            min: a.map(f64::from),
            max: std::array::from_fn(|k| f64::from(a[k] + size[k])),
        })
    }

    fn point() -> impl Strategy<Value = Point3> {
        [-5i32..6, -5i32..6, -5i32..6].prop_map(|p| p.map(|x| f64::from(x) * 0.7))
    }

    /// A point strictly inside a box wherever that has an extent.
    fn inner(b: &Aabb<3>, at: [u32; 3]) -> Q3 {
        let (low, high) = (exact(b.min), exact(b.max));
        let part = |k: usize| BigRational::new((at[k] % 15 + 1).into(), 16.into());
        std::array::from_fn(|k| &low[k] + (&high[k] - &low[k]) * part(k))
    }

    /// Whether all points lie in a plane. Exact.
    fn is_flat(points: &[Point3]) -> bool {
        let n = points.len();
        (0..n).all(|i| {
            (0..i).all(|j| {
                (0..j).all(|k| {
                    (0..k).all(|l| sightlines_geometry::orient3d(points[i], points[j], points[k], points[l]) == 0.0)
                })
            })
        })
    }

    /// Whether the point at `s` of the segment `a`-`b` lies on the segment `v`-`e`, both closed, for some `s`.
    fn meets(a: &Q3, b: &Q3, v: &Q3, e: &Q3) -> bool {
        // a + s (b - a) = v + t (e - v): two of the equations give s and t, the third has to agree.
        let d = |p: &Q3, q: &Q3| -> Q3 { std::array::from_fn(|k| &q[k] - &p[k]) };
        let (ab, ve, av) = (d(a, b), d(v, e), d(a, v));
        for [i, j] in [[0, 1], [1, 2], [2, 0]] {
            let det = &ab[j] * &ve[i] - &ab[i] * &ve[j];
            if det.is_zero() {
                continue;
            }
            let s = (&av[j] * &ve[i] - &av[i] * &ve[j]) / &det;
            let t = (&ab[i] * &av[j] - &ab[j] * &av[i]) / &det;
            let unit = |x: &BigRational| !x.is_negative() && *x <= BigRational::one();
            let agree = (0..3).all(|k| &a[k] + &s * &ab[k] == &v[k] + &t * &ve[k]);
            return unit(&s) && unit(&t) && agree;
        }
        false
    }

    proptest! {
        /// Invariant: a segment through a point of the hull between two inner points is never reported to miss it, and
        /// a triangle that contains a point of a box is never reported to avoid the box.
        #[test]
        fn shaft_nothing_inside_is_said_to_miss(
            v in boxes(), e in boxes(), at in [any::<[u32; 3]>(), any::<[u32; 3]>()], a in point(), cut in 1u32..16,
        ) {
            let (p, q) = (inner(&v, at[0].map(|x| x % 97)), inner(&e, at[1].map(|x| x % 89)));
            let t = BigRational::new(cut.into(), 16.into());
            let m: Q3 = std::array::from_fn(|k| &p[k] + (&q[k] - &p[k]) * &t);
            // From `a` through `m` and as far again, in doubles if they hold it.
            let float = |x: &BigRational| num_traits::ToPrimitive::to_f64(x).unwrap();
            let a_exact = exact(a);
            let b: Point3 = std::array::from_fn(|k| float(&(&m[k] + &m[k] - &a_exact[k])));
            prop_assume!(meets(&a_exact, &exact(b), &p, &q) );
            let shaft = Shaft::new(&v, &e);
            prop_assert!(shaft.code(a) & shaft.code(b) == 0, "{:?} {:?}", a, b);
            prop_assert!(!shaft.certainly_misses(a, b), "{:?} {:?}", a, b);
        }

        /// Invariant: points on a grid are outside if and only if a half-space or box proves it: by separation from the
        /// hull of the sixteen corners along the directions of all pairs of edges. A hull that lies in a plane has no
        /// half-spaces, and fewer points are reported to miss it.
        #[test]
        fn shaft_misses_what_is_clearly_outside(v in boxes(), e in boxes(), a in point(), b in point()) {
            let shaft = Shaft::new(&v, &e);
            let corners: Vec<Point3> = [v, e].iter().flat_map(Aabb::corners).collect();
            let f = |n: Point3, p: Point3| n[0] * p[0] + n[1] * p[1] + n[2] * p[2];
            // A separating direction with room to spare, out of those that separate segments from such hulls.
            let mut directions: Vec<Point3> = Vec::new();
            for x in -3i32..4 { for y in -3i32..4 { for z in -3i32..4 { directions.push([x, y, z].map(f64::from)); } } }
            let far = directions.iter().any(|&n| {
                let hull = corners.iter().map(|&c| f(n, c)).fold(f64::NEG_INFINITY, f64::max);
                f(n, a).min(f(n, b)) > hull + 1e-6
            });
            if far && !is_flat(&corners) {
                prop_assert!(shaft.code(a) & shaft.code(b) != 0 || shaft.certainly_misses(a, b));
            }
        }

        /// Invariant: exact separation agrees with cutting the triangle by the box in rational arithmetic.
        #[test]
        fn triangles_avoid_boxes_exactly(b in boxes(), t in [point(), point(), point()]) {
            prop_assume!(!super::super::vector::collinear(t[0], t[1], t[2]));
            let mut polygon: Vec<Q3> = t.iter().map(|&p| exact(p)).collect();
            for k in 0..3 {
                for (at, sign) in [(b.min[k], 1), (b.max[k], -1)] {
                    let at = BigRational::from_float(at).unwrap();
                    let g = |p: &Q3| (&p[k] - &at) * BigRational::from_integer(sign.into());
                    let mut cut: Vec<Q3> = Vec::new();
                    for i in 0..polygon.len() {
                        let (p, q) = (&polygon[i], &polygon[(i + 1) % polygon.len()]);
                        let (gp, gq) = (g(p), g(q));
                        if !gp.is_negative() {
                            cut.push(p.clone());
                        }
                        if (gp.is_positive() && gq.is_negative()) || (gp.is_negative() && gq.is_positive()) {
                            let s = &gp / (&gp - &gq);
                            cut.push(std::array::from_fn(|k| &p[k] + (&q[k] - &p[k]) * &s));
                        }
                    }
                    polygon = cut;
                }
            }
            prop_assert_eq!(avoids(&t, &b, false), polygon.is_empty());
            // The mean of the corners of what is left is in its relative interior, so it is in that of the box if any point is.
            let n = BigRational::from_integer(polygon.len().max(1).into());
            let mean: Q3 = std::array::from_fn(|k| polygon.iter().map(|p| p[k].clone()).sum::<BigRational>() / &n);
            let (low, high) = (exact(b.min), exact(b.max));
            let inside = !polygon.is_empty() && (0..3).all(|k| low[k] == high[k] || (low[k] < mean[k] && mean[k] < high[k]));
            prop_assert_eq!(avoids(&t, &b, true), !inside);
        }
    }
}
