//! Results of units of work as bytes: what a group of cells sees of another, and from where an object is seen.
//!
//! A unit decides all its pairs, so its result does not depend on what other units have found.

use super::AxialSearch;
use super::pairs::Pair;
use sightlines_progress::read_whole;
use sightlines_pvs::runs::{read_runs, runs_of, write_runs};
use std::ops::Range;

/// The phase of pairs of groups of cells.
pub(super) const PAIRS: &str = "pairs";
/// The phase of objects.
pub(super) const OBJECTS: &str = "objects";

/// What results are of.
pub(super) const OF: &str = "this bake";

impl AxialSearch<'_> {
    fn places_of(&self, node: u32) -> Range<usize> {
        let node = &self.tree.nodes()[node as usize];
        node.start as usize..node.end as usize
    }

    /// The predicted cost of a pair of groups: in proportion to its pairs of cells, most of which are decided together.
    pub(super) fn cost_of(&self, [a, b]: Pair) -> f64 {
        let n = [a, b].map(|node| self.places_of(node).len() as f64);
        (n[0] * n[1]).sqrt()
    }

    /// The predicted cost of an object, once pairs of cells are decided: in proportion to the cells that may see it.
    pub(super) fn cost_of_object(&self, object: usize) -> f64 {
        1.0 + self.maybe.ones(object).count() as f64
    }

    /// Which cells of one group see which of another, once that is decided.
    pub(super) fn result_of_pairs(&self, [a, b]: Pair) -> Vec<u8> {
        let (rows, cols) = (self.places_of(a), self.places_of(b));
        let mut out = Vec::new();
        for row in rows {
            let seen = self.cells.ones_within(row, [cols.start, cols.end]).map(|col| (col - cols.start) as u32);
            write_runs(&runs_of(seen), &mut out);
        }
        out
    }

    /// Marks the pairs of a result; `None` if it is of other groups, and then some may be marked.
    pub(super) fn restore_pairs(&self, [a, b]: Pair, bytes: &[u8]) -> Option<()> {
        let (rows, cols) = (self.places_of(a), self.places_of(b));
        read_whole(bytes, |bytes| {
            for row in rows {
                for col in read_runs(bytes, cols.len() as u32)?.into_iter().flatten() {
                    self.join(row, cols.start + col as usize);
                }
            }
            Some(())
        })
    }

    /// From which places an object is seen, once that is decided.
    pub(super) fn result_of_object(&self, object: usize) -> Vec<u8> {
        let mut out = Vec::new();
        write_runs(&runs_of(self.objects.ones(object).map(|place| place as u32)), &mut out);
        out
    }

    /// Marks the places of a result; `None` if it is of another object.
    pub(super) fn restore_object(&self, object: usize, bytes: &[u8]) -> Option<()> {
        let places = read_whole(bytes, |bytes| read_runs(bytes, self.cell_at.len() as u32))?;
        places.into_iter().flatten().for_each(|place| {
            self.objects.set(object, place as usize);
        });
        Some(())
    }
}
