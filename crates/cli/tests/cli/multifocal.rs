//! Pictures of multifocal buffers and of what is nearest: as blessed, as exact arithmetic says, and refused with clear words.

use crate::common::Folder;
use crate::common::picture::Picture;
use sightlines::geometry::{Point3, orient3d};
use sightlines::report::OPEN;
use std::path::PathBuf;

/// A triangle that leans, as on the slides.
const ONE: &str = "v -3 -2 5\nv 3 -2 4\nv 0 3 6\nf 1 2 3\n";
/// A square of two triangles that share a diagonal, facing the volume.
const SQUARE: &str = "v -2 -2 5\nv 2 -2 5\nv 2 2 5\nv -2 2 5\nf 1 2 3\nf 1 3 4\n";
/// Two triangles one behind the other.
const TWO: &str = "v -3 -2 6\nv 1 -2 6\nv -1 2 6\nv -1 -2 8\nv 5 -3 7\nv 2 4 8\nf 1 2 3\nf 4 5 6\n";

const VOLUME: [&str; 4] = ["--volume", "-0.25,-0.25,-0.25,0.25,0.25,0.25", "--texels", "64"];
const PLANE: [&str; 2] = ["--plane", "z=10:-8,-8,8,8"];

fn golden(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/golden/multifocal").join(name)
}

/// A folder with the scenes.
fn folder() -> Folder {
    let folder = Folder::new();
    for (name, text) in [("one.obj", ONE), ("square.obj", SQUARE), ("two.obj", TWO)] {
        folder.write(name, text);
    }
    folder
}

fn draw(folder: &Folder, scene: &str, more: &[&str]) -> serde_json::Value {
    let args = [&["multifocal", scene, "-o", "depth.png", "--json"][..], &VOLUME, &PLANE, more].concat();
    folder.run(&args).expect(0).json()
}

/// Each picture is the one that was looked at and blessed, pixel for pixel.
#[test]
fn pictures_are_as_blessed() {
    let folder = folder();
    let fields = ["--voronoi", "voronoi.png", "--distance", "distance.png"];
    let cases: [(&str, &str, &[&str]); 5] = [
        ("one", "one.obj", &fields),
        ("square", "square.obj", &fields),
        ("square-triangles", "square.obj", &["--triangles"]),
        ("two", "two.obj", &fields),
        ("two-euclid", "two.obj", &["--measure", "euclid"]),
    ];
    let bless = std::env::var_os("BLESS").is_some_and(|v| v == "1");
    let mut n = 0;
    for (name, scene, more) in cases {
        let info = draw(&folder, scene, more);
        for kind in info["files"].as_array().expect("files").iter().map(|f| f.as_str().expect("a name")) {
            let (made, path) = (folder.read(kind), golden(&format!("{name}-{kind}")));
            if bless {
                std::fs::write(&path, &made).expect("the folder of golden pictures can be written");
            }
            let shown = path.display();
            let blessed = std::fs::read(&path).unwrap_or_else(|e| panic!("{shown}: {e}; write it with BLESS=1"));
            let n_wrong = Picture::decode(&made).differs(&Picture::decode(&blessed));
            assert_eq!(n_wrong, 0, "{shown}: pixels differ");
            n += 1;
        }
    }
    assert_eq!(n, 11);
}

/// The impostor: one pixel, or another size, is a difference; and no two of the blessed pictures are alike.
#[test]
fn other_pictures_are_noticed() {
    let mut pictures = Vec::new();
    for name in crate::common::names(&golden("")) {
        pictures.push(Picture::decode(&std::fs::read(golden(&name)).expect("a golden picture")));
    }
    assert_eq!(pictures.len(), 11);
    for (i, picture) in pictures.iter().enumerate() {
        assert_eq!(picture.size, [64, 64]);
        assert!(pictures[..i].iter().all(|other| picture.differs(other) > 10));
        let mut changed = picture.clone();
        changed.pixels[7][1] ^= 1;
        assert_eq!(changed.differs(picture), 1);
        changed.size = [32, 128];
        assert_eq!(changed.differs(picture), 64 * 64);
    }
}

/// Whether a segment meets a closed triangle in a point strictly behind neither end; exact.
fn meets([a, b, c]: [Point3; 3], p: Point3, q: Point3) -> bool {
    let side = |v: f64| if v > 0.0 { 1 } else { -i32::from(v < 0.0) };
    let [sp, sq] = [p, q].map(|v| side(orient3d(a, b, c, v)));
    let around = [(a, b), (b, c), (c, a)].map(|(s, t)| side(orient3d(p, q, s, t)));
    sp * sq < 0 && (around.iter().all(|&s| s >= 0) || around.iter().all(|&s| s <= 0))
}

