//! Tables of every kind, with the scenes that they are of.

use sightlines_bake::{
    CellsFrom, PlanBakeOptions, PrtOptions, RegionBakeOptions, SceneBakeOptions, StabOptions, Subdivide, bake_plan,
    bake_prt, bake_regions, bake_scene,
};
use sightlines_cells::{CellGraph, Convex, LineId, Plan, PlanObject, Scene};
use sightlines_formats::{Prt, ViewCell, ViewCells};
use sightlines_geometry::{Aabb, Point3};
use sightlines_multifocal::mesh::{PatchOptions, patches};
use sightlines_multifocal::{FromRegion, Layout, Multifocal, OccluderSelection};
use sightlines_multifocal_cpu::Fast;
use sightlines_pvs::{Locator, Table, TableKind, TableParts};
use sightlines_scenes::world::WorldChild as Child;
use sightlines_scenes::{
    OfficeOptions, QuakeLikeOptions, TowerOptions, World, doom_like, maze, office, quake_like, tower,
    turned_pillared_hall,
};
use sightlines_verify::{Findings, MapChild, MapNode, MapTree, Truth, VerifyOptions, verify};
use std::ops::Deref;
use std::sync::{Arc, LazyLock};

/// The scene of a table.
pub(crate) enum Real {
    Plan(Plan),
    Scene(Scene),
    Portals(CellGraph<Convex>),
    Map(CellGraph<Convex>, MapTree),
}

impl Real {
    pub(crate) fn truth(&self) -> Truth<'_> {
        match self {
            Self::Plan(plan) => Truth::Plan(plan),
            Self::Scene(scene) => Truth::Scene(scene),
            Self::Portals(graph) => Truth::Portals(graph),
            Self::Map(graph, tree) => Truth::World(graph, tree),
        }
    }
}

/// A table, with its scene and the least share of flipped pairs that has to be caught.
pub(crate) struct Case {
    pub(crate) name: &'static str,
    pub(crate) table: Table,
    pub(crate) real: Real,
    /// Of cells and of objects. Multifocal buffers show much that is hidden, and no ray can find that.
    pub(crate) least_caught: [f64; 2],
}

/// Options that suit tests: few random rays, all hidden pairs, and no random segments.
pub(crate) fn quick() -> VerifyOptions<'static> {
    VerifyOptions { rays: 4_000, pairs: 3_000, segments: 0, ..VerifyOptions::default() }
}

/// Checks a table without its digests, which tell of every change of a scene, and nothing else.
pub(crate) fn check(table: &Table, real: &Real, options: &VerifyOptions<'_>) -> Findings {
    verify(&table.clone().with_digest(None), &real.truth(), options).expect("a table of this kind of scene")
}

fn plan_case(name: &'static str, plan: Plan, subdivide: Subdivide) -> Case {
    let baked = bake_plan(&plan, &PlanBakeOptions { subdivide, ..PlanBakeOptions::default() }).expect("a plan");
    Case { name, table: baked.table, real: Real::Plan(plan), least_caught: [1.0, 1.0] }
}

/// The same plan with boxes strewn over it.
fn with_objects(plan: &Plan) -> Plan {
    let b = plan.bounds();
    let at = |k: usize, share: f64| b.min[k] + (b.max[k] - b.min[k]) * share;
    let object = |i: u32| {
        let (x, y) = (f64::from(i * 37 % 101) / 101.0, f64::from(i * 61 % 97) / 97.0);
        let size = f64::from(i % 3) * 0.5;
        let min = [at(0, x), at(1, y)];
        PlanObject { name: format!("thing {i}"), bounds: Aabb { min, max: min.map(|c| c + size) } }
    };
    Plan::new(plan.lines().to_vec(), (0..20).map(object).collect()).expect("boxes inside")
}

pub(crate) fn an_office() -> Plan {
    with_objects(&office(OfficeOptions { rooms_x: 4, rooms_y: 3, ..OfficeOptions::default() }).expect("an office"))
}

pub(crate) fn small_tower() -> Scene {
    let options = TowerOptions { floors: 1, rooms_x: 2, rooms_y: 1, furniture: 1, ..TowerOptions::default() };
    tower(options).expect("a tower")
}

