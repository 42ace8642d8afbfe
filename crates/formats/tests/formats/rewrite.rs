//! Documents written again with fewer triangles: what was requested, corner by corner and attribute by attribute, as the
//! package `gltf` finds it, and all else as it was.

use crate::common::data_folder;
use crate::common::glb::{Doc, glb, rich_doc, small_doc};
use proptest::prelude::*;
use serde_json::{Value, json};
use sightlines_formats::SceneFile;
use sightlines_formats::scene::{
    GltfSource, RewriteError, Simplification, parse_glb, parse_glb_with_source, read_scene, read_scene_with_source,
    write_glb, write_simplified_glb,
};
use std::fs;
use std::path::Path;

type Changes = Vec<Option<Vec<[u32; 3]>>>;

fn with_source(doc: &Doc) -> (SceneFile, GltfSource) {
    parse_glb_with_source(doc.glb(), None).unwrap_or_else(|e| panic!("{e}"))
}

/// The text of a GLB.
fn text_of(glb: &[u8]) -> Value {
    let len = u32::from_le_bytes([glb[12], glb[13], glb[14], glb[15]]) as usize;
    serde_json::from_slice(&glb[20..20 + len]).unwrap()
}

/// The first objects of a scene that keep `keep` of their triangles; the others as they are.
fn every(file: &SceneFile, keep: impl Fn(usize) -> bool) -> Changes {
    let list = |o: &sightlines_cells::SceneObject| {
        Some(o.triangles.iter().enumerate().filter(|(k, _)| keep(*k)).map(|(_, t)| *t).collect())
    };
    file.scene.objects().iter().map(list).collect()
}

// --- What another reader finds -----------------------------------------------------------------------

/// Elements in a buffer.
struct Attribute<'a> {
    name: String,
    bytes: &'a [u8],
    stride: usize,
    size: usize,
    count: usize,
    sparse: bool,
}

impl Attribute<'_> {
    fn get(&self, k: usize) -> &[u8] {
        assert!(k < self.count && !self.sparse, "{}", self.name);
        &self.bytes[k * self.stride..][..self.size]
    }
}

/// A primitive of a node of the default scene.
struct Found<'a> {
    node: usize,
    material: Option<usize>,
    mode: gltf::mesh::Mode,
    corners: Vec<usize>,
    attributes: Vec<Attribute<'a>>,
}

impl Found<'_> {
    /// Corners of triangles, without regard to area.
    fn triangles(&self) -> Vec<[usize; 3]> {
        use gltf::mesh::Mode;
        let c = &self.corners;
        match self.mode {
            Mode::Triangles => c.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect(),
            Mode::TriangleStrip => {
                let turn = |(k, c): (usize, &[usize])| if k % 2 == 0 { [c[0], c[1], c[2]] } else { [c[0], c[2], c[1]] };
                c.windows(3).enumerate().map(turn).collect()
            }
            Mode::TriangleFan => c[1..].windows(2).map(|w| [w[0], w[1], c[0]]).collect(),
            _ => Vec::new(),
        }
    }
}

fn found(gltf: &gltf::Gltf) -> Vec<Found<'_>> {
    let mut all = Vec::new();
    let mut stack: Vec<_> = gltf.default_scene().unwrap().nodes().collect();
    stack.reverse();
    while let Some(node) = stack.pop() {
        for primitive in node.mesh().iter().flat_map(gltf::Mesh::primitives) {
            all.push(found_primitive(gltf, node.index(), &primitive));
        }
        let children: Vec<_> = node.children().collect();
        stack.extend(children.into_iter().rev());
    }
    all
}

