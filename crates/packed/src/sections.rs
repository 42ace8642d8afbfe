//! The sections that both size classes have.

use crate::format::{
    self, SINCE_CELL_NAMES, SINCE_DIGEST, SINCE_FRAME, SINCE_KIND, SINCE_OBJECT_PARTS, SINCE_SOURCES_DOORS,
};
use crate::write;
use sightlines_pvs::format::kind_section;
use sightlines_pvs::{SectionId, TableParts};

/// Those sections, in any order.
pub(crate) fn frame_sections(parts: &TableParts) -> Vec<(SectionId, Vec<u8>)> {
    let mut sections = Vec::new();
    if let Some(planes) = &parts.planes {
        sections.push((format::PLANES, write::planes(planes)));
    }
    if !parts.mirrors.is_empty() {
        sections.push((format::MIRRORS, write::mirrors(parts)));
    }
    if let Some(kind) = kind_section(parts.dimension, parts.kind, parts.up, &parts.info) {
        sections.push((format::KIND, kind.to_vec()));
    }
    if let Some(frame) = &parts.frame {
        sections.push((format::FRAME, frame.to_bytes().to_vec()));
    }
    if let Some(digest) = &parts.digest {
        sections.push((format::DIGEST, digest.to_bytes().to_vec()));
    }
    if !parts.object_sources.is_empty() {
        sections.push((format::SOURCES, write::sources(&parts.object_sources)));
    }
    if !parts.doors.is_empty() {
        sections.push((format::DOORS, write::doors(&parts.doors)));
    }
    if let Some(of_objects) = &parts.object_parts {
        sections.push((format::OBJECT_PARTS, write::object_parts(&of_objects.parts)));
    }
    sections.push((format::INFO, write::info(&parts.info)));
    sections
}

/// The minor version that a table with these sections needs.
pub(crate) fn minor(parts: &TableParts, sections: &[(SectionId, Vec<u8>)]) -> u16 {
    let has = |section: SectionId| sections.iter().any(|(id, ..)| *id == section);
    let needed = [
        (!parts.cell_names.is_empty(), SINCE_CELL_NAMES),
        (has(format::KIND), SINCE_KIND),
        (has(format::FRAME), SINCE_FRAME),
        (has(format::DIGEST), SINCE_DIGEST),
        (has(format::SOURCES) || has(format::DOORS), SINCE_SOURCES_DOORS),
        (has(format::OBJECT_PARTS), SINCE_OBJECT_PARTS),
    ];
    needed.into_iter().filter(|(there, _)| *there).map(|(_, since)| since).max().unwrap_or(0)
}
