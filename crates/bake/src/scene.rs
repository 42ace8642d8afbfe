//! Baking a scene in space: subdivide, see, tabulate.

use crate::mirrors;
use crate::plan::BakeError;
use sightlines_cells::{Axial, AxialDoor, CellGraph, CellId, Portal, Scene};
use sightlines_geometry::Aabb;
use sightlines_kdtree::{SceneOptions, SceneSummary, subdivide_scene};
use sightlines_progress::Observer;
use sightlines_pvs::{
    CellRecord, Locator, MirrorRecord, ObjectRecord, PortalRecord, SceneMethods, Table, TableError, TableKind,
    TableParts,
};
use sightlines_sightline::ShaftCounters;
use sightlines_stabtree::{SearchOptions, SpaceVisibility, VisibilityBounds, space_visibility};
use std::time::{Duration, Instant};

/// Which portals the search goes through.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum PortalMode {
    /// One rectangle around each opening: quick, and shows more than there is to see.
    Bounding,
    /// The exact pieces of each opening.
    #[default]
    Exact,
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
    /// Called with the number of finished cells and their total.
    pub progress: Option<&'a dyn Observer>,
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

/// The table of a scene, and how it came about.
#[derive(Debug, Clone, PartialEq)]
pub struct BakedScene {
    /// The table.
    pub table: Table,
    /// What was cut.
    pub cut: SceneSummary,
    /// Unordered pairs of different cells that see each other.
    pub n_visible_pairs: u64,
    /// Pairs of a cell and an object that it sees.
    pub n_objects_seen: u64,
    /// Time to cut the scene.
    pub cut_time: Duration,
    /// Time to decide who sees what.
    pub see_time: Duration,
    /// Parts of mirrors in cells.
    pub n_mirror_parts: usize,
    /// Rectangles of mirrors of which a part is in no cell on either side, and does not reflect.
    pub n_lost_mirrors: usize,
    /// Triangles of mirrors that are not perpendicular to an axis, and do not reflect.
    pub n_other_mirror_triangles: usize,
    /// Rectangles that the walls between the cells were put together to.
    pub n_blockers: usize,
    /// Pairs of a cell and a cell or object that count as visible because deciding about them took too
    /// much effort, or more digits than doubles have. Varies a little with threads.
    pub n_assumed: u64,
    /// How it was decided who sees what. Varies from run to run with several threads.
    pub counters: ShaftCounters,
}

/// Cuts a scene, decides which cells see which cells and objects, and makes the table.
///
/// Walls are the axis-aligned faces of the scene that are not detail; nothing else hides anything. Cells
/// see each other exactly if an open set of lines leads through the exact portals (or through the
/// rectangles around them, with [`PortalMode::Bounding`]); an object counts as its box. Errs towards
/// visible only.
///
/// # Errors
/// [`BakeError::KdTree`] for scenes without room, options out of range, and too many cells.
pub fn bake_scene(scene: &Scene, options: &SceneBakeOptions<'_>) -> Result<BakedScene, BakeError> {
    let start = Instant::now();
    let cut = subdivide_scene(scene, &options.cut)?;
    let cut_time = start.elapsed();
    let start = Instant::now();
    let boxes: Vec<Aabb<3>> = scene.objects().iter().map(drawn_box).collect();
    let solid = cut.left_out();
    let search = SearchOptions { threads: options.threads, progress: options.progress, ..SearchOptions::default() };
    let nothing = VisibilityBounds::nothing(cut.graph.n_cells());
    let graph = match options.portals {
        PortalMode::Bounding => merge_portals(&cut.graph),
        PortalMode::Exact => cut.graph,
    };
    let seen = space_visibility(&graph, &solid, &boxes, &nothing, &search)?;
    let see_time = start.elapsed();
    let n_visible_pairs = (seen.cells.count_ones() - graph.n_cells() as u64) / 2;
    let (n_objects_seen, counters) = (seen.objects.count_ones(), seen.counters);
    let (n_blockers, n_assumed) = (seen.n_blockers, seen.n_assumed);
    let info = info(options, &cut.summary);
    let found = mirrors::of_scene(&graph, scene);
    let n_mirror_parts = found.parts.len();
    let (n_lost_mirrors, n_other_mirror_triangles) = (found.n_lost, found.n_other_triangles);
    let table = scene_table(&graph, seen, scene, &boxes, info, found.parts)?;
    let cut = cut.summary;
    Ok(BakedScene {
        table,
        cut,
        n_visible_pairs,
        n_objects_seen,
        n_mirror_parts,
        n_lost_mirrors,
        n_other_mirror_triangles,
        n_blockers,
        n_assumed,
        counters,
        cut_time,
        see_time,
    })
}

