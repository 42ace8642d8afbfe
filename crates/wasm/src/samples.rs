//! What can be tried without a file.

use sightlines_formats::geojson::write_plan;
use sightlines_formats::scene::write_glb;
use sightlines_scenes::{OfficeOptions, TowerOptions, doom_like, office, tower};

/// A built-in input.
#[derive(Debug, Clone, Copy)]
pub struct Sample {
    /// Its name, for questions.
    pub name: &'static str,
    /// What it is, for people.
    pub about: &'static str,
    /// The name of its file.
    pub file: &'static str,
    /// Makes the file.
    pub(crate) make: fn() -> Result<Vec<u8>, String>,
}

/// All samples.
pub const SAMPLES: [Sample; 3] = [
    Sample {
        name: "plan",
        about: "Floor plan of an office",
        file: "office.geojson",
        make: || Ok(write_plan(&office(OfficeOptions::default()).map_err(|e| e.to_string())?).into_bytes()),
    },
    Sample {
        name: "house",
        about: "Building of two floors",
        file: "house.glb",
        make: || {
            let scene = tower(TowerOptions { floors: 2, ..TowerOptions::default() }).map_err(|e| e.to_string())?;
            write_glb(&scene).map_err(|e| e.to_string())
        },
    },
    Sample {
        name: "doom",
        about: "Map in the manner of Doom",
        file: "map.geojson",
        make: || Ok(write_plan(&doom_like(1, 5).map_err(|e| e.to_string())?).into_bytes()),
    },
];
