//! What can be wrong with a file of results.

use sightlines_formats::WriteError;
use std::io;
use std::path::{Path, PathBuf};

/// Why a file of results, or a file that decides them, cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StateError {
    /// It cannot be opened or read.
    #[error("{}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The error of the system.
        source: io::Error,
    },
    /// It cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// It is something else.
    #[error("{}: this is no file of results of units", .0.display())]
    NotState(PathBuf),
    /// It has the form of files of results of another version of the program.
    #[error("{}: the file has the form of another version of the program", .0.display())]
    OtherForm(PathBuf),
    /// Another process keeps its results in it.
    #[error("{}: another process keeps its results in this file", .0.display())]
    InUse(PathBuf),
    /// Something else has its name by now.
    #[error("{}: not removed: it is no longer the file that this process wrote", .0.display())]
    Replaced(PathBuf),
    /// A phase of the bake was divided into other units.
    #[error("{}: the results of phase {phase} are of other units than this bake has", path.display())]
    OtherUnitsOfPhase {
        /// The file.
        path: PathBuf,
        /// The name of the phase.
        phase: String,
    },
    /// Another version of the program wrote it.
    #[error("{}: written by version {found} of the program, and this is {expected}", path.display())]
    OtherProgram {
        /// The file.
        path: PathBuf,
        /// The version that wrote it.
        found: String,
        /// The version that reads it.
        expected: String,
    },
    /// A file that decides results may have been read as something else than what was looked at.
    #[error("{}: the file has changed while it was read; run the command again", .0.display())]
    InputChanged(PathBuf),
    /// It is of another input, or of other options.
    #[error("{}: the results are of another input or of other options", .0.display())]
    OtherKey(PathBuf),
    /// A result was changed since it was read first, or cut off.
    #[error("{}: the record at byte {offset} is damaged", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// Where the record begins.
        offset: u64,
    },
    /// The file ends before the end of its records.
    #[error("{}: it is cut off after byte {offset}", path.display())]
    CutOff {
        /// The file.
        path: PathBuf,
        /// Where its last whole record ends.
        offset: u64,
    },
    /// It has other units than it should.
    #[error("{}: it does not have the results of just the units of its shard", .0.display())]
    OtherUnits(PathBuf),
}

impl StateError {
    pub(crate) fn read(path: &Path, source: io::Error) -> Self {
        Self::Read { path: path.to_owned(), source }
    }

    pub(crate) fn write(path: &Path, source: io::Error) -> Self {
        Self::Write(WriteError { path: path.to_owned(), source })
    }
}
