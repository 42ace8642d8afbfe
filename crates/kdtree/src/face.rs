//! Faces on axial planes, and how they lie against a cell.

use crate::error::FaceError;
use sightlines_geometry::{Aabb, check_coordinate};

/// An opaque axis-parallel face: a segment of the plane (`D` = 2) or a rectangle in space (`D` = 3).
///
/// Checked when a scene is cut: `min[axis] == max[axis] == at`, and `min <= max` elsewhere. A face
/// without extent along another axis is allowed and hides nothing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxialFace<const D: usize> {
    /// The axis that the face is perpendicular to, below `D`.
    pub axis: usize,
    /// Where on that axis it lies, in scene units.
    pub at: f64,
    /// Lower corner, in scene units.
    pub min: [f64; D],
    /// Upper corner, in scene units.
    pub max: [f64; D],
}

impl<const D: usize> AxialFace<D> {
    /// The face from `min` to `max`, perpendicular to `axis`; `at` is read from `min`.
    ///
    /// # Panics
    /// If `axis` is not below `D`.
    pub const fn new(axis: usize, min: [f64; D], max: [f64; D]) -> Self {
        Self { axis, at: min[axis], min, max }
    }

    /// The plane that the face lies on.
    pub const fn plane(&self) -> AxialPlane {
        AxialPlane { axis: self.axis, at: self.at }
    }

    /// The face with negative zeros made positive.
    ///
    /// # Errors
    /// [`FaceError`] for the first thing that is wrong with it.
    pub(crate) fn checked(self) -> Result<Self, FaceError> {
        let Self { axis, at, min, max } = self;
        if axis >= D {
            return Err(FaceError::Axis(axis));
        }
        let mut out = Self { at: check_coordinate(at).map_err(FaceError::Coordinate)?, ..self };
        for x in out.min.iter_mut().chain(&mut out.max) {
            *x = check_coordinate(*x).map_err(FaceError::Coordinate)?;
        }
        if min[axis] != at || max[axis] != at {
            return Err(FaceError::OffPlane { at, min: min[axis], max: max[axis] });
        }
        match (0..D).find(|&k| min[k] > max[k]) {
            Some(axis) => Err(FaceError::Reversed { axis, min: min[axis], max: max[axis] }),
            None => Ok(out),
        }
    }
}

/// The plane of all points with `p[axis] == at`; a line if `D` is 2.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxialPlane {
    /// The axis that the plane is perpendicular to.
    pub axis: usize,
    /// Where on that axis it lies, in scene units.
    pub at: f64,
}

/// How a face lies against a cell. Each face is exactly one of these.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum FaceClass {
    /// Face and closed cell have no piece of positive measure in common: at most points (and, in
    /// space, edges).
    Disjoint,
    /// On the cell's border, where it covers a piece of positive measure.
    Covering,
    /// Divides the cell: inside it, and reaching from border to border along every other axis.
    Spanning,
    /// Inside the cell, but not all across.
    Incident,
}

/// How `face` lies against the closed box `cell`. Exact: only compares coordinates. O(D).
///
/// Looks at one face only. [`subdivide`](crate::subdivide) unites coplanar faces first, so it also recognises faces
/// that divide a cell together.
pub fn classify<const D: usize>(face: &AxialFace<D>, cell: &Aabb<D>) -> FaceClass {
    let a = face.axis;
    if !shares_measure(face, cell) {
        FaceClass::Disjoint
    } else if face.at == cell.min[a] || face.at == cell.max[a] {
        FaceClass::Covering
    } else if across::<D>(a).all(|k| face.min[k] <= cell.min[k] && cell.max[k] <= face.max[k]) {
        FaceClass::Spanning
    } else {
        FaceClass::Incident
    }
}

/// Whether `plane` cuts the piece of `face` inside the closed box `cell` in two, both of positive
/// measure. Exact: only compares coordinates. O(D).
///
/// Never for a plane parallel to the face, nor for a face that is [`FaceClass::Disjoint`].
pub fn cleaves<const D: usize>(face: &AxialFace<D>, plane: AxialPlane, cell: &Aabb<D>) -> bool {
    let k = plane.axis;
    k != face.axis
        && shares_measure(face, cell)
        && face.min[k].max(cell.min[k]) < plane.at
        && plane.at < face.max[k].min(cell.max[k])
}

