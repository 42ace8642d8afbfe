//! Methods with one fault each. The suite must refuse every one of them, or it proves nothing.

use super::{Clause, RegionScene};
use crate::{BackendError, FromRegion, Guarantee, Umbra, Volume};
use sightlines_geometry::{Aabb, Point3};

/// The fault of an [`Impostor`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fault {
    /// Hides what cannot be seen from the middle of the volume, towards the middle of the target.
    OneEye,
    /// Tests only the first of several points, from the middle of the volume.
    OnePoint,
    /// Hides what meets the volume.
    HidesWhatIsNear,
    /// Hides nothing.
    HidesNothing,
    /// Every other umbra hides nothing.
    NotRepeatable,
}

impl Fault {
    /// All of them.
    pub const ALL: [Self; 5] =
        [Self::OneEye, Self::OnePoint, Self::HidesWhatIsNear, Self::HidesNothing, Self::NotRepeatable];

    /// The clauses that it may break. A method that hides nothing leaves nothing to compare.
    pub const fn clauses(self) -> &'static [Clause] {
        match self {
            Self::OneEye => &[Clause::Conservative],
            Self::OnePoint => &[Clause::Points],
            Self::HidesWhatIsNear => &[Clause::Near],
            Self::HidesNothing => &[Clause::Tight, Clause::Counted],
            Self::NotRepeatable => &[Clause::Repeatable],
        }
    }
}

/// A method with a fault.
#[derive(Debug)]
pub struct Impostor {
    method: Box<dyn FromRegion>,
    scene: RegionScene,
    fault: Fault,
    n_umbrae: u32,
}

impl Impostor {
    /// A faultless method for this scene, but for this fault.
    pub fn new(method: Box<dyn FromRegion>, scene: RegionScene, fault: Fault) -> Self {
        Self { method, scene, fault, n_umbrae: 0 }
    }
}

impl FromRegion for Impostor {
    fn name(&self) -> String {
        format!("impostor-of-{}", self.method.name())
    }

    fn guarantee(&self) -> Guarantee {
        self.method.guarantee()
    }

    fn umbra(&mut self, volume: &Volume) -> Result<Box<dyn Umbra + '_>, BackendError> {
        self.n_umbrae += 1;
        let (fault, is_even) = (self.fault, self.n_umbrae.is_multiple_of(2));
        let umbra = self.method.umbra(volume)?;
        Ok(Box::new(WrongUmbra { umbra, scene: &self.scene, volume: *volume.bounds(), fault, is_even }))
    }
}

struct WrongUmbra<'a> {
    umbra: Box<dyn Umbra + 'a>,
    scene: &'a RegionScene,
    volume: Aabb<3>,
    fault: Fault,
    is_even: bool,
}

fn middle(b: &Aabb<3>) -> Point3 {
    [0, 1, 2].map(|k| (b.min[k] + b.max[k]) / 2.0)
}

impl Umbra for WrongUmbra<'_> {
    fn hides(&mut self, target: &Aabb<3>) -> bool {
        let is_near = (0..3).all(|k| target.min[k] <= self.volume.max[k] && self.volume.min[k] <= target.max[k]);
        match self.fault {
            Fault::OneEye => !is_near && !self.scene.is_free(middle(&self.volume), middle(target)),
            Fault::HidesWhatIsNear => is_near || self.umbra.hides(target),
            Fault::HidesNothing => false,
            Fault::NotRepeatable => !self.is_even && self.umbra.hides(target),
            Fault::OnePoint => self.umbra.hides(target),
        }
    }

    fn hides_points(&mut self, points: &[Point3]) -> bool {
        match self.fault {
            Fault::OnePoint => !self.scene.is_free(middle(&self.volume), points[0]),
            Fault::HidesNothing => false,
            _ => self.umbra.hides_points(points),
        }
    }
}
