//! Baking a scene by from-region queries: view cells as volumes, objects as occludees.
//!
//! A from-region method ([`FromRegion`]) finds for each cell which objects, and which other cells, are hidden from all of
//! it. Sightlines find the same in another way, for the cells of a k-d tree ([`bake_scene`](crate::bake_scene)) or for
//! given boxes ([`box_visibility`]). What either proves hidden is hidden, so the two can be combined. For given boxes the
//! method comes first, and sightlines decide the pairs that neither it nor a ray has decided. Rays are traced in doubles:
//! what one seems to reach through the crack between two surfaces is left visible, unless the method hides a group of cells that it is in.

mod boxes;
mod limited;
mod parts;
pub(crate) mod phase;
mod row;
mod see;
mod stream;
mod tiled;

pub use crate::grid::{GridError, grid};

use crate::baked::{Baked, BakedRegions};
use crate::doors;
use crate::error::BakeError;
use crate::eye_level::{EyeLevelError, EyeLevelOptions, EyeLevelSummary, eye_level_cells};
use crate::graph::TableGraph;
use crate::limit::{LimitReport, state_limit};
use crate::objects::object_lists;
use crate::places::{PlaceOptions, PlaceSummary, PlacesError, observed_places};
use crate::reports::RegionReport;
use crate::scene::{PortalMode, SceneBakeOptions, extents, merge_portals, n_triangles, see_scene};
use crate::stated::{DETAIL_BELOW, METHOD};
use crate::stopwatch::Stopwatch;
use crate::table::{object_record, state_file};
use crate::threads;
use parts::Start;
pub(crate) use parts::upright;
pub(crate) use see::Regions;
use sightlines_cells::{ANYWHERE, Scene};
use sightlines_formats::{SceneInfo, ViewCells};
use sightlines_geometry::{Aabb, Point3};
use sightlines_kdtree::{KdError, SceneOptions, subdivide_scene};
use sightlines_line_space::Surface;
use sightlines_multifocal::{FromRegion, Occludees, RaySampler, Split, Volume, WorkDone};
use sightlines_progress::{Allowance, Observer, Units};
use sightlines_pvs::{Axis, BitMatrix, SceneMethods, Table, TableKind, TableParts};
use sightlines_stabtree::{BoxVisibility, PairMask, SearchOptions, box_visibility};
use std::fmt;
use std::sync::Arc;
pub(crate) use stream::pack_regions_around;
pub use stream::{PackRegionsError, pack_regions};

/// The cells of the table of a scene.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum CellsFrom {
    /// Those of the k-d tree, with their portals.
    #[default]
    KdTree,
    /// A grid of so many boxes along each axis, in the view region or else the scene's box; without portals.
    Grid([u32; 3]),
    /// Boxes for any scene, cut where views differ, in the view region or else the scene's box; without portals. See
    /// [`places`](crate::places).
    Places(PlaceOptions),
    /// Boxes above floors, as high as eyes are; without portals. See [`eye_level`](crate::eye_level). Where there are no floors, places.
    EyeLevel(EyeLevelOptions),
    /// These boxes, without portals; they may overlap, and leave gaps.
    Boxes(ViewCells),
}

impl CellsFrom {
    /// Whether there are portals between the cells.
    pub const fn have_portals(&self) -> bool {
        matches!(self, Self::KdTree)
    }

    /// How many cells there may be at most; `None` if that is not known before they are cut.
    pub fn most(&self) -> Option<u64> {
        match self {
            Self::KdTree | Self::EyeLevel(_) => None,
            Self::Grid(n) => Some(n.iter().map(|&n| u64::from(n)).fold(1, u64::saturating_mul)),
            Self::Places(how) => Some(u64::from(how.n_cells())),
            Self::Boxes(given) => Some(given.cells.len() as u64),
        }
    }
}

/// The share of a budget for sightlines, if there is also a from-region method.
const SIGHTLINES: f64 = 0.25;

/// Makes a from-region method, for one thread.
pub type MakeMethod<'a> = &'a (dyn Fn() -> Box<dyn FromRegion + Send> + Sync);

