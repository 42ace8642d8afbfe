//! Baking a scene by what is hidden from whole volumes: view cells as volumes, objects as occludees.
//!
//! A from-region method ([`FromRegion`]) finds the objects and other cells that are hidden from all of a cell. Sight
//! lines give the same answer in another way, for the cells of a k-d tree ([`bake_scene`]) or of given boxes
//! ([`box_visibility`]); what either reports hidden is hidden, so the two can be combined. For given boxes the method
//! runs first, and sight lines only where neither it nor a ray has decided. Rays are traced in doubles: what one seems
//! to reach through the crack between two surfaces stays visible.

mod boxes;
mod see;

pub use boxes::{GridError, grid};

use crate::mirrors;
use crate::plan::BakeError;
use crate::scene::{BakedScene, PortalMode, SceneBakeOptions, bake_scene, merge_portals, portal_record};
use sightlines_cells::Scene;
use sightlines_formats::ViewCells;
use sightlines_geometry::{Aabb, Point3};
use sightlines_kdtree::{SceneOptions, SceneSubdivision, subdivide_scene};
use sightlines_multifocal::{BackendError, Effort, FromRegion, Occludees, Split, Volume, VolumeError, Witness};
use sightlines_progress::{Cancelled, Observer};
use sightlines_pvs::{
    BitMatrix, CellRecord, Locator, ObjectRecord, SceneMethods, Table, TableError, TableKind, TableParts,
};
use sightlines_stabtree::{BoxVisibility, PairMask, SearchOptions, box_visibility};
use std::fmt;
use std::time::{Duration, Instant};

/// The cells of the table.
#[derive(Debug, Clone, PartialEq)]
pub enum CellsFrom {
    /// Those of the k-d tree, with their portals.
    KdTree,
    /// These boxes, without portals; they may overlap, and leave gaps.
    Boxes(ViewCells),
}

/// Makes a from-region method, for one thread.
pub type MakeMethod<'a> = &'a (dyn Fn() -> Box<dyn FromRegion + Send> + Sync);

/// How to bake.
#[derive(Clone, Copy)]
pub struct RegionBakeOptions<'a> {
    /// The cells.
    pub cells: &'a CellsFrom,
    /// What says what is hidden; none leaves it to sightlines.
    pub method: Option<MakeMethod<'a>>,
    /// Whether sightlines say it as well; then without a method, they do alone.
    pub sightlines: bool,
    /// When cells are cut into smaller volumes.
    pub split: Split,
    /// How to cut the scene, for cells of the k-d tree and for sightlines.
    pub cut: SceneOptions,
    /// Which portals sightlines go through.
    pub portals: PortalMode,
    /// Number of threads; 0 for one for each core. Changes nothing but the time.
    pub threads: usize,
    /// Called with the number of finished cells and their total.
    pub progress: Option<&'a dyn Observer>,
}

impl fmt::Debug for RegionBakeOptions<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("RegionBakeOptions")
            .field("cells", self.cells)
            .field("sightlines", &self.sightlines)
            .field("split", &self.split)
            .field("threads", &self.threads)
            .finish_non_exhaustive()
    }
}

