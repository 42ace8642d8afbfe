//! Doors by name: those of a file, and those that are given as boxes; and objects that are found again in their file.

use crate::common::{Folder, levels};
use serde_json::Value;
use sightlines::pvs::{ObjectId, PortalId, Table};

/// The cells that an eye in the first room sees, with this closed.
fn seen(folder: &Folder, table: &str, closed: &[&str]) -> Value {
    let closed = closed.iter().flat_map(|text| ["--closed", text]).collect::<Vec<_>>();
    let look = ["query", table, "--eye", "2,1.7,2", "--method", "exact", "--json"];
    folder.run(&[&look[..], &closed].concat()).expect(0).json()["visible"].clone()
}

fn read(folder: &Folder, table: &str) -> Table {
    Table::from_bytes(&std::fs::read(folder.path(table)).expect("a file")).expect("a table")
}

/// The name of a door closes what its portals by number close, in plain tables and in packed ones.
#[test]
fn doors_of_a_file_are_shut_by_name() {
    let folder = Folder::new();
    folder.write("level.glb", levels::with_doors());
    folder.run(&["build", "level.glb", "-o", "level.pvs"]).expect(0);
    folder.run(&["pack", "level.pvs", "-o", "level.pvz"]).expect(0);
    let table = read(&folder, "level.pvs");
    assert_eq!(table.doors().len(), 6);
    let open = seen(&folder, "level.pvs", &[]);
    let mut n_changed = 0;
    for door in table.doors() {
        let [portal] = door.portals[..] else { panic!("{door:?}") };
        let by_name = seen(&folder, "level.pvs", &[&door.name]);
        assert_eq!(by_name, seen(&folder, "level.pvs", &[&portal.to_string()]), "{door:?}");
        assert_eq!(by_name, seen(&folder, "level.pvz", &[&format!("door:{}", door.name)]), "{door:?}");
        n_changed += usize::from(by_name != open);
    }
    assert!(n_changed > 0, "the first room has a door");
    let names: Vec<&str> = table.doors().iter().map(|door| door.name.as_str()).collect();
    let all = seen(&folder, "level.pvs", &[&names.join(",")]);
    assert!(all.as_array().map(Vec::len) < open.as_array().map(Vec::len));
    assert_eq!(all, seen(&folder, "level.pvs", &names), "once or several times");

    let ask = ["query", "level.pvs", "--eye", "2,1.7,2", "--closed"];
    let wrong = names[0].replace("Leaf", "Laef");
    let error = folder.refused(&[&ask[..], &[&wrong]].concat());
    let start = format!("level.pvs: there is no door called {wrong:?}: the nearest names are {:?}, ", names[0]);
    assert!(error.starts_with(&start), "{error}");
    folder.run(&["build", "level.glb", "--door", "12=0,0,0,1,1,1", "-o", "more.pvs"]).expect(0);
    let error = folder.refused(&["query", "more.pvs", "--eye", "2,1.7,2", "--closed", "12000"]);
    assert!(error.starts_with("more.pvs: there is no portal 12000: "), "{error}");
    assert_eq!(seen(&folder, "more.pvs", &["door:12"]), open, "it closes nothing");
}

