#![doc = include_str!("../README.md")]
//!
//! # Scope
//!
//! - **Owns**: the codings of rows ([`Distinct`], blocks through zstd; lists of what is seen in large files), merging within a
//!   budget ([`PackOptions`]), writing row by row ([`PackWriter`]), the byte [`format`](mod@format), reading on demand ([`Packed`]), the coarse table to fall back on.
//! - **Out of scope**: how a table was made, cones and eyes, threads of its own, paths of files.
//! - **Invariants**: without a budget a table comes back exactly; with one, everything visible stays visible.
//!   Large files have the same answers as small ones. Damaged bytes are errors, never a panic, and never claim memory that neither the
//!   length of the file nor a stated limit justifies. Same table and options, same bytes.
//!
//! # Why positional reads and no map
//! A file could be mapped into memory and left to the system's page cache. This crate reads at positions
//! instead. Mapping needs `unsafe`, which the workspace forbids, for a reason: a mapped file that another
//! process cuts ends the program with SIGBUS in the middle of a frame, where a read gives an error. And a
//! map bounds nothing that counts: rows have to be unpacked anyway, and a budget on unpacked blocks is
//! exact, while the pages of a map come and go as the system likes. A host that maps its files itself
//! passes the map: every `&'static [u8]` is a [`ByteSource`].

#![forbid(unsafe_code)]

pub mod across;
mod blocks;
mod bytes;
mod cache;
pub mod classes;
mod container;
mod doors;
mod error;
mod facts;
mod find;
pub mod format;
mod index;
mod locate;
mod masks;
mod merge;
mod pack;
mod packed;
mod paged;
mod pages;
mod query;
mod rows;
mod sections;
mod sizes;
mod source;
mod store;
mod stream;
mod verify;
mod whole;
mod write;
mod write_pages;
mod zstandard;

pub use cache::PackedStats;
pub use classes::Distinct;
pub use error::{PackError, PackedError, PackedErrorKind, StreamError};
pub use format::SizeClass;
pub use pack::{PackOptions, pack, pack_report};
pub use packed::Packed;
pub use query::{ExitVisitor, PackedQuery, StabNode};
pub use sizes::PartSize;
pub use source::ByteSource;
pub use stream::{PackReport, PackWriter, StreamOptions};
