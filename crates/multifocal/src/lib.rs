#![doc = include_str!("../README.md")]
//!
//! # Scope
//!
//! - **Owns**: the view volume ([`Volume`]), the planes with their texels ([`BufferPlane`]), occluders ([`Occluder`]), what is
//!   compared ([`Measure`]), buffers ([`Buffer`]) and the jobs that fill them ([`BufferJob`]), the contract of backends
//!   ([`MultifocalBackend`]) and of from-region methods ([`FromRegion`], [`Umbra`]).
//! - **Out of scope**: how buffers are filled, threads, devices, cells, files.
//! - **Invariants**: everything errs towards visible; conditions are decided by exact predicates, or by integers that were
//!   rounded towards visible; nothing compares with an epsilon.
//!
//! # Source
//! Marsden, "Visibility Determination Using a Multifocal z-Buffer", 2002, with the corrections that
//! make it conservative, described where they matter.

pub mod adaptive;
pub mod backend;
pub mod buffer;
pub mod carry;
pub mod fallback;
pub mod footprint;
pub mod form;
pub mod job;
pub mod measure;
pub mod mesh;
pub mod method;
pub mod occludees;
pub mod occluder;
pub mod plane;
pub mod plane_choice;
pub mod ray_sampler;
pub mod region;
pub mod surround;
pub mod union_method;
pub mod volume;

pub use adaptive::{Split, WorkDone};
pub use backend::{BackendError, MultifocalBackend};
pub use buffer::Buffer;
pub use carry::Carry;
pub use fallback::{WithFallback, render_by_first};
pub use footprint::Footprint;
pub use form::{Form, Forms, Outlines};
pub use job::{BufferJob, BufferJobError, VALUE_BITS};
pub use measure::Measure;
pub use method::{Multifocal, OccluderSelection};
pub use occludees::{Occludees, QueryCounts};
pub use occluder::{Occluder, OccluderError};
pub use plane::{BufferPlane, BufferPlaneError, MAX_TEXELS};
pub use plane_choice::{PlaneChoice, PlaneChoiceError, Texels};
pub use ray_sampler::RaySampler;
pub use region::{FromRegion, Guarantee, Umbra};
pub use surround::{Layout, Surround, Surrounded};
pub use union_method::UnionMethod;
pub use volume::{Volume, VolumeError};
