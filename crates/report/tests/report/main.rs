//! Pictures and exports.

mod common;
mod export;
mod pictures;
mod space;
mod surfaces;
