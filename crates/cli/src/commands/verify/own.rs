//! The visibility that a map has of its own, which engines load: read, and summed up.

use crate::error::{ErrorAbout, Result, anyhow, bail};
use crate::input;
use crate::map_portals::{do_not_fit, portals_for};
use crate::output::has_ending;
use sightlines::bake::BakeError;
use sightlines::formats::InputKind;
use sightlines::formats::doom::Game;
use sightlines::formats::quake::vis_patch::parse_vis_patches;
use sightlines::formats::quake::{Bsp, Prt, read_bsp, read_prt};
use sightlines::triangulation::subdivide;
use sightlines::verify::{OwnError, OwnVisibility};
use std::fs;
use std::path::{Path, PathBuf};

/// The own visibility of a map, if `path` is one; `scene` is what it will be checked against.
///
/// # Errors
/// For a map without visibility of its own, for files that cannot be read, and for those that do not go together.
pub(super) fn read(path: &Path, scene: &Path, map: Option<&str>, prt: Option<&Path>) -> Result<Option<OwnVisibility>> {
    if has_ending(path, "vis") && path.is_file() {
        return of_bsp(path, &patched(path, scene)?, scene, prt).map(Some);
    }
    match input::kind_of(path)? {
        Some(InputKind::Bsp) => of_bsp(path, &read_bsp(path)?, scene, prt).map(Some),
        Some(InputKind::Wad) => of_wad(path, scene, map).map(Some),
        _ => Ok(None),
    }
}

/// Reads the lump of a Quake map; the portal file of the scene lists the cluster of each leaf.
fn of_bsp(path: &Path, bsp: &Bsp, scene: &Path, prt: Option<&Path>) -> Result<OwnVisibility> {
    let (named, portals) = portals_of(path, scene, prt)?;
    OwnVisibility::of_bsp(bsp, &portals).map_err(|error| match error {
        OwnError::OtherMap(source) => do_not_fit(&named, path, &source),
        error => refused(path, None, error),
    })
}

/// The map of the scene with the visibility that a VisPatch file has for it.
fn patched(path: &Path, scene: &Path) -> Result<Bsp> {
    if input::kind_of(scene)? != Some(InputKind::Bsp) {
        bail!("{}: is visibility without its map, and {} is no Quake map", path.display(), scene.display());
    }
    let bsp = read_bsp(scene)?;
    let patches = parse_vis_patches(&fs::read(path).in_file(path)?).in_file(path)?;
    let name = scene.file_name().unwrap_or_default().to_string_lossy();
    let Some(patch) = patches.iter().find(|patch| patch.map.eq_ignore_ascii_case(&name)) else {
        let names: Vec<&str> = patches.iter().map(|patch| patch.map.as_str()).collect();
        bail!("{}: there is no visibility for {name} in it, but for {}", path.display(), names.join(", "));
    };
    patch.put_into(&bsp).and_then(Bsp::parse).in_file(path)
}

/// A table is wrong if it hides what every engine shows, and those of Doom show the least.
pub(super) const JUDGED_FOR: Option<Game> = Some(Game::Doom);

/// Reads the lump of a Doom map, for the cells that the lines of the scene make.
fn of_wad(path: &Path, scene: &Path, name: Option<&str>) -> Result<OwnVisibility> {
    if input::kind_of(scene)? != Some(InputKind::Wad) {
        bail!(
            "{}: is a map, whose own visibility is checked against a WAD with the map; {} is none",
            path.display(),
            scene.display()
        );
    }
    let [map, real] = [input::doom(path, name)?, input::doom(scene, name)?];
    if map.n_sectors() != real.n_sectors() {
        let n_sectors = [map.n_sectors(), real.n_sectors()];
        bail!(
            "{}: is no map of {}: it has {} sectors, not {}",
            path.display(),
            scene.display(),
            n_sectors[0],
            n_sectors[1]
        );
    }
    let failed = |source: BakeError| anyhow!("{}: map {}: {source}", scene.display(), real.name());
    // A map without a lump is refused before it is cut.
    OwnVisibility::check_reject(&map).map_err(|error| refused(path, Some(map.name().to_string()), error))?;
    let plan = real.plan_for(JUDGED_FOR).map_err(|error| failed(error.into()))?;
    let (graph, _) = subdivide(&plan).map_err(|error| failed(error.into()))?;
    OwnVisibility::of_reject(&map, &graph).map_err(|error| refused(path, Some(map.name().to_string()), error))
}

/// Names the file and the map.
fn refused(path: &Path, map: Option<String>, error: OwnError) -> anyhow::Error {
    let file = path.display();
    match (error, map) {
        (OwnError::Visibility(source) | OwnError::OtherMap(source), _) => anyhow!("{file}: {source}"),
        (OwnError::Length(source), Some(map)) => anyhow!("{file}: map {map}: {source}"),
        (_, Some(map)) => {
            anyhow!("{file}: map {map}: there is no REJECT lump to check, or an empty one; sightlines reject writes it")
        }
        (_, None) => {
            anyhow!("{file}: there is no visibility lump to check, or an empty one; sightlines vis writes it")
        }
    }
}

/// The portals of the scene, which may be a portal file itself, with the file that has them.
fn portals_of(path: &Path, scene: &Path, prt: Option<&Path>) -> Result<(PathBuf, Prt)> {
    match (input::kind_of(scene)?, prt) {
        (Some(InputKind::Prt), _) => Ok((scene.to_owned(), read_prt(scene)?)),
        (Some(InputKind::Bsp), prt) => {
            let portals = portals_for(&read_bsp(scene)?, scene, prt)?;
            Ok((portals.path, portals.prt))
        }
        _ => Err(anyhow!(
            "{}: is a map, whose own visibility is checked against a Quake map or its portal file; {} is none",
            path.display(),
            scene.display()
        )),
    }
}
