//! Where cells, portals and rows come from.

use sightlines_geometry::Aabb;
use sightlines_pvs::{CellId, Frame, MirrorId, ObjectId, PortalId};

/// A way out of a cell.
#[derive(Debug, Clone, Copy)]
pub struct PortalEdge<'a> {
    /// The portal, as the table counts them.
    pub portal: PortalId,
    /// Whether it is crossed from its first cell into its second.
    pub forward: bool,
    /// The cell entered.
    pub to: CellId,
    /// Its corners as the table has them, seen from its first cell: in a plane left end, right end; in space
    /// counter-clockwise.
    pub corners: &'a [[f64; 3]],
}

/// A piece of a mirror in a cell.
#[derive(Debug, Clone, Copy)]
pub struct MirrorPiece<'a> {
    /// The mirror; pieces in several cells may have the same.
    pub mirror: MirrorId,
    /// Its corners as seen from the cell: in a plane left end, right end; in space counter-clockwise.
    pub corners: &'a [[f64; 3]],
}

/// A table, in memory or not, as preparing an [`crate::VisibleSubgraph`] reads it. `conformance::CellSources` in
/// `crates/testkit` of the repository tests implementations.
pub trait CellSource {
    /// What may go wrong.
    type Error;

    /// 2 or 3.
    fn dimension(&self) -> u8;

    /// The axes along which all coordinates of the source are; `None`: those of the scene. Views are always those of the scene.
    fn frame(&self) -> Option<Frame>;

    /// Whether there may be air outside every cell in the box around them.
    fn leaves_gaps(&self) -> bool;

    /// Number of cells; ids are below it.
    fn n_cells(&self) -> usize;

    /// Number of objects; ids are below it.
    fn n_objects(&self) -> usize;

    /// The box around a cell, in scene units; it contains the cell's portals.
    ///
    /// # Errors
    /// If the cell cannot be read, as for all that follow.
    fn cell_box(&self, cell: CellId) -> Result<Aabb<3>, Self::Error>;

    /// Puts the cells that `cell` may see, itself included, into `out`, which is cleared; ascending.
    ///
    /// # Errors
    /// As [`CellSource::cell_box`].
    fn visible(&self, cell: CellId, out: &mut Vec<CellId>) -> Result<(), Self::Error>;

    /// Shows the ways out of a cell, by ascending portal.
    ///
    /// # Errors
    /// As [`CellSource::cell_box`].
    fn portal_edges(&self, cell: CellId, show: &mut dyn FnMut(PortalEdge<'_>)) -> Result<(), Self::Error>;

    /// Puts the objects that touch a cell into `out`, which is cleared; ascending.
    ///
    /// # Errors
    /// As [`CellSource::cell_box`].
    fn objects_of(&self, cell: CellId, out: &mut Vec<ObjectId>) -> Result<(), Self::Error>;

    /// Puts the objects that `cell` may see into `out`, which is cleared; ascending.
    ///
    /// # Errors
    /// As [`CellSource::cell_box`].
    fn objects_seen(&self, cell: CellId, out: &mut Vec<ObjectId>) -> Result<(), Self::Error>;

    /// The box around an object, in scene units.
    ///
    /// # Errors
    /// As [`CellSource::cell_box`].
    fn object_box(&self, object: ObjectId) -> Result<Aabb<3>, Self::Error>;

    /// Shows the pieces of mirrors in a cell.
    ///
    /// # Errors
    /// As [`CellSource::cell_box`].
    fn mirrors(&self, cell: CellId, show: &mut dyn FnMut(MirrorPiece<'_>)) -> Result<(), Self::Error>;

    /// Puts the nodes of the stab trees with which the sequences out of a cell begin into `out`, which is cleared, ascending: whether the
    /// tree was cut at once, so that any way may follow. `None` without stab trees.
    ///
    /// # Errors
    /// As [`CellSource::cell_box`].
    fn stab_roots(&self, cell: CellId, out: &mut Vec<u32>) -> Result<Option<bool>, Self::Error>;

    /// A node of the stab trees; puts what may be crossed after it into `children`, which is cleared.
    ///
    /// # Errors
    /// As [`CellSource::cell_box`].
    fn stab_node(&self, node: u32, children: &mut Vec<u32>) -> Result<StabStep, Self::Error>;
}

/// A node of stab trees.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StabStep {
    /// The portal that is crossed.
    pub portal: PortalId,
    /// Whether the tree was cut here: any way may follow.
    pub open: bool,
}
