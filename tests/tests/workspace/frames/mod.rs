//! Buildings that stand at an angle to the axes of their file: their tables against those of the same buildings upright, and
//! against rays in the scene as the file has it.

mod cells;
mod gaps;

use sightlines::bake::{BakeRequest, Baked, CellsFrom, Framed, Gap, Runtime, SceneMethod, bake};
use sightlines::cells::{Point3, Scene, SceneObject};
use sightlines::eye_to_cell::{Doors, Method, Scratch, TableCells, View, VisibleSet, VisibleSubgraph};
use sightlines::formats::scene::read_scene;
use sightlines::formats::{ViewCell, ViewCells};
use sightlines::geometry::Aabb;
use sightlines::pvs::{ObjectId, Table};
use sightlines::scenes::{TowerOptions, tower, tower_rooms};
use sightlines::simplify::{HiddenBy, LevelOptions, SimplifyError, ViewsError, levels};
use sightlines::verify::{Truth, VerifyOptions, along_frame, check_walls_in_space, verify};
use sightlines_testkit::rays::RayScene;
use sightlines_tests::data_folder;
use sightlines_tests::scenes::scene_witness;

const SMALL: TowerOptions =
    TowerOptions { seed: 1, floors: 1, rooms_x: 2, rooms_y: 1, furniture: 1, windows: true, wall_thickness: 0.25 };

fn small_tower() -> Scene {
    tower(SMALL).unwrap()
}

type Rows = [Point3; 3];

/// About y by an angle, then about x by another, in degrees.
fn rotation(about_y: f64, about_x: f64) -> Rows {
    let ((s, c), (t, d)) = (about_y.to_radians().sin_cos(), about_x.to_radians().sin_cos());
    [[c, 0.0, s], [t * s, d, -t * c], [-d * s, t, d * c]]
}

fn turn(rows: &Rows, p: Point3) -> Point3 {
    rows.map(|row| row[0] * p[0] + row[1] * p[1] + row[2] * p[2])
}

/// The scene as a file has it whose program turned the building, and rounded it to single precision.
fn turned(scene: &Scene, rows: &Rows) -> Scene {
    let round = |p: &Point3| turn(rows, *p).map(|x| f64::from(x as f32));
    let object = |o: &SceneObject| SceneObject { vertices: o.vertices.iter().map(round).collect(), ..o.clone() };
    Scene::new(scene.objects().iter().map(object).collect()).unwrap()
}

/// 16 units of rounding of the largest coordinate in single precision.
fn gap_of(scene: &Scene) -> f64 {
    let b = scene.bounds();
    b.min.iter().chain(&b.max).fold(0.0f64, |m, x| m.max(x.abs())) / f64::from(1 << 20)
}

/// With a size of detail that no object has to within rounding.
fn with(gap: Gap) -> BakeRequest {
    BakeRequest { gap, method: Some(SceneMethod::Sightlines), detail_below: Some(1.1), ..BakeRequest::default() }
}

fn n_pairs(table: &Table) -> u64 {
    let n = (0..table.n_cells() as u32).map(|cell| table.visible(sightlines::pvs::CellId(cell)).count() as u64);
    n.sum()
}

fn n_violations(baked: &Baked, scene: &Scene) -> usize {
    let options = VerifyOptions { rays: 4000, pairs: 400, tries: 64, seed: 7, threads: 2, ..VerifyOptions::default() };
    verify(&baked.table, &Truth::Scene(scene), &options).unwrap().by_kind.values().sum()
}

/// Turns by all kinds of angles.
const TURNS: [(f64, f64); 5] = [(0.000_06, 0.0), (17.0, 0.0), (45.0, 0.0), (90.0, 0.0), (-33.0, 7.0)];

