//! Bakes an office floor and asks its table; builds the REJECT lumps of a Doom map of two sectors.
//!
//! Run as `cargo run -p sightlines-bake --example tables`.

use sightlines_bake::{MapStatus, PlanBakeOptions, RejectOptions, bake_plan, reject_wad};
use sightlines_formats::doom::{DoomMapSource, ML_TWOSIDED, SourceLine, list_maps, write_doom_map};
use sightlines_formats::{DoomMap, LumpName, RejectTable, Wad};
use sightlines_pvs::{Place, Table};
use sightlines_scenes::{OfficeOptions, office};
use std::error::Error;

/// From a plan to a table in bytes, and to what a viewer sees.
fn office_table() -> Result<(), Box<dyn Error>> {
    let floor = office(OfficeOptions { seed: 5, rooms_x: 10, rooms_y: 4, ..OfficeOptions::default() })?;
    let baked = bake_plan(&floor, &PlanBakeOptions::default())?;
    let did = &baked.report;
    println!(
        "office of {} walls, cut by {}: {} cells, {} portals, {} pairs see each other",
        floor.lines().len(),
        did.subdivide,
        did.n_cells,
        did.n_portals,
        did.n_visible_pairs
    );
    let bytes = baked.table.to_bytes();
    println!("the table takes {} bytes, {} without its geometry", bytes.len(), stripped_len(&baked.table));

    let table = Table::from_bytes(&bytes)?;
    let bounds = floor.bounds();
    let eye = [0, 1].map(|k| 0.5 * (bounds.min[k] + bounds.max[k]));
    let Place::Inside(here) = table.in_dimension()?.at(eye) else {
        println!("a viewer at {eye:?} is outside every cell");
        return Ok(());
    };
    println!("a viewer at {eye:?} is in cell {:?}", here.cells());
    println!("  and sees {} of {} cells", here.visible_cells().count(), table.n_cells());
    let objects = here.visible_objects();
    println!("  with {} of {} objects", objects.len(), table.objects().len());
    for &object in objects.iter().take(3) {
        println!("  such as {}", table.objects()[object.idx()].name);
    }
    Ok(())
}

fn stripped_len(table: &Table) -> usize {
    table.strip_geometry().to_bytes().len()
}

/// Two square rooms, sector 0 in the west and sector 1 in the east, with a line between them.
fn two_rooms(between: SourceLine) -> DoomMapSource {
    let wall = |v1, v2, sector| SourceLine { v1, v2, flags: 1, right: Some(sector), left: None };
    DoomMapSource {
        vertices: vec![[0, 0], [64, 0], [128, 0], [128, 64], [64, 64], [0, 64]],
        // Clockwise around each room, so that its sector is on the right hand.
        lines: vec![wall(1, 0, 0), wall(0, 5, 0), wall(5, 4, 0), wall(4, 3, 1), wall(3, 2, 1), wall(2, 1, 1), between],
        n_sectors: 2,
        things: Vec::new(),
        reject: None,
        hexen: false,
    }
}

/// Builds and prints the REJECT table of a map.
fn print_reject(what: &str, source: &DoomMapSource) -> Result<(), Box<dyn Error>> {
    let wad = Wad::parse(write_doom_map(LumpName::new("MAP01")?, source)?)?;
    let outcome = reject_wad(&wad, &RejectOptions::default())?;
    for map in &outcome.maps {
        let MapStatus::Written(summary) = map.status else { continue };
        println!("{what}: {} of {} sectors, {} pairs rejected", map.name, map.n_sectors, summary.n_rejected);
    }
    let wad = Wad::parse(outcome.bytes)?;
    for lumps in list_maps(&wad) {
        let map = DoomMap::parse(&wad, &lumps)?;
        let table = RejectTable::from_bytes(map.n_sectors(), map.reject().unwrap_or_default())?;
        for viewer in 0..table.n_sectors() {
            let row: String = (0..table.n_sectors()).map(|t| if table.get(viewer, t) { '1' } else { '0' }).collect();
            println!("  sector {viewer}: {row}");
        }
    }
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    office_table()?;
    let between = SourceLine { v1: 1, v2: 4, flags: ML_TWOSIDED, right: Some(1), left: Some(0) };
    print_reject("a door between two rooms", &two_rooms(between))?;
    print_reject("a wall between them", &two_rooms(SourceLine { flags: 1, ..between }))?;
    Ok(())
}
