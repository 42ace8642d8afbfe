//! Isovists: every kind of result, every fault of the input.

use crate::common::Folder;
use serde_json::{Value, json};

/// Two rooms with a door, in the numbers of a national grid.
const ROOMS: &str = r#"{"type": "FeatureCollection",
"crs": {"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::25832"}},
"features": [{"type": "Feature", "properties": {}, "geometry": {"type": "MultiLineString", "coordinates": [
[[500000, 5400000], [500008, 5400000], [500008, 5400004], [500000, 5400004], [500000, 5400000]],
[[500004, 5400000], [500004, 5400003]]]}}]}"#;

fn text(folder: &Folder, name: &str) -> String {
    String::from_utf8(folder.read(name)).unwrap()
}

fn area_of(ring: &Value) -> f64 {
    let point = |p: &Value| [p[0].as_f64().unwrap() - 500_000.0, p[1].as_f64().unwrap() - 5_400_000.0];
    let ring: Vec<[f64; 2]> = ring.as_array().unwrap().iter().map(point).collect();
    ring.windows(2).map(|p| p[0][0] * p[1][1] - p[0][1] * p[1][0]).sum::<f64>() / 2.0
}

#[test]
fn isovists_are_polygons_with_walls_and_measures() {
    let folder = Folder::new();
    folder.write("rooms.geojson", ROOMS);
    folder.write("eyes.csv", "x,y,name\n500002,5400002,west\n500006,5400002,east\n");
    let args = ["isovist", "rooms.geojson", "--at", "500002,5400002", "--points", "eyes.csv", "-o", "seen.geojson"];
    folder.run(&args).expect(0);
    let seen: Value = serde_json::from_str(&text(&folder, "seen.geojson")).unwrap();
    assert_eq!(seen["crs"]["properties"]["name"], "urn:ogc:def:crs:EPSG::25832");
    let features = seen["features"].as_array().unwrap();
    assert_eq!(features.len(), 3);
    let (first, west, east) = (&features[0]["properties"], &features[1]["properties"], &features[2]["properties"]);
    assert_eq!((west["name"].as_str(), east["name"].as_str(), first.get("name")), (Some("west"), Some("east"), None));
    assert_eq!(first["area"].as_f64(), Some(17.0));
    assert_eq!(area_of(&features[0]["geometry"]["coordinates"][0]), 17.0);
    assert_eq!(east["area"], first["area"], "the rooms are alike");
    let edges: Vec<&str> = first["edges"].as_array().unwrap().iter().map(|edge| edge.as_str().unwrap()).collect();
    assert_eq!(edges.iter().filter(|edge| **edge == "occluding").count(), 1);
    let walls: Vec<&Value> = first["walls"].as_array().unwrap().iter().filter(|wall| !wall.is_null()).collect();
    assert_eq!((walls.len() + 1, walls.contains(&&json!(1))), (edges.len(), false), "the east wall is not seen");
    folder.run(&["isovist", "rooms.geojson", "--points", "eyes.csv", "-o", "seen.csv"]).expect(0);
    let csv = text(&folder, "seen.csv");
    let mut lines = csv.lines();
    assert!(lines.next().unwrap().starts_with("x,y,index,area,perimeter,") && csv.lines().count() == 3);
    assert!(lines.next().unwrap().starts_with("500002,5400002,0,17,") && csv.ends_with(",east\n"));
    folder.run(&["isovist", "rooms.geojson", "--at", "500002,5400002", "-o", "seen.svg"]).expect(0);
    assert_eq!(text(&folder, "seen.svg").matches("class=\"area\"").count(), 1);
}

#[test]
fn isovists_have_limits() {
    let folder = Folder::new();
    folder.write("rooms.geojson", ROOMS);
    let area = |more: &[&str]| {
        let args = ["isovist", "rooms.geojson", "--at", "500002,5400002", "-o", "seen.geojson", "--json"];
        let result = folder.run(&[&args, more].concat()).expect(0).json();
        result["mean_area"].as_f64().unwrap()
    };
    assert!((area(&["--radius", "1"]) - std::f64::consts::PI).abs() < 0.01);
    assert!((area(&["--radius", "1", "--dir", "0,-1", "--fov", "90"]) - std::f64::consts::FRAC_PI_4).abs() < 0.01);
    assert!((area(&["--dir", "-1,0", "--fov", "90"]) - 4.0).abs() < 1e-9);
}

