//! Errors of reading a file: its path, and what is wrong inside.

use sightlines_cells::{PlanError, SceneError};
use sightlines_geometry::CoordinateError;
use sightlines_pvs::DecodeError;
use std::error::Error;
use std::fmt::{self, Display};
use std::io;
use std::path::{Path, PathBuf};

/// A file that could not be read, shown as `e1m1.wad: map MAP01: LINEDEFS 12: ...`.
#[derive(Debug, thiserror::Error)]
#[error("{}: {kind}", path.display())]
pub struct ReadError {
    /// The file, as the caller named it.
    pub path: PathBuf,
    /// What is wrong.
    #[source]
    pub kind: ReadErrorKind,
}

impl ReadError {
    /// Puts the file's name before what is wrong inside.
    pub fn new(path: impl AsRef<Path>, kind: impl Into<ReadErrorKind>) -> Self {
        Self { path: path.as_ref().to_owned(), kind: kind.into() }
    }
}

/// What is wrong with a file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReadErrorKind {
    /// The system could not read it.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// Its content is not of the format that it is read as: [`Malformed`], or a table that cannot be decoded.
    #[error(transparent)]
    Content(Box<dyn Error + Send + Sync>),
}

impl From<Malformed> for ReadErrorKind {
    fn from(error: Malformed) -> Self {
        Self::Content(Box::new(error))
    }
}

impl From<DecodeError> for ReadErrorKind {
    fn from(error: DecodeError) -> Self {
        Self::Content(Box::new(error))
    }
}

/// Reads from a file, and puts its name before what is wrong.
pub(crate) fn in_file<T>(path: &Path, read: impl FnOnce() -> Result<T, ReadErrorKind>) -> Result<T, ReadError> {
    read().map_err(|kind| ReadError::new(path, kind))
}

/// A file, or what was read of it, that is not what its format asks for, shown as `line 12: this is no finite number`.
///
/// Both texts are for users. No program decides anything by them: what a program does decide by is an enum of its own, such as
/// [`VisibilityError`](crate::quake::VisibilityError).
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Malformed {
    /// Where, from the outside inwards, as in `map MAP01: LINEDEFS 12`: lines and columns count from 1, everything else from 0 unless
    /// its format has it otherwise. Empty for the whole.
    pub place: String,
    /// What is wrong there.
    pub what: String,
}

impl Malformed {
    pub(crate) fn new(what: impl Display) -> Self {
        Self { place: String::new(), what: what.to_string() }
    }

    /// The same, in a part of a whole.
    #[must_use]
    pub fn within(self, part: impl Display) -> Self {
        let place = if self.place.is_empty() { part.to_string() } else { format!("{part}: {}", self.place) };
        Self { place, ..self }
    }

    /// The same, on a line of a text, which counts from 1.
    pub(crate) fn on_line(self, line: usize) -> Self {
        self.within(format_args!("line {line}"))
    }
}

impl Display for Malformed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { place, what } = self;
        if place.is_empty() { f.write_str(what) } else { write!(f, "{place}: {what}") }
    }
}

impl Error for Malformed {}

/// A number and what there is so many of.
pub(crate) fn counted(n: usize, one: &str, many: &str) -> String {
    format!("{n} {}", if n == 1 { one } else { many })
}

/// Makes a [`Malformed`] whole of a text as `format!` does.
macro_rules! malformed {
    ($($what:tt)+) => { $crate::error::Malformed::new(format_args!($($what)+)) };
}
pub(crate) use malformed;

/// Results with a place for their errors.
pub(crate) trait Within {
    /// The same, with an error in a part of a whole.
    fn within(self, part: impl Display) -> Self;
}

impl<T> Within for Result<T, Malformed> {
    fn within(self, part: impl Display) -> Self {
        self.map_err(|error| error.within(part))
    }
}

/// What other crates refuse of the content of a file.
macro_rules! is_malformed {
    ($($error:ty),+) => {
        $(impl From<$error> for Malformed {
            fn from(error: $error) -> Self {
                Self::new(error)
            }
        })+
    };
}
is_malformed!(CoordinateError, PlanError, SceneError);
