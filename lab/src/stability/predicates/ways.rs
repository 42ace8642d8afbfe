//! Who decides: the exact predicates of the crates, and the same formulas in plain floats.
//!
//! A case is a list of points, as [`cases`](super::cases) makes them. Each answers whether something is *hidden*; walls and occluders are
//! closed, so what only touches them is hidden.

use super::cases::{Case, corners};
use crate::stability::Answer;
use crate::stability::plain::{self, Float, Kept, V, cross, dot, minus, rounded};
use sightlines::geometry::{Point2, Point3, Segment2, orient2d, orient3d, polygon::polygon_contains};

/// What a program without a better idea takes for "on the line".
const EPSILON: f64 = 1e-9;

fn answer(hidden: bool) -> Answer {
    if hidden { Answer::Hidden } else { Answer::Seen }
}

fn flat(p: Point3) -> Point2 {
    Point2::new(p[0], p[1])
}

fn first<const N: usize>(case: &[Point3]) -> [Point3; N] {
    *case.first_chunk().expect("a case has all of its points")
}

/// A wall ends in the third point and goes on to the left; it blocks the line through the first two if its end lies there.
pub(super) mod line {
    use super::*;

    pub(crate) fn exact(case: &Case) -> Answer {
        let [a, b, c] = first(case).map(flat);
        answer(orient2d(a, b, c) >= 0.0)
    }

    pub(crate) fn plain<F: Float>(case: &Case) -> Answer {
        answer(plain::turn::<F>(first(case)) >= 0.0)
    }

    pub(crate) fn epsilon(case: &Case) -> Answer {
        answer(plain::turn::<f64>(first(case)) >= -EPSILON)
    }

    pub(crate) fn kept(case: &Case) -> Answer {
        answer(plain::kept_turn::<f64>(first(case)) >= 0.0)
    }
}

/// The first three points span a wall; the fourth is hidden from what is in front if it lies behind the wall, or on it.
pub(super) mod plane {
    use super::*;

    pub(crate) fn exact(case: &Case) -> Answer {
        let [a, b, c, d] = first(case);
        answer(orient3d(a, b, c, d) <= 0.0)
    }

    pub(crate) fn plain<F: Float>(case: &Case) -> Answer {
        answer(plain::side::<F>(first(case)) <= 0.0)
    }

    pub(crate) fn epsilon(case: &Case) -> Answer {
        answer(plain::side::<f64>(first(case)) <= EPSILON)
    }

    pub(crate) fn kept(case: &Case) -> Answer {
        let [a, b, c, d] = first(case);
        answer(Kept::<f64>::through([a, b, c]).at(d) <= 0.0)
    }
}

/// The last point is hidden if it lies in the convex silhouette of the others, or on its border.
pub(super) mod polygon {
    use super::*;

    fn split(case: &[Point3]) -> (&[Point3], Point3) {
        let (last, corners) = case.split_last().expect("a case has points");
        (corners, *last)
    }

    fn all(case: &[Point3], inside: impl Fn([Point3; 3]) -> bool) -> Answer {
        let (corners, p) = split(case);
        answer((0..corners.len()).all(|i| inside([corners[i], corners[(i + 1) % corners.len()], p])))
    }

    pub(crate) fn exact(case: &Case) -> Answer {
        let (corners, p) = split(case);
        let corners: Vec<Point2> = corners.iter().map(|&p| flat(p)).collect();
        answer(polygon_contains(&corners, flat(p)))
    }

    pub(crate) fn plain<F: Float>(case: &Case) -> Answer {
        all(case, |points| plain::turn::<F>(points) >= 0.0)
    }

    pub(crate) fn epsilon(case: &Case) -> Answer {
        all(case, |points| plain::turn::<f64>(points) >= -EPSILON)
    }

