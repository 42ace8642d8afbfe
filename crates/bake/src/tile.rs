//! One tile of a world that is too large for one table.
//!
//! A world is cut into tiles, each a scene with cells of its own. The table of a tile says what its cells see of it. Beside it stands which cells and
//! objects of tiles nearby they see, and whether they see anything of those farther away. What a tile and those nearby contain hides; what is
//! farther away hides nothing. So a tile depends on those nearby, and on the boxes around the others, and is
//! baked without reading the rest of the world. Far tiles that it does not know of count as visible.

use crate::auto::own_cells;
use crate::error::BakeError;
use crate::graph::TableGraph;
use crate::grid;
use crate::places::{PlaceOptions, PlacesError, observed_places};
use crate::prepared::recipe_of_tile;
use crate::region::{CellsFrom, Decided, Wanted, decide, upright};
use crate::reports::RegionReport;
use crate::request::{BakeRequest, Runtime, refuse_parts};
use crate::run::with_regions;
use crate::scene::extents;
use crate::threads;
use sightlines_cells::{MovingObject, Scene, SceneError, SceneObject};
use sightlines_formats::{SceneInfo, ViewCell, ViewCells};
use sightlines_geometry::Aabb;
use sightlines_kdtree::{SceneOptions, subdivide_scene};
use sightlines_pvs::runs::runs_of;
use sightlines_pvs::{BitMatrix, ObjectId, Table};
use std::ops::Range;

/// A tile nearby.
#[derive(Debug, Clone, Copy)]
pub struct NearTile<'a> {
    /// What it contains.
    pub scene: &'a Scene,
    /// Its cells.
    pub cells: &'a [ViewCell],
}

/// A tile, with what matters of the others.
#[derive(Debug, Clone, Copy)]
pub struct Tile<'a> {
    /// What it contains, in coordinates of the world.
    pub scene: &'a Scene,
    /// Axes and units as the scene's file states them.
    pub file: Option<&'a SceneInfo>,
    /// Its cells; at most 65,536. Ids may be empty; if all are, the table has none.
    pub cells: &'a [ViewCell],
    /// Tiles nearby: they hide, and what is seen of them is told apart.
    pub near: &'a [NearTile<'a>],
    /// Boxes around all others ([`tile_extent`]).
    pub far: &'a [Aabb<3>],
}

/// For each cell what it may see, as runs of columns.
pub type Columns = Vec<Vec<Range<u32>>>;

/// A tile, baked.
#[derive(Debug, Clone, PartialEq)]
pub struct BakedTile {
    /// The table of its cells and objects.
    pub table: Table,
    /// What it may see of tiles nearby: columns are the cells of the first, its objects, the cells of the second, and so on.
    pub near: Columns,
    /// Of which tiles farther away it may see anything: a column each.
    pub far: Columns,
    /// What was done.
    pub report: RegionReport,
}

/// The cells of a tile, cut as the request says in the box where viewers can be: of what it contains alone, so that they are the same whatever
/// lies around it. Cells that are not named are [those that suit the scene](own_cells); given boxes are taken as they are.
///
/// # Errors
/// [`BakeError`]: a box without room, more cells than the limit, an option that means nothing for a scene.
pub fn tile_cells(
    scene: &Scene,
    viewers: &Aabb<3>,
    request: &BakeRequest,
    runtime: &Runtime<'_>,
) -> Result<Vec<ViewCell>, BakeError> {
    request.check(&scene.into())?;
    refuse_parts(request.parts, "a world of tiles")?;
    threads::on(runtime.threads, || cells_here(scene, viewers, request, runtime))
}

