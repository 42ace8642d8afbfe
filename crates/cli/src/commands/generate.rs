//! `generate`: scenes to try things on.

use crate::command::{Done, JsonArg, Verbosity, commands};
use crate::error::Result;
use crate::glb::save_glb;
use crate::output::{self, JsonSchema, Serialize, bytes, cannot_be_made, count};
use sightlines::geometry::Aabb;
use sightlines::scenes::{
    CityOptions, CityTile, GearboxOptions, TowerOptions, city_tiles, gearbox, tower, tower_rooms,
};
use sightlines::tiles::{TilePlan, WorldPlan};
use std::fmt;
use std::fs;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub(crate) struct GenerateArgs {
    #[command(subcommand)]
    what: What,
}

commands! {
    enum What:
    /// A furnished office tower in metres, y up, as GLB
    Tower(TowerArgs) => write_tower,
    /// A city in metres, y up, in tiles: a folder with the plan world.json, and for each tile a GLB and a file of view cells
    World(WorldArgs) => write_world,
    /// A closed gearbox: most of it can be seen from nowhere outside. As GLB
    Gearbox(GearboxArgs) => write_gearbox,
}

#[derive(Debug, clap::Args)]
pub(crate) struct WorldArgs {
    /// Seed of the generator
    #[arg(long, help_heading = "World", value_name = "N", default_value_t = CityOptions::default().seed)]
    seed: u64,
    /// Blocks of four houses along each side, 1 to 64
    #[arg(long, help_heading = "World", value_name = "N", default_value_t = CityOptions::default().blocks_x)]
    blocks: u32,
    /// Blocks along each side of a tile, from 1 on
    #[arg(long, help_heading = "World", value_name = "N", default_value_t = 2)]
    per_tile: u32,
    /// Cuts of a bay of 4 metres and of a storey along each side, 1 to 8
    #[arg(long, help_heading = "World", value_name = "N", default_value_t = CityOptions::default().detail)]
    detail: u32,
    /// What is at most so far from a tile, in metres, is near it
    #[arg(long, help_heading = "World", value_name = "UNITS", default_value_t = 20.0, value_parser = crate::numbers::size)]
    border: f64,
    /// The folder to write, which is made
    #[arg(short, long, help_heading = "Output", value_name = "FOLDER")]
    output: PathBuf,
    #[command(flatten)]
    json: JsonArg,
}

#[derive(Debug, clap::Args)]
pub(crate) struct TowerArgs {
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
    #[command(flatten)]
    json: JsonArg,
}

#[derive(Debug, clap::Args)]
pub(crate) struct GearboxArgs {
    /// Seed of the generator
    #[arg(long, help_heading = "Gearbox", value_name = "N", default_value_t = GearboxOptions::default().seed)]
    seed: u64,
    /// Gears, 1 to 20000, with a bolt and a nut for each
    #[arg(long, help_heading = "Gearbox", value_name = "N", default_value_t = GearboxOptions::default().gears)]
    gears: u32,
    /// The scene to write
    #[arg(short, long, help_heading = "Output", value_name = "OUT.glb")]
    output: PathBuf,
    #[command(flatten)]
    json: JsonArg,
}

pub(crate) fn run(args: &GenerateArgs, verbosity: Verbosity) -> Result<Done> {
    args.what.run(verbosity)
}