    /// How often a ray to the right crosses the border, by the quotient that everyone writes.
    pub(crate) fn crossings(case: &Case) -> Answer {
        let (corners, p) = split(case);
        let crossed = |(a, b): (Point3, Point3)| {
            (a[1] > p[1]) != (b[1] > p[1]) && p[0] < (b[0] - a[0]) * (p[1] - a[1]) / (b[1] - a[1]) + a[0]
        };
        let n = (0..corners.len()).filter(|&i| crossed((corners[i], corners[(i + 1) % corners.len()]))).count();
        answer(n % 2 == 1)
    }
}

/// The first two points are the ends of a wall, the others those of a line of sight, which is blocked if the two cross inside both.
pub(super) mod segments {
    use super::*;

    pub(crate) fn exact(case: &Case) -> Answer {
        let [a, b, c, d] = first(case).map(flat);
        answer(Segment2::new(a, b).crosses(&Segment2::new(c, d)))
    }

    /// Where on both segments their lines meet, by quotients.
    fn meets<F: Float>(case: &[Point3], margin: F) -> Answer {
        let [a, b, c, d] = first(case).map(rounded::<F>);
        let (u, v, w) = (minus(b, a), minus(d, c), minus(c, a));
        let flat = |p: V<F>, q: V<F>| p[0] * q[1] - p[1] * q[0];
        let det = flat(u, v);
        let (s, t) = (flat(w, v) / det, flat(w, u) / det);
        let (zero, one) = (F::of(0.0), F::of(1.0));
        let within = |x: F| x >= zero - margin && x <= one + margin;
        answer(within(s) && within(t))
    }

    pub(crate) fn plain<F: Float>(case: &Case) -> Answer {
        meets(case, F::of(0.0))
    }

    pub(crate) fn epsilon(case: &Case) -> Answer {
        meets(case, EPSILON)
    }
}

/// The first two points are the corners of a box of eyes, then come the ends of an occluder's edge and a point behind. It is hidden, as far as
/// this edge is concerned, if all lines from eyes to it pass the edge on the inner side.
pub(super) mod umbra {
    use super::*;
    use crate::stability::shader_float;

    pub(crate) fn exact(case: &Case) -> Answer {
        let [min, max, a, b, t] = first(case);
        answer(corners(min, max).iter().all(|&v| orient3d(v, a, b, t) <= 0.0))
    }

    /// Seen from the point, the middle of the box lies farther inside than the box reaches.
    fn collapsed<F: Float>([centre, half, a, b, t]: [V<F>; 5]) -> f64 {
        let n = cross(minus(a, t), minus(b, t));
        (dot(minus(centre, t), n) - dot(n.map(F::abs), half)).wide()
    }

    fn of_box<F: Float>(case: &[Point3]) -> [V<F>; 5] {
        let [min, max, a, b, t] = first(case);
        let centre = std::array::from_fn(|k| (min[k] + max[k]) / 2.0);
        let half = std::array::from_fn(|k| (max[k] - min[k]) / 2.0);
        [centre, half, a, b, t].map(rounded::<F>)
    }

    pub(crate) fn plain<F: Float>(case: &Case) -> Answer {
        answer(collapsed(of_box::<F>(case)) >= 0.0)
    }

    pub(crate) fn epsilon(case: &Case) -> Answer {
        answer(collapsed(of_box::<f64>(case)) >= -EPSILON)
    }

    /// The numbers of the shader.
    fn framed(case: &[Point3]) -> [V<f32>; 4] {
        let [min, max, a, b, t] = first(case);
        let frame = shader_float::Frame::new(min, max, [a, b, t]);
        [frame.half_size(min, max), frame.point(a), frame.point(b), frame.point(t)]
    }

    /// As the shader decides.
    pub(crate) fn margin(case: &Case) -> Answer {
        let [half, a, b, t] = framed(case);
        answer(shader_float::inner(half, [a, b], t, 1.0, shader_float::MARGIN))
    }

    /// The shader without its margin.
    pub(crate) fn no_margin(case: &Case) -> Answer {
        let [half, a, b, t] = framed(case);
        answer(shader_float::inner(half, [a, b], t, 1.0, 0.0))
    }
}
