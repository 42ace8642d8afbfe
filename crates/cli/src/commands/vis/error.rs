//! Why `vis` fails.

use crate::file_error::{FileError, from_file_error};
use crate::kept::{Interrupted, KeptError};
use crate::memory::TooLarge;
use sightlines::bake::PrtBakeError;
use std::fmt;
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
    /// Results cannot be kept, or taken up.
    #[error(transparent)]
    Kept(#[from] KeptError),
    /// There is no room for it in the memory that may be used.
    #[error("{}: {source}; allow more", path.display())]
    Memory { path: PathBuf, source: TooLarge },
    /// The program was interrupted.
    #[error("{0}")]
    Interrupted(Interrupted),
    /// A proof about two clusters contradicts what the table lists.
    #[error("{}: clusters {} and {} are listed as {}, but {found}; nothing was written", path.display(), pair[0], pair[1],
            if *is_listed { "visible" } else { "hidden" })]
    Contradiction { path: PathBuf, pair: [u32; 2], is_listed: bool, found: Found },
}

from_file_error!(Error);

/// What was found about a pair of clusters that is listed otherwise.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Found {
    /// A line between them.
    Line,
    /// A proof that there is none.
    NoLine,
    /// A line or a proof that the checker refuses.
    Refused,
}

impl fmt::Display for Found {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Line => "a line joins them",
            Self::NoLine => "no line joins them",
            Self::Refused => "the proof that was found does not hold",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn contradictions_name_the_pair_and_what_was_found() {
        let text = |is_listed, found| {
            Error::Contradiction { path: "e1m1.bsp".into(), pair: [3, 5], is_listed, found }.to_string()
        };
        let start = "e1m1.bsp: clusters 3 and 5 are listed as";
        assert_eq!(text(false, Found::Line), format!("{start} hidden, but a line joins them; nothing was written"));
        assert_eq!(text(true, Found::NoLine), format!("{start} visible, but no line joins them; nothing was written"));
        let refused = "but the proof that was found does not hold; nothing was written";
        assert_eq!(text(true, Found::Refused), format!("{start} visible, {refused}"));
    }
}
