//! Sources with one fault each.

use crate::conformance::Impostor;
use sightlines_eye_to_cell::{CellSource, MirrorPiece, PortalEdge, StabStep};
use sightlines_geometry::Aabb;
use sightlines_pvs::{CellId, Frame, ObjectId, PortalId};

faults! {
    /// What a wrong source does. It breaks the clause if several cells and objects are in view, and there are portals and
    /// stab trees.
    CellSourceFault {
        /// Four dimensions.
        FourDimensions breaks Ranges,
        /// Every cell sees one that does not exist.
        NoSuchCell breaks Ranges,
        /// Buffers are not cleared.
        NotCleared breaks Ordered,
        /// Cells do not see themselves.
        Blind breaks Ordered,
        /// Portals are crossed forwards only.
        OneWay breaks TwoSided,
        /// Boxes are half as wide as they are.
        SmallBoxes breaks Shapes,
        /// Corners of portals are not numbers.
        NoCorners breaks Shapes,
        /// Only even cells have stab trees.
        HalfTrees breaks Trees,
        /// All nodes of stab trees cross the same portal.
        WrongTrees breaks Trees,
        /// The second time, the last visible object is missing.
        NotRepeatable breaks Repeatable,
        /// The last cell that is not a neighbour is not seen.
        MissesACell breaks Conservative,
        /// No objects are seen.
        MissesObjects breaks Conservative,
    }
}

impl<S: CellSource> CellSource for Impostor<S, CellSourceFault> {
    type Error = S::Error;

    fn dimension(&self) -> u8 {
        if self.fault == CellSourceFault::FourDimensions { 4 } else { self.inner.dimension() }
    }

    fn frame(&self) -> Option<Frame> {
        self.inner.frame()
    }

    fn leaves_gaps(&self) -> bool {
        self.inner.leaves_gaps()
    }

    fn n_cells(&self) -> usize {
        self.inner.n_cells()
    }

    fn n_objects(&self) -> usize {
        self.inner.n_objects()
    }

    fn cell_box(&self, cell: CellId) -> Result<Aabb<3>, S::Error> {
        let mut bounds = self.inner.cell_box(cell)?;
        if self.fault == CellSourceFault::SmallBoxes {
            for k in 0..3 {
                bounds.max[k] = (bounds.min[k] + bounds.max[k]) / 2.0;
            }
        }
        Ok(bounds)
    }

    fn visible(&self, cell: CellId, out: &mut Vec<CellId>) -> Result<(), S::Error> {
        let before = out.clone();
        self.inner.visible(cell, out)?;
        match self.fault {
            CellSourceFault::NoSuchCell => out.push(CellId(self.n_cells() as u32)),
            CellSourceFault::NotCleared => out.splice(0..0, before).for_each(drop),
            CellSourceFault::Blind => out.retain(|other| *other != cell),
            CellSourceFault::MissesACell => {
                let mut near = vec![cell];
                self.inner.portal_edges(cell, &mut |edge| near.push(edge.to))?;
                if let Some(far) = out.iter().rposition(|other| !near.contains(other)) {
                    out.remove(far);
                }
            }
            _ => {}
        }
        Ok(())
    }

    fn portal_edges(&self, cell: CellId, show: &mut dyn FnMut(PortalEdge<'_>)) -> Result<(), S::Error> {
        self.inner.portal_edges(cell, &mut |edge| match self.fault {
            CellSourceFault::OneWay if !edge.forward => {}
            CellSourceFault::NoCorners => {
                show(PortalEdge { corners: &vec![[f64::NAN; 3]; edge.corners.len()], ..edge })
            }
            _ => show(edge),
        })
    }

    fn objects_of(&self, cell: CellId, out: &mut Vec<ObjectId>) -> Result<(), S::Error> {
        self.inner.objects_of(cell, out)
    }

    fn objects_seen(&self, cell: CellId, out: &mut Vec<ObjectId>) -> Result<(), S::Error> {
        self.inner.objects_seen(cell, out)?;
        let n_asked = self.call();
        match self.fault {
            CellSourceFault::MissesObjects => out.clear(),
            // The suite asks about all cells, then again.
            CellSourceFault::NotRepeatable if n_asked >= self.n_cells() => out.truncate(out.len().max(1) - 1),
            _ => {}
        }
        Ok(())
    }

    fn object_box(&self, object: ObjectId) -> Result<Aabb<3>, S::Error> {
        self.inner.object_box(object)
    }

    fn mirrors(&self, cell: CellId, show: &mut dyn FnMut(MirrorPiece<'_>)) -> Result<(), S::Error> {
        self.inner.mirrors(cell, show)
    }

    fn stab_roots(&self, cell: CellId, out: &mut Vec<u32>) -> Result<Option<bool>, S::Error> {
        let open = self.inner.stab_roots(cell, out)?;
        Ok(open.filter(|_| self.fault != CellSourceFault::HalfTrees || cell.0.is_multiple_of(2)))
    }

    fn stab_node(&self, node: u32, children: &mut Vec<u32>) -> Result<StabStep, S::Error> {
        let step = self.inner.stab_node(node, children)?;
        Ok(if self.fault == CellSourceFault::WrongTrees { StabStep { portal: PortalId(0), ..step } } else { step })
    }
}
