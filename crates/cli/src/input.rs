//! Inputs by name. [`sightlines::formats::input`] decides which format a file has; this module returns what a command can use, or an
//! error.

pub(crate) use crate::refuse::refuse;

use crate::error::{ErrorAbout, Result, anyhow, bail};
use crate::map_portals::cannot_be_made;
use crate::{foreign, plans, surfaces};
use sightlines::bake::{Bakeable, BakeableError};
use sightlines::formats::doom::{DoomMap, MapChoiceError, choose_map, list_maps};
use sightlines::formats::input::{Format, HEAD, Sign, titles};
use sightlines::formats::quake::Prt;
use sightlines::formats::scene::{SceneReadOptions, Simplification, read_scene_with};
use sightlines::formats::{Input, InputKind, PlanReadOptions, ReadError, SceneFile, Source, Wad, detect_file};
use sightlines::pvs::Table;
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// What a file holds, as [`formats::input`](sightlines::formats::input) recognises it; `None` if no format does.
pub(crate) fn kind_of(path: &Path) -> Result<Option<InputKind>> {
    Ok(format_of(path)?.map(|format| format.kind))
}

/// The format of a file. What is in another format is none of JSON, as which many texts begin, and a text in UTF-16 is none of any.
fn format_of(path: &Path) -> Result<Option<&'static Format>> {
    let format = detect_file(path)?;
    let is_read = |format: &&Format| match foreign::name_of(path) {
        Some((noun, _)) => noun != foreign::UTF16 && format.sign != Sign::Json,
        None => true,
    };
    Ok(format.filter(is_read))
}

/// Reads a table. Anything else is refused by its first bytes, however large it is.
pub(crate) fn table(path: &Path) -> Result<Table> {
    let kind = kind_of(path)?;
    if kind == Some(InputKind::Packed) {
        bail!(
            "{}: the table is packed; `sightlines unpack` makes it a plain one, which this command takes",
            path.display()
        );
    }
    refuse_source(path)?;
    let limit = if kind == Some(InputKind::Table) { u64::MAX } else { HEAD as u64 };
    let mut bytes = Vec::new();
    File::open(path).and_then(|file| file.take(limit).read_to_end(&mut bytes)).in_file(path)?;
    Table::from_bytes(&bytes).in_file(path)
}

/// Refuses what tables are built from, where a table is needed.
pub(crate) fn refuse_source(path: &Path) -> Result<()> {
    let Some(format) = detect_file(path)?.filter(|format| is_source(format.kind)) else { return Ok(()) };
    let map = if format.kind == InputKind::Wad { " --map NAME" } else { "" };
    let (name, out) = (path.display(), path.with_extension("pvs"));
    bail!("{name}: is {}, not a table: build one first: sightlines build {name}{map} -o {}", format.noun, out.display())
}

/// Whether a table can be built from such a file.
const fn is_source(kind: InputKind) -> bool {
    matches!(kind, InputKind::Wad | InputKind::Plan | InputKind::Scene | InputKind::Prt | InputKind::Bsp)
}

/// Refuses a table that does not store where its cells are; `what` names what cannot be done without.
pub(crate) fn refuse_without_places(table: &Table, path: &Path, what: &str) -> Result<()> {
    if table.has_places() { Ok(()) } else { Err(no_places(path, what)) }
}

/// A table that does not store where its cells are.
pub(crate) fn no_places(path: &Path, what: &str) -> anyhow::Error {
    anyhow!("{}: the table is of a portal file, which does not say where its cells are: {what}", path.display())
}

/// A file of no kind that a command takes; see [`with_formats`].
pub(crate) fn neither(path: &Path, expected: &str) -> anyhow::Error {
    let expected = with_formats(expected);
    match foreign::name_of(path) {
        Some((noun, remedy)) => anyhow!("{}: is {noun}, neither {expected}: {remedy}", path.display()),
        None => anyhow!("{}: neither {expected}", path.display()),
    }
}

/// A text with the names of the formats of plans in place of `{plans}`, and of scenes in space in place of `{scenes}`.
pub(crate) fn with_formats(text: &str) -> String {
    text.replace("{plans}", &titles(InputKind::Plan)).replace("{scenes}", &titles(InputKind::Scene))
}

