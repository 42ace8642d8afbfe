//! Once warm, a query without mirrors allocates nothing, and neither does the query of a point in a table.

use allocation_counter::measure;
use sightlines::bake::{
    PlanBakeOptions, SceneBakeOptions, StabOptions, bake_plan, bake_scene, from_table, with_stab_trees,
};
use sightlines::eye_to_cell::{Doors, Method, Scratch, TableCells, View, VisibleSet, VisibleSubgraph};
use sightlines::pvs::{CellId, Place, PlaceBuffer, PortalId, Table};
use sightlines::scenes::{TowerOptions, maze, tower};

/// Views into all directions, from the middle of each cell and from a corner of it.
fn frames(table: &Table) -> Vec<(CellId, View)> {
    let planar = table.dimension() == 2;
    let mut frames = Vec::new();
    for (id, cell) in (0u32..).map(CellId).zip(table.cells()).step_by(3) {
        let middle = [0, 1, 2].map(|k| 0.5 * (cell.min[k] + cell.max[k]));
        for (k, eye) in [middle, cell.min].into_iter().enumerate() {
            let (sin, cos) = f64::from(id.0 + k as u32).sin_cos();
            let view = match planar {
                true => View::planar([eye[0], eye[1]], [cos, sin], 1.0 + 4.0 * k as f64),
                false => View::perspective_horizontal(eye, [cos, sin, 0.1], [0.0, 0.0, 1.0], 1.0 + k as f64, 1.5),
            };
            frames.push((id, view.expect("numbers in their ranges")));
            frames.push((id, View::all_round(eye).expect("a finite eye")));
        }
    }
    frames
}

/// Rounds of all frames before allocations count: lists that change places from query to query need more than one.
const WARM_UP: usize = 3;

/// The allocations of all methods for all frames, after they have been asked before: by the queries, and by
/// preparing the subgraph, which has to allocate.
fn allocations(table: &Table) -> (usize, u64, u64) {
    let cells = TableCells::new(table);
    let frames = frames(table);
    let (mut seen, mut scratch, mut doors) = (VisibleSet::new(), Scratch::new(), Doors::all_open());
    doors.close(PortalId(2));
    let prepare = |root| VisibleSubgraph::prepare(&cells, root).unwrap_or_else(|never| match never {});
    let (mut n_queries, mut by_queries, mut by_preparing) = (0, 0, 0);
    for round in 0..=WARM_UP {
        for (root, view) in &frames {
            let mut subgraph = None;
            let preparing = measure(|| subgraph = Some(prepare(*root)));
            let subgraph = subgraph.expect("it was prepared");
            for method in Method::ALL {
                let query = measure(|| {
                    seen.clear(table.n_cells(), table.objects().len());
                    method.look(&subgraph, view, &doors, &mut scratch, &mut seen);
                    seen.sort();
                });
                if round == WARM_UP {
                    n_queries += 1;
                    by_queries += query.count_total;
                }
            }
            by_preparing += preparing.count_total;
        }
    }
    (n_queries, by_queries, by_preparing)
}

fn check(name: &str, table: Table) {
    let stab = StabOptions { max_nodes: Some(1_000), ..StabOptions::default() };
    let trees = with_stab_trees(table.clone(), &from_table::graph(&table).expect("the table stores its graph"), &stab)
        .expect("the table has its geometry")
        .table;
    for table in [table, trees] {
        let (n_queries, by_queries, by_preparing) = allocations(&table);
        assert_eq!(by_queries, 0, "{name}, {n_queries} queries");
        // The impostor: what does allocate is counted.
        assert!(n_queries > 100 && by_preparing > 100, "{name}: {n_queries} {by_preparing}");
    }
}

/// Asks a table at the middle of each cell and outside, twice; the allocations of the second round with a buffer, and of the form that
/// has none.
fn point_allocations(table: &Table) -> [u64; 2] {
    let (mut buffer, mut objects) = (PlaceBuffer::new(), Vec::new());
    let middle = |cell: &sightlines::pvs::CellRecord| std::array::from_fn(|k| 0.5 * (cell.min[k] + cell.max[k]));
    let mut points: Vec<[f64; 3]> = table.cells().iter().map(middle).collect();
    points.push([f64::MAX, 0.0, 0.0]);
    let (mut with, mut without) = (0, 0);
    for round in 0..2 {
        let mut n_outside = 0;
        for &point in &points {
            let mut n_cells = 0;
            let counted = measure(|| match table.place_at_with(point, &mut buffer) {
                Place::Inside(here) => {
                    n_cells = here.visible_cells().count();
                    here.visible_objects_into(&mut objects);
                }
                Place::Outside => n_outside += 1,
            });
            let allocating = measure(|| assert_eq!(table.place_at(point).is_outside(), n_cells == 0));
            if round == 1 {
                with += counted.count_total;
                without += allocating.count_total;
            }
        }
        assert!(n_outside >= 1 && n_outside < points.len());
    }
    [with, without]
}

#[test]
fn warm_queries_of_points_allocate_nothing() {
    let plan = maze(3, 7, 7).expect("a small maze");
    let options = TowerOptions { floors: 1, rooms_x: 2, rooms_y: 1, furniture: 1, ..TowerOptions::default() };
    let scene = tower(options).expect("a small tower");
    let tables = [
        bake_plan(&plan, &PlanBakeOptions::default()).expect("a plan").table,
        bake_scene(&scene, &SceneBakeOptions::default()).expect("a scene").table,
    ];
    for table in tables {
        let [with, without] = point_allocations(&table);
        // The impostor: the form without a buffer allocates, and that is counted.
        assert!(with == 0 && without > 10, "{with} {without}");
    }
}

#[test]
fn warm_queries_allocate_nothing() {
    let plan = maze(3, 7, 7).expect("a small maze");
    check("maze", bake_plan(&plan, &PlanBakeOptions::default()).expect("a plan").table);
    let options = TowerOptions { floors: 1, rooms_x: 2, rooms_y: 1, furniture: 1, ..TowerOptions::default() };
    let scene = tower(options).expect("a small tower");
    check("tower", bake_scene(&scene, &SceneBakeOptions::default()).expect("a scene").table);
}
