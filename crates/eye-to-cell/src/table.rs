//! Tables in memory as a source.

use crate::source::{CellSource, MirrorPiece, PortalEdge, StabStep};
use sightlines_geometry::Aabb;
use sightlines_pvs::{CellId, Frame, ObjectId, PortalId, Table};
use std::borrow::Borrow;
use std::convert::Infallible;

/// A table, with its portals and mirrors sorted by cell.
///
/// `T` is a [`Table`], a reference to one, or an `Arc`.
#[derive(Debug, Clone)]
pub struct TableCells<T> {
    table: T,
    first_way: Vec<u32>,
    /// Twice the portal, one more for the way from its second cell.
    ways: Vec<u32>,
    first_mirror: Vec<u32>,
    mirrors: Vec<u32>,
}

/// The items of each key, as a list with the place where each key's begin. Ascending within a key.
fn by_key(n_keys: usize, items: impl Iterator<Item = (usize, u32)> + Clone) -> (Vec<u32>, Vec<u32>) {
    let mut first = vec![0u32; n_keys + 1];
    items.clone().for_each(|(key, _)| first[key + 1] += 1);
    (1..first.len()).for_each(|k| first[k] += first[k - 1]);
    let mut free = first.clone();
    let mut list = vec![0; first[n_keys] as usize];
    for (key, item) in items {
        list[free[key] as usize] = item;
        free[key] += 1;
    }
    (first, list)
}

impl<T: Borrow<Table>> TableCells<T> {
    /// Sorts the portals by cell. O(portals).
    pub fn new(table: T) -> Self {
        let t = table.borrow();
        let ways =
            (0u32..).zip(t.portals()).flat_map(|(i, p)| [(p.cells[0].idx(), 2 * i), (p.cells[1].idx(), 2 * i + 1)]);
        let (first_way, ways) = by_key(t.n_cells(), ways);
        let mirrors = (0u32..).zip(&t.parts().mirrors).map(|(i, m)| (m.cell.idx(), i));
        let (first_mirror, mirrors) = by_key(t.n_cells(), mirrors);
        Self { table, first_way, ways, first_mirror, mirrors }
    }

    /// The table.
    pub fn table(&self) -> &Table {
        self.table.borrow()
    }
}

impl<T: Borrow<Table>> CellSource for TableCells<T> {
    type Error = Infallible;

    fn dimension(&self) -> u8 {
        self.table().dimension()
    }

    fn frame(&self) -> Option<Frame> {
        self.table().frame().copied()
    }

    fn leaves_gaps(&self) -> bool {
        self.table().kind().leaves_gaps()
    }

    fn n_cells(&self) -> usize {
        self.table().n_cells()
    }

    fn n_objects(&self) -> usize {
        self.table().objects().len()
    }

    fn cell_box(&self, cell: CellId) -> Result<Aabb<3>, Infallible> {
        let cell = &self.table().cells()[cell.idx()];
        Ok(Aabb { min: cell.min, max: cell.max })
    }

    fn visible(&self, cell: CellId, out: &mut Vec<CellId>) -> Result<(), Infallible> {
        out.clear();
        out.extend(self.table().visible(cell));
        Ok(())
    }

    fn portal_edges(&self, cell: CellId, show: &mut dyn FnMut(PortalEdge<'_>)) -> Result<(), Infallible> {
        for way in &self.ways[self.first_way[cell.idx()] as usize..self.first_way[cell.idx() + 1] as usize] {
            let (portal, second) = (PortalId(way / 2), way % 2);
            let record = &self.table().portals()[portal.idx()];
            let to = record.cells[1 - second as usize];
            show(PortalEdge { portal, forward: second == 0, to, corners: &record.points });
        }
        Ok(())
    }

    fn objects_of(&self, cell: CellId, out: &mut Vec<ObjectId>) -> Result<(), Infallible> {
        out.clear();
        out.extend_from_slice(self.table().objects_of(cell));
        Ok(())
    }

    fn objects_seen(&self, cell: CellId, out: &mut Vec<ObjectId>) -> Result<(), Infallible> {
        out.clear();
        out.extend(self.table().visible_objects(cell));
        Ok(())
    }

    fn object_box(&self, object: ObjectId) -> Result<Aabb<3>, Infallible> {
        let object = &self.table().objects()[object.idx()];
        Ok(Aabb { min: object.min, max: object.max })
    }

    fn mirrors(&self, cell: CellId, show: &mut dyn FnMut(MirrorPiece<'_>)) -> Result<(), Infallible> {
        for &i in &self.mirrors[self.first_mirror[cell.idx()] as usize..self.first_mirror[cell.idx() + 1] as usize] {
            let mirror = &self.table().parts().mirrors[i as usize];
            show(MirrorPiece { mirror: mirror.mirror, corners: &mirror.points });
        }
        Ok(())
    }

    fn stab_roots(&self, cell: CellId, out: &mut Vec<u32>) -> Result<Option<bool>, Infallible> {
        out.clear();
        Ok(self.table().parts().stab.as_ref().map(|trees| {
            out.extend_from_slice(trees.roots(cell));
            trees.is_root_open(cell)
        }))
    }

    fn stab_node(&self, node: u32, children: &mut Vec<u32>) -> Result<StabStep, Infallible> {
        children.clear();
        let Some(trees) = &self.table().parts().stab else {
            return Ok(StabStep { portal: PortalId(u32::MAX), open: true });
        };
        children.extend_from_slice(trees.children(node));
        Ok(StabStep { portal: trees.gate(node).0, open: trees.is_open(node) })
    }
}
