//! Sources with one fault each. The suite refuses every one of them, or it proves nothing.

use super::Clause;
use crate::{CellSource, MirrorPiece, PortalEdge, StabStep};
use sightlines_geometry::Aabb;
use sightlines_pvs::{CellId, Frame, ObjectId, PortalId};
use std::cell::Cell;

/// What an [`Impostor`] does wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fault {
    /// Four dimensions.
    FourDimensions,
    /// Every cell sees one that does not exist.
    NoSuchCell,
    /// Buffers are not cleared.
    NotCleared,
    /// Cells do not see themselves.
    Blind,
    /// Portals are crossed forwards only.
    OneWay,
    /// Boxes are half as wide as they are.
    SmallBoxes,
    /// Corners of portals are not numbers.
    NoCorners,
    /// Only even cells have stab trees.
    HalfTrees,
    /// All nodes of stab trees cross the same portal.
    WrongTrees,
    /// The second time, the last visible object is missing.
    NotRepeatable,
    /// The last cell that is not a neighbour is not seen.
    MissesACell,
    /// No objects are seen.
    MissesObjects,
}

impl Fault {
    /// All of them.
    pub const ALL: [Self; 12] = [
        Self::FourDimensions,
        Self::NoSuchCell,
        Self::NotCleared,
        Self::Blind,
        Self::OneWay,
        Self::SmallBoxes,
        Self::NoCorners,
        Self::HalfTrees,
        Self::WrongTrees,
        Self::NotRepeatable,
        Self::MissesACell,
        Self::MissesObjects,
    ];

    /// The clause that it breaks, of a source with several cells and objects in view, portals and stab trees.
    pub const fn clause(self) -> Clause {
        match self {
            Self::FourDimensions | Self::NoSuchCell => Clause::Ranges,
            Self::NotCleared | Self::Blind => Clause::Ordered,
            Self::OneWay => Clause::TwoSided,
            Self::SmallBoxes | Self::NoCorners => Clause::Shapes,
            Self::HalfTrees | Self::WrongTrees => Clause::Trees,
            Self::NotRepeatable => Clause::Repeatable,
            Self::MissesACell | Self::MissesObjects => Clause::Conservative,
        }
    }
}

/// A source with a fault.
#[derive(Debug)]
pub struct Impostor<S> {
    source: S,
    fault: Fault,
    n_asked: Cell<u32>,
}

impl<S: CellSource> Impostor<S> {
    /// A faultless source, but for this fault.
    pub fn new(source: S, fault: Fault) -> Self {
        Self { source, fault, n_asked: Cell::new(0) }
    }
}

impl<S: CellSource> CellSource for Impostor<S> {
    type Error = S::Error;

    fn dimension(&self) -> u8 {
        if self.fault == Fault::FourDimensions { 4 } else { self.source.dimension() }
    }

    fn frame(&self) -> Option<Frame> {
        self.source.frame()
    }

    fn leaves_gaps(&self) -> bool {
        self.source.leaves_gaps()
    }

    fn n_cells(&self) -> usize {
        self.source.n_cells()
    }

    fn n_objects(&self) -> usize {
        self.source.n_objects()
    }

    fn cell_box(&self, cell: CellId) -> Result<Aabb<3>, S::Error> {
        let mut bounds = self.source.cell_box(cell)?;
        if self.fault == Fault::SmallBoxes {
            for k in 0..3 {
                bounds.max[k] = (bounds.min[k] + bounds.max[k]) / 2.0;
            }
        }
        Ok(bounds)
    }

    fn visible(&self, cell: CellId, out: &mut Vec<CellId>) -> Result<(), S::Error> {
        let before = out.clone();
        self.source.visible(cell, out)?;
        match self.fault {
            Fault::NoSuchCell => out.push(CellId(self.n_cells() as u32)),
            Fault::NotCleared => out.splice(0..0, before).for_each(drop),
            Fault::Blind => out.retain(|other| *other != cell),
            Fault::MissesACell => {
                let mut near = vec![cell];
                self.source.portal_edges(cell, &mut |edge| near.push(edge.to))?;
                if let Some(far) = out.iter().rposition(|other| !near.contains(other)) {
                    out.remove(far);
                }
            }
            _ => {}
        }
        Ok(())
    }

    fn portal_edges(&self, cell: CellId, show: &mut dyn FnMut(PortalEdge<'_>)) -> Result<(), S::Error> {
        self.source.portal_edges(cell, &mut |edge| match self.fault {
            Fault::OneWay if !edge.forward => {}
            Fault::NoCorners => show(PortalEdge { corners: &vec![[f64::NAN; 3]; edge.corners.len()], ..edge }),
            _ => show(edge),
        })
    }

    fn objects_of(&self, cell: CellId, out: &mut Vec<ObjectId>) -> Result<(), S::Error> {
        self.source.objects_of(cell, out)
    }

    fn objects_seen(&self, cell: CellId, out: &mut Vec<ObjectId>) -> Result<(), S::Error> {
        self.source.objects_seen(cell, out)?;
        self.n_asked.set(self.n_asked.get() + 1);
        match self.fault {
            Fault::MissesObjects => out.clear(),
            // The suite asks about all cells, then again.
            Fault::NotRepeatable if self.n_asked.get() as usize > self.n_cells() => out.truncate(out.len().max(1) - 1),
            _ => {}
        }
        Ok(())
    }

    fn object_box(&self, object: ObjectId) -> Result<Aabb<3>, S::Error> {
        self.source.object_box(object)
    }

    fn mirrors(&self, cell: CellId, show: &mut dyn FnMut(MirrorPiece<'_>)) -> Result<(), S::Error> {
        self.source.mirrors(cell, show)
    }

    fn stab_roots(&self, cell: CellId, out: &mut Vec<u32>) -> Result<Option<bool>, S::Error> {
        let open = self.source.stab_roots(cell, out)?;
        Ok(open.filter(|_| self.fault != Fault::HalfTrees || cell.0.is_multiple_of(2)))
    }

    fn stab_node(&self, node: u32, children: &mut Vec<u32>) -> Result<StabStep, S::Error> {
        let step = self.source.stab_node(node, children)?;
        Ok(if self.fault == Fault::WrongTrees { StabStep { portal: PortalId(0), ..step } } else { step })
    }
}
