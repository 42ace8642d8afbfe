//! Scenes in space: what is read from small glTFs and OBJs, and what the errors say.

use crate::common::glb::{Doc, SMALL_OBJ, glb, small_doc};
use serde_json::json;
use sightlines_cells::{Scene, SceneObject};
use sightlines_formats::scene::{
    Axis, BackFaces, LengthUnit, MAX_ELEMENTS, MAX_OBJECTS, SceneFormat, SceneReadOptions, SceneWriteError, parse_glb,
    parse_glb_with_source, parse_gltf_with, parse_obj, read_scene, write_glb,
};
use sightlines_formats::{SceneFile, atomic_write};
use sightlines_pvs::ObjectSource;

fn read(doc: &Doc) -> SceneFile {
    parse_glb(&doc.glb(), None).unwrap_or_else(|e| panic!("{e}"))
}

fn error(doc: &Doc) -> String {
    parse_glb(&doc.glb(), None).unwrap_err().to_string()
}

fn names(file: &SceneFile) -> Vec<&str> {
    file.scene.objects().iter().map(|o| o.name.as_str()).collect()
}

/// The corners of all triangles of an object.
fn corners(file: &SceneFile, object: usize) -> Vec<[[f64; 3]; 3]> {
    file.scene.objects()[object].corners().collect()
}

const X: [f64; 3] = [1., 0., 0.];
const Y: [f64; 3] = [0., 1., 0.];
const O: [f64; 3] = [0., 0., 0.];

// --- glTF ------------------------------------------------------------------------------------------

#[test]
fn one_triangle_with_all_that_is_said_about_it() {
    let mut doc = Doc::new(json!([{"name": "sail", "mesh": 0}]));
    doc.triangle();
    let file = read(&doc);
    assert_eq!(corners(&file, 0), [[O, X, Y]]);
    assert_eq!(names(&file), ["sail"]);
    let info = &file.info;
    assert_eq!(
        (info.format, info.up, info.up_is_assumed, info.unit),
        (SceneFormat::Gltf, Axis::Y, false, LengthUnit::Metre)
    );
    assert_eq!((info.n_objects, info.n_objects_without_triangles, info.n_triangles), (1, 0, 1));
    assert_eq!(info.left_out_triangles, [[0; 2]; 0]);
}

#[test]
fn nested_transforms_are_those_computed_by_hand() {
    let mut doc = Doc::new(json!([
        {"children": [1], "translation": [10, 0, 0], "scale": [2, 2, 2]},
        // A quarter turn about y takes x to -z and z to x.
        {"children": [2], "rotation": [0, std::f32::consts::FRAC_1_SQRT_2, 0, std::f32::consts::FRAC_1_SQRT_2]},
        {"mesh": 0, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1]},
    ]));
    doc.triangle();
    // (0,0,0) to (5,6,7) to (7,6,-5) to (24,12,-10); the arms turn and double.
    assert_eq!(corners(&read(&doc), 0), [[[24., 12., -10.], [24., 12., -12.], [24., 14., -10.]]]);
    // Mirrored once, the triangle is turned round; mirrored twice, it is not.
    doc.json["nodes"][0]["scale"] = json!([2, 2, -2]);
    assert_eq!(corners(&read(&doc), 0), [[[24., 12., 10.], [24., 14., 10.], [24., 12., 12.]]]);
    doc.json["nodes"][2]["matrix"] = json!([1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1]);
    assert_eq!(corners(&read(&doc), 0), [[[24., 12., 10.], [24., 12., 12.], [24., 10., 10.]]]);
}

#[test]
fn far_from_the_origin_nothing_moves() {
    let mut doc = Doc::new(json!([{"mesh": 0, "translation": [10_000_000.25, -0.1, 0]}]));
    doc.triangle();
    assert_eq!(
        corners(&read(&doc), 0),
        [[[10_000_000.25, -0.1, 0.], [10_000_001.25, -0.1, 0.], [10_000_000.25, 0.9, 0.]]]
    );
}

#[test]
fn objects_come_parents_first_and_children_in_order() {
    let mut doc = Doc::new(json!([
        {"name": "leaf", "mesh": 0}, {"name": "root", "mesh": 1, "children": [3, 0]}, {"mesh": 1}, {"children": [4]}, {"mesh": 0}
    ]));
    doc.triangle();
    let p = doc.json["meshes"][0]["primitives"][0].clone();
    doc.push("meshes", json!({"name": "pair", "primitives": [p, p]}));
    assert_eq!(names(&read(&doc)), ["root", "root#1", "node 4", "leaf", "pair", "pair#1"]);
    doc.json["scenes"][0]["nodes"] = json!([2, 1]);
    assert_eq!(names(&read(&doc)), ["pair", "pair#1", "root", "root#1", "node 4", "leaf"]);
    // The default scene, the first scene, all trees.
    doc.push("scenes", json!({"nodes": [0]}));
    doc.json["scene"] = json!(1);
    assert_eq!(names(&read(&doc)), ["leaf"]);
    doc.json.as_object_mut().unwrap().remove("scene");
    assert_eq!(names(&read(&doc)).len(), 6);
    doc.json["scenes"] = json!([]);
    assert_eq!(names(&read(&doc)), ["root", "root#1", "node 4", "leaf", "pair", "pair#1"]);
}