/// The same, on the threads that call it.
fn cells_here(
    scene: &Scene,
    viewers: &Aabb<3>,
    request: &BakeRequest,
    runtime: &Runtime<'_>,
) -> Result<Vec<ViewCell>, BakeError> {
    let nameless = |bounds: Aabb<3>| ViewCell { id: String::new(), bounds };
    let cut = SceneOptions { view_region: Some(*viewers), ..request.recipe().cut };
    let cells = request.cells.clone().unwrap_or_else(|| request.of_width(own_cells(scene, true)));
    Ok(match &cells {
        CellsFrom::KdTree => {
            let cut = subdivide_scene(scene, &cut)?;
            // Its cells may reach out of the box.
            let within = |b: &Aabb<3>| Aabb {
                min: std::array::from_fn(|k| b.min[k].max(viewers.min[k])),
                max: std::array::from_fn(|k| b.max[k].min(viewers.max[k])),
            };
            let has_room = |b: &Aabb<3>| (0..3).all(|k| b.min[k] < b.max[k]);
            let cells = cut.graph.cells().iter().map(|cell| within(&cell.bounds));
            cells.filter(has_room).map(nameless).collect()
        }
        CellsFrom::Grid(n) => grid::grid(viewers, *n)?.cells.into_iter().map(|cell| nameless(cell.bounds)).collect(),
        // A tile does not say which way is up.
        CellsFrom::Places(_) | CellsFrom::EyeLevel(_) => {
            let how = match &cells {
                CellsFrom::Places(how) => *how,
                CellsFrom::EyeLevel(how) => how.places(),
                _ => PlaceOptions::default(),
            };
            let found = observed_places(scene, &cut, &how, runtime.progress).map_err(|error| match error {
                PlacesError::Cancelled(cancelled) => cancelled.into(),
                error => BakeError::from(error),
            })?;
            found.cells.into_iter().map(nameless).collect()
        }
        CellsFrom::Boxes(given) => upright(given),
    })
}

/// View cells as boxes along the axes of the scene, around those that stand along others; rounded outwards.
pub fn upright_cells(cells: &ViewCells) -> Vec<ViewCell> {
    upright(cells)
}

/// The box around all that a tile shows, wherever it moves, and around its cells.
pub fn tile_extent(scene: &Scene, cells: &[ViewCell]) -> Aabb<3> {
    let boxes = extents(scene).into_iter().chain(cells.iter().map(|cell| cell.bounds)).filter(|b| !b.is_empty());
    Aabb::around(boxes.flat_map(|b| [b.min, b.max]))
}

/// Bakes a tile. Errs towards visible only, as far as the method does.
///
/// Cells are boxes without portals, whatever they were cut from. [`BakeRequest::cells`] is not used; see [`tile_cells`]. A scene that stands along
/// other axes than its file is not turned.
///
/// Cost: that of its cells in a scene of the tile and those nearby, each asked of its own cells, those nearby, and the boxes of the others.
/// Memory: cells times the columns of what is asked, in bits.
///
/// # Errors
/// [`BakeError`]: cells that are not volumes, and methods that fail.
pub fn bake_tile(tile: &Tile<'_>, request: &BakeRequest, runtime: &Runtime<'_>) -> Result<BakedTile, BakeError> {
    let Decided { graph, mut parts, objects, mut report } = decided(tile, Wanted::All, request, runtime)?;
    debug_assert!(matches!(graph, TableGraph::Boxes(_)), "tiles have boxes as cells");
    let (near, far) = (near_columns(tile, &objects), far_columns(tile, &objects));
    let n_objects = tile.scene.objects().len();
    let mut own = BitMatrix::new(objects.n_rows(), n_objects);
    for row in 0..objects.n_rows() {
        objects.iter_ones(row).take_while(|&object| object < n_objects).for_each(|object| own.set(row, object, true));
    }
    report.n_objects_seen = own.count_ones();
    // The first objects are those of the tile.
    parts.objects.truncate(n_objects);
    parts.object_polygons.truncate(n_objects);
    parts.object_sources = tile.scene.sources().to_vec();
    let is_own = |object: &ObjectId| (object.0 as usize) < n_objects;
    parts.cell_objects.iter_mut().for_each(|list| list.retain(is_own));
    parts.objects_seen = Some(own);
    parts.digest = Some(tile.scene.digest());
    if tile.cells.iter().all(|cell| cell.id.is_empty()) {
        parts.cell_names.clear();
    }
    Ok(BakedTile { table: Table::new(parts)?, near, far, report })
}

