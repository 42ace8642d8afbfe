//! Sweeps that push methods to where they fail.
//!
//! A [`Sweep`] has a parameter with levels, and methods that answer the same question: may this be called hidden?
//! For each level it draws cases from a seed, knows the truth of each by exact arithmetic that shares no code with
//! the methods, and counts how they answer. What is counted is written as CSV ([`table`]); pictures and the page
//! are made of the CSV alone ([`draw`], [`page`]). [`run()`] is the whole of it, for the program `stability`.
//!
//! # Kinds of failures
//! * *unsafe*: an answer of hidden for something that an open set of lines sees. A shipped method may never do that.
//! * *loose*: an answer of visible or unknown for something hidden. That costs time, nothing else.
//! * *error*: no answer: a panic, an error, a number that is none.
//!
//! Shipped methods must have no unsafe failure and no error; each naive method must have an unsafe failure in some
//! sweep, for else the sweeps are not sharp enough to tell.

pub mod axial;
pub mod buffers;
pub mod convex;
pub mod draw;
pub mod draws;
pub mod method;
pub mod page;
mod plain;
pub mod plane;
pub mod predicates;
pub mod run;
mod shader_float;
pub mod solvers;
pub mod surfaces;
pub mod sweep;
pub mod table;

pub use method::{Answer, Decide, Kind, Outcome, SweepMethod, method};
pub use run::{Options, RunError, run};
pub use sweep::{Board, Finding, Sweep};
pub use table::{Row, TableError};

/// All sweeps, in the order of the page. `quick` has fewer levels and cases of each.
pub fn all(quick: bool) -> Vec<Sweep> {
    [
        plane::sweeps(quick),
        axial::sweeps(quick),
        convex::sweeps(quick),
        predicates::sweeps(quick),
        buffers::sweeps(quick),
        surfaces::sweeps(quick),
    ]
    .into_iter()
    .flatten()
    .collect()
}

#[cfg(test)]
mod tests;
