//! The size of each part of a file.

use crate::packed::Packed;
use crate::source::ByteSource;
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

/// What the parts are, by their names.
const PARTS: [(&str, &str); 28] = [
    ("HEAD", "numbers"),
    ("BOXS", "boxes of cells"),
    ("POLY", "corners of cells"),
    ("LOCA", "tree to find cells"),
    ("LOCT", "top of a tree to find cells"),
    ("PLAN", "planes to find cells"),
    ("MIRR", "mirrors"),
    ("FRAM", "axes of its own"),
    ("KIND", "kind of its subdivision"),
    ("INFO", "how it was made"),
    ("COAR", "coarse visibility"),
    ("CLAS", "equal rows"),
    ("SCLR", "equal rows of objects"),
    ("SCLC", "equal objects"),
    ("DGST", "digests of the scene"),
    ("OSRC", "objects in their file"),
    ("DOOR", "doors"),
    ("OPRT", "parts of objects"),
    ("BLKS", "index of blocks"),
    ("ROWS", "cells seen"),
    ("SEEN", "objects seen"),
    ("PSEN", "parts seen"),
    ("CELL", "exits, objects in cells"),
    ("PORT", "portals"),
    ("OBJS", "objects"),
    ("STAB", "stab trees"),
    ("CNAM", "names of cells"),
    ("PLAC", "pages of a tree to find cells"),
];

impl PartSize {
    /// What it is, in words; `unknown` for a part of a later version.
    pub fn about(&self) -> &'static str {
        PARTS.iter().find(|(name, _)| name.as_bytes() == self.id.0).map_or("unknown", |(_, what)| what)
    }
}

impl<S: ByteSource> Packed<S> {
    /// The known sections and then stores that exist, in the order of the file. Together with the header and the
    /// section table these are all bytes of a file of this version. O(blocks).
    pub fn part_sizes(&self) -> Vec<PartSize> {
        let sections = self.resident.sizes().map(|(id, bytes)| PartSize { id, bytes, resident: true });
        let stores = self.index.sizes().map(|(id, bytes)| PartSize { id, bytes, resident: false });
        sections.chain(stores).collect()
    }
}
