#![doc = include_str!("../README.md")]
//!
//! # Scope
//!
//! - **Owns**: grids over plans and which of their pixels are filled ([`PixelGrid`]), points ([`Points`]), the graph of what sees what
//!   ([`VisibilityGraph`]), its local measures ([`LocalMeasures`]), those of depth ([`GlobalMeasures`]), of paths through it
//!   ([`MetricMeasures`], [`AngularMeasures`]), and all of them by name ([`Measure`], [`Analysis`]).
//! - **Out of scope**: which points see each other (the caller decides), pictures, files.
//! - **Invariants**: whether a step of a grid is free is decided exactly; counts are whole numbers up to the last division; the same input gives
//!   the same bits with any number of threads, on any machine.

mod analysis;
mod bytes;
mod fill;
mod functions;
mod global;
mod graph;
mod grid;
mod local;
mod paths;
mod points;
mod run;
mod search;
mod work;

pub use analysis::{Analysis, AnalysisOptions, Group, Measure, MeasureSet};
pub use fill::InteriorPoints;
pub use global::GlobalMeasures;
pub use graph::{GraphError, VisibilityGraph};
pub use grid::{GridError, MOST_PIXELS, Pixel, PixelGrid};
pub use local::LocalMeasures;
pub use paths::{AngularMeasures, MetricMeasures, Turns};
pub use points::{Points, PointsError};
pub use run::Run;
pub use work::WorkOptions;

/// The value of a measure where it has none, as in depthmapX. No measure is negative otherwise.
pub const UNDEFINED: f64 = -1.0;
