//! View shafts and voxels against rays.

mod common;
mod conformance;
mod real;
mod shafts;
mod voxels;
