//! Visibility for scenes: cells, portals, sightlines and the tables they make, under one name.
//!
//! Owns: nothing. Each module is a crate of its own, `sightlines-<module>`, behind a feature of the same
//! name; all are on by default.
//! Does not know: anything that those crates do not. There is no logic here.
//! Invariants: the crates under one version of this one fit together.
//!
//! A game that only asks tables needs the crate `sightlines-pvs` alone, which depends on nothing that
//! bakes them.

#[cfg(feature = "area-light")]
pub use sightlines_area_light as area_light;
#[cfg(feature = "bake")]
pub use sightlines_bake as bake;
#[cfg(feature = "cells")]
pub use sightlines_cells as cells;
#[cfg(feature = "certificates")]
pub use sightlines_certificates as certificates;
#[cfg(feature = "exact")]
pub use sightlines_exact as exact;
#[cfg(feature = "eye-to-cell")]
pub use sightlines_eye_to_cell as eye_to_cell;
#[cfg(feature = "formats")]
pub use sightlines_formats as formats;
#[cfg(feature = "from-region")]
pub use sightlines_from_region as from_region;
#[cfg(feature = "geometry")]
pub use sightlines_geometry as geometry;
#[cfg(feature = "kdtree")]
pub use sightlines_kdtree as kdtree;
#[cfg(feature = "multifocal")]
pub use sightlines_multifocal as multifocal;
#[cfg(feature = "multifocal-cpu")]
pub use sightlines_multifocal_cpu as multifocal_cpu;
#[cfg(feature = "multifocal-gpu")]
pub use sightlines_multifocal_gpu as multifocal_gpu;
#[cfg(feature = "packed")]
pub use sightlines_packed as packed;
#[cfg(feature = "pvs")]
pub use sightlines_pvs as pvs;
#[cfg(feature = "report")]
pub use sightlines_report as report;
#[cfg(feature = "scenes")]
pub use sightlines_scenes as scenes;
#[cfg(feature = "sightline")]
pub use sightlines_sightline as sightline;
#[cfg(feature = "simplify")]
pub use sightlines_simplify as simplify;
#[cfg(feature = "stabtree")]
pub use sightlines_stabtree as stabtree;
#[cfg(feature = "triangulation")]
pub use sightlines_triangulation as triangulation;
#[cfg(feature = "verify")]
pub use sightlines_verify as verify;
#[cfg(feature = "visible-surface")]
pub use sightlines_visible_surface as visible_surface;
#[cfg(feature = "walkthrough")]
pub use sightlines_walkthrough as walkthrough;

#[cfg(all(doctest, feature = "bake", feature = "cells", feature = "geometry"))]
#[doc = include_str!("../README.md")]
struct ReadmeDoctests;