/// A picture in PNG needs no feature of the program, as that of `vga`.
#[test]
fn pictures_are_svg_and_png() {
    let folder = Folder::new();
    folder.write("rooms.geojson", ROOMS);
    for out in ["x.svg", "x.png"] {
        let args = ["isovist", "rooms.geojson", "--at", "500002,5400002", "--size", "300", "-o", out, "--json"];
        let reply = folder.run(&args).expect(0).json();
        assert_eq!(reply["n_bytes"], folder.read(out).len(), "{reply}");
    }
    assert!(folder.read("x.svg").starts_with(b"<svg ") && folder.read("x.png").starts_with(b"\x89PNG"));
}

#[test]
fn faults_are_named() {
    let folder = Folder::new();
    folder.write("rooms.geojson", ROOMS);
    folder.write("glass.geojson", r#"{"type": "Feature", "properties": {"sight": "transparent"}, "geometry": {"type": "LineString", "coordinates": [[0, 0], [1, 0]]}}"#);
    folder.write("far.csv", "500002,5400002\n0,0\n");
    let refused = |line: &str| folder.refused(&line.split(' ').collect::<Vec<_>>());
    let at = "--at 500002,5400002";
    assert_eq!(
        refused(&format!("isovist glass.geojson {at} -o x.csv")),
        "glass.geojson: no line of the plan blocks sight"
    );
    assert_eq!(
        refused("isovist rooms.geojson --at 1,2 -o x.csv"),
        "--at: the point (1, 2) is not inside the frame around the plan"
    );
    let far = refused("isovist rooms.geojson --points far.csv -o x.csv");
    assert_eq!(far, "far.csv: point 2: the point (0, 0) is not inside the frame around the plan");
    assert_eq!(
        refused("isovist rooms.geojson --at 1,2,3 -o x.csv"),
        "rooms.geojson: the table has 2 dimensions, but the point has 3 coordinates"
    );
    assert_eq!(
        refused(&format!("isovist rooms.geojson {at} --radius -1 -o x.csv")),
        "--radius: the radius -1 is not a positive number"
    );
    assert_eq!(
        refused(&format!("isovist rooms.geojson {at} --dir 0,0 --fov 9 -o x.csv")),
        "--dir: the direction (0, 0) is none"
    );
    let sector = "--dir and --fov go together: a direction, and how wide the view around it is";
    assert_eq!(refused(&format!("isovist rooms.geojson {at} --fov 9 -o x.csv")), sector);
    let kind = "x.txt: the name of the result ends in .geojson, .json, .csv, .svg or .png";
    assert_eq!(refused(&format!("isovist rooms.geojson {at} -o x.txt")), kind);
    assert_eq!(folder.names(), ["far.csv", "glass.geojson", "rooms.geojson"]);
}

#[test]
fn buildings_have_volumes_and_shares() {
    let folder = Folder::with_tower();
    folder.run(&["build", "tower.glb", "-o", "tower.pvs"]).expect(0);
    let seen = |more: &[&str], out: &str| {
        let args = ["isovist", "tower.glb", "--at", "3,1.5,3", "--rays", "2000", "-o", out, "--json"];
        folder.run(&[&args, more].concat()).expect(0).json()
    };
    let (by_table, by_rays) = (seen(&["--table", "tower.pvs"], "table.csv"), seen(&[], "rays.csv"));
    assert_eq!(by_table["mean_volume"], by_rays["mean_volume"], "the table changes no volume");
    assert!(by_table["mean_volume"].as_f64() > Some(0.0) && by_table["n_seen"].as_f64() > Some(0.0));
    // What the table hides is seen by no ray, and what a ray sees is in the table: the rows are the same.
    let (by_table, by_rays) = (text(&folder, "table.csv"), text(&folder, "rays.csv"));
    let shares =
        |csv: &str| -> Vec<String> { csv.lines().map(|line| line.split(',').nth(8).unwrap().to_owned()).collect() };
    assert_eq!(shares(&by_table), shares(&by_rays));
    assert!(shares(&by_rays).iter().any(|share| share == "0"));
    let error = folder.refused(&["isovist", "tower.glb", "--at", "3,1.5,3", "-o", "x.svg"]);
    assert_eq!(error, "x.svg: isovists of scenes in space are written as CSV; give a name that ends in .csv");
    let error = folder.refused(&["isovist", "tower.glb", "--at", "3,1.5,3", "--radius", "2", "-o", "x.csv"]);
    assert!(error.contains("--radius"), "{error}");
}
