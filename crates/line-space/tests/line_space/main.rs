//! The tests of this crate, as one program.

mod attacks;
mod conforms;
mod faces;
mod fronts;
mod hides;
mod known;
