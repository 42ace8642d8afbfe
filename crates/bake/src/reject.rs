//! REJECT lumps: which sectors of a Doom map cannot see each other.
//!
//! # The flat model
//! Sight ignores heights. A line lets sight through if it is marked two-sided, if it has a left side and the engine is not known to be one of Doom
//! ([`RejectOptions::game`]), and if it is of a polyobject; nothing else about it matters, because doors and lifts move and a REJECT bit cannot. The map's regions are the
//! faces of the arrangement of all its lines; a region belongs to every sector that a side facing it
//! names. Sector A sees sector B if an open set of segments without a closed one-sided line in their way
//! leads from a region of A into a region of B.
//!
//! That rule covers the known special cases without exceptions:
//! * a *self-referencing* sector, whose lines have it on both sides, is a region of its own inside the
//!   lines and shares the region outside with the sector around it; it sees and is seen from both;
//! * an *unclosed* sector shares its region with whatever it leaks into;
//! * a two-sided line with a *missing side* lets sight through like any other, into a region that other
//!   lines may name;
//! * a sector without lines has no region: it sees itself and nothing else;
//! * a line whose ends are one point is no line, and is counted.
//!
//! # Effects made by hand
//! A table that is not symmetric, or that rejects a sector from itself, was not computed: mappers build
//! blind or deaf monsters that way. Such a table is kept unless the caller insists, or says itself which effects there are
//! ([`RejectOptions::rmb`]).

mod kept;
mod wads;

pub use wads::{RejectMaps, RejectTables, RejectWadsError, reject_wad, reject_wads};

use crate::error::BakeError;
use crate::sectors::see_groups;
use sightlines_formats::doom::{DoomMap, Game, MapFormat, MapLumps, RmbFile};
use sightlines_formats::{LumpName, Malformed, RejectTable, Wad, WadError};
use sightlines_progress::{Halt, Observer, Units};
use sightlines_pvs::BitMatrix;
use sightlines_stabtree::SearchOptions;
use std::time::Duration;

/// How to build REJECT lumps.
#[derive(Clone, Default)]
pub struct RejectOptions<'a> {
    /// Names of the maps to do; all if empty.
    pub maps: Vec<String>,
    /// Replace tables with effects made by hand too.
    pub force: bool,
    /// One map that cannot be done is an error; otherwise the others are done.
    pub strict: bool,
    /// The game that the tables are for, unless a map's format says it; without one they are right for every engine ([`DoomMap::plan_for`]).
    pub game: Option<Game>,
    /// Effects to make in the tables that are built. The tables of maps that it has effects on are replaced, whatever they are.
    pub rmb: Option<&'a RmbFile>,
    /// Number of threads; 0 for one for each core. Changes nothing but the time.
    pub threads: usize,
    /// Called with the number of finished zones of a map and their total; the share is that of all maps.
    pub progress: Option<&'a dyn Observer>,
    /// Where results of units of work, which are maps, are kept. Changes nothing but who computes what.
    pub units: Units<'a>,
}

impl std::fmt::Debug for RejectOptions<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("RejectOptions")
            .field("maps", &self.maps)
            .field("force", &self.force)
            .field("strict", &self.strict)
            .field("game", &self.game)
            .field("rmb", &self.rmb)
            .field("threads", &self.threads)
            .finish_non_exhaustive()
    }
}

/// Why REJECT lumps could not be built.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RejectError {
    /// The file has no maps.
    #[error("the file has no maps")]
    NoMaps,
    /// A map that was named is not in the file.
    #[error("map {0} is not in the file")]
    NoSuchMap(String),
    /// A map is damaged, or in a format whose geometry is not read.
    #[error(transparent)]
    Map(#[from] Malformed),
    /// A map has nothing to cut.
    #[error("map {map}: {kind}")]
    Bake {
        /// Its name.
        map: LumpName,
        /// Why.
        #[source]
        kind: BakeError,
    },
    /// An effect names a sector that is not there.
    #[error(transparent)]
    Rmb(Malformed),
    /// The new file cannot be laid out.
    #[error(transparent)]
    Write(#[from] WadError),
    /// The store of units ends the work: it keeps what was done, and the rest is for others or later.
    #[error(transparent)]
    Halted(#[from] Halt),
    /// The file has other maps than those that were to be done.
    #[error("the maps of the file are not what they were when the work began")]
    Changed,
    /// The store of units has something else than the result of a map.
    #[error("map {0}: what was kept of it is damaged")]
    Kept(LumpName),
}

/// What became of the file.
#[derive(Debug, Clone, PartialEq)]
pub struct RejectOutcome {
    /// The new file.
    pub bytes: Vec<u8>,
    /// What became of each requested map, in file order.
    pub maps: Vec<MapOutcome>,
}

/// What became of one map.
#[derive(Debug, Clone, PartialEq)]
pub struct MapOutcome {
    /// Its name.
    pub name: LumpName,
    /// Number of sectors; 0 if the map was not read.
    pub n_sectors: u32,
    /// What was done.
    pub status: MapStatus,
    /// How long it took.
    pub time: Duration,
}

/// What was done with one map.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum MapStatus {
    /// Its table was built and written.
    Written(RejectSummary),
    /// Its table has effects made by hand and was kept.
    KeptHandMade,
    /// Its format is not read; its lumps were kept.
    SkippedUnsupported,
    /// It cannot be done; its lumps were kept.
    Failed(Box<RejectError>),
}

/// A table in numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct RejectSummary {
    /// Ordered pairs of sectors that are rejected.
    pub n_rejected: u64,
    /// Ordered pairs of sectors whose answer effects have changed ([`RejectOptions::rmb`]).
    pub n_effects: u64,
    /// Cells in regions whose lines disagree about the sector.
    pub n_disputed_cells: usize,
    /// Lines without length, which were left out.
    pub n_lines_without_length: usize,
    /// Crossings of lines that had to be rounded.
    pub n_rounded_crossings: usize,
    /// Pieces of one-sided lines that do not block, because rounding could have closed a gap with them.
    pub n_dropped_pieces: usize,
}

