//! Tables of boxes, which have no portals: whatever a ray from the eye meets is in the answer of every method.

use sightlines::bake::region::grid;
use sightlines::bake::{CellsFrom, RegionBakeOptions, bake_regions};
use sightlines::cells::Scene;
use sightlines::eye_to_cell::{Doors, Method, Scratch, TableCells, View, VisibleSet, VisibleSubgraph};
use sightlines::formats::ViewCells;
use sightlines::geometry::Random;
use sightlines::geometry::vector::{length, scale};
use sightlines::multifocal::mesh::SheetMethod;
use sightlines::multifocal::{FromRegion, RaySampler};
use sightlines::pvs::{BitMatrix, CellId, CellRecord, Locator, ObjectId, ObjectRecord, Table, TableKind, TableParts};
use sightlines::scenes::{TowerOptions, tower};

fn table_of(scene: &Scene, cells: ViewCells) -> Table {
    let triangles: Vec<_> = scene.objects().iter().flat_map(|o| o.corners()).collect();
    let make = || Box::new(SheetMethod::new(&triangles)) as Box<dyn FromRegion + Send>;
    let cells = CellsFrom::Boxes(cells);
    let options = RegionBakeOptions { method: Some(&make), threads: 1, ..RegionBakeOptions::new(&cells) };
    bake_regions(scene, &options).expect("a tower can be baked").table
}

/// What a method has of what is seen from an eye in a cell: objects, and the number of cells.
fn ask(table: &Table, method: Method, cell: CellId, view: &View) -> (Vec<u32>, usize) {
    let subgraph = VisibleSubgraph::prepare(&TableCells::new(table), cell).expect("memory does not fail");
    let (mut scratch, mut seen) = (Scratch::new(), VisibleSet::new());
    seen.clear(table.n_cells(), table.objects().len());
    method.look(&subgraph, view, &Doors::all_open(), &mut scratch, &mut seen);
    let mut objects: Vec<u32> = seen.objects().iter().map(|o| o.0).collect();
    objects.sort_unstable();
    (objects, seen.cells().len())
}

#[test]
fn what_rays_meet_is_seen_from_boxes() {
    let options = TowerOptions { floors: 1, rooms_x: 2, rooms_y: 2, furniture: 1, ..TowerOptions::default() };
    let scene = tower(options).expect("in range");
    // Boxes that leave gaps between each other.
    let mut cells = grid(&scene.bounds(), [5, 1, 4]).expect("some cells");
    for cell in &mut cells.cells {
        for k in [0, 2] {
            let by = (cell.bounds.max[k] - cell.bounds.min[k]) / 8.0;
            cell.bounds.min[k] += by;
            cell.bounds.max[k] -= by;
        }
    }
    let table = table_of(&scene, cells.clone());
    assert!(table.portals().is_empty());
    let triangles: Vec<Vec<_>> = scene.objects().iter().map(|o| o.corners().collect()).collect();
    let witness = RaySampler::new(triangles.iter().map(Vec::as_slice));
    let mut random = Random::new(5);
    let (mut n_met, mut n_kept, mut n_all) = (0, 0, 0);
    for (id, cell) in (0u32..).zip(&cells.cells) {
        for _ in 0..4 {
            let eye = random.point(&cell.bounds);
            let mut dir = random.direction();
            dir[1] *= 0.2;
            let dir = scale(dir, 1.0 / length(dir));
            let view =
                View::perspective_horizontal(eye, dir, [0.0, 1.0, 0.0], 60f64.to_radians(), 1.5).expect("a view");
            let answers = Method::ALL.map(|method| ask(&table, method, CellId(id), &view));
            assert!(answers.windows(2).all(|w| w[0].0.len() >= w[1].0.len() && w[0].1 >= w[1].1), "each is no more");
            n_kept += answers[4].0.len();
            n_all += answers[0].0.len();
            for _ in 0..200 {
                // Within the view: near its middle.
                let away = random.direction();
                let way = std::array::from_fn(|k| dir[k] + 0.25 * away[k]);
                let Some(object) = witness.first_hit(eye, way) else { continue };
                n_met += 1;
                for (method, (objects, _)) in Method::ALL.iter().zip(&answers) {
                    assert!(objects.contains(&object), "{method}: {eye:?} {way:?} meets object {object}");
                }
            }
        }
    }
    assert!(n_met > 5000, "{n_met} rays met something");
    // And the view leaves much out.
    assert!(n_kept * 2 < n_all, "{n_kept} of {n_all}");
}

/// An object that reaches out of a box that is not in view, into a gap that is.
#[test]
fn objects_in_gaps_are_seen() {
    let cell =
        |x: f64, z: f64| CellRecord { min: [x, 0.0, z], max: [x + 1.0, 1.0, z + 1.0], group: None, polygon: vec![] };
    let mut parts = TableParts::empty(3, TableKind::Unspecified);
    parts.cells = vec![cell(0.0, 0.0), cell(4.0, 6.0), cell(9.0, 0.0)];
    parts.rows = BitMatrix::new(3, 3);
    for (a, b) in (0..3).flat_map(|a| (0..3).map(move |b| (a, b))) {
        parts.rows.set(a, b, true);
    }
    // A wall in front of the eye, which touches only the box that is aside of the view.
    parts.objects = vec![ObjectRecord { name: "wall".to_owned(), min: [4.0, 0.0, -8.0], max: [4.5, 1.0, 6.5] }];
    parts.cell_objects = vec![vec![], vec![ObjectId(0)], vec![]];
    parts.object_polygons = vec![];
    parts.locator = Locator::build(&parts.cell_bounds(), 3);
    let table = Table::new(parts).expect("a table");
    let eye = [0.5; 3];
    let view =
        View::perspective_horizontal(eye, [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], 40f64.to_radians(), 1.0).expect("a view");
    for method in Method::ALL {
        let (objects, n_cells) = ask(&table, method, CellId(0), &view);
        assert_eq!(objects, [0], "{method}");
        assert_eq!(n_cells, if method == Method::CellToCell { 3 } else { 2 }, "{method}");
    }
}
