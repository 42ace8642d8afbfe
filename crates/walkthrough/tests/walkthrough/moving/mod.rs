//! Scenes that change under a viewer: moving objects, replaced tables, levels that arrive later.

mod grid;
mod levels;
mod movers;
mod promises;
mod replace;