/// A texel is grey only if all corners of the volume are hidden from all of its own; and nearly all such are.
#[test]
fn grey_is_what_is_blocked_and_blue_what_is_not() {
    let folder = folder();
    let triangle: [Point3; 3] = [[-3., -2., 5.], [3., -2., 4.], [0., 3., 6.]];
    let mut counts = [0, 0];
    for measure in ["euclid", "clipped", "vertex-height", "height"] {
        let info = draw(&folder, "one.obj", &["--measure", measure]);
        let picture = Picture::decode(&folder.read("depth.png"));
        let blocked = |x: usize, y: usize| {
            let at = |n: usize| n as f64 / 4.0 - 8.0;
            (0..32).all(|i| {
                let eye = [0, 1, 2].map(|k| if i >> k & 1 == 0 { -0.25 } else { 0.25 });
                meets(triangle, eye, [at(x + (i >> 3 & 1)), at(y + (i >> 4 & 1)), 10.0])
            })
        };
        let mut n = [0, 0];
        for (i, pixel) in picture.pixels.iter().enumerate() {
            let (truth, grey) = (blocked(i % 64, 63 - i / 64), *pixel != OPEN);
            assert!(truth || !grey, "{measure}: pixel {i} is grey");
            assert!(!grey || pixel.iter().all(|x| *x == pixel[0]));
            n = [n[0] + usize::from(truth), n[1] + usize::from(grey)];
        }
        assert_eq!(info["n_blocked"], n[1]);
        assert!(n[1] * 100 >= n[0] * 95, "{measure}: {n:?}");
        counts = [counts[0] + n[0], counts[1] + n[1]];
    }
    assert!(counts[0] > 2000, "{counts:?}");
}

#[test]
fn neighbours_put_together_hide_what_two_triangles_do_not() {
    let folder = folder();
    let together = draw(&folder, "square.obj", &[]);
    assert_eq!((together["n_occluders"].as_u64(), together["n_triangles"].as_u64()), (Some(1), Some(2)));
    let whole = Picture::decode(&folder.read("depth.png"));
    let apart = draw(&folder, "square.obj", &["--triangles"]);
    assert_eq!(apart["n_occluders"], 2);
    assert!(apart["n_blocked"].as_u64() < together["n_blocked"].as_u64());
    let split = Picture::decode(&folder.read("depth.png"));
    // The shared diagonal casts no umbra of its own: through the middle of the picture.
    let middle = 32 * 64 + 32;
    assert!(whole.pixels[middle] == [255; 3] && split.pixels[middle] == OPEN);
}

/// Without a device the CPU takes over and says so; with one the picture is the same.
#[test]
fn the_gpu_and_the_cpu_draw_the_same() {
    let folder = folder();
    let args = |backend| {
        [&["multifocal", "two.obj", "-o", "depth.png", "--json", "--backend", backend][..], &VOLUME, &PLANE].concat()
    };
    folder.run(&args("cpu")).expect(0);
    let cpu = folder.read("depth.png");
    if !cfg!(feature = "gpu") {
        let refused = folder.refused(&args("gpu"));
        let command = "`cargo install --path crates/cli --features gpu`";
        assert!(
            refused.starts_with("two.obj: the backend gpu is not part of this build") && refused.contains(command),
            "{refused}"
        );
        return;
    }
    let run = folder.run(&args("gpu")).expect(0);
    assert!(cpu == folder.read("depth.png"));
    if run.json()["backend"] == "cpu" {
        assert!(run.err.contains("the CPU takes over"), "{}", run.err);
        let quiet = folder.run(&[&["-q"][..], &args("gpu")].concat()).expect(0);
        assert_eq!(quiet.err, "");
    }
    assert_eq!(folder.run(&args("reference")).expect(0).json()["backend"], "cpu-reference");
}

#[test]
fn results_are_printed() {
    let folder = folder();
    let args = [&["multifocal", "square.obj", "-o", "d.png", "--plane", "z=10", "--distance", "f.png"][..], &VOLUME];
    let run = folder.run(&args.concat()).expect(0);
    let lines: Vec<&str> = run.out.lines().collect();
    assert_eq!(lines[0], "square.obj: 2 triangles, 1 occluder");
    // The shadow of the square: from -0.25 by way of 2 at the nearest, 4.75 away, in all 9.75 to 10.25.
    assert!(
        lines[1].starts_with("plane          z = 10, from (-4.") && lines[1].ends_with("64 x 64 texels"),
        "{}",
        lines[1]
    );
    assert!(lines[2].starts_with("blocked        ") && lines[2].contains(" of 4096 texels, "), "{}", lines[2]);
    assert!(lines[3].ends_with(" units (height, by cpu)"), "{}", lines[3]);
    assert!(lines[4].starts_with("nearest        of 4 corners, 5 edges, 2 faces; at most "), "{}", lines[4]);
    assert_eq!(lines[5..], ["wrote          d.png, f.png"]);
    assert_eq!(folder.names(), ["d.png", "f.png", "one.obj", "square.obj", "two.obj"]);
    // Texels are square unless both numbers are given.
    for (texels, expected) in [("16", "[16,8]"), ("16x3", "[16,3]")] {
        let plane = [&VOLUME[..2], &["--plane", "z=10:-8,-4,8,4", "--texels", texels, "--json"]].concat();
        let info = folder.run(&[&["multifocal", "one.obj", "-o", "d.png"][..], &plane].concat()).expect(0).json();
        assert_eq!(info["texels"].to_string(), expected);
    }
}

