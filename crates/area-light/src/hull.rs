//! The convex hull of a light and a piece, and what certainly stays out of its interior.
//!
//! A piece is wholly lit if no face meets the interior of the hull `K` of light and piece, because every line from an inner point of the
//! light to an inner point of the piece runs inside it. A face is shown to stay out by a plane with the face on one side and `K` on
//! the other; both may touch it. Where they do touch, the plane has to be exact; there are four such planes:
//! 1. the piece's own, behind which nothing counts: its neighbours in one plane or at convex edges;
//! 2. planes across the axes through the borders of `K`;
//! 3. the other face's, if light and the whole face of the piece are on one side: neighbours at concave edges;
//! 4. the same for the piece alone, if its corners are exact.
//!
//! Where they do not touch, any direction will do, along which `K` and the face lie apart by more than doubles may err. The
//! directions tried are the normals of all planes that can touch both: of sides of `K`, of the face, and of pairs of their edges.
//!
//! Source: Haines and Wallace, "Shaft culling for efficient ray-traced radiosity", 1991, for the planes between light and piece;
//! the separating axis theorem for the rest. The exact planes and bounds were chosen here.

use crate::Piece;
use sightlines_geometry::vector::{cross, sub};
use sightlines_geometry::{Aabb, Point3, orient3d};
use sightlines_multifocal::Volume;

/// The corners of a light, each once, and the axes along which it has an extent.
#[derive(Debug, Clone)]
pub(crate) struct Light {
    pub(crate) volume: Volume,
    pub(crate) corners: Vec<Point3>,
    /// Pairs of corners that are ends of an edge.
    edges: Vec<[usize; 2]>,
    axes: Vec<Point3>,
}

impl Light {
    pub(crate) fn new(volume: &Volume) -> Self {
        let b = volume.bounds();
        let mut corners: Vec<Point3> = Vec::with_capacity(8);
        for corner in volume.corners() {
            if !corners.contains(&corner) {
                corners.push(corner);
            }
        }
        let n_unlike = |p: Point3, q: Point3| (0..3).filter(|&k| p[k] != q[k]).count();
        let pairs = (0..corners.len()).flat_map(|i| (0..i).map(move |j| [j, i]));
        let edges = pairs.filter(|&[i, j]| n_unlike(corners[i], corners[j]) == 1).collect();
        let axis = |k: usize| std::array::from_fn(|i| f64::from(u8::from(i == k)));
        let axes = (0..3).filter(|&k| b.min[k] < b.max[k]).map(axis).collect();
        Self { volume: *volume, corners, edges, axes }
    }

    /// Whether some of the light is strictly in front of a face's side, and whether some is strictly behind. Exact.
    pub(crate) fn about(&self, [a, b, c]: [Point3; 3]) -> [bool; 2] {
        let mut about = [false; 2];
        for &corner in &self.corners {
            let side = orient3d(a, b, c, corner);
            about = [about[0] || side > 0.0, about[1] || side < 0.0];
        }
        about
    }
}

/// A half-space that holds all of the hull: where `normal * (x - origin)` is at least `low`.
#[derive(Debug, Clone, Copy)]
struct Facet {
    normal: Point3,
    low: f64,
}

/// The hull of a light and a piece. The light is in front of the piece's side, or on its plane, and not all on it; so the hull
/// has an interior.
#[derive(Debug)]
pub(crate) struct Hull<'a> {
    light: &'a Light,
    /// The whole face, so turned that the light is in front.
    face: [Point3; 3],
    corners: [Point3; 3],
    error: Point3,
    is_exact: bool,
    /// What differences are taken from.
    origin: Point3,
    bounds: Aabb<3>,
    facets: Vec<Facet>,
}

/// Bounds of `normal * (x - origin)`. A difference, a product and two sums make four roundings of 2^-53 of the sum of magnitudes, and
/// the last two lines two more: less than 8.
#[inline]
fn along(normal: Point3, x: Point3, origin: Point3) -> [f64; 2] {
    let (mut value, mut size) = (0.0, 0.0);
    for k in 0..3 {
        let part = normal[k] * (x[k] - origin[k]);
        value += part;
        size += part.abs();
    }
    let error = 4.0 * f64::EPSILON * size;
    [value - error, value + error]
}