/// Decides again what a tile sees of those farther away, and nothing else: [`BakedTile::far`], in less time. After tiles were added far away, or
/// the boxes around them changed.
///
/// # Errors
/// As [`bake_tile`].
pub fn bake_far(tile: &Tile<'_>, request: &BakeRequest, runtime: &Runtime<'_>) -> Result<Columns, BakeError> {
    Ok(far_columns(tile, &decided(tile, Wanted::LastRegions, request, runtime)?.objects))
}

fn decided(
    tile: &Tile<'_>,
    wanted: Wanted,
    request: &BakeRequest,
    runtime: &Runtime<'_>,
) -> Result<Decided, BakeError> {
    request.check(&tile.scene.into())?;
    refuse_parts(request.parts, "a world of tiles")?;
    let scene = merged(tile);
    let cells = CellsFrom::Boxes(ViewCells { cells: tile.cells.to_vec(), axes: None });
    let near: Vec<Aabb<3>> = tile.near.iter().flat_map(|near| near.cells.iter().map(|cell| cell.bounds)).collect();
    threads::on(runtime.threads, || {
        let recipe = recipe_of_tile(request, &scene, cells, runtime);
        with_regions(&scene, &recipe, runtime, tile.file, |how| decide(&scene, &[&near, tile.far], wanted, how))
    })
}

/// The scene of a tile and those nearby: its objects come first, those of each other follow in their order, without names.
fn merged(tile: &Tile<'_>) -> Scene {
    let mut objects: Vec<SceneObject> = tile.scene.objects().to_vec();
    let (mut see_through, mut single_sided) = (tile.scene.see_through().to_vec(), tile.scene.single_sided().to_vec());
    let mut front_occluders = tile.scene.front_occluders().to_vec();
    let mut moving: Vec<MovingObject> = tile.scene.moving().to_vec();
    for near in tile.near {
        let first = objects.len() as u32;
        let nameless = near.scene.objects().iter().map(|object| SceneObject { name: String::new(), ..object.clone() });
        objects.extend(nameless);
        see_through.extend(near.scene.see_through().iter().map(|object| first + object));
        single_sided.extend(near.scene.single_sided().iter().map(|object| first + object));
        front_occluders.extend(near.scene.front_occluders().iter().map(|object| first + object));
        moving.extend(near.scene.moving().iter().map(|m| MovingObject { object: first + m.object, within: m.within }));
    }
    let merge = || -> Result<Scene, SceneError> {
        let scene = Scene::new(objects)?.with_see_through(see_through)?.with_moving(moving)?;
        scene.with_single_sided(single_sided)?.with_front_occluders(front_occluders)
    };
    merge().expect("what is right in its scene is right in one of several")
}

/// Where the columns of objects, of cells nearby, and of tiles farther away begin in what was decided.
fn starts(tile: &Tile<'_>) -> [usize; 3] {
    let n_objects: usize = tile.near.iter().map(|near| near.scene.objects().len()).sum();
    let n_cells: usize = tile.near.iter().map(|near| near.cells.len()).sum();
    let own = tile.scene.objects().len();
    [own, own + n_objects, own + n_objects + n_cells]
}

/// What each cell sees of cells and objects nearby.
fn near_columns(tile: &Tile<'_>, seen: &BitMatrix) -> Columns {
    let [mut objects_at, mut cells_at, _] = starts(tile);
    let mut columns: Vec<Range<usize>> = Vec::new();
    for near in tile.near {
        let (n_cells, n_objects) = (near.cells.len(), near.scene.objects().len());
        columns.extend([cells_at..cells_at + n_cells, objects_at..objects_at + n_objects]);
        cells_at += n_cells;
        objects_at += n_objects;
    }
    rows(seen, columns.into_iter().flatten())
}

/// Of which tiles farther away each cell sees anything.
fn far_columns(tile: &Tile<'_>, seen: &BitMatrix) -> Columns {
    let [_, _, at] = starts(tile);
    rows(seen, at..at + tile.far.len())
}

/// The runs of bits in these columns, which are numbered through.
fn rows(seen: &BitMatrix, columns: impl Iterator<Item = usize> + Clone) -> Columns {
    let row = |row: usize| {
        let columns = (0u32..).zip(columns.clone());
        runs_of(columns.filter(|(_, column)| seen.get(row, *column)).map(|(k, _)| k))
    };
    (0..seen.n_rows()).map(row).collect()
}
