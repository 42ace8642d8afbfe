//! Bakes with a budget: whenever it is spent, the table hides nothing that it shows without one, and nothing that a ray reaches.

use sightlines_bake::auto::own_cells;
use sightlines_bake::methods::OcclusionMethod;
use sightlines_bake::places::PlaceOptions;
use sightlines_bake::{BakeRequest, BufferRequest, CellsFrom, LimitReport, Report, Runtime, SceneMethod};
use sightlines_cells::{Scene, SceneObject};
use sightlines_geometry::{Aabb, Point3, Random};
use sightlines_multifocal::{RaySampler, Split};
use sightlines_packed::Packed;
use sightlines_progress::Budget;
use sightlines_pvs::{BitMatrix, Table, TableParts};
use sightlines_scenes::{TowerOptions, tower};
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

/// Spends one part of `n` each time that it is asked.
fn calls(n: u64) -> impl Fn() -> f64 + Sync {
    let asked = AtomicU64::new(0);
    move || asked.fetch_add(1, Relaxed) as f64 / n as f64
}

/// A floor with walls along axes, and with windows; or without, turned about z by a rotation with rational cosine.
pub(crate) fn building(turned: bool) -> Scene {
    let floor = TowerOptions { floors: 1, rooms_x: 3, rooms_y: 2, furniture: 0, ..TowerOptions::default() };
    let upright = tower(TowerOptions { windows: !turned, ..floor });
    let turn = |p: &Point3| if turned { [0.8 * p[0] - 0.6 * p[1], 0.6 * p[0] + 0.8 * p[1], p[2]] } else { *p };
    let object = |o: &SceneObject| SceneObject { vertices: o.vertices.iter().map(turn).collect(), ..o.clone() };
    Scene::new(upright.expect("a tower").objects().iter().map(object).collect()).expect("a scene")
}

/// What a bake makes within a budget.
type Made = (Table, Option<LimitReport>);
type Bake = fn(&Scene, &BakeRequest, Option<&dyn Budget>) -> Made;

/// Small buffers and few rays: how long one cell takes does not matter here.
fn made_small(options: &BakeRequest) -> BakeRequest {
    let mut options = options.clone();
    if options.method != Some(SceneMethod::Sightlines) {
        options.split = Some(Split { n_rays: 1024, ..Split::default() });
    }
    let without = [SceneMethod::Sightlines, SceneMethod::Auto, SceneMethod::FromRegion(OcclusionMethod::LineSpace)];
    if options.method.is_none_or(|method| !without.contains(&method)) {
        options.buffers = BufferRequest { planes: Some(1), texels: Some(32), ..BufferRequest::default() };
    }
    options
}

/// A table that is written row by row.
fn by_rows(scene: &Scene, options: &BakeRequest, budget: Option<&dyn Budget>) -> Made {
    let runtime = Runtime { budget, threads: 1, ..Runtime::default() };
    let (scene, options) = (scene.clone(), made_small(options));
    let prepared = options.prepare(&scene, &runtime).expect("good options");
    let (bytes, report, _) = prepared.run_packed(Vec::new(), &runtime).expect("a packed table");
    let packed = Packed::open(bytes, 1 << 20).expect("a sound table");
    (packed.to_table().expect("a sound table"), report.limit)
}

fn baked(scene: &Scene, options: &BakeRequest, budget: Option<&dyn Budget>) -> Made {
    let runtime = Runtime { budget, threads: 1, ..Runtime::default() };
    let baked = runtime.bake(scene, &made_small(options)).expect("a table");
    let limit = match &baked.report {
        Report::Scene(report) => report.limit,
        Report::Regions(report) => report.limit,
        _ => None,
    };
    (baked.table, limit)
}

/// Pairs of cells, and of a cell and an object, that the table shows.
fn visible(table: &Table) -> [&BitMatrix; 2] {
    [&table.parts().rows, table.parts().objects_seen.as_ref().expect("objects are seen")]
}

/// Pairs that one table shows and another, with the same cells, hides.
fn hidden_by(full: &Table, limited: &Table) -> u64 {
    assert_eq!(full.cells(), limited.cells());
    let pairs = visible(full).into_iter().zip(visible(limited));
    pairs
        .map(|(a, b)| {
            (0..a.n_rows()).map(|row| a.iter_ones(row).filter(|&col| !b.get(row, col)).count() as u64).sum::<u64>()
        })
        .sum()
}

/// Objects that rays from anywhere in a cell hit first, and that a table hides there; and how many rays hit.
fn hidden_wrongly(scene: &Scene, table: &Table) -> (usize, usize) {
    let objects: Vec<Vec<[Point3; 3]>> = scene.objects().iter().map(|o| o.corners().collect()).collect();
    let rays = RaySampler::new(objects.iter().map(|o| &o[..]));
    let mut random = Random::new(1);
    let (mut wrong, mut n_hits) = (0, 0);
    for (cell, record) in table.cells().iter().enumerate() {
        let b = Aabb { min: record.min, max: record.max };
        for _ in 0..80 {
            if let Some(object) = rays.first_hit(random.point(&b), random.direction()) {
                n_hits += 1;
                wrong += usize::from(!visible(table)[1].get(cell, object as usize));
            }
        }
    }
    (wrong, n_hits)
}

