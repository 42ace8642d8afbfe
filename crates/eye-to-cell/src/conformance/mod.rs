//! The contract of [`CellSource`], as code that anyone can run against their own implementation.
//!
//! [`run`] asks a source about every cell and object, twice, with buffers that hold something else before, and checks:
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
//!    mirrors are the same.
//!
//! [`impostors`] are sources with one fault each, which the suite has to refuse.

mod check;
pub mod impostors;
mod violation;

use crate::CellSource;
use check::Answers;
pub use violation::{Clause, Violation};

/// What was compared, without a violation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Report {
    /// Cells.
    pub cells: usize,
    /// Pairs of a cell and a cell that it may see.
    pub visible: usize,
    /// Portals, once for each side.
    pub edges: usize,
    /// Objects.
    pub objects: usize,
    /// Pairs of a cell and an object that it may see.
    pub objects_seen: usize,
    /// Pieces of mirrors.
    pub mirrors: usize,
    /// Nodes of stab trees that were followed.
    pub nodes: usize,
    /// Cells compared with those of a reference.
    pub compared: usize,
}

/// Checks that a source keeps the contract; against a reference if there is one, which has to keep it too.
///
/// Cost: two passes over all cells, and at most 100,000 nodes of stab trees.
///
/// # Errors
/// The first [`Violation`] that was found; one of them is that the source has no cells. Errors of the source are
/// violations: what is checked has to be readable.
pub fn run<S, R>(source: &S, reference: Option<&R>) -> Result<Report, Violation>
where
    S: CellSource,
    R: CellSource,
{
    let mut report = Report::default();
    let answers = Answers::of(source, &mut report)?;
    answers.check_edges()?;
    answers.check_trees(source, &mut report)?;
    if let Some(reference) = reference {
        let mut unused = Report::default();
        let truth = Answers::of(reference, &mut unused)?;
        answers.compare(&truth, &mut report)?;
    }
    if report.cells == 0 {
        return Err(Violation::NothingRan);
    }
    Ok(report)
}
