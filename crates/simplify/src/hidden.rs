//! Which faces are proven hidden.

use crate::ask::{Asker, MakeMethod};
use crate::views::{ViewBox, Views};
use rayon::prelude::*;
use sightlines_geometry::{Aabb, BoxTree};
use sightlines_multifocal::{BackendError, Volume};
use sightlines_pvs::Table;
use sightlines_visible_surface::Faces;
use std::fmt;

/// Sources of proofs that faces are hidden. A face that any of them hides is hidden.
#[derive(Clone, Copy, Default)]
pub struct HiddenBy<'a> {
    /// A from-region method, such as the multifocal z-buffer with sheets.
    pub method: Option<MakeMethod<'a>>,
    /// A table of the scene, used for views that are its cells; see [`Views::of_cells`].
    pub table: Option<&'a Table>,
}

impl fmt::Debug for HiddenBy<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("HiddenBy")
            .field("method", &self.method.is_some())
            .field("table", &self.table.is_some())
            .finish()
    }
}

/// The occluders of a scene, prepared for queries about any views.
pub(crate) struct Hider<'a> {
    faces: &'a Faces,
    table: Option<TableFaces<'a>>,
    method: Option<(MakeMethod<'a>, Asker<'a>)>,
}

impl<'a> Hider<'a> {
    /// O(n log² n).
    pub(crate) fn new(faces: &'a Faces, by: &HiddenBy<'a>) -> Self {
        let method = by.method.map(|make| (make, Asker::new(faces)));
        Self { faces, table: by.table.map(|table| TableFaces::new(faces, table)), method }
    }

    /// For each view, which faces may be visible from it. Errs towards visible only, provided that method and table do.
    pub(crate) fn may_see(&self, views: &Views) -> Result<Vec<Vec<bool>>, BackendError> {
        let start = self.by_table(views);
        match &self.method {
            Some((make, asker)) => asker.each(*make, &volumes(views), start),
            None => Ok(start),
        }
    }

    /// Which faces may be visible from some view. Errs as [`Self::may_see`].
    pub(crate) fn may_see_from_any(&self, views: &Views) -> Result<Vec<bool>, BackendError> {
        let start = self.by_table(views);
        match &self.method {
            Some((make, asker)) => asker.any(*make, &volumes(views), &start),
            None => Ok(self.faces.ids().map(|face| start.iter().any(|visible| visible[face as usize])).collect()),
        }
    }

    /// What the table alone says.
    fn by_table(&self, views: &Views) -> Vec<Vec<bool>> {
        let start = |view: &ViewBox| -> Vec<bool> {
            let mut visible: Vec<bool> = self.faces.ids().map(|face| self.faces.has_area(face)).collect();
            if let Some(table) = &self.table {
                table.hide(view, self.faces, &mut visible);
            }
            visible
        };
        views.parts().par_iter().map(start).collect()
    }
}

fn volumes(views: &Views) -> Vec<Volume> {
    views.parts().iter().map(|view| view.volume).collect()
}

/// A table as a source of hidden faces.
struct TableFaces<'a> {
    table: &'a Table,
    /// For each face, the cells whose closed boxes meet its box; none if cells do not determine where it can be
    /// reached.
    touched: Vec<Vec<u32>>,
}

impl<'a> TableFaces<'a> {
    fn new(faces: &Faces, table: &'a Table) -> Self {
        if !table.kind().cells_fill_space() {
            // Other cells leave gaps.
            return Self { table, touched: vec![Vec::new(); faces.len()] };
        }
        let cells: Vec<Aabb<3>> = table.cells().iter().map(|c| Aabb { min: c.min, max: c.max }).collect();
        let tree = BoxTree::build(&cells, 8);
        // Within the box around all cells, everything outside every cell is solid.
        let all = Aabb::<3>::around(cells.iter().flat_map(|b| [b.min, b.max]));
        let meet = |a: &Aabb<3>, b: &Aabb<3>| (0..3).all(|k| a.min[k] <= b.max[k] && b.min[k] <= a.max[k]);
        let touched = |face: u32| {
            let b = faces.bounds(face);
            let mut found = Vec::new();
            if !(all.contains(b.min) && all.contains(b.max)) {
                return found;
            }
            tree.visit(
                |node| meet(node, &b),
                |cell| {
                    if meet(&cells[cell as usize], &b) {
                        found.push(cell);
                    }
                },
            );
            found
        };
        Self { table, touched: faces.ids().into_par_iter().map(touched).collect() }
    }

    /// Hides faces of objects that the view's cell does not see, and faces that touch no cell that it sees: a ray that
    /// reaches a face comes through a cell whose closed box the face touches. A face that touches no cell of a k-d tree
    /// is inside something solid, but is left visible: this costs little, and makes no assumption about the outside.
    fn hide(&self, view: &ViewBox, faces: &Faces, visible: &mut [bool]) {
        let Some(cell) = view.cell else { return };
        let mut objects = vec![false; self.table.objects().len()];
        self.table.visible_objects(cell).into_iter().for_each(|o| objects[o.idx()] = true);
        let mut seen = vec![false; self.table.n_cells()];
        self.table.visible(cell).for_each(|c| seen[c.idx()] = true);
        for (face, visible) in faces.ids().zip(visible) {
            let touched = &self.touched[face as usize];
            let reached = touched.is_empty() || touched.iter().any(|&c| seen[c as usize]);
            *visible &= reached && objects[faces.object(face) as usize];
        }
    }
}
