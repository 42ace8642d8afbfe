//! Whether a triangle of a chain stays away from an end of the lines. Exact.

use crate::end::End;
use crate::orient::orient;
use sightlines_geometry::{Aabb, Point2, Point3, orient2d};

/// What the lines of a search end at.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Target {
    /// A box: no point of it may be touched, as what is in it is not known.
    Box,
    /// A triangle: its inside may not be touched.
    Triangle([Point3; 3]),
}

impl Target {
    /// Whether a triangle stays away from the end of the lines of a cell at this target.
    pub(crate) fn is_clear_of(&self, triangle: &[Point3; 3], bounds: &Aabb<3>, end: &End) -> bool {
        let around = end.bounds();
        if apart(bounds, around) {
            return true;
        }
        match self {
            Self::Box => avoids(triangle, end, false),
            Self::Triangle(whole) => {
                let inside_of = |piece: &[Point3; 3]| avoids_inside(triangle, piece);
                inside_of(whole)
                    || end.is_exact() && inside_of(&[end.corners()[0], end.corners()[1], end.corners()[2]])
                    || avoids_box(triangle, around)
            }
        }
    }
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
    pub(crate) fn is_clear_of(&self, triangle: &[Point3; 3], bounds: &Aabb<3>, end: &End) -> bool {
        let at = end.corners()[0][self.axis];
        let is_beyond = if self.upward { bounds.min[self.axis] >= at } else { bounds.max[self.axis] <= at };
        self.from_behind && is_beyond || apart(bounds, end.bounds()) || avoids(triangle, end, true)
    }
}

/// Whether a triangle has no point of an exact end; with `touching` it may have points of the end's border.
fn avoids(t: &[Point3; 3], end: &End, touching: bool) -> bool {
    let corners = end.corners();
    let n = corners.len();
    if plane_separates(t[0], t[1], t[2], &[], corners, touching) {
        return true;
    }
    if plane_separates(corners[0], corners[1], corners[2], corners, t, false) {
        return true;
    }
    for i in 0..3 {
        for &p in corners {
            if plane_splits(t[i], t[(i + 1) % 3], p, t, corners, touching) {
                return true;
            }
        }
    }
    for i in 0..n {
        for &p in t {
            if plane_splits(corners[i], corners[(i + 1) % n], p, t, corners, touching) {
                return true;
            }
        }
    }
    coplanar_apart(t, corners, touching)
}

/// Whether a triangle has no inner point of another one.
fn avoids_inside(t: &[Point3; 3], inside: &[Point3; 3]) -> bool {
    avoids(t, &End::triangle(*inside), true)
}

/// Whether a triangle has no point of the relative interior of a box.
fn avoids_box(t: &[Point3; 3], b: &Aabb<3>) -> bool {
    sightlines_multifocal::mesh::avoids(t, b, true)
}

/// Whether all `points` lie on one side of a plane, none of them on it; with `touching` some may, but not all.
fn plane_separates(a: Point3, b: Point3, c: Point3, _on: &[Point3], points: &[Point3], touching: bool) -> bool {
    let [mut positive, mut negative, mut zero] = [false; 3];
    for &p in points {
        let side = orient(a, b, c, p);
        positive |= side > 0.0;
        negative |= side < 0.0;
        zero |= side == 0.0;
    }
    positive != negative && (touching || !zero)
}

/// Whether a plane has a triangle on one side or on it, and the end strictly on the other; with `touching` some corners of the end may be
/// on it, but not all.
fn plane_splits(a: Point3, b: Point3, c: Point3, t: &[Point3; 3], end: &[Point3], touching: bool) -> bool {
    let sides = |points: &[Point3]| {
        let mut has = [false; 3];
        for &p in points {
            let side = orient(a, b, c, p);
            has[if side > 0.0 {
                0
            } else if side < 0.0 {
                1
            } else {
                2
            }] = true;
        }
        has
    };
    let [up, down, on] = sides(end);
    if up == down || (on && !touching) {
        return false;
    }
    let [triangle_up, triangle_down, _] = sides(t);
    if up { !triangle_up } else { !triangle_down }
}

/// Whether a triangle and an end in one plane have a line between them there.
fn coplanar_apart(t: &[Point3; 3], end: &[Point3], touching: bool) -> bool {
    if !end.iter().all(|&p| orient(t[0], t[1], t[2], p) == 0.0) {
        return false;
    }
    (0..3).any(|k| {
        let flat = |p: &Point3| Point2::new(p[(k + 1) % 3], p[(k + 2) % 3]);
        let (t, end): (Vec<Point2>, Vec<Point2>) = (t.iter().map(flat).collect(), end.iter().map(flat).collect());
        let sides = |a: Point2, b: Point2, points: &[Point2]| {
            let mut has = [false; 3];
            for &p in points {
                let side = orient2d(a, b, p);
                has[if side > 0.0 {
                    0
                } else if side < 0.0 {
                    1
                } else {
                    2
                }] = true;
            }
            has
        };
        let splits = |a: Point2, b: Point2| {
            let [up, down, on] = sides(a, b, &end);
            if up == down || (on && !touching) {
                return false;
            }
            let [triangle_up, triangle_down, _] = sides(a, b, &t);
            if up { !triangle_up } else { !triangle_down }
        };
        let around = |ring: &[Point2]| (0..ring.len()).any(|i| splits(ring[i], ring[(i + 1) % ring.len()]));
        around(&t) || around(&end)
    })
}
