//! The multifocal z-buffer as a from-region method.

use crate::mesh::Chooser;
use crate::{
    BackendError, Buffer, BufferPlane, FromRegion, Guarantee, Layout, MultifocalBackend, Occluder, Surround,
    Surrounded, Umbra, Volume,
};
use sightlines_geometry::{Aabb, Point3};
use std::sync::Arc;

/// Buffers all around a volume, filled by a backend.
#[derive(Debug)]
pub struct Multifocal<B> {
    backend: B,
    occluders: Arc<OccluderSelection>,
    scene: Aabb<3>,
    layout: Layout,
    buffers: [Vec<Buffer>; 6],
    surround: Option<Surround>,
}

impl<B: MultifocalBackend> Multifocal<B> {
    /// * `occluders`: the occluders to select from
    /// * `scene`: the box of everything that will be tested
    pub fn new(backend: B, occluders: Arc<OccluderSelection>, scene: Aabb<3>, layout: Layout) -> Self {
        Self { backend, occluders, scene, layout, buffers: Default::default(), surround: None }
    }
}

impl<B: MultifocalBackend> FromRegion for Multifocal<B> {
    fn name(&self) -> String {
        let carried = if self.layout.carry { "-sweep" } else { "" };
        format!("multifocal-{}{carried}-{}", self.layout.measure.name(), self.layout.planes)
    }

    fn guarantee(&self) -> Guarantee {
        Guarantee::Conservative
    }

    fn umbra(&mut self, volume: &Volume) -> Result<Box<dyn Umbra + '_>, BackendError> {
        // Around a volume so far away from everything, or so large, that no planes fit, nothing is known.
        let Ok(surround) = Surround::new(volume, &self.scene, &self.layout) else { return Ok(Box::new(Nothing)) };
        let surround = &*self.surround.insert(surround);
        let mut units = [1.0; 6];
        let farthest =
            surround.directions().each_ref().map(|d| d.planes.last().expect("there is a plane on each side"));
        let chosen = self.occluders.choose(volume, farthest);
        for (side, unit) in units.iter_mut().enumerate() {
            let occluders = chosen[side].iter().map(|&i| &self.occluders.occluders[i as usize]);
            let Ok(job) = surround.job(side, occluders) else {
                return Ok(Box::new(Nothing));
            };
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

/// Occluders from which some are selected for each volume and side: those that seem to hide most. Any selection is
/// sound.
#[derive(Debug)]
pub struct OccluderSelection {
    occluders: Vec<Occluder>,
    chooser: Chooser,
    most: usize,
}

impl OccluderSelection {
    /// At most `most` occluders are drawn on each side of a volume.
    pub fn new(occluders: Vec<Occluder>, most: usize) -> Self {
        Self { chooser: Chooser::new(&occluders), occluders, most }
    }

    /// All of them.
    pub fn occluders(&self) -> &[Occluder] {
        &self.occluders
    }

    /// For each of the planes around a volume.
    fn choose(&self, volume: &Volume, planes: [&BufferPlane; 6]) -> [Vec<u32>; 6] {
        self.chooser.select_for(volume, planes, self.most)
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
