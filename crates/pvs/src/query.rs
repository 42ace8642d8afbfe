//! What is visible from a point.

use crate::bits::WORD;
use crate::{BitMatrix, CellId, CellSet, ObjectId, Table, TriangleRange, triangle_ranges};
use std::borrow::Cow;

/// The result of locating a point.
///
/// Match it: outside every cell nothing is known, so *everything* has to be drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[must_use = "outside of every cell nothing is known, so everything has to be drawn"]
pub enum Place<T> {
    /// In no cell, or unknown: a coordinate is not finite, or the table has no positions of its cells.
    Outside,
    /// In at least one cell.
    Inside(T),
}

impl<T> Place<T> {
    /// Whether the point is in no cell.
    pub const fn is_outside(&self) -> bool {
        matches!(self, Self::Outside)
    }

    /// The content inside; `None` outside.
    pub fn inside(self) -> Option<T> {
        match self {
            Self::Outside => None,
            Self::Inside(inside) => Some(inside),
        }
    }

    /// The same place with other content inside.
    pub fn map<U>(self, change: impl FnOnce(T) -> U) -> Place<U> {
        match self {
            Self::Outside => Place::Outside,
            Self::Inside(inside) => Place::Inside(change(inside)),
        }
    }
}

impl Place<Inside<'_>> {
    /// The cells that contain the point, ascending; none outside. For locating a point only: what to draw there is in
    /// [`Inside`].
    pub fn cells(&self) -> &[CellId] {
        match self {
            Self::Outside => &[],
            Self::Inside(inside) => inside.cells(),
        }
    }
}

/// Working memory of queries, which allocate nothing once it is warm.
#[derive(Debug, Clone, Default)]
pub struct PlaceBuffer {
    pending: Vec<u32>,
    cells: Vec<CellId>,
}

impl PlaceBuffer {
    /// Nothing allocated yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// The cells that `find` puts into its second argument, in any order, perhaps repeated; its first argument is
    /// scratch space. Both are empty at first. For other forms of tables.
    pub fn fill(&mut self, find: impl FnOnce(&mut Vec<u32>, &mut Vec<CellId>)) -> Place<&[CellId]> {
        self.pending.clear();
        self.cells.clear();
        find(&mut self.pending, &mut self.cells);
        self.cells.sort_unstable();
        self.cells.dedup();
        if self.cells.is_empty() { Place::Outside } else { Place::Inside(&self.cells) }
    }
}

/// A table does not have the dimension of the points that it is queried with.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the table has {table} dimensions, not {points}")]
pub struct DimensionError {
    /// Number of dimensions of the table.
    pub table: u8,
    /// Number of coordinates of the points.
    pub points: usize,
}

/// A table in `D` dimensions, 2 or 3: [`Table::in_dimension`].
#[derive(Debug, Clone, Copy)]
pub struct Query<'a, const D: usize> {
    table: &'a Table,
}

impl<'a, const D: usize> Query<'a, D> {
    /// The table.
    pub const fn table(self) -> &'a Table {
        self.table
    }

    /// What is visible from a point (scene units). Allocates the list of cells; see [`Query::at_with`].
    ///
    /// A cell contains the points of its closed polygon, or of its box if it has no polygon; if the table has a
    /// [`crate::PlaneTree`], that alone decides. A point on the border between cells is in all of them. Decided in doubles with an
    /// error bound that errs towards "inside": a point within rounding of a border may be found in cells on both sides of it,
    /// never in none of them. O(log n + candidates), with planes O(depth of the tree).
    ///
    /// In a table with a [frame](Table::frame) the point is in all cells within the gap of the frame.
    pub fn at(self, p: [f64; D]) -> Place<Inside<'a>> {
        self.table.place_at(lifted(p))
    }

    /// The same, with the list of cells in `buffer`: allocates nothing once that is warm.
    pub fn at_with<'b>(self, p: [f64; D], buffer: &'b mut PlaceBuffer) -> Place<Inside<'b>>
    where
        'a: 'b,
    {
        self.table.place_at_with(lifted(p), buffer)
    }
}

fn lifted<const D: usize>(p: [f64; D]) -> [f64; 3] {
    std::array::from_fn(|k| p.get(k).copied().unwrap_or(0.0))
}

