//! Walks and movers, frame by frame.

mod moving;
mod sources;
mod walk;
