//! Why a document cannot be written again.

use crate::error::{Malformed, malformed};

/// Why a glTF document cannot be written again with fewer triangles.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum RewriteError {
    /// An extension may speak of what is to change.
    #[error("{place}: extension {name} is not understood, and may depend on what is to be changed")]
    Extension {
        /// Where in the document.
        place: String,
        /// The extension.
        name: String,
    },
    /// Triangles that do not fit the scene, a part of the document that is not what the format says, data that are not sound, or more
    /// than a GLB can hold.
    #[error(transparent)]
    Malformed(#[from] Malformed),
}

impl RewriteError {
    /// The error of a file that would have this many bytes, or has them before it is given up.
    pub(super) fn too_large(len: usize) -> Self {
        malformed!("{len} bytes are too many for a GLB").into()
    }

    /// Refuses so many bytes.
    pub(super) fn check_size(len: usize) -> Result<(), Self> {
        u32::try_from(len).map(|_| ()).map_err(|_| Self::too_large(len))
    }
}
