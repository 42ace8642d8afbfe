//! Viewers, walks and movers, look by look and frame by frame.

mod moving;
#[cfg(feature = "packed")]
mod sources;
mod viewer;
mod walk;
