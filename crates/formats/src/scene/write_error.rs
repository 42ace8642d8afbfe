//! Why a scene cannot be written.

use std::fmt;

/// What an OBJ cannot hold of an object.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum ObjLimit {
    /// A name that a line cannot end with: empty, with spaces at an end, with a line break, or with a backslash at its end.
    Name,
    /// A mirror whose name does not state it, or a name that states it of something else.
    Mirror,
    /// Something that moves.
    Moves,
    /// Something of which only the fronts are drawn.
    SingleSided,
    /// An object without triangles.
    Empty,
}

impl fmt::Display for ObjLimit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Name => "its name",
            Self::Mirror => "a mirror whose name does not end in -mirror, nor such a name of anything else",
            Self::Moves => "what moves",
            Self::SingleSided => "what has one side",
            Self::Empty => "what has no triangles",
        })
    }
}

/// Why a scene cannot be written as GLB or OBJ.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SceneWriteError {
    /// GLB holds single precision, and the coordinate needs more.
    #[error("object {object}, vertex {vertex}: {value:?} is not a number of single precision")]
    Precision {
        /// Index of the object.
        object: usize,
        /// Index of the vertex in it.
        vertex: usize,
        /// The coordinate.
        value: f64,
    },
    /// glTF has no meshes without corners.
    #[error("object {object} has no vertices")]
    Empty {
        /// Index of the object.
        object: usize,
    },
    /// An OBJ cannot hold an object.
    #[error("object {object}: an OBJ cannot hold {what}")]
    Obj {
        /// Index of the object.
        object: usize,
        /// What of it.
        what: ObjLimit,
    },
    /// A GLB has at most 4 GiB.
    #[error("{len} bytes are too many for a GLB")]
    TooLarge {
        /// Bytes of the file.
        len: usize,
    },
}
