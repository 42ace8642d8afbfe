//! Packed tables for both roles: the resident part, and the data read on demand.

use crate::coarse::CoarseVisibility;
use crate::facts::TableFacts;
use sightlines_eye_to_cell::{CellSource, MirrorPiece, PortalEdge, StabStep};
use sightlines_geometry::Aabb;
use sightlines_packed::{ByteSource, Packed, PackedError};
use sightlines_pvs::{Axis, CellId, DoorRecord, Frame, ObjectId, ObjectSource, Place, PlaceBuffer, TriangleRange};
use std::sync::Arc;

/// A packed table, shared by the frames and the thread that reads ahead.
#[derive(Debug)]
pub struct PackedCells<S: ByteSource>(Arc<Packed<S>>);

impl<S: ByteSource> Clone for PackedCells<S> {
    fn clone(&self) -> Self {
        Self(Arc::clone(&self.0))
    }
}

impl<S: ByteSource> PackedCells<S> {
    /// Shares a table.
    pub fn new(packed: Packed<S>) -> Self {
        Self(Arc::new(packed))
    }

    /// The table.
    pub fn packed(&self) -> &Packed<S> {
        &self.0
    }
}

fn bounds((min, max): ([f64; 3], [f64; 3])) -> Aabb<3> {
    Aabb { min, max }
}

impl<S: ByteSource> CellSource for PackedCells<S> {
    type Error = PackedError;

    fn dimension(&self) -> u8 {
        self.0.dimension()
    }

    fn frame(&self) -> Option<Frame> {
        self.0.frame().copied()
    }

    fn leaves_gaps(&self) -> bool {
        self.0.kind().leaves_gaps()
    }

    fn n_cells(&self) -> usize {
        self.0.n_cells()
    }

    fn n_objects(&self) -> usize {
        self.0.n_objects()
    }

    fn cell_box(&self, cell: CellId) -> Result<Aabb<3>, PackedError> {
        self.0.cell_box(cell).map(bounds)
    }

    fn visible(&self, cell: CellId, out: &mut Vec<CellId>) -> Result<(), PackedError> {
        self.0.visible(cell, out)
    }

    fn portal_edges(&self, cell: CellId, show: &mut dyn FnMut(PortalEdge<'_>)) -> Result<(), PackedError> {
        self.0.exits(cell, &mut |portal, forward, to, corners| show(PortalEdge { portal, forward, to, corners }))
    }

    fn objects_of(&self, cell: CellId, out: &mut Vec<ObjectId>) -> Result<(), PackedError> {
        self.0.objects_of(cell, out)
    }

    fn objects_seen(&self, cell: CellId, out: &mut Vec<ObjectId>) -> Result<(), PackedError> {
        self.0.objects_seen(cell, out)
    }

    fn object_box(&self, object: ObjectId) -> Result<Aabb<3>, PackedError> {
        self.0.object_box(object).map(bounds)
    }

    fn mirrors(&self, cell: CellId, show: &mut dyn FnMut(MirrorPiece<'_>)) -> Result<(), PackedError> {
        for mirror in self.0.mirrors().iter().filter(|mirror| mirror.cell == cell) {
            show(MirrorPiece { mirror: mirror.mirror, corners: &mirror.points });
        }
        Ok(())
    }

    fn stab_roots(&self, cell: CellId, out: &mut Vec<u32>) -> Result<Option<bool>, PackedError> {
        let open = self.0.stab_roots(cell, out)?;
        Ok(self.0.n_stab_nodes().map(|_| open))
    }

    fn stab_node(&self, node: u32, children: &mut Vec<u32>) -> Result<StabStep, PackedError> {
        let step = self.0.stab_node(node, children)?;
        Ok(StabStep { portal: step.portal, open: step.open })
    }
}

impl<S: ByteSource> CoarseVisibility for PackedCells<S> {
    type PlaceError = PackedError;

    fn n_cells(&self) -> usize {
        self.0.n_cells()
    }

    fn n_objects(&self) -> usize {
        self.0.n_objects()
    }

    fn cells_at<'b>(&'b self, eye: [f64; 3], buffer: &'b mut PlaceBuffer) -> Result<Place<&'b [CellId]>, PackedError> {
        self.0.cells_at(eye, buffer)
    }

    fn coarse(&self, cell: CellId, show: &mut dyn FnMut(CellId)) {
        let mut cells = Vec::new();
        match self.0.coarse(cell, &mut cells) {
            Ok(()) => cells.into_iter().for_each(show),
            Err(_) => (0..self.0.n_cells() as u32).map(CellId).for_each(show),
        }
    }

    fn coarse_objects(&self, _cell: CellId, _show: &mut dyn FnMut(ObjectId)) -> bool {
        false
    }
}

impl<S: ByteSource> TableFacts for PackedCells<S> {
    fn up(&self) -> Option<Axis> {
        self.0.up()
    }

    fn has_places(&self) -> bool {
        self.0.has_places()
    }

    fn n_portals(&self) -> usize {
        self.0.n_portals()
    }

    fn doors(&self) -> &[DoorRecord] {
        self.0.doors()
    }

    fn object_name(&self, object: ObjectId) -> Result<String, PackedError> {
        self.0.object_name(object)
    }

    fn source_of(&self, object: ObjectId) -> Result<Option<ObjectSource>, PackedError> {
        self.0.source_of(object)
    }

    fn visible_ranges(&self, cell: CellId) -> Result<Vec<TriangleRange>, PackedError> {
        let mut ranges = Vec::new();
        self.0.visible_ranges(cell, &mut ranges)?;
        Ok(ranges)
    }

    fn cell_name(&self, cell: CellId) -> Result<Option<String>, PackedError> {
        self.0.cell_name(cell)
    }

    fn polygons_of(&self, object: ObjectId) -> Result<u32, PackedError> {
        self.0.object_polygons(object)
    }

    fn bytes_in_memory(&self) -> Option<(usize, usize)> {
        Some((self.0.resident_bytes(), self.0.bytes_in_use()))
    }
}