fn found_primitive<'a>(gltf: &'a gltf::Gltf, node: usize, primitive: &gltf::Primitive<'a>) -> Found<'a> {
    let blob = gltf.blob.as_deref().unwrap();
    let attribute = |name: String, a: gltf::Accessor<'a>| match a.view() {
        Some(view) => {
            // Vertices lie at multiples of four.
            let (stride, start) = (view.stride().unwrap_or(a.size()), view.offset() + a.offset());
            assert!(stride.is_multiple_of(4) && start.is_multiple_of(4), "{name}");
            let bytes = &blob[view.offset()..view.offset() + view.length()][a.offset()..];
            let (stride, sparse) = (view.stride().unwrap_or(a.size()), a.sparse().is_some());
            Attribute { name, bytes, stride, size: a.size(), count: a.count(), sparse }
        }
        None => Attribute { name, bytes: &[], stride: 0, size: 0, count: 0, sparse: true },
    };
    let mut attributes: Vec<_> = primitive.attributes().map(|(s, a)| attribute(s.to_string(), a)).collect();
    for (k, target) in primitive.morph_targets().enumerate() {
        attributes.extend(target.positions().map(|a| attribute(format!("target {k}"), a)));
    }
    let reader = primitive.reader(|_| Some(blob));
    let n = reader.read_positions().unwrap().len();
    let corners = match reader.read_indices() {
        Some(indices) => indices.into_u32().map(|i| i as usize).collect(),
        None => (0..n).collect(),
    };
    Found { node, material: primitive.material().index(), mode: primitive.mode(), corners, attributes }
}

/// The same GLB for a reader that takes extras of some forms only.
fn without_extras(bytes: &[u8]) -> Vec<u8> {
    fn strip(value: &mut Value) {
        match value {
            Value::Array(list) => list.iter_mut().for_each(strip),
            Value::Object(object) => {
                object.remove("extras");
                object.values_mut().for_each(strip);
            }
            _ => {}
        }
    }
    let mut text = text_of(bytes);
    strip(&mut text);
    let start = 20 + u32::from_le_bytes([bytes[12], bytes[13], bytes[14], bytes[15]]) as usize;
    glb(&text.to_string(), bytes.get(start + 8..).unwrap_or_default())
}

/// Where a document written again is not what was requested, if anywhere.
fn difference(before: &[u8], source: &GltfSource, changes: &Changes, after: &[u8]) -> Option<String> {
    let parse = |bytes| gltf::Gltf::from_slice(&without_extras(bytes)).unwrap_or_else(|e| panic!("{e}"));
    let [before, after] = [before, after].map(parse);
    let (old, new) = (found(&before), found(&after));
    let mut new = new.iter();
    for (k, (o, change)) in old.iter().zip(changes).enumerate() {
        let of = source.object(k).unwrap();
        if of.node != o.node {
            return Some(format!("object {k} is of node {}, not {}", of.node, o.node));
        }
        let is_area = o.mode as u32 >= gltf::mesh::Mode::Triangles as u32;
        let expected: Vec<[usize; 3]> = match change {
            None => o.triangles(),
            Some(list) if list.is_empty() && is_area => continue,
            Some(list) => {
                let corner = |v: u32| of.corners[v as usize];
                let turned = |[a, b, c]: [u32; 3]| if of.is_mirrored { [a, c, b] } else { [a, b, c] };
                list.iter().map(|&t| turned(t).map(corner)).collect()
            }
        };
        let Some(n) = new.next() else { return Some(format!("object {k} is gone")) };
        if (o.node, o.material, o.attributes.len()) != (n.node, n.material, n.attributes.len()) {
            return Some(format!("object {k}: another node, another material or other attributes"));
        }
        let triangles = n.triangles();
        if triangles.len() != expected.len() {
            return Some(format!("object {k}: {} triangles, not {}", triangles.len(), expected.len()));
        }
        let pairs = expected.iter().flatten().zip(triangles.iter().flatten());
        let lines = if is_area || !expected.is_empty() { &[][..] } else { &o.corners[..] };
        for (&a, &b) in pairs.chain(lines.iter().zip(&n.corners)) {
            for attribute in &o.attributes {
                let Some(other) = n.attributes.iter().find(|other| other.name == attribute.name) else {
                    return Some(format!("object {k}: no {}", attribute.name));
                };
                if attribute.get(a) != other.get(b) {
                    return Some(format!("object {k}: {} of corner {a} is not that of {b}", attribute.name));
                }
            }
        }
    }
    new.next().map(|n| format!("a primitive too much at node {}", n.node))
}

/// All of a document but data and meshes, of which nodes may name others.
fn rest(mut text: Value) -> Value {
    let root = text.as_object_mut().unwrap();
    for key in ["accessors", "bufferViews", "buffers", "meshes", "animations", "images", "extensionsUsed"] {
        root.remove(key);
    }
    for node in root["nodes"].as_array_mut().unwrap() {
        node.as_object_mut().unwrap().remove("mesh");
    }
    text
}

