//! Where each format has what: a table for each.

use super::BspFormat;
use crate::bytes::{i16_at, i32_at, u16_at, u32_at};

/// Where the records of a kind are, and how many bytes one has.
#[derive(Debug, Clone, Copy)]
pub(super) struct Records {
    pub(super) lump: usize,
    pub(super) len: usize,
}

/// A number in a record.
#[derive(Debug, Clone, Copy)]
pub(super) enum Number {
    U16(usize),
    I16(usize),
    U32(usize),
    I32(usize),
}

impl Number {
    pub(super) fn of(self, record: &[u8]) -> i64 {
        match self {
            Self::U16(at) => u16_at(record, at).into(),
            Self::I16(at) => i16_at(record, at).into(),
            Self::U32(at) => u32_at(record, at).into(),
            Self::I32(at) => i32_at(record, at).into(),
        }
    }

    /// Its value, for one that is never negative.
    pub(super) fn count_of(self, record: &[u8]) -> u32 {
        match self {
            Self::U16(at) | Self::I16(at) => u16_at(record, at).into(),
            Self::U32(at) | Self::I32(at) => u32_at(record, at),
        }
    }
}

/// How the six bounds of a leaf are stored.
#[derive(Debug, Clone, Copy)]
pub(super) enum Bounds {
    Short(usize),
    Int(usize),
    Float(usize),
}

impl Bounds {
    pub(super) fn of(self, record: &[u8]) -> [[f32; 3]; 2] {
        let number = |k: usize| match self {
            Self::Short(at) => f32::from(i16_at(record, at + 2 * k)),
            Self::Int(at) => i32_at(record, at + 4 * k) as f32,
            Self::Float(at) => f32::from_bits(u32_at(record, at + 4 * k)),
        };
        [0, 3].map(|first| std::array::from_fn(|k| number(first + k)))
    }
}

/// How visibility is stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::quake) enum RowForm {
    /// Each leaf has the place of a coded row of leafs.
    OfLeafs,
    /// For each cluster the places of two coded rows of clusters: seen and heard.
    SeenAndHeard,
    /// For each cluster a row of clusters as it is, all of one width.
    Raw,
}

/// A list of edges, each with two vertices, and where a face has its run of it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Edges {
    pub(super) edges: Records,
    pub(super) surfedges: usize,
    pub(super) first: Number,
    pub(super) count: Number,
}

/// The corners of faces.
#[derive(Debug, Clone, Copy)]
pub(super) enum FaceForm {
    /// A run of a list of edges.
    Edges(Edges),
    /// A run of vertices, and of indices of these: triangles, or a grid of control points.
    Vertices { indices: usize },
}

#[derive(Debug)]
pub(super) struct Layout {
    pub(super) magic: &'static [u8],
    pub(super) name: &'static str,
    pub(super) game: &'static str,
    /// What its lumps hold, in the order of the directory.
    pub(super) lump_names: &'static [&'static str],
    pub(super) visibility: usize,
    pub(super) row_form: RowForm,
    /// Normal and distance as floats come first in a record.
    pub(super) planes: Records,
    /// The plane comes first in a record, then two children.
    pub(super) nodes: Records,
    pub(super) short_children: bool,
    pub(super) leafs: Records,
    /// What fills a leaf, if the format has that.
    pub(super) leaf_contents: Option<usize>,
    /// The row of a leaf, or its cluster.
    pub(super) leaf_row: Number,
    pub(super) leaf_bounds: Bounds,
    pub(super) leaf_faces: [Number; 2],
    /// Where a leaf has its loudness.
    pub(super) leaf_ambient: Option<usize>,
    /// Whether the compilers of the format compute that loudness.
    pub(super) has_sounds: bool,
    pub(super) models: Records,
    /// Where a model has the root of its tree; without, it is node 0.
    pub(super) model_root: Option<usize>,
    /// Where a model has the number of visible leafs.
    pub(super) model_leafs: Option<usize>,
    /// Where a model has its first face, and behind it their number.
    pub(super) model_faces: usize,
    /// Three floats come first in a record.
    pub(super) vertices: Records,
    pub(super) faces: Records,
    pub(super) face_form: FaceForm,
    /// Where a face has its texinfo.
    pub(super) face_texinfo: Option<Number>,
    pub(super) marks: Records,
}

impl BspFormat {
    pub(super) const fn layout(self) -> &'static Layout {
        match self {
            Self::Bsp29 => &BSP29,
            Self::Bsp2 => &BSP2,
            Self::Bsp2Psb => &BSP2_PSB,
            Self::Quake2 => &QUAKE2,
            Self::HalfLife => &HALF_LIFE,
            Self::Hexen2 => &HEXEN2,
            Self::Qbism => &QBISM,
            Self::Quake3 => &QUAKE3,
            Self::Wolfenstein => &WOLFENSTEIN,
        }
    }
}

const fn records(lump: usize, len: usize) -> Records {
    Records { lump, len }
}

/// Edges, and lists of them, in these lumps; in the variants with wider numbers, too.
const fn edges(lump: usize, surfedges: usize, is_wide: bool) -> FaceForm {
    let (len, first, count) =
        if is_wide { (8, Number::I32(8), Number::U32(12)) } else { (4, Number::I32(4), Number::U16(8)) };
    FaceForm::Edges(Edges { edges: records(lump, len), surfedges, first, count })
}

