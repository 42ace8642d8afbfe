// Features beside the items that need them, where the documentation is built with a nightly compiler, as on docs.rs.
#![cfg_attr(docsrs, feature(doc_cfg))]
#![cfg_attr(
    any(
        not(doctest),
        all(
            feature = "bake", feature = "cells", feature = "eye-to-cell", feature = "formats", feature = "geometry",
            feature = "pvs", feature = "scenes", feature = "walkthrough"
        )
    ),
    doc = include_str!("../README.md")
)]
//!
//! # Scope
//!
//! This crate contains no logic: each module is another crate, re-exported behind a feature. Crates of the same version
//! as this one fit together.

#[cfg(feature = "area-light")]
pub use sightlines_area_light as area_light;
#[cfg(feature = "bake")]
pub use sightlines_bake as bake;
#[cfg(feature = "bsp")]
pub use sightlines_bsp as bsp;
#[cfg(feature = "cells")]
pub use sightlines_cells as cells;
#[cfg(feature = "certificates")]
pub use sightlines_certificates as certificates;
#[cfg(feature = "checkpoint")]
pub use sightlines_checkpoint as checkpoint;
#[cfg(feature = "exact")]
pub use sightlines_exact as exact;
#[cfg(feature = "eye-to-cell")]
pub use sightlines_eye_to_cell as eye_to_cell;
#[cfg(feature = "formats")]
pub use sightlines_formats as formats;
#[cfg(feature = "frame")]
pub use sightlines_frame as frame;
#[cfg(feature = "from-region")]
pub use sightlines_from_region as from_region;
#[cfg(feature = "geometry")]
pub use sightlines_geometry as geometry;
#[cfg(feature = "isovist")]
pub use sightlines_isovist as isovist;
#[cfg(feature = "kdtree")]
pub use sightlines_kdtree as kdtree;
#[cfg(feature = "line-space")]
pub use sightlines_line_space as line_space;
#[cfg(feature = "multifocal")]
pub use sightlines_multifocal as multifocal;
#[cfg(feature = "multifocal-cpu")]
pub use sightlines_multifocal_cpu as multifocal_cpu;
#[cfg(feature = "multifocal-gpu")]
pub use sightlines_multifocal_gpu as multifocal_gpu;
#[cfg(feature = "packed")]
pub use sightlines_packed as packed;
#[cfg(feature = "progress")]
pub use sightlines_progress as progress;
#[cfg(feature = "pvs")]
pub use sightlines_pvs as pvs;
#[cfg(feature = "relevance")]
pub use sightlines_relevance as relevance;
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
#[cfg(feature = "strip")]
pub use sightlines_strip as strip;
#[cfg(feature = "tiles")]
pub use sightlines_tiles as tiles;
#[cfg(feature = "triangulation")]
pub use sightlines_triangulation as triangulation;
#[cfg(feature = "verify")]
pub use sightlines_verify as verify;
#[cfg(feature = "viewer")]
pub use sightlines_viewer as viewer;
#[cfg(feature = "visibility-graph")]
pub use sightlines_visibility_graph as visibility_graph;
#[cfg(feature = "visible-surface")]
pub use sightlines_visible_surface as visible_surface;
#[cfg(feature = "walkthrough")]
pub use sightlines_walkthrough as walkthrough;
