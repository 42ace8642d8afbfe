//! Leafs, and how many of them can be seen.

use super::{BspError, BspFormat, bytes_at, i16_at, i32_at, u16_at, u32_at};

/// Index of the lump of models, in all formats but Quake II's.
pub(super) const MODELS: usize = 14;
/// Bytes of a model there.
pub(super) const MODEL_LEN: usize = 64;
/// Where a model states how many leafs can be seen: behind 9 floats and 4 nodes.
const MODEL_LEAFS: usize = 52;
/// Where a leaf has its place of a row, in all formats but Quake II's.
pub(super) const LEAF_ROW: usize = 4;

/// What a leaf sees according to the map.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LeafRow {
    /// Everything.
    All,
    /// The row at this byte of the visibility lump, which need not be inside.
    At(u32),
    /// What its cluster sees (Quake II).
    Cluster(u16),
    /// Nothing: it is in no cluster (Quake II).
    Solid,
}

/// A leaf of the map's tree.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BspLeaf {
    /// What fills it, as the format codes it.
    pub contents: i32,
    /// What it sees.
    pub row: LeafRow,
    /// Low corner, in scene units.
    pub mins: [f32; 3],
    /// High corner, in scene units.
    pub maxs: [f32; 3],
    /// Its first face, as an index of the list of faces of leafs.
    pub first_face: u32,
    /// Number of its faces.
    pub n_faces: u32,
    /// Loudness of water, sky, slime and lava; zeros in Quake II, which has none.
    pub ambient: [u8; 4],
}

impl BspLeaf {
    /// Its cluster, in Quake II and unless it is solid.
    pub fn cluster(&self) -> Option<u16> {
        if let LeafRow::Cluster(cluster) = self.row { Some(cluster) } else { None }
    }
}

/// Bytes of a leaf.
pub(super) const fn leaf_len(format: BspFormat) -> usize {
    match format {
        BspFormat::Bsp29 | BspFormat::Quake2 => 28,
        BspFormat::Bsp2 => 44,
        BspFormat::Bsp2Psb => 32,
    }
}

/// Reads leafs from a whole number of records.
pub(super) fn parse_leafs(format: BspFormat, bytes: &[u8]) -> Result<Vec<BspLeaf>, BspError> {
    let records = bytes.chunks_exact(leaf_len(format)).enumerate();
    records.map(|(leaf, record)| parse_leaf(format, leaf, record)).collect()
}

fn parse_leaf(format: BspFormat, leaf: usize, record: &[u8]) -> Result<BspLeaf, BspError> {
    let short = |k: usize| f32::from(i16_at(record, 8 + 2 * k));
    let float = |k: usize| f32::from_bits(u32_at(record, 8 + 4 * k));
    let bounds: [f32; 6] = std::array::from_fn(|k| if format == BspFormat::Bsp2 { float(k) } else { short(k) });
    let (first_face, n_faces) = match format {
        BspFormat::Bsp29 | BspFormat::Quake2 => (u32::from(u16_at(record, 20)), u32::from(u16_at(record, 22))),
        BspFormat::Bsp2Psb => (u32_at(record, 20), u32_at(record, 24)),
        BspFormat::Bsp2 => (u32_at(record, 32), u32_at(record, 36)),
    };
    let (row, ambient) = match format {
        BspFormat::Quake2 => (cluster_row(leaf, i16_at(record, LEAF_ROW))?, [0; 4]),
        _ => (offset_row(leaf, i32_at(record, LEAF_ROW))?, bytes_at(record, record.len() - 4)),
    };
    let [x0, y0, z0, x1, y1, z1] = bounds;
    let (mins, maxs) = ([x0, y0, z0], [x1, y1, z1]);
    Ok(BspLeaf { contents: i32_at(record, 0), row, mins, maxs, first_face, n_faces, ambient })
}

fn offset_row(leaf: usize, found: i32) -> Result<LeafRow, BspError> {
    match found {
        -1 => Ok(LeafRow::All),
        _ => u32::try_from(found).map(LeafRow::At).map_err(|_| BspError::LeafRow { leaf, found }),
    }
}

fn cluster_row(leaf: usize, found: i16) -> Result<LeafRow, BspError> {
    match found {
        -1 => Ok(LeafRow::Solid),
        _ => u16::try_from(found).map(LeafRow::Cluster).map_err(|_| BspError::LeafCluster { leaf, found }),
    }
}

/// The number of visible leafs, from the records of models.
pub(super) fn visible_leafs(models: &[u8], n_leafs: usize) -> Result<usize, BspError> {
    if models.is_empty() {
        return Err(BspError::NoWorld);
    }
    let found = i32_at(models, MODEL_LEAFS);
    let n_visible = usize::try_from(found).ok().filter(|&n| n < n_leafs);
    n_visible.ok_or(BspError::VisibleLeafs { found, n_leafs })
}
