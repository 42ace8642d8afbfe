//! What a user wants a map to show and hide: against visibility without wishes, changed by hand; and visibility without its map.

use crate::common::Folder;
use crate::common::quake::{Map, rooms, row_of_leafs};
use serde_json::json;
use sightlines::formats::quake::prt::parse_prt;
use sightlines::formats::quake::vis_patch::{VisPatch, parse_vis_patches, write_vis_patches};
use sightlines::formats::quake::visibility::read_visibility;
use sightlines::formats::quake::{Bsp, BspFormat};
use sightlines::pvs::BitMatrix;

fn with(map: &Map) -> Folder {
    let folder = Folder::new();
    folder.write("map.bsp", &map.bsp);
    folder.write("map.prt", &map.prt);
    folder
}

/// What a map of the folder says.
fn seen(folder: &Folder, name: &str, map: &Map) -> BitMatrix {
    let bsp = Bsp::parse(folder.read(name)).expect("a sound map");
    let leafs = parse_prt(map.prt.as_bytes()).expect("sound portals").leaf_clusters();
    read_visibility(&bsp, &leafs).expect("sound visibility").expect("visibility was written")
}

/// The square of the distance of two rooms of 16 by 16 in rows of five, each widened by one.
fn square(a: usize, b: usize) -> usize {
    let gap = |a: usize, b: usize| (16 * a.abs_diff(b)).saturating_sub(18);
    gap(a % 5, b % 5).pow(2) + gap(a / 5, b / 5).pow(2)
}

/// Hidden is what was, and what is farther apart; each distance is reached exactly.
#[test]
fn what_is_too_far_away_is_hidden_and_nothing_else() {
    let map = rooms(5, 4);
    let folder = with(&map);
    folder.run(&["vis", "map.bsp", "-o", "all.bsp"]).expect(0);
    let all = seen(&folder, "all.bsp", &map);
    let (mut n_far, mut n_near) = (0, 0);
    for distance in [1, 13, 14, 15, 29, 30, 31, 1000] {
        let text = distance.to_string();
        let reply = folder.run(&["vis", "map.bsp", "-o", "near.bsp", "--visdist", &text, "--json"]).expect(0).json();
        let near = seen(&folder, "near.bsp", &map);
        let pairs = || (0..20).flat_map(|a| (0..20).map(move |b| (a, b)));
        let differs =
            |most: usize| pairs().filter(|&(a, b)| near.get(a, b) != (all.get(a, b) && square(a, b) <= most)).count();
        assert_eq!(differs(distance * distance), 0, "{distance}");
        let far = pairs().filter(|&(a, b)| a < b && all.get(a, b) && !near.get(a, b)).count();
        assert_eq!(
            (&reply["wishes"]["n_far_pairs"], &reply["wishes"]["visdist"]),
            (&json!(far), &json!(distance as f64))
        );
        // What is visible stays in the report, and the impostor: another distance is noticed.
        assert_eq!(reply["n_visible_pairs"], json!((all.count_ones() - 20) / 2));
        if distance == 14 || distance == 30 {
            assert!(differs((distance - 1) * (distance - 1)) > 0 && far > 0, "{distance}");
        }
        (n_far, n_near) = (n_far + far, n_near + pairs().filter(|&(a, b)| a < b && near.get(a, b)).count());
        if distance == 1000 {
            assert_eq!(folder.read("near.bsp"), folder.read("all.bsp"));
        }
    }
    assert!(n_far > 20 && n_near > 100, "{n_far} {n_near}");
    // The other program takes the same wish, says so, and takes 0 for none.
    for (distance, name) in [("14", true), ("0", false), ("-5", false)] {
        folder.write("copy.bsp", &map.bsp);
        folder.write("copy.prt", &map.prt);
        let run = folder.run_vis(&["-visdist", distance, "-quiet", "copy.bsp"]).expect(0);
        assert_eq!(run.out.contains("wishes "), name, "{}", run.out);
        let like = if name { &["--visdist", "14"][..] } else { &[] };
        folder.run(&[&["vis", "map.bsp", "-o", "like.bsp"], like].concat()).expect(0);
        assert_eq!(folder.read("copy.bsp"), folder.read("like.bsp"));
    }
}

#[test]
fn overrides_count_in_their_order() {
    let map = rooms(5, 4);
    let folder = with(&map);
    folder.run(&["vis", "map.bsp", "-o", "all.bsp"]).expect(0);
    let all = seen(&folder, "all.bsp", &map);
    let hidden = (1..20).find(|&b| !all.get(0, b)).expect("a hidden pair");
    let text =
        format!("# what a mapper wants\nshow 1 {}\r\n\nhide 2 3 # one way\nshow 1 2\nhide 7 6\nshow 6 7\n", hidden + 1);
    folder.write("wishes.txt", text);
    let args = ["vis", "map.bsp", "-o", "out.bsp", "--overrides", "wishes.txt"];
    let reply = folder.run(&[&args[..], &["--json"]].concat()).expect(0).json();
    let out = seen(&folder, "out.bsp", &map);
    let mut expected = all.clone();
    [(0, hidden, true), (hidden, 0, true), (1, 2, false)].iter().for_each(|&(a, b, is)| expected.set(a, b, is));
    assert_eq!(out, expected);
    // The impostor: the same in both directions.
    expected.set(2, 1, false);
    assert_ne!(out, expected);
    let wishes = json!({"visdist": null, "n_far_pairs": 0, "n_shown": 2, "n_hidden": 2, "n_without_effect": 1});
    assert_eq!(reply["wishes"], wishes);
    assert!(folder.run(&args).expect(0).out.contains("wishes         5 overrides: 2 show, 2 hide, 1 change nothing"));
    // They come behind a distance, and a map without either has no wishes.
    folder.run(&[&args[..], &["--visdist", "1"]].concat()).expect(0);
    assert!(seen(&folder, "out.bsp", &map).get(0, hidden));
    assert_eq!(folder.run(&["vis", "map.bsp", "-o", "out.bsp", "--json"]).expect(0).json()["wishes"], json!(null));
}

