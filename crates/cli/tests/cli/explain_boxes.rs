//! `explain` of cells without portals: a line that joins them, or what is known of who hid them.

use crate::common::Folder;
use crate::common::looks::table;
use serde_json::{Value, json};
use sightlines::cells::Scene;
use sightlines::formats::scene::read_scene;
use sightlines::geometry::{Point3, orient3d};
use sightlines::pvs::{CellId, Table};

/// Builds a table of a grid of boxes in a tower; a pair that it shows, that touches nowhere and that a ray joins, and the first that it hides.
fn grid(folder: &Folder, method: &str) -> (Table, [[u32; 2]; 2]) {
    folder.run(&["build", "tower.glb", "--method", method, "--grid", "4,2,4", "-o", "t.pvs"]).expect(0);
    let table = table(folder, "t.pvs");
    let n = table.n_cells() as u32;
    let touch = |a: u32, b: u32| {
        let [a, b] = [a, b].map(|id| &table.cells()[id as usize]);
        (0..3).all(|k| a.min[k] <= b.max[k] && b.min[k] <= a.max[k])
    };
    let fits = |is_seen: bool| {
        let pairs = (0..n).flat_map(|a| (a + 1..n).map(move |b| [a, b]));
        pairs.filter(|&[a, b]| table.sees(CellId(a), CellId(b)) == is_seen && !touch(a, b)).collect::<Vec<_>>()
    };
    // Tables show more than rays reach, and ask from one of many places.
    let scene = ["--scene", "tower.glb"];
    let joined = |pair: &[u32; 2]| explain(folder, "t.pvs", *pair, &scene, 0)["answer"] == "visible";
    let seen = fits(true).into_iter().step_by(7).take(40).find(joined).expect("a pair that a ray joins");
    let hidden = fits(false)[0];
    (table, [seen, hidden])
}

fn explain(folder: &Folder, file: &str, [a, b]: [u32; 2], more: &[&str], code: i32) -> Value {
    let pair = [a.to_string(), b.to_string()];
    folder.run(&[&["explain", file, &pair[0], &pair[1], "--json"], more].concat()).expect(code).json()
}

/// Whether a segment meets no triangle of a scene, by exact signs.
fn is_free(scene: &Scene, [p, q]: [Point3; 2]) -> bool {
    scene.objects().iter().flat_map(|o| o.corners().collect::<Vec<_>>()).all(|[a, b, c]| {
        let ends = [orient3d(a, b, c, p), orient3d(a, b, c, q)];
        let turns = [orient3d(p, q, a, b), orient3d(p, q, b, c), orient3d(p, q, c, a)];
        let same_side = ends[0] * ends[1] > 0.0;
        let passes = turns.iter().any(|t| *t > 0.0) && turns.iter().any(|t| *t < 0.0);
        same_side || passes
    })
}

