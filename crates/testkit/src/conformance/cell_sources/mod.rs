//! The contract of [`CellSource`].
//!
//! A source is asked about every cell and object, twice, with buffers that hold something else before:
//! 1. ranges: the dimension is 2 or 3, and ids of cells, objects, portals and tree nodes are in range;
//! 2. ordered: lists are cleared first and strictly ascending, and a cell is in its own list;
//! 3. two-sided: each portal leads back from the cell that it enters, in the other direction, with the same corners, and
//!    the cell that it enters may be seen;
//! 4. shapes: boxes are finite and in order, corners are finite, as many as the dimension asks for, and inside the box of
//!    their cell;
//! 5. trees: either all cells have stab trees or none, and each node crosses a portal of the cell that its parent leads
//!    into;
//! 6. repeatable: the same question has the same answer;
//! 7. conservative: with a reference, nothing that may be seen there is missing here, and cells, portals, objects and
//!    mirrors are the same;
//! 8. done: the source gives no error.

mod check;
mod impostor;

use super::{Clause, Report, Suite, Violation};
use check::Answers;
pub use impostor::CellSourceFault;
use sightlines_eye_to_cell::CellSource;

/// The suite of cell sources. Cost: two passes over all cells, and at most 100,000 nodes of stab trees.
#[derive(Debug, Clone, Copy)]
pub struct CellSources<'a, R> {
    /// A source that keeps the contract, to compare with.
    pub reference: Option<&'a R>,
}

impl<S: CellSource, R: CellSource> Suite<S> for CellSources<'_, R> {
    const CONTRACT: &'static str = "cell source";
    const NEEDED: &'static [&'static str] = &["cells"];
    const COUNTED: &'static [&'static str] = &[
        "visible cells",
        "portals of cells",
        "objects",
        "visible objects",
        "mirrors",
        "nodes of stab trees",
        "cells compared",
    ];

    fn check(&self, source: &mut S, report: &mut Report) -> Result<(), Violation> {
        let answers = Answers::of(&*source, report)?;
        answers.count(report);
        answers.check_edges(report)?;
        answers.check_trees(&*source, report)?;
        let Some(reference) = self.reference else { return Ok(()) };
        let truth = Answers::of(reference, report)?;
        answers.compare(&truth, report)
    }
}