#[test]
fn wishes_that_cannot_be_granted_are_refused_before_the_search() {
    let folder = with(&rooms(5, 4));
    for (text, wrong) in [
        ("show 1 2\nshow 1", "wishes.txt: line 2: neither `show A B` nor `hide A B`, with the numbers of two leafs"),
        ("see 1 2", "wishes.txt: line 1: neither `show A B` nor `hide A B`, with the numbers of two leafs"),
        ("hide -1 2", "wishes.txt: line 1: neither `show A B` nor `hide A B`, with the numbers of two leafs"),
        ("hide 3 3", "wishes.txt: leafs 3 and 3 of an override are in one cluster, which sees itself"),
        ("show 0 3", "wishes.txt: leaf 0 of an override is none of the map's that can be seen"),
        ("show 3 21", "wishes.txt: leaf 21 of an override is none of the map's that can be seen"),
    ] {
        folder.write("wishes.txt", text);
        let run = folder.run(&["vis", "map.bsp", "-o", "out.bsp", "--overrides", "wishes.txt"]).expect(2);
        assert!(run.err.contains(wrong), "{text}: {}", run.err);
    }
    folder.run(&["vis", "map.bsp", "--visdist", "0"]).expect(2);
    assert_eq!(folder.names(), ["map.bsp", "map.prt", "wishes.txt"]);
}

/// A VisPatch file has what the map would get, and `verify` checks it as it checks a map.
#[test]
fn visibility_without_its_map_is_that_of_the_map() {
    let map = row_of_leafs(BspFormat::Bsp29);
    let folder = with(&map);
    folder.run(&["vis", "map.bsp", "-o", "out.bsp"]).expect(0);
    let reply = folder.run(&["vis", "map.bsp", "-o", "map.vis", "--json"]).expect(0).json();
    assert_eq!(folder.read("map.bsp"), map.bsp);
    assert_eq!(reply["n_bytes"], json!(folder.read("map.vis").len()));
    let patches = parse_vis_patches(&folder.read("map.vis")).expect("a sound file");
    let bsp = Bsp::parse(map.bsp.clone()).expect("a sound map");
    assert_eq!((patches.len(), patches[0].map.as_str()), (1, "map.bsp"));
    assert_eq!(patches[0].put_into(&bsp).expect("it fits"), folder.read("out.bsp"));
    let verified = |name: &str| folder.run(&["verify", name, "map.bsp", "--rays", "2000"]);
    assert!(
        verified("out.bsp").expect(0).out.contains("0 violations")
            == verified("map.vis").expect(0).out.contains("0 violations")
    );
    // Impostors: rows that hide the neighbour, found among the parts of other maps by its name in any case; and files that do not go with the map.
    let mut wrong = patches[0].clone();
    wrong.map = "MAP.BSP".to_owned();
    wrong.visibility.iter_mut().for_each(|byte| *byte &= 1);
    let other = VisPatch { map: "other.bsp".to_owned(), ..patches[0].clone() };
    folder.write("wrong.vis", write_vis_patches(&[other.clone(), wrong]).expect("small"));
    verified("wrong.vis").expect(1);
    folder.write("other.vis", write_vis_patches(&[other]).expect("small"));
    let error = verified("other.vis").expect(2).err;
    assert!(error.contains("other.vis: there is no visibility for map.bsp in it, but for other.bsp"), "{error}");
    let mut moved = patches[0].clone();
    moved.leafs[28 + 8] ^= 1;
    folder.write("moved.vis", write_vis_patches(&[moved]).expect("small"));
    let error = verified("moved.vis").expect(2).err;
    assert!(
        error.contains("moved.vis: the visibility for map.bsp is of another map, or of another version"),
        "{error}"
    );
    folder.write("cut.vis", &folder.read("map.vis")[..50]);
    let error = verified("cut.vis").expect(2).err;
    assert!(error.contains("cut.vis: the part at byte 0 is cut short, or this is no VisPatch file"), "{error}");
    // Engines take no such file for maps of other formats.
    let wide = with(&row_of_leafs(BspFormat::Bsp2));
    let error = wide.run(&["vis", "map.bsp", "-o", "map.vis"]).expect(2).err;
    assert!(error.contains("map.bsp: engines take VisPatch files for maps of Quake's version 29 only"), "{error}");
    assert_eq!(wide.names(), ["map.bsp", "map.prt"]);
}
