//! Scenes that change under a viewer: things that move, tables that are replaced, levels that come when they are read.

mod grid;
mod levels;
mod movers;
mod promises;
mod replace;
