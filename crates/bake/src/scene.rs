//! Baking a scene in space: subdivide, see, tabulate.

use crate::baked::{Baked, BakedScene};
use crate::doors;
use crate::error::BakeError;
use crate::limit::{LimitReport, state_limit};
use crate::mirrors;
use crate::objects::object_lists;
use crate::reports::SceneReport;
use crate::stated::{DETAIL_BELOW, ONE_SIDED};
use crate::stopwatch::Stopwatch;
use crate::table::{axial_portal_record, box_record, object_record, state_file};
use crate::threads;
use sightlines_cells::{Axial, AxialDoor, CellGraph, Portal, Scene, SceneObject};
use sightlines_formats::SceneInfo;
use sightlines_geometry::Aabb;
use sightlines_kdtree::{SceneOptions, SceneSummary, subdivide_scene};
use sightlines_progress::{Allowance, Observer, Units};
use sightlines_pvs::{CellRecord, Locator, MirrorRecord, SceneMethods, Table, TableKind, TableParts};
use sightlines_stabtree::{AxialVisibility, PairMask, SearchOptions, axial_visibility};

/// Which portals the search goes through.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum PortalMode {
    /// One rectangle around each opening: a looser answer.
    Bounding,
    /// The exact pieces of each opening.
    #[default]
    Exact,
}

impl PortalMode {
    /// All modes.
    pub const ALL: [Self; 2] = [Self::Exact, Self::Bounding];

    /// Lower-case name: that of options, and of the information of a table.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::Bounding => "bounding",
        }
    }
}

/// How to bake a scene.
#[derive(Clone, Copy, Default)]
pub struct SceneBakeOptions<'a> {
    /// How to cut.
    pub cut: SceneOptions,
    /// Which portals the search goes through, and the table stores.
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

impl std::fmt::Debug for SceneBakeOptions<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("SceneBakeOptions")
            .field("cut", &self.cut)
            .field("portals", &self.portals)
            .field("threads", &self.threads)
            .finish_non_exhaustive()
    }
}

/// Cuts a scene, decides which cells see which cells and objects, and makes the table.
///
/// Walls are the axis-aligned faces of the scene that are neither detail nor see-through; nothing else hides anything. Cells
/// see each other exactly if an open set of lines leads through the exact portals (or through the
/// rectangles around them, with [`PortalMode::Bounding`]); an object counts as its box. Errs towards
/// visible only.
///
/// # Errors
/// [`BakeError::KdTree`] for scenes without room, options out of range, and too many cells.
pub fn bake_scene(scene: &Scene, options: &SceneBakeOptions<'_>) -> Result<BakedScene, BakeError> {
    let (graph, mut parts, mut report, left) = threads::on(options.threads, || see_scene(scene, options))?;
    if let (Some(left), Some(objects)) = (left, &parts.objects_seen) {
        let limit = LimitReport::of(&left, objects);
        state_limit(&mut parts, &limit);
        report.limit = Some(limit);
    }
    Ok(Baked { table: Table::new(parts)?, graph, report })
}

/// What [`bake_scene`] makes a table of.
pub(crate) fn see_scene(
    scene: &Scene,
    options: &SceneBakeOptions<'_>,
) -> Result<(CellGraph<Axial>, TableParts, SceneReport, Option<PairMask>), BakeError> {
    let start = Stopwatch::start();
    let cut = subdivide_scene(scene, &options.cut)?;
    let cut_time = start.elapsed();
    let start = Stopwatch::start();
    let boxes = extents(scene);
    let solid = cut.left_out();
    let SceneBakeOptions { threads, progress, budget, units, .. } = *options;
    let search = SearchOptions { threads, progress, budget, units, ..SearchOptions::default() };
    let graph = match options.portals {
        PortalMode::Bounding => merge_portals(&cut.graph),
        PortalMode::Exact => cut.graph,
    };
    let mut seen = axial_visibility(&graph, &solid, &cut.fronts, &boxes, &search)?;
    let left = seen.left.take();
    let see_time = start.elapsed();
    let found = mirrors::of_scene(&graph, scene);
    let doors = doors::of_scene(&graph, scene);
    let report = SceneReport {
        n_visible_pairs: (seen.cells.count_ones() - graph.n_cells() as u64) / 2,
        n_objects_seen: seen.objects.count_ones(),
        n_mirror_parts: found.parts.len(),
        n_lost_mirrors: found.n_lost,
        n_other_mirror_triangles: found.n_other_triangles,
        n_moving_mirrors: found.n_moving,
        doors,
        n_blockers: seen.n_blockers,
        n_assumed: seen.n_assumed,
        counters: seen.counters,
        limit: None,
        cut_time,
        see_time,
        cut: cut.summary,
    };
    let mut parts = scene_parts(&graph, seen, scene, &boxes, info(options, &report.cut), found.parts);
    parts.doors = doors::records(scene, &report.doors);
    if !cut.fronts.is_empty() {
        parts.info.push((ONE_SIDED.to_owned(), cut.fronts.len().to_string()));
        parts.info.sort();
    }
    state_file(&mut parts, options.file);
    Ok((graph, parts, report, left))
}