fn space_case() -> Case {
    let scene = small_tower();
    let table = bake_scene(&scene, &SceneBakeOptions::default()).expect("a scene").table;
    Case { name: "tower by sightlines", table, real: Real::Scene(scene), least_caught: [0.75, 0.75] }
}

/// A few boxes in a scene, by multifocal buffers, with sightlines besides or without.
fn grid_case(name: &'static str, sightlines: bool) -> Case {
    let scene = small_tower();
    let bounds = scene.bounds();
    let side = |k: usize, i: usize, n: usize| bounds.min[k] + (bounds.max[k] - bounds.min[k]) * i as f64 / n as f64;
    let (nx, nz) = (4, 4);
    let cell = |k: usize| {
        let (i, j) = (k % nx, k / nx);
        let min = [side(0, i, nx), bounds.min[1], side(2, j, nz)];
        let max = [side(0, i + 1, nx), side(1, 1, 2), side(2, j + 1, nz)];
        ViewCell { id: format!("box {k}"), bounds: Aabb { min, max } }
    };
    let cells = CellsFrom::Boxes(ViewCells { cells: (0..nx * nz).map(cell).collect(), axes: None });
    let triangles: Vec<[Point3; 3]> = scene.objects().iter().flat_map(|o| o.corners()).collect();
    let chosen = Arc::new(OccluderSelection::new(patches(&triangles, &PatchOptions::default()), 40));
    let layout = Layout { planes: 3, texels: 48, ..Layout::default() };
    let make = || -> Box<dyn FromRegion + Send> {
        Box::new(Multifocal::new(Fast::new(), Arc::clone(&chosen), bounds, layout))
    };
    let options = RegionBakeOptions { method: Some(&make), sightlines, ..RegionBakeOptions::new(&cells) };
    let table = bake_regions(&scene, &options).expect("boxes").table;
    Case { name, table, real: Real::Scene(scene), least_caught: [0.75, 0.4] }
}

pub(crate) fn a_world() -> World {
    quake_like(QuakeLikeOptions { seed: 3, rooms_x: 2, rooms_y: 2, floors: 1 }).expect("a level")
}

fn a_portal_file() -> Prt {
    let world = a_world();
    let mut prt = Prt::new(world.graph.n_cells() as u32).expect("cells");
    for portal in world.graph.portals() {
        prt.push_portal(portal.cells.map(|c| c.0), portal.shape.corners()).expect("convex");
    }
    prt
}

pub(crate) fn portals_case() -> Case {
    let prt = a_portal_file();
    let table = bake_prt(&prt, PrtOptions::default()).expect("portals").table;
    let graph = sightlines_formats::quake::graph_of_prt(&prt);
    Case { name: "portal file", table, real: Real::Portals(graph), least_caught: [0.75, 1.0] }
}

/// The same world as a map: with its tree of planes, and the boxes of its leafs.
pub(crate) fn map_case() -> Case {
    let Case { table, real, .. } = portals_case();
    let Real::Portals(graph) = real else { panic!("portals") };
    let world = a_world();
    let child = |c: Child| match c {
        Child::Node(node) => MapChild::Node(node as u32),
        Child::Leaf(leaf) => world.leafs[leaf].cell.map_or(MapChild::Solid, |cell| MapChild::Cluster(cell.0)),
    };
    let node = |n: &sightlines_scenes::world::WorldNode| MapNode {
        normal: world.planes[n.plane].normal.map(f64::from),
        distance: world.planes[n.plane].offset,
        children: n.children.map(child),
    };
    let nodes = world.nodes.iter().map(node).collect();
    let mut parts: TableParts = table.into_parts();
    parts.kind = TableKind::QuakeMap;
    for (cell, leaf) in world.cells().iter().enumerate() {
        let around = Aabb::<3>::around(leaf.faces.iter().flatten().copied());
        (parts.cells[cell].min, parts.cells[cell].max) = (around.min, around.max);
    }
    parts.locator = Locator::build(&parts.cell_bounds(), 3);
    let table = Table::new(parts).expect("boxes around leafs");
    let listed = vec![Vec::new(); table.n_cells()];
    let tree = MapTree { nodes, faces: Vec::new(), listed };
    Case { name: "map", table, real: Real::Map(graph, tree), least_caught: [0.75, 1.0] }
}

