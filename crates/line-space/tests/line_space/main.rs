//! The tests of this crate, as one program.

mod conforms;
mod hides;
mod known;