impl<'a> Hull<'a> {
    /// * `face`: all of the face that the piece is a part of
    pub(crate) fn new(light: &'a Light, face: [Point3; 3], piece: &Piece) -> Self {
        let turned = piece.side.turned(face);
        let b = light.volume.bounds();
        let mut bounds = Aabb::around(piece.corners);
        for k in 0..3 {
            if piece.error[k] > 0.0 {
                bounds.min[k] = (bounds.min[k] - piece.error[k]).next_down();
                bounds.max[k] = (bounds.max[k] + piece.error[k]).next_up();
            }
        }
        bounds = bounds.with(b.min).with(b.max);
        let mut hull = Self {
            light,
            face: turned,
            corners: piece.corners,
            error: piece.error,
            is_exact: piece.error == [0.0; 3],
            origin: piece.corners[0],
            bounds,
            facets: Vec::with_capacity(24),
        };
        hull.make_facets();
        hull
    }

    /// Sides of the hull, as far as doubles can tell them; which are taken decides nothing, as their place is worked out afterwards.
    fn make_facets(&mut self) {
        let [a, b, c] = self.face;
        self.add_facet(cross(sub(b, a), sub(c, a)), None);
        let p = self.corners;
        for i in 0..3 {
            let edge = sub(p[(i + 1) % 3], p[i]);
            for l in 0..self.light.corners.len() {
                self.add_facet(cross(edge, sub(self.light.corners[l], p[i])), Some(p[i]));
            }
            for e in 0..self.light.edges.len() {
                let [l, m] = self.light.edges[e].map(|l| self.light.corners[l]);
                self.add_facet(cross(sub(m, l), sub(l, p[i])), Some(p[i]));
            }
        }
    }

    /// Adds the half-space with this normal or with the opposite one, if the hull touches the plane through `at`.
    fn add_facet(&mut self, normal: Point3, at: Option<Point3>) {
        let range = self.range(normal);
        let slack = (range[1] - range[0]) * 1e-9;
        let place = at.map(|at| along(normal, at, self.origin)[0]);
        if place.is_none_or(|place| range[0] + slack >= place) {
            self.facets.push(Facet { normal, low: range[0] });
        } else if place.is_some_and(|place| range[1] - slack <= place) {
            self.facets.push(Facet { normal: normal.map(|x| -x), low: -range[1] });
        }
    }

    /// Bounds of where the hull is along a direction, with all that rounding may have moved.
    fn range(&self, normal: Point3) -> [f64; 2] {
        // Three products and two sums; twice is more than their roundings.
        let moved =
            if self.is_exact { 0.0 } else { 2.0 * (0..3).map(|k| normal[k].abs() * self.error[k]).sum::<f64>() };
        let mut range = [f64::INFINITY, f64::NEG_INFINITY];
        for &p in &self.corners {
            let [low, high] = along(normal, p, self.origin);
            range = [range[0].min((low - moved).next_down()), range[1].max((high + moved).next_up())];
        }
        for &l in &self.light.corners {
            let [low, high] = along(normal, l, self.origin);
            range = [range[0].min(low), range[1].max(high)];
        }
        range
    }

    /// Whether a box certainly stays out of the interior.
    pub(crate) fn misses_box(&self, b: &Aabb<3>) -> bool {
        let beside = |k: usize| b.max[k] <= self.bounds.min[k] || b.min[k] >= self.bounds.max[k];
        if (0..3).any(beside) {
            return true;
        }
        self.facets.iter().any(|f| {
            let farthest = std::array::from_fn(|k| if f.normal[k] > 0.0 { b.max[k] } else { b.min[k] });
            along(f.normal, farthest, self.origin)[1] <= f.low
        })
    }

    /// Whether a triangle certainly stays out of the interior.
    pub(crate) fn misses(&self, t: &[Point3; 3]) -> bool {
        let beside = |k: usize| {
            let of = t.map(|p| p[k]);
            let (low, high) = (of[0].min(of[1]).min(of[2]), of[0].max(of[1]).max(of[2]));
            high <= self.bounds.min[k] || low >= self.bounds.max[k]
        };
        let [a, b, c] = self.face;
        (0..3).any(beside)
            || self.facets.iter().any(|f| t.iter().all(|&p| along(f.normal, p, self.origin)[1] <= f.low))
            || t.iter().all(|&p| orient3d(a, b, c, p) <= 0.0)
            || self.is_beside_plane(t)
            || self.is_apart(t)
    }

