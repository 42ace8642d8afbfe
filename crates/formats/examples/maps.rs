//! Lists the maps of a WAD: lines, sectors, and what their REJECT lumps say. Without a file it makes a
//! small one first.

use sightlines_formats::doom::{DoomMap, DoomMapSource, ML_TWOSIDED, SourceLine, list_maps, write_doom_map};
use sightlines_formats::{LumpName, RejectTable, Wad};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let wad = match std::env::args_os().nth(1) {
        Some(path) => Wad::read(path)?,
        None => Wad::parse(write_doom_map(LumpName::new("MAP01")?, &two_triangles())?)?,
    };
    for lumps in list_maps(&wad) {
        let map = DoomMap::parse(&wad, &lumps)?;
        let table = map.reject().map(|bytes| RejectTable::from_bytes(map.n_sectors(), bytes));
        let table = match table {
            Some(Ok(table)) => format!("{} pairs rejected", table.n_rejected()),
            Some(Err(error)) => error.to_string(),
            None => "no REJECT".to_owned(),
        };
        println!("{}: {} lines, {} sectors, {table}", map.name(), map.lines().len(), map.n_sectors());
    }
    Ok(())
}

/// Two triangular sectors with an open line between them.
fn two_triangles() -> DoomMapSource {
    let wall = |v1, v2, sector| SourceLine { v1, v2, flags: 0, right: Some(sector), left: None };
    let open = SourceLine { v1: 0, v2: 1, flags: ML_TWOSIDED, right: Some(0), left: Some(1) };
    DoomMapSource {
        vertices: vec![[0, 0], [0, 64], [64, 32], [-64, 32]],
        lines: vec![open, wall(1, 2, 0), wall(2, 0, 0), wall(0, 3, 1), wall(3, 1, 1)],
        n_sectors: 2,
        things: Vec::new(),
        reject: Some(RejectTable::new(2).into_bytes()),
        hexen: false,
    }
}
