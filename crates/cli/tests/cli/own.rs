//! The visibility that maps have of their own, checked against their geometry.

use crate::common::quake::{Map, rooms, row_of_leafs, small_maps};
use crate::common::{Folder, doom_map, wad};
use serde_json::{Value, json};
use sightlines::formats::doom::{DoomMap, list_maps, write_doom_map};
use sightlines::formats::quake::visibility::{lump, read_visibility};
use sightlines::formats::quake::{Bsp, BspFormat, prt::parse_prt};
use sightlines::formats::{LumpName, RejectTable, Wad};
use sightlines::pvs::BitMatrix;

fn written(map: &Map) -> Folder {
    let folder = Folder::new();
    folder.write("map.bsp", &map.bsp);
    folder.write("map.prt", &map.prt);
    folder.run(&["vis", "map.bsp", "-o", "seen.bsp"]).expect(0);
    folder
}

/// The map with another visibility.
fn changed(folder: &Folder, to: &str, change: impl FnOnce(&mut BitMatrix)) {
    let bsp = Bsp::parse(folder.read("seen.bsp")).expect("a sound map");
    let leafs = parse_prt(&folder.read("map.prt")).expect("sound portals").leaf_clusters();
    let mut seen = read_visibility(&bsp, &leafs).expect("sound rows").expect("some");
    change(&mut seen);
    let lump = lump(&bsp, &leafs, &seen).expect("rows of this map");
    folder.write(to, bsp.with_visibility(&lump).expect("a small map"));
}

fn verify(folder: &Folder, args: &[&str], code: i32) -> Value {
    let rays = if args.contains(&"--rays") { &[][..] } else { &["--rays", "5000", "--pairs", "2000"] };
    folder.run(&[&["verify", "--json"], rays, args].concat()).expect(code).json()
}

/// Two sides that see each other but are not joined, all of them.
fn seen_apart(folder: &Folder) -> Vec<[usize; 2]> {
    let prt = parse_prt(&folder.read("map.prt")).expect("sound portals");
    let bsp = Bsp::parse(folder.read("seen.bsp")).expect("a sound map");
    let seen = read_visibility(&bsp, &prt.leaf_clusters()).expect("sound rows").expect("some");
    let joined = |a: usize, b: usize| prt.portals().any(|p| [[a, b], [b, a]].contains(&p.clusters.map(|c| c as usize)));
    let n = seen.n_rows();
    let pairs = (0..n).flat_map(|a| (a + 1..n).map(move |b| [a, b]));
    pairs.filter(|&[a, b]| seen.get(a, b) && !joined(a, b)).collect()
}

/// Invariant: what `vis` writes is true to the map; every pair of leafs that is hidden though they see each other is found, named by
/// the numbers of the leafs, with a ray, whether it is hidden both ways or one way only. Against the map and against its portals.
#[test]
fn leafs_that_are_hidden_though_seen_are_found() {
    let folder = written(&row_of_leafs(BspFormat::Bsp29));
    let mut n_found = 0;
    for scene in ["map.bsp", "map.prt", "seen.bsp"] {
        let prt = if scene == "seen.bsp" { &["--prt", "map.prt"][..] } else { &[] };
        let good = verify(&folder, &[&["seen.bsp", scene], prt].concat(), 0);
        assert_eq!((&good["is_true"], &good["own"]["n_leafs"]), (&json!(true), &json!(4)), "{scene}");
        assert!(good["n_rays"].as_u64() > Some(1000) && good["cells"]["n_confirmed"].as_u64() > Some(3), "{good}");
        for [a, b] in seen_apart(&folder) {
            for both in [true, false] {
                changed(&folder, "bad.bsp", |seen| {
                    seen.set(a, b, false);
                    seen.set(b, a, !both);
                });
                let bad = verify(&folder, &[&["bad.bsp", scene], prt].concat(), 1);
                assert_eq!((&bad["is_true"], &bad["n_violations"]), (&json!(false), &json!(1)), "{bad}");
                assert_eq!(bad["own"]["n_hidden_one_way"], json!(u64::from(!both)));
                let reply = &bad["violations"][0];
                // Maps count leafs from 1.
                let mut names =
                    [reply["names"][0].clone(), reply["names"][1].clone()].map(|n| n.as_str().unwrap().to_owned());
                names.sort();
                assert_eq!(names, [a, b].map(|leaf| format!("leaf {}", leaf + 1)), "{bad}");
                assert!(reply["segment"][1][2].is_f64(), "{reply}");
                let text = reply["text"].as_str().expect("words");
                let one_way = format!("leaf {} is hidden from leaf {}, but nothing is between (", b + 1, a + 1);
                assert_eq!(text.contains("are hidden from each other, but nothing is between ("), both, "{text}");
                assert_eq!(text.contains(&one_way), !both, "{text}");
                n_found += 1;
            }
        }
    }
    assert!(n_found >= 18, "{n_found}");
}