    /// Whether light and piece are on one side of a triangle's plane, or touch it. Exact.
    fn is_beside_plane(&self, t: &[Point3; 3]) -> bool {
        // The piece is a part of the whole face, however its own corners are rounded.
        self.are_beside(t, &self.face) || (self.is_exact && self.are_beside(t, &self.corners))
    }

    fn are_beside(&self, &[a, b, c]: &[Point3; 3], points: &[Point3; 3]) -> bool {
        let [mut any_front, mut any_behind] = [false; 2];
        self.light.corners.iter().chain(points).all(|&p| {
            let side = orient3d(a, b, c, p);
            any_front |= side > 0.0;
            any_behind |= side < 0.0;
            !(any_front && any_behind)
        })
    }

    /// Whether a direction is found along which triangle and hull are apart.
    fn is_apart(&self, t: &[Point3; 3]) -> bool {
        let apart = |normal: Point3| {
            let [low, high] = self.range(normal);
            let of = t.map(|p| along(normal, p, self.origin));
            of.iter().all(|r| r[1] <= low) || of.iter().all(|r| r[0] >= high)
        };
        let sides = [sub(t[1], t[0]), sub(t[2], t[1]), sub(t[0], t[2])];
        let p = self.corners;
        apart(cross(sides[0], sides[1]))
            || sides.iter().any(|&side| {
                let own = (0..3).map(|i| sub(p[(i + 1) % 3], p[i]));
                let axes = self.light.axes.iter().copied();
                let across = p.iter().flat_map(|&p| self.light.corners.iter().map(move |&l| sub(l, p)));
                own.chain(axes).chain(across).any(|edge| apart(cross(side, edge)))
            })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Side;
    use proptest::prelude::*;

    fn grid(n: i32) -> impl Strategy<Value = Point3> {
        [-n..n + 1, -n..n + 1, -n..n + 1].prop_map(|p| p.map(f64::from))
    }

    fn light() -> impl Strategy<Value = Light> {
        (grid(4), [0i32..4, 0i32..4, 0i32..4]).prop_map(|(min, size)| {
            let max = std::array::from_fn(|k| min[k] + f64::from(size[k]));
            Light::new(&Volume::new(Aabb { min, max }).unwrap())
        })
    }

    /// The hull of a light and a whole face, on the side that the light is on.
    fn hull<'a>(light: &'a Light, face: [Point3; 3], error: f64) -> Option<Hull<'a>> {
        let sides = [Side::Front, Side::Back];
        let side = sides.into_iter().find(|s| light.about(s.turned(face)) == [true, false])?;
        let piece = Piece { error: [error; 3], ..Piece::whole(0, side, face) };
        Some(Hull::new(light, face, &piece))
    }

    /// A mean with weights of sixteenths, none of which is 0.
    fn inner(ends: [f64; 2], at: u32) -> f64 {
        let part = f64::from(at % 15 + 1) / 16.0;
        ends[0] + (ends[1] - ends[0]) * part
    }

    proptest! {
        /// Invariant: a triangle with an inner point of the hull within it is never said to stay out, nor a box around one. All
        /// coordinates are exact: parts of whole numbers.
        #[test]
        fn hull_nothing_inside_is_said_to_miss(
            light in light(), face in [grid(5), grid(5), grid(5)], error in prop::sample::select(vec![0.0, 1e-9, 0.25]),
            at in [any::<u32>(), any::<u32>(), any::<u32>(), any::<u32>()], weights in [1u32..8, 1u32..8], away in [grid(6), grid(6)],
        ) {
            let Some(hull) = hull(&light, face, error) else { return Ok(()) };
            let w = [f64::from(weights[0]) / 16.0, f64::from(weights[1]) / 16.0];
            let p: Point3 = std::array::from_fn(|k| face[0][k] * w[0] + face[1][k] * w[1] + face[2][k] * (1.0 - w[0] - w[1]));
            let b = light.volume.bounds();
            let l: Point3 = std::array::from_fn(|k| inner([b.min[k], b.max[k]], at[k]));
            let m: Point3 = std::array::from_fn(|k| inner([p[k], l[k]], at[3]));
            let [u, v] = away;
            let t = [
                std::array::from_fn(|k| m[k] + u[k]),
                std::array::from_fn(|k| m[k] + v[k]),
                std::array::from_fn(|k| m[k] - u[k] - v[k]),
            ];
            prop_assert!(!hull.misses_box(&Aabb::around(t)), "{:?}", t);
            prop_assume!(cross(sub(t[1], t[0]), sub(t[2], t[0])) != [0.0; 3]);
            prop_assert!(!hull.misses(&t), "{:?}", t);
        }

        /// Invariant: what is apart from the hull along some direction, or touches it in a plane of its own, is
        /// reported to miss it.
        #[test]
        fn hull_what_is_apart_is_said_to_miss(
            light in light(), face in [grid(5), grid(5), grid(5)], t in [grid(9), grid(9), grid(9)],
        ) {
            let Some(hull) = hull(&light, face, 0.0) else { return Ok(()) };
            prop_assume!(cross(sub(t[1], t[0]), sub(t[2], t[0])) != [0.0; 3]);
            let all: Vec<Point3> = light.corners.iter().chain(&face).copied().collect();
            let (mut apart, mut far) = (false, false);
            for n in (0..343).map(|i| [i % 7 - 3, i / 7 % 7 - 3, i / 49 - 3].map(f64::from)) {
                let f = |p: &Point3| n[0] * p[0] + n[1] * p[1] + n[2] * p[2];
                let highest = all.iter().map(f).fold(f64::NEG_INFINITY, f64::max);
                apart |= t.iter().map(f).fold(f64::INFINITY, f64::min) > highest;
                far |= t.iter().map(f).fold(f64::INFINITY, f64::min) > highest + 1e-6;
            }
            let b = Aabb::around(t);
            prop_assert!(!apart || hull.misses(&t));
            prop_assert!(!far || !hull.misses_box(&b) || hull.misses(&t));
            // A face with the whole hull on one side; corners may lie on its plane.
            let sides: Vec<f64> = all.iter().map(|&p| orient3d(t[0], t[1], t[2], p)).collect();
            let beside = sides.iter().all(|&s| s >= 0.0) || sides.iter().all(|&s| s <= 0.0);
            prop_assert!(!beside || hull.misses(&t));
        }
    }

    #[test]
    fn lights_have_their_corners_once() {
        let light = |min, max| Light::new(&Volume::new(Aabb { min, max }).unwrap());
        let counts = |l: &Light| [l.corners.len(), l.edges.len(), l.axes.len()];
        assert_eq!(counts(&light([0.0; 3], [1.0; 3])), [8, 12, 3]);
        assert_eq!(counts(&light([0.0; 3], [1.0, 0.0, 1.0])), [4, 4, 2]);
        assert_eq!(counts(&light([0.0; 3], [0.0, 2.0, 0.0])), [2, 1, 1]);
        assert_eq!(counts(&light([7.0; 3], [7.0; 3])), [1, 0, 0]);
    }

    /// Neighbours at convex and concave edges touch the hull, and stay out of it.
    #[test]
    fn neighbours_stay_out() {
        let light = Light::new(&Volume::new(Aabb { min: [1., 1., 3.], max: [2., 2., 3.] }).unwrap());
        let floor = [[0.0; 3], [4., 0., 0.], [0., 4., 0.]];
        let hull = hull(&light, floor, 0.0).unwrap();
        let edge = [[0.0; 3], [0., 4., 0.]];
        for far in [[0., 2., 3.], [0., 2., -3.], [-1., 2., 3.], [-3., 2., 0.], [-3., 2., -1.]] {
            assert!(hull.misses(&[edge[0], edge[1], far]), "{far:?}");
        }
        assert!(!hull.misses(&[edge[0], edge[1], [2., 2., 3.]]));
        // The whole floor again.
        assert!(hull.misses(&floor));
    }
}
