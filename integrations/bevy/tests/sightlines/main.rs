//! The plugin in headless apps: what is left in the lists of cameras, and what is left in their pictures.
//!
//! The levels are generated: `cargo xtask bevy-assets` in the folder of the project, once.

mod app;
mod lists;
mod misfits;
mod parts;
mod pictures;
