//! Visibility of Quake maps through the command line.

use crate::common::quake::{Map, Portals, rooms, row_of_leafs, small_maps};
use crate::common::{Folder, Run};
use serde_json::{Value, json};
use sightlines::bake::from_table::convex_graph;
use sightlines::formats::quake::prt::{LeafList, parse_prt, write_prt};
use sightlines::formats::quake::visibility::{VisibilityLump, read_visibility};
use sightlines::formats::quake::{Bsp, BspFormat, Prt};
use sightlines::pvs::{BitMatrix, CellId, Table};

/// What a map of the folder says that its clusters see.
fn seen(folder: &Folder, name: &str, portals: &Portals) -> BitMatrix {
    let bsp = Bsp::parse(folder.read(name)).expect("a sound map");
    let leafs = parse_prt(portals.as_bytes()).expect("sound portals").leaf_clusters();
    read_visibility(&bsp, &leafs).expect("sound visibility").expect("visibility was written")
}

fn with(maps: &Map) -> Folder {
    let folder = Folder::new();
    folder.write("map.bsp", &maps.bsp);
    folder.write("map.prt", &maps.prt);
    folder
}

/// Every format with every dialect that goes with it: the table of the portals and the map say the same, and
/// nothing else of the map has changed.
#[test]
fn maps_get_what_the_table_of_their_portals_says() {
    let mut n_maps = 0;
    for map in small_maps().into_iter().chain([rooms(5, 4)]) {
        let folder = with(&map);
        let reply = folder.run(&["vis", "map.bsp", "-o", "out.bsp", "--json"]).expect(0).json();
        folder.run(&["build", "map.prt", "-o", "map.pvs"]).expect(0);
        let table = Table::from_bytes(&folder.read("map.pvs")).expect("a sound table");
        let seen = seen(&folder, "out.bsp", &map.prt);
        for cell in (0..table.n_cells() as u32).map(CellId) {
            let row: Vec<usize> = table.visible(cell).map(|other| other.idx()).collect();
            assert_eq!(row, seen.iter_ones(cell.idx()).collect::<Vec<_>>(), "{}", map.name);
        }
        assert!(convex_graph(&table).is_some());
        let n_pairs = (seen.count_ones() - seen.n_rows() as u64) / 2;
        assert_eq!((&reply["n_visible_pairs"], &reply["n_clusters"]), (&json!(n_pairs), &json!(seen.n_rows())));
        assert_eq!(crate::common::quake::difference(&map.bsp, &folder.read("out.bsp")), None, "{}", map.name);
        assert_eq!(folder.read("map.bsp"), map.bsp);
        assert_eq!(folder.names(), ["map.bsp", "map.prt", "map.pvs", "out.bsp"], "no state stays behind");
        n_maps += 1;
    }
    assert!(n_maps > 10, "{n_maps}");
}

/// A portal file with the corners of every portal, or of one, in the other order is refused, with the line.
#[test]
fn portals_inside_out_are_refused() {
    let map = rooms(3, 2);
    let parsed = parse_prt(map.prt.as_bytes()).expect("sound portals");
    // A portal with others on both sides.
    let n_of = |cluster: u32| parsed.portals().filter(|p| p.clusters.contains(&cluster)).count();
    let inner = parsed.portals().position(|p| p.clusters.iter().all(|&cluster| n_of(cluster) > 1)).expect("a grid");
    for only in [None, Some(inner)] {
        let mut turned = Prt::new(parsed.n_clusters()).expect("clusters");
        for (k, portal) in parsed.portals().enumerate() {
            let mut points = portal.points.to_vec();
            if only.is_none_or(|only| only == k) {
                points.reverse();
            }
            turned.push_portal(portal.clusters, &points).expect("as good as before");
        }
        let turned = turned.with_leafs(LeafList::PerCluster, parsed.leaf_clusters().cluster_of_leaf().to_vec());
        let folder = with(&map);
        folder.write("map.prt", write_prt(&turned.expect("the same leafs")));
        for arguments in [&["vis", "map.bsp", "-o", "out.bsp"][..], &["build", "map.prt", "-o", "out.pvs"]] {
            let run = folder.run(arguments).expect(2);
            let line = 5 + only.unwrap_or(0);
            assert!(run.err.contains(&format!("line {line}")), "{}", run.err);
            assert!(run.err.contains("corners are in the wrong order"), "{}", run.err);
        }
        assert_eq!(folder.names(), ["map.bsp", "map.prt"], "nothing is written");
    }
}

