//! Packing tables, and asking what was packed.

use crate::common::Folder;
use crate::common::looks::{middle, scenes, table};
use serde_json::json;
use sightlines::pvs::CellId;

#[test]
fn tables_are_packed_and_come_back() {
    for (folder, name, views) in scenes() {
        for class in ["small", "large"] {
            check_packed(&folder, name, &views, class);
        }
    }
}

fn check_packed(folder: &Folder, name: &str, views: &[Vec<&str>], class: &str) {
    let plain = folder.read(name);
    let table = table(folder, name);
    let reply = folder.run(&["pack", name, "-o", "small.pvz", "--class", class, "--json"]).expect(0).json();
    assert_eq!(reply["class"], class);
    let packed = folder.read("small.pvz");
    assert_eq!((&reply["n_plain_bytes"], &reply["n_packed_bytes"]), (&json!(plain.len()), &json!(packed.len())));
    assert!(packed.len() < plain.len() && reply["n_merges"] == 0 && reply["over_estimation"] == 1.0);
    folder.run(&["unpack", "small.pvz", "-o", "back.pvs"]).expect(0);
    assert!(folder.read("back.pvs") == plain, "{name} comes back bit for bit");
    let info = folder.run(&["info", "small.pvz", "--json"]).expect(0).json();
    assert_eq!(
        (&info["kind"], &info["class"], &info["n_cells"], &info["n_bytes"]),
        (&json!("packed"), &json!(class), &json!(table.n_cells()), &json!(packed.len()))
    );
    let parts = info["parts"].as_array().unwrap();
    let unknown: Vec<_> = parts.iter().filter(|part| part["what"] == "unknown").collect();
    assert!(unknown.is_empty() && parts.iter().any(|part| part["name"] == "KIND"), "{unknown:?}");
    let sum = |resident: bool| -> u64 {
        let of = parts.iter().filter(|part| part["resident"] == resident);
        of.map(|part| part["n_bytes"].as_u64().unwrap()).sum()
    };
    assert_eq!(info["resident_bytes"], sum(true));
    // All parts, the fixed header, an entry for each section, and a checksum or what ends a large file.
    let rest = if class == "small" { 4 } else { 32 };
    let n_sections = parts.iter().filter(|part| part["resident"] == true).count();
    assert_eq!(sum(true) + sum(false) + 24 + 24 * n_sections as u64 + rest, packed.len() as u64);
    assert!(folder.run(&["info", "small.pvz"]).expect(0).out.contains(if class == "small" {
        ": packed visibility table in "
    } else {
        ": large packed visibility table in "
    }));
    // Who needs the plain one says so.
    for command in [&["export", "small.pvz"][..], &["pack", "small.pvz", "-o", "twice.pvz"]] {
        let reply = folder.run(command).expect(2);
        assert!(reply.err.contains("small.pvz: the table is packed; `sightlines unpack` makes it"), "{}", reply.err);
    }
    // It answers as the table does, but for the time.
    let eye = middle(&table, table.n_cells() / 2);
    for more in [&[][..], &views[0], &["--method", "all"]] {
        let ask = |file: &str| {
            let mut found =
                folder.run(&[&["query", file, "--eye", &eye, "--json"][..], more].concat()).expect(0).json();
            found.as_object_mut().unwrap().remove("microseconds");
            if let Some(methods) = found["methods"].as_array_mut() {
                methods.iter_mut().for_each(|m| drop(m.as_object_mut().unwrap().remove("microseconds")));
            }
            found
        };
        assert_eq!(ask(name), ask("small.pvz"), "{more:?}");
    }
    folder.run(&["walk", "small.pvz", "--random", "50"]).expect(0);
}

/// Invariant: a table that was made smaller than it is shows all that it showed.
#[test]
fn packing_within_a_budget_shows_more() {
    let folder = Folder::with_tower();
    let whole = folder.run(&["pack", "tower.pvs", "-o", "whole.pvz", "--json"]).expect(0).json();
    let [all, rows] = ["n_packed_bytes", "n_row_bytes"].map(|k| whole[k].as_u64().unwrap());
    let budget = (all - rows / 4).to_string();
    let reply =
        folder.run(&["pack", "tower.pvs", "-o", "small.pvz", "--max-bytes", &budget, "--json"]).expect(0).json();
    assert!(reply["n_packed_bytes"].as_u64().unwrap() <= all - rows / 4 && reply["n_merges"].as_u64().unwrap() > 0);
    folder.run(&["unpack", "small.pvz", "-o", "more.pvs"]).expect(0);
    let [less, more] = ["tower.pvs", "more.pvs"].map(|name| table(&folder, name));
    let (mut n_pairs, mut n_more) = (0u64, 0u64);
    for a in (0..less.n_cells() as u32).map(CellId) {
        assert!(less.visible(a).all(|b| more.sees(a, b)), "cell {a}");
        assert!(less.visible_objects(a).iter().all(|o| more.visible_objects(a).contains(o)), "cell {a}");
        n_pairs += less.visible(a).count() as u64;
        n_more += more.visible(a).count() as u64;
    }
    let over = reply["over_estimation"].as_f64().unwrap();
    assert!(n_pairs < n_more && (over - n_more as f64 / n_pairs as f64).abs() < 1e-9, "{n_pairs} {n_more} {over}");
    let error = folder.refused(&["pack", "tower.pvs", "-o", "none.pvz", "--max-bytes", "10"]);
    assert!(error.starts_with("tower.pvs: a budget of 10 bytes cannot be kept: "), "{error}");
    assert!(!folder.path("none.pvz").exists());
}