/// The table without what no decision stands for: what would result if the undecided counted as hidden.
fn impostor(full: &Table, zero: &Table) -> Table {
    let mut parts: TableParts = zero.parts().clone();
    let seen = parts.objects_seen.as_mut().expect("objects are seen");
    for cell in 0..seen.n_rows() {
        let touching: Vec<usize> = parts.cell_objects[cell].iter().map(|o| o.0 as usize).collect();
        (0..seen.n_cols()).filter(|o| !touching.contains(o)).for_each(|o| seen.set(cell, o, false));
    }
    assert!(full.cells() == zero.cells());
    Table::new(parts).expect("the parts fit together")
}

fn check(name: &str, scene: &Scene, options: &BakeRequest) {
    check_made(name, scene, options, baked);
}

fn check_made(name: &str, scene: &Scene, options: &BakeRequest, baked: Bake) {
    let (full, none) = baked(scene, options, None);
    assert!(none.is_none() && full.info_value("time-limit").is_none(), "{name}");
    let (wrong, n_hits) = hidden_wrongly(scene, &full);
    assert!(wrong == 0 && n_hits > 300, "{name}: {wrong} of {n_hits}");
    let mut looser = Vec::new();
    for n in [0, 3, 40, 300, 2_000, 20_000] {
        let (limited, limit) = baked(scene, options, Some(&calls(n)));
        assert_eq!(hidden_by(&full, &limited), 0, "{name}, after {n} questions");
        let n_more = hidden_by(&limited, &full);
        looser.push(n_more);
        if let Some(limit) = limit {
            assert_eq!(limited.info_value("time-limit"), Some(limit.to_string().as_str()), "{name}");
            assert!(2 * limit.n_cell_pairs + limit.n_object_pairs >= n_more, "{name}: all that is looser is stated");
            let n_cells = limit.n_cells_decided + limit.n_cells_in_part + limit.n_cells_undecided;
            assert_eq!(n_cells, full.n_cells(), "{name}");
        } else {
            assert_eq!(n_more, 0, "{name}");
        }
        if n == 0 {
            let limit = limit.expect("nothing was decided");
            assert!(limit.n_cells_undecided > 0 && n_more > 0, "{name}: {limit}");
            // The impostor, which both checks notice.
            let wrong = impostor(&full, &limited);
            assert!(hidden_by(&full, &wrong) > 0 && hidden_wrongly(scene, &wrong).0 > 0, "{name}");
        }
    }
    // Tight: who may spend more decides more.
    assert!(looser[5] < looser[0], "{name}: {looser:?}");
    let (whole, limit) = baked(scene, options, Some(&calls(1 << 50)));
    assert!(limit.is_none(), "{name}");
    assert_eq!(whole.to_bytes(), full.to_bytes(), "{name}: nothing was limited");
}

fn by(method: SceneMethod) -> BakeRequest {
    BakeRequest { method: Some(method), ..BakeRequest::default() }
}

#[test]
fn rooms_along_walls_by_sightlines() {
    check("rooms", &building(false), &by(SceneMethod::Sightlines));
}

#[test]
fn rooms_along_walls_by_both_methods() {
    check("rooms, both", &building(false), &by(SceneMethod::Both));
}

#[test]
fn boxes_by_sightlines_and_from_regions() {
    for method in [SceneMethod::Sightlines, SceneMethod::Auto] {
        let turned = method == SceneMethod::Auto;
        let cells = Some(CellsFrom::Grid(if turned { [4, 3, 1] } else { [5, 4, 1] }));
        check("boxes", &building(turned), &BakeRequest { cells, ..by(method) });
    }
}

/// Places are cut in full, however little may be spent, so that the limit does not change which cells there are.
#[test]
fn places_by_both_methods() {
    let scene = building(true);
    assert_ne!(own_cells(&scene, true), CellsFrom::KdTree);
    let cells = Some(CellsFrom::Places(PlaceOptions { n_cells: Some(30), cell_size: None }));
    let method = SceneMethod::FromRegion(OcclusionMethod::Multifocal);
    check("places by one method", &scene, &BakeRequest { cells: cells.clone(), ..by(method) });
    check("places", &scene, &BakeRequest { cells, ..by(SceneMethod::Auto) });
}

/// Row by row, whether walls have one side or two.
#[test]
fn tables_row_by_row_keep_to_a_budget() {
    let scene = building(true);
    let cells = Some(CellsFrom::Grid([4, 3, 1]));
    let options = BakeRequest { cells, ..by(SceneMethod::FromRegion(OcclusionMethod::LineSpace)) };
    check_made("rows", &scene, &options, by_rows);
    let all = (0..scene.objects().len() as u32).collect();
    check_made("rows, one side", &scene.with_front_occluders(all).expect("objects of it"), &options, by_rows);
}
