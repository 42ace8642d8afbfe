//! Why `vis` fails.

use crate::file_error::{FileError, from_file_error};
use sightlines::bake::PrtBakeError;
use sightlines::bake::quake::StateError;
use std::path::PathBuf;

/// Why `vis` fails; exit code 2.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Error {
    /// A file cannot be read, used or written.
    #[error(transparent)]
    File(FileError),
    /// A portal file where the map is needed that it is of.
    #[error("{}: these are the portals of a map, and the map itself is needed: {command} {} --prt {}", path.display(),
            path.with_extension("bsp").display(), path.display())]
    PortalsForMap { path: PathBuf, command: &'static str },
    /// A portal file, or the map that it is of, cannot be baked.
    #[error("{}: {source}", path.display())]
    BakePrt { path: PathBuf, source: PrtBakeError },
    /// A proof about two clusters contradicts what the table lists.
    #[error("{}: clusters {} and {} are listed as {listed}, but {found}; nothing was written", path.display(), pair[0], pair[1])]
    Contradiction { path: PathBuf, pair: [u32; 2], listed: &'static str, found: &'static str },
    /// A state from which the search cannot be resumed.
    #[error("{}: {source}; without --resume the search begins anew", path.display())]
    State { path: PathBuf, source: StateError },
    /// Something else is where the state of the search would be written.
    #[error("{}: this is no state of a search, and would be overwritten; name another with --state", .0.display())]
    NotState(PathBuf),
}

from_file_error!(Error);
