//! Walls that hide from their front only: where nothing but the borders of cells is asked, in proofs and explanations; and where scenes are
//! simplified.

use crate::common::Folder;
use sightlines::cells::{Scene, SceneObject};
use sightlines::formats::scene::write_glb;
use sightlines::geometry::Point3;
use sightlines::pvs::{CellId, Table};

/// Single-sided quads in one mesh.
fn quads(corners: &[[Point3; 4]]) -> SceneObject {
    let triangles =
        (0..corners.len() as u32).flat_map(|k| [[4 * k, 4 * k + 1, 4 * k + 2], [4 * k, 4 * k + 2, 4 * k + 3]]);
    SceneObject { name: String::new(), vertices: corners.concat(), triangles: triangles.collect() }
}

/// A wall all across the hall whose front is towards larger x, or smaller x.
fn wall(x: f64, is_up: bool) -> SceneObject {
    let corners = [[x, 0.0, 0.0], [x, 4.0, 0.0], [x, 4.0, 4.0], [x, 0.0, 4.0]];
    let [a, b, c, d] = corners;
    quads(&[if is_up { corners } else { [d, c, b, a] }])
}

/// A hall of 10 by 4 by 4, seen from inside, with walls of one side: each at x, with its front towards larger x or not.
fn hall(walls: &[(f64, bool)]) -> Vec<u8> {
    let corner =
        |i: usize| -> Point3 { std::array::from_fn(|k| if i >> k & 1 == 1 { [10.0, 4.0, 4.0][k] } else { 0.0 }) };
    let shell = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]];
    let shell = quads(&shell.map(|side| side.map(corner)));
    let objects: Vec<SceneObject> =
        std::iter::once(shell).chain(walls.iter().map(|&(x, is_up)| wall(x, is_up))).collect();
    let all = (0..objects.len() as u32).collect();
    write_glb(&Scene::new(objects).and_then(|scene| scene.with_front_occluders(all)).expect("a scene")).expect("a file")
}

/// Cells 0, 1 and 2 of the hall with two walls in it, which face each other: nothing is seen past both.
const APART: [(f64, bool); 2] = [(3.0, true), (6.0, false)];

fn build(folder: &Folder, out: &str, more: &[&str]) -> Table {
    folder
        .run(&[&["build", "hall.glb", "--method", "sightlines", "--detail-below", "0", "-o", out], more].concat())
        .expect(0);
    Table::from_bytes(&folder.read(out)).expect("a sound table")
}

/// A table with proofs takes nothing from walls of one side. The impostor is the table without, which the proofs contradict; the twin is a pair of such
/// walls back to back, which hides with proofs too.
#[test]
fn tables_with_proofs_rest_on_walls_with_two_sides() {
    let folder = Folder::new();
    folder.write("hall.glb", hall(&APART));
    let plain = build(&folder, "plain.pvs", &[]);
    let proven = build(&folder, "t.pvs", &["--certify"]);
    assert_eq!((plain.n_cells(), proven.n_cells()), (3, 3));
    let ends = [CellId(0), CellId(2)];
    assert!(!plain.sees(ends[0], ends[1]) && proven.sees(ends[0], ends[1]));
    let few = ["--rays", "0", "--pairs", "0", "--proofs", "t.cert"];
    folder.run(&[&["verify", "t.pvs", "hall.glb", "--strict"], &few[..]].concat()).expect(0);
    let wrong = folder.run(&[&["verify", "plain.pvs", "hall.glb"], &few[..]].concat()).expect(1).out;
    assert!(wrong.contains("cells 0 and 2 are hidden from each other, but a proven line joins them"), "{wrong}");
    let warning = folder.run(&["build", "hall.glb", "--certify", "-o", "again.pvs"]).expect(0).err;
    assert!(warning.contains("walls that hide from their front only hide nothing from sightlines"), "{warning}");

    folder.write("hall.glb", hall(&[(5.0, true), (5.0, false)]));
    let table = build(&folder, "t.pvs", &["--certify"]);
    assert!(table.n_cells() == 2 && !table.sees(CellId(0), CellId(1)));
    folder.run(&[&["verify", "t.pvs", "hall.glb", "--strict"], &few[..]].concat()).expect(0);
}

/// What walls of one side hide past portals is no error of the table; where there are none it is one.
#[test]
fn explanations_know_of_walls_of_one_side() {
    let folder = Folder::new();
    folder.write("hall.glb", hall(&APART));
    build(&folder, "t.pvs", &[]);
    let explain = |code: i32| folder.run(&["explain", "t.pvs", "0", "2"]).expect(code).out;
    let out = explain(1);
    let line =
        "the table hides them: only walls that hide from one side can be in the way, which portals do not tell of\n";
    assert!(out.starts_with("cell 0 sees cell 2 through 2 portals\n") && out.ends_with(line), "{out}");
    // The twin: a table that takes nothing from them.
    let mut parts = build(&folder, "t.pvs", &["--certify"]).into_parts();
    parts.rows.set(0, 2, false);
    parts.rows.set(2, 0, false);
    folder.write("t.pvs", Table::new(parts).expect("symmetric").to_bytes());
    let out = explain(0);
    assert!(out.ends_with("the table says that they do not: it is wrong\n"), "{out}");
}

/// What is behind a wall of one side goes for eyes in front of it, as behind a wall with two sides, and stays for eyes behind it; those on both sides
/// see everything.
#[test]
fn walls_of_one_side_simplify_what_is_behind_them() {
    let folder = Folder::new();
    // Its front is towards lower x; the ends of the hall have two triangles each.
    folder.write("hall.glb", hall(&[(5.0, false)]));
    for method in ["multifocal", "shafts", "line-space"] {
        let n_hidden = |volume: &str, backs: &str| {
            let args =
                ["simplify", "hall.glb", "--volume", volume, "--backs", backs, "--method", method, "-o", "out.glb"];
            folder.run(&[&args[..], &["--json"]].concat()).expect(0).json()["n_hidden"].as_u64().expect("a number")
        };
        let [before, behind, across] = ["1,1,1,2,2,2", "8,1,1,9,2,2", "1,1,1,9,2,2"];
        assert_eq!([before, behind, across].map(|eyes| n_hidden(eyes, "either")), [2, 0, 0], "{method}");
        assert_eq!([before, behind, across].map(|eyes| n_hidden(eyes, "drawn")), [2, 2, 0], "{method}");
    }
}

/// The buffer of a scene has walls of one side in it for volumes in front of them.
#[test]
fn buffers_show_walls_of_one_side_from_their_front() {
    let folder = Folder::new();
    folder.write("hall.glb", hall(&[(5.0, false)]));
    for each in [&[][..], &["--triangles"]] {
        let n_blocked = |volume: &str, backs: &str| {
            let args =
                ["multifocal", "hall.glb", "--volume", volume, "--plane", "x=9.5", "--backs", backs, "-o", "out.png"];
            let reply = folder.run(&[&args[..], each, &["--json"]].concat()).expect(0).json();
            reply["n_blocked"].as_u64().expect("a number")
        };
        let [before, behind] = ["1,1,1,2,2,2", "6,1,1,7,2,2"];
        assert!(n_blocked(before, "either") > 0 && n_blocked(behind, "either") == 0);
        assert_eq!(n_blocked(before, "either"), n_blocked(before, "drawn"));
    }
}
