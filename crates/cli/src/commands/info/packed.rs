//! What a packed table holds, without unpacking it.

use crate::error::{ErrorAbout, Result};
use crate::output::{JsonSchema, Serialize, bytes, percent};
use crate::tables;
use sightlines::packed::{PartSize, SizeClass};
use sightlines::pvs::ObjectId;
use sightlines::report::{
    DigestFacts, DoorFacts, FrameFacts, InfoFacts, ObjectFacts, ObjectPlace, write_doors, write_sources,
};
use std::fmt;
use std::path::Path;

/// Bytes of blocks that are kept while objects are listed.
const CACHE: usize = 1 << 20;

/// What a packed table holds.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct PackedInfo {
    /// The file.
    file: String,
    /// `packed`.
    kind: &'static str,
    /// Layout of the file, `small` or `large`.
    class: &'static str,
    /// 2 in the plane, 3 in space.
    dimension: u8,
    /// Bytes of the file.
    n_bytes: u64,
    /// Cells.
    n_cells: usize,
    /// Whether the cells have names.
    has_cell_names: bool,
    /// Portals.
    n_portals: usize,
    /// Objects.
    n_objects: usize,
    /// Nodes of stab trees; null without stab trees.
    n_stab_nodes: Option<u32>,
    /// Parts of mirrors on borders of cells.
    n_mirror_parts: usize,
    /// Objects of which node and primitive are known.
    n_objects_with_source: usize,
    /// Its doors.
    doors: Vec<DoorFacts>,
    /// With `--objects`: all objects.
    #[serde(skip_serializing_if = "Option::is_none")]
    objects: Option<Vec<ObjectFacts>>,
    /// Bytes that stay in memory as they are in the file.
    resident_bytes: usize,
    /// The parts of the file.
    parts: Vec<Part>,
    /// Its frame, if it has one.
    #[serde(skip_serializing_if = "Option::is_none")]
    frame: Option<FrameFacts>,
    /// Digests of what the table was made of, as hexadecimal numbers of 128 bits; older tables have none.
    #[serde(skip_serializing_if = "Option::is_none")]
    digests: Option<DigestFacts>,
    /// As in a table.
    info: InfoFacts,
}

/// A part of the file.
#[derive(Debug, Serialize, JsonSchema)]
struct Part {
    /// Name of the part.
    name: String,
    /// What it is, for people.
    what: &'static str,
    /// Its size.
    n_bytes: u64,
    /// Whether it stays in memory.
    resident: bool,
}

impl PackedInfo {
    pub(super) fn read(path: &Path, with_objects: bool) -> Result<Self> {
        let packed = tables::packed(path, if with_objects { CACHE } else { 0 })?;
        let (mut n_objects_with_source, mut objects) = (0, Vec::new());
        for id in (0..packed.n_objects() as u32).map(ObjectId) {
            let source = packed.source_of(id).in_file(path)?.map(ObjectPlace::from);
            n_objects_with_source += usize::from(source.is_some());
            if with_objects {
                objects.push(ObjectFacts { id: id.0, name: packed.object_name(id).in_file(path)?, source });
            }
        }
        let part = |part: PartSize| Part {
            name: part.id.to_string(),
            what: part.about(),
            n_bytes: part.bytes,
            resident: part.resident,
        };
        Ok(Self {
            file: path.display().to_string(),
            kind: "packed",
            class: packed.size_class().name(),
            dimension: packed.dimension(),
            n_bytes: std::fs::metadata(path).in_file(path)?.len(),
            n_cells: packed.n_cells(),
            has_cell_names: packed.has_cell_names(),
            n_portals: packed.n_portals(),
            n_objects: packed.n_objects(),
            n_stab_nodes: packed.n_stab_nodes(),
            n_mirror_parts: packed.mirrors().len(),
            n_objects_with_source,
            doors: packed.doors().iter().map(DoorFacts::from).collect(),
            objects: with_objects.then_some(objects),
            resident_bytes: packed.resident_bytes(),
            parts: packed.part_sizes().into_iter().map(part).collect(),
            frame: packed.frame().map(FrameFacts::from),
            digests: packed.digest().map(DigestFacts::from),
            info: packed.info().into(),
        })
    }
}

impl fmt::Display for PackedInfo {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let large = if self.class == SizeClass::Large.name() { "large " } else { "" };
        let n_bytes = bytes(self.n_bytes);
        writeln!(f, "{}: {large}packed visibility table in {}D, {n_bytes}", self.file, self.dimension)?;
        let names = if self.has_cell_names { ", with names" } else { "" };
        writeln!(
            f,
            "cells          {}{names}\nportals        {}\nobjects        {}",
            self.n_cells, self.n_portals, self.n_objects
        )?;
        if let Some(nodes) = self.n_stab_nodes {
            writeln!(f, "stab trees     {nodes} nodes")?;
        }
        if self.n_mirror_parts > 0 {
            writeln!(f, "mirrors        {} parts in cells", self.n_mirror_parts)?;
        }
        write_sources(f, self.n_objects_with_source)?;
        write_doors(f, &self.doors)?;
        self.objects.iter().flatten().try_for_each(|object| writeln!(f, "{object}"))?;
        writeln!(f, "in memory      {}, the rest is read on demand", bytes(self.resident_bytes as u64))?;
        for Part { name, what, n_bytes, resident } in &self.parts {
            let share = percent(*n_bytes as f64 / self.n_bytes.max(1) as f64);
            let held = if *resident { ", in memory" } else { "" };
            writeln!(f, "  {name}         {n_bytes:>10} bytes {share:>8}  {what}{held}")?;
        }
        self.frame.iter().try_for_each(|frame| writeln!(f, "frame          {frame}"))?;
        self.digests.iter().try_for_each(|digests| write!(f, "{digests}"))?;
        write!(f, "{}", self.info)
    }
}
