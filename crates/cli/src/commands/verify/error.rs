//! Why `verify` fails.

use crate::error::of_map;
use crate::file_error::{FileError, from_file_error};
use sightlines::bake::BakeError;
use sightlines::bake::PrtBakeError;
use sightlines::formats::quake::VisibilityError;
use sightlines::formats::reject::RejectLengthError;
use sightlines::verify::ProofError;
use sightlines::verify::VerifyError;
use std::path::PathBuf;

/// Why `verify` fails; exit code 2.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Error {
    /// A file cannot be read, used or written.
    #[error(transparent)]
    File(FileError),
    /// A plan or a scene cannot be baked.
    #[error("{}: {}{source}", path.display(), of_map(map.as_ref()))]
    Bake { path: PathBuf, map: Option<String>, source: Box<BakeError> },
    /// A portal file, or the map that it is of, cannot be baked.
    #[error("{}: {source}", path.display())]
    BakePrt { path: PathBuf, source: PrtBakeError },
    /// A table that cannot be of the scene that it is to be checked against.
    #[error("{}: is no table of {}: {source}", table.display(), scene.display())]
    Verify { table: PathBuf, scene: PathBuf, source: VerifyError },
    /// A map without visibility of its own.
    #[error("{}: {}there is no {what} to check, or an empty one; {command} writes it", path.display(), of_map(map.as_ref()))]
    NoOwn { path: PathBuf, map: Option<String>, what: &'static str, command: &'static str },
    /// The own visibility of a map cannot be read.
    #[error("{}: {source}", path.display())]
    OwnVisibility { path: PathBuf, source: Box<VisibilityError> },
    /// The REJECT lump of a map has another length than its sectors need.
    #[error("{}: map {map}: {source}", path.display())]
    OwnLength { path: PathBuf, map: String, source: RejectLengthError },
    /// The REJECT lump of another map.
    #[error("{}: is no map of {}: it has {} sectors, not {}", path.display(), scene.display(), n_sectors[0], n_sectors[1])]
    OwnSectors { path: PathBuf, scene: PathBuf, n_sectors: [u32; 2] },
    /// The own visibility of a map, and a scene of another kind.
    #[error("{}: is a map, whose own visibility is checked against {needed}; {} is none", path.display(), scene.display())]
    OwnScene { path: PathBuf, scene: PathBuf, needed: &'static str },
    /// Proofs cannot be compared with a table.
    #[error("{}: {source} (the table is {})", path.display(), table.display())]
    Proofs { path: PathBuf, table: PathBuf, source: ProofError },
    /// Strictness without proofs.
    #[error("{}: --strict is for tables with proofs, and there are none: no --proofs, and no {}", path.display(), beside.display())]
    NoProofs { path: PathBuf, beside: PathBuf },
}

from_file_error!(Error);