/// Where only one cluster tells, as at a dead end, the tree of the map does: each portal of a row of leafs is found, in every format, with the line.
#[test]
fn single_portals_inside_out_are_refused() {
    let mut n_found = 0;
    for map in BspFormat::ALL.map(row_of_leafs) {
        let parsed = parse_prt(map.prt.as_bytes()).expect("sound portals");
        for turned in 0..parsed.n_portals() {
            let mut other = Prt::new(parsed.n_clusters()).expect("clusters");
            for (k, portal) in parsed.portals().enumerate() {
                let mut points = portal.points.to_vec();
                if k == turned {
                    points.reverse();
                }
                other.push_portal(portal.clusters, &points).expect("as good as before");
            }
            let folder = with(&map);
            folder.write("map.prt", write_prt(&other));
            let table = Table::from_bytes(&{
                let sound = with(&map);
                sound.run(&["build", "map.bsp", "-o", "t.pvs"]).expect(0);
                sound.read("t.pvs")
            });
            folder.write("t.pvs", table.expect("a sound table").to_bytes());
            for arguments in [
                &["vis", "map.bsp", "-o", "out.bsp"][..],
                &["build", "map.bsp", "-o", "out.pvs"],
                &["verify", "t.pvs", "map.bsp"],
            ] {
                let run = folder.run(arguments).expect(2);
                let wrong = format!(": portal {turned}: its corners are in the wrong order");
                let says = [format!("map.prt: line {}", 4 + turned), wrong];
                assert!(says.iter().all(|text| run.err.contains(text)), "{}", run.err);
            }
            assert_eq!(folder.names(), ["map.bsp", "map.prt", "t.pvs"], "nothing is written");
            n_found += 1;
        }
    }
    assert!(n_found > 10, "{n_found}");
}

/// A portal file that has every portal twice says the same as one that has it once, with a warning, and takes about as long.
#[test]
fn repeated_portals_are_used_once() {
    let map = rooms(3, 2);
    let parsed = parse_prt(map.prt.as_bytes()).expect("sound portals");
    let mut twice = Prt::new(parsed.n_clusters()).expect("clusters");
    for portal in parsed.portals() {
        let [a, b] = portal.clusters;
        let mut points = portal.points.to_vec();
        twice.push_portal([a, b], &points).expect("as before");
        points.reverse();
        twice.push_portal([b, a], &points).expect("the same from the other side");
    }
    let twice = twice.with_leafs(LeafList::PerCluster, parsed.leaf_clusters().cluster_of_leaf().to_vec());
    let folder = with(&map);
    let once = folder.run(&["vis", "map.bsp", "-o", "once.bsp", "--json"]).expect(0);
    assert!(!once.err.contains("repeat"), "{}", once.err);
    folder.write("map.prt", write_prt(&twice.expect("the same leafs")));
    let run = folder.run(&["vis", "map.bsp", "-o", "twice.bsp", "--json"]).expect(0);
    let n = parsed.n_portals();
    assert!(run.err.contains(&format!("{n} portals repeat earlier ones and are ignored")), "{}", run.err);
    assert_eq!(folder.read("twice.bsp"), folder.read("once.bsp"));
    assert_eq!(run.json()["counters"], once.json()["counters"], "the same work");
    let built = folder.run(&["build", "map.prt", "-o", "map.pvs", "--json"]).expect(0);
    assert!(built.err.contains("portals repeat earlier ones"), "{}", built.err);
    assert_eq!(folder.run(&["info", "map.prt", "--json"]).expect(0).json()["n_repeated_portals"], json!(n));
}

