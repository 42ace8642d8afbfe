// Features beside the items that need them, where the documentation is built with a nightly compiler, as on docs.rs.
#![cfg_attr(docsrs, feature(doc_cfg))]
#![doc = include_str!("../README.md")]
//!
//! # Scope
//!
//! - **Owns**: drawings of cells and of what is visible, as a plan ([`plan_svg`]), as a floor plan of a
//!   scene in space ([`slice_svg`]) and as boxes ([`isometric_svg`]), in SVG, and with the feature `png` in PNG (`svg_to_png`); the JSON export
//!   ([`export_json`]); summary numbers of a table ([`Summary`], [`ViewerShare`]) and all that it states of itself ([`TableInfo`]), with words for them ([`words`]); the numbers of a walk ([`WalkReport`]) and their chart ([`walk_svg`]), and what charts are made of ([`chart`]);
//!   pictures of multifocal buffers ([`buffer_png`]) and of the fields beside them ([`voronoi_png`], [`distance_png`]);
//!   pictures of what is seen, in a colour for each face ([`faces_png`]), and sheets of them ([`sheet_png`]);
//!   pictures of soft shadows ([`light_png`]); areas that points see ([`areas_geojson`], [`areas_csv`], [`areas_svg`], [`areas_png`]);
//!   pictures and tables of values at points ([`field_svg`], [`field_png`], [`points_csv`], [`points_geojson`]).
//! - **Out of scope**: how a table was made, files.
//! - **Invariants**: a table is only read, and pictures show only what it contains; the same table and options
//!   give the same bytes on every machine; words in pictures are drawn as lines, so they need no fonts.

mod areas;
mod buffer_chart;
mod canvas;
pub mod chart;
mod draw;
mod export;
mod faces;
mod facts;
mod field;
mod frame;
mod letters;
mod light;
mod multifocal;
mod outline;
mod png;
mod point_table;
mod share;
mod sheet;
mod summary;
mod table_info;
mod theme;
mod viewpoints;
mod walk;
mod walk_report;

pub use areas::{Area, AreaEdge, SeenInSpace, areas_csv, areas_geojson, areas_png, areas_svg, seen_csv};
pub use buffer_chart::{BufferChart, buffer_chart_svg};
pub use draw::{
    DrawError, DrawOptions, Drawing, IsometricOptions, MAX_SIZE, MIN_SIZE, PictureSubject, SeenFromEye, SliceOptions,
    Surfaces, Up, isometric_drawing, isometric_svg, plan_drawing, plan_svg, slice_drawing, slice_svg,
};
pub use export::{export_json, write_json};
pub use faces::{MARK, NO_FACE, NOWHERE, face_colour, faces_png};
pub use facts::{DigestFacts, DoorFacts, InfoFacts, ObjectPlace, StabFacts, write_doors};
pub use field::{Field, field_colour, field_png, field_svg};
pub use light::{LIT, LightPixel, UMBRA, light_png};
pub use multifocal::{OPEN, buffer_png, distance_png, voronoi_png};
pub use png::PngError;
#[cfg(feature = "png")]
pub use png::svg_to_png;
pub use point_table::{PointColumn, points_csv, points_geojson};
pub use share::ViewerShare;
pub use sheet::{SheetPicture, sheet_png, sheet_size};
pub use sightlines_frame::{ALONG_THE_FILE, FrameFacts};
pub use sightlines_progress::words;
pub use summary::Summary;
pub use table_info::{ObjectFacts, TableInfo, write_sources};
pub use viewpoints::{cells_by_seen_floor, secluded_cell};
pub use walk::{WalkBar, walk_svg};
pub use walk_report::{WalkReport, WalkedLevels};
