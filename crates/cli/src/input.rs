//! Inputs by name. Which format a file has is decided in [`sightlines::formats::input`]; here it is what a command can use, or an error.

use crate::error::InputError;
use sightlines::bake::from_table::planar_graph;
use sightlines::cells::{CellGraph, Plan, Planar};
use sightlines::formats::doom::{DoomMap, MapChoiceError, choose_map, list_maps};
use sightlines::formats::quake::{Bsp, Prt};
use sightlines::formats::scene::{Simplified, read_scene};
use sightlines::formats::{Input as FileInput, InputKind, ReadError, SceneFile, Source, Wad, detect_file, geojson};
use sightlines::packed;
use sightlines::pvs::{Table, format};
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// What a file holds, as [`formats::input`](sightlines::formats::input) recognises it; `None` if no format does.
pub(crate) fn kind_of(path: &Path) -> Result<Option<InputKind>, InputError> {
    Ok(detect_file(path)?.map(|format| format.kind))
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
    let found = match detect_file(path)? {
        Some(format) if is_source(format.kind) => format.noun,
        _ => return Ok(()),
    };
    Err(InputError::NotTable { path: path.to_owned(), found })
}

/// Whether a table can be built from such a file.
const fn is_source(kind: InputKind) -> bool {
    matches!(kind, InputKind::Wad | InputKind::Plan | InputKind::Scene | InputKind::Prt | InputKind::Bsp)
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
    planar_graph(table).ok_or_else(|| InputError::Stripped(path.to_owned()))
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
    let format = detect_file(path)?.filter(|format| is_source(format.kind));
    let format = format.ok_or_else(|| InputError::Kind { path: path.to_owned(), expected: BUILDABLE })?;
    if map.is_some() && format.kind != InputKind::Wad {
        return Err(InputError::MapOfPlan(path.to_owned()));
    }
    match Source::File(path).read_as(format)? {
        FileInput::Wad(wad) => Ok(Input::Plan(plan_of_map(path, &wad, map)?)),
        FileInput::Plan(plan) => Ok(Input::Plan(PlanFile { plan, map: None })),
        FileInput::Scene(file) => {
            check_occluder(path, &file)?;
            Ok(Input::Scene(file))
        }
        FileInput::Prt(prt) => Ok(Input::Portals(prt)),
        FileInput::Bsp(bsp) => Ok(Input::Map(bsp)),
        _ => Err(InputError::Kind { path: path.to_owned(), expected: BUILDABLE }),
    }
}

/// Refuses a file that is no scene in space.
pub(crate) fn check_is_scene(path: &Path) -> Result<(), InputError> {
    match kind_of(path)? {
        Some(InputKind::Scene) => Ok(()),
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
    map_of(path, &Wad::read(path)?, name)
}

fn plan_of_map(path: &Path, wad: &Wad, name: Option<&str>) -> Result<PlanFile, InputError> {
    let map = map_of(path, wad, name)?;
    let name = map.name().to_string();
    let plan =
        map.plan().map_err(|source| InputError::Plan { path: path.to_owned(), map: Some(name.clone()), source })?;
    Ok(PlanFile { plan, map: Some(name) })
}

/// The map that is meant, with what there is to choose from if none is.
fn map_of(path: &Path, wad: &Wad, name: Option<&str>) -> Result<DoomMap, InputError> {
    let maps = list_maps(wad);
    let names = || maps.iter().map(|map| map.name().to_string()).collect();
    let lumps = choose_map(&maps, name).map_err(|error| match error {
        MapChoiceError::NoMaps => InputError::NoMaps(path.to_owned()),
        MapChoiceError::Which { .. } => InputError::WhichMap { path: path.to_owned(), names: names() },
        _ => InputError::NoSuchMap { path: path.to_owned(), name: name.unwrap_or_default().to_owned(), names: names() },
    })?;
    Ok(DoomMap::parse(wad, lumps).map_err(|error| ReadError::new(path, error))?)
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
