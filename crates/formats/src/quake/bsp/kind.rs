//! What leafs are made of.

use super::{BspFormat, BspLeaf};

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

impl BspLeaf {
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
