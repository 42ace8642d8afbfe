//! Why `render` fails.

use crate::error::InputError;
use crate::error::OutputError;
use crate::eye::EyeError;
use crate::picture::PictureError;
use sightlines::formats::ReadError;
use sightlines::visible_surface::FacesError;
use std::path::PathBuf;

/// Why `render` fails; exit code 2.
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
    /// A picture that cannot be drawn or written.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// An eye that sees nothing.
    #[error(transparent)]
    Eye(#[from] EyeError),
    /// A scene that is too large.
    #[error("{}: {source}", path.display())]
    Faces { path: PathBuf, source: FacesError },
    /// Several methods, and one picture.
    #[error("--method: several methods are drawn with --compare only; name one")]
    ManyMethods,
    /// A depth format, and no z-buffer.
    #[error("--depth: this is what a z-buffer keeps, and none is drawn: add --method zbuffer")]
    NoBuffer,
    /// A table that nobody asks.
    #[error("--table: nothing is asked of the table: add --cull pvs")]
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

/// What a table and a scene do not have in common.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub(crate) enum Unlike {
    #[error("the table is of a plan")]
    Plane,
    #[error("the table has {table} objects, the scene {scene}")]
    Count { table: usize, scene: usize },
    #[error("object {object} is called {table:?} in the table and {scene:?} in the scene")]
    Name { object: u32, table: String, scene: String },
    #[error("object {object}, {name:?}, is not where the table has it")]
    Box { object: u32, name: String },
}
