//! Parts of objects: they are all of their object, none is hidden that is seen, and of large objects less is drawn.

use crate::places::{city_of_boxes, scene};
use sightlines_bake::eye_level::EyeLevelOptions;
use sightlines_bake::tile::{Tile, bake_tile};
use sightlines_bake::{BakeError, BakeInput, BakeRequest, Bakeable, CellsFrom, Report, Runtime, SceneMethod, bake};
use sightlines_cells::{Scene, SceneObject, places_of_triangles};
use sightlines_formats::Source;
use sightlines_formats::scene::{SceneFile, parse_glb, write_glb};
use sightlines_geometry::Aabb;
use sightlines_pvs::{Axis, CellId, ObjectId, ObjectParts, Table};
use sightlines_scenes::{TowerOptions, tower};
use sightlines_verify::{Findings, Truth, VerifyOptions, Violation, verify};
use std::fmt::Write;
use std::path::Path;

/// All objects of a scene as one, in their order.
fn merged(scene: &Scene) -> SceneObject {
    let mut all = SceneObject { name: "all".to_owned(), vertices: Vec::new(), triangles: Vec::new() };
    for o in scene.objects() {
        let first = all.vertices.len() as u32;
        all.vertices.extend(&o.vertices);
        all.triangles.extend(o.triangles.iter().map(|t| t.map(|i| i + first)));
    }
    all
}

/// A city of one object, with a lamp post in it that is not cut; turned, so that no wall is along an axis.
fn city() -> Scene {
    let city = city_of_boxes([3, 3]);
    let turn = |p: &[f64; 3]| [0.8 * p[0] - 0.6 * p[2], p[1], 0.6 * p[0] + 0.8 * p[2]];
    let all = merged(&city);
    let bounds = city.bounds();
    let post =
        crate::places::block(&Aabb { min: bounds.max.map(|x| x + 1.0), max: bounds.max.map(|x| x + 2.0) }, false);
    let turned = |o: SceneObject| SceneObject { vertices: o.vertices.iter().map(turn).collect(), ..o };
    scene(vec![turned(post), turned(all)])
}

/// Cells at the height of eyes.
fn request(parts: Option<u32>) -> BakeRequest {
    let how = EyeLevelOptions {
        cell_size: Some(30.0),
        eye_height: Some([0.0, 2.5]),
        units_per_metre: Some(1.0),
        up: Some(Axis::Y),
    };
    let cells = Some(CellsFrom::EyeLevel(how));
    let method = Some("line-space".parse().expect("a method"));
    BakeRequest { cells, method, parts, ..BakeRequest::default() }
}

fn baked(scene: &Scene, request: &BakeRequest) -> Table {
    bake(scene, request).expect("a table").table
}

fn found(table: &Table, scene: &Scene, left_out: &[[u32; 2]]) -> Findings {
    let options = VerifyOptions { rays: 40_000, pairs: 4_000, tries: 32, left_out, ..VerifyOptions::default() };
    verify(table, &Truth::Scene(scene), &options).expect("verified")
}

/// The share of an object's triangles that cells see, by parts and as a whole.
fn shares(table: &Table, object: ObjectId) -> [f64; 2] {
    let end =
        table.object_parts().iter().filter(|part| part.object == object).map(|part| part.end).max().expect("parts");
    let (mut by_parts, mut whole) = (0, 0);
    for cell in (0..table.n_cells() as u32).map(CellId) {
        whole += if table.visible_objects(cell).contains(&object) { end } else { 0 };
        let ranges = table.visible_ranges(cell).into_iter().filter(|(o, _)| *o == object);
        by_parts += ranges.filter_map(|(_, range)| range).map(|range| range.end - range.start).sum::<u32>();
    }
    let all = f64::from(end) * table.n_cells() as f64;
    [f64::from(by_parts) / all, f64::from(whole) / all]
}

/// A table with the bits of the parts that rays see, in one cell, cleared.
fn spoiled(table: &Table, cell: usize) -> Table {
    let mut parts = table.parts().clone();
    let ObjectParts { parts: all, seen } = parts.object_parts.as_mut().expect("parts");
    (0..all.len()).for_each(|part| seen.set(cell, part, false));
    Table::new(parts).expect("a table")
}

fn is_part(violation: &Violation) -> bool {
    matches!(violation, Violation::HiddenPart { .. })
}

