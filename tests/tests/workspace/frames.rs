//! Buildings that stand at an angle to the axes of their file: their tables against those of the same buildings upright, and
//! against rays in the scene as the file has it.

use sightlines::bake::{Along, BakeOptions, Baked, CellsFrom, Framed, Gap, SceneMethod, bake, growth_of_cells};
use sightlines::cells::{Point3, Scene, SceneObject};
use sightlines::eye_to_cell::{Doors, Method, Scratch, TableCells, View, VisibleSet, VisibleSubgraph};
use sightlines::formats::scene::read_scene;
use sightlines::formats::{ViewCell, ViewCells};
use sightlines::frame::are_near;
use sightlines::geometry::Aabb;
use sightlines::pvs::{Frame, ObjectId, Table};
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
fn with(gap: Gap) -> BakeOptions<'static> {
    let mut options = BakeOptions { gap, threads: 2, ..BakeOptions::default() };
    options.cut.detail_below = Some(1.1);
    options
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
        let again = bake(&scene, &BakeOptions { threads: 1, ..with(Gap::Width(gap_of(&scene))) }).unwrap();
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
    let shares = [exact.mean_visible_share(), framed.mean_visible_share()];
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

/// Whether the eye sees the thing at the other end.
fn sees_east(table: &Table, eye: Point3) -> bool {
    table.place_at(eye).inside().is_none_or(|at| at.visible_objects().contains(&ObjectId(2)))
}

/// Invariant: an opening wider than the gap stays open, one that is narrower may close. The impostor: a gap that closes a real opening is
/// noticed as soon as the table states another.
#[test]
fn a_gap_that_is_too_wide_is_noticed() {
    let rows = rotation(20.0, 0.0);
    let eye = turn(&rows, [0.5, 1.6, 0.5]);
    let detail = |gap| {
        let mut options = with(Gap::Width(gap));
        options.cut.detail_below = Some(0.0);
        options
    };
    let scene = turned(&slit(0.25), &rows);
    let honest = bake(&scene, &detail(1e-4)).unwrap();
    assert!(sees_east(&honest.table, eye) && honest.table.frame().is_some());
    assert_eq!(n_violations(&honest, &scene), 0);
    let wide = bake(&scene, &detail(0.75)).unwrap();
    assert!(!sees_east(&wide.table, eye), "the slit is closed");
    // As stated, that is within the premise.
    assert_eq!(n_violations(&wide, &scene), 0);
    let frame = wide.table.frame().copied().expect("a frame");
    let less = Frame::new(frame.axes(), 1e-4).unwrap();
    let table = wide.table.clone().with_frame(Some(less)).unwrap();
    assert!(n_violations(&Baked { table, ..wide }, &scene) > 0, "it hides what is seen through the slit");
    // A hairline is closed by default precision, and open without.
    let scene = turned(&slit(1e-6), &rows);
    assert!(!sees_east(&bake(&scene, &detail(1e-5)).unwrap().table, eye));
    assert!(sees_east(&bake(&scene, &detail(0.0)).unwrap().table, eye));
}

/// The impostor: a table whose frame is forgotten takes an eye on one side of a wall for one on the other.
#[test]
fn a_frame_that_is_forgotten_hides_what_is_seen() {
    let rows = rotation(-17.0, 0.0);
    let mut options = with(Gap::Width(1e-4));
    options.cut.detail_below = Some(0.0);
    let table = bake(&turned(&slit(0.0), &rows), &options).unwrap().table;
    let eye = turn(&rows, [6.55, 1.6, 1.0]);
    assert!(sees_east(&table, eye) && !table.place_at(eye).is_outside());
    assert!(!sees_east(&table.with_frame(None).unwrap(), eye));
}

