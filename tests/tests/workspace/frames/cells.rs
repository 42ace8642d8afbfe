//! Given cells in frames: turned along with the scene, bringing a frame, or standing across one.

use super::{Rows, SMALL, TURNS, gap_of, hidden_hits, n_violations, rotation, small_tower, turn, turned, with};
use sightlines::bake::{Along, BakeRequest, CellsFrom, Framed, Gap, SceneMethod, bake, growth_of_cells};
use sightlines::cells::{Point3, Scene, SceneObject};
use sightlines::formats::{ViewCell, ViewCells};
use sightlines::frame::are_near;
use sightlines::geometry::Aabb;
use sightlines::pvs::{ObjectId, Table};
use sightlines::scenes::tower_rooms;

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
        bake(scene, &BakeRequest { cells: Some(cells), ..with(Gap::Width(gap)) }).unwrap()
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
        bake(scene, &BakeRequest { cells: Some(cells), method: Some(method), gap, ..BakeRequest::default() }).unwrap()
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
        let growth = growth_of_cells(Some(&given(Some(axes))), None);
        assert!((1.3..3.0).contains(&growth) && growth_of_cells(Some(&given(None)), None) == 1.0, "{growth}");
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
    let options = |method| BakeRequest {
        cells: Some(CellsFrom::Boxes(ViewCells { cells: cells.clone(), axes: Some(rows) })),
        method: Some(method),
        ..with(Gap::Width(gap_of(&scene)))
    };
    for method in [SceneMethod::Auto, SceneMethod::Sightlines] {
        let framed = Framed::of(&scene, None, &options(method)).unwrap().expect("a frame");
        assert_eq!(framed.along, Along::Walls);
        assert!(growth_of_cells(options(method).cells.as_ref(), Some(&framed)) > 1.2);
    }
    // The impostor: for a yard of towers without common axes it is the other way round.
    let yard = turned(&yard(), &rotation(0.0, 45.0));
    let framed = Framed::of(&yard, None, &options(SceneMethod::Auto)).unwrap().expect("a frame");
    assert_eq!(framed.along, Along::Cells);
}
