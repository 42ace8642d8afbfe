//! What a WAD holds.

use crate::error::Result;
use crate::output::{JsonSchema, Serialize, count, percent};
use sightlines::formats::doom::{DoomMap, MapLumps, list_maps};
use sightlines::formats::wad::WadKind;
use sightlines::formats::{RejectTable, Wad};
use std::fmt;
use std::path::Path;

/// The numbers of a WAD.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct WadInfo {
    /// The file.
    file: String,
    /// `iwad` or `pwad`.
    kind: &'static str,
    /// Lumps.
    n_lumps: usize,
    /// The maps.
    maps: Vec<MapInfo>,
}

/// Map of a WAD; its numbers are null if it is damaged.
#[derive(Debug, Serialize, JsonSchema)]
struct MapInfo {
    /// Name of the map.
    name: String,
    /// Format of the map.
    format: String,
    /// Sectors; this, `n_lines` and `n_things` are null if the map is damaged.
    n_sectors: Option<u32>,
    /// Lines.
    n_lines: Option<usize>,
    /// Things.
    n_things: Option<usize>,
    /// The REJECT lump: `none`, `empty` (nothing rejected), `odd size`, `hand-made` (effects that no line of sight explains) or `built`; null if the
    /// map is damaged.
    reject: Option<&'static str>,
    /// Ordered pairs that it rejects; null without a sound lump.
    n_rejected: Option<u64>,
    /// Why the map cannot be used; null if it can.
    error: Option<String>,
}

impl WadInfo {
    pub(super) fn read(path: &Path) -> Result<Self> {
        let wad = Wad::read(path)?;
        let kind = if wad.kind() == WadKind::Game { "iwad" } else { "pwad" };
        let maps = list_maps(&wad).iter().map(|lumps| map(&wad, lumps)).collect();
        Ok(Self { file: path.display().to_string(), kind, n_lumps: wad.lumps().len(), maps })
    }
}

fn map(wad: &Wad, lumps: &MapLumps) -> MapInfo {
    let mut info = MapInfo {
        name: lumps.name().to_string(),
        format: lumps.format().to_string(),
        n_sectors: None,
        n_lines: None,
        n_things: None,
        reject: None,
        n_rejected: None,
        error: None,
    };
    match DoomMap::parse(wad, lumps) {
        Err(error) => {
            // Without the name of the map, which stands beside it.
            let text = error.to_string();
            let name = format!("map {}: ", lumps.name());
            info.error = Some(text.strip_prefix(&name).unwrap_or(&text).to_owned());
        }
        Ok(map) => {
            info.n_sectors = Some(map.n_sectors());
            info.n_lines = Some(map.lines().len());
            info.n_things = Some(map.things().len());
            (info.reject, info.n_rejected) = reject(&map);
        }
    }
    info
}

fn reject(map: &DoomMap) -> (Option<&'static str>, Option<u64>) {
    let Some(lump) = map.reject() else { return (Some("none"), None) };
    let Ok(table) = RejectTable::from_bytes(map.n_sectors(), lump) else { return (Some("odd size"), None) };
    let kind = match table.n_rejected() {
        0 => "empty",
        _ if table.has_hand_made_effects() => "hand-made",
        _ => "built",
    };
    (Some(kind), Some(table.n_rejected()))
}

impl fmt::Display for WadInfo {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let kind = self.kind.to_ascii_uppercase();
        let [lumps, maps] = [(self.n_lumps, "lump"), (self.maps.len(), "map")].map(|(n, what)| count(n as u64, what));
        writeln!(f, "{}: {kind} with {lumps} and {maps}", self.file)?;
        self.maps.iter().try_for_each(|map| writeln!(f, "{map}"))
    }
}

impl fmt::Display for MapInfo {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:<8} {:<5}", self.name, self.format)?;
        if let Some(error) = &self.error {
            return write!(f, " cannot be used: {error}");
        }
        let (sectors, lines) = (self.n_sectors.unwrap_or(0), self.n_lines.unwrap_or(0));
        write!(f, " {sectors:>5} sectors {lines:>6} lines {:>5} things", self.n_things.unwrap_or(0))?;
        match (self.reject, self.n_rejected) {
            (Some("built" | "hand-made"), Some(n)) => {
                let pairs = f64::from(sectors) * f64::from(sectors);
                let made = if self.reject == Some("hand-made") { ", with effects made by hand" } else { "" };
                write!(f, "   REJECT {}{made}", percent(n as f64 / pairs))
            }
            (Some(kind), _) => write!(f, "   REJECT {kind}"),
            (None, _) => Ok(()),
        }
    }
}