#[test]
fn every_format_is_checked() {
    for format in BspFormat::ALL {
        let folder = written(&row_of_leafs(format));
        let good = verify(&folder, &["seen.bsp", "map.bsp"], 0);
        assert_eq!(good["is_true"], true, "{format:?}");
        let pairs = seen_apart(&folder);
        let Some(&[a, b]) = pairs.first() else { continue };
        changed(&folder, "bad.bsp", |seen| seen.set(b, a, false));
        assert_eq!(verify(&folder, &["bad.bsp", "map.bsp"], 1)["n_violations"], 1, "{format:?}");
    }
}

/// Clusters of several leafs are named by their leafs; where these differ in what they see, that is reported.
#[test]
fn clusters_of_several_leafs_are_checked() {
    let (mut n_maps, mut n_uneven) = (0, 0);
    for map in small_maps() {
        let folder = written(&map);
        let good = verify(&folder, &["seen.bsp", "map.prt"], 0);
        assert_eq!((&good["is_true"], &good["own"]["n_uneven_clusters"]), (&json!(true), &json!(0)), "{}", map.name);
        n_maps += 1;
        let leafs = parse_prt(map.prt.as_bytes()).expect("sound portals").leaf_clusters();
        let shared = (0..leafs.n_clusters()).find_map(|c| leafs.leafs_of(c).get(1));
        let (Some(&leaf), BspFormat::Bsp29) = (shared, map.format) else { continue };
        // One of the leafs sees everything: its row is at -1.
        let mut bytes = folder.read("seen.bsp");
        let lump = Bsp::parse(bytes.clone()).expect("a sound map").lumps()[map.format.leaf_lump()].clone();
        let at = lump.start + 28 * (leaf as usize + 1) + 4;
        bytes[at..at + 4].copy_from_slice(&[0xFF; 4]);
        folder.write("uneven.bsp", bytes);
        let reply = verify(&folder, &["uneven.bsp", "map.prt"], 0);
        assert_eq!(reply["own"]["n_uneven_clusters"], 1, "{}", map.name);
        let reply = folder.run(&["verify", "uneven.bsp", "map.prt"]).expect(0).out;
        assert!(reply.contains("1 cluster with leafs that do not see the same"), "{reply}");
        n_uneven += 1;
    }
    assert!(n_maps > 8 && n_uneven > 0, "{n_maps} maps, {n_uneven} uneven");
}

/// Neighbours need no ray, nor does a leaf that does not see itself.
#[test]
fn neighbours_and_the_leaf_itself_are_found_without_rays() {
    let folder = written(&rooms(3, 3));
    assert_eq!(verify(&folder, &["seen.bsp", "map.prt"], 0)["is_true"], true);
    let none = ["--rays", "0", "--pairs", "0"];
    changed(&folder, "bad.bsp", |seen| seen.set(0, 1, false));
    let bad = verify(&folder, &[&["bad.bsp", "map.prt"][..], &none].concat(), 1);
    assert_eq!(bad["violations"][0]["text"], "leaf 2 is hidden from leaf 1, but a portal joins them");
    changed(&folder, "bad.bsp", |seen| seen.set(4, 4, false));
    let bad = verify(&folder, &[&["bad.bsp", "map.prt"][..], &none].concat(), 1);
    assert_eq!(bad["violations"][0]["text"], "leaf 5 is hidden from itself");
    let reply = folder.run(&["verify", "bad.bsp", "map.prt"]).expect(1).out;
    assert!(
        reply.contains("lump           visibility of the map, ") && reply.contains("for 9 leafs in 9 clusters"),
        "{reply}"
    );
    assert!(reply.contains("violation      hidden-from-itself: leaf 5 is hidden from itself\n"), "{reply}");
}

