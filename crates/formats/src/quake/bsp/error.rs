//! What can be wrong with a map, and where.

use super::MAX_TREE_DEPTH;
use std::fmt;

/// A lump in an error message, shown as `lump 10 (leafs)`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BspLumpId {
    /// Its index in the directory.
    pub index: usize,
    /// What it holds.
    pub name: &'static str,
}

impl fmt::Display for BspLumpId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "lump {} ({})", self.index, self.name)
    }
}

/// Why bytes are not a map that can be used, or a map cannot be written.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum BspError {
    /// Fewer bytes than a header has.
    #[error("not a map: {len} bytes are less than a header of {needed}")]
    NoHeader {
        /// Bytes there are.
        len: usize,
        /// Bytes that the header of this version has, or of any version has at least.
        needed: usize,
    },
    /// It begins like no version that is known.
    #[error(
        "not a map: it begins with \"{}\", not with version 29 or 30, BSP2, 2PSB, IBSP and version 38, 46 or 47, or QBSP and version 38",
        found.escape_ascii()
    )]
    Version {
        /// The first eight bytes.
        found: [u8; 8],
    },
    /// A map of Half-Life: Blue Shift, which has the first two lumps the other way round.
    #[error(
        "lump 0 has planes and lump 1 has none, as in maps of Half-Life: Blue Shift, which are not read; with the first two entries of the directory exchanged this is a map of Half-Life"
    )]
    BlueShift,
    /// A map with more lumps than its version has, as Quake Live's: they would be lost.
    #[error(
        "the directory has an entry for lump {index}, which version {version} does not have: {len} bytes at byte {offset}; such maps (of Quake Live) are not read"
    )]
    MoreLumps {
        /// The number of the version.
        version: i32,
        /// The index of the first such lump.
        index: usize,
        /// Its place, as the directory has it.
        offset: i32,
        /// Its length, as the directory has it.
        len: i32,
    },
    /// A lump is not inside the file.
    #[error("{lump}: {len} bytes at byte {offset} are not inside the file of {file_len} bytes")]
    LumpRange {
        /// The lump.
        lump: BspLumpId,
        /// Its place, as the directory has it.
        offset: i32,
        /// Its length, as the directory has it.
        len: i32,
        /// Length of the file.
        file_len: usize,
    },
    /// A lump lies over the header.
    #[error("{lump} overlaps the header")]
    OverlapsHeader {
        /// The lump.
        lump: BspLumpId,
    },
    /// A lump is not a whole number of records.
    #[error("{lump}: {len} bytes are no whole number of records of {record}")]
    LumpLength {
        /// The lump.
        lump: BspLumpId,
        /// Its length in bytes.
        len: usize,
        /// Bytes of a record.
        record: usize,
    },
    /// The directory of lumps behind the end (BSPX) is not inside the file, or an entry of it is not.
    #[error("the BSPX directory at byte {at} is not sound: {n_lumps} lumps, the first bad one is {bad}")]
    Bspx {
        /// Where it begins.
        at: usize,
        /// How many lumps it claims.
        n_lumps: u32,
        /// Index of the first that is not inside the file; 0 if the directory itself is not.
        bad: usize,
    },
    /// There is no model 0, which states how many leafs can be seen.
    #[error("lump 14 (models): there is no model 0")]
    NoWorld,
    /// More leafs can be seen than there are, besides leaf 0.
    #[error("model 0 has {found} visible leafs, but there are {n_leafs} leafs, one of them for what is solid")]
    VisibleLeafs {
        /// How many it states.
        found: i32,
        /// How many leafs there are.
        n_leafs: usize,
    },
    /// The place of a leaf's row makes no sense.
    #[error("leaf {leaf}: {found} is no place of a row")]
    LeafRow {
        /// The leaf, as the map counts.
        leaf: usize,
        /// The number there.
        found: i32,
    },
    /// The cluster of a leaf makes no sense.
    #[error("leaf {leaf}: {found} is no cluster")]
    LeafCluster {
        /// The leaf, as the map counts.
        leaf: usize,
        /// The number there.
        found: i32,
    },
    /// The faces of a leaf are not in their list.
    #[error("leaf {leaf}: faces {first} to {first} + {count} of the list are not among its {n_listed}")]
    LeafFaces {
        /// The leaf, as the map counts.
        leaf: usize,
        /// The first, as an index of the list.
        first: u32,
        /// How many.
        count: u32,
        /// Length of the list.
        n_listed: usize,
    },
    /// A leaf has a face that does not exist.
    #[error("leaf {leaf}: there is no face {face} among {n_faces}")]
    Face {
        /// The leaf, as the map counts.
        leaf: usize,
        /// The face.
        face: u32,
        /// How many there are.
        n_faces: usize,
    },
    /// The texture of a face cannot be looked up.
    #[error("leaf {leaf}: face {face} has a texture that is not in the file")]
    Texture {
        /// The leaf, as the map counts.
        leaf: usize,
        /// The face.
        face: u32,
    },
    /// There is no model 0, which is the world.
    #[error("{lump}: there is no model 0")]
    NoModel {
        /// The lump of models.
        lump: BspLumpId,
    },
    /// A record names one of another lump that is not there.
    #[error("{lump}: record {record} names record {found} of {of}, which has {n}")]
    Reference {
        /// The lump.
        lump: BspLumpId,
        /// The record, as an index of the lump.
        record: usize,
        /// What it names.
        found: i64,
        /// The lump that should have it.
        of: BspLumpId,
        /// Records of that lump.
        n: usize,
    },
    /// A plane without a direction or a place.
    #[error("{lump}: plane {plane} has no normal of unit length, or no finite distance")]
    NotAPlane {
        /// The lump of planes.
        lump: BspLumpId,
        /// The plane.
        plane: usize,
    },
    /// Two ways from the root of the world's tree lead to one node.
    #[error("{lump}: node {node} is reached twice, so this is no tree")]
    NodeTwice {
        /// The lump of nodes.
        lump: BspLumpId,
        /// The node.
        node: usize,
    },
    /// A tree deeper than is followed.
    #[error("{lump}: node {node} is {MAX_TREE_DEPTH} steps below the root, more than are followed")]
    TreeDepth {
        /// The lump of nodes.
        lump: BspLumpId,
        /// The node.
        node: usize,
    },
    /// A corner of faces is nowhere.
    #[error("{lump}: vertex {vertex} has a coordinate that is not a finite number")]
    Vertex {
        /// The lump of vertices.
        lump: BspLumpId,
        /// The vertex.
        vertex: usize,
    },
    /// A run of records that a record names is not in its lump.
    #[error("{lump}: record {record} names {count} records from {first} on of {of}, which has {n}")]
    Run {
        /// The lump.
        lump: BspLumpId,
        /// The record, as an index of the lump.
        record: usize,
        /// The first record that it names.
        first: i64,
        /// How many it names.
        count: i64,
        /// The lump that should have them.
        of: BspLumpId,
        /// Records of that lump.
        n: usize,
    },
    /// The grid of a curved face is not as large as it has points.
    #[error("{lump}: face {face}: a grid of {width} by {height} has not its {n} points")]
    Grid {
        /// The lump of faces.
        lump: BspLumpId,
        /// The face.
        face: usize,
        /// Points in a row.
        width: i64,
        /// Rows.
        height: i64,
        /// Points that the face has.
        n: usize,
    },
    /// Runs that share a list so much that they are longer than any file.
    #[error("{lump}: its records name {n_named} records of {of}, which has {n}: they share more than is read")]
    SharedRuns {
        /// The lump.
        lump: BspLumpId,
        /// Sum of the lengths of the runs.
        n_named: u64,
        /// The lump that has them.
        of: BspLumpId,
        /// Records of that lump.
        n: usize,
    },
    /// Places of rows for another number of leafs than can be seen.
    #[error("the rows are for {found} leafs, the map has {n_leafs} that can be seen")]
    RowCount {
        /// How many leafs there are rows for.
        found: usize,
        /// How many leafs can be seen.
        n_leafs: usize,
    },
    /// A lump that has to change shares bytes with another.
    #[error("{lump} has to change, but {other} lies over it")]
    Shared {
        /// The lump.
        lump: BspLumpId,
        /// The other.
        other: BspLumpId,
    },
    /// The file to be written would be larger than its 32-bit places can say.
    #[error("the file would have {len} bytes, more than a map can have")]
    TooLarge {
        /// Bytes that it would have.
        len: u64,
    },
}

impl From<BspError> for crate::ReadErrorKind {
    fn from(error: BspError) -> Self {
        Self::content(error)
    }
}
