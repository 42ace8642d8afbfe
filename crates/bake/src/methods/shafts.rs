//! View shafts as a method by name.

use super::{Entry, Prepared, welded};
use sightlines_from_region::ViewShafts;
use sightlines_multifocal::FromRegion;
use sightlines_multifocal::mesh::{PatchOptions, patches_of};

pub(super) const ENTRY: Entry = Entry {
    name: "shafts",
    about: "One flat piece that cuts the whole shaft between a volume and a target",
    prepare: |scene, _| Ok(Box::new(ViewShafts::new(patches_of(&welded(scene), &PatchOptions::default())))),
};

impl Prepared for ViewShafts {
    fn instance(&self) -> Box<dyn FromRegion + Send> {
        Box::new(self.clone())
    }
}
