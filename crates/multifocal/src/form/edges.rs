//! Which affine functions bound an umbra, and the rectangle of texels around it.

use super::affine::{Around, Edge, Window};
use crate::Occluder;
use sightlines_geometry::{Point2, Point3, orient2d, orient3d};

/// A plane that bounds an umbra, as a function that is not negative for what is hidden: `normal · (p - point)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Side {
    point: Point3,
    normal: Point3,
    /// Bound of the error of each coordinate of the normal.
    error: Point3,
}

impl Side {
    /// The plane through three points, not negative where `sign * orient3d(a, b, c, p)` is not.
    ///
    /// With u = 2^-53: differences have a relative error of u, their products of 3 u, and the difference of two products
    /// `x` and `y` is wrong by at most 4 u (|x| + |y|), up to terms in u². Taken twice.
    fn through([a, b, c]: [Point3; 3], sign: f64) -> Self {
        let difference = |p: Point3| [p[0] - a[0], p[1] - a[1], p[2] - a[2]];
        let (b, c) = (difference(b), difference(c));
        let (mut normal, mut error) = ([0.0; 3], [0.0; 3]);
        for k in 0..3 {
            let (i, j) = ((k + 1) % 3, (k + 2) % 3);
            let (x, y) = (b[i] * c[j], b[j] * c[i]);
            normal[k] = sign * (x - y);
            error[k] = (x.abs() + y.abs()) * (4.0 * f64::EPSILON);
        }
        Self { point: a, normal, error }
    }

    /// The function at `p`. Differences and products are wrong by 3 u of their size, and two sums by 2 u more; taken
    /// twice as well.
    pub(crate) fn at(&self, p: Point3) -> Around {
        let (mut about, mut error) = (0.0, 0.0);
        for (k, x) in p.into_iter().enumerate() {
            let difference = x - self.point[k];
            about += self.normal[k] * difference;
            error += difference.abs() * (self.error[k] + self.normal[k].abs() * (5.0 * f64::EPSILON));
        }
        Around { about, error: error * (1.0 + 8.0 * f64::EPSILON) }
    }

    /// The function at `p`, rounded as by [`Self::at`].
    fn about(&self, p: Point3) -> f64 {
        (0..3).fold(0.0, |about, k| about + self.normal[k] * (p[k] - self.point[k]))
    }

    fn at_corners(&self, window: &Window<'_>, bounds: [i32; 4]) -> [Around; 4] {
        Window::places(bounds).map(|place| self.at(window.point(place)))
    }
}

/// Appends the planes that bound the umbra of `occluder` for eyes in the box with `corners`: for each facet its own
/// plane, and for each edge of the outline the one through the corner of the box from which it hides least there.
/// `false` if it hides nothing. The choice of planes is exact.
///
/// Around an edge, the planes through the corners of the box all contain it. Let its facet's plane have the box in
/// front, and measure angles around the edge from the direction into the facet: eyes have angles from 0 to π, and what
/// lies behind the facet from -π to 0. A line from an eye at α to a point at β passes inside if α - β is at most π. So
/// the eye with the largest angle decides for all points behind the facet, and it is the one that has no other
/// corner outside of its plane: a comparison by exact predicates.
pub(crate) fn sides(occluder: &Occluder, corners: &[Point3; 8], out: &mut Vec<Side>) -> bool {
    // Seen from the front the outline runs counter-clockwise, and what passes inside is below the planes.
    let sign = match occluder.side_of(corners) {
        Some(true) => -1.0,
        Some(false) => 1.0,
        None => return false,
    };
    out.extend(occluder.facets().iter().map(|&points| Side::through(points, sign)));
    let outline = occluder.outline();
    for (i, &p) in outline.iter().enumerate() {
        let q = outline[(i + 1) % outline.len()];
        out.push(Side::through([farthest(corners, p, q, sign), p, q], sign));
    }
    true
}

/// The corner of the box that has no other one outside of its plane through `p` and `q`; the first of several. Exact.
fn farthest(corners: &[Point3; 8], p: Point3, q: Point3, sign: f64) -> Point3 {
    let first = corners[0];
    let Some(k) = (0..3).find(|&k| p[k] != q[k] && (1..3).all(|i| p[(k + i) % 3] == q[(k + i) % 3])) else {
        let outside = |v: Point3, other: Point3| sign * orient3d(v, p, q, other) < 0.0;
        return corners[1..].iter().fold(first, |v, &other| if outside(v, other) { other } else { v });
    };
    // Corners that differ along the edge have one plane, and the question is one of the plane across it.
    let flat = |p: Point3| Point2::new(p[(k + 1) % 3], p[(k + 2) % 3]);
    let (p, sign) = (flat(p), if q[k] > p[k] { -sign } else { sign });
    let outside = |v: Point3, other: Point3| sign * orient2d(flat(v), p, flat(other)) < 0.0;
    let lower = (1..8).filter(|corner| corner >> k & 1 == 0).map(|corner| corners[corner]);
    lower.fold(first, |v, other| if outside(v, other) { other } else { v })
}

