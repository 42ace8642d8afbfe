#![doc = include_str!("../README.md")]
//!
//! # Scope
//!
//! - **Owns**: the share of the view that a triangle can cover, as a proven upper bound ([`Intercepts`]) and as an
//!   estimate by rays ([`HitEstimate`]); simplification within a budget ([`simplify`]); levels for the cells of a table
//!   ([`levels()`]); the measurement of the change ([`measure`]); the ordinary geometric metric, for comparison
//!   ([`geometric`]); with the feature `serde`, what rays find as a report (`report`).
//! - **Out of scope**: how hidden things are proven (this is left to a
//!   [`FromRegion`](sightlines_multifocal::FromRegion) method or a table), files.
//! - **Invariants**: for every eye in the closed boxes of [`Views`] that lies on no surface, the share of the sphere of
//!   directions in which the first surface met changes is at most [`Simplified::bound`], which is at most the budget;
//!   with a budget of 0 nothing changes.
//!
//! # The promise
//! Let a direction's first hit be the face that its ray from the eye meets first. Faces are kept, removed, or added. If
//! a ray's first hit before is a kept face and its first hit after is not a new one, they are the same face: a kept
//! face that is nearer after was as near before. So a direction can only change if its first hit before was removed, or
//! if its first hit after is new. Therefore the share that changes is at most the sum of the shares of removed and new
//! faces of the sphere of directions, each counted where it is not proven hidden; and this holds for every eye of a box
//! if each term is a bound for every eye of it. A face is hidden in terms of the original scene; this may be used for a
//! new face as well, as a ray that reaches it although it is hidden passes a place where a face was removed, and is
//! counted there. A table takes the backs of single-sided faces to be unseen, so with one the promise is about eyes that see the back of
//! no such face. Merging faces in one plane changes no surface, and so it changes first hits only in name.

mod aimed;
mod ask;
pub mod bound;
mod collapse_budget;
mod compared;
pub mod estimate;
mod geometric;
mod hidden;
mod intercepts;
mod kept;
pub mod levels;
mod measure;
mod mesh;
mod options;
mod rays;
#[cfg(feature = "serde")]
pub mod report;
mod select;
mod simplified;
mod simplify;
mod views;
mod weigh;

pub use aimed::{Aimed, measure_aimed};
pub use ask::MakeMethod;
pub use estimate::{HitEstimate, Interval};
pub use geometric::geometric;
pub use hidden::HiddenBy;
pub use intercepts::Intercepts;
pub use levels::{Level, LevelOptions, Levels, WorkOptions, levels, levels_with};
pub use measure::{MeasureOptions, Measured, measure};
pub use options::{OptionsError, SimplifyOptions};
pub use simplified::{Counts, Simplified};
pub use simplify::{PreparedScene, SimplifyError, simplify};
pub use views::{ViewBox, Views, ViewsError};