/// Why a scene was not baked.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RegionBakeError {
    /// The scene could not be cut, or seen through by sightlines.
    #[error(transparent)]
    Scene(#[from] BakeError),
    /// A cell is no volume.
    #[error("view cell {cell}: {error}")]
    Cell {
        /// Which, from 0.
        cell: usize,
        /// What is wrong.
        error: VolumeError,
    },
    /// The method failed.
    #[error(transparent)]
    Backend(#[from] BackendError),
    /// The observer cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl From<TableError> for RegionBakeError {
    fn from(error: TableError) -> Self {
        Self::Scene(error.into())
    }
}

/// A table, and how it came about.
#[derive(Debug, Clone, PartialEq)]
pub struct BakedRegions {
    /// The table.
    pub table: Table,
    /// Pairs that count as visible because it would have taken sightlines too much effort to decide about them.
    pub n_assumed: u64,
    /// Name of the method, if one was asked.
    pub method: Option<String>,
    /// What it did.
    pub effort: Effort,
    /// Unordered pairs of different cells that may see each other.
    pub n_visible_pairs: u64,
    /// Pairs of a cell and an object that it may see.
    pub n_objects_seen: u64,
    /// Time for everything.
    pub time: Duration,
}

/// What is known before a method runs.
struct Start {
    cells: Vec<Aabb<3>>,
    /// Which cells may see each other: symmetric, with ones on the diagonal.
    rows: BitMatrix,
    objects: BitMatrix,
}

/// Decides which cells see which objects and each other, and makes the table.
///
/// An eye may be anywhere in a closed cell. Objects are hidden if all of their triangles are; those whose box touches a cell
/// are visible from it. Errs towards visible only, as far as the method does.
///
/// # Errors
/// [`RegionBakeError`]
pub fn bake_regions(scene: &Scene, options: &RegionBakeOptions<'_>) -> Result<BakedRegions, RegionBakeError> {
    let start = Instant::now();
    let triangles: Vec<Vec<[Point3; 3]>> = scene.objects().iter().map(|o| o.corners().collect()).collect();
    let boxes: Vec<Aabb<3>> = triangles.iter().map(|t| Aabb::around(t.iter().flatten().copied())).collect();
    let by_sightlines = options.sightlines || options.method.is_none();
    let mut n_assumed = 0;
    let (mut parts, known) = match options.cells {
        CellsFrom::KdTree if by_sightlines => {
            let baked = by_portals(scene, options)?;
            n_assumed = baked.n_assumed;
            kd_known(baked.table.parts().clone())
        }
        CellsFrom::KdTree => {
            let cut = subdivide_scene(scene, &options.cut).map_err(BakeError::from)?;
            kd_parts(scene, &cut, boxes.len())
        }
        CellsFrom::Boxes(cells) => box_parts(cells, boxes.len()),
    };
    let volumes = volumes(&known.cells)?;
    let touching = see::touching(&known.cells, &boxes);
    let n = known.cells.len();
    let mut proven = PairMask { boxes: BitMatrix::identity(n), objects: BitMatrix::new(n, boxes.len()) };
    let (mut rows, mut objects, effort, method) = match options.method {
        Some(make) => {
            let made = make();
            let method = (made.name(), made.only_in_air());
            let witness = Witness::new(triangles.iter().map(|t| &t[..]));
            let occludees = Occludees::new(triangles);
            let scene = see::Scene { occludees: &occludees, witness: &witness, volumes: &volumes };
            let seen = see::see(&scene, make, options, known.rows, known.objects)?;
            proven = seen.proven;
            (seen.rows, seen.objects, seen.effort, Some(method))
        }
        None => (known.rows, known.objects, Effort::default(), None),
    };
    if by_sightlines && matches!(options.cells, CellsFrom::Boxes(_)) {
        let doubt = boxes::in_doubt(&rows, &objects, &proven, &touching);
        // Where no doubt is left the scene need not be cut.
        if doubt.boxes.count_ones() + doubt.objects.count_ones() > 0 {
            let answer = past_walls(scene, options, &known.cells, &boxes, &doubt)?;
            n_assumed = answer.n_assumed;
            boxes::clear_hidden([&mut rows, &mut objects], &doubt, &answer);
        }
    }
    see::add(&mut objects, &touching);
    let (n_visible_pairs, n_objects_seen) = ((rows.count_ones() - n as u64) / 2, objects.count_ones());
    parts.rows = rows;
    parts.cell_objects = touching;
    parts.objects_seen = Some(objects);
    if parts.objects.is_empty() {
        parts.objects = scene.objects().iter().zip(&boxes).map(|(o, b)| record(&o.name, b)).collect();
        parts.object_polygons =
            scene.objects().iter().map(|o| u32::try_from(o.triangles.len()).unwrap_or(u32::MAX)).collect();
    }
    let (method, only_in_air) = method.map_or((None, false), |(name, only_in_air)| (Some(name), only_in_air));
    let text = method.clone().unwrap_or_default();
    let by = if by_sightlines && method.is_some() {
        "sightlines+"
    } else if by_sightlines {
        "sightlines"
    } else {
        ""
    };
    let hidden_by = SceneMethods { sightlines: by_sightlines, from_region: method.is_some(), only_in_air };
    parts.kind = match options.cells {
        CellsFrom::KdTree => TableKind::SceneKdTree { hidden_by },
        CellsFrom::Boxes(_) => TableKind::SceneGivenCells { hidden_by },
    };
    parts.info.push(("method".to_owned(), format!("{by}{text}")));
    parts.info.sort();
    let table = Table::new(parts)?;
    Ok(BakedRegions { table, n_assumed, method, effort, n_visible_pairs, n_objects_seen, time: start.elapsed() })
}

/// The table of the k-d tree's cells.
fn by_portals(scene: &Scene, options: &RegionBakeOptions<'_>) -> Result<BakedScene, BakeError> {
    let RegionBakeOptions { cut, portals, threads, progress, .. } = *options;
    bake_scene(scene, &SceneBakeOptions { cut, portals, threads, progress })
}

/// What sightlines say of boxes that may lie anywhere, with the insides of solid things, out to the farthest box.
fn past_walls(
    scene: &Scene,
    options: &RegionBakeOptions<'_>,
    cells: &[Aabb<3>],
    objects: &[Aabb<3>],
    doubt: &PairMask,
) -> Result<BoxVisibility, BakeError> {
    let ends = [scene.bounds().min, scene.bounds().max].into_iter().chain(cells.iter().flat_map(|b| [b.min, b.max]));
    let cut = SceneOptions { keep_solid: true, view_region: Some(Aabb::around(ends)), ..options.cut };
    let cut = subdivide_scene(scene, &cut)?;
    let loose = (options.portals == PortalMode::Bounding).then(|| merge_portals(&cut.graph));
    let search = SearchOptions { threads: options.threads, progress: options.progress, ..SearchOptions::default() };
    let graph = loose.as_ref().unwrap_or(&cut.graph);
    Ok(box_visibility(graph, &cut.left_out(), cells, objects, doubt, &search)?)
}

fn volumes(cells: &[Aabb<3>]) -> Result<Vec<Volume>, RegionBakeError> {
    let volume = |(cell, b): (usize, &Aabb<3>)| Volume::new(*b).map_err(|error| RegionBakeError::Cell { cell, error });
    cells.iter().enumerate().map(volume).collect()
}

fn record(name: &str, b: &Aabb<3>) -> ObjectRecord {
    let b = if b.is_empty() { Aabb { min: [0.0; 3], max: [0.0; 3] } } else { *b };
    ObjectRecord { name: name.to_owned(), min: b.min, max: b.max }
}

/// A matrix of ones.
fn ones(n_rows: usize, n_cols: usize) -> BitMatrix {
    let mut all = BitMatrix::new(n_rows, n_cols);
    (0..n_rows).for_each(|row| (0..n_cols).for_each(|col| all.set(row, col, true)));
    all
}

/// The cells of a k-d tree, with what sightlines leave visible.
fn kd_known(parts: TableParts) -> (TableParts, Start) {
    let cells = parts.cells.iter().map(|c| Aabb { min: c.min, max: c.max }).collect();
    let objects = parts.objects_seen.clone().expect("scenes in space say what objects are seen");
    let rows = parts.rows.clone();
    (parts, Start { cells, rows, objects })
}

/// The cells of a k-d tree, of which everything may see everything.
fn kd_parts(scene: &Scene, cut: &SceneSubdivision, n_objects: usize) -> (TableParts, Start) {
    let cells: Vec<Aabb<3>> = cut.graph.cell_ids().map(|id| cut.graph.cell(id).bounds).collect();
    let bounds: Vec<_> = cells.iter().map(|b| (b.min, b.max)).collect();
    let info = vec![
        ("detail-below".to_owned(), cut.summary.detail_below.to_string()),
        ("subdivide".to_owned(), "kd".to_owned()),
    ];
    let parts = TableParts {
        cells: cells.iter().map(cell_record).collect(),
        portals: cut.graph.portals().iter().map(portal_record).collect(),
        locator: Locator::build(&bounds, 3),
        mirrors: mirrors::of_scene(&cut.graph, scene).parts,
        info,
        ..TableParts::empty(3, TableKind::SceneKdTree { hidden_by: SceneMethods::default() })
    };
    let n = cells.len();
    (parts, Start { cells, rows: ones(n, n), objects: ones(n, n_objects) })
}

fn cell_record(b: &Aabb<3>) -> CellRecord {
    CellRecord { min: b.min, max: b.max, group: None, polygon: Vec::new() }
}

/// Boxes from elsewhere, of which everything may see everything.
fn box_parts(boxes: &ViewCells, n_objects: usize) -> (TableParts, Start) {
    let cells: Vec<Aabb<3>> = boxes.cells.iter().map(|b| b.bounds).collect();
    let bounds: Vec<_> = cells.iter().map(|b| (b.min, b.max)).collect();
    let parts = TableParts {
        cells: cells.iter().map(cell_record).collect(),
        cell_names: boxes.cells.iter().map(|b| b.id.clone()).collect(),
        locator: Locator::build(&bounds, 3),
        info: vec![("subdivide".to_owned(), "boxes".to_owned())],
        ..TableParts::empty(3, TableKind::SceneGivenCells { hidden_by: SceneMethods::default() })
    };
    let n = cells.len();
    (parts, Start { cells, rows: ones(n, n), objects: ones(n, n_objects) })
}