/// The impostor of the comparison above: a lump that lacks a pair.
#[test]
fn a_missing_pair_would_be_found() {
    let map = rooms(3, 2);
    let folder = with(&map);
    folder.run(&["vis", "map.bsp", "-o", "out.bsp"]).expect(0);
    let right = seen(&folder, "out.bsp", &map.prt);
    let bsp = Bsp::parse(folder.read("out.bsp")).unwrap();
    let leafs = parse_prt(map.prt.as_bytes()).unwrap().leaf_clusters();
    let mut less = right.clone();
    less.set(0, 0, false);
    let lump: VisibilityLump = sightlines::formats::quake::visibility::lump(&bsp, &leafs, &less).unwrap();
    folder.write("less.bsp", bsp.with_visibility(&lump).unwrap());
    assert_ne!(seen(&folder, "less.bsp", &map.prt), right);
}

#[test]
fn the_number_of_threads_changes_nothing() {
    for fast in [false, true] {
        let folder = with(&rooms(6, 5));
        let vis = |threads: &str| -> (Vec<u8>, Value) {
            let fast = if fast { &["--fast"][..] } else { &[] };
            let args = [&["vis", "map.bsp", "-o", "out.bsp", "--json", "--threads", threads][..], fast].concat();
            let reply = folder.run(&args).expect(0).json();
            assert_eq!(reply["fast"], json!(fast.len() == 1));
            (folder.read("out.bsp"), reply["counters"].clone())
        };
        let one = vis("1");
        assert!(one == vis("2") && one == vis("8") && one == vis("0"));
        assert!(one.1.as_object().is_some_and(|counters| !counters.is_empty()));
    }
}

/// Without options the map is replaced, by the portals beside it; visibility that is there is replaced too.
#[test]
fn a_map_is_replaced() {
    let map = rooms(4, 3);
    let folder = with(&map);
    folder.run(&["vis", "map.bsp", "-o", "out.bsp"]).expect(0);
    let reply = folder.run(&["vis", "map.bsp"]).expect(0).out;
    assert!(reply.starts_with("wrote map.bsp, ") && reply.contains("\nclusters       12\n"), "{reply}");
    let line = |start: &str| reply.lines().any(|line| line.starts_with(start));
    assert!(["portals  ", "visible pairs  ", "undecided  ", "effort  ", "time  "].into_iter().all(line), "{reply}");
    assert!(folder.read("map.bsp") == folder.read("out.bsp") && folder.read("map.bsp") != map.bsp);
    // Again, over another visibility: everything sees everything.
    let bsp = Bsp::parse(folder.read("map.bsp")).unwrap();
    let leafs = parse_prt(map.prt.as_bytes()).unwrap().leaf_clusters();
    let mut all = BitMatrix::identity(12);
    (0..12).for_each(|a| (0..12).for_each(|b| all.set(a, b, true)));
    let lump = sightlines::formats::quake::visibility::lump(&bsp, &leafs, &all).unwrap();
    folder.write("map.bsp", bsp.with_visibility(&lump).unwrap());
    folder.run(&["vis", "map.bsp", "--quiet"]).expect(0);
    let after = seen(&folder, "map.bsp", &map.prt);
    assert_eq!(after, seen(&folder, "out.bsp", &map.prt));
    assert_eq!(folder.names(), ["map.bsp", "map.prt", "out.bsp"]);
}

