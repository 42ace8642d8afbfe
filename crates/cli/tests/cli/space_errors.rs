//! Scenes in space that cannot be used: one line that names the file, the node and the primitive, exit code
//! 2, and nothing written.

use crate::common::Folder;
use crate::common::picture::DRAWN;
use serde_json::{Value, json};

/// A GLB of these chunks, put together without the code that reads it.
fn glb(json: &Value, binary: &[u8]) -> Vec<u8> {
    let mut text = json.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut binary = binary.to_vec();
    binary.resize(binary.len().next_multiple_of(4), 0);
    let len = (28 + text.len() + binary.len()) as u32;
    let mut file = [b"glTF", &2u32.to_le_bytes()[..], &len.to_le_bytes()].concat();
    for (kind, chunk) in [(b"JSON", text), (b"BIN\0", binary)] {
        file.extend([&(chunk.len() as u32).to_le_bytes()[..], kind, &chunk].concat());
    }
    file
}

/// A document of one node called `wall`, whose one primitive is the triangle of these corners.
fn document(corners: [[f32; 3]; 3]) -> (Value, Vec<u8>) {
    let json = json!({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
        "nodes": [{"name": "wall", "mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 3}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "buffers": [{"byteLength": 36}]
    });
    (json, corners.iter().flatten().flat_map(|x| x.to_le_bytes()).collect())
}

const CORNERS: [[f32; 3]; 3] = [[0., 0., 0.], [4., 0., 0.], [0., 3., 2.]];

/// Builds `bad.glb` and sums it up; both must fail with the same words, and an output that was there stays.
fn refused(folder: &Folder, name: &str, bytes: &[u8]) -> String {
    folder.write(name, bytes);
    folder.write("out.pvs", "precious");
    let error = folder.refused(&["build", name, "-o", "out.pvs"]);
    assert_eq!(folder.read("out.pvs"), b"precious");
    assert_eq!(folder.refused(&["info", name]), error);
    assert!(error.starts_with(&format!("{name}: ")), "{error}");
    error
}

#[test]
fn the_sound_scene_is_taken() {
    let folder = Folder::new();
    let (json, binary) = document(CORNERS);
    folder.write("good.glb", glb(&json, &binary));
    folder.run(&["build", "good.glb", "-o", "out.pvs"]).expect(0);
}

#[test]
fn broken_containers_are_refused_at_every_length() {
    let folder = Folder::new();
    let (json, binary) = document(CORNERS);
    let sound = glb(&json, &binary);
    for len in [0, 3, 11, 12, 19, 40, sound.len() / 2, sound.len() - 36, sound.len() - 1] {
        refused(&folder, "bad.glb", &sound[..len]);
    }
    let noise: Vec<u8> = [&sound[..12], &[7; 200]].concat();
    refused(&folder, "bad.glb", &noise);
}

#[test]
fn broken_documents_are_refused_with_node_and_primitive() {
    let folder = Folder::new();
    let place = "node 0 (\"wall\"), primitive 0: ";
    type Change = fn(&mut Value);
    let cases: [(Change, &str); 8] = [
        (|j| j["buffers"] = json!([]), place),
        (|j| j["buffers"][0]["uri"] = json!("missing.bin"), place),
        (|j| j["buffers"][0]["byteLength"] = json!(12), place),
        (|j| j["bufferViews"][0]["byteLength"] = json!(u64::MAX), place),
        (|j| j["accessors"][0]["count"] = json!(1u64 << 60), place),
        (|j| j["meshes"][0]["primitives"][0]["mode"] = json!(9), place),
        (|j| j["nodes"][0]["scale"] = json!([1e300, 1, 1]), place),
        (|j| j["nodes"][0]["mesh"] = json!(3), "node 0 (\"wall\"): "),
    ];
    for (change, place) in cases {
        let (mut json, binary) = document(CORNERS);
        change(&mut json);
        let error = refused(&folder, "bad.glb", &glb(&json, &binary));
        assert!(error.contains(place), "{error}");
    }
    // The same as text, whose buffer is a file that is not there.
    let (mut json, _) = document(CORNERS);
    json["buffers"][0]["uri"] = json!("missing.bin");
    let error = refused(&folder, "bad.gltf", json.to_string().as_bytes());
    assert!(error.contains(place) && error.contains("missing.bin"), "{error}");
}

#[test]
fn coordinates_that_are_none_are_named() {
    let folder = Folder::new();
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let (json, binary) = document([CORNERS[0], [4.0, bad, 0.0], CORNERS[2]]);
        let error = refused(&folder, "bad.glb", &glb(&json, &binary));
        assert!(error.contains("node 0 (\"wall\"), primitive 0: ") && error.contains("position 1: "), "{error}");
    }
    for bad in ["nan", "inf", "1e300", "-1e300", "1e999", "x", ""] {
        let text = format!("o wall\nv 0 0 0\nv 4 {bad} 0\nv 0 3 2\nf 1 2 3\n");
        let error = refused(&folder, "bad.obj", text.as_bytes());
        assert!(error.starts_with("bad.obj: line 3: "), "{error}");
    }
}

#[test]
fn scenes_without_triangles_are_refused() {
    let folder = Folder::new();
    // On one line, twice the same corner, all in one point.
    for corners in [
        [[0., 0., 0.], [1., 2., 3.], [2., 4., 6.]],
        [[0., 0., 0.], [1., 2., 3.], [1., 2., 3.]],
        [[1., 1., 1.], [1., 1., 1.], [1., 1., 1.]],
    ] {
        let (json, binary) = document(corners);
        let error = refused(&folder, "flat.glb", &glb(&json, &binary));
        assert_eq!(error, "flat.glb: no triangles (1 objects, 1 triangles without area)");
    }
    let error = refused(&folder, "none.obj", b"# nothing\n");
    assert_eq!(error, "none.obj: no triangles (0 objects, 0 triangles without area)");
}

/// Sizes at the end of what coordinates may be are no errors, and a scene without room is one.
#[test]
fn sizes_and_flat_scenes() {
    let folder = Folder::new();
    for size in ["1e60", "1e-41"] {
        folder.write("far.obj", format!("o wall\nv 0 0 0\nv {size} 0 0\nv 0 {size} {size}\nf 1 2 3\n"));
        folder.run(&["build", "far.obj", "-o", "far.pvs"]).expect(0);
        folder.run(&["draw", "far.pvs", "-o", &format!("far.{DRAWN}"), "--isometric", "--size", "200"]).expect(0);
        folder.run(&["draw", "far.pvs", "-o", "far.svg", "--cell", "0"]).expect(0);
    }
    folder.write("floor.obj", "o floor\nv 0 0 0\nv 4 0 0\nv 0 0 4\nf 1 2 3\n");
    folder.write("out.pvs", "precious");
    let error = folder.refused(&["build", "floor.obj", "-o", "out.pvs"]);
    assert_eq!(error, "floor.obj: the scene has no extent along axis 1");
    assert_eq!(folder.read("out.pvs"), b"precious");
    folder.run(&["build", "floor.obj", "-o", "out.pvs", "--view-region", "0,0,0,4,2,4"]).expect(0);
}

/// A gap below the rounding of the coordinates cannot be kept, and one that is no width is none.
#[test]
fn gaps_that_cannot_be_kept_are_refused() {
    let folder = Folder::new();
    let (json, binary) = document(CORNERS);
    folder.write("wall.glb", glb(&json, &binary));
    let run = folder.run(&["build", "wall.glb", "-o", "out.pvs", "--gap", "1e-300"]).expect(2);
    assert_eq!(
        run.err,
        "error: wall.glb: object 0, vertex 1: the gap of the frame is within the rounding of doubles\n"
    );
    for wrong in ["-1", "NaN", "inf", "wide"] {
        let run = folder.run(&["build", "wall.glb", "-o", "out.pvs", "--gap", wrong]).expect(2);
        assert!(run.err.contains("--gap <WIDTH>") && run.err.contains("not a number from 0 on"), "{}", run.err);
    }
    assert!(!folder.path("out.pvs").exists());
}
