//! Cells, portals and exits, generic over the kind of cell.

use sightlines_pvs::CellId;
pub use sightlines_pvs::PortalId;
use std::fmt::Debug;

/// A kind of cells and portals: planar, axial boxes, convex polyhedra.
pub trait Space: Debug + Clone + Send + Sync + 'static {
    /// Shape and labels of a cell.
    type Cell: Debug + Clone + PartialEq + Send + Sync;
    /// Shape of a portal, as seen when crossing from the first of its two cells into the second.
    type Portal: Debug + Clone + PartialEq + Send + Sync;
}

/// An opening between two cells.
#[derive(Debug, Clone, PartialEq)]
pub struct Portal<S: Space> {
    /// The two cells, different from each other.
    pub cells: [CellId; 2],
    /// The side of each cell that the portal lies on. A side is a maximal flat piece of the cell's
    /// boundary: no line enters and leaves a convex cell by one side.
    pub sides: [u32; 2],
    /// Its shape, seen from `cells[0]`.
    pub shape: S::Portal,
}

/// One way out of a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Exit {
    /// The side of the cell that is left by.
    pub side: u32,
    /// The portal crossed.
    pub portal: PortalId,
    /// Whether it is crossed from its first cell into its second.
    pub forward: bool,
    /// The cell entered.
    pub to: CellId,
    /// The side of that cell that is entered by.
    pub entry_side: u32,
}

/// Convex cells and the portals between them.
#[derive(Debug, Clone, PartialEq)]
pub struct CellGraph<S: Space> {
    cells: Vec<S::Cell>,
    portals: Vec<Portal<S>>,
    first_exit: Vec<u32>,
    exits: Vec<Exit>,
}

impl<S: Space> CellGraph<S> {
    /// Joins `cells` by `portals`. O(n log n).
    ///
    /// # Panics
    /// If a portal names a cell that does not exist, or joins a cell with itself: the subdivision
    /// that made them is wrong.
    pub fn new(cells: Vec<S::Cell>, portals: Vec<Portal<S>>) -> Self {
        let mut by_cell: Vec<Vec<Exit>> = vec![Vec::new(); cells.len()];
        for (id, portal) in (0u32..).map(PortalId).zip(&portals) {
            let [a, b] = portal.cells;
            assert!(a != b, "portal {} joins cell {a} with itself", id.0);
            let [side_a, side_b] = portal.sides;
            by_cell[a.idx()].push(Exit { side: side_a, portal: id, forward: true, to: b, entry_side: side_b });
            by_cell[b.idx()].push(Exit { side: side_b, portal: id, forward: false, to: a, entry_side: side_a });
        }
        let mut first_exit = vec![0u32];
        let mut exits = Vec::with_capacity(2 * portals.len());
        for mut list in by_cell {
            list.sort_unstable();
            exits.append(&mut list);
            first_exit.push(u32::try_from(exits.len()).expect("fewer than 2^31 portals"));
        }
        Self { cells, portals, first_exit, exits }
    }

    /// Number of cells; ids are below it.
    pub fn n_cells(&self) -> usize {
        self.cells.len()
    }

    /// All ids.
    pub fn cell_ids(&self) -> impl ExactSizeIterator<Item = CellId> + use<S> {
        (0..u32::try_from(self.cells.len()).expect("cells have 32-bit ids")).map(CellId)
    }

    /// All cells, by id.
    pub fn cells(&self) -> &[S::Cell] {
        &self.cells
    }

    /// All portals, by id.
    pub fn portals(&self) -> &[Portal<S>] {
        &self.portals
    }

    /// One cell.
    pub fn cell(&self, id: CellId) -> &S::Cell {
        &self.cells[id.idx()]
    }

    /// One portal.
    pub fn portal(&self, id: PortalId) -> &Portal<S> {
        &self.portals[id.idx()]
    }

    /// The ways out of a cell, ordered by side, then portal.
    pub fn exits(&self, id: CellId) -> &[Exit] {
        &self.exits[self.exit_range(id)]
    }

    /// The place of a cell's exits among all exits, which are numbered cell by cell.
    pub fn exit_range(&self, id: CellId) -> std::ops::Range<usize> {
        self.first_exit[id.idx()] as usize..self.first_exit[id.idx() + 1] as usize
    }

    /// All exits of all cells, cell by cell.
    pub fn all_exits(&self) -> &[Exit] {
        &self.exits
    }
}