#[test]
fn files_are_recognized_by_their_content() {
    let map = rooms(3, 3);
    let folder = with(&map);
    folder.write("portals", &map.prt);
    folder.write("map", &map.bsp);
    let reply = folder.run(&["info", "portals", "--json"]).expect(0).json();
    assert_eq!((&reply["kind"], &reply["n_clusters"], &reply["n_portals"]), (&json!("portals"), &json!(9), &json!(12)));
    let reply = folder.run(&["info", "map", "--json"]).expect(0).json();
    assert_eq!((&reply["visibility"], &reply["n_seen_pairs"]), (&json!("none"), &Value::Null));
    folder.run(&["vis", "map", "--prt", "portals", "-o", "done"]).expect(0);
    let reply = folder.run(&["info", "done", "--json"]).expect(0).json();
    let n_seen = seen(&folder, "done", &map.prt).count_ones() - 9;
    assert_eq!((&reply["visibility"], &reply["n_seen_pairs"]), (&json!("there"), &json!(n_seen)));
    for format in BspFormat::ALL {
        folder.write("map", small_maps().into_iter().find(|map| map.format == format).unwrap().bsp);
        let reply = folder.run(&["info", "map"]).expect(0).out;
        assert!(
            reply.starts_with(&format!("map: {} map, {}\n", format.game(), format.name()))
                && reply.contains("\nvisibility  "),
            "{reply}"
        );
    }
    // CRLF is whitespace.
    folder.write("crlf", map.prt.replace('\n', "\r\n"));
    folder.run(&["vis", "map.bsp", "--prt", "crlf", "-o", "out"]).expect(0);
    assert_eq!(folder.read("out"), folder.read("done"));
}

/// A table of portals has no places, so whatever needs one refuses it.
#[test]
fn tables_of_portals_answer_what_they_can() {
    let folder = with(&rooms(3, 2));
    let reply = folder.run(&["build", "map.prt", "-o", "map.pvs", "--verbose"]).expect(0).out;
    assert!(reply.starts_with("wrote map.pvs, ") && reply.contains("\nclusters       6\n"), "{reply}");
    let reply = folder.run(&["info", "map.pvs"]).expect(0).out;
    assert!(reply.contains("\nsource         portal file PRT1\n") && !reply.contains("volume"), "{reply}");
    let reply = folder.run(&["info", "map.pvs", "--json"]).expect(0).json();
    assert_eq!((&reply["mean_floor_share"], &reply["n_portals"]), (&Value::Null, &json!(7)));
    assert_eq!(folder.run(&["export", "map.pvs"]).expect(0).json()["cells"].as_array().map(Vec::len), Some(6));
    for args in [&["query", "map.pvs", "--eye", "1,2,3"][..], &["draw", "map.pvs", "-o", "out.svg", "--isometric"]] {
        let error = folder.refused(args);
        let start = "map.pvs: the table is of a portal file, which does not say where its cells are: ";
        assert!(error.starts_with(start), "{error}");
    }
    for (args, text) in [
        (&["--tau", "0.5"][..], "map.prt: --tau is for plans and scenes in space, and this is a portal file"),
        (&["--subdivide", "kd"], "map.prt: --subdivide is for plans, and this is a portal file"),
        (&["--keep-solid"], "map.prt: --keep-solid is for scenes in space, and this is a portal file"),
        (&["--map", "E1M1"], "map.prt: --map is for WADs, and this is none"),
    ] {
        assert_eq!(folder.refused(&[&["build", "map.prt", "-o", "out.pvs"][..], args].concat()), text);
    }
    assert_eq!(folder.names(), ["map.bsp", "map.prt", "map.pvs"]);
    let folder = Folder::with_office();
    let error = folder.refused(&["build", "office.geojson", "-o", "out.pvs", "--fast"]);
    assert_eq!(error, "office.geojson: --fast is for portal files, and this is a plan");
}

/// All results of a search of portals, as a run keeps them.
fn state(map: &Map, portals: &str, fast: bool) -> Vec<u8> {
    let folder = with(map);
    folder.write("map.prt", portals);
    let how = if fast { &["-fast"][..] } else { &[] };
    folder.run_vis(&[how, &["-noautoclean", "map"]].concat()).expect(0);
    folder.read("map.bsp.state")
}

fn vis(folder: &Folder, more: &[&str]) -> Run {
    folder.run(&[&["vis", "map.bsp", "-o", "out.bsp", "--json"][..], more].concat())
}