#[test]
fn strips_fans_points_and_lines() {
    let mut doc = Doc::new(json!([{"name": "n", "mesh": 0}]));
    let p = doc.positions(&[[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [1., 1., 0.], [0., 2., 1.]]);
    let two = doc.indices(&[3, 0], 1);
    let all = json!({"POSITION": p});
    doc.mesh(json!([
        {"attributes": all, "mode": 5}, {"attributes": all, "mode": 6}, {"attributes": all, "mode": 0},
        {"attributes": all, "mode": 1, "indices": two},
    ]));
    let file = read(&doc);
    let v = [O, X, Y, [1., 1., 0.], [0., 2., 1.]];
    assert_eq!(corners(&file, 0), [[v[0], v[1], v[2]], [v[1], v[3], v[2]], [v[2], v[3], v[4]]]);
    assert_eq!(corners(&file, 1), [[v[1], v[2], v[0]], [v[2], v[3], v[0]], [v[3], v[4], v[0]]]);
    let points = |k: usize| (file.scene.objects()[k].vertices.clone(), corners(&file, k).len());
    assert_eq!((points(2), points(3)), ((v.to_vec(), 0), (vec![v[0], v[3]], 0)));
    assert_eq!((file.info.n_objects, file.info.n_objects_without_triangles), (4, 2));
}

#[test]
fn indices_of_every_size_and_corners_that_nothing_uses() {
    for size in [1, 2, 4] {
        let mut doc = Doc::new(json!([{"mesh": 0}]));
        let p = doc.positions(&[[9., 9., 9.], [0., 0., 0.], [8., 8., 8.], [1., 0., 0.], [0., 1., 0.]]);
        let i = doc.indices(&[4, 1, 3], size);
        doc.mesh(json!([{"attributes": {"POSITION": p, "NORMAL": p}, "indices": i}]));
        let file = read(&doc);
        assert_eq!(corners(&file, 0), [[Y, O, X]]);
        assert_eq!(file.scene.objects()[0].vertices, [O, X, Y]);
    }
}

#[test]
fn quantised_interleaved_and_sparse_positions() {
    let file = read(&small_doc());
    assert_eq!(names(&file), ["hall", "wall", "wall#1"].map(|n| if n == "hall" { "node 2" } else { n }));
    // 32767 stands for 1 and -32768 for no less than -1; the sparse element replaces the third.
    let half = 16384. / 32767.;
    let at = |p: [f64; 3]| [10. - 2. * p[0], 2. * p[1], 2. * p[2] - 3.];
    // A fan, and mirrored.
    assert_eq!(corners(&file, 0), [[at(X), at(O), at([0., 1., half])]]);
    assert_eq!((file.info.n_triangles, file.info.n_degenerate_triangles), (5, 1));

    let component = |code: u32, bytes: &[u8], normalized: bool| {
        let mut doc = Doc::new(json!([{"mesh": 0}]));
        let a = doc.accessor(bytes, code, "VEC3", 3);
        doc.json["accessors"][a]["normalized"] = json!(normalized);
        doc.mesh(json!([{"attributes": {"POSITION": a}}]));
        read(&doc).scene.objects()[0].vertices.clone()
    };
    let bytes = [0, 0, 0, 127, 0, 0, 0, 128, 0];
    assert_eq!(component(5120, &bytes, true), [O, X, [0., -1., 0.]]);
    assert_eq!(component(5120, &bytes, false), [O, [127., 0., 0.], [0., -128., 0.]]);
    assert_eq!(component(5121, &bytes, true), [O, [127. / 255., 0., 0.], [0., 128. / 255., 0.]]);
    let shorts: Vec<u8> = [0u16, 0, 0, 65535, 0, 0, 0, 1, 0].iter().flat_map(|x| x.to_le_bytes()).collect();
    assert_eq!(component(5123, &shorts, true), [O, X, [0., 1. / 65535., 0.]]);
    assert_eq!(component(5122, &shorts, false), [O, [-1., 0., 0.], Y]);
}

#[test]
fn sparse_positions_without_a_base() {
    let mut doc = Doc::new(json!([{"mesh": 0}]));
    let at = doc.view(&[1, 0, 2, 0], None);
    let bytes: Vec<u8> = [1f32, 0., 0., 0., 1., 0.].iter().flat_map(|x| x.to_le_bytes()).collect();
    let values = doc.view(&bytes, None);
    let sparse =
        json!({"count": 2, "indices": {"bufferView": at, "componentType": 5123}, "values": {"bufferView": values}});
    let a = doc.push("accessors", json!({"componentType": 5126, "type": "VEC3", "count": 3, "sparse": sparse}));
    doc.mesh(json!([{"attributes": {"POSITION": a}}]));
    assert_eq!(corners(&read(&doc), 0), [[O, X, Y]]);
    doc.json["accessors"][a]["count"] = json!(30_000_000);
    assert_eq!(error(&doc), "node 0, primitive 0: positions (accessor 0): 30000000 elements that are in no buffer");
    doc.json["accessors"][a]["count"] = json!(2);
    assert_eq!(
        error(&doc),
        "node 0, primitive 0: positions (accessor 0): sparse index 1 does not ascend or is not below 2"
    );
}

#[test]
fn triangles_without_area_are_counted_and_left_out() {
    let mut doc = Doc::new(json!([{"mesh": 0}, {"mesh": 0, "scale": [1, 1, 0]}, {"mesh": 0, "scale": [1, 0, 0]}]));
    let p = doc.positions(&[[0., 0., 0.], [1., 1., 0.], [2., 2., 0.], [0., 0., 1.], [3., 0., 0.], [0., 0., 0.]]);
    let i = doc.indices(&[0, 1, 2, 0, 1, 1, 0, 5, 1, 0, 1, 3, 0, 1, 4], 2);
    doc.mesh(json!([{"attributes": {"POSITION": p}, "indices": i}]));
    let file = read(&doc);
    let counts: Vec<usize> = file.scene.objects().iter().map(|o| o.triangles.len()).collect();
    assert_eq!((counts, file.info.n_degenerate_triangles), (vec![2, 1, 0], 3 + 4 + 5));
    assert!(file.scene.objects().iter().all(|o| o.vertices.len() == 6));
}

#[test]
fn buffers_wherever_they_are() {
    let folder = tempfile::tempdir().unwrap();
    let mut doc = Doc::new(json!([{"name": "a", "mesh": 0}]));
    doc.triangle();
    let parse = |doc: &Doc| parse_glb(doc.text().as_bytes(), Some(folder.path()));
    let fails = |doc: &Doc, with: &str| {
        let error = parse(doc).unwrap_err().to_string();
        assert!(error.starts_with("node 0 (\"a\"), primitive 0: positions (accessor 0): buffer 0: "), "{error}");
        assert!(error.contains(with), "{error}");
    };
    fails(&doc, "it has no URI and there is no binary chunk for it");
    let mut set = |uri: &str| {
        doc.json["buffers"][0]["uri"] = json!(uri);
        doc.clone()
    };
    let missing = set("no%20such.bin");
    fails(&missing, "\"no%20such.bin\" cannot be read: ");
    let no_folder = parse_glb(missing.text().as_bytes(), None).unwrap_err().to_string();
    assert!(no_folder.ends_with("\"no%20such.bin\" is not a file in the scene's folder"), "{no_folder}");
    fails(&set("../x.bin"), "is not a file in the scene's folder");
    fails(&set("."), "is not a file in the scene's folder");
    fails(&set("data:text/plain;base64,AAA"), "it states 36 bytes, there are 2");
    fails(&set("data:,AAAA"), "its data URI is not base64");

    let outside = set("the%20walls.bin");
    atomic_write(folder.path().join("the walls.bin"), &outside.binary).unwrap();
    assert_eq!(corners(&parse(&outside).unwrap(), 0), [[O, X, Y]]);
    // The nine numbers of the triangle, coded by another program.
    let coded = "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA";
    assert_eq!(corners(&parse(&set(coded)).unwrap(), 0), [[O, X, Y]]);

    // The same through files with names.
    let path = folder.path().join("scene.gltf");
    atomic_write(&path, outside.text().as_bytes()).unwrap();
    assert_eq!(read_scene(&path).unwrap().info.n_triangles, 1);
    let path = folder.path().join("scene.dat");
    atomic_write(&path, &small_doc().glb()).unwrap();
    assert_eq!(read_scene(&path).unwrap().info.n_objects, 3);
    let path = folder.path().join("scene.OBJ");
    atomic_write(&path, SMALL_OBJ.as_bytes()).unwrap();
    assert_eq!(read_scene(&path).unwrap().info.format, SceneFormat::Obj);
    let path = folder.path().join("scene.txt");
    atomic_write(&path, b"o x").unwrap();
    let error = read_scene(&path).unwrap_err().to_string();
    assert!(error.ends_with("scene.txt: neither GLB nor glTF nor OBJ"), "{error}");
}

// --- What is refused -------------------------------------------------------------------------------

#[test]
fn broken_containers_are_refused() {
    let says = |bytes: &[u8], text: &str| assert_eq!(parse_glb(bytes, None).unwrap_err().to_string(), text);
    says(b"glTF\x02\0\0", "not a GLB: 7 bytes are less than a header");
    says(
        b"glTF\x01\0\0\0\x0C\0\0\0",
        "GLB version 1 is not 2; `npx gltf-pipeline -i IN.gltf -o OUT.glb` makes version 2 of version 1",
    );
    says(b"glTF\x03\0\0\0\x0C\0\0\0", "GLB version 3 is not 2");
    says(b"glTF\x02\0\0\0\x03\0\0\0", "the header states 3 bytes, the file has 12");
    says(b"glTF\x02\0\0\0\x0C\0\0\0", "the first chunk is not JSON");
    says(b"glTF\x02\0\0\0\x14\0\0\0\x01\0\0\0JSON", "the chunk at byte 12 is not inside the 20 bytes of the file");
    says(b"glTF\x02\0\0\0\x14\0\0\0\0\0\0\0BIN\0", "the first chunk is not JSON");
    says(&glb("{}", b""), "the glTF text cannot be read: missing field `asset` at line 1 column 2");
    says(b"{\"asset\":\xFF}", "byte 9 of the glTF text is not UTF-8");
    says(
        br#"{"asset":{"version":"1.0"}}"#,
        "glTF version \"1.0\" is not 2.x; `npx gltf-pipeline -i IN.gltf -o OUT.glb` makes version 2 of version 1",
    );
    // Of other versions the rest of the text may have any form.
    says(
        br#"{"asset":{"version":"1.1"},"nodes":{}}"#,
        "glTF version \"1.1\" is not 2.x; `npx gltf-pipeline -i IN.gltf -o OUT.glb` makes version 2 of version 1",
    );
    says(br#"{"asset":{"version":0.8},"nodes":{}}"#, "glTF version \"0.8\" is not 2.x");
    says(br#"{"asset":{"version":"2.1"}}"#, "no triangles (0 objects, 0 triangles without area)");
    // Chunks of extensions, and what is behind the GLB, are skipped.
    let mut file = small_doc().glb();
    file.extend(b"\x04\0\0\0xtra1234");
    let len = file.len() as u32;
    file[8..12].copy_from_slice(&len.to_le_bytes());
    file.extend(b"behind");
    assert_eq!(parse_glb(&file, None).unwrap(), read(&small_doc()));
}

#[test]
fn errors_name_node_and_primitive() {
    let with = |spoil: &dyn Fn(&mut Doc), text: &str| {
        let mut doc = small_doc();
        spoil(&mut doc);
        assert_eq!(error(&doc), text);
    };
    let set = |pointer: &'static str, value: serde_json::Value, text: &str| {
        with(&|doc| *doc.json.pointer_mut(pointer).unwrap_or_else(|| panic!("{pointer}")) = value.clone(), text);
    };
    let quantised = "node 2, primitive 0: positions (accessor 2): ";
    let wall = "node 1 (\"wall\"), primitive 0: ";
    set("/scene", json!(1), "there is no scene 1, which should be the default");
    set("/scenes/0/nodes/0", json!(3), "scene 0: there is no node 3");
    set("/scenes/0/nodes", json!([0, 0]), "node 0 (\"hall\"): reached twice, though nodes form trees");
    set("/nodes/0/children/1", json!(0), "node 0 (\"hall\"): reached twice, though nodes form trees");
    set("/nodes/0/children/1", json!(2), "node 2: reached twice, though nodes form trees");
    set("/nodes/0/children/1", json!(9), "node 0 (\"hall\"): there is no node 9, which it has as a child");
    set("/nodes/1/mesh", json!(2), "node 1 (\"wall\"): there is no mesh 2");
    set("/nodes/1/rotation", json!([0, 0, 0, 0]), "node 1 (\"wall\"): its rotation is the zero quaternion");
    set("/nodes/0/matrix/3", json!(1), "node 0 (\"hall\"): its matrix is not affine");
    with(
        &|doc| doc.json["nodes"][0]["scale"] = json!([1, 1, 1]),
        "node 0 (\"hall\"): both a matrix and a translation, rotation or scale",
    );
    set(
        "/extensionsRequired/0",
        json!("KHR_draco_mesh_compression"),
        "extension KHR_draco_mesh_compression is not understood; `npx @gltf-transform/cli cp IN.glb OUT.glb` unpacks the \
         file",
    );
    set(
        "/extensionsRequired/0",
        json!("EXT_meshopt_compression"),
        "extension EXT_meshopt_compression is not understood; `npx @gltf-transform/cli cp IN.glb OUT.glb` unpacks the file",
    );
    let instances = |attributes: serde_json::Value, text: &str| {
        let extension = json!({"EXT_mesh_gpu_instancing": attributes});
        with(&|doc| doc.json["nodes"][1]["extensions"] = extension.clone(), text);
    };
    let without = "node 1 (\"wall\"): EXT_mesh_gpu_instancing without TRANSLATION, ROTATION or SCALE";
    instances(json!({}), without);
    instances(json!({"attributes": {"COLOR_0": 0}}), without);
    let unfit = |attribute: &str, accessor: usize| {
        format!("node 1 (\"wall\"): EXT_mesh_gpu_instancing: {attribute} (accessor {accessor}) does not fit")
    };
    instances(json!({"attributes": {"TRANSLATION": 9}}), &unfit("TRANSLATION", 9));
    instances(json!({"attributes": {"ROTATION": 0}}), &unfit("ROTATION", 0));
    // Four positions, and three quantised ones.
    instances(json!({"attributes": {"TRANSLATION": 0, "SCALE": 2}}), &unfit("TRANSLATION", 0));
    set("/meshes/1/primitives/0/mode", json!(7), "node 2, primitive 0: mode 7 does not exist");
    set("/meshes/1/primitives/0/attributes", json!({}), "node 2, primitive 0: no positions");
    set("/meshes/0/primitives/1/mode", json!(4), "node 1 (\"wall\"), primitive 1: 4 corners are no list of triangles");
    set("/meshes/0/primitives/0/indices", json!(9), &format!("{wall}indices (accessor 9): it does not exist"));
    set(
        "/meshes/0/primitives/0/indices",
        json!(0),
        &format!("{wall}indices (accessor 0): elements of type \"VEC3\" with components 5126 cannot be that"),
    );
    set(
        "/accessors/2/type",
        json!("VEC2"),
        &format!("{quantised}elements of type \"VEC2\" with components 5122 cannot be that"),
    );
    set(
        "/accessors/2/componentType",
        json!(5125),
        &format!("{quantised}elements of type \"VEC3\" with components 5125 cannot be that"),
    );
    set("/accessors/2/count", json!(0), &format!("{quantised}it has no elements"));
    set("/accessors/2/count", json!(4), &format!("{quantised}4 elements are not inside the 24 bytes of buffer view 2"));
    set(
        "/accessors/2/count",
        json!(u64::MAX),
        "node 2, primitive 0: positions (accessor 2): 18446744073709551615 elements are not inside the 24 bytes of buffer view 2",
    );
    with(
        &|doc| doc.json["accessors"][2]["byteOffset"] = json!(25),
        &format!("{quantised}3 elements are not inside the 24 bytes of buffer view 2"),
    );
    with(
        &|doc| doc.json["accessors"][2]["byteOffset"] = json!(u64::MAX),
        &format!("{quantised}3 elements are not inside the 24 bytes of buffer view 2"),
    );
    set("/accessors/2/bufferView", json!(17), &format!("{quantised}there is no buffer view 17"));
    set(
        "/bufferViews/2/byteStride",
        json!(5),
        &format!("{quantised}buffer view 2: stride 5 is less than 6 bytes of an element"),
    );
    set(
        "/bufferViews/2/byteOffset",
        json!(999),
        &format!("{quantised}buffer view 2 is not inside the 107 bytes of buffer 0"),
    );
    set(
        "/bufferViews/2/byteOffset",
        json!(u64::MAX),
        &format!("{quantised}buffer view 2 is not inside the 107 bytes of buffer 0"),
    );
    set("/bufferViews/2/buffer", json!(1), &format!("{quantised}buffer 1: it does not exist"));
    set("/buffers/0/byteLength", json!(9999), &format!("{quantised}buffer 0: it states 9999 bytes, there are 108"));
    set(
        "/accessors/2/sparse/count",
        json!(2),
        &format!("{quantised}2 elements are not inside the 1 bytes of buffer view 3"),
    );
    with(
        &|doc| doc.binary[40..44].copy_from_slice(&f32::NAN.to_le_bytes()),
        &format!("{wall}position 3: coordinate NaN is not a finite number"),
    );
}

#[test]
fn coordinates_that_are_no_places_are_refused() {
    let mut doc = Doc::new(json!([{"name": "a\n", "mesh": 0}]));
    doc.triangle();
    let text =
        |doc: &Doc, end: &str| assert_eq!(error(doc), format!("node 0 (\"a\\n\"), primitive 0: position 1: {end}"));
    for (number, end) in [(f32::NAN, "NaN"), (f32::INFINITY, "inf"), (f32::NEG_INFINITY, "-inf")] {
        let mut broken = doc.clone();
        broken.binary[12..16].copy_from_slice(&number.to_le_bytes());
        let end = if number.is_nan() { "NaN".to_owned() } else { end.to_owned() };
        // An infinity that a matrix multiplies by zero is no number in the other coordinates.
        assert!(error(&broken).starts_with("node 0 (\"a\\n\"), primitive 0: position 1: coordinate "), "{end}");
        assert!(error(&broken).ends_with(" is not a finite number"));
    }
    doc.json["nodes"][0]["scale"] = json!([1e300, 1, 1]);
    text(&doc, "coordinate 1e300 is neither 0 nor between 2^-140 and 2^200 in magnitude");
    // Less than the least coordinate is zero.
    doc.json["nodes"][0]["scale"] = json!([1e-300, 1, 1]);
    assert_eq!(error(&doc), "no triangles (1 objects, 1 triangles without area)");
}

#[test]
fn absurd_sizes_are_refused_at_once() {
    let many = |n: usize, name: &str| {
        let nodes: Vec<_> = (0..n).map(|_| json!({"mesh": 0, "name": name})).collect();
        let mut doc = Doc::new(json!([]));
        doc.json["scenes"][0]["nodes"] = (0..n).collect();
        doc.json["nodes"] = json!(nodes);
        doc
    };
    let says = |doc: &Doc, max: usize, what: &str| {
        let text = error(doc);
        assert!(text.ends_with(&format!("primitive 0: with it the scene has more than {max} {what}")), "{text}");
    };
    let n = 1 << 13;
    let mut doc = many(MAX_ELEMENTS / (n - 2) + 1, "x");
    let p = doc.positions(&vec![[0.; 3]; n]);
    doc.mesh(json!([{"attributes": {"POSITION": p}, "mode": 5}]));
    says(&doc, MAX_ELEMENTS, "corners");
    doc.json["accessors"][p]["count"] = json!(3);
    doc.json["meshes"][0]["primitives"][0]["indices"] = json!(1);
    doc.indices(&vec![0; n], 1);
    says(&doc, MAX_ELEMENTS, "triangles");
    doc.json["accessors"][p]["count"] = json!(n);
    doc.json["meshes"][0]["primitives"][0]["mode"] = json!(0);
    says(&doc, MAX_ELEMENTS, "corners");
    let mut doc = many(1 << 10, "x");
    let p = doc.positions(&[[0.; 3]]);
    let primitive = json!({"attributes": {"POSITION": p}, "mode": 0});
    doc.mesh(json!(vec![primitive.clone(); (1 << 12) + 1]));
    assert!(error(&doc).ends_with(&format!("more than {MAX_OBJECTS} objects")));
    let mut doc = many(1, &"long".repeat(1 << 16));
    doc.positions(&[[0.; 3]]);
    doc.mesh(json!(vec![primitive; 1 << 12]));
    assert!(error(&doc).ends_with(&format!("more than {MAX_OBJECTS} objects")));
    // Depth is no size.
    let n = 100_000;
    let mut doc = many(n, "deep");
    doc.triangle();
    for k in 1..n {
        doc.json["nodes"][k - 1] = json!({"children": [k]});
    }
    doc.json["scenes"][0]["nodes"] = json!([0]);
    assert_eq!(read(&doc).info.n_objects, 1);
}

// --- OBJ -------------------------------------------------------------------------------------------

fn obj(text: &str) -> SceneFile {
    parse_obj(text.as_bytes()).unwrap_or_else(|e| panic!("{e}"))
}

#[test]
fn objs_are_read() {
    let file = obj(SMALL_OBJ);
    assert_eq!(names(&file), ["floor", "notch"]);
    let v = [O, [4., 0., 0.], [4., 3., 0.], [0., 3., 0.], [2.5, 1., 0.]];
    assert_eq!(corners(&file, 0), [[v[0], v[1], v[2]], [v[0], v[2], v[3]]]);
    // Cut so that the notch stays open.
    assert_eq!(corners(&file, 1), [[v[0], v[1], v[4]], [v[0], v[4], v[3]], [v[0], v[1], v[4]]]);
    let info = &file.info;
    assert_eq!(
        (info.format, info.up, info.up_is_assumed, info.unit),
        (SceneFormat::Obj, Axis::Y, true, LengthUnit::Unknown)
    );
}

#[test]
fn groups_are_objects_only_without_objects() {
    let v = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    let f = "f 1 2 3\n";
    assert_eq!(
        names(&obj(&format!("{v}{f}g a b\n{f}usemtl x\n{f}g\n{f}g empty\ng last\n{f}"))),
        ["object 0", "a b", "object 2", "last"]
    );
    assert_eq!(names(&obj(&format!("{v}o camera\no house\ng wall\n{f}g roof\n{f}o tree\n{f}"))), ["house", "tree"]);
    // A face may stand before its corners, lines may end as on Windows, comments may be in any code.
    assert_eq!(names(&obj(&format!("o é\r\n{f}{v}#o x\n"))), ["é"]);
    assert!(parse_obj(format!("# caf\u{e9}\n{v}{f}").replace('\u{e9}', "e").as_bytes()).is_ok());
    assert!(parse_obj(&[b"# \xE9\n", v.as_bytes(), f.as_bytes()].concat()).is_ok());
    // Double precision.
    assert_eq!(corners(&obj(&format!("v 10000000.1 0 1\n{v}{f}")), 0)[0][0][0], 10_000_000.1);
}

#[test]
fn concave_faces_cover_no_more_than_themselves() {
    let file = obj("v 0 0 0\nv 4 1 0\nv 0 4 0\nv 1 1 0\nf 1 2 3 4\n");
    let area = |[a, b, c]: [[f64; 3]; 3]| ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2.0;
    let areas: Vec<f64> = corners(&file, 0).into_iter().map(area).collect();
    assert_eq!(areas.iter().sum::<f64>(), 6.0);
    assert!(areas.iter().all(|&a| a > 0.0));
}

#[test]
fn broken_objs_are_refused_with_their_line() {
    let says = |text: &str, error: &str| assert_eq!(parse_obj(text.as_bytes()).unwrap_err().to_string(), error);
    let v = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
    says("", "no triangles (0 objects, 0 triangles without area)");
    says(&format!("{v}f 1 1 2"), "no triangles (1 objects, 1 triangles without area)");
    says("\nv 0 1", "line 2: a corner needs three numbers");
    says("v 0 1 x", "line 1: a corner needs three numbers");
    says("v 0 nan 1", "line 1: coordinate NaN is not a finite number");
    says("v 0 1e999 1", "line 1: coordinate inf is not a finite number");
    says("v 0 1 1 0.5", "line 1: a corner with a weight other than 1");
    says(&format!("{v}f 1 2"), "line 5: a face needs three corners or more");
    says(&format!("{v}f 1 2 x"), "line 5: a face needs indices of corners");
    says(&format!("{v}f 1 2 /3"), "line 5: a face needs indices of corners");
    says(&format!("{v}f 1 2 5"), "line 5: there is no corner 5");
    says(&format!("{v}f 0 1 2"), "line 5: there is no corner 0");
    says(&format!("{v}f 1 2 -5"), "line 5: there is no corner -5");
    says(&format!("{v}f 1 2 -9223372036854775808"), "line 5: there is no corner -9223372036854775808");
    says(&format!("{v}f 1 2 9223372036854775807"), "line 5: there is no corner 9223372036854775807");
    says(&format!("{v}f 1 3 2 4"), "line 5: the outline of the face crosses itself");
    let error = parse_obj(b"v 0 0 0\no \xFF").unwrap_err().to_string();
    assert_eq!(error, "line 2: not UTF-8");
}

// --- Writing ---------------------------------------------------------------------------------------

fn scene(objects: Vec<SceneObject>) -> Scene {
    Scene::new(objects).unwrap()
}

/// The scene as it is without a file.
fn unplaced(scene: Scene) -> Scene {
    scene.with_sources(Vec::new()).unwrap()
}

#[test]
fn what_was_written_is_read() {
    let triangle = |name: &str, x: f64| SceneObject {
        name: name.to_owned(),
        vertices: vec![[x, 0.0, 0.0], [1e7, 0.25, 0.0], [0.0, 1.5, -2.0]],
        triangles: vec![[0, 1, 2], [1, 0, 2]],
    };
    let points = SceneObject { triangles: vec![], ..triangle("points", 7.0) };
    let large = SceneObject {
        name: String::new(),
        vertices: (0..70_000).map(|k| [f64::from(k), f64::from(k % 2), 0.0]).collect(),
        triangles: (0..69_998).map(|k| [k, k + 1, k + 2]).collect(),
    };
    let scene = scene(vec![triangle("a \"b\"\u{1}", 0.0), points, large, triangle("a", -3.5)]);
    let bytes = write_glb(&scene).unwrap();
    let placed = |k: u32| Some(ObjectSource { node: k, primitive: 0 });
    let read = parse_glb(&bytes, None).unwrap().scene;
    assert_eq!(read.sources(), (0..4).map(placed).collect::<Vec<_>>(), "each object is a node of its own");
    assert_eq!(unplaced(read), scene);
    assert_eq!(write_glb(&scene).unwrap(), bytes);
    // An impostor with one bit of a coordinate flipped is another scene.
    let mut other = bytes;
    let last = other.len() - 4 - 12;
    other[last] ^= 1;
    assert_ne!(parse_glb(&other, None).map(|file| file.scene).ok(), Some(scene));
}

#[test]
fn mirrors_are_marked_and_written() {
    let mut doc = small_doc();
    let mesh = doc.triangle();
    for node in [
        json!({"name": "a-mirror", "mesh": mesh}),
        json!({"name": "b", "mesh": mesh, "extras": {"sightlines": {"role": "mirror"}, "more": [1]}}),
        json!({"name": "c-mirrors", "mesh": mesh, "extras": "mirror"}),
        json!({"name": "d", "mesh": mesh, "extras": null}),
    ] {
        let node = doc.push("nodes", node);
        doc.json["scenes"][0]["nodes"].as_array_mut().unwrap().push(json!(node));
    }
    let read = parse_glb(&doc.glb(), None).unwrap().scene;
    let names = |scene: &Scene| -> Vec<String> {
        scene.mirrors().iter().map(|&k| scene.objects()[k as usize].name.clone()).collect()
    };
    assert_eq!(names(&read), ["a-mirror", "b"]);
    let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\no hall\nf 1 2 3\no wall-mirror\nf 1 2 3\no mirror\nf 3 2 1\n";
    let read = parse_obj(obj.as_bytes()).unwrap().scene;
    assert_eq!(names(&read), ["wall-mirror"]);
    let groups = parse_obj(obj.replace("\no ", "\ng ").as_bytes()).unwrap().scene;
    assert_eq!(names(&groups), ["wall-mirror"]);
    let marked = read.clone().with_mirrors(vec![1, 2]).unwrap();
    let again = parse_glb(&write_glb(&marked).unwrap(), None).unwrap().scene;
    let again = unplaced(again);
    assert_eq!(again, marked);
    assert_ne!(again, read, "an impostor");
}

#[test]
fn what_cannot_be_written_is_refused() {
    let one = |p: [f64; 3]| SceneObject { name: "x".into(), vertices: vec![p], triangles: vec![] };
    let error = write_glb(&scene(vec![one(O), one([0.0, 0.1, 0.0])])).unwrap_err();
    assert_eq!(error, SceneWriteError::Precision { object: 1, vertex: 0, value: 0.1 });
    assert_eq!(error.to_string(), "object 1, vertex 0: 0.1 is not a number of single precision");
    assert!(write_glb(&scene(vec![one([1e60, 0., 0.])])).is_err());
    let none = SceneObject { vertices: vec![], ..one(O) };
    assert_eq!(write_glb(&scene(vec![none])), Err(SceneWriteError::Empty { object: 0 }));
    // Nothing at all can be written, if not read again as a scene with something in it.
    let error = parse_glb(&write_glb(&scene(vec![])).unwrap(), None).unwrap_err();
    assert_eq!(error.to_string(), "no triangles (0 objects, 0 triangles without area)");
}

/// A node with instances is drawn at each of them and nowhere else.
#[test]
fn instances_are_objects() {
    let mut doc = Doc::new(json!([
        {"children": [1], "translation": [0, 100, 0]},
        {"name": "tree", "mesh": 0, "scale": [2, 2, 2], "children": [2]},
        {"name": "nest", "mesh": 0},
    ]));
    doc.triangle();
    let places = doc.positions(&[[0., 0., 0.], [5., 0., 0.], [0., 0., 5.]]);
    let h = std::f32::consts::FRAC_1_SQRT_2;
    let turns: Vec<u8> = [[0., 0., 0., 1.], [0., h, 0., h], [0., 0., 0., 1.]]
        .iter()
        .flatten()
        .flat_map(|x: &f32| x.to_le_bytes())
        .collect();
    let turns = doc.accessor(&turns, 5126, "VEC4", 3);
    let scales = doc.positions(&[[1., 1., 1.], [1., 1., 1.], [-1., 1., 1.]]);
    let attributes = json!({"TRANSLATION": places, "ROTATION": turns, "SCALE": scales});
    doc.json["nodes"][1]["extensions"] = json!({"EXT_mesh_gpu_instancing": {"attributes": attributes}});
    doc.json["extensionsUsed"] = json!(["EXT_mesh_gpu_instancing"]);
    doc.json["extensionsRequired"] = json!(["EXT_mesh_gpu_instancing"]);
    let scene = parse_glb(&doc.glb(), None).unwrap().scene;
    let names: Vec<&str> = scene.objects().iter().map(|o| o.name.as_str()).collect();
    assert_eq!(names, ["tree[1]", "tree[2]", "tree[3]", "nest"]);
    // Instances have the node and the primitive in common, and come in their order.
    let nodes: Vec<u32> = scene.sources().iter().map(|source| source.unwrap().node).collect();
    assert!(nodes[..3] == [1; 3] && nodes[3] != 1, "{nodes:?}");
    let corners = |k: usize| scene.objects()[k].corners().next().unwrap();
    assert_eq!(corners(0), [[0., 100., 0.], [2., 100., 0.], [0., 102., 0.]]);
    // A quarter turn about y, five to the side, and all of it twice as large.
    assert_eq!(corners(1), [[10., 100., 0.], [10., 100., -2.], [10., 102., 0.]]);
    // A mirrored one keeps its front.
    assert_eq!(corners(2), [[0., 100., 10.], [0., 102., 10.], [-2., 100., 10.]]);
    assert_eq!(corners(3), corners(0));
    // What has instances and moves may be anywhere; it is not written again with fewer triangles.
    let mut moving = doc.clone();
    moving.json["nodes"][0]["extras"] = json!({"sightlines": {"moves": true}});
    let scene = parse_glb(&moving.glb(), None).unwrap().scene;
    assert!(scene.moving().len() == 4 && scene.moving().iter().all(|moving| moving.within.is_none()));
    let (_, source) = parse_glb_with_source(doc.glb(), None).unwrap();
    let error = source.rewrite(&vec![None; 4], None).unwrap_err().to_string();
    assert!(error.contains("nodes[1]") && error.contains("EXT_mesh_gpu_instancing"), "{error}");
    let backs = BackFaces::Drawn;
    let pattern = SceneReadOptions { see_through: vec!["tree".parse().unwrap()], backs, ..SceneReadOptions::default() };
    assert_eq!(parse_gltf_with(&doc.glb(), None, &pattern).unwrap().scene.see_through(), [0, 1, 2]);
}

/// A triangle with an index that is not there is left out and named, and the rest is as it was; without a rest the file is refused.
#[test]
fn triangles_of_corners_that_are_not_there_are_left_out() {
    let square = [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [1., 1., 0.]];
    let of = |indices: &[u32], mode: u32| {
        let mut doc = Doc::new(json!([{"name": "wall", "mesh": 0}, {"mesh": 0, "translation": [0, 0, 5]}]));
        let (positions, indices) = (doc.positions(&square), doc.indices(indices, 2));
        doc.mesh(json!([{"attributes": {"POSITION": positions}, "indices": indices, "mode": mode}]));
        parse_glb(&doc.glb(), None)
    };
    let (list, strip, fan) = (4, 5, 6);
    for (indices, mode, n_left_out, triangles) in [
        (&[0, 1, 2, 1, 2, 4, 2, 1, 3][..], list, "1 face: ", &[[0, 1, 2], [2, 1, 3]][..]),
        (&[9, 9, 9, 0, 1, 7, 2, 1, 3], list, "2 faces, the first of them: ", &[[2, 1, 3]]),
        (&[0, 1, 2, 3, 8], strip, "1 face: ", &[[0, 1, 2], [1, 3, 2]]),
        (&[0, 1, 3, 2, 8], fan, "1 face: ", &[[1, 3, 0], [3, 2, 0]]),
    ] {
        let file = of(indices, mode).unwrap();
        let k = indices.iter().position(|&index| index > 3).unwrap();
        let wrong = format!("index {k} is {}, but there are 4 positions", indices[k]);
        assert_eq!(file.info.n_triangles, 2 * triangles.len());
        assert_eq!(file.info.warnings.len(), 1);
        let warning = &file.info.warnings[0];
        assert!(warning.starts_with(&format!("left out {n_left_out}")) && warning.ends_with(&wrong), "{warning}");
        let found: Vec<_> = corners(&file, 0);
        let expected = triangles.iter().map(|t| t.map(|k| file.scene.objects()[0].vertices[k]));
        assert_eq!(found.len(), triangles.len());
        let sorted = |t: [[f64; 3]; 3]| {
            let mut t = t.map(|p| p.map(f64::to_bits));
            t.sort_unstable();
            t
        };
        assert_eq!(found.into_iter().map(sorted).collect::<Vec<_>>(), expected.map(sorted).collect::<Vec<_>>());
    }
    let error = of(&[0, 1, 4], list).unwrap_err().to_string();
    assert!(error.ends_with("index 2 is 4, but there are 4 positions"), "{error}");
}

/// The same of an OBJ: bad faces are left out, counted and named, wherever they stand; line ends are those of any system.
#[test]
fn bad_faces_of_an_obj_are_left_out() {
    let good = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\no wall\nf 1 2 3 4\no post\nf 1 2 3\n";
    let expected = parse_obj(good.as_bytes()).unwrap();
    assert_eq!(expected.info.warnings, [""; 0]);
    for end in ["\r\n", "\r"] {
        assert_eq!(parse_obj(good.replace('\n', end).as_bytes()).unwrap(), expected);
    }
    let bad = ["f 1 2", "f", "f 1 2 x", "f 1 2 /3", "f 1 2 9", "f 0 1 2", "f 1 2 -5"];
    for (k, bad) in bad.iter().enumerate() {
        // Before, between and behind the others, and once as an object that has nothing else.
        for (place, line) in [("o wall", 5), ("o post", 7), ("", 9)] {
            let text = if place.is_empty() {
                format!("{good}o bad\n{bad}")
            } else {
                good.replace(place, &format!("{bad}\n{place}"))
            };
            let line = if place.is_empty() { line + 1 } else { line };
            let file = parse_obj(text.as_bytes()).unwrap();
            assert_eq!(file.scene.objects(), expected.scene.objects(), "{k}: {text}");
            let [warning] = &file.info.warnings[..] else { panic!("{:?}", file.info.warnings) };
            assert!(warning.starts_with(&format!("left out 1 face: line {line}: ")), "{warning}");
        }
    }
    let all = parse_obj(format!("{good}{}", bad.join("\n")).as_bytes()).unwrap();
    let [warning] = &all.info.warnings[..] else { panic!("{:?}", all.info.warnings) };
    assert!(warning.starts_with("left out 7 faces, the first of them: line 9: a face needs"), "{warning}");
    assert_eq!(all.scene.objects(), expected.scene.objects());
}

/// A face whose outline crosses itself may be drawn in any way: whatever it may show is seen, and it hides nothing.
#[test]
fn faces_that_cross_themselves_are_seen_and_hide_nothing() {
    let good = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\no wall\nf 1 2 3 4\n";
    let read = |more: &str| parse_obj(format!("{good}{more}").as_bytes()).unwrap();
    let file = read("f 1 3 2 4\no bow\nf 3 1 2 4\n");
    let names: Vec<&str> = file.scene.objects().iter().map(|o| o.name.as_str()).collect();
    assert_eq!((names, file.scene.see_through()), (vec!["wall", "wall#see-through", "bow"], &[1, 2][..]));
    assert_eq!(file.scene.objects().iter().map(|o| o.triangles.len()).collect::<Vec<_>>(), [2, 4, 4]);
    assert_eq!(file.info.warnings, ["2 faces hide nothing: line 7: the outline of the face crosses itself"]);
    // The impostor: one that does not cross itself is a wall.
    let file = read("o bow\nf 1 2 3 4\n");
    assert!(file.scene.see_through().is_empty() && file.info.warnings.is_empty());
    // Too many corners for all of their triangles: what is drawn cannot be bounded, so nothing is left out in silence.
    let corners: String = (0..9).flat_map(|k| [format!("v {k} 0 0\n"), format!("v {k} 1 0\n")]).collect();
    let error =
        parse_obj(format!("{good}{corners}f {}", (5..23).map(|k| format!("{k} ")).collect::<String>()).as_bytes());
    assert_eq!(error.unwrap_err().to_string(), "line 25: the outline of the face crosses itself");
}
