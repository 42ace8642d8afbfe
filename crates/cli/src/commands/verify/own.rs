//! The visibility that a map has of its own, which engines load: read, and summed up.

use crate::error::{Result, anyhow, bail};
use crate::input;
use crate::map_portals::{do_not_fit, portals_for};
use crate::output::{JsonSchema, Serialize, bytes, count};
use sightlines::bake::BakeError;
use sightlines::formats::InputKind;
use sightlines::formats::doom::Game;
use sightlines::formats::quake::{Prt, read_bsp, read_prt};
use sightlines::triangulation::subdivide;
use sightlines::verify::{OwnError, OwnSummary, OwnVisibility};
use std::fmt;
use std::path::{Path, PathBuf};

/// What was looked at.
#[derive(Debug, Clone, Serialize, JsonSchema)]
pub(super) struct About {
    /// Name of the lump.
    lump: &'static str,
    /// Size of the lump.
    n_bytes: usize,
    /// Leafs of a Quake map.
    #[serde(skip_serializing_if = "Option::is_none")]
    n_leafs: Option<usize>,
    /// What is hidden from each other: clusters of leafs, or sectors.
    sides: &'static str,
    /// How many clusters or sectors there are.
    n_sides: usize,
    /// Unordered pairs of sides of which at least one is hidden from the other.
    n_hidden_pairs: u64,
    /// Of the hidden pairs, those of which only one is hidden from the other.
    n_hidden_one_way: u64,
    /// Clusters whose leafs have different rows; what is visible from one leaf counts for all.
    n_uneven_clusters: usize,
}

impl From<&OwnSummary> for About {
    fn from(summary: &OwnSummary) -> Self {
        let OwnSummary { lump, n_bytes, n_leafs, sides, n_sides, .. } = *summary;
        Self {
            lump: lump.name(),
            n_bytes,
            n_leafs,
            sides,
            n_sides,
            n_hidden_pairs: summary.n_hidden_pairs,
            n_hidden_one_way: summary.n_hidden_one_way,
            n_uneven_clusters: summary.n_uneven_clusters,
        }
    }
}

impl fmt::Display for About {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let sides = count(self.n_sides as u64, self.sides);
        let sides = self.n_leafs.map_or(sides.clone(), |n| format!("{} in {sides}", count(n as u64, "leaf")));
        writeln!(f, "lump           {} of the map, {}, for {sides}", self.lump, bytes(self.n_bytes as u64))?;
        writeln!(f, "               {} hidden", count(self.n_hidden_pairs, "pair"))?;
        if self.n_hidden_one_way > 0 {
            writeln!(f, "remark         {} hidden one way only", count(self.n_hidden_one_way, "pair"))?;
        }
        if self.n_uneven_clusters > 0 {
            let n = count(self.n_uneven_clusters as u64, "cluster");
            writeln!(
                f,
                "remark         {n} with leafs that do not see the same: what one of them sees counts for all"
            )?;
        }
        Ok(())
    }
}

/// The own visibility of a map, if `path` is one; `scene` is what it will be checked against.
///
/// # Errors
/// For a map without visibility of its own, for files that cannot be read, and for those that do not go together.
pub(super) fn read(path: &Path, scene: &Path, map: Option<&str>, prt: Option<&Path>) -> Result<Option<OwnVisibility>> {
    match input::kind_of(path)? {
        Some(InputKind::Bsp) => of_bsp(path, scene, prt).map(Some),
        Some(InputKind::Wad) => of_wad(path, scene, map).map(Some),
        _ => Ok(None),
    }
}

/// Reads the lump of a Quake map; the portal file of the scene lists the cluster of each leaf.
fn of_bsp(path: &Path, scene: &Path, prt: Option<&Path>) -> Result<OwnVisibility> {
    let bsp = read_bsp(path)?;
    let (named, portals) = portals_of(path, scene, prt)?;
    OwnVisibility::of_bsp(&bsp, &portals).map_err(|error| match error {
        OwnError::OtherMap(source) => do_not_fit(&named, path, &source),
        error => refused(path, None, error),
    })
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
