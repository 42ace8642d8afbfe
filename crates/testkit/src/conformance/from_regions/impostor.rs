//! Methods with one fault each.

use super::RegionScene;
use crate::conformance::Impostor;
use sightlines_geometry::{Aabb, Point3};
use sightlines_multifocal::{BackendError, FromRegion, Guarantee, Umbra, Volume};
use std::sync::Arc;

faults! {
    /// What a wrong method does.
    FromRegionFault {
        /// Hides what cannot be seen from the middle of the volume, towards the middle of the target.
        OneEye breaks Conservative,
        /// Tests only the first of several points, from the middle of the volume.
        OnePoint breaks Points,
        /// Hides what meets the volume.
        HidesWhatIsNear breaks Near,
        /// Hides nothing.
        HidesNothing breaks Tight,
        /// Every other umbra hides nothing.
        NotRepeatable breaks Repeatable,
    }
}

/// A maker of methods that have a fault, but for which they are those of `make`.
pub fn wrong(
    mut make: impl FnMut(&RegionScene) -> Box<dyn FromRegion>,
    fault: FromRegionFault,
) -> impl FnMut(&RegionScene) -> Box<dyn FromRegion> {
    move |scene| Box::new(Impostor { inner: make(scene), fault, memory: scene.clone(), n_calls: Arc::default() })
}

/// Has the scene in memory.
impl FromRegion for Impostor<Box<dyn FromRegion>, FromRegionFault, RegionScene> {
    fn name(&self) -> String {
        format!("impostor-of-{}", self.inner.name())
    }

    fn guarantee(&self) -> Guarantee {
        self.inner.guarantee()
    }

    fn umbra(&mut self, volume: &Volume) -> Result<Box<dyn Umbra + '_>, BackendError> {
        let (fault, is_second) = (self.fault, !self.call().is_multiple_of(2));
        let umbra = self.inner.umbra(volume)?;
        Ok(Box::new(WrongUmbra { umbra, scene: &self.memory, volume: *volume.bounds(), fault, is_second }))
    }
}

struct WrongUmbra<'a> {
    umbra: Box<dyn Umbra + 'a>,
    scene: &'a RegionScene,
    volume: Aabb<3>,
    fault: FromRegionFault,
    is_second: bool,
}

fn middle(b: &Aabb<3>) -> Point3 {
    [0, 1, 2].map(|k| (b.min[k] + b.max[k]) / 2.0)
}

impl Umbra for WrongUmbra<'_> {
    fn hides(&mut self, target: &Aabb<3>) -> bool {
        let is_near = (0..3).all(|k| target.min[k] <= self.volume.max[k] && self.volume.min[k] <= target.max[k]);
        match self.fault {
            FromRegionFault::OneEye => !is_near && !self.scene.is_free(middle(&self.volume), middle(target)),
            FromRegionFault::HidesWhatIsNear => is_near || self.umbra.hides(target),
            FromRegionFault::HidesNothing => false,
            FromRegionFault::NotRepeatable => !self.is_second && self.umbra.hides(target),
            FromRegionFault::OnePoint => self.umbra.hides(target),
        }
    }

    fn hides_points(&mut self, points: &[Point3]) -> bool {
        match self.fault {
            FromRegionFault::OnePoint => !self.scene.is_free(middle(&self.volume), points[0]),
            FromRegionFault::HidesNothing => false,
            _ => self.umbra.hides_points(points),
        }
    }
}