/// Builds the REJECT table of one map. Symmetric; no sector is rejected from itself. Exact in the flat
/// model of this [module](self) but for rounded crossings, which err towards visible. Makes no effects.
///
/// # Errors
/// [`RejectError::Bake`] if the map has no lines.
pub fn reject_table(map: &DoomMap, options: &RejectOptions<'_>) -> Result<(RejectTable, RejectSummary), RejectError> {
    let bake = |kind: BakeError| RejectError::Bake { map: map.name(), kind };
    let plan = map.plan_for(options.game).map_err(|kind| bake(kind.into()))?;
    let search = SearchOptions { threads: options.threads, progress: options.progress, ..SearchOptions::default() };
    let (seen, cut) = see_groups(&plan, map.n_sectors(), &search).map_err(bake)?;
    let table = table_of(&seen, map.n_sectors());
    let summary = RejectSummary {
        n_rejected: table.n_rejected(),
        n_effects: 0,
        n_disputed_cells: cut.n_disputed_cells,
        n_lines_without_length: map.n_lines_without_length(),
        n_rounded_crossings: cut.n_rounded_crossings,
        n_dropped_pieces: cut.n_dropped_pieces,
    };
    Ok((table, summary))
}

fn table_of(seen: &BitMatrix, n_sectors: u32) -> RejectTable {
    RejectTable::from_seen_rows(n_sectors, (0..n_sectors as usize).map(|viewer| seen.row(viewer)))
}

fn is_readable(map: &MapLumps) -> bool {
    map.format() != MapFormat::Console
}

/// How many bytes a table may have behind its end: less than what some tools fill lumps up to.
const PADDING: usize = 4;

/// The table of a lump, which may be padded. `None` for one of any other length: it is of the map as it was before a sector came or went, and read as that of
/// this one it would be taken for one with effects.
fn old_table(n_sectors: u32, bytes: &[u8]) -> Option<RejectTable> {
    let (table, rest) = bytes.split_at_checked(usize::try_from(RejectTable::byte_len(n_sectors)).ok()?)?;
    let is_padding = rest.len() < PADDING && rest.iter().all(|&byte| byte == 0);
    if is_padding { RejectTable::from_bytes(n_sectors, table).ok() } else { None }
}

type Done = (u32, MapStatus, Option<Vec<u8>>);

/// Does one map; with `insist`, one in a format that is not read is an error.
fn do_map(wad: &Wad, lumps: &MapLumps, insist: bool, options: &RejectOptions<'_>) -> Result<Done, RejectError> {
    if !is_readable(lumps) && !insist {
        return Ok((0, MapStatus::SkippedUnsupported, None));
    }
    let map = DoomMap::parse(wad, lumps)?;
    let n = map.n_sectors();
    let old = map.reject().and_then(|bytes| old_table(n, bytes));
    let rmb = options.rmb.filter(|rmb| rmb.is_for(lumps.name()));
    if !options.force && rmb.is_none() && old.is_some_and(|table| table.has_hand_made_effects()) {
        return Ok((n, MapStatus::KeptHandMade, None));
    }
    let (mut table, mut summary) = reject_table(&map, options)?;
    if let Some(rmb) = rmb {
        summary.n_effects = rmb.apply(lumps.name(), &mut table).map_err(RejectError::Rmb)?;
        summary.n_rejected = table.n_rejected();
    }
    Ok((n, MapStatus::Written(summary), Some(table.into_bytes())))
}