#[test]
fn parts_of_a_city_are_seen_where_rays_see_them() {
    let scene = city();
    let [whole, table] = [None, Some(12)].map(|parts| baked(&scene, &request(parts)));
    let (n, all) = (scene.objects()[1].triangles.len() as u32, table.object_parts());
    assert!(all.iter().all(|part| part.object == ObjectId(1) && part.end - part.start <= 12));
    assert_eq!((all[0].start, all.last().map(|part| part.end)), (0, Some(n)));
    assert!((n / 12..n / 6).contains(&(all.len() as u32)), "{} parts of {n} triangles", all.len());
    assert!(found(&table, &scene, &[]).is_true());
    // Nothing else changes, but for objects of which no part is left.
    let (a, b) = (table.parts(), whole.parts());
    assert!(a.cells == b.cells && a.rows == b.rows && a.objects == b.objects && a.digest == b.digest);
    for cell in (0..table.n_cells() as u32).map(CellId) {
        let before = whole.visible_objects(cell);
        assert!(table.visible_objects(cell).iter().all(|object| before.contains(object)));
    }
    let [by_parts, by_object] = shares(&table, ObjectId(1));
    assert!(by_object == 1.0 && by_parts < 0.85, "{by_parts} of the triangles");
    // The impostor: a cell that sees no part.
    let wrong = found(&spoiled(&table, table.n_cells() / 2), &scene, &[]);
    assert!(wrong.violations.iter().all(is_part) && wrong.by_kind["hidden-part"] > 0, "{:?}", wrong.by_kind);
}

#[test]
fn threads_and_other_cells_change_nothing_or_little() {
    let scene = city();
    let tables = [1, 2].map(|threads| {
        let runtime = Runtime { threads, ..Runtime::default() };
        runtime.bake(&scene, &request(Some(12))).expect("a table").table.to_bytes()
    });
    assert!(tables[0] == tables[1]);
    // Cells of other kinds: boxes anywhere, and those of a building by sightlines alone.
    let grid = BakeRequest { cells: Some(CellsFrom::Grid([4, 8, 4])), ..request(Some(12)) };
    let table = baked(&scene, &grid);
    assert!(found(&table, &scene, &[]).is_true());
    assert!(shares(&table, ObjectId(1))[0] < 0.95);
    let tower = tower(TowerOptions { floors: 1, ..TowerOptions::default() }).expect("a tower");
    let scene = crate::places::scene(vec![merged(&tower)]);
    let request = BakeRequest { method: Some(SceneMethod::Sightlines), parts: Some(64), ..BakeRequest::default() };
    let table = baked(&scene, &request);
    assert!(found(&table, &scene, &[]).is_true() && !table.portals().is_empty());
    let [by_parts, by_object] = shares(&table, ObjectId(0));
    assert!(by_object == 1.0 && by_parts < 0.6, "{by_parts} of the triangles of a tower");
    let wrong = found(&spoiled(&table, 1), &scene, &[]);
    assert!(wrong.by_kind["hidden-part"] > 0);
}

/// A city as an OBJ file, with a triangle without area before every tenth one, and two at the end.
#[test]
fn ranges_count_triangles_as_the_file_does() {
    let city = merged(&city_of_boxes([2, 2]));
    let mut text = "o all\n".to_owned();
    for [x, y, z] in &city.vertices {
        writeln!(text, "v {x} {y} {z}").unwrap();
    }
    let mut degenerate = Vec::new();
    let mut n = 0;
    let mut add = |t: [u32; 3]| {
        writeln!(text, "f {} {} {}", t[0] + 1, t[1] + 1, t[2] + 1).unwrap();
        n += 1;
        n - 1
    };
    for (k, &t) in city.triangles.iter().enumerate() {
        if k % 10 == 0 {
            degenerate.push([0, add([t[0], t[1], t[1]])]);
        }
        add(t);
    }
    degenerate.extend([0, 1].map(|_| [0, add([0, 0, 1])]));
    let source = Source::Memory { name: Path::new("city.obj"), bytes: text.as_bytes(), beside: None };
    let Bakeable::Scene(file) = Bakeable::read(&source, None).expect("a scene") else { panic!("a scene") };
    assert_eq!(file.info.left_out_triangles, degenerate);
    let request = BakeRequest { parts: Some(30), cells: Some(CellsFrom::Grid([3, 1, 3])), ..BakeRequest::default() };
    let table = bake(BakeInput::from(&file), &request).expect("a table").table;
    let parts = table.object_parts();
    assert_eq!(parts.last().map(|part| part.end), Some(n));
    let places = places_of_triangles(&degenerate, 0, city.triangles.len());
    let sizes = parts.iter().map(|part| places.iter().filter(|&&p| part.start <= p && p < part.end).count());
    assert!(sizes.clone().all(|size| (1..=30).contains(&size)) && sizes.sum::<usize>() == city.triangles.len());
    let scene = &file.scene;
    assert!(found(&table, scene, &degenerate).is_true());
    // Who does not know of them finds that the parts are not those of the scene.
    assert_eq!(found(&table, scene, &[]).violations, [Violation::ObjectParts { object: 0 }]);
}

