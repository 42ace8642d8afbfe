#![doc = include_str!("../README.md")]
//!
//! # Scope
//!
//! - **Owns**: [`visible_zones`] (which cells, or groups of cells, see each other, by portal sequences),
//!   [`axial_visibility`] (the same for boxes in space, and for objects, by the walls between them), [`LiveAxial`] (that answer
//!   kept up to date while walls and objects change), [`box_visibility`] (from-region queries for boxes that are no cells),
//!   [`ConvexSearch`] (which cells see each other through convex portals in space, by beams and sequences),
//!   [`StabTree`] (every stabbable portal sequence out of one cell), [`stab_trees`] (those out of all cells, in one graph,
//!   up to a limit), [`explain`](fn@explain),
//!   [`explain_axial`] and [`explain_convex`] (the line between two cells, or why there is none), [`certify_planar`],
//!   [`certify_axial`] and [`certify_convex`] (proofs of all rows of a table).
//! - **Out of scope**: files, tables, how cells were cut. The search over sequences is generic over the
//!   [`Stabber`](sightlines_sightline::Stabber), and with it over the dimension.
//! - **Invariants**: the answer is exact if the stabber is; it is symmetric, has every zone see itself, and
//!   does not depend on the number of threads or on which hints a caller gives.

mod axial;
mod certify;
mod chords;
mod convex;
mod explain;
mod explanation;
mod network;
mod search;
mod tree;
mod zones;

pub use axial::{
    AxialExplainer, AxialExplanation, AxialPath, AxialProof, AxialUpdate, AxialVisibility, BoxVisibility, LiveAxial,
    PairMask, axial_visibility, box_visibility, explain_axial,
};
pub use certify::{
    CertifyError, CertifyOptions, ObjectRows, axial_network, certify_axial, certify_planar, planar_network,
};
pub use chords::{shoot_axial_chords, shoot_chords};
pub use convex::{
    BlockedConvex, Blocking, ConvexDoubt, ConvexExplainer, ConvexExplanation, ConvexGate, ConvexOptions, ConvexPath,
    ConvexProof, ConvexSearch, ConvexSearchCounters, ConvexState, ConvexVisibility, MOST_EXPLAINED, WorkChain,
    certify_convex, check_convex, convex_network, explain_convex,
};
pub use explain::{BlockedSequence, PlanarExplanation, PlanarPath, PlanarProof, explain};
pub use explanation::{Barrier, Explanation, SearchLimit, Sight};
pub use network::Network;
pub use search::{SearchOptions, SearchSummary, ZoneVisibility, visible_zones};
pub use tree::{
    ByPolygons, ByStabber, Follower, StabNode, StabTree, StabTreesOptions, StabTreesSummary, TreeTooLarge, gate_of,
    portal_of, stab_trees, stab_trees_axial, stab_trees_convex, stab_trees_planar,
};
pub use zones::Zones;

use sightlines_cells::{CellGraph, Planar};
use sightlines_geometry::Adaptive;
use sightlines_progress::Cancelled;
use sightlines_pvs::BitMatrix;
use sightlines_sightline::Funnel;

/// Which zones of a planar graph see each other: chords first, then the exact search.
///
/// `graph` is cut by any method; `zones` groups the cells that are searched for together. Returns a symmetric matrix,
/// zones by zones, with the diagonal set. Exact: a bit is set if and only if an open set of lines leads from a cell of
/// one zone through portals into a cell of the other.
///
/// Cost: see [`visible_zones`].
///
/// # Errors
/// [`Cancelled`] by the observer.
pub fn planar_visibility(
    graph: &CellGraph<Planar>,
    zones: &Zones,
    options: &SearchOptions<'_>,
) -> Result<(BitMatrix, SearchSummary), Cancelled> {
    let known = shoot_chords(graph, zones, options.chords);
    let network = Network::planar(graph, zones);
    let seen = match graph.small_grid() {
        Some(grid) => visible_zones(&network, &Funnel::new(grid), &known, options),
        None => visible_zones(&network, &Funnel::new(Adaptive), &known, options),
    }?;
    Ok((seen.zones, seen.summary))
}
