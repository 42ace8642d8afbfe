//! `generate`: scenes to try things on.

use crate::Answer;
use crate::file_error::{FileError, from_file_error};
use crate::glb::{self, GlbError, save_glb};
use crate::output::{self, bytes, count};
use serde::Serialize;
use sightlines::scenes::SceneError;
use sightlines::scenes::{TowerOptions, tower, tower_rooms};
use std::fmt;
use std::path::PathBuf;

/// Why `generate` fails; exit code 2.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Error {
    /// A file cannot be read, used or written.
    #[error(transparent)]
    File(FileError),
    /// A scene that cannot be written as GLB.
    #[error(transparent)]
    Glb(#[from] GlbError),
    /// A scene cannot be generated.
    #[error(transparent)]
    Generate(#[from] SceneError),
}

from_file_error!(Error);

/// Arguments of `generate`.
#[derive(Debug, clap::Args)]
pub(crate) struct GenerateArgs {
    #[command(subcommand)]
    what: What,
}

/// What to generate.
#[derive(Debug, clap::Subcommand)]
enum What {
    /// A furnished office tower in metres, y up, as GLB
    Tower(TowerArgs),
}

/// Arguments of `generate tower`.
#[derive(Debug, clap::Args)]
struct TowerArgs {
    /// Seed of the generator
    #[arg(long, help_heading = "Tower", value_name = "N", default_value_t = TowerOptions::default().seed)]
    seed: u64,
    /// Floors, 1 to 256; a higher tower has the same lower floors
    #[arg(long, help_heading = "Tower", value_name = "N", default_value_t = TowerOptions::default().floors)]
    floors: u32,
    /// Rooms side by side, 1 to 128
    #[arg(long, help_heading = "Tower", value_name = "N", default_value_t = TowerOptions::default().rooms_x)]
    rooms_x: u32,
    /// Rows of rooms, 1 to 128
    #[arg(long, help_heading = "Tower", value_name = "N", default_value_t = TowerOptions::default().rooms_y)]
    rooms_y: u32,
    /// Furniture, 0 (none) to 3 (finest)
    #[arg(long, help_heading = "Tower", value_name = "LEVEL", default_value_t = TowerOptions::default().furniture)]
    furniture: u32,
    /// Leave out the windows
    #[arg(long, help_heading = "Tower")]
    no_windows: bool,
    /// Thickness of the walls, in metres: 0, 0.25 or 0.5
    #[arg(long, help_heading = "Tower", value_name = "UNITS")]
    #[arg(default_value_t = TowerOptions::default().wall_thickness, allow_hyphen_values = true)]
    wall_thickness: f64,
    /// The scene to write
    #[arg(short, long, help_heading = "Output", value_name = "OUT.glb")]
    output: PathBuf,
    /// Print the result as JSON
    #[arg(long, help_heading = "Output")]
    json: bool,
}

pub(crate) fn run(args: &GenerateArgs) -> Result<Answer, Error> {
    let What::Tower(args) = &args.what;
    glb::check_name(&args.output)?;
    output::check(&[], &[&args.output])?;
    let options = TowerOptions {
        seed: args.seed,
        floors: args.floors,
        rooms_x: args.rooms_x,
        rooms_y: args.rooms_y,
        furniture: args.furniture,
        windows: !args.no_windows,
        wall_thickness: args.wall_thickness,
    };
    let scene = tower(options)?;
    let n_bytes = save_glb(&args.output, &scene)?;
    let outcome = Outcome {
        out: args.output.display().to_string(),
        seed: args.seed,
        n_floors: args.floors,
        n_rooms: tower_rooms(options)?.len(),
        n_objects: scene.objects().len(),
        n_triangles: scene.n_triangles(),
        n_bytes,
    };
    output::print(args.json, &outcome)?;
    Ok(Answer::Yes)
}

/// What was written.
#[derive(Debug, Serialize)]
struct Outcome {
    out: String,
    seed: u64,
    n_floors: u32,
    /// Stairwells are rooms, corridors are not.
    n_rooms: usize,
    n_objects: usize,
    n_triangles: usize,
    n_bytes: usize,
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "wrote {}, {}", self.out, bytes(self.n_bytes as u64))?;
        let [floors, rooms] = [count(self.n_floors, "floor"), count(self.n_rooms as u64, "room")];
        writeln!(f, "a tower of {floors} and {rooms} (seed {})", self.seed)?;
        writeln!(f, "objects        {}\ntriangles      {}", self.n_objects, self.n_triangles)
    }
}
