//! What `sightlines-vis` refuses, and what it notices about files.

use crate::common::quake::{Map, rooms, row_of_leafs};
use crate::common::{Folder, Run};
use sightlines::formats::quake::prt::{parse_prt, write_prt};
use sightlines::formats::quake::{Bsp, BspFormat, Prt};

fn with(map: &Map) -> Folder {
    let folder = Folder::new();
    folder.write("map.bsp", &map.bsp);
    folder.write("map.prt", &map.prt);
    folder
}

/// Both programs refuse the map, with the same words; it stays as it is. What they print.
fn refused(folder: &Folder) -> String {
    let before = folder.read("map.bsp");
    let runs = [folder.run(&["vis", "map.bsp"]), folder.run_vis(&["map"])].map(|run| run.expect(2).err);
    assert_eq!(runs[0], runs[1]);
    assert!(runs[0].starts_with("error: map."), "{}", runs[0]);
    assert_eq!(folder.read("map.bsp"), before);
    runs[0].clone()
}

#[test]
fn wrong_options_are_refused() {
    let folder = with(&rooms(2, 2));
    let before = folder.read("map.bsp");
    for (args, what) in [
        (&["-nosuch", "map"][..], "there is no option -nosuch"),
        (&["-level", "x", "map"], "'x'"),
        (&["-threads", "map"], "'map'"),
        (&["map", "map"], "unexpected argument"),
        (&[], "<MAP>"),
    ] {
        let Run { code, out, err } = folder.run_vis(args);
        assert_eq!((code, out.as_str()), (2, ""), "{args:?}");
        assert!(err.starts_with("error: ") && err.contains(what), "{args:?}: {err}");
    }
    assert_eq!(folder.read("map.bsp"), before);
    let missing = folder.run_vis(&["no such map.map"]).expect(2).err;
    assert!(missing.starts_with("error: no such map.bsp: "), "{missing}");
}

/// Lumps over leafs, which have to change, are found before the search: nothing is printed about one, and no state is written.
#[test]
fn lumps_over_leafs_are_found_before_the_search() {
    let map = rooms(12, 10);
    let folder = with(&map);
    let bsp = Bsp::parse(map.bsp.clone()).expect("a sound map");
    let mut bytes = map.bsp;
    let start = bsp.lumps()[BspFormat::Bsp29.leaf_lump()].start as u32 + 28;
    bytes[4..8].copy_from_slice(&start.to_le_bytes());
    folder.write("map.bsp", &bytes);
    let error = refused(&folder);
    assert!(error.contains("lump 10 (leafs)") && error.contains("lump 0 (entities)"), "{error}");
    let run = folder.run_vis(&["-save-after", "0", "-noautoclean", "map"]).expect(2);
    assert!(!run.out.contains("wrote") && folder.names() == ["map.bsp", "map.prt"], "{}", run.out);
}

/// The portals of a file, each twice in a row: as it is, or as the other side writes it.
fn twice(prt: &Prt, from_the_other_side: bool) -> Prt {
    let mut twice = Prt::new(prt.n_clusters()).expect("clusters");
    for portal in prt.portals() {
        let [a, b] = portal.clusters;
        let (clusters, mut points) = (if from_the_other_side { [b, a] } else { [a, b] }, portal.points.to_vec());
        if from_the_other_side {
            points.reverse();
        }
        points.rotate_left(1);
        twice.push_portal(portal.clusters, portal.points).expect("as before");
        twice.push_portal(clusters, &points).expect("the same again");
    }
    twice
}

/// Portals that stand twice are found, and used once: the same bytes by the same work. The impostor: were they taken for two, there would be more.
#[test]
fn portals_that_stand_twice_are_used_once() {
    let map = rooms(5, 4);
    let prt = parse_prt(map.prt.as_bytes()).expect("sound portals");
    let folder = with(&map);
    let work = |folder: &Folder| {
        folder.run(&["vis", "map.bsp", "-o", "out.bsp", "--json"]).expect(0).json()["counters"].clone()
    };
    let once = (work(&folder), folder.read("out.bsp"));
    for from_the_other_side in [false, true] {
        let text = write_prt(&twice(&prt, from_the_other_side));
        folder.write("map.prt", &text);
        assert_eq!((work(&folder), folder.read("out.bsp")), once);
        let run = folder.run_vis(&["map"]).expect(0);
        assert!(run.err.contains(&format!("map.prt: {} portals repeat earlier ones and are ignored", prt.n_portals())));
        assert!(folder.read("map.bsp") == once.1 && run.err.lines().count() == 1, "{}", run.err);
    }
    let mut moved = twice(&prt, false);
    let extra = [[16.0, 0.5, 0.5], [16.0, 0.75, 0.5], [16.0, 0.75, 0.75]];
    moved.push_portal([0, 1], &extra).expect("another window");
    folder.write("map.prt", write_prt(&moved));
    assert_ne!(work(&folder), once.0);
}

/// Corners the wrong way round are noticed, in all portals and in one of them.
#[test]
fn portals_inside_out_are_refused() {
    for format in BspFormat::ALL {
        let map = row_of_leafs(format);
        let prt = parse_prt(map.prt.as_bytes()).expect("sound portals");
        for only in [None, Some(0), Some(1), Some(2)] {
            let folder = with(&map);
            let mut turned = Prt::new(prt.n_clusters()).expect("clusters");
            for (k, portal) in prt.portals().enumerate() {
                let mut points = portal.points.to_vec();
                if only.is_none_or(|only| only == k) {
                    points.reverse();
                }
                turned.push_portal(portal.clusters, &points).expect("as good as before");
            }
            folder.write("map.prt", write_prt(&turned));
            let error = refused(&folder);
            let line = 4 + only.unwrap_or(0);
            assert!(error.contains(&format!("map.prt: line {line}")) && error.contains("wrong order"), "{error}");
            assert_eq!(folder.names(), ["map.bsp", "map.prt"]);
        }
    }
}