/// How often rays from boxes of eyes in the scene hit something first, and how often the table hides that from all cells that
/// the box touches.
fn hidden_hits(table: &Table, scene: &Scene, eyes: &[Aabb<3>]) -> (usize, usize) {
    let rays = RayScene::new(scene);
    let (mut n, mut n_hidden) = (0, 0);
    for (seed, eye) in (0..).zip(eyes) {
        let (mut shown, mut n_cells) = (vec![false; table.objects().len()], 0);
        table.for_each_touching(eye.min, eye.max, &mut Vec::new(), |cell| {
            table.visible_objects(cell).iter().for_each(|o| shown[o.idx()] = true);
            n_cells += 1;
            true
        });
        if n_cells == 0 {
            // Outside of every cell everything may be seen.
            shown.fill(true);
        }
        for object in rays.witness_objects(*eye, seed, 1500) {
            n += 1;
            n_hidden += usize::from(!shown[object as usize]);
        }
    }
    (n, n_hidden)
}

/// Boxes of eyes inside of the rooms of the tower, as it is turned.
fn eyes(rows: &Rows) -> Vec<Aabb<3>> {
    let near = |b: &Aabb<3>| {
        let middle = turn(rows, std::array::from_fn(|k| 0.4 * b.min[k] + 0.6 * b.max[k]));
        Aabb { min: middle.map(|x| x - 0.3), max: middle.map(|x| x + 0.3) }
    };
    tower_rooms(SMALL).unwrap().iter().map(|room| near(&room.bounds)).collect()
}

