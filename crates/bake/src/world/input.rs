//! What a world consists of: its plan, and what is known of each tile before any is baked.

use super::WorldBakeError;
use crate::region::CellsFrom;
use crate::request::{BakeRequest, Runtime};
use crate::tile::{tile_cells, tile_extent, upright_cells};
use sightlines_cells::Scene;
use sightlines_checkpoint::{Key, KeyHasher};
use sightlines_formats::scene::{SceneReadOptions, read_scene_with};
use sightlines_formats::view_cells::read_view_cells;
use sightlines_formats::{SceneInfo, Simplification, ViewCell, ViewCells};
use sightlines_geometry::Aabb;
use sightlines_tiles::{TileBounds, TilePlan, WorldError, WorldPlan};
use std::fs;
use std::path::{Path, PathBuf};

/// A tile, with what is known of it before its cells are cut.
#[derive(Debug)]
pub(super) struct TileInput {
    pub(super) plan: TilePlan,
    pub(super) scene: PathBuf,
    cells: Option<PathBuf>,
    pub(super) bounds: TileBounds,
    /// Of all that it is: what it contains in the world, and where eyes can be.
    pub(super) key: Key,
    /// About how much work its own cells are, seen from itself.
    pub(super) n_triangles: usize,
    /// Axes and units, in words.
    pub(super) axes: String,
}

/// A tile that was read.
#[derive(Debug)]
pub(super) struct Loaded {
    pub(super) scene: Scene,
    pub(super) info: SceneInfo,
    /// As given, moved.
    given: Option<ViewCells>,
    viewers: Aabb<3>,
}

/// The plan of a world.
pub(super) fn plan(path: &Path) -> Result<WorldPlan, WorldBakeError> {
    let text = fs::read(path).map_err(|error| WorldBakeError::file(path, error))?;
    WorldPlan::parse(&text).map_err(|error| WorldBakeError::file(path, error))
}

/// The plan, and all files that it names.
pub(super) fn files(world: &Path, plan: &WorldPlan) -> Vec<PathBuf> {
    let named = plan.tiles.iter().flat_map(|tile| [Some(&tile.scene), tile.cells.as_ref()]).flatten();
    std::iter::once(world.to_owned()).chain(named.map(|name| beside(world, name))).collect()
}

fn beside(world: &Path, name: &str) -> PathBuf {
    world.parent().unwrap_or(Path::new("")).join(name)
}

/// The tile of a plan, `tile` in it; warns of what a user should hear of its file.
pub(super) fn look(
    world: &Path,
    (tile, plan): (usize, &TilePlan),
    reading: &SceneReadOptions,
    warn: fn(&str),
) -> Result<TileInput, WorldBakeError> {
    let (scene, cells) = (beside(world, &plan.scene), plan.cells.as_deref().map(|name| beside(world, name)));
    let loaded = load(&scene, cells.as_deref(), plan, reading, warn)?;
    let extent = tile_extent(&loaded.scene, &[ViewCell { id: String::new(), bounds: loaded.viewers }]);
    if (0..3).any(|k| loaded.viewers.min[k] >= loaded.viewers.max[k]) {
        let what =
            format!("{}: there is no room for viewers in the box of the scene; name \"viewers\"", scene.display());
        return Err(WorldBakeError::file(world, WorldError::Tile { tile, what }));
    }
    let bounds = TileBounds { viewers: loaded.viewers, extent };
    let axes = format!("{:?}, {:?}", loaded.info.up, loaded.info.unit);
    let (key, n_triangles) = (loaded.key(), loaded.scene.n_triangles());
    Ok(TileInput { plan: plan.clone(), scene, cells, bounds, key, n_triangles, axes })
}

impl TileInput {
    /// Reads it again. Refuses what has changed meanwhile.
    pub(super) fn load(&self, reading: &SceneReadOptions) -> Result<Loaded, WorldBakeError> {
        let loaded = load(&self.scene, self.cells.as_deref(), &self.plan, reading, |_| {})?;
        if loaded.key() == self.key { Ok(loaded) } else { Err(WorldBakeError::Changed(self.scene.clone())) }
    }

    /// Its cells: those that its plan gives, or cut as the request says.
    pub(super) fn cut(
        &self,
        loaded: &Loaded,
        request: &BakeRequest,
        runtime: &Runtime<'_>,
    ) -> Result<Vec<ViewCell>, WorldBakeError> {
        let cells = loaded.given.clone().map(CellsFrom::Boxes).or_else(|| request.cells.clone());
        let request = BakeRequest { cells, ..request.clone() };
        let cells = tile_cells(&loaded.scene, &loaded.viewers, &request, runtime);
        let cells = cells.map_err(|source| WorldBakeError::scene(&self.scene, source))?;
        if cells.is_empty() {
            let tile = &self.plan.name;
            let why =
                format!("the tile {tile:?} has no cells: no eye can be in it; leave it out, or give it \"viewers\"");
            return Err(WorldBakeError::file(&self.scene, why));
        }
        Ok(cells)
    }
}

impl Loaded {
    fn key(&self) -> Key {
        let mut hasher = KeyHasher::new("");
        hasher.debug("scene", &(self.scene.checksum(), &self.info));
        hasher.debug("viewers", &(&self.given, self.viewers));
        hasher.finish()
    }
}

fn load(
    path: &Path,
    cells: Option<&Path>,
    plan: &TilePlan,
    reading: &SceneReadOptions,
    warn: fn(&str),
) -> Result<Loaded, WorldBakeError> {
    let file = read_scene_with(path, reading)?;
    if matches!(file.info.simplified, Some(Simplification { occluder: false })) {
        return Err(WorldBakeError::Occluder(path.to_owned()));
    }
    file.info.warnings.iter().for_each(|warning| warn(&format!("{}: {warning}", path.display())));
    let moved = file.scene.translated(plan.at);
    let scene =
        moved.map_err(|error| WorldBakeError::file(path, format!("moved to its place in the world: {error}")))?;
    let info = file.info;
    let given = cells.map(read_view_cells).transpose()?.map(|given| moved_cells(given, plan.at));
    let of_cells = |given: &ViewCells| {
        let boxes = upright_cells(given);
        Aabb::around(boxes.iter().flat_map(|cell| [cell.bounds.min, cell.bounds.max]))
    };
    let viewers = given.as_ref().map(of_cells).or(plan.viewers).unwrap_or_else(|| {
        let stated = info.view_region().map(|b| moved_box(b, plan.at));
        stated.unwrap_or_else(|| scene.bounds())
    });
    Ok(Loaded { scene, info, given, viewers })
}

fn moved_box(b: Aabb<3>, by: [f64; 3]) -> Aabb<3> {
    let moved = |p: [f64; 3]| std::array::from_fn(|k| p[k] + by[k]);
    Aabb { min: moved(b.min), max: moved(b.max) }
}

/// View cells, moved. With axes of their own they are widened by the rounding, as boxes of the world.
fn moved_cells(given: ViewCells, by: [f64; 3]) -> ViewCells {
    if by == [0.0; 3] {
        return given;
    }
    let boxes = upright_cells(&given);
    let cells = boxes.into_iter().map(|cell| ViewCell { bounds: moved_box(cell.bounds, by), id: cell.id });
    ViewCells { cells: cells.collect(), axes: None }
}
