//! What is behind the Python package `sightlines`: tables, plans and bakes for the module `sightlines._native`.
//!
//! # Scope
//!
//! - **Owns**: arrays of numpy to and from the project's types, exceptions, signals and progress during long calls.
//! - **Out of scope**: everything that needs no types of Rust: shapely, geopandas, trimesh, pictures. That is Python, in
//!   `lib/sightlines`, and so is what users call; this module is private to it.
//! - **Invariants**: no input causes a panic; a panic would be our own bug, and reaches Python as `sightlines.Error`. No lock of the
//!   interpreter is held during a bake.

mod arrays;
mod bake;
mod error;
mod explain;
mod isovist;
mod long;
mod plan;
mod relevance;
mod scenes;
mod strip;
mod table;
mod vga;

use pyo3::prelude::*;

/// The part of the package that is written in Rust.
#[pymodule]
fn _native(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add("Error", m.py().get_type::<error::Error>())?;
    m.add("__version__", env!("CARGO_PKG_VERSION"))?;
    m.add_class::<table::Table>()?;
    m.add_class::<plan::Plan>()?;
    m.add_class::<relevance::Reaches>()?;
    m.add_class::<explain::Explanation>()?;
    m.add_class::<isovist::Isovists>()?;
    m.add_function(wrap_pyfunction!(isovist::isovists_of, m)?)?;
    m.add_function(wrap_pyfunction!(isovist::isovist_of, m)?)?;
    m.add_function(wrap_pyfunction!(isovist::sees, m)?)?;
    m.add_function(wrap_pyfunction!(isovist::sees_each, m)?)?;
    m.add_function(wrap_pyfunction!(vga::vga, m)?)?;
    m.add_function(wrap_pyfunction!(vga::vga_measures, m)?)?;
    m.add_function(wrap_pyfunction!(bake::bake_file, m)?)?;
    m.add_function(wrap_pyfunction!(bake::bake_bytes, m)?)?;
    m.add_function(wrap_pyfunction!(bake::bake_meshes, m)?)?;
    m.add_function(wrap_pyfunction!(strip::strip_file, m)?)?;
    m.add_function(wrap_pyfunction!(strip::strip_bytes, m)?)?;
    m.add_function(wrap_pyfunction!(strip::strip_meshes, m)?)?;
    m.add_function(wrap_pyfunction!(scenes::tower, m)?)?;
    m.add_function(wrap_pyfunction!(scenes::office, m)?)?;
    m.add_function(wrap_pyfunction!(scenes::city, m)?)?;
    Ok(())
}
