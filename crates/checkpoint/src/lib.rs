#![doc = include_str!("../README.md")]
//!
//! # Scope
//!
//! - **Owns**: stores of units in files: one file beside the output of a bake ([`Journal`]), and a folder that processes share ([`Job`],
//!   [`JobStore`]); what tells the results of one bake from those of another ([`Key`]); who does the shards of a job ([`engine`]), and what is printed about it ([`report`]).
//! - **Out of scope**: what units are and how they are computed (`bake`), command lines of processes (the program).
//! - **Invariants**: no content of a file causes a panic or more memory than a small multiple of its size; a result is returned only
//!   if its checksum holds; parts and the manifest of a job appear whole or not at all.

mod division;
pub mod engine;
mod error;
mod index;
mod inputs;
mod job;
mod journal;
mod key;
mod lock;
mod records;
pub mod report;

pub use error::StateError;
pub use inputs::{Identity, InputFile, Inputs};
pub use job::{
    Job, JobError, JobProgress, JobRole, JobSlot, JobStore, Manifest, ParseShardRunError, PhasePlan, PhaseStatus,
    ShardPlan, ShardRun, ShardState, batch, cut, in_words,
};
pub use journal::{Journal, OpenMode};
pub use key::{Key, KeyHasher, ParseKeyError};