/// Whatever of a packed table is damaged: an error with the file's name, and never a panic.
#[test]
fn damaged_packed_tables_are_refused() {
    let folder = Folder::with_office();
    let (mut n_refused, mut n_walked) = (0, 0);
    let mut damaged: Vec<Vec<u8>> = Vec::new();
    for class in ["small", "large"] {
        folder.run(&["pack", "office.pvs", "-o", "small.pvz", "--class", class]).expect(0);
        let sound = folder.read("small.pvz");
        damaged.extend([0, 7, 8, 20, 100, sound.len() / 2, sound.len() - 1].map(|n| sound[..n].to_vec()));
        for at in (0..sound.len()).step_by(1 + sound.len() / 12) {
            let mut bytes = sound.clone();
            bytes[at] ^= 0x10;
            damaged.push(bytes);
        }
    }
    for bytes in &damaged {
        folder.write("bad.pvz", bytes);
        let error = folder.refused(&["unpack", "bad.pvz", "-o", "out.pvs"]);
        assert!(error.starts_with("bad.pvz: "), "{error}");
        n_refused += 1;
        // A walk may not come by what is damaged; a query reads one row.
        for args in [
            &["walk", "bad.pvz", "--random", "300"][..],
            &["query", "bad.pvz", "--eye", "1,1", "--method", "all"],
            &["query", "bad.pvz", "--eye", "1,1"],
            &["info", "bad.pvz"],
        ] {
            let run = folder.run(args);
            assert!(run.code < 2 || run.err.starts_with("error: bad.pvz: "), "{args:?}: {}", run.err);
            n_walked += usize::from(run.code == 2);
        }
    }
    assert!(n_refused > 30 && n_walked > 60 && !folder.path("out.pvs").exists(), "{n_refused} {n_walked}");
    let error = folder.refused(&["unpack", "office.pvs", "-o", "out.pvs"]);
    assert_eq!(error, "office.pvs: byte 0: this is no packed visibility table");
    let error = folder.refused(&["unpack", "small.pvz", "-o", "small.pvz"]);
    assert_eq!(error, "small.pvz: the output would replace the input");
}

/// A table that is built under a packed name has the bytes of the plain one, packed.
#[test]
fn tables_are_built_packed() {
    let folder = Folder::new();
    folder.run(&["generate", "tower", "--floors", "1", "--rooms-x", "2", "-o", "a.glb"]).expect(0);
    folder.run(&["build", "a.glb", "-o", "a.pvs"]).expect(0);
    folder.run(&["pack", "a.pvs", "-o", "packed.pvz"]).expect(0);
    folder.run(&["build", "a.glb", "-o", "built.PVZ"]).expect(0);
    assert!(folder.read("built.PVZ") == folder.read("packed.pvz"));
    assert!(folder.read("built.PVZ") != folder.read("a.pvs"));
    folder.run(&["unpack", "built.PVZ", "-o", "back.pvs"]).expect(0);
    assert!(folder.read("back.pvs") == folder.read("a.pvs"));
    // Row by row.
    let how = ["--method", "shafts", "--grid", "3,2,3"];
    folder.run(&[&["build", "a.glb", "-o", "b.pvs"][..], &how].concat()).expect(0);
    folder.run(&["pack", "b.pvs", "-o", "packed.pvz", "--class", "large"]).expect(0);
    folder.run(&[&["build", "a.glb", "-o", "rows.pvz", "--class", "large"][..], &how].concat()).expect(0);
    assert!(folder.read("rows.pvz") == folder.read("packed.pvz"));
    let error = folder.refused(&["build", "a.glb", "-o", "b.pvs", "--class", "large"]);
    assert_eq!(error, "b.pvs: --class is for packed tables, whose names end in .pvz");
}
