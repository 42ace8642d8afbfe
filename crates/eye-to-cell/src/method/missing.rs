//! What the exact method has not found yet.
//!
//! The incident portals' answer holds all that can be seen. Once all of it is found there is nothing more to look
//! for, and a cone that meets nothing of what is missing need not be followed.

use super::budget::Work;
use super::query::{Query, excluded};
use super::reach;
use crate::side::Side;
use crate::subgraph::VisibleSubgraph;
use crate::view::View;
use crate::visible_set::VisibleSet;

/// Something that a line from the eye may lead to.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Missing {
    /// A cell of the subgraph.
    Cell(u32),
    /// An object of the subgraph.
    Object(u32),
    /// A cell with a mirror, which is never done with: each way to it shows something else.
    Mirror(u32),
}

/// Lists what the exact method may find, as `wanted` cells, and as what is missing of it.
pub(super) fn list_missing(query: &mut Query<'_>) {
    reach::incident_cells(query);
    let subgraph = query.subgraph;
    query.scratch.missing.clear();
    for k in 0..query.scratch.wanted.list().len() {
        let cell = query.scratch.wanted.list()[k];
        query.scratch.missing.push(Missing::Cell(cell));
        query.scratch.work.take((1 + subgraph.ways_of(cell).len() + subgraph.objects_of(cell).len()) as u64);
        if !subgraph.mirrors_of(cell).is_empty() {
            query.scratch.missing.push(Missing::Mirror(cell));
        }
        for &object in subgraph.objects_of(cell) {
            if !query.seen.has_object(subgraph.objects[object as usize]) && query.object_in_view(object) {
                query.scratch.missing.push(Missing::Object(object));
            }
        }
    }
}

/// Whether a cone may meet anything that is missing. Strikes off what was found.
pub(super) fn meets(
    missing: &mut Vec<Missing>,
    work: &mut Work,
    cone: &[Side],
    subgraph: &VisibleSubgraph,
    view: &View,
    seen: &VisibleSet,
) -> bool {
    let mut k = 0;
    while let Some(&item) = missing.get(k) {
        work.take(1);
        let (found, bounds) = match item {
            Missing::Cell(cell) => (seen.has_cell(subgraph.cells[cell as usize]), &subgraph.bounds[cell as usize]),
            Missing::Object(object) => {
                (seen.has_object(subgraph.objects[object as usize]), &subgraph.object_bounds[object as usize])
            }
            Missing::Mirror(cell) => (false, &subgraph.bounds[cell as usize]),
        };
        if found {
            missing.swap_remove(k);
        } else if excluded(cone, bounds, view.eye) {
            k += 1;
        } else {
            // What is met once is often met again.
            missing.swap(0, k);
            return true;
        }
    }
    false
}
