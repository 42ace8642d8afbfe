// Features beside the items that need them, where the documentation is built with a nightly compiler, as on docs.rs.
#![cfg_attr(docsrs, feature(doc_cfg))]
#![doc = include_str!("../README.md")]
//!
//! # Scope
//!
//! - **Owns**: the whole way for any input ([`bake`](fn@bake)): what to bake ([`BakeRequest`]), all decisions before the work ([`PreparedBake`]), the work; from a file of any format ([`Bakeable`]), and the steps for each kind of it ([`bake_plan`], [`bake_scene`],
//!   [`bake_regions`], [`bake_prt`], [`bake_map`]), all of which return the graph, the table and a report ([`Baked`]); stab
//!   trees ([`with_stab_trees`]) and proofs ([`certify_table`]) from a graph, and the graph of a stored table ([`from_table`]);
//!   from-region methods and backends by name ([`methods`]), and the choice of methods from the properties of an input
//!   ([`auto`]); the frame of a scene that does not stand along the axes of its file ([`Framed`]); cells for scenes without
//!   walls along axes ([`places`]), and cells as high as eyes are ([`eye_level`]); the REJECT lumps of a WAD ([`reject_wad`]) or of several ([`reject_wads`]), the visibility of Quake maps and the state of an interrupted
//!   search ([`quake`]), the table of a changing scene ([`live`]), why cells of a table see each other
//!   ([`explain`](mod@explain)), lines of sight for the pairs of a table ([`lines`]);
//!   the floor plan of a scene at a height ([`floor_cut`]); one tile of a world that is too large for one table ([`tile`]), and all of them, from a plan to a folder ([`world`]).
//! - **Out of scope**: paths but for those of worlds, the command line, pictures.
//! - **Invariants**: the same scene and options give the same table, byte for byte, with any number of
//!   threads; every approximation on the way errs towards visible.

pub mod auto;
mod backs;
mod bakeable;
mod baked;
mod certify;
mod doors;
mod error;
pub mod explain;
pub mod eye_level;
mod floor;
mod framed;
pub mod from_table;
mod gap;
mod graph;
mod grid;
mod input;
mod limit;
pub mod lines;
pub mod live;
pub mod methods;
mod mirrors;
#[cfg(feature = "serde")]
mod named;
mod needs;
mod object_parts;
mod objects;
mod options;
pub mod places;
mod plan;
mod prepared;
mod propagation;
pub mod quake;
pub mod region;
pub mod reject;
mod reports;
mod request;
mod run;
pub mod scene;
mod sectors;
mod stab;
mod stated;
mod stopwatch;
mod subdivide;
mod surroundings;
mod table;
mod threads;
pub mod tile;
pub mod world;

pub use backs::Backs;
pub use bakeable::{Bakeable, BakeableError};
pub use baked::{Baked, BakedMap, BakedPlan, BakedPrt, BakedRegions, BakedScene};
pub use certify::{Certified, CertifyError, Proofs, certify_table};
pub use doors::DoorPortals;
pub use error::{BakeError, Meaningless};
pub use floor::{FloorCut, FloorCutError, floor_cut};
pub use framed::{Along, Framed, growth_of_cells};
pub use gap::Gap;
pub use graph::{GraphKind, GraphRef, OtherGraph, TableGraph};
pub use input::BakeInput;
pub use limit::LimitReport;
pub use live::{LiveScene, LiveUpdate};
#[cfg(feature = "serde")]
pub use named::RequestError;
pub use needs::portals_need;
pub use options::{ParseSceneMethodError, Recipe, SceneMethod};
pub use places::PlaceOptions;
pub use plan::{PlanBakeOptions, bake_plan};
pub use prepared::{BakeDecisions, PreparedBake, StatedViewers};
pub use quake::{PrtBakeError, PrtOptions, VisMap, bake_map, bake_prt, vis_map};
pub use region::{CellsFrom, MakeMethod, RegionBakeOptions, bake_regions};
pub use reject::{
    MapOutcome, MapStatus, RejectError, RejectMaps, RejectOptions, RejectOutcome, RejectSummary, RejectTables,
    RejectWadsError, reject_table, reject_wad, reject_wads,
};
pub use reports::{
    ClusterSummary, ClusterVisibility, MapReport, PlanReport, RegionReport, Report, SceneReport, WorldSummary,
};
pub use request::{BakeRequest, BufferRequest, Runtime};
pub use run::bake;
pub use scene::{PortalMode, SceneBakeOptions, bake_scene};
pub use sectors::see_groups;
pub use stab::{BakedStab, StabBakeError, StabOptions, StabReport, with_stab_trees};
pub use stated::{StatedMethods, stated_gap, stated_methods, stated_reading};
pub use subdivide::{ParseSubdivideError, Subdivide};
pub use surroundings::{Surrounding, surroundings};
pub use table::{TableOptions, table_of};