const BSP29: Layout = Layout {
    magic: &[29, 0, 0, 0],
    name: "BSP 29",
    game: "Quake",
    lump_names: &QUAKE_LUMPS,
    visibility: 4,
    row_form: RowForm::OfLeafs,
    planes: records(1, 20),
    nodes: records(5, 24),
    short_children: true,
    leafs: records(10, 28),
    leaf_contents: Some(0),
    leaf_row: Number::I32(4),
    leaf_bounds: Bounds::Short(8),
    leaf_faces: [Number::U16(20), Number::U16(22)],
    leaf_ambient: Some(24),
    has_sounds: true,
    models: records(14, 64),
    model_root: Some(36),
    model_leafs: Some(52),
    model_faces: 56,
    vertices: records(3, 12),
    faces: records(7, 20),
    face_form: edges(12, 13, false),
    face_texinfo: Some(Number::U16(10)),
    marks: records(11, 2),
};

const BSP2: Layout = Layout {
    magic: b"BSP2",
    name: "BSP2",
    nodes: records(5, 44),
    short_children: false,
    leafs: records(10, 44),
    leaf_bounds: Bounds::Float(8),
    leaf_faces: [Number::U32(32), Number::U32(36)],
    leaf_ambient: Some(40),
    faces: records(7, 28),
    face_form: edges(12, 13, true),
    face_texinfo: Some(Number::U32(16)),
    marks: records(11, 4),
    ..BSP29
};

const BSP2_PSB: Layout = Layout {
    magic: b"2PSB",
    name: "2PSB",
    nodes: records(5, 32),
    leafs: records(10, 32),
    leaf_bounds: Bounds::Short(8),
    leaf_faces: [Number::U32(20), Number::U32(24)],
    leaf_ambient: Some(28),
    ..BSP2
};

/// Colours of light and the textures' own palettes differ, which visibility does not need.
const HALF_LIFE: Layout =
    Layout { magic: &[30, 0, 0, 0], name: "BSP 30", game: "Half-Life", has_sounds: false, ..BSP29 };

/// Models have roots for eight sizes of things that move, instead of four.
const HEXEN2: Layout = Layout {
    name: "BSP 29 of Hexen II",
    game: "Hexen II",
    models: records(14, 80),
    model_leafs: Some(68),
    model_faces: 72,
    ..BSP29
};

const QUAKE2: Layout = Layout {
    magic: b"IBSP\x26\0\0\0",
    name: "IBSP 38",
    game: "Quake II",
    lump_names: &QUAKE2_LUMPS,
    visibility: 3,
    row_form: RowForm::SeenAndHeard,
    nodes: records(4, 28),
    short_children: false,
    leafs: records(8, 28),
    leaf_row: Number::I16(4),
    leaf_ambient: None,
    has_sounds: false,
    models: records(13, 48),
    model_leafs: None,
    model_faces: 40,
    vertices: records(2, 12),
    faces: records(6, 20),
    face_form: edges(11, 12, false),
    face_texinfo: None,
    marks: records(9, 2),
    ..BSP29
};

const QBISM: Layout = Layout {
    magic: b"QBSP\x26\0\0\0",
    name: "QBSP 38",
    game: "Qbism",
    nodes: records(4, 44),
    leafs: records(8, 52),
    leaf_row: Number::I32(4),
    leaf_bounds: Bounds::Float(12),
    leaf_faces: [Number::U32(36), Number::U32(40)],
    faces: records(6, 28),
    face_form: edges(11, 12, true),
    marks: records(9, 4),
    ..QUAKE2
};

const QUAKE3: Layout = Layout {
    magic: b"IBSP\x2e\0\0\0",
    name: "IBSP 46",
    game: "Quake III",
    lump_names: &QUAKE3_LUMPS,
    visibility: 16,
    row_form: RowForm::Raw,
    planes: records(2, 16),
    nodes: records(3, 36),
    leafs: records(4, 48),
    leaf_contents: None,
    leaf_row: Number::I32(0),
    leaf_bounds: Bounds::Int(8),
    leaf_faces: [Number::U32(32), Number::U32(36)],
    models: records(7, 40),
    model_root: None,
    model_faces: 24,
    vertices: records(10, 44),
    faces: records(13, 104),
    face_form: FaceForm::Vertices { indices: 11 },
    marks: records(5, 4),
    ..QUAKE2
};

const WOLFENSTEIN: Layout = Layout { magic: b"IBSP\x2f\0\0\0", name: "IBSP 47", game: "Wolfenstein", ..QUAKE3 };

/// Lumps of Quake, Half-Life and Hexen II.
#[rustfmt::skip]
static QUAKE_LUMPS: [&str; 15] = [
    "entities", "planes", "textures", "vertices", "visibility", "nodes", "texinfo", "faces", "lighting", "clipnodes",
    "leafs", "marksurfaces", "edges", "surfedges", "models",
];

/// Lumps of Quake II and Qbism.
#[rustfmt::skip]
static QUAKE2_LUMPS: [&str; 19] = [
    "entities", "planes", "vertices", "visibility", "nodes", "texinfo", "faces", "lighting", "leafs", "leaffaces",
    "leafbrushes", "edges", "surfedges", "models", "brushes", "brushsides", "pop", "areas", "areaportals",
];

/// Lumps of Quake III.
#[rustfmt::skip]
static QUAKE3_LUMPS: [&str; 17] = [
    "entities", "shaders", "planes", "nodes", "leafs", "leaffaces", "leafbrushes", "models", "brushes", "brushsides",
    "vertices", "indices", "fogs", "faces", "lightmaps", "lightgrid", "visibility",
];
