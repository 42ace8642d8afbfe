//! Why a document cannot be written again.

use crate::scene::error::AccessorErrorKind;

/// Why a glTF document cannot be written again with fewer triangles.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RewriteError {
    /// The text is nested more deeply than what is written again may be.
    #[error("the glTF text cannot be written again: {source}")]
    Json {
        /// What is wrong, with line and column in the text.
        source: serde_json::Error,
    },
    /// There is not one answer for each object.
    #[error("triangles of {found} objects for a scene of {expected}")]
    Objects {
        /// Lists of triangles that there are.
        found: usize,
        /// Objects of the scene.
        expected: usize,
    },
    /// A new triangle names a vertex that its object does not have.
    #[error("object {object}, triangle {triangle}: there is no vertex {vertex}")]
    Index {
        /// Index of the object.
        object: usize,
        /// Index of the new triangle.
        triangle: usize,
        /// The vertex that it names.
        vertex: u32,
    },
    /// A part of the document is not what the format says.
    #[error("{place} is not {expected}")]
    Form {
        /// Where in the document.
        place: String,
        /// What it should be.
        expected: &'static str,
    },
    /// Data that have to be copied are not sound.
    #[error("accessor {accessor}: {kind}")]
    Accessor {
        /// Its index in the document.
        accessor: usize,
        /// What is wrong with it.
        #[source]
        kind: AccessorErrorKind,
    },
    /// An attribute has fewer elements than there are corners.
    #[error("accessor {accessor}: there is no element {index} of {count}")]
    Element {
        /// Its index in the document.
        accessor: usize,
        /// The element that a corner needs.
        index: usize,
        /// Elements that there are.
        count: usize,
    },
    /// Bytes that have to be kept are not there.
    #[error("buffer view {view}: {kind}")]
    View {
        /// Its index in the document.
        view: usize,
        /// What is wrong with it.
        #[source]
        kind: AccessorErrorKind,
    },
    /// An extension may speak of what is to change.
    #[error("{place}: extension {name} is not understood, and may depend on what is to be changed")]
    Extension {
        /// Where in the document.
        place: String,
        /// The extension.
        name: String,
    },
    /// A GLB has at most 4 GiB.
    #[error("{len} bytes are too many for a GLB")]
    TooLarge {
        /// Bytes of the file, or as many as were counted before it was given up.
        len: usize,
    },
}
