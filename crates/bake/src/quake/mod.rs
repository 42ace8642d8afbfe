//! Quake maps: from a portal file to visibility, and from there into the map or a table.
//!
//! The graph of clusters comes from the file ([`graph_of_prt`]); [`ConvexSearch`] finds out which clusters see
//! which. [`vis_map`] puts the answer into the map, [`bake_prt`] into a table, [`bake_map`] into one that also knows
//! where the clusters are and which faces they have, from the map. All go on from the results of units that an earlier
//! run has kept ([`PrtOptions::units`]).

mod covered;
mod error;
mod portals;
mod sample;
mod table;
mod wishes;
mod world;

pub use error::PrtBakeError;
pub use portals::{MapPortals, PortalsError, portals_of_map};
pub use sample::{ProvenPairs, SampledProofs, WrongPair};
pub use wishes::{VisWishes, WishReport};
pub use world::bake_map;

use crate::baked::{Baked, BakedPrt};
use crate::reports::ClusterVisibility;
use crate::stopwatch::Stopwatch;
use sightlines_cells::{CellGraph, Convex};
use sightlines_formats::quake::bsp::AmbientTextures;
use sightlines_formats::quake::visibility::{check_portals, lump_with_sounds};
use sightlines_formats::quake::{Bsp, Prt, graph_of_prt};
use sightlines_progress::{Observer, Units};
use sightlines_pvs::Table;
use sightlines_stabtree::{ConvexOptions, ConvexSearch};
use std::fmt;
use wishes::Granting;

/// How to find out which clusters see which.
#[derive(Default)]
pub struct PrtOptions<'a> {
    /// How to search.
    pub search: ConvexOptions,
    /// Receives a report before the first step of the search and after each, and may cancel it.
    pub progress: Option<&'a dyn Observer>,
    /// Where results of units of work are kept, to go on after a stop or to share a search among processes.
    pub units: Units<'a>,
    /// Which textures make sounds in a map of Quake; of no use for a table.
    pub sounds: AmbientTextures,
    /// What a map is to show and hide, whatever is visible; of no use for a table.
    pub wishes: VisWishes,
}

impl fmt::Debug for PrtOptions<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("PrtOptions").field("search", &self.search).finish_non_exhaustive()
    }
}

/// A map with its visibility, and a report on that.
#[derive(Debug, Clone, PartialEq)]
pub struct VisMap {
    /// The map.
    pub bytes: Vec<u8>,
    /// Which clusters see which. The map says the same, but for wishes.
    pub clusters: ClusterVisibility,
    /// What wishes changed.
    pub wished: WishReport,
    /// The clusters, and the portals that the search went through.
    pub graph: CellGraph<Convex>,
}

/// Finds out which clusters of a map see which, and writes that into the map: its visibility lump, and what
/// leafs say of it. Everything else stays as it is; visibility that was there is replaced.
///
/// With [`PrtOptions::wishes`] the map shows and hides what they say; sounds and what is heard follow what it says.
///
/// # Errors
/// [`PrtBakeError`], before the search, for wishes about leafs that there are not, for portals of another map, for several clusters without a
/// portal, and for a map whose leafs lie under another lump; after it, for an answer that is too large for the map.
pub fn vis_map(bsp: &Bsp, prt: &Prt, options: PrtOptions<'_>) -> Result<VisMap, PrtBakeError> {
    check_portals(bsp, prt)?;
    // What would be refused at the end is refused before the search too: that may take hours.
    bsp.leaf_sounds()?;
    bsp.check_leafs()?;
    let graph = graph(prt)?;
    let granting = Granting::new(&options.wishes, (bsp, prt), &graph)?;
    let sounds = options.sounds;
    let clusters = see(&graph, options)?;
    let (says, wished) = granting.grant(&clusters.seen.cells);
    let lump = lump_with_sounds(bsp, &prt.leaf_clusters(), &says, sounds)?;
    Ok(VisMap { bytes: bsp.with_visibility(&lump)?, clusters, wished, graph })
}

/// Finds out which clusters of a portal file see which, and makes a table of them: cell `k` is cluster `k`.
///
/// A portal file contains no walls, so the table does not store where its cells are: the box of a cell is that
/// around its portals, which the cell may leave on all sides, and a cell without portals has a box without volume.
/// Query such a table, of the kind [`sightlines_pvs::TableKind::QuakePortalFile`], by cells instead of points.
///
/// # Errors
/// As [`vis_map`].
pub fn bake_prt(prt: &Prt, options: PrtOptions<'_>) -> Result<BakedPrt, PrtBakeError> {
    let graph = graph(prt)?;
    let fast = options.search.fast;
    let clusters = see(&graph, options)?;
    let table = Table::new(table::parts_of_clusters(prt, &graph, clusters.seen.cells.clone(), fast))?;
    Ok(Baked { graph, table, report: clusters })
}

fn graph(prt: &Prt) -> Result<CellGraph<Convex>, PrtBakeError> {
    match (prt.n_clusters(), prt.n_portals()) {
        // One room is a map; several without a way between them are a file that lost its portals.
        (2.., 0) => Err(PrtBakeError::NoPortals { n_clusters: prt.n_clusters() }),
        _ => Ok(graph_of_prt(prt)),
    }
}

fn see(graph: &CellGraph<Convex>, options: PrtOptions<'_>) -> Result<ClusterVisibility, PrtBakeError> {
    let PrtOptions { search, progress, units, sounds: _, wishes: _ } = options;
    let start = Stopwatch::start();
    let mut running = ConvexSearch::new(graph, search);
    if units.are_kept() {
        running.run_in_units(progress, units)?;
    } else {
        running.run(progress)?;
    }
    Ok(ClusterVisibility { seen: running.finish(), n_portals: graph.portals().len(), see_time: start.elapsed() })
}
