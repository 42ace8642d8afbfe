//! Inserts of blocks.

/// An insert of a block.
#[derive(Debug)]
pub(super) struct Insert {
    pub(super) block: String,
    pub(super) at: [f64; 3],
    pub(super) scale: [f64; 3],
    /// In degrees, counter-clockwise.
    pub(super) rotation: f64,
    /// Columns and rows.
    pub(super) counts: [u32; 2],
    pub(super) spacing: [f64; 2],
}