fn write_world(args: &WorldArgs, _: Verbosity) -> Result<Done> {
    let WorldArgs { seed, blocks, per_tile, detail, border, ref output, json } = *args;
    let options = CityOptions { seed, blocks_x: blocks, blocks_z: blocks, detail };
    let tiles = city_tiles(options, per_tile)?;
    fs::create_dir_all(output).map_err(|error| cannot_be_made(output, error))?;
    let mut plan = WorldPlan { border, reach: None, tiles: Vec::new() };
    let mut outcome =
        WorldOutcome { out: output.display().to_string(), seed, n_tiles: tiles.len(), ..WorldOutcome::default() };
    for CityTile { name, scene, cells } in tiles {
        let [scene_name, cells_name] = [format!("{name}.glb"), format!("{name}.cells.json")];
        save_glb(&output.join(&scene_name), &scene)?;
        let cell = |(k, b): (usize, &Aabb<3>)| serde_json::json!({"id": k.to_string(), "min": b.min, "max": b.max});
        let cells_text = serde_json::json!({"cells": cells.iter().enumerate().map(cell).collect::<Vec<_>>()});
        output::save(&output.join(&cells_name), cells_text.to_string().as_bytes())?;
        outcome.n_cells += cells.len();
        outcome.n_objects += scene.objects().len();
        outcome.n_triangles += scene.n_triangles();
        plan.tiles.push(TilePlan { name, scene: scene_name, at: [0.0; 3], viewers: None, cells: Some(cells_name) });
    }
    output::save(&output.join("world.json"), plan.to_json().as_bytes())?;
    Ok(Done::new(json, outcome))
}

/// What was written of a world.
#[derive(Debug, Default, Serialize, JsonSchema)]
pub(crate) struct WorldOutcome {
    /// The folder that was written.
    out: String,
    /// Seed of the generator.
    seed: u64,
    /// Tiles.
    n_tiles: usize,
    /// View cells of all tiles.
    n_cells: usize,
    /// Objects of all tiles.
    n_objects: usize,
    /// Triangles of all tiles.
    n_triangles: usize,
}

impl fmt::Display for WorldOutcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "wrote {}: a city of {} (seed {})", self.out, count(self.n_tiles as u64, "tile"), self.seed)?;
        let Self { n_cells, n_objects, n_triangles, .. } = self;
        writeln!(f, "view cells     {n_cells}\nobjects        {n_objects}\ntriangles      {n_triangles}")
    }
}

fn write_gearbox(args: &GearboxArgs, _: Verbosity) -> Result<Done> {
    output::check_ending(&args.output, "scene", "glb")?;
    output::check(&[], &[&args.output])?;
    let made = gearbox(GearboxOptions { seed: args.seed, gears: args.gears })?;
    let n_bytes = save_glb(&args.output, &made.scene)?;
    let outcome = GearboxOutcome {
        out: args.output.display().to_string(),
        seed: args.seed,
        n_objects: made.scene.objects().len(),
        n_hidden_objects: made.hidden.len(),
        n_triangles: made.scene.n_triangles(),
        n_bytes,
    };
    Ok(Done::new(args.json, outcome))
}

/// What was written of a gearbox.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct GearboxOutcome {
    /// The scene that was written.
    out: String,
    /// Seed of the generator.
    seed: u64,
    /// Objects.
    n_objects: usize,
    /// Those of them that nobody outside can see.
    n_hidden_objects: usize,
    /// Triangles.
    n_triangles: usize,
    /// Bytes of the file.
    n_bytes: usize,
}

impl fmt::Display for GearboxOutcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "wrote {}, {}", self.out, bytes(self.n_bytes as u64))?;
        let Self { n_objects, n_hidden_objects, n_triangles, seed, .. } = self;
        writeln!(f, "a gearbox (seed {seed})")?;
        writeln!(
            f,
            "objects        {n_objects}, {n_hidden_objects} of them hidden from outside\ntriangles      {n_triangles}"
        )
    }
}

fn write_tower(args: &TowerArgs, _: Verbosity) -> Result<Done> {
    output::check_ending(&args.output, "scene", "glb")?;
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
    Ok(Done::new(args.json, outcome))
}

/// The scene that was written.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct Outcome {
    /// The scene that was written.
    out: String,
    /// Seed of the generator.
    seed: u64,
    /// Floors.
    n_floors: u32,
    /// Rooms; stairwells are rooms, corridors are not.
    n_rooms: usize,
    /// Objects.
    n_objects: usize,
    /// Triangles.
    n_triangles: usize,
    /// Bytes of the file.
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
