//! Tests across crates.

mod convex_classical;
mod convex_found;
mod convex_merged;
mod convex_worlds;
mod docs;
mod doom;
mod eye_to_cell;
mod frames;
mod from_region;
mod layers;
mod lines;
mod made_portals;
mod materials;
mod names;
mod oracles;
mod quake_tables;
mod scenes;
mod simplify;
mod viewer;
mod viewer_isovist;
mod viewer_methods;
mod viewer_soon;
mod visible_surface;
mod web_module;
mod web_package;
