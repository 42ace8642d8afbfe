//! Files to read, told apart by their content.

use crate::error::{InputError, SOME_WAD};
use sightlines::bake::graph_of;
use sightlines::cells::{CellGraph, Plan, Planar};
use sightlines::formats::doom::{DoomMap, MapLumps, list_maps};
use sightlines::formats::quake::prt::PrtDialect;
use sightlines::formats::quake::{Bsp, BspFormat, Prt, read_bsp, read_prt};
use sightlines::formats::scene::{Simplified, read_scene};
use sightlines::formats::{ReadError, SceneFile, Wad, geojson};
use sightlines::packed;
use sightlines::pvs::{Table, format};
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// What a file is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    Wad,
    Table,
    /// A packed table.
    Packed,
    Json,
    /// A scene in space: GLB, glTF or OBJ.
    Scene,
    /// The portals of a Quake map.
    Prt,
    /// A map of Quake or Quake II.
    Bsp,
}

/// Tells what a file is by its first bytes; if they say nothing, by the end of its name.
pub(crate) fn kind_of(path: &Path) -> Result<Option<Kind>, InputError> {
    let open = |source| InputError::Open { path: path.to_owned(), source };
    let mut start = Vec::new();
    File::open(path).and_then(|file| file.take(64).read_to_end(&mut start)).map_err(open)?;
    let name = path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase);
    Ok(match (kind_of_bytes(&start), name.as_deref()) {
        // Both are JSON, and what is no glTF should not be told that it is no plan.
        (Some(Kind::Json) | None, Some("gltf" | "glb" | "obj")) => Some(Kind::Scene),
        (None, Some("wad")) => Some(Kind::Wad),
        (None, Some("pvs")) => Some(Kind::Table),
        (None, Some("pvz")) => Some(Kind::Packed),
        (None, Some("json" | "geojson")) => Some(Kind::Json),
        (None, Some("prt")) => Some(Kind::Prt),
        (None, Some("bsp")) => Some(Kind::Bsp),
        (kind, _) => kind,
    })
}

fn kind_of_bytes(start: &[u8]) -> Option<Kind> {
    let text = start.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(start).trim_ascii_start();
    if start.starts_with(b"IWAD") || start.starts_with(b"PWAD") {
        Some(Kind::Wad)
    } else if start.starts_with(&format::MAGIC) {
        Some(Kind::Table)
    } else if start.starts_with(&packed::format::MAGIC) {
        Some(Kind::Packed)
    } else if start.starts_with(b"glTF") {
        Some(Kind::Scene)
    } else if PrtDialect::ALL.iter().any(|dialect| start.starts_with(dialect.magic().as_bytes())) {
        Some(Kind::Prt)
    } else if BspFormat::ALL.iter().any(|format| start.starts_with(format.magic())) {
        Some(Kind::Bsp)
    } else if text.starts_with(b"{") {
        Some(Kind::Json)
    } else {
        None
    }
}

/// Reads a table.
pub(crate) fn table(path: &Path) -> Result<Table, InputError> {
    let open = |source| InputError::Open { path: path.to_owned(), source };
    let mut bytes = Vec::new();
    let mut file = File::open(path).map_err(open)?;
    // What is no table is refused before the rest of a large file is read.
    file.by_ref().take(format::MAGIC.len() as u64).read_to_end(&mut bytes).map_err(open)?;
    if bytes == packed::format::MAGIC {
        return Err(InputError::IsPacked { path: path.to_owned() });
    }
    if bytes == format::MAGIC {
        file.read_to_end(&mut bytes).map_err(open)?;
    } else {
        refuse_source(path)?;
    }
    Table::from_bytes(&bytes).map_err(|source| InputError::Table { path: path.to_owned(), source })
}

/// Refuses what tables are built from, where a table is needed.
pub(crate) fn refuse_source(path: &Path) -> Result<(), InputError> {
    let found = match kind_of(path)? {
        None | Some(Kind::Table | Kind::Packed) => return Ok(()),
        Some(Kind::Wad) => SOME_WAD,
        Some(Kind::Json) => "JSON, such as a floor plan",
        Some(Kind::Scene) => "a scene",
        Some(Kind::Prt) => "a portal file",
        Some(Kind::Bsp) => "a Quake map",
    };
    Err(InputError::NotTable { path: path.to_owned(), found })
}

/// Whether a table is of a portal file, with its map or without: its cells are joined by convex portals, and nobody knows
/// their volumes.
pub(crate) fn is_of_portals(table: &Table) -> bool {
    table.kind().is_quake()
}

/// Refuses a table that does not know where its cells are; `what` says what cannot be done for that.
pub(crate) fn refuse_without_places(table: &Table, path: &Path, what: &'static str) -> Result<(), InputError> {
    if !table.has_places() { Err(InputError::NoPlaces { path: path.to_owned(), what }) } else { Ok(()) }
}

/// The cell graph that a table holds.
pub(crate) fn graph(table: &Table, path: &Path) -> Result<CellGraph<Planar>, InputError> {
    graph_of(table).ok_or_else(|| InputError::Stripped(path.to_owned()))
}

/// What is to be built.
#[derive(Debug)]
pub(crate) enum Input {
    /// A scene in the plane.
    Plan(PlanFile),
    /// A scene in space.
    Scene(SceneFile),
    /// The clusters of a Quake map, without the map.
    Portals(Prt),
    /// A Quake map, without its portals.
    Map(Bsp),
}

