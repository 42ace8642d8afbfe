//! Following a viewer through a scene: what to draw in each frame, prepared before he arrives.
//!
//! Owns: the frame loop's side of a table ([`Walkthrough`]): the last answer and the last outlooks are used again, the
//! next ones are prepared on another thread ([`Prefetcher`]) along the way that the viewer seems to take, within a
//! budget of bytes; doors that open and close; tables that are replaced on the way; moving objects that cost nothing while they are hidden
//! ([`Movers`]); simplified levels of the scene for the cells that the viewer is in ([`Levels`]).
//! Does not know: how visibility is decided (`eye-to-cell`), how tables are stored (`packed`, `pvs`), files, drawing.
//! Invariants: a frame never waits, neither for the thread nor for a lock; an answer that comes before everything is prepared is a
//! superset; a mover that keeps its promises is never missed; a level that has not come, or is not for all of the viewer's cells, is the
//! original; an eye outside every cell sees everything.

#![forbid(unsafe_code)]

mod cache;
mod levels;
mod movers;
mod packed;
mod portals;
mod predict;
mod prefetch;
mod resident;
mod walkthrough;
mod wander;

pub use levels::{Draw, LevelCounters, LevelError, LevelIndex, LevelSize, Levels, LoadLevel};
pub use movers::{
    Broken, BrokenPromise, CellBoxes, Motion, MotionError, MoverCounters, MoverError, MoverId, MoverOptions, Movers,
    Places,
};
pub use packed::PackedCells;
pub use portals::same_portals;
pub use prefetch::{Prefetcher, Prepare};
pub use resident::Resident;
pub use walkthrough::{Answer, Frame, WalkCounters, WalkOptions, Walkthrough};
pub use wander::{Stand, wander};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeDoctests;
