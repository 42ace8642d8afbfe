//! Why `explain` fails.

use crate::file_error::{FileError, from_file_error};
use crate::place::LookupError;
use sightlines::bake::explain::ExplainError;
use std::path::PathBuf;

/// Why `explain` fails; exit code 2.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Error {
    /// A file cannot be read, used or written.
    #[error(transparent)]
    File(FileError),
    /// A cell or a point that the table does not have.
    #[error(transparent)]
    Lookup(#[from] LookupError),
    /// A table without shapes, or the scene of another table.
    #[error("{}: {source}", table.display())]
    Explain { table: PathBuf, source: ExplainError },
    /// A cluster that a portal file does not have.
    #[error("{}: there is no cluster {cluster}: there are {n_clusters}", path.display())]
    NoSuchCluster { path: PathBuf, cluster: u32, n_clusters: usize },
    /// A point where a portal file, or the table of one, has no places.
    #[error("{}: a portal file does not say where its clusters are: name them by their numbers", .0.display())]
    NoPoints(PathBuf),
}

from_file_error!(Error);
