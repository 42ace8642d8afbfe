//! Generated scenes, for examples and tests.

use crate::error::{error, value_error};
use crate::plan::Plan;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use sightlines_formats::scene::write_glb;
use sightlines_scenes::{CityOptions, OfficeOptions, TowerOptions};

/// An office tower, as the bytes of a GLB file.
#[pyfunction]
#[pyo3(signature = (floors, rooms_x, rooms_y, furniture, seed))]
pub(crate) fn tower(
    py: Python<'_>,
    floors: u32,
    rooms_x: u32,
    rooms_y: u32,
    furniture: u32,
    seed: u64,
) -> PyResult<Bound<'_, PyBytes>> {
    let options = TowerOptions { seed, floors, rooms_x, rooms_y, furniture, ..TowerOptions::default() };
    let bytes = py.detach(|| {
        let scene = sightlines_scenes::tower(options).map_err(value_error)?;
        write_glb(&scene).map_err(error)
    })?;
    Ok(PyBytes::new(py, &bytes))
}

/// An office floor.
#[pyfunction]
#[pyo3(signature = (rooms_x, rooms_y, wall_thickness, furniture, seed))]
pub(crate) fn office(
    py: Python<'_>,
    rooms_x: u32,
    rooms_y: u32,
    wall_thickness: f64,
    furniture: bool,
    seed: u64,
) -> PyResult<Plan> {
    let options = OfficeOptions { seed, rooms_x, rooms_y, wall_thickness, furniture, ..OfficeOptions::default() };
    py.detach(|| sightlines_scenes::office(options)).map(Plan::from).map_err(value_error)
}

/// Streets and houses.
#[pyfunction]
#[pyo3(signature = (blocks_x, blocks_z, seed))]
pub(crate) fn city(py: Python<'_>, blocks_x: u32, blocks_z: u32, seed: u64) -> PyResult<Bound<'_, PyBytes>> {
    let options = CityOptions { seed, blocks_x, blocks_z, ..CityOptions::default() };
    let bytes = py.detach(|| {
        let scene = sightlines_scenes::city(options).map_err(value_error)?;
        write_glb(&scene).map_err(error)
    })?;
    Ok(PyBytes::new(py, &bytes))
}
