//! Why `build` fails.

use crate::buffers::MethodFailed;
use crate::error::of_map;
use crate::file_error::{FileError, from_file_error};
use crate::kept::{Interrupted, KeptError};
use crate::memory::TooLarge;
use sightlines::bake::BakeError;
use sightlines::bake::CertifyError;
use sightlines::bake::PrtBakeError;
use sightlines::bake::StabBakeError;
use sightlines::bake::region::PackRegionsError;
use sightlines::packed::PackError;
use sightlines::verify::{ProofError, ProofViolation};
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
    /// Proofs that were made are none of the table: our bug.
    #[error("{}: the proofs that were made cannot be compared with the table: {source}; nothing was written", path.display())]
    Incomparable { path: PathBuf, source: ProofError },
    /// What is proven is not what the table states: our bug.
    #[error("{}: the proofs contradict the table: {first}{}; nothing was written", path.display(), and_more(*n_violations))]
    Contradiction { path: PathBuf, n_violations: u64, first: ProofViolation },
    /// A door with a box of another dimension than the table.
    #[error("{}: the box of the door {name:?} has {found} numbers: here it needs {needed}", path.display())]
    DoorDimension { path: PathBuf, name: String, found: usize, needed: usize },
    /// Results cannot be kept, or taken up.
    #[error(transparent)]
    Kept(#[from] KeptError),
    /// The program was interrupted.
    #[error("{0}")]
    Interrupted(Interrupted),
    /// There is no room for it in the memory that may be used.
    #[error("{}: {source}; {advice}", path.display())]
    Memory { path: PathBuf, source: TooLarge, advice: &'static str },
    /// A layout for a table that is not packed.
    #[error("{}: --class is for packed tables, whose names end in .pvz", out.display())]
    Class { out: PathBuf },
    /// A table cannot be packed.
    #[error("{}: {source}", path.display())]
    Pack { path: PathBuf, source: PackError },
    /// A table cannot be written row by row.
    #[error("{}: {source}", path.display())]
    Rows { path: PathBuf, source: Box<PackRegionsError> },
    /// A table cannot have stab trees.
    #[error("{}: {source}", path.display())]
    Stab { path: PathBuf, source: StabBakeError },
}

from_file_error!(Error);

/// How many there are besides the first.
fn and_more(n: u64) -> String {
    if n > 1 { format!("; and {} more", n - 1) } else { String::new() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sightlines::pvs::CellId;

    #[test]
    fn proofs_that_contradict_are_named() {
        let error = |n_violations: u64| {
            let first = ProofViolation::Joined([CellId(1), CellId(2)]);
            Error::Contradiction { path: "a.glb".into(), n_violations, first }.to_string()
        };
        let text = "a.glb: the proofs contradict the table: cells 1 and 2 are hidden from each other, but a proven line joins them";
        assert_eq!(
            [1, 3].map(error),
            [format!("{text}; nothing was written"), format!("{text}; and 2 more; nothing was written")]
        );
        let other = Error::Incomparable { path: "a.glb".into(), source: ProofError::Portal(3) }.to_string();
        let text = "cannot be compared with the table: portal 3 of the table is no rectangle across an axis; nothing was written";
        assert_eq!(other, format!("a.glb: the proofs that were made {text}"));
    }
}
