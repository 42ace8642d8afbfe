// Features beside the items that need them, where the documentation is built with a nightly compiler, as on docs.rs.
#![cfg_attr(docsrs, feature(doc_cfg))]
#![doc = include_str!("../README.md")]
//!
//! # Scope
//!
//! - **Owns**: what one eye sees, look by look ([`Viewer`]); the frame loop's side of a table ([`Walkthrough`]): the last
//!   answer is reused, and the data of the next cells is prepared on another thread ([`Prefetcher`]) along the predicted
//!   path of the eye, within a byte budget;
//!   doors that open and close; tables that are replaced at run time; moving objects that cost nothing while they are
//!   hidden ([`Movers`]); simplified levels of the scene for the cells of the eye ([`LevelPrefetcher`]); what all this leaves to draw, and costs, along a walk
//!   ([`WalkMeasure`]).
//! - **Out of scope**: how visibility is decided (`eye-to-cell`), how tables are stored (`packed`, `pvs`), files, drawing.
//! - **Invariants**: a frame of a walk never waits, neither for the thread nor for a lock; an answer given before everything is
//!   prepared is a superset; a mover that keeps its promises is never missed; where a level has not arrived, or is not
//!   for all cells of the eye, the original is drawn; an eye outside every cell sees everything.

#![forbid(unsafe_code)]

mod cache;
mod coarse;
mod facts;
mod levels;
mod measure;
mod movers;
mod nesting;
#[cfg(feature = "packed")]
mod packed;
mod portals;
mod predict;
mod prefetch;
mod viewer;
mod walkthrough;
mod wander;

pub use coarse::CoarseVisibility;
pub use facts::TableFacts;
pub use levels::{Draw, LevelCounters, LevelError, LevelIndex, LevelPrefetcher, LevelSize, LevelsDrawn, LoadLevel};
pub use measure::{LeftToDraw, MeasureError, MethodSums, WalkMeasure, WalkMeasured};
pub use movers::{
    Broken, BrokenPromise, CellBoxes, CellLocator, Motion, MotionError, MoverCounters, MoverError, MoverId,
    MoverOptions, Movers,
};
pub use nesting::Found;
#[cfg(feature = "packed")]
pub use packed::PackedCells;
pub use portals::same_portals;
pub use prefetch::{Prefetcher, Prepare};
pub use viewer::{Look, Viewer};
pub use walkthrough::{AnswerKind, DrawList, WalkCounters, WalkOptions, Walkthrough};
pub use wander::{CameraPose, usual_step, wander};
