//! REJECT lumps: which sectors of a Doom map cannot see each other.
//!
//! # The flat model
//! Sight ignores heights. A line lets sight through if and only if it is marked two-sided; nothing else
//! about it matters, because doors and lifts move and a REJECT bit cannot. The map's regions are the
//! faces of the arrangement of all its lines; a region belongs to every sector that a side facing it
//! names. Sector A sees sector B if an open set of segments without a closed one-sided line in their way
//! leads from a region of A into a region of B.
//!
//! That rule answers the known traps without exceptions to it:
//! * a *self-referencing* sector, whose lines have it on both sides, is a region of its own inside the
//!   lines and shares the region outside with the sector around it; it sees and is seen from both;
//! * an *unclosed* sector shares its region with whatever it leaks into;
//! * a two-sided line with a *missing side* lets sight through like any other, into a region that other
//!   lines may name;
//! * a sector without lines has no region: it sees itself and nothing else.
//!
//! # Effects made by hand
//! A table that is not symmetric, or that rejects a sector from itself, was not computed: mappers build
//! blind or deaf monsters that way. Such a table is kept unless the caller insists.

use crate::plan::BakeError;
use sightlines_formats::doom::{DoomMap, MapKind, MapLumps};
use sightlines_formats::reject::RejectTable;
use sightlines_formats::wad::Wad;
use sightlines_formats::{DoomError, WadError};
use sightlines_pvs::BitMatrix;
use sightlines_stabtree::{Progress, SearchOptions, Zones, see_plan};
use sightlines_triangulation::subdivide;
use std::time::{Duration, Instant};

/// How to build REJECT lumps.
#[derive(Clone, Default)]
pub struct RejectOptions<'a> {
    /// Names of the maps to do; all if empty.
    pub maps: Vec<String>,
    /// Replace tables with effects made by hand too.
    pub force: bool,
    /// Number of threads; 0 for one for each core. Changes nothing but the time.
    pub threads: usize,
    /// Told how many zones of how many are done, for each map anew.
    pub progress: Option<Progress<'a>>,
}

impl std::fmt::Debug for RejectOptions<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("RejectOptions")
            .field("maps", &self.maps)
            .field("force", &self.force)
            .field("threads", &self.threads)
            .finish_non_exhaustive()
    }
}