/// Given cells are turned along: as boxes along the axes of the building they see what the rooms of the upright one see; along those of the
/// file they are the boxes around, and see at least that.
#[test]
fn given_cells_are_turned_along() {
    let upright = small_tower();
    let rooms = tower_rooms(SMALL).unwrap();
    let cell = |(i, b): (usize, Aabb<3>)| ViewCell { id: i.to_string(), bounds: b };
    let inside = |b: &Aabb<3>| Aabb { min: b.min.map(|x| x + 0.25), max: b.max.map(|x| x - 0.25) };
    let given = |axes: Option<Rows>, boxes: Vec<Aabb<3>>| {
        CellsFrom::Boxes(ViewCells { cells: boxes.into_iter().enumerate().map(cell).collect(), axes })
    };
    let boxes: Vec<Aabb<3>> = rooms.iter().map(|room| inside(&room.bounds)).collect();
    let baked = |scene: &Scene, cells: CellsFrom, gap: f64| {
        bake(scene, &BakeOptions { cells, ..with(Gap::Width(gap)) }).unwrap()
    };
    let seen = |table: &Table| -> Vec<Vec<ObjectId>> {
        (0..table.n_cells() as u32).map(|cell| table.visible_objects(sightlines::pvs::CellId(cell))).collect()
    };
    let expected = seen(&baked(&upright, given(None, boxes.clone()), 0.0).table);
    for (y, x) in TURNS {
        let rows = rotation(y, x);
        let scene = turned(&upright, &rows);
        let axes: Rows = std::array::from_fn(|k| rows.map(|row| row[k]));
        let table = baked(&scene, given(Some(axes), boxes.clone()), gap_of(&scene)).table;
        let found = seen(&table);
        let n = |seen: &[Vec<ObjectId>]| seen.iter().map(Vec::len).sum::<usize>();
        assert!(n(&found).abs_diff(n(&expected)) * 20 <= n(&expected), "{y} {x}: {} of {}", n(&found), n(&expected));
        // The eye in the middle of a room is in its cell.
        for (cell, b) in (0u32..).zip(&boxes) {
            let middle = turn(&rows, std::array::from_fn(|k| (b.min[k] + b.max[k]) / 2.0));
            assert!(table.place_at(middle).cells().contains(&sightlines::pvs::CellId(cell)), "{y} {x}: {cell}");
        }
        let around: Vec<Aabb<3>> = boxes
            .iter()
            .map(|b| {
                let corner = |i: usize| std::array::from_fn(|k| if i >> k & 1 == 0 { b.min[k] } else { b.max[k] });
                Aabb::around((0..8).map(|i| turn(&rows, corner(i))))
            })
            .collect();
        let wide = seen(&baked(&scene, given(None, around), gap_of(&scene)).table);
        assert!(wide.iter().zip(&found).all(|(wide, own)| own.iter().all(|o| wide.contains(o))), "{y} {x}");
    }
}

/// Towers at angles of their own around a yard with a post in it: most walls lie along no axes.
fn yard() -> Scene {
    let tower = |k: usize| {
        let (s, c) = (0.3 + 0.55 * k as f64).sin_cos();
        let (x, z) = (f64::from(k as u32 % 3) * 9.0, f64::from(k as u32 / 3) * 9.0);
        let half = if k == 4 { 0.4 } else { 3.2 };
        let corner = |i: usize| -> Point3 {
            let [u, v] = [i & 1, i >> 2].map(|side| if side == 0 { -half } else { half });
            [x + c * u - s * v, if i >> 1 & 1 == 0 { 0.0 } else { 14.0 + 0.1 * k as f64 }, z + s * u + c * v]
        };
        let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let triangles = sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        SceneObject { name: format!("tower {k}"), vertices: (0..8).map(corner).collect(), triangles }
    };
    let thing = |k: usize| {
        let (x, z) = (f64::from(k as u32 % 4) * 9.0 - 4.5, f64::from(k as u32 / 4) * 9.0 - 4.5);
        let vertices = vec![[x, 1.0, z], [x + 0.3, 1.0, z + 0.1], [x, 1.5, z + 0.2]];
        SceneObject { name: format!("thing {k}"), vertices, triangles: vec![[0, 1, 2]] }
    };
    Scene::new((0..9).map(tower).chain((0..16).map(thing)).collect()).unwrap()
}

