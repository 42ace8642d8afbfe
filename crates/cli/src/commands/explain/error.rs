//! Why `explain` fails.

use crate::error::InputError;
use crate::error::OutputError;
use crate::picture::PictureError;
use crate::place::LookupError;
use sightlines::formats::ReadError;
use std::path::PathBuf;

/// Why `explain` fails; exit code 2.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Error {
    /// An input that is none.
    #[error(transparent)]
    Input(#[from] InputError),
    /// A WAD, a plan or a scene cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// A result that cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// A cell or a point that the table does not have.
    #[error(transparent)]
    Lookup(#[from] LookupError),
    /// A picture that cannot be drawn or written.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// A cluster that a portal file does not have.
    #[error("{}: there is no cluster {cluster}: there are {n_clusters}", path.display())]
    NoSuchCluster { path: PathBuf, cluster: u32, n_clusters: usize },
    /// A point where a portal file, or the table of one, has no places.
    #[error("{}: a portal file does not say where its clusters are: name them by their numbers", .0.display())]
    NoPoints(PathBuf),
}
