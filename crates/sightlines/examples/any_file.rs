//! From the bytes of a file to answers: a floor plan as GeoJSON, a Doom map in a WAD, a scene as GLB, and the portal file of a Quake
//! map. All of them are generated here; with files, `Source::File` takes a path.
//!
//! Run as `cargo run --release -p sightlines --example any_file`.

use sightlines::bake::{BakeRequest, Bakeable, bake};
use sightlines::formats::doom::{DoomMapSource, SourceLine, write_doom_map};
use sightlines::formats::{LumpName, Source, geojson, scene::write_glb};
use sightlines::pvs::{CellId, Table};
use sightlines::scenes::{OfficeOptions, TowerOptions, office, tower};
use std::error::Error;
use std::path::Path;

/// The table of a file, which is given by its name and its bytes.
fn table_of(name: &str, bytes: &[u8]) -> Result<Table, Box<dyn Error>> {
    let source = Source::Memory { name: Path::new(name), bytes, beside: None };
    let input = Bakeable::read(&source, None)?;
    Ok(bake(&input, &BakeRequest::default())?.table)
}

/// A square room with walls all round.
fn doom_room() -> DoomMapSource {
    let wall = |v1, v2| SourceLine { v1, v2, flags: 1, right: Some(0), left: None };
    DoomMapSource {
        vertices: vec![[0, 0], [0, 64], [64, 64], [64, 0]],
        lines: vec![wall(0, 1), wall(1, 2), wall(2, 3), wall(3, 0)],
        n_sectors: 1,
        things: Vec::new(),
        reject: None,
        hexen: false,
    }
}

/// Three clusters in a row, and the two openings between them.
const PORTALS: &[u8] =
    b"PRT1\n3\n2\n4 0 1 (8 0 0) (8 2 0) (8 2 2) (8 0 2)\n4 1 2 (16 6 6) (16 8 6) (16 8 8) (16 6 8)\n";

fn main() -> Result<(), Box<dyn Error>> {
    // A plan: which cells does a viewer at a point see?
    let plan = office(OfficeOptions { rooms_x: 6, rooms_y: 3, ..OfficeOptions::default() })?;
    let table = table_of("office.geojson", geojson::write_plan(&plan).as_bytes())?;
    let bounds = plan.bounds();
    let eye = [0, 1].map(|k| 0.5 * (bounds.min[k] + bounds.max[k]));
    match table.in_dimension::<2>()?.at(eye).inside() {
        Some(here) => println!("office: {} of {} cells in sight", here.visible_cells().count(), table.n_cells()),
        None => println!("office: {eye:?} is outside every cell, where everything may be seen"),
    }

    // A Doom map: the WAD has only one, so it need not be named.
    let wad = write_doom_map(LumpName::new("MAP01")?, &doom_room())?;
    println!("Doom map: {} cells", table_of("room.wad", &wad)?.n_cells());

    // A scene in space: which objects?
    let scene = tower(TowerOptions { floors: 2, rooms_x: 2, rooms_y: 1, furniture: 1, ..TowerOptions::default() })?;
    let table = table_of("tower.glb", &write_glb(&scene)?)?;
    let here = table.in_dimension::<3>()?.at([4.0, 1.5, 4.0]).inside().ok_or("the eye is in a room")?;
    let seen = here.visible_objects();
    println!("tower: {} of {} objects in sight", seen.len(), table.objects().len());
    assert!(!seen.is_empty() && seen.len() < table.objects().len());

    // The portal file of a Quake map: its cells are clusters at unknown places, so they are queried by number.
    let table = table_of("rooms.prt", PORTALS)?;
    println!("clusters that the first one sees: {:?}", table.visible(CellId(0)).collect::<Vec<_>>());
    Ok(())
}