#[test]
fn a_run_goes_on_where_another_stopped() {
    let map = rooms(6, 4);
    let folder = with(&map);
    let whole = vis(&folder, &[]).expect(0).json();
    let bytes = folder.read("out.bsp");
    let state = state(&map, &map.prt, false);
    let mut n_resumed = 0;
    for eighths in 0..=8 {
        // As a run leaves it that was killed, while it wrote for most of these.
        folder.write("out.bsp.state", &state[..state.len() * eighths / 8]);
        let reply = vis(&folder, &["--resume", "--threads", "2"]).expect(0).json();
        assert_eq!(reply["counters"], whole["counters"], "{eighths} eighths");
        assert_eq!(folder.read("out.bsp"), bytes);
        n_resumed += usize::from(reply["resumed"] == json!(true));
        if eighths > 0 {
            assert_eq!(folder.names(), ["map.bsp", "map.prt", "out.bsp"], "the state is gone");
        }
        let _ = std::fs::remove_file(folder.path("out.bsp.state"));
    }
    assert!(n_resumed > 2, "{n_resumed}");
    // A map that was compiled again has other bytes and the same portals.
    folder.write("out.bsp.state", &state);
    folder.write("map.bsp", &bytes);
    assert_eq!(vis(&folder, &["--resume"]).expect(0).json()["resumed"], json!(true));
    assert_eq!(folder.read("out.bsp"), bytes);
    // Nothing to go on from is no error, but said.
    let run = vis(&folder, &["--resume", "--state", "other"]).expect(0);
    assert!(run.err.contains("other: there is nothing to go on from") && run.json()["resumed"] == json!(false));
    assert_eq!(folder.read("out.bsp"), bytes);
}

/// A state that the run writes itself is one that can be resumed, and not read unless asked for.
#[test]
fn a_state_is_written_and_only_read_when_asked_for() {
    let map = rooms(6, 4);
    let folder = with(&map);
    vis(&folder, &[]).expect(0);
    let bytes = folder.read("out.bsp");
    let (own, other) = (state(&map, &map.prt, false), state(&map, &map.prt, true));
    folder.write("out.bsp.state", &other);
    assert_eq!(vis(&folder, &[]).expect(0).json()["resumed"], json!(false));
    assert!(folder.read("out.bsp") == bytes && folder.read("out.bsp.state") == other);
    folder.write("out.bsp.state", &own);
    let run = vis(&folder, &[]).expect(0);
    assert!(run.err.contains("out.bsp.state: beginning without its "), "{}", run.err);
    assert!(run.json()["resumed"] == json!(false) && folder.read("out.bsp") == bytes);
    assert!(!folder.path("out.bsp.state").exists(), "it is of the same search, which is done");
    // The folder of the output is no folder, so the state is all that would be written.
    folder.write("states", "");
    let error = folder.refused(&["vis", "map.bsp", "-o", "states/out.bsp", "--state", "kept", "--save-after", "0"]);
    assert!(error.starts_with("states/out.bsp: cannot be written: "), "{error}");
    assert!(!folder.names().contains(&"kept".to_owned()), "that is found before the search");
    let run = folder.run(&["vis", "map.bsp", "-o", "out.bsp", "--state", "no/state", "--save-after", "0"]).expect(0);
    assert!(
        run.err.contains("no/state: cannot be written") && run.err.contains("cannot go on from there"),
        "{}",
        run.err
    );
    assert_eq!(folder.read("out.bsp"), bytes, "a state that cannot be kept is no reason to stop");
}

