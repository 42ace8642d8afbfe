//! What a table holds, in full.

use crate::facts::{DigestFacts, DoorFacts, InfoFacts, ObjectPlace, StabFacts, write_doors};
use crate::summary::Summary;
use crate::words::{count, point};
use serde::Serialize;
use sightlines_frame::FrameFacts;
use sightlines_pvs::{CellRecord, ObjectId, Table};
use std::fmt;

/// What a table holds.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
pub struct TableInfo {
    #[serde(flatten)]
    /// Its numbers.
    pub summary: Summary,
    /// The box around its cells, its lower corner and its upper one, along the axes of the table; null for a table of a portal file.
    pub extent: Option<[[f64; 3]; 2]>,
    /// Its stab trees, if it has any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stab: Option<StabFacts>,
    /// Objects of which node and primitive are known.
    pub n_objects_with_source: usize,
    /// Its doors.
    pub doors: Vec<DoorFacts>,
    /// With `--objects`: all objects.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub objects: Option<Vec<ObjectFacts>>,
    /// Its frame, if it has one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub frame: Option<FrameFacts>,
    /// Digests of what the table was made of, as hexadecimal numbers of 128 bits; older tables have none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub digests: Option<DigestFacts>,
    /// Keys and values that the table has for people: how it was made. All values are texts.
    pub info: InfoFacts,
}

/// An object of a table.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
pub struct ObjectFacts {
    /// The object.
    pub id: u32,
    /// Its name.
    pub name: String,
    /// If it is known.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    pub source: Option<ObjectPlace>,
}

impl fmt::Display for ObjectFacts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "  {:>5} {}", self.id, self.name)?;
        self.source.iter().try_for_each(|source| write!(f, ", {source}"))
    }
}

/// Writes the line about the objects that can be found again, if there are any.
///
/// # Errors
/// Those of the writer.
pub fn write_sources(f: &mut fmt::Formatter<'_>, n: usize) -> fmt::Result {
    if n == 0 {
        return Ok(());
    }
    writeln!(f, "found again    {}, by node and primitive", count(n as u64, "object"))
}

/// The box around all cells.
fn extent_of(table: &Table) -> Option<[[f64; 3]; 2]> {
    let cells = Some(table.cells()).filter(|cells| table.has_places() && !cells.is_empty())?;
    let around = |end: fn(f64, f64) -> f64, corner: fn(&CellRecord) -> [f64; 3]| {
        let corners = cells.iter().map(corner);
        corners.reduce(|a, b| std::array::from_fn(|k| end(a[k], b[k]))).unwrap_or_default()
    };
    Some([around(f64::min, |cell| cell.min), around(f64::max, |cell| cell.max)])
}

impl TableInfo {
    /// Of a table; objects are listed only `with_objects`. Costs what [`Summary::of`] does, and twice the writing of a table with stab trees.
    pub fn of(table: &Table, with_objects: bool) -> Self {
        let mut summary = Summary::of(table);
        if table.kind().is_quake() {
            // The boxes are around portals, not around cells: volumes are unknown. Null in JSON.
            (summary.mean_floor_share, summary.floor) = (f64::NAN, f64::NAN);
        }
        let (stab, frame) = (StabFacts::of(table), table.frame().map(FrameFacts::from));
        let digests = table.digest().map(DigestFacts::from);
        let ids = || (0..table.objects().len() as u32).map(ObjectId);
        let object = |id: ObjectId| ObjectFacts {
            id: id.0,
            name: table.objects()[id.idx()].name.clone(),
            source: table.source_of(id).map(ObjectPlace::from),
        };
        Self {
            summary,
            extent: extent_of(table),
            stab,
            n_objects_with_source: ids().filter(|&id| table.source_of(id).is_some()).count(),
            doors: table.doors().iter().map(DoorFacts::from).collect(),
            objects: with_objects.then(|| ids().map(object).collect()),
            frame,
            digests,
            info: table.info().into(),
        }
    }
}

impl fmt::Display for TableInfo {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let dimension = self.summary.dimension;
        write!(f, "{}", self.summary)?;
        if let Some([low, high]) = self.extent {
            let [low, high] = [low, high].map(|corner| point(&corner[..usize::from(dimension)]));
            writeln!(f, "extent         {low} to {high}")?;
        }
        self.stab.iter().try_for_each(|stab| write!(f, "{stab}"))?;
        write_sources(f, self.n_objects_with_source)?;
        write_doors(f, &self.doors)?;
        self.objects.iter().flatten().try_for_each(|object| writeln!(f, "{object}"))?;
        self.frame.iter().try_for_each(|frame| writeln!(f, "frame          {frame}"))?;
        self.digests.iter().try_for_each(|digests| write!(f, "{digests}"))?;
        write!(f, "{}", self.info)
    }
}