fn same_scene(a: &SceneFile, b: &SceneFile) -> Result<(), String> {
    let bits = |file: &SceneFile| -> Vec<_> {
        let objects = file.scene.objects().iter();
        objects
            .map(|o| (o.name.clone(), o.corners().map(|t| t.map(|p| p.map(f64::to_bits))).collect::<Vec<_>>()))
            .collect()
    };
    if bits(a) == bits(b) && a.scene.mirrors() == b.scene.mirrors() { Ok(()) } else { Err("other scenes".to_owned()) }
}

// --- Random documents ---------------------------------------------------------------------------------

/// A document of up to five nodes with one of three meshes of the kind that `rich_doc` has.
fn documents() -> impl Strategy<Value = Doc> {
    let mesh_of = prop::option::weighted(0.8, 0..3usize);
    let node = (mesh_of, any::<bool>(), any::<bool>());
    let indices = prop::collection::vec(0..9u32, 3..12);
    let primitive = (indices, prop::sample::select(vec![1, 4, 4, 4, 5, 6]), 0..2u32, any::<bool>());
    let meshes = prop::collection::vec(prop::collection::vec(primitive, 1..4), 3);
    (prop::collection::vec(node, 1..6), meshes).prop_map(|(nodes, meshes)| {
        let mut doc = rich_doc();
        let attributes = [0, 2].map(|_| doc.json["meshes"][0]["primitives"][0]["attributes"].clone());
        doc.json["meshes"] = json!([]);
        let own = doc.positions(&[[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.], [2., 0., 0.], [0., 2., 0.], [3., 1., 1.], [1., 3., 1.], [1., 1., 3.]]);
        for primitives in meshes {
            let mut list = Vec::new();
            for (mut indices, mode, material, alone) in primitives {
                if mode == 4 {
                    indices.truncate(indices.len() / 3 * 3);
                }
                let mut attributes = attributes[0].clone();
                if alone {
                    attributes["POSITION"] = json!(own);
                }
                let indices = doc.indices(&indices, 2);
                list.push(json!({"attributes": attributes, "indices": indices, "mode": mode, "material": material}));
            }
            doc.mesh(json!(list));
        }
        let node = |(k, (mesh, mirrored, child)): (usize, (Option<usize>, bool, bool))| {
            let mut node = json!({"name": format!("n{k}"), "scale": [1, if mirrored { -1 } else { 1 }, 1], "translation": [0.1, k, 0]});
            if let Some(mesh) = mesh {
                node["mesh"] = json!(mesh);
            }
            (node, child && k > 0)
        };
        let nodes: Vec<(Value, bool)> = nodes.into_iter().enumerate().map(node).collect();
        let children: Vec<usize> = (0..nodes.len()).filter(|&k| nodes[k].1).collect();
        let roots: Vec<usize> = (0..nodes.len()).filter(|&k| !nodes[k].1).collect();
        let mut list: Vec<Value> = nodes.into_iter().map(|(node, _)| node).collect();
        if !children.is_empty() {
            list[0]["children"] = json!(children);
        }
        // A node of another scene keeps its mesh.
        list.push(json!({"mesh": 2}));
        doc.json["scenes"] = json!([{"nodes": roots}, {"nodes": [list.len() - 1]}]);
        doc.json["nodes"] = json!(list);
        doc.json.as_object_mut().unwrap().remove("animations");
        doc
    })
}

/// For each object nothing, or triangles of its vertices: some of its own, or any.
fn change(o: &sightlines_cells::SceneObject, seed: u64) -> Option<Vec<[u32; 3]>> {
    let n = o.vertices.len() as u64;
    match seed % 5 {
        0 => None,
        1 => Some(Vec::new()),
        2 if n > 2 => Some(
            (0..seed / 5 % 4)
                .map(|k| [seed / 20 + k, seed / 160 + 2 * k, seed / 1280].map(|v| (v % n) as u32))
                .collect(),
        ),
        _ => Some(
            o.triangles.iter().enumerate().filter(|(k, _)| seed >> (k % 32 + 3) & 1 == 0).map(|(_, t)| *t).collect(),
        ),
    }
}

