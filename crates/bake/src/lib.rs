#![doc = include_str!("../README.md")]
//!
//! # Scope
//!
//! - **Owns**: the choice of subdivision and predicate ([`bake_plan`]), and of methods from the properties of a scene
//!   ([`auto`]), the conversion of a cell graph to a table ([`table_of`]) and back ([`graph_of`], [`axial_graph_of`]),
//!   stab trees for a finished table ([`with_stab_trees`]), proofs for it ([`certify_table`]), the REJECT lumps of a
//!   WAD ([`reject_wad`]), the visibility of Quake maps and the state of an interrupted search ([`quake`]), the table
//!   of a changing scene ([`live`]).
//! - **Out of scope**: paths, the command line, pictures.
//! - **Invariants**: the same scene and options give the same table, byte for byte, with any number of
//!   threads; every approximation on the way errs towards visible.

pub mod auto;
mod certify;
pub mod live;
pub mod methods;
mod mirrors;
mod objects;
mod plan;
pub mod quake;
pub mod region;
pub mod reject;
pub mod scene;
mod sectors;
mod stab;
mod table;

pub use certify::{Certified, CertifyError, Proofs, certify_table};
pub use live::{LiveScene, LiveUpdate};
pub use plan::{BakeError, BakeOptions, BakeSummary, Baked, ParseSubdivideError, Subdivide, bake_plan};
pub use quake::{
    BakedMap, BakedPrt, PrtBakeError, PrtOptions, SeenClusters, VisMap, bake_map, bake_prt, convex_graph_of, vis_map,
};
pub use region::{BakedRegions, CellsFrom, MakeMethod, RegionBakeError, RegionBakeOptions, bake_regions};
pub use reject::{
    MapOutcome, MapStatus, RejectError, RejectOptions, RejectOutcome, RejectSummary, reject_table, reject_wad,
};
pub use scene::{BakedScene, PortalMode, SceneBakeOptions, bake_scene};
pub use sectors::see_groups;
pub use stab::{BakedStab, StabBakeError, StabOptions, most_nodes, with_stab_trees};
pub use table::{TableOptions, axial_graph_of, graph_of, table_of};
