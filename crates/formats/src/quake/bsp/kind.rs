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

/// Quake's codes.
const SOLID: i32 = -2;
const SKY: i32 = -6;
/// Quake II's bit.
const SOLID_BIT: i32 = 1;

impl BspLeaf {
    /// What fills it.
    ///
    /// # Source
    /// As [`super::Bsp::parse`].
    pub fn kind(&self, format: BspFormat) -> LeafKind {
        match (format, self.contents) {
            (BspFormat::Quake2, contents) if contents & SOLID_BIT != 0 => LeafKind::Solid,
            (BspFormat::Bsp29 | BspFormat::Bsp2 | BspFormat::Bsp2Psb, SOLID) => LeafKind::Solid,
            (BspFormat::Bsp29 | BspFormat::Bsp2 | BspFormat::Bsp2Psb, SKY) => LeafKind::Sky,
            _ => LeafKind::Open,
        }
    }
}