/// How to bake a scene by from-region queries.
#[derive(Clone, Copy)]
pub struct RegionBakeOptions<'a> {
    /// The cells.
    pub cells: &'a CellsFrom,
    /// The from-region method; none leaves all to sightlines. [`OcclusionMethodFactory`](crate::methods::OcclusionMethodFactory)
    /// has those of this workspace by name.
    pub method: Option<MakeMethod<'a>>,
    /// What that method has prepared for propagating shadows from cell to cell; without it each cell of [`CellsFrom::EyeLevel`] is
    /// asked about alone.
    pub surface: Option<&'a Arc<Surface>>,
    /// Whether sightlines decide as well; without a method they always do.
    pub sightlines: bool,
    /// When cells are cut into smaller volumes.
    pub split: Split,
    /// How to cut the scene, for cells of the k-d tree and for sightlines.
    pub cut: SceneOptions,
    /// Which portals sightlines go through.
    pub portals: PortalMode,
    /// Number of threads; 0 for one for each core. Changes nothing but the time.
    pub threads: usize,
    /// Axes and units as the scene's file states them, if it came from one; the table states them too.
    pub file: Option<&'a SceneInfo>,
    /// Receives reports, and may cancel.
    pub progress: Option<&'a dyn Observer>,
    /// What may be spent; what is not decided then counts as visible.
    pub budget: Allowance<'a>,
    /// Where results of units of work are kept.
    pub units: Units<'a>,
}

impl<'a> RegionBakeOptions<'a> {
    /// These cells by sightlines alone, with everything else as it is by default.
    pub fn new(cells: &'a CellsFrom) -> Self {
        Self {
            cells,
            method: None,
            surface: None,
            sightlines: true,
            split: Split::default(),
            cut: SceneOptions::default(),
            portals: PortalMode::default(),
            threads: 0,
            file: None,
            progress: None,
            budget: Allowance::default(),
            units: Units::default(),
        }
    }
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

/// Decides which cells see which objects and each other, and makes the table.
///
/// An eye may be anywhere in a closed cell. Objects are hidden if all of their triangles are, and those that move if the box
/// that they do not leave is; those whose box touches a cell are visible from it. Errs towards visible only, as far as the method does.
///
/// # Errors
/// [`BakeError`]: for scenes that cannot be cut, cells that are not volumes, and methods that fail.
pub fn bake_regions(scene: &Scene, options: &RegionBakeOptions<'_>) -> Result<BakedRegions, BakeError> {
    let decided = threads::on(options.threads, || decide(scene, &[], Wanted::All, options))?;
    let Decided { graph, mut parts, objects, mut report } = decided;
    let start = Stopwatch::start();
    parts.objects_seen = Some(objects);
    let table = Table::new(parts)?;
    report.time += start.elapsed();
    Ok(Baked { graph, table, report })
}

/// What the cells of a scene may see.
pub(crate) struct Decided {
    pub(crate) graph: TableGraph,
    /// Those of the table, but for what is visible of objects.
    pub(crate) parts: TableParts,
    /// Cells by objects, and by regions behind them.
    pub(crate) objects: BitMatrix,
    pub(crate) report: RegionReport,
}

/// What is decided.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Wanted {
    All,
    /// Only what is seen of the last list of regions, which is the same as with [`Wanted::All`]; only for cells without portals.
    LastRegions,
}