#[test]
fn bad_input_is_refused_in_one_line() {
    let folder = folder();
    folder.write("points.obj", "v 0 0 0\nv 1 0 0\n");
    folder.write("plan.geojson", crate::common::maze_text(1));
    let before = folder.names();
    let refused = |scene: &str, plane: &str, more: &[&str]| {
        folder.refused(&[&["multifocal", scene, "--plane", plane][..], &VOLUME[..2], more].concat())
    };
    let out = ["-o", "depth.png"];
    assert_eq!(
        refused("one.obj", "z=0.125", &out),
        "--plane z=0.125: the plane goes through the view volume, which reaches from z=-0.25 to z=0.25"
    );
    assert_eq!(
        refused("one.obj", "x=-0.25", &out),
        "--plane x=-0.25: the plane goes through the view volume, which reaches from x=-0.25 to x=0.25"
    );
    assert_eq!(
        refused("one.obj", "z=9:1,1,1,2", &out),
        "--plane z=9: the window from [1.0, 1.0] to [1.0, 2.0] is empty, or too small to be divided into texels"
    );
    assert_eq!(refused("points.obj", "z=9", &out), "points.obj: no triangles (0 objects, 0 triangles without area)");
    assert_eq!(refused("plan.geojson", "z=9", &out), "plan.geojson: neither a GLB nor a glTF nor an OBJ scene");
    assert_eq!(
        refused("one.obj", "z=9", &["-o", "depth.svg"]),
        "depth.svg: the picture is written as PNG; give a name that ends in .png"
    );
    assert_eq!(
        refused("one.obj", "z=9", &["-o", "a.png", "--voronoi", "a.png"]),
        "a.png: two outputs would be written to this file"
    );
    let missing = refused("none.obj", "z=9", &out);
    assert!(missing.starts_with("none.obj: "), "{missing}");
    let nowhere = refused("one.obj", "z=9", &["-o", "no/such/folder.png"]);
    assert!(nowhere.starts_with("no/such/folder.png: "), "{nowhere}");
    assert_eq!(folder.names(), before);
}

/// What the arguments' own words refuse: exit code 2, and the reason is named.
#[test]
fn bad_arguments_are_refused() {
    let folder = folder();
    let cases = [
        (["1,0,0,0,1,1", "z=9", "8"], "the lower corner is above the upper one: 1 is more than 0"),
        (["0,0,0,1,1,NaN", "z=9", "8"], "coordinate NaN is not a finite number"),
        (["0,0,0,1,1", "z=9", "8"], "a box is six comma-separated numbers: the lower corner, then the upper one"),
        (["0,0,0,1,1,1", "z=NaN", "8"], "coordinate NaN is not a finite number"),
        (["0,0,0,1,1,1", "z", "8"], "a plane is an axis and a place on it, such as z=20 or z=20:-4,-4,4,4"),
        (["0,0,0,1,1,1", "z=9:1,2", "8"], "a window is four comma-separated numbers"),
        (["0,0,0,1,1,1", "z=9", "0"], "'0' is not a whole number from 1 to 8192"),
        (["0,0,0,1,1,1", "z=9", "8x0"], "'0' is not a whole number from 1 to 8192"),
        (["0,0,0,1,1,1", "z=9", "8193"], "'8193' is not a whole number from 1 to 8192"),
    ];
    for ([volume, plane, texels], reason) in cases {
        let args = ["multifocal", "one.obj", "-o", "a.png", "--volume", volume, "--plane", plane, "--texels", texels];
        let run = folder.run(&args).expect(2);
        assert!(run.out.is_empty() && run.err.contains(reason), "{args:?}: {}", run.err);
    }
    assert_eq!(folder.names(), ["one.obj", "square.obj", "two.obj"]);
}

/// The picture for people has a title, the window and a scale, and leaves the other pictures as they are.
#[test]
fn charts_have_a_scale() {
    let folder = folder();
    let plain = draw(&folder, "one.obj", &[]);
    let picture = folder.read("depth.png");
    let info = draw(&folder, "one.obj", &["--chart", "chart.svg"]);
    assert!(folder.read("depth.png") == picture && info["n_blocked"] == plain["n_blocked"]);
    assert_eq!(info["files"], serde_json::json!(["depth.png", "chart.svg"]));
    let svg = String::from_utf8(folder.read("chart.svg")).expect("text");
    for text in ["Multifocal buffer on the plane z = 10", "x", "y", "-8", "8", "nothing is known to block"] {
        assert!(svg.contains(&format!("<title>{text}</title>")), "{text}");
    }
    assert_eq!(svg.matches("<image ").count(), 1);
    assert!(
        folder
            .refused(&[
                "multifocal",
                "one.obj",
                "-o",
                "a.png",
                "--volume",
                VOLUME[1],
                "--plane",
                PLANE[1],
                "--chart",
                "a.gif"
            ])
            .contains("ends in .svg or .png")
    );
}