proptest! {
    /// Invariant: the requested triangles, in their order, with all attributes; everything else in the document stays;
    /// and the same again gives the same bytes.
    #[test]
    fn documents_get_the_triangles_that_they_should_have(
        doc in documents(),
        seeds in prop::collection::vec(any::<u32>(), 16),
    ) {
        let Ok((file, source)) = parse_glb_with_source(doc.glb(), None) else { return Ok(()) };
        let objects = file.scene.objects().iter();
        let changes: Changes = objects.zip(seeds.iter().cycle()).map(|(o, &seed)| change(o, seed.into())).collect();
        let after = source.rewrite(&changes, None).unwrap();
        prop_assert_eq!(difference(&doc.glb(), &source, &changes, &after), None);
        prop_assert_eq!(rest(text_of(&after)), rest(doc.json.clone()));
        prop_assert_eq!(&source.rewrite(&changes, None).unwrap(), &after);

        // Our own reader finds the same, bit by bit.
        let mut expected = Vec::new();
        for (o, change) in file.scene.objects().iter().zip(&changes) {
            let corner = |t: &[u32; 3]| t.map(|v| o.vertices[v as usize].map(f64::to_bits));
            let list = change.as_ref().unwrap_or(&o.triangles);
            // Those without area are not read.
            expected.extend(list.iter().filter(|t| !is_flat(t.map(|v| o.vertices[v as usize]))).map(corner));
        }
        match parse_glb(&after, None) {
            Ok(again) => {
                let corners = again.scene.objects().iter().flat_map(|o| o.corners());
                let found: Vec<_> = corners.map(|t| t.map(|p| p.map(f64::to_bits))).collect();
                prop_assert_eq!(found, expected);
            }
            Err(error) => prop_assert!(expected.is_empty(), "{}", error),
        }
    }

    /// Invariant: nothing changed, nothing is read otherwise; nor if all triangles are listed.
    #[test]
    fn documents_without_changes_stay(doc in documents()) {
        let Ok((file, source)) = parse_glb_with_source(doc.glb(), None) else { return Ok(()) };
        let after = source.rewrite(&vec![None; source.n_objects()], None).unwrap();
        prop_assert_eq!(parse_glb(&after, None).unwrap(), file);
        // Meshes stay what they were.
        prop_assert_eq!(text_of(&after)["meshes"].as_array().unwrap().len(), 3);
    }

    /// Invariant: the node and primitive of an object in its scene are those by which the file is written again.
    #[test]
    fn objects_are_where_they_come_from(doc in documents()) {
        let Ok((file, source)) = parse_glb_with_source(doc.glb(), None) else { return Ok(()) };
        prop_assert_eq!(file.scene.sources().len(), source.n_objects());
        for (k, found) in file.scene.sources().iter().enumerate() {
            let origin = source.object(k).unwrap();
            let found = found.map(|found| (found.node as usize, found.primitive as usize));
            prop_assert_eq!(found, Some((origin.node, origin.primitive)));
        }
    }
}

/// Whether three corners lie on a line: by the area of the shadows on three planes, exact for the coordinates here as
/// long as the reader's own answer is not asked for.
fn is_flat([a, b, c]: [[f64; 3]; 3]) -> bool {
    let doc = {
        // A scene of the triangle alone is read, or has nothing to read.
        let object =
            sightlines_cells::SceneObject { name: String::new(), vertices: vec![a, b, c], triangles: vec![[0, 1, 2]] };
        let scene = sightlines_cells::Scene::new(vec![object]).unwrap();
        let text: String =
            scene.objects()[0].vertices.iter().map(|p| format!("v {:?} {:?} {:?}\n", p[0], p[1], p[2])).collect();
        format!("{text}f 1 2 3\n")
    };
    sightlines_formats::scene::parse_obj(doc.as_bytes()).is_err()
}

// --- One defect each ----------------------------------------------------------------------------------

