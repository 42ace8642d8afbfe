//! The volume of viewpoints.

use sightlines_geometry::{Aabb, CoordinateError, Point3, check_coordinate};

/// Why a box is not a valid volume of viewpoints.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum VolumeError {
    /// A lower corner above the upper one.
    #[error("the view volume is empty along axis {axis}: it reaches from {min} to {max}")]
    Empty {
        /// 0 to 2.
        axis: usize,
        /// Lower end.
        min: f64,
        /// Upper end.
        max: f64,
    },
    /// A coordinate that predicates cannot take.
    #[error("the view volume's {0}")]
    Coordinate(#[from] CoordinateError),
}

/// A closed box in which the eye can be anywhere. It may be flat, or a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Volume(Aabb<3>);

impl Volume {
    /// The box, checked.
    ///
    /// # Errors
    /// [`VolumeError`] for boxes without points, and coordinates that exact predicates cannot take.
    pub fn new(bounds: Aabb<3>) -> Result<Self, VolumeError> {
        for axis in 0..3 {
            let (min, max) = (check_coordinate(bounds.min[axis])?, check_coordinate(bounds.max[axis])?);
            if min > max {
                return Err(VolumeError::Empty { axis, min, max });
            }
        }
        Ok(Self(bounds))
    }

    /// The box.
    pub const fn bounds(&self) -> &Aabb<3> {
        &self.0
    }

    /// Its eight corners; bit `k` of the index selects lower (0) or upper along axis `k`.
    pub fn corners(&self) -> [Point3; 8] {
        self.0.corners()
    }

    /// Its halves along its longest axis, which share the border between them. `None` if no double lies between the
    /// ends.
    pub fn halves(&self) -> Option<[Self; 2]> {
        let size = |k: usize| self.0.max[k] - self.0.min[k];
        let axis = (1..3).fold(0, |best, k| if size(k) > size(best) { k } else { best });
        let middle = self.0.min[axis] + size(axis) / 2.0;
        let middle = check_coordinate(middle).ok()?;
        if !(self.0.min[axis] < middle && middle < self.0.max[axis]) {
            return None;
        }
        let (mut low, mut high) = (self.0, self.0);
        low.max[axis] = middle;
        high.min[axis] = middle;
        Some([Self(low), Self(high)])
    }
}
