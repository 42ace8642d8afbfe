//! What can be wrong with a file of a scene in space, and where.

use sightlines_cells::SceneError;
use sightlines_geometry::CoordinateError;
use std::fmt;
use std::io;

/// A node in an error message, shown as `node 3 ("Wall")`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NodeId {
    /// Its index in the document.
    pub index: usize,
    /// Its name, if it has one.
    pub name: Option<String>,
}

impl fmt::Display for NodeId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.name {
            // As a Rust string: a name may hold anything, and a message should stay one line.
            Some(name) => write!(f, "node {} ({name:?})", self.index),
            None => write!(f, "node {}", self.index),
        }
    }
}

/// Why a file is not a scene that can be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SceneReadError {
    /// Neither a GLB nor a glTF text nor named like an OBJ.
    #[error("neither GLB nor glTF nor OBJ")]
    UnknownFormat,
    /// The GLB container is not sound.
    #[error(transparent)]
    Glb(#[from] GlbError),
    /// A glTF text that is not UTF-8.
    #[error("byte {offset} of the glTF text is not UTF-8")]
    Utf8 {
        /// Where in the text.
        offset: usize,
    },
    /// A glTF text that is not JSON or not a glTF document.
    #[error("the glTF text cannot be read: {source}")]
    Json {
        /// What is wrong, with line and column in the text.
        source: serde_json::Error,
    },
    /// Another version of glTF than 2.
    #[error("glTF version {found:?} is not 2.x")]
    Version {
        /// The version that the document states.
        found: String,
    },
    /// The geometry is coded in a way that is not understood.
    #[error("extension {name} is not understood{}", remedy(name))]
    Extension {
        /// The extension.
        name: String,
    },
    /// The default scene does not exist.
    #[error("there is no scene {scene}, which should be the default")]
    NoScene {
        /// Its index.
        scene: usize,
    },
    /// None of the scenes is the one that is asked for.
    #[error("there is no scene {name:?}, but {}", if names.is_empty() { "none".to_owned() } else { names.join(", ") })]
    NoSuchScene {
        /// The name or index that is asked for.
        name: String,
        /// The names of all scenes, or indices.
        names: Vec<String>,
    },
    /// A scene lists a node that does not exist.
    #[error("scene {scene}: there is no node {node}")]
    NoRoot {
        /// Index of the scene.
        scene: usize,
        /// The node that it lists.
        node: usize,
    },
    /// A node cannot be used.
    #[error("{node}: {kind}")]
    Node {
        /// The node.
        node: NodeId,
        /// What is wrong with it.
        kind: NodeErrorKind,
    },
    /// A primitive of a node's mesh cannot be used.
    #[error("{node}, primitive {primitive}: {kind}")]
    Primitive {
        /// The node, the first in document order that has the mesh.
        node: NodeId,
        /// Index of the primitive in the mesh.
        primitive: usize,
        /// What is wrong with it.
        #[source]
        kind: Box<PrimitiveErrorKind>,
    },
    /// A line of an OBJ cannot be used.
    #[error("line {line}: {kind}")]
    Obj {
        /// The line, from 1.
        line: usize,
        /// What is wrong with it.
        #[source]
        kind: ObjErrorKind,
    },
    /// Nothing in the scene has a face.
    #[error("no triangles ({n_objects} objects, {n_degenerate} triangles without area)")]
    NoTriangles {
        /// Objects that were read.
        n_objects: usize,
        /// Triangles that were left out because they have no area.
        n_degenerate: usize,
    },
    /// The whole is not a scene.
    #[error(transparent)]
    Scene(#[from] SceneError),
}

/// The command that writes a file without an extension, if there is a usual one.
fn remedy(extension: &str) -> &'static str {
    match extension {
        "KHR_draco_mesh_compression" | "EXT_meshopt_compression" => {
            "; `npx @gltf-transform/cli cp IN.glb OUT.glb` unpacks the file"
        }
        "KHR_meshopt_compression" => "; `gltfpack -i IN.glb -o OUT.glb -noq -kn -km` unpacks the file",
        _ => "",
    }
}

