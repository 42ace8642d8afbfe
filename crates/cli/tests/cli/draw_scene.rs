//! `draw --scene`: the surfaces of the scene beside the cells of its table.

use crate::common::Folder;
use crate::common::quake::row_of_leafs;
use sightlines::formats::quake::BspFormat;

/// A floor, a slanted roof above it, and a wall that leans over. y is up.
const LEANING: &str = "o floor\nv 0 0 0\nv 8 0 0\nv 8 0 8\nv 0 0 8\nf 1 4 3\nf 1 3 2\n\
    o roof\nv 0 3 0\nv 8 3 0\nv 8 5 8\nv 0 5 8\nf 5 6 7\nf 5 7 8\n\
    o wall\nv 4 0 0\nv 4 0 5\nv 6 3 5\nv 6 3 0\nf 9 10 11\nf 9 11 12\n";

fn leaning() -> Folder {
    let folder = Folder::new();
    folder.write("leaning.obj", LEANING);
    let cells = ["--view-region", "0,0.5,0,8,2.5,8", "--grid", "4,2,4", "--method", "auto"];
    folder.run(&[&["build", "leaning.obj", "-o", "leaning.pvs"][..], &cells].concat()).expect(0);
    folder
}

fn text(folder: &Folder, name: &str) -> String {
    String::from_utf8(folder.read(name)).expect("text")
}

/// Where a line across the wall at this height is drawn, in pixels, if it is.
fn uprights(svg: &str) -> Vec<f64> {
    let of_line = |line: &str| {
        let (x, y) = line.split_once(' ')?;
        let (y0, end) = y.split_once('L')?;
        let (x1, y1) = end.split_once(' ')?;
        let [x0, x1, y0, y1]: [f64; 4] = [x.parse().ok()?, x1.parse().ok()?, y0.parse().ok()?, y1.parse().ok()?];
        (x0 == x1 && (y1 - y0).abs() > 20.0).then_some(x0)
    };
    let paths = svg.lines().filter(|line| line.contains("fill=\"none\" stroke=\"#1c2733\""));
    paths
        .filter_map(|line| line.split('"').nth(1))
        .flat_map(|path| path.split('M').skip(1))
        .filter_map(of_line)
        .collect()
}

/// The wall leans by two units on three, and is cut farther to the right the higher the plane is.
#[test]
fn a_leaning_wall_is_cut_at_every_height() {
    let folder = leaning();
    let at = |height: &str| {
        let scene = ["--scene", "leaning.obj", "--height", height, "--size", "800", "-o", "plan.svg"];
        folder.run(&[&["draw", "leaning.pvs"][..], &scene].concat()).expect(0);
        let svg = text(&folder, "plan.svg");
        assert!(
            svg.contains("<title>surfaces of the scene</title>") && svg.contains("<title>borders of cells</title>")
        );
        let found = uprights(&svg);
        assert!(!found.is_empty() && found.iter().all(|x| *x == found[0]), "at {height}: {found:?}");
        found[0]
    };
    let places = ["0.75", "1.5", "2.25"].map(at);
    let [near, far] = [places[1] - places[0], places[2] - places[1]];
    assert!((near - far).abs() < 0.25 && near > 20.0, "{places:?}");
    // The impostor: without the scene there is no such line.
    folder.run(&["draw", "leaning.pvs", "--height", "1.5", "--size", "800", "-o", "bare.svg"]).expect(0);
    assert!(uprights(&text(&folder, "bare.svg")).is_empty());
}

#[test]
fn another_scene_is_refused() {
    let folder = leaning();
    let refused =
        |scene: &str| folder.refused(&["draw", "leaning.pvs", "--scene", scene, "--cell", "0", "-o", "no.svg"]);
    folder.write("fewer.obj", LEANING.split("o wall").next().expect("a part"));
    let other = "the table was made of another scene";
    assert_eq!(refused("fewer.obj"), format!("fewer.obj: {other}: it has 3 objects, and this file has 2"));
    folder.write("named.obj", LEANING.replace("o roof", "o lid"));
    let names = "its object 1 is \"roof\", and that of this file \"lid\"";
    assert_eq!(refused("named.obj"), format!("named.obj: {other}: {names}"));
    folder.write("moved.obj", LEANING.replace("v 6 3 0", "v 6.5 3 0"));
    assert_eq!(refused("moved.obj"), format!("moved.obj: {other}: its triangles differ from those of this file"));
    let map = row_of_leafs(BspFormat::Bsp29);
    folder.write("map.bsp", &map.bsp);
    folder.write("map.prt", &map.prt);
    assert!(refused("map.bsp").starts_with(&format!("map.bsp: {other}: it has 3 objects, and the world of this map ")));
    assert_eq!(refused("map.prt"), format!("map.prt: {other}: a portal file has nothing to draw; name its map"));
    assert!(!folder.path("no.svg").exists());
    // The map goes with its own table.
    folder.run(&["build", "map.bsp", "-o", "map.pvs"]).expect(0);
    folder.run(&["draw", "map.pvs", "--scene", "map.bsp", "--cell", "0", "-o", "map.svg"]).expect(0);
    let svg = text(&folder, "map.svg");
    assert!(svg.contains("<title>the cell</title>") && !svg.contains("<title>walls</title>"), "{svg}");
}

#[test]
fn plans_and_outputs_are_refused() {
    let folder = Folder::with_office();
    folder.write("leaning.obj", LEANING);
    let error = folder.refused(&["draw", "office.pvs", "--scene", "leaning.obj", "-o", "no.svg"]);
    assert!(error.contains("--scene") && error.contains("scenes in space"), "{error}");
    let folder = leaning();
    let onto = ["draw", "leaning.pvs", "--scene", "leaning.obj", "--cell", "0", "-o", "leaning.obj"];
    assert_eq!(folder.run(&onto).code, 2);
    assert_eq!(text(&folder, "leaning.obj"), LEANING);
}

/// Without a height an isometric view is cut where the viewer is; with the scene it shows surfaces, in pixels.
#[test]
fn isometric_views_are_cut_and_shaded() {
    let folder = leaning();
    let draw = |options: &[&str]| {
        folder
            .run(&[&["draw", "leaning.pvs", "--isometric", "--size", "600", "-o", "iso.svg"][..], options].concat())
            .expect(0);
        text(&folder, "iso.svg")
    };
    let title = |svg: &str| svg.split("<title>").nth(1).and_then(|t| t.split("</title>").next()).map(str::to_owned);
    let eye = ["--eye", "1,1.25,1"];
    let boxes = draw(&eye);
    assert_eq!(title(&boxes).as_deref(), Some("What a viewer at (1, 1.25, 1) sees, cut at height 1.25"));
    assert!(!boxes.contains("<image ") && boxes.contains("<title>the viewer</title>"));
    let scene = draw(&[&eye[..], &["--scene", "leaning.obj"]].concat());
    assert_eq!(scene.matches("<image ").count(), 1);
    assert!(scene.contains("<title>where the height cuts surfaces</title>"));
    assert_eq!(title(&draw(&[])).as_deref(), Some("Cells"));
}
