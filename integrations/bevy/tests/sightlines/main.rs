//! The plugin in headless apps: what is left in the lists of cameras, and what is left in their pictures.
//!
//! The levels are generated: `cargo xtask bevy-assets` in the folder of the project, once. Those with walls of one side are made by their tests, which
//! run the program.

mod app;
mod lists;
mod misfits;
mod one_sided;
mod parts;
mod pictures;
#[cfg(feature = "replicon")]
mod server;
mod shots;
