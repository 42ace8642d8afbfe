//! The multifocal z-buffer as a method that says what is hidden from a volume.

use crate::{
    BackendError, Buffer, FromRegion, Guarantee, Layout, MultifocalBackend, Occluder, Surround, Surrounded, Umbra,
    Volume,
};
use sightlines_geometry::{Aabb, Point3};

/// Buffers all around a volume, filled by a backend.
#[derive(Debug)]
pub struct Multifocal<B> {
    backend: B,
    occluders: Vec<Occluder>,
    scene: Aabb<3>,
    layout: Layout,
    buffers: [Vec<Buffer>; 6],
    surround: Option<Surround>,
}

impl<B: MultifocalBackend> Multifocal<B> {
    /// * `occluders`: what hides
    /// * `scene`: the box of everything that is asked about
    pub fn new(backend: B, occluders: Vec<Occluder>, scene: Aabb<3>, layout: Layout) -> Self {
        Self { backend, occluders, scene, layout, buffers: Default::default(), surround: None }
    }
}

impl<B: MultifocalBackend> FromRegion for Multifocal<B> {
    fn name(&self) -> String {
        let carried = if self.layout.reproject { "-sweep" } else { "" };
        format!("multifocal-{}{carried}-{}", self.layout.measure.name(), self.layout.n_levels)
    }

    fn guarantee(&self) -> Guarantee {
        Guarantee::Conservative
    }

    fn umbra(&mut self, volume: &Volume) -> Result<Box<dyn Umbra + '_>, BackendError> {
        // Around a volume so far away from everything, or so large, that no planes fit, nothing is known.
        let Ok(surround) = Surround::new(volume, &self.scene, &self.layout) else { return Ok(Box::new(Nothing)) };
        let surround = &*self.surround.insert(surround);
        let mut units = [1.0; 6];
        for (side, unit) in units.iter_mut().enumerate() {
            let Ok(job) = surround.job(side, &self.occluders) else { return Ok(Box::new(Nothing)) };
            *unit = job.unit();
            self.backend.render(&job, &mut self.buffers[side])?;
        }
        Ok(Box::new(Surrounded::new(surround, &self.buffers, units)))
    }
}

impl Umbra for Surrounded<'_> {
    fn hides(&mut self, target: &Aabb<3>) -> bool {
        Surrounded::hides(self, target)
    }

    fn hides_points(&mut self, points: &[Point3]) -> bool {
        Surrounded::hides_points(self, points)
    }
}

/// Hides nothing.
#[derive(Debug)]
struct Nothing;

impl Umbra for Nothing {
    fn hides(&mut self, _: &Aabb<3>) -> bool {
        false
    }
}
