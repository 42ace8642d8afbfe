//! One tile of a world that is too large for one table.
//!
//! A world is cut into tiles, each a scene with cells of its own. The table of a tile says what its cells see of it. Of tiles nearby its
//! rows across say which cells and objects its cells see; of those farther away, whether they see anything of them. What a tile and those
//! nearby contain hides; what is farther away hides nothing. So a tile depends on those nearby, and on the boxes around the others, and is
//! baked without reading the rest of the world; what it shows is a superset of what a bake of the whole world would show.

use crate::auto::choose_for;
use crate::error::BakeError;
use crate::graph::TableGraph;
use crate::options::{BakeOptions, SceneMethod};
use crate::places::{PlacesError, observed_places};
use crate::region::{CellsFrom, Decided, decide};
use crate::reports::RegionReport;
use crate::run::with_regions;
use crate::scene::extents;
use crate::{BakeInput, grid};
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

/// A tile, baked.
#[derive(Debug, Clone, PartialEq)]
pub struct BakedTile {
    /// The table of its cells and objects.
    pub table: Table,
    /// For each cell what it may see of other tiles, as runs of columns: the cells of the first tile nearby, its objects, those of the
    /// second, and so on, then those farther away, one each.
    pub across: Vec<Vec<Range<u32>>>,
    /// What was done.
    pub report: RegionReport,
}

/// The cells of a tile, cut as the options say in the box where viewers can be: of what it contains alone, so that they are the same whatever
/// lies around it. Given boxes are taken as they are.
///
/// # Errors
/// [`BakeError`]: a box without room, more cells than the limit.
pub fn tile_cells(scene: &Scene, viewers: &Aabb<3>, options: &BakeOptions<'_>) -> Result<Vec<ViewCell>, BakeError> {
    let nameless = |bounds: Aabb<3>| ViewCell { id: String::new(), bounds };
    let cut = SceneOptions { view_region: Some(*viewers), ..options.cut };
    Ok(match &options.cells {
        CellsFrom::KdTree => {
            let cut = subdivide_scene(scene, &cut)?;
            cut.graph.cells().iter().map(|cell| nameless(cell.bounds)).collect()
        }
        CellsFrom::Grid(n) => grid::grid(viewers, *n)?.cells.into_iter().map(|cell| nameless(cell.bounds)).collect(),
        CellsFrom::Places(how) => {
            let found = observed_places(scene, &cut, how, options.progress).map_err(|error| match error {
                PlacesError::Cancelled(cancelled) => cancelled.into(),
                error => BakeError::from(error),
            })?;
            found.cells.into_iter().map(nameless).collect()
        }
        CellsFrom::Boxes(given) => crate::region::upright(given),
    })
}

/// The box around all that a tile shows, wherever it moves, and around its cells.
pub fn tile_extent(scene: &Scene, cells: &[ViewCell]) -> Aabb<3> {
    let boxes = extents(scene).into_iter().chain(cells.iter().map(|cell| cell.bounds)).filter(|b| !b.is_empty());
    Aabb::around(boxes.flat_map(|b| [b.min, b.max]))
}

/// Bakes a tile. Errs towards visible only, as far as the method does.
///
/// Cells are boxes without portals, whatever they were cut from. [`BakeOptions::cells`] is not used; see [`tile_cells`]. A scene that stands along
/// other axes than its file is not turned.
///
/// Cost: that of its cells in a scene of the tile and those nearby, each asked of its own cells, those nearby, and the boxes of the others.
/// Memory: cells times the columns of what is asked, in bits.
///
/// # Errors
/// [`BakeError`]: cells that are not volumes, and methods that fail.
pub fn bake_tile(tile: &Tile<'_>, options: &BakeOptions<'_>) -> Result<BakedTile, BakeError> {
    let scene = merged(tile);
    let cells = CellsFrom::Boxes(ViewCells { cells: tile.cells.to_vec(), axes: None });
    let mut options = BakeOptions { cells, ..options.clone() };
    if options.method == SceneMethod::Auto {
        options = choose_for(&BakeInput::Scene(&scene, None), &options).1;
    }
    let near_cells = tile.near.iter().flat_map(|near| near.cells.iter().map(|cell| cell.bounds));
    let regions: Vec<Aabb<3>> = near_cells.chain(tile.far.iter().copied()).collect();
    let Decided { graph, mut parts, objects, mut report } =
        with_regions(&scene, &options, tile.file, |how| decide(&scene, &regions, how))?;
    debug_assert!(matches!(graph, TableGraph::Boxes(_)), "tiles have boxes as cells");
    let across = across(tile, &objects);
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
    Ok(BakedTile { table: Table::new(parts)?, across, report })
}

/// The scene of a tile and those nearby: its objects come first, those of each other follow in their order, without names.
fn merged(tile: &Tile<'_>) -> Scene {
    let mut objects: Vec<SceneObject> = tile.scene.objects().to_vec();
    let (mut see_through, mut single_sided) = (tile.scene.see_through().to_vec(), tile.scene.single_sided().to_vec());
    let mut moving: Vec<MovingObject> = tile.scene.moving().to_vec();
    for near in tile.near {
        let first = objects.len() as u32;
        let nameless = near.scene.objects().iter().map(|object| SceneObject { name: String::new(), ..object.clone() });
        objects.extend(nameless);
        see_through.extend(near.scene.see_through().iter().map(|object| first + object));
        single_sided.extend(near.scene.single_sided().iter().map(|object| first + object));
        moving.extend(near.scene.moving().iter().map(|m| MovingObject { object: first + m.object, within: m.within }));
    }
    let merge = || -> Result<Scene, SceneError> {
        Scene::new(objects)?.with_see_through(see_through)?.with_moving(moving)?.with_single_sided(single_sided)
    };
    merge().expect("what is right in its scene is right in one of several")
}

/// The columns of other tiles that each cell may see.
fn across(tile: &Tile<'_>, objects: &BitMatrix) -> Vec<Vec<Range<u32>>> {
    let sizes = tile.near.iter().map(|near| (near.cells.len(), near.scene.objects().len()));
    let mut objects_at = tile.scene.objects().len();
    let mut regions_at = objects_at + sizes.clone().map(|(_, n)| n).sum::<usize>();
    // For each column of other tiles that of the matrix.
    let mut columns: Vec<Range<usize>> = Vec::new();
    for (n_cells, n_objects) in sizes {
        columns.extend([regions_at..regions_at + n_cells, objects_at..objects_at + n_objects]);
        regions_at += n_cells;
        objects_at += n_objects;
    }
    columns.push(regions_at..regions_at + tile.far.len());
    let row = |row: usize| {
        let seen = (0u32..).zip(columns.iter().cloned().flatten());
        runs_of(seen.filter(|(_, column)| objects.get(row, *column)).map(|(column, _)| column))
    };
    (0..objects.n_rows()).map(row).collect()
}
