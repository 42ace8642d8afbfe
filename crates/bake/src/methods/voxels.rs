//! Voxels with blocker extension as a method by name.

use super::{Entry, Prepared};
use sightlines_from_region::{VoxelOptions, Voxels};
use sightlines_multifocal::FromRegion;

pub(super) const ENTRY: Entry = Entry {
    name: "voxels",
    about: "Voxels inside closed surfaces, extended to blockers",
    prepare: |scene, _| {
        let voxels = Voxels::new(scene, VoxelOptions::default());
        Ok(Box::new(voxels.expect("the default number of voxels is within limits")))
    },
};

impl Prepared for Voxels {
    fn instance(&self) -> Box<dyn FromRegion + Send> {
        Box::new(self.clone())
    }
}
