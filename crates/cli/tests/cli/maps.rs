//! Tables of Quake maps through the command line: they know where their cells are, and what is drawn there.

use crate::common::Folder;
use crate::common::quake::{Map, rooms, row_of_leafs};
use serde_json::json;
use sightlines::formats::quake::BspFormat;
use sightlines::pvs::Table;

fn with(map: &Map) -> Folder {
    let folder = Folder::new();
    folder.write("map.bsp", &map.bsp);
    folder.write("map.prt", map.prt.as_bytes());
    folder
}

#[test]
fn maps_become_tables_that_can_be_asked() {
    for format in BspFormat::ALL {
        let folder = with(&row_of_leafs(format));
        let built = folder.run(&["build", "map.bsp", "-o", "map.pvs", "--json"]).expect(0).json();
        let quake2 = format.has_clusters();
        assert_eq!((&built["n_clusters"], &built["n_planes"]), (&json!(if quake2 { 3 } else { 4 }), &json!(4)));
        assert_eq!((&built["n_faces"], &built["n_portals"]), (&json!(6), &json!(3)));
        let text = folder.run(&["build", "map.bsp", "-o", "again.pvs", "-v"]).expect(0).out;
        assert!(text.contains("objects        6 faces of the world"), "{text}");
        let text = folder.run(&["build", "map.bsp", "-o", "again.pvs"]).expect(0).out;
        let starts =
            ["map            a ", "method         exact stabbing of convex portals; ", "wrote          again.pvs, "];
        assert!(
            text.lines().count() == 3 && text.lines().zip(starts).all(|(line, start)| line.starts_with(start)),
            "{text}"
        );
        assert!(text.contains(": 6 faces of the world\n") && text.contains(" of 6 pairs visible") != quake2, "{text}");
        assert_eq!(folder.read("map.pvs"), folder.read("again.pvs"));

        // In the second leaf, away from its faces; on a plane; in what is solid behind the last.
        let query = |eye: &str| folder.run(&["query", "map.pvs", "--eye", eye, "--json"]);
        let found = query("70,50,50").expect(0).json();
        assert_eq!(found["cells"], json!([if quake2 { 0 } else { 1 }]));
        let names: Vec<&str> =
            found["objects"].as_array().unwrap().iter().map(|o| o["name"].as_str().unwrap()).collect();
        assert!(names.contains(&"face 0") && names.contains(&"face 1"), "{names:?}");
        assert_eq!(query("64,50,50").expect(0).json()["cells"], json!(if quake2 { [0, 2] } else { [0, 1] }));
        assert_eq!(query("300,50,50").expect(1).json()["cell"], json!(null));

        let info = folder.run(&["info", "map.pvs", "--json"]).expect(0).json();
        assert!(info["info"]["source"].as_str().unwrap().starts_with("Quake map "), "{info}");
        folder.run(&["export", "map.pvs", "-o", "map.json"]).expect(0);
        folder.run(&["draw", "map.pvs", "-o", "map.svg", "--eye", "70,50,50"]).expect(0);
        // Explanations of clusters by number, and of points by the clusters that they are in.
        let by_number = folder.run(&["explain", "map.pvs", "0", "1", "--json"]).expect(0).json();
        assert_eq!((&by_number["answer"], &by_number["checked"]), (&json!("visible"), &json!(true)));
        let [a, b] = if quake2 { ["70,50,50", "150,50,50"] } else { ["10,50,50", "70,50,50"] };
        assert_eq!(folder.run(&["explain", "map.pvs", a, b, "--json"]).expect(0).json(), by_number);
        folder.run(&["explain", "map.pvs", "300,50,50", "1"]).expect(1);
    }
}

#[test]
fn other_threads_and_options_are_taken() {
    let folder = with(&row_of_leafs(BspFormat::Bsp2));
    folder.write("other.prt", folder.read("map.prt"));
    folder.run(&["build", "map.bsp", "-o", "one.pvs", "--threads", "1"]).expect(0);
    folder.run(&["build", "map.bsp", "-o", "two.pvs", "--threads", "2", "--prt", "other.prt"]).expect(0);
    assert_eq!(folder.read("one.pvs"), folder.read("two.pvs"));
    folder.run(&["build", "map.bsp", "-o", "fast.pvs", "--fast"]).expect(0);
    let table = Table::from_bytes(&folder.read("fast.pvs")).expect("a sound table");
    assert_eq!((table.info_value("search"), table.planes().is_some()), (Some("fast"), true));
    // Without the map, places are unknown.
    folder.run(&["build", "map.prt", "-o", "blind.pvs"]).expect(0);
    let error = folder.refused(&["query", "blind.pvs", "--eye", "1,1,1"]);
    assert!(error.contains("does not say where its cells are"), "{error}");
}

#[test]
fn what_cannot_be_built_is_refused() {
    let folder = with(&row_of_leafs(BspFormat::Bsp29));
    let error = folder.refused(&["build", "map.bsp", "-o", "o.pvs", "--prt", "none.prt"]);
    assert!(error.starts_with("none.prt: "), "{error}");
    assert_eq!(
        folder.refused(&["build", "map.prt", "-o", "o.pvs", "--prt", "map.prt"]),
        "map.prt: --prt is for Quake maps, and this is none"
    );
    assert_eq!(folder.refused(&["build", "map.bsp", "-o", "map.prt"]), "map.prt: the output would replace the input");
    folder.write("rooms.prt", rooms(3, 2).prt.as_bytes());
    let error = folder.refused(&["build", "map.bsp", "-o", "o.pvs", "--prt", "rooms.prt"]);
    assert!(error.starts_with("rooms.prt: does not go with map.bsp: the portals are of a map with 6 leafs"), "{error}");
    // A map whose other lumps hold something else.
    let folder = with(&rooms(2, 1));
    let error = folder.refused(&["build", "map.bsp", "-o", "o.pvs"]);
    assert!(error.starts_with("map.bsp: lump "), "{error}");
    assert_eq!(folder.names(), ["map.bsp", "map.prt"]);
}