/// Invariant: where walls bring no frame, given cells with axes do: turned along with the scene they see what they saw upright, to within 5 %, and
/// no ray sees anything else; with the precision of a file, with that of doubles, and with axes in single precision. Without the frame, boxes around them
/// are taken, which are larger.
#[test]
fn given_cells_bring_a_frame() {
    let upright = yard();
    let spot = |k: usize| {
        let [x, z] = [k as u32 % 2, k as u32 / 2].map(|i| f64::from(i) * 9.0 + 4.5);
        Aabb { min: [x - 0.6, 0.5, z - 0.6], max: [x + 0.6, 6.5, z + 0.6] }
    };
    let spots: Vec<Aabb<3>> = (0..4).map(spot).collect();
    let given = |axes: Option<Rows>| {
        let cell = |(i, bounds): (usize, &Aabb<3>)| ViewCell { id: i.to_string(), bounds: *bounds };
        CellsFrom::Boxes(ViewCells { cells: spots.iter().enumerate().map(cell).collect(), axes })
    };
    let baked = |scene: &Scene, cells: CellsFrom, gap: Gap| {
        let method = SceneMethod::Auto;
        bake(scene, &BakeOptions { cells, method, gap, threads: 2, ..BakeOptions::default() }).unwrap()
    };
    let n_seen = |table: &Table| -> usize {
        (0..table.n_cells() as u32).map(|cell| table.visible_objects(sightlines::pvs::CellId(cell)).len()).sum()
    };
    let plain = baked(&upright, given(None), Gap::Width(0.0));
    let expected = n_seen(&plain.table);
    assert!(expected < 4 * 25 * 3 / 4, "something is hidden: {expected}");
    let mut n_rays = 0;
    for (y, x) in [(0.0, 45.0), (17.0, 30.0)] {
        let rows = rotation(y, x);
        let scene = turned(&upright, &rows);
        let axes: Rows = std::array::from_fn(|k| rows.map(|row| f64::from(row[k] as f32)));
        let eyes: Vec<Aabb<3>> = spots
            .iter()
            .map(|b| {
                let middle = turn(&rows, std::array::from_fn(|k| (b.min[k] + b.max[k]) / 2.0));
                Aabb { min: middle.map(|x| x - 0.2), max: middle.map(|x| x + 0.2) }
            })
            .collect();
        for gap in [Gap::Width(gap_of(&scene)), Gap::OfFile] {
            let baked = baked(&scene, given(Some(axes)), gap);
            let frame = baked.table.frame().expect("that of the cells");
            assert!(are_near(frame.axes(), axes) && frame.gap() > 0.0, "{frame:?}");
            let n = n_seen(&baked.table);
            assert!(n.abs_diff(expected) * 20 <= expected, "{y} {x} {gap:?}: {n} pairs, {expected} upright");
            let (n, n_hidden) = hidden_hits(&baked.table, &scene, &eyes);
            assert_eq!(n_hidden, 0, "{y} {x} {gap:?}");
            n_rays += n;
            assert_eq!(n_violations(&baked, &scene), 0, "{y} {x} {gap:?}");
        }
        // Exactly as they are: no frame, and boxes around the cells.
        let exact = baked(&scene, given(Some(axes)), Gap::Width(0.0)).table;
        assert!(exact.frame().is_none());
        assert_eq!(hidden_hits(&exact, &scene, &eyes).1, 0, "{y} {x}");
        let growth = growth_of_cells(&given(Some(axes)), None);
        assert!((1.3..3.0).contains(&growth) && growth_of_cells(&given(None), None) == 1.0, "{growth}");
    }
    assert!(n_rays > 50, "{n_rays} hits");
}

/// Walls come first: cells that stand across them are boxes around what they were.
#[test]
fn walls_come_before_cells() {
    let scene = turned(&small_tower(), &rotation(17.0, 0.0));
    let room = &tower_rooms(SMALL).unwrap()[0].bounds;
    let cells = vec![ViewCell { id: "room".to_owned(), bounds: *room }];
    let rows = rotation(20.0, 0.0);
    let options = |method| BakeOptions {
        cells: CellsFrom::Boxes(ViewCells { cells: cells.clone(), axes: Some(rows) }),
        method,
        ..with(Gap::Width(gap_of(&scene)))
    };
    for method in [SceneMethod::Auto, SceneMethod::Sightlines] {
        let framed = Framed::of(&scene, None, &options(method)).unwrap().expect("a frame");
        assert_eq!(framed.along, Along::Walls);
        assert!(growth_of_cells(&options(method).cells, Some(&framed)) > 1.2);
    }
    // The impostor: for a yard of towers without common axes it is the other way round.
    let yard = turned(&yard(), &rotation(0.0, 45.0));
    let framed = Framed::of(&yard, None, &options(SceneMethod::Auto)).unwrap().expect("a frame");
    assert_eq!(framed.along, Along::Cells);
}

/// Rays that pass hairlines of the file, which the frame closes, are counted apart. The twin: of what is open along the frame too, nothing is a crack.
#[test]
fn cracks_are_counted_apart() {
    let rows = rotation(20.0, 0.0);
    let detail = |gap| {
        let mut options = with(Gap::Width(gap));
        options.cut.detail_below = Some(0.0);
        options
    };
    let remarks = |width: f64, gap: f64| {
        let scene = turned(&slit(width), &rows);
        let baked = bake(&scene, &detail(gap)).unwrap();
        let options = VerifyOptions { rays: 20_000, pairs: 400, tries: 256, threads: 2, ..VerifyOptions::default() };
        let found = verify(&baked.table, &Truth::Scene(&scene), &options).unwrap();
        assert!(found.is_true(), "{:?}", found.by_kind);
        found.remarks
    };
    let [wide, narrow] = [0.75, 1e-4].map(|gap| remarks(0.25, gap).cracks);
    // Rays that graze an edge pass within any gap.
    assert!(wide > 4 * narrow, "{wide} where the slit is closed, {narrow} where it is open");
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
            let view = View::pinhole(eye, dir, [0.0, 1.0, 0.0], 1.2, 1.5).unwrap();
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
        bake(scene, &BakeOptions { cells, gap: Gap::Width(gap), threads: 2, ..BakeOptions::default() }).unwrap().table
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
