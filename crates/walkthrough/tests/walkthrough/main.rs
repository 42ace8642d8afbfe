//! Walks and movers, frame by frame.

mod moving;
mod walk;
