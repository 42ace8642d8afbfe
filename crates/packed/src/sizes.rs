//! The size of each part of a file.

use crate::packed::Packed;
use crate::source::Source;
use sightlines_pvs::SectionId;

/// A part of a packed file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PartSize {
    /// The section or store; see [`crate::format`](mod@crate::format).
    pub id: SectionId,
    /// Its bytes in the file.
    pub bytes: u64,
    /// Whether it stays in memory (a section), or is read block by block (a store).
    pub resident: bool,
}

impl<S: Source> Packed<S> {
    /// The known sections and then stores that exist, in the order of the file. Together with the header and the
    /// section table these are all bytes of a file of this version. O(blocks).
    pub fn part_sizes(&self) -> Vec<PartSize> {
        let sections = self.resident.sizes().map(|(id, bytes)| PartSize { id, bytes, resident: true });
        let stores = self.index.sizes().map(|(id, bytes)| PartSize { id, bytes, resident: false });
        sections.chain(stores).collect()
    }
}