fn shares_measure<const D: usize>(face: &AxialFace<D>, cell: &Aabb<D>) -> bool {
    cell.min[face.axis] <= face.at
        && face.at <= cell.max[face.axis]
        && across::<D>(face.axis).all(|k| face.min[k].max(cell.min[k]) < face.max[k].min(cell.max[k]))
}

/// The axes other than `axis`, ascending.
pub(crate) fn across<const D: usize>(axis: usize) -> impl Iterator<Item = usize> {
    (0..D).filter(move |&k| k != axis)
}

#[cfg(test)]
mod tests {
    use super::*;

    const CELL: Aabb<2> = Aabb { min: [0.0, 0.0], max: [4.0, 2.0] };

    fn upright(x: f64, y0: f64, y1: f64) -> AxialFace<2> {
        AxialFace::new(0, [x, y0], [x, y1])
    }

    #[test]
    fn classes_in_the_plane() {
        let class = |x, y0, y1| classify(&upright(x, y0, y1), &CELL);
        assert_eq!(class(1.0, 0.0, 2.0), FaceClass::Spanning);
        assert_eq!(class(1.0, -1.0, 3.0), FaceClass::Spanning);
        assert_eq!(class(1.0, 0.0, 1.0), FaceClass::Incident);
        assert_eq!(class(1.0, 1.0, 9.0), FaceClass::Incident);
        assert_eq!(class(0.0, 1.0, 9.0), FaceClass::Covering);
        assert_eq!(class(4.0, 0.0, 2.0), FaceClass::Covering);
        assert_eq!(class(4.5, 0.0, 2.0), FaceClass::Disjoint);
        assert_eq!(class(1.0, 2.0, 3.0), FaceClass::Disjoint, "touches in a point");
        assert_eq!(class(1.0, 1.0, 1.0), FaceClass::Disjoint, "has no extent");
        let next_up = 1.0f64.next_up();
        let thin = Aabb { min: [1.0, 0.0], max: [next_up, 2.0] };
        assert_eq!(classify(&upright(next_up, 0.0, 2.0), &thin), FaceClass::Covering, "one ulp apart");
    }

    #[test]
    fn classes_in_space() {
        let cell = Aabb { min: [0.0; 3], max: [2.0; 3] };
        let class = |min: [f64; 2], max: [f64; 2]| {
            classify(&AxialFace::new(1, [min[0], 1.0, min[1]], [max[0], 1.0, max[1]]), &cell)
        };
        assert_eq!(class([0.0, 0.0], [2.0, 2.0]), FaceClass::Spanning);
        assert_eq!(class([0.0, 0.0], [2.0, 1.0]), FaceClass::Incident);
        assert_eq!(class([2.0, 0.0], [3.0, 1.0]), FaceClass::Disjoint, "touches along an edge");
    }

    #[test]
    fn cleaving_needs_both_sides() {
        let plane = |at| AxialPlane { axis: 1, at };
        let face = upright(1.0, 0.5, 9.0);
        assert!(cleaves(&face, plane(1.0), &CELL));
        assert!(!cleaves(&face, plane(0.5), &CELL), "touches the plane");
        assert!(!cleaves(&face, plane(3.0), &CELL), "cut outside the cell");
        assert!(!cleaves(&face, AxialPlane { axis: 0, at: 1.0 }, &CELL), "lies on the plane");
        assert!(!cleaves(&upright(5.0, 0.5, 9.0), plane(1.0), &CELL), "not in the cell");
    }

    #[test]
    fn faces_are_checked() {
        let message = |face: AxialFace<2>| face.checked().unwrap_err().to_string();
        assert_eq!(message(AxialFace { axis: 2, ..upright(0., 0., 1.) }), "axis 2 does not exist");
        assert_eq!(message(upright(f64::NAN, 0., 1.)), "coordinate NaN is not a finite number");
        assert_eq!(message(upright(0., 3., 1.)), "begins at 3 on axis 1, above its end 1");
        let slanted = AxialFace::new(0, [0., 0.], [1., 1.]);
        assert_eq!(message(slanted), "extends from 0 to 1 across its plane at 0");
        let clean = upright(-0.0, -0.0, 1.0).checked().unwrap();
        assert!([clean.at, clean.min[0], clean.min[1], clean.max[0]].iter().all(|x| x.is_sign_positive()));
    }
}