#[test]
fn maps_that_cannot_be_checked_are_refused() {
    let folder = written(&rooms(2, 2));
    let refused = |args: &[&str]| folder.refused(&[&["verify"], args].concat());
    assert_eq!(
        refused(&["map.bsp", "map.bsp"]),
        "map.bsp: there is no visibility lump to check, or an empty one; sightlines vis writes it"
    );
    let error = refused(&["seen.bsp", "seen.bsp"]);
    assert!(
        error.starts_with("seen.bsp: there is no seen.prt beside it, and no portals can be made from the map: "),
        "{error}"
    );
    folder.write("plan.geojson", crate::common::maze_text(1));
    assert_eq!(
        refused(&["seen.bsp", "plan.geojson"]),
        "seen.bsp: is a map, whose own visibility is checked against a Quake map or its portal file; plan.geojson is none"
    );
    assert_eq!(
        refused(&["seen.bsp", "map.prt", "--strict"]),
        "seen.bsp: --proofs or --strict is for tables, and this is a map with its own"
    );
    assert_eq!(
        refused(&["seen.bsp", "map.prt", "--draw", "ray.svg"]),
        "seen.bsp: --draw is for tables and WADs, and this is a map with its own"
    );
    folder.write("larger.prt", rooms(3, 2).prt);
    assert!(refused(&["seen.bsp", "larger.prt"]).starts_with("larger.prt: does not go with seen.bsp: "));
    folder.write("maps.wad", wad(&["MAP01", "MAP02"]));
    assert_eq!(
        refused(&["maps.wad", "maps.wad", "--map", "MAP01"]),
        "maps.wad: map MAP01: there is no REJECT lump to check, or an empty one; sightlines reject writes it"
    );
    assert_eq!(
        refused(&["maps.wad", "map.bsp", "--map", "MAP01"]),
        "maps.wad: is a map, whose own visibility is checked against a WAD with the map; map.bsp is none"
    );
    let mut short = doom_map(1);
    short.reject = Some(vec![0; 2]);
    folder.write("short.wad", write_doom_map(LumpName::new("MAP01").unwrap(), &short).unwrap());
    let error = refused(&["short.wad", "short.wad"]);
    assert!(error.starts_with("short.wad: map MAP01: REJECT has 2 bytes, but "), "{error}");
}

fn reject_of(folder: &Folder, file: &str) -> RejectTable {
    let wad = Wad::parse(folder.read(file)).expect("a sound WAD");
    let map = DoomMap::parse(&wad, &list_maps(&wad)[0]).expect("a sound map");
    RejectTable::from_bytes(map.n_sectors(), map.reject().expect("a lump")).expect("a full table")
}