#[test]
fn objects_know_where_they_come_from() {
    let (file, source) = with_source(&rich_doc());
    let of = |k| source.object(k).map(|o| (o.node, o.mesh, o.primitive, o.corners.to_vec(), o.is_mirrored));
    assert_eq!(source.n_objects(), 6);
    assert_eq!(of(0), Some((1, 0, 0, vec![0, 1, 2, 3, 4], true)));
    assert_eq!(of(1), Some((1, 0, 1, vec![3, 4, 5, 6, 7, 8], true)));
    assert_eq!(of(2), Some((2, 0, 0, vec![0, 1, 2, 3, 4], false)));
    assert_eq!(of(5), Some((3, 1, 1, vec![0, 3], false)));
    assert_eq!(of(6), None);
    assert_eq!(file.scene.objects()[5].name, "below#1");
}

#[test]
fn all_that_has_nothing_to_do_with_triangles_stays() {
    let doc = rich_doc();
    let (file, source) = with_source(&doc);
    let changes = every(&file, |k| k % 2 == 0);
    let after = source.rewrite(&changes, None).unwrap();
    assert_eq!(difference(&doc.glb(), &source, &changes, &after), None);
    let text = text_of(&after);
    assert_eq!(rest(text.clone()), rest(doc.json.clone()));
    assert_eq!(text["extensionsUsed"], doc.json["extensionsUsed"]);
    assert_eq!(text["animations"][0]["channels"], doc.json["animations"][0]["channels"]);
    assert_eq!(text["images"][1], json!({"uri": "nowhere.png"}));
    // Two nodes want the same, so they still share their mesh, its name and its extras.
    assert_eq!((&text["nodes"][1]["mesh"], &text["nodes"][2]["mesh"]), (&json!(0), &json!(0)));
    assert_eq!((&text["meshes"][0]["name"], &text["meshes"][0]["extras"]), (&json!("grid"), &json!([1, 2])));
    assert_eq!(text["meshes"].as_array().unwrap().len(), 3);
    let primitive = &text["meshes"][0]["primitives"][0];
    assert_eq!((&primitive["extras"], &primitive["material"]), (&json!("x"), &json!(1)));
    let positions = &text["accessors"][primitive["attributes"]["POSITION"].as_u64().unwrap() as usize];
    assert_eq!(
        (&positions["name"], &positions["count"], &positions["max"]),
        (&json!("places"), &json!(5), &json!([2., 1., 2.]))
    );
    // The picture is where its view says.
    let view = &text["bufferViews"][text["images"][0]["bufferView"].as_u64().unwrap() as usize];
    let start = after.len() - text["buffers"][0]["byteLength"].as_u64().unwrap().next_multiple_of(4) as usize;
    let at = start + view["byteOffset"].as_u64().unwrap() as usize;
    assert_eq!(&after[at..at + 14], b"\x89PNG and so on");
}

#[test]
fn impostors_are_found_out() {
    let doc = rich_doc();
    let (file, source) = with_source(&doc);
    let changes = every(&file, |k| k != 1);
    let after = source.rewrite(&changes, None).unwrap();
    let other = every(&file, |k| k != 0);
    assert!(difference(&doc.glb(), &source, &other, &after).is_some());
    let other = every(&file, |_| true);
    assert!(difference(&doc.glb(), &source, &other, &after).is_some());
    // One bit of one attribute.
    let text = text_of(&after);
    let normal = text["meshes"][0]["primitives"][0]["attributes"]["NORMAL"].as_u64().unwrap() as usize;
    let view = text["accessors"][normal]["bufferView"].as_u64().unwrap() as usize;
    let start = after.len() - text["buffers"][0]["byteLength"].as_u64().unwrap().next_multiple_of(4) as usize;
    let mut spoilt = after.clone();
    spoilt[start + text["bufferViews"][view]["byteOffset"].as_u64().unwrap() as usize] ^= 1;
    assert!(difference(&doc.glb(), &source, &changes, &spoilt).unwrap().contains("NORMAL"));
}

