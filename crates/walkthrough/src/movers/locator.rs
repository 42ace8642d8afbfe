//! Which cells a box touches.

use sightlines_eye_to_cell::{CellSource, TableCells};
use sightlines_geometry::{Aabb, BoxTree};
use sightlines_pvs::{CellId, Frame, Table};
use std::borrow::Borrow;
use std::sync::Arc;

/// The positions of a table's cells, available without waiting.
pub trait CellLocator {
    /// 2 or 3.
    fn dimension(&self) -> u8;

    /// Number of cells; ids are below it.
    fn n_cells(&self) -> usize;

    /// The box of the scene around all cells; [`Aabb::EMPTY`] without cells. May be slow; it is called once.
    fn bounds(&self) -> Aabb<3>;

    /// Whether there may be air outside every cell in the box around them.
    fn leaves_gaps(&self) -> bool;

    /// The axes of the cells, if they are not those of the scene, and the box along them around all cells. May be slow; it is called once.
    fn along(&self) -> (Option<Frame>, Aabb<3>) {
        (None, self.bounds())
    }

    /// Calls `visit` with every cell that the closed box of the scene touches (z is 0 in the plane), until it returns `false`. A
    /// cell may be visited more than once, in any order. `pending` is scratch space.
    ///
    /// Errs towards touching, by rounding; cells that truly touch a box are visited for every larger box too.
    fn touching(&self, bounds: &Aabb<3>, pending: &mut Vec<u32>, visit: &mut dyn FnMut(CellId) -> bool);
}

impl<T: Borrow<Table>> CellLocator for TableCells<T> {
    fn dimension(&self) -> u8 {
        self.table().dimension()
    }

    fn n_cells(&self) -> usize {
        self.table().n_cells()
    }

    fn leaves_gaps(&self) -> bool {
        self.table().kind().leaves_gaps()
    }

    fn bounds(&self) -> Aabb<3> {
        let (frame, along) = self.along();
        in_scene(frame.as_ref(), along)
    }

    fn along(&self) -> (Option<Frame>, Aabb<3>) {
        let around = self.table().cells().iter().fold(Aabb::EMPTY, |all, cell| all.with(cell.min).with(cell.max));
        (self.table().frame().copied(), around)
    }

    fn touching(&self, bounds: &Aabb<3>, pending: &mut Vec<u32>, visit: &mut dyn FnMut(CellId) -> bool) {
        self.table().for_each_touching(bounds.min, bounds.max, pending, visit);
    }
}

/// The box of the scene around a box along the frame of a table, if it has one.
fn in_scene(frame: Option<&Frame>, along: Aabb<3>) -> Aabb<3> {
    match frame.filter(|_| !along.is_empty()) {
        Some(frame) => {
            let (min, max) = frame.around_in_scene(along.min, along.max);
            Aabb { min, max }
        }
        None => along,
    }
}

impl<P: CellLocator + ?Sized> CellLocator for Arc<P> {
    fn dimension(&self) -> u8 {
        (**self).dimension()
    }

    fn n_cells(&self) -> usize {
        (**self).n_cells()
    }

    fn leaves_gaps(&self) -> bool {
        (**self).leaves_gaps()
    }

    fn bounds(&self) -> Aabb<3> {
        (**self).bounds()
    }

    fn along(&self) -> (Option<Frame>, Aabb<3>) {
        (**self).along()
    }

    fn touching(&self, bounds: &Aabb<3>, pending: &mut Vec<u32>, visit: &mut dyn FnMut(CellId) -> bool) {
        (**self).touching(bounds, pending, visit);
    }
}

/// The boxes of all cells of any source, for example a packed table, read once and kept in a tree.
///
/// Cells count as their boxes: where cells are polygons, or cut by planes, a box touches more of them than in the table
/// itself. About 200 bytes for each cell.
#[derive(Debug, Clone, PartialEq)]
pub struct CellBoxes {
    dimension: u8,
    /// The axes of the boxes.
    frame: Option<Frame>,
    leaves_gaps: bool,
    boxes: Vec<Aabb<3>>,
    tree: BoxTree<3>,
}

impl CellBoxes {
    /// Reads the boxes of all cells. O(n log n).
    ///
    /// # Errors
    /// The first of the source.
    pub fn read<S: CellSource + ?Sized>(source: &S) -> Result<Self, S::Error> {
        let boxes = (0..source.n_cells() as u32).map(|i| source.cell_box(CellId(i))).collect::<Result<Vec<_>, _>>()?;
        let tree = BoxTree::build(&boxes, 4);
        let leaves_gaps = source.leaves_gaps();
        Ok(Self { dimension: source.dimension(), frame: source.frame(), leaves_gaps, boxes, tree })
    }
}

fn touch(a: &Aabb<3>, b: &Aabb<3>) -> bool {
    !(0..3).any(|k| a.min[k] > b.max[k] || b.min[k] > a.max[k])
}

impl CellLocator for CellBoxes {
    fn dimension(&self) -> u8 {
        self.dimension
    }

    fn n_cells(&self) -> usize {
        self.boxes.len()
    }

    fn leaves_gaps(&self) -> bool {
        self.leaves_gaps
    }

    fn bounds(&self) -> Aabb<3> {
        in_scene(self.frame.as_ref(), self.tree.nodes()[0].bounds)
    }

    fn along(&self) -> (Option<Frame>, Aabb<3>) {
        (self.frame, self.tree.nodes()[0].bounds)
    }

    fn touching(&self, bounds: &Aabb<3>, _pending: &mut Vec<u32>, visit: &mut dyn FnMut(CellId) -> bool) {
        let bounds = &self.frame.map_or(*bounds, |frame| {
            let (min, max) = frame.around(bounds.min, bounds.max);
            Aabb { min, max }
        });
        let goes_on = std::cell::Cell::new(true);
        self.tree.visit(
            |node| goes_on.get() && touch(node, bounds),
            |i| {
                if goes_on.get() && touch(&self.boxes[i as usize], bounds) {
                    goes_on.set(visit(CellId(i)));
                }
            },
        );
    }
}
