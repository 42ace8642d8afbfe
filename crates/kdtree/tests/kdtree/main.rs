//! Cells and portals of k-d trees, in the plane and in space.

mod cells;
mod common;
mod cutter;
mod degenerate;
mod doors;
mod meshes;
mod openings;
mod rooms;
mod solids;
mod threshold;
mod triangles;