#[test]
fn meshes_part_and_go() {
    let doc = rich_doc();
    let (file, source) = with_source(&doc);
    let mut changes: Changes = vec![None; 6];
    // The left grid loses its first primitive, the right one all; what is below loses its triangles and keeps its line.
    changes[0] = Some(Vec::new());
    (changes[2], changes[3]) = (Some(Vec::new()), Some(Vec::new()));
    (changes[4], changes[5]) = (Some(Vec::new()), Some(Vec::new()));
    let after = source.rewrite(&changes, None).unwrap();
    assert_eq!(difference(&doc.glb(), &source, &changes, &after), None);
    let text = text_of(&after);
    assert_eq!(text["meshes"][0]["primitives"].as_array().unwrap().len(), 1);
    assert_eq!(text["nodes"][2], json!({"name": "right", "translation": [5, 0, 0], "children": [3]}));
    assert_eq!(text["meshes"][1]["primitives"][0]["mode"], json!(1));
    // What only the triangles needed is gone.
    let n_bytes = |text: &Value| text["buffers"][0]["byteLength"].as_u64();
    assert!(n_bytes(&text) < n_bytes(&doc.json));
    // Now the left one keeps two primitives, the right one only a triangle of the second: two meshes.
    let mut changes: Changes = vec![None; 6];
    (changes[2], changes[3]) = (Some(Vec::new()), Some(vec![file.scene.objects()[3].triangles[1]]));
    let after = source.rewrite(&changes, None).unwrap();
    assert_eq!(difference(&doc.glb(), &source, &changes, &after), None);
    let text = text_of(&after);
    assert_eq!([&text["nodes"][1]["mesh"], &text["nodes"][2]["mesh"]], [&json!(0), &json!(3)]);
    assert_eq!((&text["meshes"][3]["name"], text["meshes"][3]["primitives"][0].get("mode")), (&json!("grid"), None));
    // A mesh that no node has any more goes, the others move up, and what moved its targets goes too.
    let mut changes: Changes = vec![Some(Vec::new()); 4];
    changes.extend([None, None]);
    let after = source.rewrite(&changes, None).unwrap();
    assert_eq!(difference(&doc.glb(), &source, &changes, &after), None);
    let text = text_of(&after);
    assert_eq!(text["meshes"].as_array().unwrap().len(), 2);
    assert_eq!([&text["nodes"][3]["mesh"], &text["nodes"][4]["mesh"]], [&json!(0), &json!(1)]);
    assert_eq!(text["animations"][0]["channels"].as_array().unwrap().len(), 1);
}

#[test]
fn sparse_and_quantised_vertices_are_copied() {
    let doc = small_doc();
    let (file, source) = with_source(&doc);
    let changes = every(&file, |k| k == 0);
    let after = source.rewrite(&changes, None).unwrap();
    let again = parse_glb(&after, None).unwrap();
    let first = |file: &SceneFile| -> Vec<_> { file.scene.objects().iter().map(|o| o.corners().next()).collect() };
    assert_eq!(first(&again), first(&file));
    assert_eq!(again.info.n_triangles, file.scene.objects().len());
    let text = text_of(&after);
    let list = text["accessors"].as_array().unwrap();
    assert!(list.iter().all(|a| a.get("sparse").is_none()));
    let quantised = list.iter().find(|a| a["componentType"] == 5122).unwrap();
    assert_eq!((&quantised["normalized"], &quantised["max"]), (&json!(true), &json!([32767, 32767, 16384])));
}

