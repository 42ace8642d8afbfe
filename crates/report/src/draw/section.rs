//! What a horizontal plane cuts of the surfaces of a scene.

use super::space::Up;
use super::surfaces::Surface;
use super::visible_set::VisibleSet;
use sightlines_geometry::{Point2, Point3, Segment2};

/// What a plane and a triangle have in common.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Cut {
    /// No more than a point.
    Nothing,
    Line([Point3; 2]),
    /// The triangle lies in the plane.
    Flat,
}

/// Cuts a triangle by the plane of the points whose coordinate on `axis` is `height`. Which corners are above is exact; ends of the
/// line between corners are rounded.
pub(super) fn cut(corners: &[Point3; 3], axis: usize, height: f64) -> Cut {
    if corners.iter().all(|p| p[axis] == height) {
        return Cut::Flat;
    }
    let on = corners.iter().filter(|p| p[axis] == height).copied();
    let sides = [[0, 1], [1, 2], [2, 0]].map(|side| side.map(|i: usize| corners[i]));
    let crossed = sides.into_iter().filter(|[a, b]| (a[axis] < height) != (b[axis] < height));
    // A corner in the plane counts as a corner, not as the end of a side.
    let crossed = crossed.filter(|[a, b]| a[axis] != height && b[axis] != height);
    let between = crossed.map(|[a, b]| {
        let t = (height - a[axis]) / (b[axis] - a[axis]);
        let mut p: Point3 = std::array::from_fn(|k| a[k] + t * (b[k] - a[k]));
        p[axis] = height;
        p
    });
    let ends: Vec<Point3> = on.chain(between).collect();
    match ends[..] {
        [a, b] => Cut::Line([a, b]),
        _ => Cut::Nothing,
    }
}

/// How a cut surface is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// Seen, or nothing is told of what is seen.
    Seen,
    Hidden,
    /// It hides nothing.
    SeeThrough,
}

impl Kind {
    pub(super) const ALL: [Self; 3] = [Self::Hidden, Self::SeeThrough, Self::Seen];

    fn of(surface: &Surface, seen: Option<&VisibleSet>) -> Self {
        match surface.is_opaque {
            _ if seen.is_some_and(|seen| !seen.sees_object(surface.object)) => Self::Hidden,
            true => Self::Seen,
            false => Self::SeeThrough,
        }
    }
}

/// The surfaces of a scene in a horizontal plane, in the plane of the picture.
#[derive(Debug, Default)]
pub(super) struct Section {
    pub(super) lines: Vec<(Kind, Segment2)>,
    /// Triangles that lie in the plane.
    pub(super) flat: Vec<[Point2; 3]>,
}

impl Section {
    /// Cuts surfaces at a height; `place` is where a point lies in the plane of the picture. O(surfaces).
    pub(super) fn of(
        surfaces: impl Iterator<Item = Surface>,
        up: Up,
        place: impl Fn(Point3) -> Point2,
        height: f64,
        seen: Option<&VisibleSet>,
    ) -> Self {
        let mut section = Self::default();
        for surface in surfaces {
            match cut(&surface.corners, up.axis(), height) {
                Cut::Nothing => {}
                Cut::Line([a, b]) => {
                    section.lines.push((Kind::of(&surface, seen), Segment2::new(place(a), place(b))));
                }
                Cut::Flat => section.flat.push(surface.corners.map(&place)),
            }
        }
        section
    }

    /// All points of it.
    pub(super) fn points(&self) -> impl Iterator<Item = [f64; 2]> + '_ {
        let lines = self.lines.iter().flat_map(|(_, line)| [line.a, line.b]);
        lines.chain(self.flat.iter().flatten().copied()).map(|p| [p.x, p.y])
    }

    /// The lines of a kind.
    pub(super) fn of_kind(&self, kind: Kind) -> impl Iterator<Item = Segment2> + '_ {
        self.lines.iter().filter(move |(of, _)| *of == kind).map(|(_, line)| *line)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By height of the three corners: above, below, on the plane.
    #[test]
    fn triangles_are_cut_where_they_cross_the_plane() {
        let mut n = [0; 3];
        for heights in (0..27).map(|k| [k % 3, k / 3 % 3, k / 9].map(|k: u32| f64::from(k) - 1.0)) {
            let places = [[0.0, 0.0], [4.0, 0.0], [0.0, 4.0]];
            let corners: [Point3; 3] = std::array::from_fn(|i| [places[i][0], heights[i], places[i][1]]);
            let count = |sign: f64| heights.iter().filter(|&&h| h == sign).count();
            let found = cut(&corners, 1, 0.0);
            let expected = match (count(-1.0), count(0.0), count(1.0)) {
                (_, 3, _) => 2,
                (_, 2, _) | (1, 1, 1) | (1, 0, 2) | (2, 0, 1) => 1,
                _ => 0,
            };
            match found {
                Cut::Nothing => assert_eq!(expected, 0, "{heights:?}"),
                Cut::Flat => assert_eq!(expected, 2, "{heights:?}"),
                Cut::Line(ends) => {
                    assert_eq!(expected, 1, "{heights:?}");
                    assert!(ends.iter().all(|p| p[1] == 0.0) && ends[0] != ends[1], "{heights:?}: {ends:?}");
                    // Between the corners that differ, half of the way.
                    assert!(ends.iter().flatten().all(|x| [0.0, 2.0, 4.0].contains(x)), "{heights:?}: {ends:?}");
                }
            }
            n[expected] += 1;
        }
        assert_eq!(n, [8, 18, 1]);
    }
}