/// Why bytes are not a GLB container.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum GlbError {
    /// Fewer bytes than a header has.
    #[error("not a GLB: {len} bytes are less than a header")]
    NoHeader {
        /// Bytes there are.
        len: usize,
    },
    /// Another version of the container than 2.
    #[error("GLB version {found} is not 2")]
    Version {
        /// The version in the header.
        found: u32,
    },
    /// The header states a length that the file does not have.
    #[error("the header states {stated} bytes, the file has {len}")]
    Length {
        /// Bytes that the header states.
        stated: u32,
        /// Bytes there are.
        len: usize,
    },
    /// A chunk, its header included, is not inside the file.
    #[error("the chunk at byte {offset} is not inside the {len} bytes of the file")]
    Chunk {
        /// Where it begins.
        offset: usize,
        /// Bytes there are.
        len: usize,
    },
    /// The first chunk is missing or is not the text.
    #[error("the first chunk is not JSON")]
    NoJson,
}

/// Why a node cannot be used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum NodeErrorKind {
    /// It lists a child that does not exist.
    #[error("there is no node {child}, which it has as a child")]
    NoChild {
        /// The child that it lists.
        child: usize,
    },
    /// It is reached twice: by two parents, by one parent twice, or below itself.
    #[error("reached twice, though nodes form trees")]
    ReachedTwice,
    /// Its mesh does not exist.
    #[error("there is no mesh {mesh}")]
    NoMesh {
        /// The mesh that it names.
        mesh: usize,
    },
    /// It has a matrix and also a translation, rotation or scale.
    #[error("both a matrix and a translation, rotation or scale")]
    TwoTransforms,
    /// The last row of its matrix is not 0, 0, 0, 1.
    #[error("its matrix is not affine")]
    NotAffine,
    /// Its rotation is a quaternion of length zero.
    #[error("its rotation is the zero quaternion")]
    ZeroRotation,
    /// It is to be drawn many times, and nowhere.
    #[error("EXT_mesh_gpu_instancing without TRANSLATION, ROTATION or SCALE")]
    NoInstances,
    /// An attribute of its instances cannot be read, or has another number of elements than the others.
    #[error("EXT_mesh_gpu_instancing: {attribute} (accessor {accessor}) does not fit")]
    Instances {
        /// The attribute.
        attribute: &'static str,
        /// Its accessor.
        accessor: usize,
    },
}

/// What an accessor is used for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AccessorRole {
    /// Corners of a primitive.
    Positions,
    /// Indices into the corners.
    Indices,
    /// Anything else that corners have, or that a document keeps.
    Attribute,
}

impl fmt::Display for AccessorRole {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Positions => "positions",
            Self::Indices => "indices",
            Self::Attribute => "attribute",
        })
    }
}

/// Why a primitive cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PrimitiveErrorKind {
    /// It has no corners.
    #[error("no positions")]
    NoPositions,
    /// It is drawn in a way that glTF does not have.
    #[error("mode {mode} does not exist")]
    Mode {
        /// The mode that it states.
        mode: u32,
    },
    /// Its number of corners is not that of a list of triangles.
    #[error("{n_corners} corners are no list of triangles")]
    Corners {
        /// Indices, or positions if there are no indices.
        n_corners: usize,
    },
    /// An accessor cannot be used.
    #[error("{role} (accessor {accessor}): {kind}")]
    Accessor {
        /// What it is for.
        role: AccessorRole,
        /// Its index in the document.
        accessor: usize,
        /// What is wrong with it.
        #[source]
        kind: AccessorErrorKind,
    },
    /// An index names a corner that does not exist.
    #[error("index {position} is {index}, but there are {n_positions} positions")]
    Index {
        /// Which index.
        position: usize,
        /// Its value.
        index: u32,
        /// Corners there are.
        n_positions: usize,
    },
    /// A corner lies nowhere.
    #[error("position {vertex}: {kind}")]
    Vertex {
        /// Index of the corner in the file.
        vertex: usize,
        /// What is wrong with it, in world coordinates.
        #[source]
        kind: CoordinateError,
    },
    /// With it the scene has more than a scene may have.
    #[error("with it the scene has more than {max} {what}")]
    TooMany {
        /// What there is too much of.
        what: &'static str,
        /// The most there may be.
        max: usize,
    },
}

