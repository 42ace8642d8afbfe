//! Why a scene cannot be written.

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
        what: &'static str,
    },
    /// A GLB has at most 4 GiB.
    #[error("{len} bytes are too many for a GLB")]
    TooLarge {
        /// Bytes of the file.
        len: usize,
    },
}
