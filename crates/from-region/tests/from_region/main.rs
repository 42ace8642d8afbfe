//! View shafts and voxels against rays.

mod common;
mod real;
mod shafts;
mod voxels;
