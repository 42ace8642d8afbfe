//! What a packed table holds, without unpacking it.

use super::Error;
use super::as_map;
use crate::error::InputError;
use crate::facts::{DigestFacts, FrameFacts};
use crate::output::{bytes, percent};
use crate::tables;
use serde::Serialize;
use std::fmt;
use std::path::Path;

/// The numbers of a packed table.
#[derive(Debug, Serialize)]
pub(super) struct PackedInfo {
    file: String,
    kind: &'static str,
    dimension: u8,
    n_bytes: u64,
    n_cells: usize,
    has_cell_names: bool,
    n_portals: usize,
    n_objects: usize,
    /// Null without stab trees.
    n_stab_nodes: Option<u32>,
    n_mirror_parts: usize,
    /// Bytes that stay in memory as they are in the file.
    resident_bytes: usize,
    parts: Vec<Part>,
    /// If the table stands along axes of its own.
    #[serde(skip_serializing_if = "Option::is_none")]
    frame: Option<FrameFacts>,
    /// If the table has any.
    #[serde(skip_serializing_if = "Option::is_none")]
    digests: Option<DigestFacts>,
    /// How the table was made, as it states.
    #[serde(serialize_with = "as_map")]
    info: Vec<(String, String)>,
}

/// A part of the file.
#[derive(Debug, Serialize)]
struct Part {
    name: String,
    /// What it is, for people.
    what: &'static str,
    n_bytes: u64,
    resident: bool,
}

/// What the parts are.
const PARTS: [(&str, &str); 22] = [
    ("HEAD", "numbers"),
    ("BOXS", "boxes of cells"),
    ("POLY", "corners of cells"),
    ("LOCA", "tree to find cells"),
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
    ("BLKS", "index of blocks"),
    ("ROWS", "cells seen"),
    ("SEEN", "objects seen"),
    ("CELL", "exits, objects in cells"),
    ("PORT", "portals"),
    ("OBJS", "objects"),
    ("STAB", "stab trees"),
    ("CNAM", "names of cells"),
];

impl PackedInfo {
    pub(super) fn read(path: &Path) -> Result<Self, Error> {
        let packed = tables::packed(path, 0)?;
        let part = |part: sightlines::packed::PartSize| {
            let name = part.id.to_string();
            let what = PARTS.iter().find(|(known, _)| *known == name).map_or("unknown", |(_, what)| what);
            Part { name, what, n_bytes: part.bytes, resident: part.resident }
        };
        let open = |source| InputError::Open { path: path.to_owned(), source };
        Ok(Self {
            file: path.display().to_string(),
            kind: "packed",
            dimension: packed.dimension(),
            n_bytes: std::fs::metadata(path).map_err(open)?.len(),
            n_cells: packed.n_cells(),
            has_cell_names: packed.has_cell_names(),
            n_portals: packed.n_portals(),
            n_objects: packed.n_objects(),
            n_stab_nodes: packed.n_stab_nodes(),
            n_mirror_parts: packed.mirrors().len(),
            resident_bytes: packed.resident_bytes(),
            parts: packed.part_sizes().into_iter().map(part).collect(),
            frame: packed.frame().map(FrameFacts::from),
            digests: packed.digest().map(DigestFacts::from),
            info: packed.info().to_vec(),
        })
    }
}

impl fmt::Display for PackedInfo {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}: packed visibility table in {}D, {}", self.file, self.dimension, bytes(self.n_bytes))?;
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
        writeln!(f, "in memory      {}, the rest is read on demand", bytes(self.resident_bytes as u64))?;
        for Part { name, what, n_bytes, resident } in &self.parts {
            let share = percent(*n_bytes as f64 / self.n_bytes.max(1) as f64);
            let held = if *resident { ", in memory" } else { "" };
            writeln!(f, "  {name}         {n_bytes:>10} bytes {share:>8}  {what}{held}")?;
        }
        self.frame.iter().try_for_each(|frame| writeln!(f, "frame          {frame}"))?;
        self.digests.iter().try_for_each(|digests| write!(f, "{digests}"))?;
        self.info.iter().try_for_each(|(key, value)| writeln!(f, "{key:<14} {value}"))
    }
}