/// The box around an object's triangles; empty, and so never seen, if it has none.
pub(crate) fn drawn_box(object: &sightlines_cells::SceneObject) -> Aabb<3> {
    Aabb::around(object.corners().flatten())
}

/// The polygons that are drawn for an object; more than the table can say count as the most that it can.
fn n_triangles(object: &sightlines_cells::SceneObject) -> u32 {
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

/// What found the hidden in a table of a scene that was cut along its rectangles.
const SIGHTLINES: SceneMethods = SceneMethods { sightlines: true, from_region: false, only_in_air: false };

pub(crate) fn info(options: &SceneBakeOptions<'_>, cut: &SceneSummary) -> Vec<(String, String)> {
    let portals = match options.portals {
        PortalMode::Bounding => "bounding",
        PortalMode::Exact => "exact",
    };
    let pair = |k: &str, v: String| (k.to_owned(), v);
    // Ascending keys.
    vec![
        pair("detail-below", cut.detail_below.to_string()),
        pair("portals", portals.to_owned()),
        pair("subdivide", "kd".to_owned()),
        pair("tau", options.cut.tau.to_string()),
    ]
}

/// The table of a subdivided scene and its visibility.
pub(crate) fn scene_table(
    graph: &CellGraph<Axial>,
    seen: SpaceVisibility,
    scene: &Scene,
    boxes: &[Aabb<3>],
    info: Vec<(String, String)>,
    mirrors: Vec<MirrorRecord>,
) -> Result<Table, TableError> {
    let cell = |id: CellId| {
        let Aabb { min, max } = graph.cell(id).bounds;
        CellRecord { min, max, group: None, polygon: Vec::new() }
    };
    let cells: Vec<CellRecord> = graph.cell_ids().map(cell).collect();
    let bounds: Vec<([f64; 3], [f64; 3])> = cells.iter().map(|c| (c.min, c.max)).collect();
    let object = |(o, b): (&sightlines_cells::SceneObject, &Aabb<3>)| {
        let b = if b.is_empty() { Aabb { min: [0.0; 3], max: [0.0; 3] } } else { *b };
        ObjectRecord { name: o.name.clone(), min: b.min, max: b.max }
    };
    Table::new(TableParts {
        portals: graph.portals().iter().map(portal_record).collect(),
        rows: seen.cells,
        objects: scene.objects().iter().zip(boxes).map(object).collect(),
        object_polygons: scene.objects().iter().map(n_triangles).collect(),
        cell_objects: seen.touching,
        objects_seen: Some(seen.objects),
        locator: Locator::build(&bounds, 3),
        cells,
        info,
        mirrors,
        ..TableParts::empty(3, TableKind::SceneKdTree { hidden_by: SIGHTLINES })
    })
}

/// The corners counter-clockwise as seen from the first cell: the normal by the right-hand rule points
/// towards the viewer.
pub(crate) fn portal_record(portal: &Portal<Axial>) -> PortalRecord {
    let AxialDoor { extent: Aabb { min, max }, axis, forward } = portal.shape;
    let a = usize::from(axis);
    let (b, c) = ((a + 1) % 3, (a + 2) % 3);
    let corner = |high_b: bool, high_c: bool| {
        let mut p = min;
        p[b] = if high_b { max[b] } else { min[b] };
        p[c] = if high_c { max[c] } else { min[c] };
        p
    };
    // With b towards c, the right-hand rule gives the axis; who crosses forwards stands on its low side.
    let mut points = vec![corner(false, false), corner(false, true), corner(true, true), corner(true, false)];
    if !forward {
        points.reverse();
    }
    PortalRecord { cells: portal.cells, sides: portal.sides, points }
}