/// `info` and `query` print node and primitive, and the nodes of the file have the names of these objects.
#[test]
fn objects_are_found_again() {
    let folder = Folder::new();
    let glb = levels::with_doors();
    let length = u32::from_le_bytes(glb[12..16].try_into().expect("four bytes")) as usize;
    let document: Value = serde_json::from_slice(&glb[20..20 + length]).expect("a document");
    folder.write("level.glb", glb);
    folder.run(&["build", "level.glb", "-o", "level.pvs"]).expect(0);
    folder.run(&["pack", "level.pvs", "-o", "level.pvz"]).expect(0);
    let info = folder.run(&["info", "level.pvs", "--objects", "--json"]).expect(0).json();
    let objects = info["objects"].as_array().expect("a list").clone();
    assert_eq!(info["n_objects_with_source"], objects.len());
    for object in &objects {
        let node = object["node"].as_u64().expect("a node") as usize;
        assert_eq!((&document["nodes"][node]["name"], &object["primitive"]), (&object["name"], &0.into()));
    }
    let packed = folder.run(&["info", "level.pvz", "--objects", "--json"]).expect(0).json();
    assert_eq!((&packed["objects"], &packed["doors"]), (&info["objects"], &info["doors"]));
    assert_eq!(info["doors"].as_array().map(Vec::len), Some(6));
    for file in ["level.pvs", "level.pvz"] {
        let look = folder.run(&["query", file, "--eye", "2,1.7,2", "--json"]).expect(0).json();
        let seen = look["objects"].as_array().expect("a list").clone();
        assert!(!seen.is_empty() && seen.iter().all(|object| objects.contains(object)), "{file}");
    }
    let text = folder.run(&["info", "level.pvs", "--objects"]).expect(0).out;
    assert!(text.contains("found again    ") && text.contains(", node 3 primitive 0\n"), "{text}");
    assert!(text.contains("doors          \"Leaf.0"), "{text}");
    let table = read(&folder, "level.pvs");
    assert_eq!(table.objects_of_node(4).collect::<Vec<_>>(), [ObjectId(4)]);
    // An OBJ has no nodes.
    folder.write("two.obj", "o a\nv 0 0 0\nv 4 0 0\nv 0 4 0\nf 1 2 3\no b\nv 0 0 4\nv 4 0 4\nv 0 4 4\nf 4 5 6\n");
    folder.run(&["build", "two.obj", "-o", "two.pvs"]).expect(0);
    let text = folder.run(&["info", "two.pvs", "--objects"]).expect(0).out;
    assert!(!text.contains("found again") && text.contains("      1 b\n") && !read(&folder, "two.pvs").has_sources());
    let error = folder.refused(&["info", "level.glb", "--objects"]);
    assert!(error.contains("--objects") && error.contains("tables"), "{error}");
}

/// A box closes the portals within it; one that covers none is warned of, and one of another dimension refused.
#[test]
fn doors_are_given_as_boxes() {
    let folder = Folder::new();
    folder.write("level.glb", levels::blender());
    let build = |door: &str| folder.run(&["build", "level.glb", "--door", door, "-o", "level.pvs"]);
    // An opening from the first room to the corridor, in a wall from z = 3.75 to 4.
    let run = build("first room=1,0,3.75,2,2,4").expect(0);
    assert!(run.out.contains("given door     \"first room\", open; closes "), "{}", run.out);
    let table = read(&folder, "level.pvs");
    let [door] = table.doors() else { panic!("{:?}", table.doors()) };
    assert!(door.object.is_none() && !door.portals.is_empty());
    for (portal, record) in (0u32..).map(PortalId).zip(table.portals()) {
        let is_inside = record
            .points
            .iter()
            .all(|&[x, y, z]| (1.0..=2.0).contains(&x) && (0.0..=2.0).contains(&y) && (3.75..=4.0).contains(&z));
        assert_eq!(door.portals.contains(&portal), is_inside, "{record:?}");
    }
    let (open, shut) = (seen(&folder, "level.pvs", &[]), seen(&folder, "level.pvs", &["first room"]));
    assert!(shut.as_array().map(Vec::len) < open.as_array().map(Vec::len), "{shut}");
    let found = folder.run(&["verify", "level.pvs", "level.glb", "--rays", "2000"]).expect(0).out;
    assert!(found.contains("1 door\n") && !found.contains("remark"), "{found}");

    let run = build("crack=1.5,0,3.75,1.6,2,4").expect(0);
    assert!(run.err.contains("the door \"crack\" closes nothing: no portal is wholly within its box"), "{}", run.err);
    let boxes = ["build", "level.glb", "--grid", "2,1,2", "--door", "a=0,0,0,9,9,9", "-o", "boxes.pvs"];
    let run = folder.run(&boxes).expect(0);
    assert!(
        run.err.contains("the door \"a\" closes nothing: the cells have no portals; --method sightlines"),
        "{}",
        run.err
    );
    let flat = ["build", "level.glb", "--door", "a=0,0,9,9", "-o", "flat.pvs"];
    assert_eq!(folder.refused(&flat), "level.glb: the box of the door \"a\" has 4 numbers: here it needs 6");
    assert!(!folder.path("flat.pvs").exists());
    for bad in ["a", "=0,0,1,1", "a=1,1,0,0", "a=0,0,1"] {
        assert_eq!(folder.run(&["build", "level.glb", "--door", bad, "-o", "bad.pvs"]).code, 2, "{bad}");
    }
}
