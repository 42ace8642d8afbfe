//! The REJECT lump of a Doom map.

use super::{About, Own, Side, hidden_pairs};
use crate::commands::verify::Error;
use crate::input;
use sightlines::bake::{BakeError, TableOptions, table_of};
use sightlines::formats::InputKind;
use sightlines::formats::{DoomMap, RejectTable};
use sightlines::pvs::{BitMatrix, TableKind};
use sightlines::triangulation::subdivide;
use std::path::Path;

/// Reads the lump of a map. Its sectors are cut into cells along the lines of the scene, so that rays have places to begin at.
///
/// Where lines disagree about the sector of a cell, it is hidden only if it is whichever of them is meant.
pub(super) fn read(path: &Path, scene: &Path, name: Option<&str>) -> Result<Own, Error> {
    if input::kind_of(scene)? != Some(InputKind::Wad) {
        let (path, scene) = (path.to_owned(), scene.to_owned());
        return Err(Error::OwnScene { path, scene, needed: "a WAD with the map" });
    }
    let [map, real] = [input::doom(path, name)?, input::doom(scene, name)?];
    let name = || Some(map.name().to_string());
    if map.n_sectors() != real.n_sectors() {
        let n_sectors = [map.n_sectors(), real.n_sectors()];
        return Err(Error::OwnSectors { path: path.to_owned(), scene: scene.to_owned(), n_sectors });
    }
    let (reject, n_bytes) = reject_of(path, &map)?;
    let failed = |source: BakeError| Error::Bake { path: scene.to_owned(), map: Some(real.name().to_string()), source };
    let plan = real.plan().map_err(|error| failed(error.into()))?;
    let (graph, _) = subdivide(&plan).map_err(|error| failed(error.into()))?;
    let groups: Vec<&[u32]> = graph.cells().iter().map(|cell| cell.groups.as_slice()).collect();

    let n = map.n_sectors();
    let mut hidden = BitMatrix::new(n as usize, n as usize);
    let mut seen = BitMatrix::new(n as usize, n as usize);
    for a in 0..n {
        for b in 0..n {
            hidden.set(a as usize, b as usize, reject.get(a, b));
            seen.set(a as usize, b as usize, !reject.get(a, b) && !reject.get(b, a));
        }
    }
    let sees = |x: &[u32], y: &[u32]| {
        let is_seen = |a: &u32| y.iter().any(|&b| seen.get(*a as usize, b as usize));
        x.is_empty() || y.is_empty() || x.iter().any(is_seen)
    };
    let mut rows = BitMatrix::identity(groups.len());
    for (x, of_x) in groups.iter().enumerate() {
        for (y, of_y) in groups.iter().enumerate().filter(|&(y, _)| y != x) {
            rows.set(x, y, sees(of_x, of_y));
        }
    }
    let mut has_places = vec![false; n as usize];
    groups.iter().filter(|list| list.len() == 1).for_each(|list| has_places[list[0] as usize] = true);
    let [n_hidden_pairs, n_hidden_one_way] = hidden_pairs(&hidden);
    let about = About {
        lump: "REJECT",
        n_bytes,
        n_leafs: None,
        sides: "sector",
        n_sides: n as usize,
        n_hidden_pairs,
        n_hidden_one_way,
        n_uneven_clusters: 0,
    };
    let side_of = groups.iter().map(|list| list.first().copied()).collect();
    let table = table_of(&graph, rows, TableOptions::new(TableKind::PlanTriangulation));
    let table = table.map_err(|source| Error::Bake { path: path.to_owned(), map: name(), source: source.into() })?;
    let side = |(k, has_places)| Side { name: format!("sector {k}"), has_places };
    Ok(Own { table, about, side_of, sides: has_places.into_iter().enumerate().map(side).collect(), hidden })
}

/// The table that an engine reads from the lump, and the bytes of the lump; those past the end of the table do not count.
fn reject_of(path: &Path, map: &DoomMap) -> Result<(RejectTable, usize), Error> {
    let name = map.name().to_string();
    let lump = map.reject().filter(|lump| !lump.is_empty()).ok_or_else(|| Error::NoOwn {
        path: path.to_owned(),
        map: Some(name.clone()),
        what: "REJECT lump",
        command: "sightlines reject",
    })?;
    let needed = usize::try_from(RejectTable::byte_len(map.n_sectors())).unwrap_or(usize::MAX);
    let table = RejectTable::from_bytes(map.n_sectors(), lump.get(..needed).unwrap_or(lump));
    let table = table.map_err(|source| Error::OwnLength { path: path.to_owned(), map: name, source })?;
    Ok((table, lump.len()))
}
