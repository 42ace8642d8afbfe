//! Why `query` fails.

use crate::error::InputError;
use crate::error::OutputError;
use crate::place::LookupError;
use sightlines::eye_to_cell::ViewError;
use std::path::PathBuf;

/// Why `query` fails; exit code 2.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Error {
    /// An input that is none.
    #[error(transparent)]
    Input(#[from] InputError),
    /// A result that cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// A cell or a point that the table does not have.
    #[error(transparent)]
    Lookup(#[from] LookupError),
    /// A direction, or what else says how a viewer looks, that is none.
    #[error("{option}: {source}")]
    View { option: &'static str, source: ViewError },
    /// An angle of view, and nothing that says where it is looked.
    #[error("--fov, --aspect and --up need --dir: without it the viewer looks all round")]
    LensWithoutDirection,
    /// A portal that the table does not have.
    #[error("{}: there is no portal {portal}: the table has {n_portals} portals", path.display())]
    NoSuchPortal { path: PathBuf, portal: u32, n_portals: usize },
}
