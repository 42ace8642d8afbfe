//! Whether a triangle of a chain stays away from an end of the lines. Exact.

use crate::end::End;
use crate::orient::{orient, sign};
use crate::surface::Surface;
use sightlines_geometry::{Aabb, Point2, Point3, orient2d};
use sightlines_multifocal::mesh::avoids as avoids_box;

/// What the lines of a search end at.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Target {
    /// A box: the inside of the end may not be touched, a side of the box or a rectangle before it.
    Box,
    /// A triangle: its inside may not be touched.
    Triangle([Point3; 3]),
}

impl Target {
    /// A triangle, if no inner point of where lines begin is on its plane.
    pub(crate) fn seen_from_one_side(&self, from: &End) -> Option<[Point3; 3]> {
        let Self::Triangle([a, b, c]) = *self else { return None };
        let sides = Sides::of(from.corners(), |p| orient(a, b, c, p));
        (sides.positive != sides.negative).then_some([a, b, c])
    }

    /// Whether a triangle is in the plane of the target, so that no line is blocked there before it ends.
    pub(crate) fn is_level_with(&self, triangle: &[Point3; 3]) -> bool {
        let Self::Triangle([a, b, c]) = *self else { return false };
        triangle.iter().all(|&p| orient(a, b, c, p) == 0.0)
    }

    /// Whether a triangle stays away from the end of the lines of a cell at this target.
    pub(crate) fn is_clear_of(&self, surface: &Surface, triangle: &[Point3; 3], bounds: &Aabb<3>, end: &End) -> bool {
        let around = end.bounds();
        if apart(bounds, around) || is_parted(surface, triangle, end) {
            return true;
        }
        match self {
            Self::Box => avoids(triangle, end, true),
            Self::Triangle(whole) => {
                let inside_of = |piece: &[Point3; 3]| avoids_inside(triangle, piece);
                inside_of(whole)
                    || end.is_exact() && inside_of(&[end.corners()[0], end.corners()[1], end.corners()[2]])
                    || !end.is_exact() && leaves_plane_of(triangle, end)
                    || avoids_box(triangle, around, true)
            }
        }
    }
}

/// Whether a plane that an end is known to be on a side of has a triangle on its other side, or on it.
fn is_parted(surface: &Surface, triangle: &[Point3; 3], end: &End) -> bool {
    end.sides().any(|side| {
        let [a, b, c] = surface.corners(side.triangle());
        triangle.iter().all(|&p| f64::from(side.sign()) * orient(a, b, c, p) <= 0.0)
    })
}

/// Whether all of a rounded end is certainly on one side of the plane of a triangle.
fn leaves_plane_of([a, b, c]: &[Point3; 3], end: &End) -> bool {
    let side = |p: Point3| sign(*a, *b, *c, p, end.radius());
    let first = side(end.corners()[0]);
    first != 0 && end.corners()[1..].iter().all(|&p| side(p) == first)
}

fn apart(a: &Aabb<3>, b: &Aabb<3>) -> bool {
    (0..3).any(|k| a.max[k] < b.min[k] || b.max[k] < a.min[k])
}

/// How lines leave the box where they begin.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Start {
    /// The axis across which.
    pub(crate) axis: usize,
    /// Whether upwards along it.
    pub(crate) upward: bool,
    /// Whether they come from behind the side of the box, as it has an extent along the axis.
    pub(crate) from_behind: bool,
}

impl Start {
    /// Whether a triangle stays away from the end where lines begin. Or else, if lines come from behind, whether it lies on the end's plane or
    /// beyond: they then cross it where they begin.
    pub(crate) fn is_clear_of(&self, surface: &Surface, triangle: &[Point3; 3], bounds: &Aabb<3>, end: &End) -> bool {
        let at = end.corners()[0][self.axis];
        let is_beyond = if self.upward { bounds.min[self.axis] >= at } else { bounds.max[self.axis] <= at };
        self.from_behind && is_beyond
            || apart(bounds, end.bounds())
            || is_parted(surface, triangle, end)
            || avoids(triangle, end, true)
    }
}

/// Whether a triangle has no point of an exact end; with `touching` it may have points of the end's border.
fn avoids(t: &[Point3; 3], end: &End, touching: bool) -> bool {
    let corners = end.corners();
    let n = corners.len();
    let by_plane = |a: Point3, b: Point3, c: Point3| {
        let side = |p: Point3| orient(a, b, c, p);
        Sides::of(corners, side).are_apart_from(&Sides::of(t, side), touching)
    };
    let of_triangle = (0..3).flat_map(|i| corners.iter().map(move |&p| (t[i], t[(i + 1) % 3], p)));
    let of_end = (0..n).flat_map(|i| t.iter().map(move |&p| (corners[i], corners[(i + 1) % n], p)));
    // The end's own plane has nothing of the end strictly on a side; there the triangle has to be.
    let leaves_plane = Sides::of(t, |p| orient(corners[0], corners[1], corners[2], p)).are_strictly_on_one_side();
    leaves_plane
        || by_plane(t[0], t[1], t[2])
        || of_triangle.chain(of_end).any(|(a, b, c)| by_plane(a, b, c))
        || coplanar_apart(t, corners, touching)
}

/// Whether a triangle has no inner point of another one.
fn avoids_inside(t: &[Point3; 3], inside: &[Point3; 3]) -> bool {
    avoids(t, &End::triangle(*inside), true)
}

/// On which sides of a plane, or of a line in a plane, some points lie.
#[derive(Debug, Clone, Copy, Default)]
struct Sides {
    positive: bool,
    negative: bool,
    on: bool,
}

impl Sides {
    fn of<P: Copy>(points: &[P], side: impl Fn(P) -> f64) -> Self {
        let mut sides = Self::default();
        for &p in points {
            let side = side(p);
            sides.positive |= side > 0.0;
            sides.negative |= side < 0.0;
            sides.on |= side == 0.0;
        }
        sides
    }

    fn are_strictly_on_one_side(&self) -> bool {
        self.positive != self.negative && !self.on
    }

    /// Whether these are the corners of an end on one side, and `triangle` is on the other or on the border. With `touching` some
    /// corners of the end may be on the border, but not all.
    fn are_apart_from(&self, triangle: &Self, touching: bool) -> bool {
        let one_side = self.positive != self.negative && (touching || !self.on);
        one_side && !(if self.positive { triangle.positive } else { triangle.negative })
    }
}

/// Whether a triangle and an end in one plane have a line between them there.
fn coplanar_apart(t: &[Point3; 3], end: &[Point3], touching: bool) -> bool {
    if !end.iter().all(|&p| orient(t[0], t[1], t[2], p) == 0.0) {
        return false;
    }
    (0..3).any(|k| {
        let flat = |p: Point3| Point2::new(p[(k + 1) % 3], p[(k + 2) % 3]);
        let by_line = |a: Point3, b: Point3| {
            let side = |p: Point3| orient2d(flat(a), flat(b), flat(p));
            Sides::of(end, side).are_apart_from(&Sides::of(t, side), touching)
        };
        let around = |ring: &[Point3]| (0..ring.len()).any(|i| by_line(ring[i], ring[(i + 1) % ring.len()]));
        around(t) || around(end)
    })
}