/// Invariant: the table of a turned building is that of one that stands along the axes: within 5 % as many pairs and cells. What rays see in the file's own
/// scene it shows, and `verify` finds nothing against it. The same bytes with any number of threads.
#[test]
fn turned_towers_are_as_good_as_upright_ones() {
    let upright = small_tower();
    // By a quarter, exactly: the cells of such a building are cut in another order.
    let quarter = turned(&upright, &[[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]);
    let plain = [&upright, &quarter].map(|scene| bake(scene, &with(Gap::Width(0.0))).unwrap().table);
    assert!(plain.iter().all(|table| table.frame().is_none()));
    let sizes = plain.each_ref().map(|table| [table.n_cells() as u64, n_pairs(table)]);
    let mut n_seen = 0;
    for (y, x) in TURNS {
        let rows = rotation(y, x);
        let scene = turned(&upright, &rows);
        let baked = bake(&scene, &with(Gap::Width(gap_of(&scene)))).unwrap();
        // A quarter needs no frame.
        assert!(baked.table.frame().is_some() || y == 90.0, "{y} {x}");
        let size = [baked.table.n_cells() as u64, n_pairs(&baked.table)];
        let is_near = |of: &[u64; 2]| (0..2).all(|k| size[k].abs_diff(of[k]) * 20 <= of[k]);
        assert!(sizes.iter().any(is_near), "{y} {x}: {size:?} cells and pairs, upright {sizes:?}");
        let (n, n_hidden) = hidden_hits(&baked.table, &scene, &eyes(&rows));
        assert_eq!(n_hidden, 0, "{y} {x}");
        n_seen += n;
        assert_eq!(n_violations(&baked, &scene), 0, "{y} {x}");
        let again =
            Runtime { threads: 1, ..Runtime::default() }.bake(&scene, &with(Gap::Width(gap_of(&scene)))).unwrap();
        assert_eq!(again.table.to_bytes(), baked.table.to_bytes(), "{y} {x}");
    }
    assert!(n_seen > 100, "{n_seen} hits");
}

/// The twin: without the premise nearly nothing of a turned building hides anything.
#[test]
fn without_a_frame_little_is_hidden() {
    let scene = turned(&small_tower(), &rotation(8.0, 0.0));
    let exact = bake(&scene, &with(Gap::Width(0.0))).unwrap().table;
    assert!(exact.frame().is_none());
    let framed = bake(&scene, &with(Gap::Width(gap_of(&scene)))).unwrap().table;
    // Of all cells, with that of the viewer.
    let share = |table: &Table| {
        let n = table.n_cells() as f64;
        (1.0 + (n - 1.0) * table.mean_visible_share()) / n
    };
    let shares = [share(&exact), share(&framed)];
    assert!(shares[0] > 2.0 * shares[1], "{shares:?}");
}

/// Proofs and walls: the borders of the cells of a turned building are covered by its walls, along the frame, exactly.
#[test]
fn walls_of_turned_cells_are_covered() {
    let scene = turned(&small_tower(), &rotation(17.0, 0.0));
    let baked = bake(&scene, &with(Gap::Width(gap_of(&scene)))).unwrap();
    let (table, along) = along_frame(&baked.table, &scene).unwrap().expect("it has a frame");
    let walls = check_walls_in_space(&table, &along);
    assert!(walls.n_bare == 0 && walls.n_walls > 100, "{walls:?}");
}

/// A hall, divided by a wall with a slit, and a thing at either end.
fn slit(width: f64) -> Scene {
    let block = |name: &str, min: Point3, max: Point3| {
        let corner = |i: usize| -> Point3 { std::array::from_fn(|k| if i >> k & 1 == 0 { min[k] } else { max[k] }) };
        let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let triangles = sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        SceneObject { name: name.to_owned(), vertices: (0..8).map(corner).collect(), triangles }
    };
    let mut shell = block("shell", [0.0; 3], [12.0, 4.0, 3.0]);
    shell.triangles.iter_mut().for_each(|t| t.swap(0, 1));
    let things =
        [block("west", [1.0, 0.75, 1.0], [2.0, 2.25, 2.0]), block("east", [10.0, 0.75, 1.0], [11.0, 2.25, 2.0])];
    let walls =
        [block("low", [6.0, 0.0, 0.0], [6.5, 1.5, 3.0]), block("high", [6.0, 1.5 + width, 0.0], [6.5, 4.0, 3.0])];
    Scene::new([vec![shell], things.to_vec(), walls.to_vec()].concat()).unwrap()
}

/// Levels are made along the frame: of a table without it and the scene along it. The table with its frame is refused.
#[test]
fn levels_are_made_along_the_frame() {
    let scene = turned(&slit(0.25), &rotation(20.0, 0.0));
    let framed = bake(&scene, &with(Gap::Width(1e-4))).unwrap().table;
    let (table, along) = along_frame(&framed, &scene).unwrap().expect("it has a frame");
    let (by, options) = (HiddenBy { method: None, table: None }, LevelOptions::default());
    assert!(levels(&along, &table, &by, &options).is_ok());
    let error = levels(&scene, &framed, &by, &options).map(|_| ()).unwrap_err();
    assert_eq!(error, SimplifyError::Views(ViewsError::Frame));
}

/// Views of the scene are taken into the frame: each method answers within the one before, and what a ray from the eye hits first is
/// seen by all of them, if it is in the view.
#[test]
fn views_are_taken_into_the_frame() {
    let rows = rotation(17.0, 5.0);
    let scene = turned(&small_tower(), &rows);
    let table = bake(&scene, &with(Gap::Width(gap_of(&scene)))).unwrap().table;
    let cells = TableCells::new(&table);
    let rays = RayScene::new(&scene);
    let (mut scratch, mut seen, mut n_hits) = (Scratch::new(), VisibleSet::new(), 0);
    let mut n_seen = [0; 5];
    for room in tower_rooms(SMALL).unwrap() {
        let eye = turn(&rows, std::array::from_fn(|k| 0.45 * room.bounds.min[k] + 0.55 * room.bounds.max[k]));
        for dir in [[1.0, 0.1, 0.2], [-0.3, 0.0, 1.0], [0.5, -0.2, -1.0], [-1.0, 0.05, 0.0]] {
            let view = View::perspective_horizontal(eye, dir, [0.0, 1.0, 0.0], 1.2, 1.5).unwrap();
            let mut before: Option<Vec<ObjectId>> = None;
            for (k, method) in Method::ALL.into_iter().enumerate() {
                seen.clear(table.n_cells(), table.objects().len());
                for &cell in table.place_at(eye).cells() {
                    let subgraph = VisibleSubgraph::prepare(&cells, cell).unwrap_or_else(|e| match e {});
                    method.look(&subgraph, &view, &Doors::all_open(), &mut scratch, &mut seen);
                }
                seen.sort();
                let objects = seen.objects().to_vec();
                assert!(before.is_none_or(|before| objects.iter().all(|o| before.contains(o))), "{method}");
                n_seen[k] += objects.len();
                // Straight ahead, and a little beside.
                for side in [[0.0; 3], [0.1, 0.0, 0.1], [0.0, 0.2, 0.0], [-0.1, -0.1, 0.0]] {
                    let ray = std::array::from_fn(|k| dir[k] + side[k]);
                    if let Some(hit) = rays.first_hit(eye, ray) {
                        n_hits += 1;
                        assert!(objects.contains(&ObjectId(hit.object)), "{method} from {eye:?}");
                    }
                }
                before = Some(objects);
            }
        }
    }
    assert!(n_hits > 50 && n_seen[4] * 2 < n_seen[0], "{n_hits} {n_seen:?}");
}

/// What is upright to the last bit stays as it is, with any gap that closes nothing; and a scene without a file has none by default.
#[test]
fn upright_scenes_have_no_frame() {
    let scene = small_tower();
    let plain = bake(&scene, &with(Gap::Width(0.0))).unwrap().table.to_bytes();
    assert_eq!(bake(&scene, &with(Gap::OfFile)).unwrap().table.to_bytes(), plain);
    assert_eq!(bake(&scene, &with(Gap::Width(gap_of(&scene)))).unwrap().table.to_bytes(), plain);
    assert!(Framed::of(&scene, None, &with(Gap::OfFile)).unwrap().is_none());
}

/// Invariant: on a real office, turned and rounded to single precision, each room sees what rays found from it in the building as it was,
/// and within 5 % as many objects as there.
#[test]
fn a_real_office_may_stand_at_any_angle() {
    let Some(folder) = data_folder("SIGHTLINES_DATA") else { return };
    let folder = folder.join("scenes/office_a");
    let upright = read_scene(folder.join("office_a.glb")).unwrap_or_else(|e| panic!("{e}")).scene;
    let rooms = scene_witness(&folder);
    let cells: Vec<ViewCell> = rooms
        .iter()
        .map(|room| ViewCell { id: room.id.clone(), bounds: Aabb { min: room.min, max: room.max } })
        .collect();
    let table = |scene: &Scene, axes: Option<Rows>, gap: f64| {
        let cells = CellsFrom::Boxes(ViewCells { cells: cells.clone(), axes });
        let (cells, method) = (Some(cells), Some(SceneMethod::Sightlines));
        bake(scene, &BakeRequest { cells, method, gap: Gap::Width(gap), ..BakeRequest::default() }).unwrap().table
    };
    let n_shown = |table: &Table| -> usize {
        (0..table.n_cells() as u32).map(|cell| table.visible_objects(sightlines::pvs::CellId(cell)).len()).sum()
    };
    let expected = n_shown(&table(&upright, None, 0.0));
    for (y, x) in [(0.000_06, 0.0), (17.0, 7.0)] {
        let rows = rotation(y, x);
        let scene = turned(&upright, &rows);
        let table = table(&scene, Some(std::array::from_fn(|k| rows.map(|row| row[k]))), gap_of(&scene));
        let n = n_shown(&table);
        assert!(n.abs_diff(expected) * 20 <= expected, "{y} {x}: {n} pairs, {expected} upright");
        let mut n_seen = 0;
        for (cell, room) in (0u32..).map(sightlines::pvs::CellId).zip(&rooms) {
            let shown = table.visible_objects(cell);
            for &object in &room.objects {
                assert!(shown.contains(&ObjectId(object)), "{y} {x}: {} sees {object}", room.id);
                n_seen += 1;
            }
        }
        assert!(n_seen > 4000, "{n_seen} pairs seen");
    }
}
