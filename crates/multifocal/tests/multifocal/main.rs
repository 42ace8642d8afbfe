//! Occluders made from meshes.

mod mesh_patches;
mod mesh_real;
mod mesh_sheets;