/// Invariant: what `reject` writes is true to the map; sectors that are hidden though they see each other are found and named.
#[test]
fn sectors_that_are_rejected_though_seen_are_found() {
    let folder = Folder::new();
    let name = LumpName::new("MAP01").unwrap();
    let source = doom_map(4);
    folder.write("plain.wad", write_doom_map(name, &source).unwrap());
    folder.run(&["reject", "plain.wad", "-o", "good.wad"]).expect(0);
    let good = verify(&folder, &["good.wad", "plain.wad"], 0);
    let table = reject_of(&folder, "good.wad");
    let n = table.n_sectors();
    assert_eq!((&good["own"]["lump"], &good["own"]["n_sides"]), (&json!("REJECT"), &json!(n)));
    assert_eq!(good["own"]["n_hidden_pairs"], json!(table.n_rejected() / 2));
    assert!(good["cells"]["n_aimed_at"].as_u64() > Some(10), "{good}");
    let seen: Vec<[u32; 2]> =
        (0..n).flat_map(|a| (0..n).map(move |b| [a, b])).filter(|&[a, b]| a < b && !table.get(a, b)).collect();
    assert!(seen.len() > 5, "{}", seen.len());
    let mut n_found = 0;
    for (k, [a, b]) in seen.into_iter().step_by(3).enumerate() {
        let (mut bad, both) = (table.clone(), k % 2 == 0);
        bad.set(a, b, true);
        bad.set(b, a, both);
        let with = sightlines::formats::doom::DoomMapSource { reject: Some(bad.into_bytes()), ..source.clone() };
        folder.write("bad.wad", write_doom_map(name, &with).unwrap());
        let reply = verify(&folder, &["bad.wad", "plain.wad"], 1);
        assert_eq!(reply["n_violations"], 1, "{reply}");
        let mut names = reply["violations"][0]["names"].as_array().expect("two").clone();
        names.sort_by_key(|name| name.as_str().map(|s| (s.len(), s.to_owned())));
        assert_eq!(names, [a, b].map(|sector| json!(format!("sector {sector}"))), "{reply}");
        let text = reply["violations"][0]["text"].as_str().expect("words");
        assert_eq!(text.contains("from each other"), both, "{text}");
        n_found += 1;
    }
    assert!(n_found > 2, "{n_found}");
    // A sector that does not see itself was made by hand, and is reported.
    let mut blind = table.clone();
    blind.set(1, 1, true);
    let with = sightlines::formats::doom::DoomMapSource { reject: Some(blind.into_bytes()), ..source };
    folder.write("blind.wad", write_doom_map(name, &with).unwrap());
    let reply = folder.run(&["verify", "blind.wad", "blind.wad", "--draw", "ray.svg"]).expect(1).out;
    assert!(reply.contains("sector 1 is hidden from itself"), "{reply}");
}

/// Invariant: the own visibility of real maps, as `vis` and `reject` write it, is true to them.
#[test]
fn real_maps_are_true_to_themselves() {
    let Some(data) = std::env::var_os("SIGHTLINES_DATA").map(std::path::PathBuf::from) else {
        eprintln!("SKIPPED real_maps_are_true_to_themselves: SIGHTLINES_DATA is not set");
        return;
    };
    assert!(data.is_dir(), "SIGHTLINES_DATA names no folder: {}", data.display());
    let folder = Folder::new();
    let map = data.join("quake/dm6.bsp").display().to_string();
    folder.write("map.prt", std::fs::read(data.join("quake/dm6.prt")).expect("the portals of the map"));
    folder.run(&["vis", &map, "--prt", "map.prt", "-o", "seen.bsp", "--quiet"]).expect(0);
    // Rays through a map for Quake take most of the time.
    let few = ["--rays", "5000", "--pairs", "500", "--segments", "46"];
    let of_map = |own: &str, rc| verify(&folder, &[&[own, &map][..], &few].concat(), rc);
    assert!(of_map("seen.bsp", 0)["cells"]["n_confirmed"].as_u64() > Some(1000));
    let [a, b] = seen_apart(&folder)[1000];
    changed(&folder, "bad.bsp", |seen| seen.set(a, b, false));
    assert_eq!(of_map("bad.bsp", 1)["n_violations"], 1);
    let wad = data.join("doom/freedoom1_E1M1.wad").display().to_string();
    assert_eq!(verify(&folder, &[&wad, &wad], 0)["is_true"], true);
    folder.run(&["reject", &wad, "-o", "out.wad", "--force"]).expect(0);
    assert!(verify(&folder, &["out.wad", &wad], 0)["own"]["n_hidden_pairs"].as_u64() > Some(1000));
    // One pair of a map as it was published is rejected though a line passes twelve two-sided lines from the one to the other, and no
    // one-sided line.
    let wad = data.join("doom/freedoom1_E1M3.wad").display().to_string();
    let reply = verify(&folder, &[&wad, &wad, "--rays", "20000", "--pairs", "3000"], 1);
    assert_eq!(
        (&reply["n_violations"], &reply["violations"][0]["names"]),
        (&json!(1), &json!(["sector 101", "sector 200"]))
    );
    folder.run(&["reject", &wad, "-o", "mended.wad", "--force"]).expect(0);
    assert_eq!(verify(&folder, &["mended.wad", &wad, "--rays", "20000", "--pairs", "3000"], 0)["is_true"], true);
}