#[test]
fn extensions_are_kept_or_refused() {
    // An unknown one may name accessors in any way: everything stays in its place.
    let mut doc = rich_doc();
    doc.json["extensions"]["ACME_things"] = json!({"thing": [3, 1], "bufferView": 2});
    let (file, source) = with_source(&doc);
    let changes = every(&file, |k| k == 0);
    let after = source.rewrite(&changes, None).unwrap();
    assert_eq!(difference(&doc.glb(), &source, &changes, &after), None);
    let text = text_of(&after);
    assert_eq!(text["extensions"], doc.json["extensions"]);
    let [old, new] = [&doc.json, &text].map(|t| t["accessors"].as_array().unwrap());
    assert_eq!(new[..old.len()], old[..]);
    // Buffers are put together, so that what speaks of buffers cannot be kept.
    doc.json["extensions"]["ACME_things"]["buffer"] = json!(0);
    let error = with_source(&doc).1.rewrite(&changes, None).unwrap_err();
    assert_eq!(
        error.to_string(),
        "extensions: extension ACME_things is not understood, and may depend on what is to be changed"
    );

    // Metadata of the triangles that are to change.
    let mut doc = rich_doc();
    doc.json["meshes"][0]["primitives"][0]["extensions"] = json!({"ACME_edges": {"indices": 3}});
    let source = with_source(&doc).1;
    let error = source.rewrite(&changes, None).unwrap_err();
    assert!(
        matches!(&error, RewriteError::Extension { place, name } if place == "meshes[0].primitives[0]" && name == "ACME_edges")
    );
    assert!(source.rewrite(&vec![None; 6], None).is_ok());

    // A second coding of the same triangles goes with them; a choice of materials stays.
    let mut doc = rich_doc();
    doc.json["extensionsUsed"] = json!(["KHR_draco_mesh_compression", "KHR_materials_variants"]);
    doc.json["meshes"][0]["primitives"][0]["extensions"] = json!({"KHR_draco_mesh_compression": {"bufferView": 4, "attributes": {}}, "KHR_materials_variants": {"mappings": []}});
    let source = with_source(&doc).1;
    let text = text_of(&source.rewrite(&changes, None).unwrap());
    assert_eq!(text["meshes"][0]["primitives"][0]["extensions"], json!({"KHR_materials_variants": {"mappings": []}}));
    assert_eq!(text["extensionsUsed"], json!(["KHR_materials_variants"]));
    let text = text_of(&source.rewrite(&vec![None; 6], None).unwrap());
    assert_eq!(text["extensionsUsed"].as_array().unwrap().len(), 2);
}

#[test]
fn outside_buffers_and_pictures_are_taken_along() {
    let folder = tempfile::tempdir().unwrap();
    let mut doc = rich_doc();
    fs::write(folder.path().join("data.bin"), &doc.binary).unwrap();
    fs::write(folder.path().join("a b.jpg"), b"\xFF\xD8\xFFjpeg").unwrap();
    fs::write(folder.path().join("notes.txt"), b"no picture").unwrap();
    doc.json["buffers"][0]["uri"] = json!("data.bin");
    doc.json["images"] =
        json!([{"uri": "a%20b.jpg", "name": "x"}, {"uri": "notes.txt"}, {"uri": "a%20b.jpg"}, {"uri": "../x.png"}]);
    let path = folder.path().join("scene.gltf");
    fs::write(&path, doc.text()).unwrap();
    let (file, source) = read_scene_with_source(&path).unwrap();
    let source = source.unwrap();
    // What was read once is not read again.
    fs::remove_file(folder.path().join("data.bin")).unwrap();
    let after = source.rewrite(&vec![None; 6], None).unwrap();
    assert_eq!(parse_glb(&after, None).unwrap(), file);
    let text = text_of(&after);
    let view = text["images"][0]["bufferView"].as_u64().unwrap();
    assert_eq!(text["images"][0], json!({"name": "x", "bufferView": view, "mimeType": "image/jpeg"}));
    assert_eq!(text["images"][2]["bufferView"], json!(view));
    assert_eq!([&text["images"][1]["uri"], &text["images"][3]["uri"]], ["notes.txt", "../x.png"]);
    assert_eq!(text["bufferViews"][view as usize]["byteLength"], 7);
}

#[test]
fn simplified_scenes_say_so() {
    let (file, source) = with_source(&rich_doc());
    assert_eq!(file.info.simplified, None);
    let unchanged = vec![None; 6];
    let says = |bytes: &[u8]| parse_glb(bytes, None).unwrap().info.simplified.map(|s| s.occluder);
    let of = |occluder| source.rewrite(&unchanged, Some(Simplification { occluder })).unwrap();
    assert_eq!([says(&of(true)), says(&of(false))], [Some(true), Some(false)]);
    assert_eq!(
        text_of(&of(true))["asset"]["extras"],
        json!({"by": ["hand"], "sightlines": {"simplified": {"occluder": true}}})
    );
    // What was moved once stays moved.
    let again = parse_glb_with_source(of(false), None).unwrap().1;
    assert_eq!(says(&again.rewrite(&unchanged, Some(Simplification { occluder: true })).unwrap()), Some(false));
    assert_eq!(says(&again.rewrite(&unchanged, None).unwrap()), Some(false));
    let mut doc = Doc::new(json!([{"mesh": 0}]));
    doc.triangle();
    let scene = parse_glb(&doc.glb(), None).unwrap().scene;
    assert_eq!(says(&write_simplified_glb(&scene, Simplification { occluder: false }).unwrap()), Some(false));
    assert_eq!(says(&write_glb(&scene).unwrap()), None);
    // Extras of another form are not lost.
    let mut doc = rich_doc();
    doc.json["asset"]["extras"] = json!(["a", 1]);
    let text = text_of(&with_source(&doc).1.rewrite(&unchanged, Some(Simplification { occluder: true })).unwrap());
    assert_eq!(text["asset"]["extras"]["was"], json!(["a", 1]));
}

