//! Runtime table: which cells can be seen from which.

mod id;

pub use id::CellId;
