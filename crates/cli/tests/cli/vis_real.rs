//! Visibility of real maps of Quake and Quake II through the command line.

use crate::common::Folder;
use crate::common::quake::difference;
use serde_json::json;
use sightlines::bake::from_table::convex_graph;
use sightlines::formats::Bsp;
use sightlines::formats::quake::visibility::{lump, read_hearing, read_visibility};
use sightlines::formats::quake::{BspFormat, read_prt};
use sightlines::pvs::{BitMatrix, CellId, Table};
use std::path::PathBuf;

/// A Quake map whose clusters are of several leafs, and a map of Quake II.
const MAPS: [(&str, BspFormat); 2] = [("dm3", BspFormat::Bsp29), ("base1-test", BspFormat::Quake2)];

fn data(test: &str) -> Option<PathBuf> {
    let Some(folder) = std::env::var_os("SIGHTLINES_DATA").map(PathBuf::from) else {
        eprintln!("SKIPPED {test}: SIGHTLINES_DATA is not set");
        return None;
    };
    assert!(folder.is_dir(), "SIGHTLINES_DATA names no folder: {}", folder.display());
    Some(folder.join("quake"))
}

/// The map and its portals, copied.
fn copied(data: &std::path::Path, name: &str) -> Folder {
    let folder = Folder::new();
    for extension in ["bsp", "prt"] {
        let bytes = std::fs::read(data.join(name).with_extension(extension)).expect("a map and its portals");
        folder.write(&format!("map.{extension}"), bytes);
    }
    folder
}

/// Pairs that are known to see each other.
fn witnessed(data: &std::path::Path, name: &str, n: usize) -> BitMatrix {
    let bytes = std::fs::read(data.join(name).with_extension("seen.bin")).expect("a witness table");
    let words: Vec<u64> = bytes.chunks_exact(8).map(|b| u64::from_le_bytes(b.try_into().expect("8 bytes"))).collect();
    assert_eq!((words[0] as usize, words.len()), (n, 1 + n * n.div_ceil(64)));
    let mut seen = BitMatrix::new(n, n);
    words[1..].chunks_exact(n.div_ceil(64)).enumerate().for_each(|(row, w)| seen.row_mut(row).copy_from_slice(w));
    seen
}

fn n_missing(seen: &BitMatrix, known: &BitMatrix) -> usize {
    let missing = |a: usize| known.iter_ones(a).filter(move |&b| !seen.get(a, b)).count();
    (0..known.n_rows()).map(missing).sum()
}

#[test]
fn real_maps_get_their_visibility() {
    let Some(data) = data("real_maps_get_their_visibility") else { return };
    for (name, format) in MAPS {
        let folder = copied(&data, name);
        let prt = read_prt(folder.path("map.prt")).expect("sound portals");
        let leafs = prt.leaf_clusters();
        let reply = folder.run(&["vis", "map.bsp", "-o", "out.bsp", "--json", "--threads", "1"]).expect(0).json();
        let written = folder.read("out.bsp");
        assert_eq!(difference(&folder.read("map.bsp"), &written), None, "{name}");
        let after = Bsp::parse(written.clone()).expect("a sound map");
        assert_eq!(after.format(), format);
        let seen = read_visibility(&after, &leafs).expect("sound visibility").expect("visibility");

        // As the table of the portals says.
        folder.run(&["build", "map.prt", "-o", "map.pvs"]).expect(0);
        let table = Table::from_bytes(&folder.read("map.pvs")).expect("a sound table");
        assert!(convex_graph(&table).is_some(), "{name}: the portals come back");
        assert_eq!((table.n_cells(), &reply["n_clusters"]), (seen.n_rows(), &json!(seen.n_rows())));
        for cell in 0..table.n_cells() {
            assert_eq!(table.row(CellId(cell as u32)), seen.row(cell), "{name}: cluster {cell}");
        }
        // Of 5,000 visible pairs at most one is there because nothing decided it.
        let n_visible = reply["n_visible_pairs"].as_u64().expect("a number");
        let n_undecided = reply["undecided"].as_array().expect("a list").len() as u64;
        assert!(n_undecided * 5000 <= n_visible, "{name}: {n_undecided} of {n_visible}");
        // Nothing that is known to be seen is hidden; the impostor lacks a pair.
        let known = witnessed(&data, name, seen.n_rows());
        assert_eq!(n_missing(&seen, &known), 0, "{name}");
        let mut less = seen.clone();
        let far = known.iter_ones(7).find(|&b| b != 7).expect("cluster 7 sees another");
        less.set(7, far, false);
        assert_eq!(n_missing(&less, &known), 1);
        // Sounds and what is heard are made of the same.
        let made = lump(&after, &leafs, &seen).expect("a lump");
        assert_eq!(after.visibility(), made.bytes);
        if format == BspFormat::Quake2 {
            let heard = read_hearing(&after).expect("sound visibility").expect("visibility");
            assert!((0..seen.n_rows()).all(|a| seen.iter_ones(a).all(|b| heard.get(a, b))));
            assert!(heard.count_ones() > seen.count_ones());
        } else {
            let ambient: Vec<[u8; 4]> = after.visible_leafs().iter().map(|leaf| leaf.ambient).collect();
            assert_eq!(ambient, made.ambient);
        }
        for threads in ["2", "8"] {
            folder.run(&["vis", "map.bsp", "-o", "out.bsp", "--threads", threads]).expect(0);
            assert!(folder.read("out.bsp") == written, "{name} with {threads} threads");
        }
        eprintln!("{name}: {reply}");
    }
}