/// The boxes outside of which nothing of an object is drawn; empty, and so never seen, for those that are not drawn.
pub(crate) fn extents(scene: &Scene) -> Vec<Aabb<3>> {
    (0u32..).zip(scene.objects()).map(|(object, _)| scene.extent(object)).collect()
}

/// The polygons that are drawn for an object; more than the table can store count as the most that it can.
pub(crate) fn n_triangles(object: &SceneObject) -> u32 {
    u32::try_from(object.triangles.len()).unwrap_or(u32::MAX)
}

/// The same graph with one portal for each pair of cells: the rectangle around the exact pieces.
pub(crate) fn merge_portals(graph: &CellGraph<Axial>) -> CellGraph<Axial> {
    let mut portals: Vec<Portal<Axial>> = Vec::new();
    let mut sorted: Vec<&Portal<Axial>> = graph.portals().iter().collect();
    sorted.sort_by_key(|p| p.cells);
    for portal in sorted {
        match portals.last_mut().filter(|last| last.cells == portal.cells) {
            Some(last) => {
                let around = last.shape.extent.with(portal.shape.extent.min).with(portal.shape.extent.max);
                last.shape = AxialDoor { extent: around, ..last.shape };
            }
            None => portals.push(portal.clone()),
        }
    }
    CellGraph::new(graph.cells().to_vec(), portals)
}

/// The methods behind a table of a scene that was cut along its rectangles.
const SIGHTLINES: SceneMethods = SceneMethods { sightlines: true, from_region: false, only_in_air: false };

/// How the table of a scene was made, for people.
pub(crate) fn info(options: &SceneBakeOptions<'_>, cut: &SceneSummary) -> Vec<(String, String)> {
    let pair = |k: &str, v: String| (k.to_owned(), v);
    // Ascending keys.
    vec![
        pair(DETAIL_BELOW, cut.detail_below.to_string()),
        pair("portals", options.portals.name().to_owned()),
        pair("subdivide", "kd".to_owned()),
        pair("tau", options.cut.tau.to_string()),
    ]
}

/// The parts of the table of a scene that was cut, from what its cells see.
pub(crate) fn scene_parts(
    graph: &CellGraph<Axial>,
    seen: AxialVisibility,
    scene: &Scene,
    boxes: &[Aabb<3>],
    info: Vec<(String, String)>,
    mirrors: Vec<MirrorRecord>,
) -> TableParts {
    let cells: Vec<CellRecord> = graph.cells().iter().map(|cell| box_record(&cell.bounds)).collect();
    let bounds: Vec<([f64; 3], [f64; 3])> = cells.iter().map(|c| (c.min, c.max)).collect();
    TableParts {
        portals: graph.portals().iter().map(axial_portal_record).collect(),
        rows: seen.cells,
        objects: scene.objects().iter().zip(boxes).map(|(o, b)| object_record(&o.name, b)).collect(),
        object_polygons: scene.objects().iter().map(n_triangles).collect(),
        object_sources: scene.sources().to_vec(),
        cell_objects: object_lists(seen.touching),
        objects_seen: Some(seen.objects),
        locator: Locator::build(&bounds, 3),
        cells,
        info,
        mirrors,
        digest: Some(scene.digest()),
        ..TableParts::empty(3, TableKind::SceneKdTree { hidden_by: SIGHTLINES })
    }
}
