//! Inputs by name. [`sightlines::formats::input`] decides which format a file has; this module returns what a command can use, or an
//! error.

pub(crate) use crate::refuse::refuse;

use crate::error::InputError;
use crate::{plans, surfaces};
use sightlines::bake::{Bakeable, BakeableError};
use sightlines::formats::doom::{DoomMap, MapChoiceError, choose_map, list_maps};
use sightlines::formats::input::HEAD;
use sightlines::formats::quake::Prt;
use sightlines::formats::scene::{SceneReadOptions, Simplified, read_scene_with};
use sightlines::formats::{Input, InputKind, PlanReadOptions, ReadError, SceneFile, Source, Wad, detect_file};
use sightlines::pvs::Table;
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// What a file holds, as [`formats::input`](sightlines::formats::input) recognises it; `None` if no format does.
pub(crate) fn kind_of(path: &Path) -> Result<Option<InputKind>, InputError> {
    Ok(detect_file(path)?.map(|format| format.kind))
}

/// Reads a table. Anything else is refused by its first bytes, however large it is.
pub(crate) fn table(path: &Path) -> Result<Table, InputError> {
    let kind = kind_of(path)?;
    if kind == Some(InputKind::Packed) {
        return Err(InputError::IsPacked { path: path.to_owned() });
    }
    refuse_source(path)?;
    let limit = if kind == Some(InputKind::Table) { u64::MAX } else { HEAD as u64 };
    let mut bytes = Vec::new();
    let read = File::open(path).and_then(|file| file.take(limit).read_to_end(&mut bytes));
    read.map_err(|source| InputError::Open { path: path.to_owned(), source })?;
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

/// Whether a table is of a portal file, with its map or without: its cells are joined by convex portals, and their volumes are
/// unknown.
pub(crate) fn is_of_portals(table: &Table) -> bool {
    table.kind().is_quake()
}

/// Refuses a table that does not store where its cells are; `what` names what cannot be done without.
pub(crate) fn refuse_without_places(table: &Table, path: &Path, what: &'static str) -> Result<(), InputError> {
    if !table.has_places() { Err(InputError::NoPlaces { path: path.to_owned(), what }) } else { Ok(()) }
}

/// What `build` takes, in the words of errors.
const BUILDABLE: &str = "a WAD nor a GeoJSON or DXF plan nor a GLB, glTF or OBJ nor a Quake map or portal file";

/// Reads a file from which a table can be built: a WAD, a plan as GeoJSON or DXF, a scene in space, a portal file, or a Quake map. `map` is
/// refused for all but WADs.
///
/// * `options`: of scenes in space
/// * `plan`: of plans
pub(crate) fn read(
    path: &Path,
    map: Option<&str>,
    options: &SceneReadOptions,
    plan: &PlanReadOptions,
) -> Result<Input, InputError> {
    let format = detect_file(path)?.filter(|format| is_source(format.kind));
    let format = format.ok_or_else(|| InputError::Kind { path: path.to_owned(), expected: BUILDABLE })?;
    if map.is_some() && format.kind != InputKind::Wad {
        return Err(InputError::MapOfPlan(path.to_owned()));
    }
    if format.kind == InputKind::Scene {
        return Ok(Input::Scene(scene(path, options)?));
    }
    if format.kind == InputKind::Plan {
        return Ok(Input::Plan(plans::read(path, plan)?));
    }
    Ok(Source::File(path).read_as(format)?)
}

/// Makes of a file, and what belongs to it, what can be baked.
pub(crate) fn bakeable(
    path: &Path,
    input: Input,
    map: Option<&str>,
    portals: Option<Prt>,
) -> Result<Bakeable, InputError> {
    Bakeable::new(input, map, portals).map_err(|error| match error {
        BakeableError::Read(error) => error.into(),
        BakeableError::Choice(error) => which_map(path, error),
        BakeableError::Doom(error) => ReadError::new(path, error).into(),
        BakeableError::Plan { map, source } => {
            InputError::Plan { path: path.to_owned(), map: Some(map.to_string()), source }
        }
        BakeableError::Moved => InputError::NoOccluder(path.to_owned()),
        BakeableError::Portals(source) => InputError::MadePortals { path: path.to_owned(), source: Box::new(source) },
        _ => InputError::Kind { path: path.to_owned(), expected: BUILDABLE },
    })
}

/// Refuses a file that is not a scene in space.
pub(crate) fn check_is_scene(path: &Path) -> Result<(), InputError> {
    match kind_of(path)? {
        Some(InputKind::Scene) => Ok(()),
        _ => Err(InputError::Kind { path: path.to_owned(), expected: "a GLB nor a glTF nor an OBJ scene" }),
    }
}

/// Reads a scene whose triangles are used as occluders, and refuses one that might hide what can be seen.
pub(crate) fn occluders(path: &Path, options: &SceneReadOptions) -> Result<SceneFile, InputError> {
    let file = scene(path, options)?;
    check_occluder(path, &file)?;
    Ok(file)
}

/// Reads a scene in space, and warns of what a user should hear of it.
pub(crate) fn scene(path: &Path, options: &SceneReadOptions) -> Result<SceneFile, ReadError> {
    let file = read_scene_with(path, options)?;
    surfaces::warn(path, &file);
    Ok(file)
}

/// Refuses a scene whose triangles were moved by simplification.
pub(crate) fn check_occluder(path: &Path, file: &SceneFile) -> Result<(), InputError> {
    match file.info.simplified {
        Some(Simplified { occluder: false }) => Err(InputError::NoOccluder(path.to_owned())),
        _ => Ok(()),
    }
}

/// Reads a map of a WAD; without a name, its only one.
pub(crate) fn doom(path: &Path, name: Option<&str>) -> Result<DoomMap, InputError> {
    let wad = Wad::read(path)?;
    let maps = list_maps(&wad);
    let lumps = choose_map(&maps, name).map_err(|error| which_map(path, error))?;
    Ok(DoomMap::parse(&wad, lumps).map_err(|error| ReadError::new(path, error))?)
}

/// Names the WAD in which no map was chosen.
fn which_map(path: &Path, error: MapChoiceError) -> InputError {
    let path = path.to_owned();
    match error {
        MapChoiceError::Which { names } => InputError::WhichMap { path, names },
        MapChoiceError::NoSuchMap { name, names } => InputError::NoSuchMap { path, name, names },
        _ => InputError::NoMaps(path),
    }
}