/// Tables with stab trees.
pub(crate) fn with_trees() -> Vec<(&'static str, Table, Real)> {
    let options = StabOptions::default();
    let plan = an_office();
    let of_plan = bake_plan(&plan, &PlanBakeOptions::default()).expect("a plan").into_any().with_stab_trees(&options);
    let scene = small_tower();
    let of_scene =
        bake_scene(&scene, &SceneBakeOptions::default()).expect("a scene").into_any().with_stab_trees(&options);
    let prt = a_portal_file();
    let of_prt = bake_prt(&prt, PrtOptions::default()).expect("portals").into_any().with_stab_trees(&options);
    let graph = sightlines_formats::quake::graph_of_prt(&prt);
    vec![
        ("office with trees", of_plan.expect("trees").0.table, Real::Plan(plan)),
        ("tower with trees", of_scene.expect("trees").0.table, Real::Scene(scene)),
        ("portal file with trees", of_prt.expect("trees").0.table, Real::Portals(graph)),
    ]
}

/// Tables with mirrors: every seventh line of a plan, and every second box of a building.
pub(crate) fn with_mirrors() -> Vec<Case> {
    let plan = an_office();
    let lines = (0..plan.lines().len() as u32).filter(|&line| plan.lines()[line as usize].opaque).step_by(7);
    let lines: Vec<LineId> = lines.map(LineId).collect();
    let plan = plan.with_mirrors(lines).expect("opaque lines");
    let scene = small_tower();
    let is_box = |&object: &u32| {
        let (b, o) = (scene.extent(object), &scene.objects()[object as usize]);
        let is_corner = |p: &Point3| (0..3).all(|k| p[k] == b.min[k] || p[k] == b.max[k]);
        scene.is_opaque(object) && o.triangles.len() == 12 && o.corners().flatten().all(|p| is_corner(&p))
    };
    let objects: Vec<u32> = (0..scene.objects().len() as u32).filter(is_box).step_by(2).collect();
    let scene = scene.clone().with_mirrors(objects).expect("objects");
    let table = bake_scene(&scene, &SceneBakeOptions::default()).expect("a scene").table;
    vec![
        plan_case("office with mirrors, by k-d tree", plan.clone(), Subdivide::KdTree),
        plan_case("office with mirrors, by triangulation", plan, Subdivide::Triangulation),
        Case { name: "tower with mirrors", table, real: Real::Scene(scene), least_caught: [1.0; 2] },
    ]
}

/// A table of each kind, made once for all tests.
static CASES: [LazyLock<Case>; 10] = [
    LazyLock::new(|| plan_case("office by k-d tree", an_office(), Subdivide::KdTree)),
    LazyLock::new(|| plan_case("office by triangulation", an_office(), Subdivide::Triangulation)),
    LazyLock::new(|| plan_case("maze", maze(5, 6, 6).expect("a maze"), Subdivide::Auto)),
    LazyLock::new(|| plan_case("Doom-like map", doom_like(2, 3).expect("a map"), Subdivide::Auto)),
    LazyLock::new(|| plan_case("turned pillars", turned_pillared_hall(1, 4, 3).expect("a hall"), Subdivide::Auto)),
    LazyLock::new(space_case),
    LazyLock::new(|| grid_case("boxes by multifocal buffers", false)),
    LazyLock::new(|| grid_case("boxes by both", true)),
    LazyLock::new(portals_case),
    LazyLock::new(map_case),
];

pub(crate) fn cases() -> impl Iterator<Item = &'static Case> {
    CASES.iter().map(LazyLock::deref)
}

/// What is found in these tables, which are true, with many random rays: made once.
pub(crate) fn checked() -> &'static [(&'static Case, Findings)] {
    static CHECKED: LazyLock<Vec<(&'static Case, Findings)>> = LazyLock::new(|| {
        let options = VerifyOptions { rays: 20_000, ..quick() };
        cases().map(|case| (case, check(&case.table, &case.real, &options))).collect()
    });
    &CHECKED
}

/// The table with other parts.
pub(crate) fn changed(table: &Table, change: impl FnOnce(&mut TableParts)) -> Table {
    let mut parts = table.parts().clone();
    change(&mut parts);
    Table::new(parts).expect("the format allows it")
}
