//! Why `render` fails.

use crate::eye::EyeError;
use crate::file_error::{FileError, from_file_error};
use sightlines::cells::Unlike;
use sightlines::visible_surface::FacesError;
use std::path::PathBuf;

/// Why `render` fails; exit code 2.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Error {
    /// A file cannot be read, used or written.
    #[error(transparent)]
    File(FileError),
    /// A camera that shows nothing.
    #[error(transparent)]
    Eye(#[from] EyeError),
    /// A scene that is too large.
    #[error("{}: {source}", path.display())]
    Faces { path: PathBuf, source: FacesError },
    /// Several methods, and one picture.
    #[error("--method: several methods are drawn with --compare only; name one")]
    ManyMethods,
    /// A depth format, and no z-buffer.
    #[error("--depth: this is the format of a z-buffer, and none is drawn: add --method zbuffer")]
    NoBuffer,
    /// A table that is not used.
    #[error("--table: the table is not used: add --cull pvs")]
    NoCulling,
    /// A table is needed and not named.
    #[error("--cull pvs: this needs a table of the scene: name it with --table")]
    NoTable,
    /// A table of something else.
    #[error("{}: does not go with {}: {unlike}", table.display(), scene.display())]
    OtherScene { table: PathBuf, scene: PathBuf, unlike: Unlike },
    /// A sheet that is too large.
    #[error(
        "--size: {n} pictures of {} by {} pixels make a sheet of more than {most} pixels; name fewer methods, or a smaller size",
        size[0], size[1]
    )]
    Sheet { n: usize, size: [u32; 2], most: u64 },
}

from_file_error!(Error);
