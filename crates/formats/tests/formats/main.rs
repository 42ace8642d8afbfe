//! Readers and writers of maps and scenes, on small, random, broken and real files.

mod common;
mod dxf;
mod maps;
mod materials;
mod motion;
mod mutations;
mod quake_bsp;
mod quake_family;
mod quake_prt;
mod quake_real;
mod quake_world;
mod real;
mod registry;
mod rewrite;
mod roles;
mod scene_mutations;
mod scene_oracles;
mod scene_writers;
mod scenes;
mod udmf;
