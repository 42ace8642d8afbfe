//! What is seen in a picture, and from where.

use super::SeenFromEye;
use sightlines_pvs::{CellId, ObjectId, Place, Table};

/// What a cell or a viewer sees.
#[derive(Debug)]
pub(super) struct VisibleSet {
    /// The cells looked from, ascending; none for a viewer outside every cell.
    pub(super) from: Vec<CellId>,
    /// For each cell of the table whether it is seen.
    cells: Vec<bool>,
    /// The objects that are seen, ascending.
    objects: Vec<ObjectId>,
    /// For each cell whether the viewer sees it, if that is known apart from what their cell sees.
    viewer: Option<Vec<bool>>,
}

impl VisibleSet {
    /// What a cell of the table sees.
    pub(super) fn from_cell(table: &Table, cell: CellId) -> Self {
        Self::new(table, vec![cell], table.visible(cell), table.visible_objects(cell))
    }

    /// What a viewer at a point sees (z does not count in a plane); nothing if the point is outside every cell.
    pub(super) fn from_point(table: &Table, point: [f64; 3]) -> Self {
        match table.place_at(point) {
            Place::Inside(at) => Self::new(table, at.cells().to_vec(), at.visible_cells(), at.visible_objects()),
            Place::Outside => Self::new(table, Vec::new(), std::iter::empty(), Vec::new()),
        }
    }

    fn new(table: &Table, from: Vec<CellId>, ids: impl Iterator<Item = CellId>, objects: Vec<ObjectId>) -> Self {
        let mut cells = vec![false; table.n_cells()];
        ids.for_each(|id| cells[id.idx()] = true);
        Self { from, cells, objects, viewer: None }
    }

    /// The same, of which a viewer sees only this.
    pub(super) fn narrowed<P>(mut self, sight: &SeenFromEye<'_, P>) -> Self {
        let mut seen = vec![false; self.cells.len()];
        sight.cells.iter().for_each(|id| seen[id.idx()] = true);
        self.objects = sight.objects.to_vec();
        self.objects.sort_unstable();
        self.viewer = Some(seen);
        self
    }

    /// Whether what the viewer sees is told apart from what their cell sees.
    pub(super) fn is_narrowed(&self) -> bool {
        self.viewer.is_some()
    }

    /// Whether a cell is seen by the viewer; by their cell, if only that is known.
    pub(super) fn is_in_sight(&self, cell: CellId) -> bool {
        self.viewer.as_ref().map_or_else(|| self.sees(cell), |seen| seen[cell.idx()])
    }

    /// Whether a cell is seen by the cells looked from.
    pub(super) fn sees(&self, cell: CellId) -> bool {
        self.cells[cell.idx()]
    }

    /// Whether an object is seen.
    pub(super) fn sees_object(&self, object: u32) -> bool {
        self.objects.binary_search(&ObjectId(object)).is_ok()
    }

    /// Whether it is looked from this cell.
    pub(super) fn is_from(&self, cell: CellId) -> bool {
        self.from.binary_search(&cell).is_ok()
    }
}