/// Why an accessor cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum AccessorErrorKind {
    /// It does not exist.
    #[error("it does not exist")]
    Missing,
    /// It has no elements.
    #[error("it has no elements")]
    Empty,
    /// Its elements are of another kind.
    #[error("elements of type {found:?} with components {component} cannot be that")]
    Type {
        /// The type that it states.
        found: String,
        /// The kind of components that it states.
        component: u32,
    },
    /// Its buffer view does not exist.
    #[error("there is no buffer view {view}")]
    NoView {
        /// The buffer view.
        view: usize,
    },
    /// The stride of its buffer view is less than one element.
    #[error("buffer view {view}: stride {stride} is less than {size} bytes of an element")]
    Stride {
        /// The buffer view.
        view: usize,
        /// Its stride.
        stride: usize,
        /// Bytes of an element.
        size: usize,
    },
    /// Elements lie outside the buffer view.
    #[error("{count} elements are not inside the {len} bytes of buffer view {view}")]
    Range {
        /// The buffer view.
        view: usize,
        /// Elements that it states.
        count: usize,
        /// Bytes of the buffer view.
        len: usize,
    },
    /// The buffer view lies outside the buffer.
    #[error("buffer view {view} is not inside the {len} bytes of buffer {buffer}")]
    ViewRange {
        /// The buffer view.
        view: usize,
        /// Its buffer.
        buffer: usize,
        /// Bytes of the buffer.
        len: usize,
    },
    /// The buffer cannot be used.
    #[error("buffer {buffer}: {kind}")]
    Buffer {
        /// Its index in the document.
        buffer: usize,
        /// What is wrong with it.
        #[source]
        kind: BufferErrorKind,
    },
    /// A sparse index does not ascend, or there is no such element.
    #[error("sparse index {position} does not ascend or is not below {count}")]
    Sparse {
        /// Which sparse index.
        position: usize,
        /// Elements of the accessor.
        count: usize,
    },
    /// It has no buffer view and states more elements than the document has bytes.
    #[error("{count} elements that are in no buffer")]
    Unbacked {
        /// Elements that it states.
        count: usize,
    },
}

/// Why a buffer cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BufferErrorKind {
    /// It does not exist.
    #[error("it does not exist")]
    Missing,
    /// It has no URI, and is not the binary chunk of a GLB.
    #[error("it has no URI and there is no binary chunk for it")]
    NoData,
    /// There are fewer bytes than it states.
    #[error("it states {stated} bytes, there are {len}")]
    Length {
        /// Bytes that it states.
        stated: usize,
        /// Bytes there are.
        len: usize,
    },
    /// Its data URI is not base64.
    #[error("its data URI is not base64")]
    DataUri,
    /// Its URI does not name a file in or below the folder of the scene.
    #[error("{uri:?} is not a file in the scene's folder")]
    Uri {
        /// The URI.
        uri: String,
    },
    /// Its file cannot be read.
    #[error("{uri:?} cannot be read: {source}")]
    Io {
        /// The URI.
        uri: String,
        /// The error of the system.
        source: io::Error,
    },
}

/// Why a line of an OBJ cannot be used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ObjErrorKind {
    /// A line that matters is not UTF-8.
    #[error("not UTF-8")]
    Utf8,
    /// A corner without three numbers.
    #[error("a corner needs three numbers")]
    Vertex,
    /// A corner with a weight, which means something for curves only.
    #[error("a corner with a weight other than 1")]
    Weight,
    /// A number that cannot be a coordinate.
    #[error(transparent)]
    Coordinate(#[from] CoordinateError),
    /// A corner of a face that is not an index.
    #[error("a face needs indices of corners")]
    FaceIndex,
    /// A face with fewer than three corners.
    #[error("a face needs three corners or more")]
    FaceCorners,
    /// A face names a corner that does not exist.
    #[error("there is no corner {index}")]
    Index {
        /// The index as the file has it.
        index: i64,
    },
    /// A face whose outline crosses itself, or a bent face that looks so from every axis.
    #[error("the outline of the face crosses itself")]
    Crossing,
    /// A face that is not star-shaped and has too many corners to be cut into triangles.
    #[error("a winding face of {n_corners} corners, more than {max}")]
    LargeFace {
        /// Corners of the face.
        n_corners: usize,
        /// The most there may be.
        max: usize,
    },
    /// With it the scene has more than a scene may have.
    #[error("with it the scene has more than {max} triangles")]
    TooMany {
        /// The most there may be.
        max: usize,
    },
}

impl From<SceneReadError> for crate::ReadErrorKind {
    fn from(error: SceneReadError) -> Self {
        Self::content(error)
    }
}
