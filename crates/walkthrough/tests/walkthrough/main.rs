//! Walks and movers, frame by frame.

mod moving;
#[cfg(feature = "packed")]
mod sources;
mod walk;