/// `--fast` shows what the full search shows, and more.
#[test]
fn fast_shows_more() {
    let Some(data) = data("fast_shows_more") else { return };
    let folder = copied(&data, "dm3");
    let leafs = read_prt(folder.path("map.prt")).expect("sound portals").leaf_clusters();
    let [fast, full] = [&["--fast"][..], &[]].map(|how| {
        folder.run(&[&["vis", "map.bsp", "-o", "out.bsp"][..], how].concat()).expect(0);
        let after = Bsp::parse(folder.read("out.bsp")).expect("a sound map");
        read_visibility(&after, &leafs).expect("sound visibility").expect("visibility")
    });
    assert_eq!(n_missing(&fast, &full), 0);
    assert!(fast.count_ones() > full.count_ones());
}

/// Killed while it works and taken up again, until it is done, a run gives the bytes of one that was left alone.
#[cfg(unix)]
#[test]
fn a_killed_run_of_a_real_map_loses_nothing() {
    let Some(data) = data("a_killed_run_of_a_real_map_loses_nothing") else { return };
    let folder = copied(&data, "dm3");
    folder.run(&["vis", "map.bsp", "-o", "whole.bsp"]).expect(0);
    let before = folder.read("map.bsp");
    let args = ["vis", "map.bsp", "--resume", "--save-after", "0", "--quiet", "--threads", "1"];
    let mut n_kept = 0;
    for wait in [50, 100, 200, 400] {
        let mut child = std::process::Command::new(env!("CARGO_BIN_EXE_sightlines"))
            .args(args)
            .current_dir(folder.path("."))
            .stdout(std::process::Stdio::null())
            .spawn()
            .expect("the program was built");
        std::thread::sleep(std::time::Duration::from_millis(wait));
        child.kill().expect("a child can be killed");
        if child.wait().expect("a child ends").code().is_some() {
            break;
        }
        assert_eq!(folder.read("map.bsp"), before, "the map is as it was");
        n_kept += usize::from(folder.path("map.bsp.state").exists());
    }
    let reply = folder.run(&[&args[..], &["--json"]].concat()).expect(0).json();
    eprintln!("states kept: {n_kept}; {reply}");
    assert!(folder.read("map.bsp") == folder.read("whole.bsp"));
    assert!(!folder.path("map.bsp.state").exists());
}

/// The first Ctrl-C keeps what is done, however short the run was.
#[cfg(unix)]
#[test]
fn an_interrupted_run_of_a_real_map_goes_on() {
    let Some(data) = data("an_interrupted_run_of_a_real_map_goes_on") else { return };
    let folder = copied(&data, "dm3");
    folder.run(&["vis", "map.bsp", "-o", "whole.bsp"]).expect(0);
    let before = folder.read("map.bsp");
    let args = ["vis", "map.bsp", "--resume", "--quiet", "--threads", "1"];
    let mut n_saved = 0;
    for wait in [60, 120, 240, 480] {
        let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_sightlines"));
        command.args(args).current_dir(folder.path(".")).stderr(std::process::Stdio::piped());
        let child = command.stdout(std::process::Stdio::null()).spawn().expect("the program was built");
        std::thread::sleep(std::time::Duration::from_millis(wait));
        // It may be over.
        let _ = std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).output();
        let ended = child.wait_with_output().expect("a child ends");
        if ended.status.success() {
            break;
        }
        // Before the search, nothing is to be saved, and it ends at once.
        assert_eq!(ended.status.code(), Some(130).filter(|_| ended.status.code().is_some()));
        assert_eq!(folder.read("map.bsp"), before, "the map is as it was");
        let text = String::from_utf8(ended.stderr).expect("text");
        let says = text.ends_with("interrupted; the same command with --resume goes on from map.bsp.state\n");
        assert!(!says || folder.path("map.bsp.state").exists(), "{text}");
        n_saved += usize::from(says);
    }
    folder.run(&args).expect(0);
    eprintln!("states saved: {n_saved}");
    assert!(folder.read("map.bsp") == folder.read("whole.bsp") && !folder.path("map.bsp.state").exists());
}

/// Pairs of a real map that are near to seeing each other, or nearly do: all are proven.
#[test]
fn real_pairs_are_proven() {
    let Some(data) = data("real_pairs_are_proven") else { return };
    let folder = copied(&data, "dm3");
    let args = ["vis", "map.bsp", "-o", "out.bsp", "--json", "--certify", "40"];
    let reply = folder.run(&args).expect(0).json();
    for kind in ["visible", "hidden"] {
        let proven = &reply["certified"][kind];
        assert_eq!(proven["n_picked"], json!(40), "{proven}");
        // Some may graze; of all that were looked at when this was written, none did.
        assert!(proven["n_accepted"].as_u64() >= Some(36), "{proven}");
    }
    // Through a table as well: the portals come back to the bit.
    folder.run(&["build", "map.prt", "-o", "map.pvs", "--fast"]).expect(0);
    let known = witnessed(&data, "dm3", 706);
    let mut n_shown = 0;
    for a in (3..706).step_by(140) {
        let Some(b) = known.iter_ones(a).filter(|&b| b != a).last() else { continue };
        let (a, b) = (a.to_string(), b.to_string());
        let reply = folder.run(&["explain", "map.pvs", &a, &b, "--json"]).expect(0).json();
        assert_eq!((&reply["answer"], &reply["checked"]), (&json!("visible"), &json!(true)), "{a} {b}");
        n_shown += 1;
    }
    assert!(n_shown > 2, "{n_shown}");
}
