//! Why `build` fails.

use crate::buffers::MethodFailed;
use crate::error::of_map;
use crate::file_error::{FileError, from_file_error};
use sightlines::bake::BakeError;
use sightlines::bake::CertifyError;
use sightlines::bake::PrtBakeError;
use sightlines::bake::StabBakeError;
use std::path::PathBuf;

/// Why `build` fails; exit code 2.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Error {
    /// A file cannot be read, used or written.
    #[error(transparent)]
    File(FileError),
    /// A from-region method cannot be prepared.
    #[error(transparent)]
    Method(#[from] MethodFailed),
    /// A table under a name that ends in `.json`.
    #[error("{}: `build` writes a table, which is not JSON: name it {}, and then: sightlines export {} -o {}", out.display(),
            out.with_extension("pvs").display(), out.with_extension("pvs").display(), out.display())]
    Json { out: PathBuf },
    /// A plan or a scene cannot be baked.
    #[error("{}: {}{source}", path.display(), of_map(map.as_ref()))]
    Bake { path: PathBuf, map: Option<String>, source: Box<BakeError> },
    /// A portal file, or the map that it is of, cannot be baked.
    #[error("{}: {source}", path.display())]
    BakePrt { path: PathBuf, source: PrtBakeError },
    /// A table cannot have proofs.
    #[error("{}: {source}", path.display())]
    Certify { path: PathBuf, source: CertifyError },
    /// What is proven is not what the table states: our bug.
    #[error("{}: the proofs contradict the table: {text}", path.display())]
    Contradiction { path: PathBuf, text: String },
    /// A table cannot have stab trees.
    #[error("{}: {source}", path.display())]
    Stab { path: PathBuf, source: StabBakeError },
}

from_file_error!(Error);
