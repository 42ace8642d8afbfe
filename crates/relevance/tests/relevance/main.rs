//! Reaches and answers against brute force on small grids.

mod grid;
mod reaches;
mod ticks;
mod times;