impl Table {
    /// The table for queries with points of `D` coordinates, checked once.
    ///
    /// # Errors
    /// [`DimensionError`] if the table has another dimension.
    pub fn in_dimension<const D: usize>(&self) -> Result<Query<'_, D>, DimensionError> {
        if usize::from(self.dimension()) == D {
            Ok(Query { table: self })
        } else {
            Err(DimensionError { table: self.dimension(), points: D })
        }
    }

    /// As [`Query::at`], for code that serves both dimensions: in a plane the third coordinate does not count.
    pub fn place_at(&self, p: [f64; 3]) -> Place<Inside<'_>> {
        let mut buffer = PlaceBuffer::new();
        let is_outside = self.cells_at(p, &mut buffer).is_outside();
        let cells = Cow::Owned(buffer.cells);
        if is_outside { Place::Outside } else { Place::Inside(Inside { table: self, cells }) }
    }

    /// As [`Query::at_with`], for code that serves both dimensions: in a plane the third coordinate does not count.
    pub fn place_at_with<'b>(&'b self, p: [f64; 3], buffer: &'b mut PlaceBuffer) -> Place<Inside<'b>> {
        self.cells_at(p, buffer).map(|cells| Inside { table: self, cells: Cow::Borrowed(cells) })
    }

    /// Only the cells of [`Table::place_at_with`], for a list that outlives the borrow of the table.
    pub fn cells_at<'b>(&self, p: [f64; 3], buffer: &'b mut PlaceBuffer) -> Place<&'b [CellId]> {
        let p = if self.dimension() == 2 { [p[0], p[1], 0.0] } else { p };
        if !self.has_places() || !p.iter().all(|x| x.is_finite()) {
            return Place::Outside;
        }
        buffer.fill(|pending, found| self.for_each_cell_at(p, pending, |cell| found.push(cell)))
    }
}

/// The cells that contain a point, and what is visible from there: what is visible from any of them.
#[derive(Debug, Clone)]
pub struct Inside<'a> {
    table: &'a Table,
    cells: Cow<'a, [CellId]>,
}

impl Inside<'_> {
    /// The cells that contain the point, ascending; at least one, several on borders.
    pub fn cells(&self) -> &[CellId] {
        &self.cells
    }

    /// Whether something in `cell` may be seen from the point; `false` if the table has no such cell. O(cells at the point).
    pub fn sees(&self, cell: CellId) -> bool {
        cell.idx() < self.table.n_cells() && self.cells.iter().any(|&at| self.table.sees(at, cell))
    }

    /// The cells that may be seen from the point, ascending, those around it included. Allocates nothing. O(words of a row).
    pub fn visible_cells(&self) -> impl Iterator<Item = CellId> + '_ {
        self.union_of(&self.table.parts().rows).map(|i| CellId(i as u32))
    }

    /// The cells that may be seen from the point, as a set. Allocates it.
    pub fn visible_set(&self) -> CellSet {
        let mut seen = CellSet::empty(self.table.n_cells());
        self.cells.iter().for_each(|&cell| seen.unite(self.table.row(cell)));
        seen
    }

    /// The objects that may be seen from the point, ascending. Allocates the list; see [`Inside::visible_objects_into`].
    pub fn visible_objects(&self) -> Vec<ObjectId> {
        let mut objects = Vec::new();
        self.visible_objects_into(&mut objects);
        objects
    }

    /// What may be seen from the point, by ascending object: the triangles of an object that was cut into parts, as ranges that do not meet, and no
    /// range for all of an object that was not. Triangles count as for [`ObjectPart`](crate::ObjectPart). Allocates the list.
    pub fn visible_ranges(&self) -> Vec<TriangleRange> {
        let parts = self.table.parts().object_parts.iter().flat_map(|of| self.union_of(&of.seen));
        triangle_ranges(self.table.object_parts(), &self.visible_objects(), parts)
    }

    /// Puts the objects that may be seen from the point into `out`, which is cleared first; ascending. Allocates nothing but what
    /// `out` lacks. O(words of a row), without own rows of objects O(n log n) for the n objects listed in the visible cells.
    pub fn visible_objects_into(&self, out: &mut Vec<ObjectId>) {
        out.clear();
        match &self.table.parts().objects_seen {
            Some(seen) => out.extend(self.union_of(seen).map(|o| ObjectId(o as u32))),
            None => {
                self.visible_cells().for_each(|cell| out.extend_from_slice(self.table.objects_of(cell)));
                out.sort_unstable();
                out.dedup();
            }
        }
    }

    /// The ones of the union of the rows of the cells.
    fn union_of<'r>(&'r self, rows: &'r BitMatrix) -> impl Iterator<Item = usize> + 'r {
        let n_words = self.cells.first().map_or(0, |cell| rows.row(cell.idx()).len());
        (0..n_words).flat_map(move |k| {
            let word = self.cells.iter().fold(0, |word, cell| word | rows.row(cell.idx())[k]);
            ones(word).map(move |i| k * WORD + i)
        })
    }
}

/// The places of the ones of a word, ascending.
fn ones(word: u64) -> impl Iterator<Item = usize> {
    let mut rest = word;
    std::iter::from_fn(move || {
        let at = (rest != 0).then(|| rest.trailing_zeros() as usize)?;
        rest &= rest - 1;
        Some(at)
    })
}
