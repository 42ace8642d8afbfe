//! The program, run as a user runs it.

mod auto;
mod cell_names;
mod certify;
mod common;
mod doors;
mod draw;
mod errors;
mod explain_boxes;
mod explain_portals;
mod far;
mod guides;
mod help;
mod json;
mod light;
mod maps;
mod materials;
mod multifocal;
mod outputs;
mod own;
mod pack;
mod region;
mod reject;
mod render;

mod same_bytes;
mod simplify;
mod space;
mod space_errors;
mod stab_trees;
mod tables;
mod verify;
mod view;
mod vis;
mod vis_errors;
mod vis_real;
mod walk;