/// What `build` takes, in the words of errors.
const BUILDABLE: &str = "a WAD nor a {plans} plan nor a {scenes} nor a Quake map or portal file";

/// Reads a file from which a table can be built: a WAD, a plan, a scene in space, a portal file, or a Quake map. `map` is
/// refused for all but WADs.
///
/// * `options`: of scenes in space
/// * `plan`: of plans
pub(crate) fn read(
    path: &Path,
    map: Option<&str>,
    options: &SceneReadOptions,
    plan: &PlanReadOptions,
) -> Result<Input> {
    let format = format_of(path)?.filter(|format| is_source(format.kind));
    let format = format.ok_or_else(|| neither(path, BUILDABLE))?;
    if map.is_some() && format.kind != InputKind::Wad {
        bail!("{}: --map is for WADs, and this is none", path.display());
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
pub(crate) fn bakeable(path: &Path, input: Input, map: Option<&str>, portals: Option<Prt>) -> Result<Bakeable> {
    Bakeable::new(input, map, portals).map_err(|error| match error {
        BakeableError::Read(error) => error.into(),
        BakeableError::Choice(error) => which_map(path, error),
        BakeableError::Doom(error) => ReadError::new(path, error).into(),
        BakeableError::Plan { map, source } => anyhow!("{}: map {map}: {source}", path.display()),
        BakeableError::Moved => no_occluder(path),
        BakeableError::Portals(source) => cannot_be_made(path, &source),
        _ => neither(path, BUILDABLE),
    })
}

/// Refuses a file that is not a scene in space.
pub(crate) fn check_is_scene(path: &Path) -> Result<()> {
    match kind_of(path)? {
        Some(InputKind::Scene) => Ok(()),
        _ => Err(neither(path, "a GLB nor a glTF nor an OBJ scene")),
    }
}

/// Reads a scene whose triangles are used as occluders, and refuses one that might hide what can be seen.
pub(crate) fn occluders(path: &Path, options: &SceneReadOptions) -> Result<SceneFile> {
    let file = scene(path, options)?;
    check_occluder(path, &file)?;
    Ok(file)
}

/// Reads a scene in space, and warns of what a user should hear of it.
pub(crate) fn scene(path: &Path, options: &SceneReadOptions) -> Result<SceneFile> {
    let file = read_scene_with(path, options)?;
    surfaces::warn(path, &file);
    Ok(file)
}

/// Refuses a scene whose triangles were moved by simplification.
pub(crate) fn check_occluder(path: &Path, file: &SceneFile) -> Result<()> {
    match file.info.simplified {
        Some(Simplification { occluder: false }) => Err(no_occluder(path)),
        _ => Ok(()),
    }
}

/// A scene whose triangles were moved, where occluders are needed.
pub(crate) fn no_occluder(path: &Path) -> anyhow::Error {
    anyhow!(
        "{}: the scene was simplified and its triangles were moved, so that it may hide what can be seen: use the original that it was made from",
        path.display()
    )
}

/// Reads a map of a WAD; without a name, its only one.
pub(crate) fn doom(path: &Path, name: Option<&str>) -> Result<DoomMap> {
    let wad = Wad::read(path)?;
    let maps = list_maps(&wad);
    let lumps = choose_map(&maps, name).map_err(|error| which_map(path, error))?;
    Ok(DoomMap::parse(&wad, lumps).map_err(|error| ReadError::new(path, error))?)
}

fn which_map(path: &Path, error: MapChoiceError) -> anyhow::Error {
    let file = path.display();
    match error {
        MapChoiceError::Which { names } => {
            anyhow!("{file}: there are {} maps in the file; choose one with --map: {}", names.len(), list(&names))
        }
        MapChoiceError::NoSuchMap { name, names } => {
            anyhow!("{file}: there is no map {name} in the file; there are {}", list(&names))
        }
        _ => anyhow!("{file}: there are no maps in the file"),
    }
}

fn list(names: &[String]) -> String {
    const MOST: usize = 40;
    let shown = names.iter().take(MOST).map(String::as_str).collect::<Vec<_>>().join(", ");
    if names.len() > MOST { format!("{shown} and {} more", names.len() - MOST) } else { shown }
}

/// Names the map of a file in front of an error, if it has one.
pub(crate) fn of_map(map: Option<&String>) -> String {
    map.map_or(String::new(), |name| format!("map {name}: "))
}
