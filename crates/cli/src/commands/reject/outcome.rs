//! What is printed about REJECT lumps.

use crate::output::{JsonSchema, Serialize, count, percent, seconds_of};
use sightlines::bake::{MapOutcome, MapStatus};
use std::fmt;

/// What was done.
#[derive(Debug, Serialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum Outcome {
    Wad(WadOutcome),
    Folder(FolderOutcome),
}

/// What became of a folder.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct FolderOutcome {
    /// The folder that was written.
    pub(super) out: String,
    /// The WADs of the folder that was read, in the order of their names.
    pub(super) files: Vec<FileOutcome>,
    /// The largest memory in use; null if the system does not report it.
    pub(super) peak_bytes: Option<u64>,
}

/// WAD of a folder, and what became of it.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct FileOutcome {
    /// Name of the file.
    pub(super) name: String,
    /// The WAD that was written; null unless it was.
    pub(super) out: Option<String>,
    /// `written`, `skipped` (it has no maps, or none of those that were named) or `failed` (it cannot be done, or is no WAD; the others are).
    pub(super) status: FileStatus,
    /// Why it was not written; null if it was.
    pub(super) reason: Option<String>,
    /// The maps that were looked at; empty unless the file was written.
    pub(super) maps: Vec<Map>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(super) enum FileStatus {
    Written,
    /// It has no maps, or none of those that were named.
    Skipped,
    Failed,
}

/// What became of a WAD.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct WadOutcome {
    /// The WAD that was written.
    pub(super) out: String,
    /// The maps that were looked at.
    pub(super) maps: Vec<Map>,
    /// The largest memory in use; null if the system does not report it.
    pub(super) peak_bytes: Option<u64>,
}

/// Map with a REJECT lump.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct Map {
    /// Name of the map.
    name: String,
    /// `written`, `kept` (its table has effects made by hand), `skipped` (its format is not supported) or `failed` (it cannot be done; the other
    /// maps are).
    status: &'static str,
    /// Why it failed; null unless it did.
    reason: Option<String>,
    /// Sectors.
    n_sectors: u32,
    /// Ordered pairs of sectors that are rejected; this, `n_effects` and the numbers of cells, lines, crossings and pieces are null unless written.
    n_rejected: Option<u64>,
    /// Ordered pairs whose answer the option file of `--rmb` has changed.
    n_effects: Option<u64>,
    /// Cells in regions whose lines disagree about the sector.
    n_disputed_cells: Option<usize>,
    /// Lines whose ends are one point, which were left out.
    n_lines_without_length: Option<usize>,
    /// Crossings of lines whose point was rounded, towards visible.
    n_rounded_crossings: Option<usize>,
    /// Pieces of lines that block nothing because rounding could have closed a gap beside them.
    n_dropped_pieces: Option<usize>,
    /// Seconds for this map.
    seconds: f64,
}

impl From<&MapOutcome> for Map {
    fn from(outcome: &MapOutcome) -> Self {
        let (status, did) = match &outcome.status {
            MapStatus::Written(did) => ("written", Some(did)),
            MapStatus::KeptHandMade => ("kept", None),
            MapStatus::Failed(_) => ("failed", None),
            _ => ("skipped", None),
        };
        let reason = match &outcome.status {
            MapStatus::Failed(reason) => Some(reason.to_string()),
            _ => None,
        };
        Self {
            name: outcome.name.to_string(),
            status,
            reason,
            n_sectors: outcome.n_sectors,
            n_rejected: did.map(|d| d.n_rejected),
            n_effects: did.map(|d| d.n_effects),
            n_disputed_cells: did.map(|d| d.n_disputed_cells),
            n_lines_without_length: did.map(|d| d.n_lines_without_length),
            n_rounded_crossings: did.map(|d| d.n_rounded_crossings),
            n_dropped_pieces: did.map(|d| d.n_dropped_pieces),
            seconds: outcome.time.as_secs_f64(),
        }
    }
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Wad(outcome) => outcome.fmt(f),
            Self::Folder(outcome) => outcome.fmt(f),
        }
    }
}

fn n_built(maps: &[Map]) -> usize {
    maps.iter().filter(|map| map.status == "written").count()
}

impl fmt::Display for WadOutcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for map in &self.maps {
            writeln!(f, "{map}")?;
        }
        let maps = count(self.maps.len() as u64, "map");
        writeln!(f, "wrote {}: {} of {maps} built", self.out, n_built(&self.maps))
    }
}

impl fmt::Display for FolderOutcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for FileOutcome { name, status, reason, maps, .. } in &self.files {
            let reason = reason.as_deref().unwrap_or_default();
            match status {
                FileStatus::Written => writeln!(f, "{name}:")?,
                FileStatus::Skipped => writeln!(f, "{name}: skipped: {reason}")?,
                FileStatus::Failed => writeln!(f, "{name}: not done: {reason}")?,
            }
            maps.iter().try_for_each(|map| writeln!(f, "  {map}"))?;
        }
        let written = self.files.iter().filter(|file| file.status == FileStatus::Written).count();
        let built: usize = self.files.iter().map(|file| n_built(&file.maps)).sum();
        let n_maps: usize = self.files.iter().map(|file| file.maps.len()).sum();
        let (files, maps) = (count(self.files.len() as u64, "WAD"), count(n_maps as u64, "map"));
        writeln!(f, "wrote {}: {written} of {files}, with {built} of {maps} built", self.out)
    }
}

impl fmt::Display for Map {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:<8} ", self.name)?;
        match (self.status, self.n_rejected) {
            (_, Some(n)) => {
                let pairs = (f64::from(self.n_sectors) * f64::from(self.n_sectors)).max(1.0);
                let time = seconds_of(self.seconds);
                write!(f, "{:>5} sectors, {:>7} of pairs rejected, {time}", self.n_sectors, percent(n as f64 / pairs))?;
                match self.n_effects {
                    Some(n @ 1..) => write!(f, ", {} changed by effects", count(n, "pair")),
                    _ => Ok(()),
                }
            }
            ("failed", _) => write!(f, "failed: {}", self.reason.as_deref().unwrap_or_default()),
            ("kept", _) => f.write_str("kept: its table has effects made by hand (--force replaces it)"),
            _ => f.write_str("skipped: its format is not supported"),
        }
    }
}