#[test]
fn stale_states_are_refused_by_name() {
    let map = rooms(5, 3);
    let folder = with(&map);
    folder.write("out.bsp", "precious");
    let sound = state(&map, &map.prt, false);
    let mut newer = sound.clone();
    newer[8] = 200;
    let other = rooms(4, 3);
    let (of_other, form) = ("the results are of another input or of other options", "the form of another version");
    for (bytes, what) in [
        (state(&map, &map.prt.replace('\n', "\r\n"), false), of_other),
        (state(&map, &map.prt, true), of_other),
        (state(&other, &other.prt, false), of_other),
        (newer, form),
        // What `vis` wrote before it kept results of units.
        (b"\x8ESLVIS\r\n\x01\0\0\0".to_vec(), form),
    ] {
        for name in ["out.bsp.state", "named"] {
            folder.write(name, &bytes);
            let error = folder.refused(&["vis", "map.bsp", "-o", "out.bsp", "--resume", "--state", name]);
            let end = "; without --resume the work begins anew";
            assert!(error.starts_with(&format!("{name}: ")) && error.contains(what) && error.ends_with(end), "{error}");
            assert_eq!((folder.read("out.bsp"), folder.read(name)), (b"precious".to_vec(), bytes.clone()));
        }
    }
    // What is no state at all is not overwritten either.
    for more in [&[][..], &["--resume"]] {
        for (name, what) in
            [("map.bsp", "two outputs"), ("map.prt", "two outputs"), ("out.bsp", "would be overwritten")]
        {
            let before = folder.read(name);
            let error = folder.refused(&[&["vis", "map.bsp", "-o", "new.bsp", "--state", name][..], more].concat());
            assert!(error.starts_with(name) && error.contains(what), "{error}");
            assert_eq!(folder.read(name), before);
        }
    }
}

/// A changed byte anywhere in a state costs the record that it is in, or the state is refused; nothing else is found.
#[test]
fn damaged_results_are_not_used() {
    let map = rooms(5, 3);
    let folder = with(&map);
    let whole = vis(&folder, &[]).expect(0).json();
    let (bytes, sound) = (folder.read("out.bsp"), state(&map, &map.prt, false));
    let (mut n_refused, mut n_passed_over) = (0, 0);
    for at in (0..sound.len()).step_by(sound.len() / 24) {
        let mut damaged = sound.clone();
        damaged[at] ^= 4;
        folder.write("out.bsp.state", &damaged);
        folder.write("out.bsp", "precious");
        let run = vis(&folder, &["--resume"]);
        if run.code == 2 {
            assert!(run.err.starts_with("error: out.bsp.state: "), "{}", run.err);
            assert_eq!((folder.read("out.bsp"), folder.read("out.bsp.state")), (b"precious".to_vec(), damaged));
            n_refused += 1;
            continue;
        }
        let run = run.expect(0);
        n_passed_over += usize::from(run.err.contains("damaged; the rest is used"));
        assert_eq!(folder.read("out.bsp"), bytes, "byte {at}");
        assert_eq!(run.json()["counters"], whole["counters"], "byte {at}");
    }
    assert!(n_refused > 0 && n_passed_over > 5, "{n_refused} {n_passed_over}");
}

/// Killed again and again while it keeps the results of every unit, and taken up again each time, a run ends with
/// the same bytes; what is there of the output until then is the old file.
#[cfg(unix)]
#[test]
fn a_killed_run_loses_nothing() {
    let map = rooms(12, 10);
    let folder = with(&map);
    vis(&folder, &[]).expect(0);
    let bytes = folder.read("out.bsp");
    let args = ["vis", "map.bsp", "-o", "again.bsp", "--resume", "--save-after", "0", "--quiet"];
    folder.write("again.bsp", "precious");
    let mut n_killed = 0;
    for wait in (0..40).map(|k| std::time::Duration::from_millis(2 * k)) {
        let mut child = std::process::Command::new(env!("CARGO_BIN_EXE_sightlines"))
            .args(args)
            .current_dir(folder.path("."))
            .stdout(std::process::Stdio::null())
            .spawn()
            .unwrap();
        std::thread::sleep(wait);
        child.kill().unwrap();
        let ended = child.wait().unwrap().code() == Some(0);
        let now = folder.read("again.bsp");
        assert!(now == bytes || (!ended && now == b"precious"), "the output is the old file or the new one");
        n_killed += usize::from(!ended);
        if ended {
            break;
        }
    }
    assert!(n_killed > 0);
    folder.run(&args).expect(0);
    assert_eq!(folder.read("again.bsp"), bytes);
}
