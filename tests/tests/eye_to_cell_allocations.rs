//! Once warm, a query without mirrors allocates nothing.

use allocation_counter::measure;
use sightlines::bake::{
    PlanBakeOptions, SceneBakeOptions, StabOptions, bake_plan, bake_scene, from_table, with_stab_trees,
};
use sightlines::eye_to_cell::{Doors, Method, Scratch, TableCells, View, VisibleSet, VisibleSubgraph};
use sightlines::pvs::{CellId, Table};
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
                false => View::pinhole(eye, [cos, sin, 0.1], [0.0, 0.0, 1.0], 1.0 + k as f64, 1.5),
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
    doors.close(2);
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

#[test]
fn warm_queries_allocate_nothing() {
    let plan = maze(3, 7, 7).expect("a small maze");
    check("maze", bake_plan(&plan, &PlanBakeOptions::default()).expect("a plan").table);
    let options = TowerOptions { floors: 1, rooms_x: 2, rooms_y: 1, furniture: 1, ..TowerOptions::default() };
    let scene = tower(options).expect("a small tower");
    check("tower", bake_scene(&scene, &SceneBakeOptions::default()).expect("a scene").table);
}