/// Decides what the cells of a scene see.
///
/// * `regions`: boxes elsewhere, of which is decided as well which cells see anything in them; only for cells without portals
pub(crate) fn decide(
    scene: &Scene,
    regions: &Regions<'_>,
    wanted: Wanted,
    options: &RegionBakeOptions<'_>,
) -> Result<Decided, BakeError> {
    let start = Stopwatch::start();
    // Rays find objects.
    let n_rays = if wanted == Wanted::All { options.split.n_rays } else { 0 };
    let options = &RegionBakeOptions { split: Split { n_rays, ..options.split }, ..*options };
    let n_objects = scene.objects().len();
    // Regions come behind the objects.
    let mut boxes = extents(scene);
    boxes.extend(regions.iter().copied().flatten());
    let mut by_sightlines = options.sightlines || options.method.is_none();
    let (mut n_assumed, mut summary, mut eye_level, mut left, mut cut_time) = (0, None, None, None, None);
    let Start { graph, mut parts, cells, rows, objects } = match options.cells {
        CellsFrom::KdTree if by_sightlines => {
            let RegionBakeOptions { cut, portals, threads, progress, units, .. } = *options;
            let budget = if options.method.is_some() { options.budget.part(SIGHTLINES) } else { options.budget };
            let options = SceneBakeOptions { cut, portals, threads, file: None, progress, budget, units };
            let (graph, parts, report, not_decided) = see_scene(scene, &options)?;
            (n_assumed, cut_time) = (report.n_assumed, Some(report.cut_time));
            left = not_decided;
            parts::of_seen(graph, parts)
        }
        CellsFrom::KdTree => parts::of_cut(scene, subdivide_scene(scene, &options.cut)?, boxes.len()),
        alone => {
            let cut = cells_alone(scene, options, alone)?;
            (summary, eye_level) = (cut.places, cut.eye_level);
            let n_wanted = match wanted {
                Wanted::All => None,
                Wanted::LastRegions => regions.last().map(|last| last.len()),
            };
            parts::of_alone((cut.cells, cut.parts), boxes.len(), n_wanted)
        }
    };
    let volumes = volumes(&cells)?;
    let touching = see::touching(&cells, &boxes);
    let n = cells.len();
    let cut_time = cut_time.unwrap_or_else(|| start.elapsed());
    let doors = match &graph {
        TableGraph::Axial(graph) => doors::of_scene(graph, scene),
        _ => Vec::new(),
    };
    let none = || PairMask { boxes: BitMatrix::new(n, n), objects: BitMatrix::new(n, boxes.len()) };
    let mut left = left.unwrap_or_else(none);
    let mut proven = PairMask { boxes: BitMatrix::identity(n), objects: BitMatrix::new(n, boxes.len()) };
    let (mut rows, mut objects, effort, method) = 'method: {
        let Some(make) = options.method else { break 'method (rows, objects, WorkDone::default(), None) };
        let made = make();
        let method = (made.name(), made.only_in_air());
        let (occludees, witness) = targets_of(scene, &boxes[..n_objects]);
        if let Some(surface) = options.surface.filter(|_| eye_level.is_some() && regions.is_empty()) {
            let seen = tiled::see((scene, Arc::clone(surface)), &cells, (&occludees, &witness), &boxes, options)?;
            left = seen.left;
            break 'method (seen.rows, seen.objects, seen.effort, Some(method));
        }
        let has_one_way = !scene.front_occluders().is_empty();
        let scene = see::Targets::new((&occludees, &witness), &volumes, has_one_way, regions);
        let takes_turns = by_sightlines && matches!(graph, TableGraph::Boxes(_));
        let allowance = if takes_turns { options.budget.part(1.0 - SIGHTLINES) } else { options.budget };
        let seen = see::see(&scene, make, options, allowance, rows, objects)?;
        proven = seen.proven;
        boxes::add(&mut left, &seen.left);
        (seen.rows, seen.objects, seen.effort, Some(method))
    };
    if by_sightlines && matches!(graph, TableGraph::Boxes(_)) {
        let doubt = boxes::in_doubt(&rows, &objects, &proven, &touching);
        // Where no doubt is left the scene need not be cut.
        let is_any = doubt.boxes.count_ones() + doubt.objects.count_ones() > 0;
        if is_any && options.budget.is_over() {
            boxes::add(&mut left, &doubt);
        } else if is_any {
            match past_walls(scene, options, &cells, &boxes, &doubt) {
                Ok(answer) => {
                    n_assumed = answer.n_assumed;
                    answer.left.iter().for_each(|more| boxes::add(&mut left, more));
                    boxes::clear_hidden([&mut rows, &mut objects], &doubt, &answer);
                }
                // Scenes that are cut into places may have too many walls for a k-d tree; what is in doubt stays visible.
                Err(BakeError::KdTree(KdError::TooManyCells { .. })) if summary.is_some() && method.is_some() => {
                    by_sightlines = false;
                }
                Err(error) => return Err(error),
            }
        }
    }
    boxes::keep_visible(&mut left, &rows, &objects, &touching);
    see::add(&mut objects, &touching);
    let limit = Some(LimitReport::of(&left, &objects)).filter(LimitReport::is_any);
    let (n_visible_pairs, n_objects_seen) = ((rows.count_ones() - n as u64) / 2, objects.count_ones());
    parts.rows = rows;
    parts.doors = doors::records(scene, &doors);
    let of_objects = |mut list: Vec<u32>| {
        list.truncate(list.partition_point(|&object| (object as usize) < n_objects));
        list
    };
    parts.cell_objects = object_lists(touching.into_iter().map(of_objects).collect());
    if parts.objects.is_empty() {
        state_objects(&mut parts, scene, &boxes);
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
    parts.kind = match graph {
        TableGraph::Boxes(_) => TableKind::SceneGivenCells { hidden_by },
        _ => TableKind::SceneKdTree { hidden_by },
    };
    parts.info.push((METHOD.to_owned(), format!("{by}{text}")));
    // Those of a k-d tree state it whether it was chosen or not.
    if let Some(size) = options.cut.detail_below.filter(|_| by_sightlines && matches!(graph, TableGraph::Boxes(_))) {
        parts.info.push((DETAIL_BELOW.to_owned(), size.to_string()));
    }
    parts.info.sort();
    limit.iter().for_each(|limit| state_limit(&mut parts, limit));
    state_file(&mut parts, options.file);
    // Those of a k-d tree have them.
    parts.digest.get_or_insert_with(|| scene.digest());
    let report = RegionReport {
        places: summary,
        eye_level,
        n_assumed,
        method,
        effort,
        doors,
        n_visible_pairs,
        n_objects_seen,
        limit,
        cut_time,
        time: start.elapsed(),
    };
    Ok(Decided { graph, parts, objects, report })
}

/// Cells without portals, with what is known of them.
struct CellsAlone {
    cells: Vec<Aabb<3>>,
    /// The parts of the table, but for objects and what is visible.
    parts: TableParts,
    places: Option<PlaceSummary>,
    eye_level: Option<EyeLevelSummary>,
}

fn cells_alone(scene: &Scene, options: &RegionBakeOptions<'_>, how: &CellsFrom) -> Result<CellsAlone, BakeError> {
    let (mut places, mut eye_level, cut) = (None, None, &options.cut);
    let mut cut_places = |how: &PlaceOptions| {
        let found = observed_places(scene, cut, how, options.progress).map_err(|error| match error {
            PlacesError::Cancelled(cancelled) => cancelled.into(),
            error => BakeError::from(error),
        })?;
        places = Some(found.summary);
        Ok::<_, BakeError>(parts::places_alone(found.cells, "places"))
    };
    let (cells, parts) = match how {
        CellsFrom::KdTree => unreachable!("those have portals"),
        CellsFrom::Grid(n) => {
            let around = cut.view_region.unwrap_or_else(|| scene.bounds());
            parts::boxes_alone(&grid(&around, *n)?.cells)
        }
        CellsFrom::Places(how) => cut_places(how)?,
        CellsFrom::EyeLevel(how) => {
            let (up, region) = (how.up.unwrap_or(Axis::Z), cut.view_region.as_ref());
            match eye_level_cells(scene, up, region, how, cut.max_cells, options.progress) {
                Ok(found) => {
                    eye_level = Some(found.summary);
                    parts::places_alone(found.cells, "eye-level")
                }
                Err(EyeLevelError::NoFloor) => cut_places(&how.places())?,
                Err(EyeLevelError::Cancelled(cancelled)) => return Err(cancelled.into()),
                Err(error) => return Err(error.into()),
            }
        }
        CellsFrom::Boxes(cells) => parts::boxes_alone(&upright(cells)),
    };
    Ok(CellsAlone { cells, parts, places, eye_level })
}

/// What from-region methods are asked about, and the rays that find what is visible.
fn targets_of(scene: &Scene, boxes: &[Aabb<3>]) -> (Occludees, RaySampler) {
    // What may be anywhere touches every cell, and need not be decided.
    let covering = |(object, extent): (u32, &Aabb<3>)| {
        if *extent == ANYWHERE { Vec::new() } else { scene.covering_triangles(object) }
    };
    let triangles: Vec<Vec<[Point3; 3]>> = (0u32..).zip(boxes).map(covering).collect();
    let witness = rays_of(scene, &triangles, |object| object);
    (Occludees::new(triangles).with_single_sided(|object| scene.is_single_sided(object)), witness)
}

/// Whether an object stops rays, if only from its front: what is see-through does not.
pub(crate) fn stops_rays(scene: &Scene, object: u32) -> bool {
    scene.is_opaque(object) || scene.hides_from_front(object)
}

/// Rays among things made of triangles, with the sides of the objects that they are of.
pub(crate) fn rays_of(scene: &Scene, things: &[Vec<[Point3; 3]>], object_of: impl Fn(u32) -> u32) -> RaySampler {
    let none: &[[Point3; 3]] = &[];
    let in_the_way =
        (0u32..).zip(things).map(|(thing, of)| if stops_rays(scene, object_of(thing)) { &of[..] } else { none });
    RaySampler::new(in_the_way)
        .with_single_sided(|thing| scene.is_single_sided(object_of(thing)))
        .with_front_occluders(|thing| scene.hides_from_front(object_of(thing)))
}

/// States the objects of a scene.
fn state_objects(parts: &mut TableParts, scene: &Scene, boxes: &[Aabb<3>]) {
    parts.objects = scene.objects().iter().zip(boxes).map(|(o, b)| object_record(&o.name, b)).collect();
    parts.object_polygons = scene.objects().iter().map(n_triangles).collect();
    parts.object_sources = scene.sources().to_vec();
}

/// What boxes anywhere see by sightlines, with the insides of solid things as cells, out to the farthest box.
fn past_walls(
    scene: &Scene,
    options: &RegionBakeOptions<'_>,
    cells: &[Aabb<3>],
    objects: &[Aabb<3>],
    doubt: &PairMask,
) -> Result<BoxVisibility, BakeError> {
    // What may be anywhere touches every cell, and is not in doubt.
    let is_somewhere = |b: &&Aabb<3>| !b.is_empty() && **b != ANYWHERE;
    let around = cells.iter().chain(objects.iter().filter(is_somewhere)).flat_map(|b| [b.min, b.max]);
    let ends = [scene.bounds().min, scene.bounds().max].into_iter().chain(around);
    // The limit of places is not one of the cells that sightlines need.
    let max_cells = options.cut.max_cells.max(SceneOptions::default().max_cells);
    let max_cells = if matches!(options.cells, CellsFrom::Places(_)) { max_cells } else { options.cut.max_cells };
    let cut = SceneOptions { keep_solid: true, view_region: Some(Aabb::around(ends)), max_cells, ..options.cut };
    let cut = subdivide_scene(scene, &cut)?;
    let loose = (options.portals == PortalMode::Bounding).then(|| merge_portals(&cut.graph));
    let RegionBakeOptions { threads, progress, budget, units, .. } = *options;
    let search = SearchOptions { threads, progress, budget, units, ..SearchOptions::default() };
    let graph = loose.as_ref().unwrap_or(&cut.graph);
    Ok(box_visibility(graph, &cut.left_out(), &cut.fronts, cells, objects, doubt, &search)?)
}

fn volumes(cells: &[Aabb<3>]) -> Result<Vec<Volume>, BakeError> {
    let volume = |(cell, b): (usize, &Aabb<3>)| Volume::new(*b).map_err(|error| BakeError::Cell { cell, error });
    cells.iter().enumerate().map(volume).collect()
}