/// A limit of time that is over before it begins: every part counts as visible where its object does, and the table says so.
#[test]
fn parts_that_are_not_decided_in_time_are_seen() {
    let scene = city();
    let spent = || 1.0;
    let runtime = Runtime { budget: Some(&spent), ..Runtime::default() };
    let baked = runtime.bake(&scene, &request(Some(12))).expect("a table");
    let table = baked.table;
    let [by_parts, by_object] = shares(&table, ObjectId(1));
    assert!(by_parts == by_object && !table.object_parts().is_empty());
    let said = table.info_value("time-limit").expect("the table says so");
    let Report::Regions(report) = baked.report else { panic!("a scene by regions") };
    let n_pairs = (table.n_cells() * table.object_parts().len()) as u64;
    let limit = report.limit.expect("there is one");
    assert!(limit.n_object_pairs >= n_pairs && said == limit.to_string(), "{said}");
}

/// A triangle whose corner is not there is left out, and counted: those behind it keep their places.
#[test]
fn ranges_count_triangles_that_were_left_out() {
    let city = merged(&city_of_boxes([2, 2]));
    let glb = write_glb(&crate::places::scene(vec![city.clone()])).expect("a file");
    let mut spoiled = glb.clone();
    // Indices are the last numbers of 32 bits in the file that are 0, 1, 2 in a row, or the triangle as it is written.
    let first: Vec<u8> = city.triangles[1].iter().flat_map(|i| (*i as u16).to_le_bytes()).collect();
    let wide: Vec<u8> = city.triangles[1].iter().flat_map(|i| i.to_le_bytes()).collect();
    let found = |bytes: &[u8]| glb.windows(bytes.len()).rposition(|w| w == bytes);
    match (found(&wide), found(&first)) {
        (Some(at), _) => spoiled[at..at + 4].copy_from_slice(&60_000u32.to_le_bytes()),
        (None, Some(at)) => spoiled[at..at + 2].copy_from_slice(&60_000u16.to_le_bytes()),
        (None, None) => panic!("the triangle is in the file"),
    }
    let files = [&glb, &spoiled].map(|bytes| parse_glb(bytes, None).expect("a scene"));
    let [places, others] = files.each_ref().map(|file| file.info.left_out_triangles.clone());
    let n = city.triangles.len() as u32;
    assert_eq!((places, others.len(), files[1].scene.n_triangles() as u32), (vec![], 1, n - 1));
    let request = BakeRequest { parts: Some(30), cells: Some(CellsFrom::Grid([3, 1, 3])), ..BakeRequest::default() };
    let tables = files.each_ref().map(|file| bake(BakeInput::from(file), &request).expect("a table").table);
    assert!(tables.iter().all(|table| table.object_parts().last().map(|part| part.end) == Some(n)));
    assert!(found_in(&tables[1], &files[1]).is_true());
}

fn found_in(table: &Table, file: &SceneFile) -> Findings {
    found(table, &file.scene, &file.info.left_out_triangles)
}

#[test]
fn parts_are_refused_where_no_table_has_them() {
    let scene = city();
    let refused = |scene: &Scene, request: &BakeRequest| match bake(scene, request) {
        Err(BakeError::Meaningless(of)) => (of.option, of.found),
        other => panic!("{other:?}"),
    };
    let parts = Some(12);
    assert_eq!(refused(&scene, &BakeRequest { parts: Some(0), ..BakeRequest::default() }), ("parts", "0"));
    let proofs = BakeRequest { parts, for_proofs: true, ..BakeRequest::default() };
    assert_eq!(refused(&scene, &proofs), ("parts", "a bake with proofs or stab trees"));
    let mirrored = scene.clone().with_mirrors(vec![0]).expect("a mirror");
    let request = BakeRequest { parts, ..BakeRequest::default() };
    assert_eq!(refused(&mirrored, &request), ("parts", "a scene with mirrors"));
    let tile = Tile { scene: &scene, cells: &[], near: &[], far: &[], file: None };
    assert!(
        matches!(bake_tile(&tile, &request, &Runtime::default()), Err(BakeError::Meaningless(of)) if of.option == "parts")
    );
    // What moves is not cut, nor is what has few triangles.
    let table = baked(&scene, &self::request(Some(1 << 20)));
    assert!(table.object_parts().is_empty() && table.info_value("parts").is_none());
}
