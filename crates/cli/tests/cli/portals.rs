//! Portals that are made from a map without a portal file.

use crate::common::Folder;
use crate::common::quake::{rooms, row_of_leafs};
use serde_json::json;
use sightlines::formats::quake::BspFormat;
use sightlines::formats::quake::prt::parse_prt;

#[test]
fn a_map_without_its_portal_file_has_portals() {
    for format in BspFormat::ALL {
        let folder = Folder::new();
        folder.write("map.bsp", row_of_leafs(format).bsp);
        let reply = folder.run(&["portals", "map.bsp", "-o", "made.prt", "--json"]).expect(0).json();
        let prt = parse_prt(&folder.read("made.prt")).expect("a sound portal file");
        assert_eq!(reply["n_portals"], json!(prt.n_portals()), "{format:?}");
        // Three walls between the leafs; in Quake II and III leafs 1 and 3 are one cluster.
        let between = |a: u32, b: u32| prt.portals().filter(|p| p.clusters == [a, b] || p.clusters == [b, a]).count();
        let pairs = if format.has_clusters() { [(2, 0), (0, 1), (1, 0)] } else { [(0, 1), (1, 2), (2, 3)] };
        assert!(pairs.into_iter().all(|(a, b)| between(a, b) > 0), "{format:?}: {reply}");

        let made = folder.run(&["vis", "map.bsp", "-o", "one.bsp"]).expect(0);
        assert!(made.out.contains(", portals made from the map\n"), "{}", made.out);
        let note =
            format!("note: map.bsp: there is no map.prt; made {} portals from the map's tree\n", prt.n_portals());
        assert!(made.err.contains(&note), "{}", made.err);
        folder.run(&["vis", "map.bsp", "-o", "two.bsp", "--prt", "made.prt"]).expect(0);
        assert_eq!(folder.read("one.bsp"), folder.read("two.bsp"), "{format:?}");
        folder.run(&["build", "map.bsp", "-o", "map.pvs"]).expect(0);
        for table in ["map.pvs", "one.bsp"] {
            folder.run(&["verify", table, "map.bsp", "--rays", "10000"]).expect(0);
        }
        // A portal file goes before.
        folder.write("map.prt", row_of_leafs(format).prt);
        let own = folder.run(&["vis", "map.bsp", "-o", "own.bsp"]).expect(0);
        assert!(!own.out.contains("made from the map") && own.err.is_empty(), "{}", own.out);
    }
}

/// A row of leafs whose second is solid, without faces: a fence.
#[test]
fn what_is_solid_without_faces_is_seen_through() {
    for (format, solid, [a, b]) in [(BspFormat::Bsp29, -2i32, ["0", "2"]), (BspFormat::Quake2, 1, ["2", "1"])] {
        let folder = Folder::new();
        let mut map = row_of_leafs(format).bsp;
        let leafs = sightlines::formats::Bsp::parse(map.clone()).expect("a sound map");
        let at = leafs.lumps()[format.leaf_lump()].start;
        map[at + 2 * 28..][..4].copy_from_slice(&solid.to_le_bytes());
        folder.write("map.bsp", map);
        let reply = folder.run(&["portals", "map.bsp", "-o", "made.prt", "--json"]).expect(0).json();
        assert_eq!((&reply["n_passages"], &reply["portal_format"]), (&json!(1), &json!("PRT2")), "{format:?}");
        folder.run(&["build", "map.bsp", "-o", "map.pvs"]).expect(0);
        let seen = folder.run(&["explain", "map.pvs", a, b, "--json"]).expect(0).json();
        assert_eq!((&seen["answer"], &seen["checked"]), (&json!("visible"), &json!(true)));
        folder.run(&["vis", "map.bsp", "-o", "out.bsp"]).expect(0);
        folder.run(&["vis", "map.bsp", "-o", "again.bsp", "--prt", "made.prt"]).expect(0);
        assert_eq!(folder.read("out.bsp"), folder.read("again.bsp"), "{format:?}");
        folder.run(&["verify", "out.bsp", "map.bsp"]).expect(0);
        folder.run(&["verify", "map.pvs", "map.bsp"]).expect(0);
    }
}

#[test]
fn maps_without_a_tree_are_refused() {
    let folder = Folder::new();
    folder.write("map.bsp", rooms(2, 2).bsp);
    for args in [
        &["portals", "map.bsp", "-o", "o.prt"][..],
        &["vis", "map.bsp", "-o", "o.bsp"],
        &["build", "map.bsp", "-o", "o.pvs"],
    ] {
        let error = folder.refused(args);
        assert!(
            error.starts_with("map.bsp: there is no map.prt beside it, and no portals can be made from the map: lump "),
            "{error}"
        );
    }
    assert!(folder.refused(&["portals", "map.bsp", "-o", "map.bsp"]).ends_with("the output would replace the input"));
    assert_eq!(folder.names(), ["map.bsp"]);
}

/// Every byte of a small map, changed in one of three ways in turn: an answer or an error, and nothing half written.
#[test]
fn changed_maps_are_refused_or_have_portals() {
    use sightlines::bake::quake::portals_of_map;
    let [mut n_made, mut n_refused] = [0; 2];
    for format in BspFormat::ALL {
        let bytes = row_of_leafs(format).bsp;
        for at in 0..bytes.len() {
            let mut changed = bytes.clone();
            changed[at] ^= [0xFF, 0x80, 0x01][at % 3];
            let Ok(bsp) = sightlines::formats::Bsp::parse(changed) else { continue };
            match portals_of_map(&bsp) {
                Ok(_) => n_made += 1,
                Err(error) => {
                    assert!(!error.to_string().is_empty());
                    n_refused += 1;
                }
            }
        }
    }
    assert!(n_made > 1000 && n_refused > 500, "{n_made} made, {n_refused} refused");
}
