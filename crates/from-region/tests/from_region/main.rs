//! View shafts and voxels against rays, closed surfaces against floods of cells, balls against balls on whole numbers.

mod ball;
mod closed;
mod common;
mod conformance;
mod real;
mod shafts;
mod voxels;