/// A plan, and the map that it is of.
#[derive(Debug)]
pub(crate) struct PlanFile {
    pub(crate) plan: Plan,
    pub(crate) map: Option<String>,
}

/// What `build` takes, as errors say it.
const BUILDABLE: &str = "a WAD nor a GeoJSON plan nor a GLB, glTF or OBJ nor a Quake map or portal file";

/// Reads what is to be built: a map of a WAD, a GeoJSON file, a scene in space, a portal file, or a Quake map.
pub(crate) fn read(path: &Path, map: Option<&str>) -> Result<Input, InputError> {
    match (kind_of(path)?, map) {
        (Some(Kind::Wad), map) => Ok(Input::Plan(plan_of_map(path, map)?)),
        (Some(Kind::Json | Kind::Scene | Kind::Prt | Kind::Bsp), Some(_)) => {
            Err(InputError::MapOfPlan(path.to_owned()))
        }
        (Some(Kind::Json), None) => Ok(Input::Plan(plan(path)?)),
        (Some(Kind::Scene), None) => Ok(Input::Scene(occluders(path)?)),
        (Some(Kind::Prt), None) => Ok(Input::Portals(read_prt(path)?)),
        (Some(Kind::Bsp), None) => Ok(Input::Map(read_bsp(path)?)),
        (Some(Kind::Table | Kind::Packed) | None, _) => {
            Err(InputError::Kind { path: path.to_owned(), expected: BUILDABLE })
        }
    }
}

/// Refuses a file that is no scene in space.
pub(crate) fn check_is_scene(path: &Path) -> Result<(), InputError> {
    match kind_of(path)? {
        Some(Kind::Scene) => Ok(()),
        _ => Err(InputError::Kind { path: path.to_owned(), expected: "a GLB nor a glTF nor an OBJ scene" }),
    }
}

/// Reads a scene that is to hide something, and refuses one that might hide what can be seen.
pub(crate) fn occluders(path: &Path) -> Result<SceneFile, InputError> {
    let file = read_scene(path)?;
    check_occluder(path, &file)?;
    Ok(file)
}

/// Refuses a scene whose triangles were moved by simplification.
pub(crate) fn check_occluder(path: &Path, file: &SceneFile) -> Result<(), InputError> {
    match file.info.simplified {
        Some(Simplified { occluder: false }) => Err(InputError::NoOccluder(path.to_owned())),
        _ => Ok(()),
    }
}

/// Reads a plan in a GeoJSON file.
pub(crate) fn plan(path: &Path) -> Result<PlanFile, InputError> {
    Ok(PlanFile { plan: geojson::read_plan(path)?, map: None })
}

/// Reads a map of a WAD; its only one, if none is named.
pub(crate) fn doom(path: &Path, name: Option<&str>) -> Result<DoomMap, InputError> {
    let wad = Wad::read(path)?;
    let maps = list_maps(&wad);
    let lumps = choose(path, &maps, name)?;
    Ok(DoomMap::parse(&wad, lumps).map_err(|error| ReadError::new(path, error))?)
}

fn plan_of_map(path: &Path, name: Option<&str>) -> Result<PlanFile, InputError> {
    let map = doom(path, name)?;
    let name = map.name().to_string();
    let bake = |error: sightlines::cells::PlanError| InputError::Plan {
        path: path.to_owned(),
        map: Some(name.clone()),
        source: error,
    };
    Ok(PlanFile { plan: map.plan().map_err(bake)?, map: Some(name) })
}

/// The map of that name, which is the last one if there are several, as in the engine; or the only one.
fn choose<'m>(path: &Path, maps: &'m [MapLumps], name: Option<&str>) -> Result<&'m MapLumps, InputError> {
    let path = || path.to_owned();
    let names = || maps.iter().map(|map| map.name().to_string()).collect();
    match (maps, name) {
        ([], _) => Err(InputError::NoMaps(path())),
        (_, Some(name)) => maps.iter().rfind(|map| map.name().is(name)).ok_or_else(|| InputError::NoSuchMap {
            path: path(),
            name: name.to_owned(),
            names: names(),
        }),
        ([map], None) => Ok(map),
        (_, None) => Err(InputError::WhichMap { path: path(), names: names() }),
    }
}

/// Refuses the first option that was given though it is meant for something else.
pub(crate) fn refuse(
    path: &Path,
    given: &[(&'static str, bool)],
    meant: &'static str,
    found: &'static str,
) -> Result<(), InputError> {
    match given.iter().find(|(_, is_given)| *is_given) {
        Some((option, _)) => Err(InputError::Option { path: path.to_owned(), option, meant, found }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_told_apart_by_their_content() {
        assert_eq!(kind_of_bytes(b"PWAD\x01\0\0\0"), Some(Kind::Wad));
        assert_eq!(kind_of_bytes(b"\x89PVS\r\n\x1a\n\x01"), Some(Kind::Table));
        assert_eq!(kind_of_bytes(b"\xEF\xBB\xBF \n{\"type\""), Some(Kind::Json));
        assert_eq!(kind_of_bytes(b"glTF\x02\0\0\0"), Some(Kind::Scene));
        assert_eq!(kind_of_bytes(b"PWA"), None);
        assert_eq!(kind_of_bytes(b""), None);
    }
}