#[test]
fn a_ray_or_the_methods_are_named() {
    let folder = Folder::with_tower();
    let scene = read_scene(folder.path("tower.glb")).expect("a scene").scene;
    let mut last = [[0; 2]; 2];
    for (method, of_regions) in [("sightlines", ""), ("shafts", "shafts"), ("both", "multifocal")] {
        let (table, [seen, hidden]) = grid(&folder, method);
        last = [seen, hidden];
        // The table alone: what it says, and by whom.
        let answer = explain(&folder, "t.pvs", seen, &[], 0);
        assert_eq!((&answer["answer"], &answer["listed"]), (&json!("unknown"), &json!(true)));
        assert!(answer["hidden_by"].is_null() && answer["n_rays"].is_null(), "{answer}");
        let answer = explain(&folder, "t.pvs", hidden, &[], 1);
        let by: Vec<&str> = answer["hidden_by"].as_array().expect("methods").iter().filter_map(Value::as_str).collect();
        assert_eq!(by.len(), if method == "both" { 2 } else { 1 }, "{answer}");
        assert_eq!(by.contains(&"sightlines"), method != "shafts", "{answer}");
        assert!(of_regions.is_empty() || by.iter().any(|name| name.contains(of_regions)), "{answer}");
        // With the scene: a line, which meets nothing; or one of the methods.
        let with = ["--scene", "tower.glb"];
        let answer = explain(&folder, "t.pvs", seen, &with, 0);
        assert_eq!(answer["answer"], "visible", "{answer}");
        let point =
            |k: usize| -> Point3 { std::array::from_fn(|axis| answer["segment"][k][axis].as_f64().expect("a number")) };
        let segment = [point(0), point(1)];
        assert!(is_free(&scene, segment), "{answer}");
        for (end, cell) in segment.iter().zip(seen) {
            let cell = &table.cells()[cell as usize];
            assert!((0..3).all(|k| cell.min[k] < end[k] && end[k] < cell.max[k]), "{answer}");
        }
        let answer = explain(&folder, "t.pvs", hidden, &[&with[..], &["--rays", "300"]].concat(), 1);
        assert_eq!((&answer["answer"], &answer["n_rays"]), (&json!("unknown"), &json!(300)));
        assert_eq!(answer["hidden_by"].as_array().map(Vec::len), Some(1), "{answer}");
        // The impostor: a table that hides the pair is wrong, and that is said.
        let mut parts = table.into_parts();
        let [a, b] = seen.map(|id| id as usize);
        parts.rows.set(a, b, false);
        parts.rows.set(b, a, false);
        folder.write("wrong.pvs", Table::new(parts).expect("symmetric").to_bytes());
        let pair = seen.map(|id| id.to_string());
        let run = folder.run(&["explain", "wrong.pvs", &pair[0], &pair[1], "--scene", "tower.glb"]).expect(0);
        assert!(
            run.out.starts_with(&format!("cell {a} sees cell {b}: nothing is on the segment from (")),
            "{}",
            run.out
        );
        assert!(run.out.ends_with("the table says that they do not: it is wrong\n"), "{}", run.out);
    }
    let run = folder.run(&["explain", "t.pvs", "3", "3"]).expect(0);
    assert_eq!(run.out, "both are in cell 3, and a cell sees itself\n");
    let [seen, hidden] = last;
    let text = |pair: [u32; 2], code: i32| {
        let pair = pair.map(|id| id.to_string());
        folder.run(&["explain", "t.pvs", &pair[0], &pair[1]]).expect(code).out
    };
    assert!(text(seen, 0).ends_with("the table says that they see each other: no method has hidden them\n"));
    let hidden = text(hidden, 1);
    assert!(
        hidden.contains("give the scene that it was made of, --scene SCENE, to shoot rays between them\nhidden by sightlines or multifocal"),
        "{hidden}"
    );
    assert!(
        hidden.ends_with("; which one is not recorded\nthe table says that they do not see each other\n"),
        "{hidden}"
    );
}

/// What a from-region method hides although a line leads through portals is no error of the table.
#[test]
fn what_a_region_hides_past_portals_stays_hidden() {
    let folder = Folder::with_bare_tower();
    folder.run(&["build", "tower.glb", "--method", "both", "-o", "t.pvs"]).expect(0);
    let made = table(&folder, "t.pvs");
    let seen = (1..made.n_cells() as u32).rfind(|&b| made.sees(CellId(0), CellId(b))).expect("a cell that is seen");
    assert_eq!(explain(&folder, "t.pvs", [0, seen], &[], 0)["answer"], "visible");
    let mut parts = made.into_parts();
    parts.rows.set(0, seen as usize, false);
    parts.rows.set(seen as usize, 0, false);
    folder.write("less.pvs", Table::new(parts.clone()).expect("symmetric").to_bytes());
    let run = folder.run(&["explain", "less.pvs", "0", &seen.to_string()]).expect(1);
    let line = "the table hides them: a from-region method found walls that are no borders of cells in the way\n";
    assert!(run.out.ends_with(line), "{}", run.out);
    // The twin: of sightlines it is one.
    let plain = table(&folder, "tower.pvs").kind();
    parts.kind = plain;
    folder.write("wrong.pvs", Table::new(parts).expect("symmetric").to_bytes());
    let run = folder.run(&["explain", "wrong.pvs", "0", &seen.to_string()]).expect(0);
    assert!(run.out.ends_with("the table says that they do not: it is wrong\n"), "{}", run.out);
}

#[test]
fn scenes_are_for_cells_without_portals() {
    let folder = Folder::with_tower();
    let error = folder.refused(&["explain", "tower.pvs", "0", "1", "--scene", "tower.glb"]);
    assert!(
        error.contains("--scene is for cells without portals, and this is the table of a scene in space"),
        "{error}"
    );
    grid(&folder, "sightlines");
    let error = folder.refused(&["explain", "t.pvs", "0", "1", "--max-programs", "9"]);
    assert!(error.contains("--max-programs is for scenes in space"), "{error}");
    let error = folder.refused(&["explain", "t.pvs", "0", "1", "--scene", "none.glb"]);
    assert!(error.contains("none.glb"), "{error}");
    folder.run(&["explain", "t.pvs", "0", "1", "--rays", "9"]).expect(2);
}