/// The texels around the umbra, widened to whole ones; `None` if it is empty. Rounding may lose texels, never add any:
/// what is within the bounds still has to pass all edges.
pub(crate) fn bounds(sides: &[Side], window: &Window<'_>) -> Option<[i32; 4]> {
    let all = window.all();
    let (w, h) = (f64::from(all[2]), f64::from(all[3]));
    let mut polygon = vec![[0.0, 0.0], [w, 0.0], [w, h], [0.0, h]];
    let mut clipped = Vec::new();
    let corners = Window::places(all).map(|place| window.point(place));
    for side in sides {
        let at = corners.map(|p| side.about(p));
        if at.iter().all(|&f| f < 0.0) {
            return None;
        }
        let (dx, dy) = ((at[1] - at[0]) / w, (at[2] - at[0]) / h);
        clip(&polygon, |[x, y]| at[0] + dx * x + dy * y, &mut clipped);
        std::mem::swap(&mut polygon, &mut clipped);
        if polygon.len() < 3 {
            return None;
        }
    }
    let extent =
        |k: usize| polygon.iter().fold((f64::INFINITY, 0.0), |(l, h): (f64, f64), p| (l.min(p[k]), h.max(p[k])));
    let ((x0, x1), (y0, y1)) = (extent(0), extent(1));
    let whole = |low: f64, high: f64, n: i32| ((low.floor() as i32).clamp(0, n), (high.ceil() as i32).clamp(0, n));
    let ((x0, x1), (y0, y1)) = (whole(x0, x1, all[2]), whole(y0, y1, all[3]));
    (x0 < x1 && y0 < y1).then_some([x0, y0, x1, y1])
}

/// The part of a convex polygon where `f` is not negative, in plain doubles.
fn clip(polygon: &[[f64; 2]], f: impl Fn([f64; 2]) -> f64, out: &mut Vec<[f64; 2]>) {
    out.clear();
    for (i, &a) in polygon.iter().enumerate() {
        let b = polygon[(i + 1) % polygon.len()];
        let (fa, fb) = (f(a), f(b));
        if fa >= 0.0 {
            out.push(a);
        }
        if (fa >= 0.0) != (fb >= 0.0) {
            let t = fa / (fa - fb);
            out.push([a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t]);
        }
    }
}

/// Appends the integer forms of all sides. `false` if nothing passes them.
pub(crate) fn push_edges(sides: &[Side], window: &Window<'_>, bounds: [i32; 4], out: &mut Vec<[i32; 3]>) -> bool {
    for side in sides {
        match window.edge(bounds, side.at_corners(window, bounds)) {
            Edge::Superfluous => {}
            Edge::Nowhere => return false,
            Edge::Integers(edge) => out.push(edge),
        }
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;
    use sightlines_geometry::{Aabb, Random};

    /// Edges along an axis are looked at in the plane across it, with the same corner as in space. A box that the line of the edge meets
    /// is not on one side of a facet there, and is left out.
    #[test]
    fn the_farthest_corner_is_that_of_exact_predicates() {
        let (mut random, mut counts) = (Random::new(5), [0; 2]);
        let mut whole = || random.below(7) as f64 - 3.0;
        for _ in 0..20_000 {
            let min = [0; 3].map(|_| whole());
            let corners = Aabb { min, max: min.map(|x| x + (whole() + 3.0) / 2.0) }.corners();
            let (p, mut q) = ([0; 3].map(|_| whole()), [0; 3].map(|_| whole()));
            let axis = ((whole() + 3.0) as usize).min(3);
            if axis < 3 {
                let end = q[axis];
                q = p;
                q[axis] = end;
            }
            // Others may be along an axis by chance.
            let differs = |k: usize| p[k] != q[k];
            let axis = (0..3).find(|&k| (0..3).all(|i| differs(i) == (i == k))).unwrap_or(3);
            for sign in [1.0, -1.0] {
                let outside = |v: Point3, other: Point3| sign * orient3d(v, p, q, other) < 0.0;
                let want = corners[1..].iter().fold(corners[0], |v, &other| if outside(v, other) { other } else { v });
                let is_met = |k: usize| corners[0][k] <= p[k] && p[k] <= corners[7][k];
                if axis == 3 || !(is_met((axis + 1) % 3) && is_met((axis + 2) % 3)) {
                    assert_eq!(farthest(&corners, p, q, sign), want, "{corners:?} {p:?} {q:?} {sign}");
                    counts[usize::from(axis < 3)] += 1;
                }
            }
        }
        assert!(counts.iter().all(|&n| n > 8000), "{counts:?}");
    }
}
