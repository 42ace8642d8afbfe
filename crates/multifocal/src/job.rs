//! The input of a backend.

use crate::plane::power_of_two_at_most;
use crate::{BufferPlane, BufferPlaneError, Measure, Occluder, Volume};

/// Why a job is invalid.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BufferJobError {
    /// A list without planes.
    #[error("a job needs at least one plane")]
    NoPlane,
    /// A plane that is not in front of the volume.
    #[error("plane {idx}: {error}")]
    Plane {
        /// Its index.
        idx: usize,
        /// The defect.
        error: BufferPlaneError,
    },
    /// Planes of one job look the same way, each farther away than the one before.
    #[error("plane {0} does not look the same way as the one before, or is no farther away")]
    Order(usize),
    /// Heights can be carried from plane to plane; distances cannot.
    #[error("planes are carried over for heights only, not for {}", .0.name())]
    Carry(Measure),
}

/// One whole job: the buffers of one or several planes in one direction, for one volume.
#[derive(Debug, Clone)]
pub struct BufferJob<'a> {
    volume: Volume,
    planes: Vec<BufferPlane>,
    occluders: Vec<&'a Occluder>,
    measure: Measure,
    carry: bool,
    unit: f64,
}

/// Values stay below 2 to the power of this.
pub const VALUE_BITS: u32 = 28;

impl<'a> BufferJob<'a> {
    /// Checks a job.
    ///
    /// * `planes`: looking the same way, from the nearest to the farthest
    /// * `occluders`: those that hide [from their front only](Occluder::is_front_only) count if all of the volume is in front of them; of all others
    ///   backends find out
    /// * `carry`: whether the values of each plane are carried to the next one (re-projection): a texel is also blocked if
    ///   all lines from it to the volume cross blocked texels of the previous plane
    ///
    /// # Errors
    /// [`BufferJobError`]
    pub fn new(
        volume: Volume,
        planes: Vec<BufferPlane>,
        occluders: impl IntoIterator<Item = &'a Occluder>,
        measure: Measure,
        carry: bool,
    ) -> Result<Self, BufferJobError> {
        if planes.is_empty() {
            return Err(BufferJobError::NoPlane);
        }
        if carry && planes.len() > 1 && !measure.is_height() {
            return Err(BufferJobError::Carry(measure));
        }
        for (idx, plane) in planes.iter().enumerate() {
            plane.check_in_front_of(&volume).map_err(|error| BufferJobError::Plane { idx, error })?;
        }
        let farther = |(a, b): (&BufferPlane, &BufferPlane)| {
            let same = a.axis() == b.axis() && a.positive() == b.positive();
            same && if a.positive() { a.at() < b.at() } else { a.at() > b.at() }
        };
        if let Some(i) = planes.iter().zip(&planes[1..]).position(|pair| !farther(pair)) {
            return Err(BufferJobError::Order(i + 1));
        }
        let unit = unit(&volume, &planes, measure);
        let eyes = volume.corners();
        let hides = |o: &&Occluder| !o.is_front_only() || o.hiding_side_of(&eyes).is_some();
        let occluders = occluders.into_iter().filter(hides).collect();
        Ok(Self { volume, planes, occluders, measure, carry, unit })
    }

    /// Where the eyes are.
    pub const fn volume(&self) -> &Volume {
        &self.volume
    }

    /// The planes, nearest first.
    pub fn planes(&self) -> &[BufferPlane] {
        &self.planes
    }

    /// The occluders, without those that hide from their front only and have some of the volume not in front of them.
    pub fn occluders(&self) -> &[&'a Occluder] {
        &self.occluders
    }

    /// The meaning of the values.
    pub const fn measure(&self) -> Measure {
        self.measure
    }

    /// Whether the values of each plane are carried to the next one.
    pub const fn carry(&self) -> bool {
        self.carry
    }

    /// Scene units in one unit of the values: a power of two, the same for all planes of a job.
    pub const fn unit(&self) -> f64 {
        self.unit
    }
}

/// A power of two of which all values of a job are less than 2^[`VALUE_BITS`] - 2.
fn unit(volume: &Volume, planes: &[BufferPlane], measure: Measure) -> f64 {
    let largest = planes.iter().map(|plane| reach(volume, plane, measure)).fold(0.0, f64::max);
    power_of_two_at_most(largest) * 4.0 / f64::from(1u32 << VALUE_BITS)
}

/// More than any value that an occluder between the volume and the plane can have.
fn reach(volume: &Volume, plane: &BufferPlane, measure: Measure) -> f64 {
    let (b, axis) = (volume.bounds(), plane.axis());
    let height = plane.height(b.min).max(plane.height(b.max));
    debug_assert!(axis < 3, "planes are checked");
    if measure.is_height() {
        return height;
    }
    let (low, high) = (plane.origin(), plane.end());
    let across = plane.across();
    let aside = |k: usize| (b.max[across[k]] - low[k]).max(high[k] - b.min[across[k]]);
    height + aside(0).max(0.0) + aside(1).max(0.0)
}
