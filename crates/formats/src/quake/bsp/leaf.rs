//! Leafs, and how many of them can be seen.

use super::BspFormat;
use super::layout::{Layout, RowForm};
use crate::bytes::{bytes_at, i32_at};
use crate::error::{Malformed, malformed};

/// What fills a leaf, as far as eyes care.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LeafKind {
    /// Air, or a liquid.
    Open,
    /// Sky: its sides are drawn, and no eye is in it.
    Sky,
    /// Solid.
    Solid,
}

/// The codes of Quake, Half-Life and Hexen II.
const SOLID: i32 = -2;
const SKY: i32 = -6;
/// The bit of Quake II and Qbism.
const SOLID_BIT: i32 = 1;

/// What a leaf sees according to the map.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LeafRow {
    /// Everything.
    All,
    /// The row at this byte of the visibility lump, which need not be inside.
    At(u32),
    /// What its cluster sees (Quake II and III).
    Cluster(u16),
    /// Nothing: it is in no cluster (Quake II and III).
    Solid,
}

/// A leaf of the map's tree.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BspLeaf {
    /// What fills it, as the format codes it; 0 in Quake III, whose leafs have no such number.
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
    /// Loudness of water, sky, slime and lava; zeros in Quake II and III, which have none.
    pub ambient: [u8; 4],
}

impl BspLeaf {
    /// Its cluster, in Quake II and III and unless it is solid.
    pub fn cluster(&self) -> Option<u16> {
        if let LeafRow::Cluster(cluster) = self.row { Some(cluster) } else { None }
    }

    /// What fills it. In Quake III and its relatives, which do not say that, what is in no cluster is solid.
    ///
    /// # Source
    /// As [`super::Bsp::parse`].
    pub fn kind(&self, format: BspFormat) -> LeafKind {
        let is_solid = match format {
            BspFormat::Quake3 | BspFormat::Wolfenstein => self.cluster().is_none(),
            _ if format.has_clusters() => self.contents & SOLID_BIT != 0,
            _ => self.contents == SOLID,
        };
        match (is_solid, format.has_clusters(), self.contents) {
            (true, _, _) => LeafKind::Solid,
            (_, false, SKY) => LeafKind::Sky,
            _ => LeafKind::Open,
        }
    }
}

pub(super) fn parse_leafs(layout: &Layout, bytes: &[u8]) -> Result<Vec<BspLeaf>, Malformed> {
    let records = bytes.chunks_exact(layout.leafs.len).enumerate();
    records.map(|(leaf, record)| parse_leaf(layout, leaf, record)).collect()
}

fn parse_leaf(layout: &Layout, leaf: usize, record: &[u8]) -> Result<BspLeaf, Malformed> {
    let [mins, maxs] = layout.leaf_bounds.of(record);
    let [first_face, n_faces] = layout.leaf_faces.map(|number| number.count_of(record));
    let found = layout.leaf_row.of(record);
    let row = match (layout.row_form, found) {
        (RowForm::OfLeafs, -1) => LeafRow::All,
        (RowForm::OfLeafs, _) => {
            LeafRow::At(u32::try_from(found).map_err(|_| malformed!("leaf {leaf}: {found} is no place of a row"))?)
        }
        (_, -1) => LeafRow::Solid,
        // Of 16 bits: there are at most `MAX_CLUSTERS`.
        _ => LeafRow::Cluster(u16::try_from(found).map_err(|_| malformed!("leaf {leaf}: {found} is no cluster"))?),
    };
    let ambient = layout.leaf_ambient.map_or([0; 4], |at| bytes_at(record, at));
    let contents = layout.leaf_contents.map_or(0, |at| i32_at(record, at));
    Ok(BspLeaf { contents, row, mins, maxs, first_face, n_faces, ambient })
}

/// The number of visible leafs, from the records of models; model 0 has it at a place.
pub(super) fn visible_leafs(models: &[u8], at: usize, n_leafs: usize) -> Result<usize, Malformed> {
    if models.is_empty() {
        return Err(malformed!("lump 14 (models): there is no model 0"));
    }
    let found = i32_at(models, at);
    let n_visible = usize::try_from(found).ok().filter(|&n| n < n_leafs);
    n_visible.ok_or_else(|| {
        let leafs = format_args!("there are {n_leafs} leafs, one of them for what is solid");
        malformed!("model 0 has {found} visible leafs, but {leafs}")
    })
}