#[test]
fn what_does_not_fit_is_refused() {
    let doc = rich_doc();
    let (_, source) = with_source(&doc);
    let says = |changes: Changes, text: &str| assert_eq!(source.rewrite(&changes, None).unwrap_err().to_string(), text);
    says(vec![None; 5], "triangles of 5 objects for a scene of 6");
    let mut changes: Changes = vec![None; 6];
    changes[4] = Some(vec![[0, 1, 2], [0, 4, 1]]);
    says(changes, "object 4, triangle 1: there is no vertex 4");
    let refused = |spoil: fn(&mut Doc), text: &str| {
        let mut doc = rich_doc();
        spoil(&mut doc);
        let (file, source) = with_source(&doc);
        assert_eq!(source.rewrite(&every(&file, |k| k == 0), None).unwrap_err().to_string(), text);
    };
    refused(|d| d.json["accessors"][1]["count"] = json!(3), "accessor 1: there is no element 3 of 3");
    refused(
        |d| d.json["accessors"][1]["type"] = json!("VEC7"),
        "accessor 1: elements of type \"VEC7\" with components 5126 cannot be that",
    );
    refused(
        |d| d.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = json!("x"),
        "meshes[0].primitives[0]: NORMAL is not an index",
    );
    refused(
        |d| d.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = json!(99),
        "accessor 99: it does not exist",
    );
    refused(|d| d.json["images"][0]["bufferView"] = json!(99), "buffer view 99: there is no buffer view 99");
    refused(|d| d.json["skins"] = json!(3), "skins is not a list");
}

#[test]
fn real_scenes_are_written_again() {
    let Some(data) = data_folder("SIGHTLINES_DATA", "real_scenes_are_written_again") else { return };
    let mut n_scenes = 0;
    for name in ["sponza", "castle", "duplex", "pandora"] {
        let path = data.join("scenes").join(name).join(format!("{name}.glb"));
        real(&path).unwrap_or_else(|e| panic!("{name}: {e}"));
        n_scenes += 1;
    }
    assert_eq!(n_scenes, 4);
}

fn real(path: &Path) -> Result<(), String> {
    let bytes = fs::read(path).unwrap();
    let (file, source) = read_scene_with_source(path).unwrap();
    let source = source.ok_or("no source")?;
    assert_eq!(read_scene(path).unwrap(), file);
    let unchanged = source.rewrite(&vec![None; source.n_objects()], None).unwrap();
    let again = parse_glb(&unchanged, None).unwrap();
    same_scene(&again, &file)?;
    assert_eq!(again, file);
    // What nothing refers to does not come along, and little else is new.
    assert!(unchanged.len() < bytes.len() + bytes.len() / 20 + 4096, "{} after {}", unchanged.len(), bytes.len());
    let changes = every(&file, |k| k % 2 == 1);
    let after = source.rewrite(&changes, Some(Simplification { occluder: true })).unwrap();
    eprintln!(
        "{}: {} bytes, {} unchanged, {} with half the triangles",
        path.display(),
        bytes.len(),
        unchanged.len(),
        after.len()
    );
    match difference(&bytes, &source, &changes, &after) {
        Some(difference) => return Err(difference),
        None => assert_eq!(
            parse_glb(&after, None).unwrap().info.n_triangles,
            changes.iter().flatten().map(Vec::len).sum::<usize>()
        ),
    }
    assert_eq!(rest(text_of(&unchanged)), rest(text_of(&bytes)));
    Ok(())
}
