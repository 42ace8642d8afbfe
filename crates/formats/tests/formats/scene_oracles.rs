//! Scenes in space against other readers of the same formats (`gltf` and `tobj`), and real scenes against
//! what is known of them.

use crate::common::data_folder;
use crate::common::glb::{Doc, small_doc};
use proptest::prelude::*;
use serde_json::{Value, json};
use sightlines_cells::Scene;
use sightlines_formats::SceneFile;
use sightlines_formats::scene::{parse_glb, parse_obj, read_scene, write_glb};
use std::fs;

type Triangle = [[f64; 3]; 3];

/// What two readers have to agree on: names and triangles of objects.
type Summary = Vec<(String, Vec<Triangle>)>;

fn summary(scene: &Scene) -> Summary {
    scene.objects().iter().map(|o| (o.name.clone(), o.corners().collect())).collect()
}

/// Where two summaries differ first, beyond `slack` in a coordinate.
fn difference(a: &Summary, b: &Summary, slack: f64) -> Option<String> {
    if a.len() != b.len() {
        return Some(format!("{} and {} objects", a.len(), b.len()));
    }
    let near =
        |s: &Triangle, t: &Triangle| s.iter().flatten().zip(t.iter().flatten()).all(|(x, y)| (x - y).abs() <= slack);
    a.iter().zip(b).enumerate().find_map(|(k, ((name, s), (other, t)))| {
        let same = name == other && s.len() == t.len() && s.iter().zip(t).all(|(s, t)| near(s, t));
        (!same).then(|| format!("object {k}: {name:?} {s:?}, {other:?} {t:?}"))
    })
}

fn has_area([a, b, c]: &Triangle) -> bool {
    // Exact for the small whole numbers of the tests.
    let (u, v) = ([0, 1, 2].map(|k| b[k] - a[k]), [0, 1, 2].map(|k| c[k] - a[k]));
    (0..3).any(|k| u[(k + 1) % 3] * v[(k + 2) % 3] != u[(k + 2) % 3] * v[(k + 1) % 3])
}

// --- glTF against `gltf` ---------------------------------------------------------------------------

type Matrix = [[f32; 4]; 4];

/// Columns of `a` after `b`.
fn product(a: &Matrix, b: &Matrix) -> Matrix {
    b.map(|column| [0, 1, 2, 3].map(|r| (0..4).map(|k| a[k][r] * column[k]).sum()))
}

/// What the package `gltf` makes of a GLB, in single precision; recursive where the reader is not.
fn by_gltf(bytes: &[u8]) -> Summary {
    let gltf = gltf::Gltf::from_slice(bytes).unwrap_or_else(|e| panic!("{e}"));
    let identity = [0, 1, 2, 3].map(|c| [0, 1, 2, 3].map(|r| f32::from(u8::from(c == r))));
    let mut objects = Vec::new();
    for node in gltf.default_scene().unwrap().nodes() {
        visit(&node, &identity, gltf.blob.as_deref().unwrap(), &mut objects);
    }
    objects
}

fn visit(node: &gltf::Node<'_>, parent: &Matrix, blob: &[u8], objects: &mut Summary) {
    let world = product(parent, &node.transform().matrix());
    for primitive in node.mesh().iter().flat_map(gltf::Mesh::primitives) {
        let name = node.name().map_or_else(|| format!("node {}", node.index()), str::to_owned);
        let name = if primitive.index() == 0 { name } else { format!("{name}#{}", primitive.index()) };
        let reader = primitive.reader(|_| Some(blob));
        let put = |[x, y, z]: [f32; 3]| {
            [0, 1, 2].map(|r| f64::from(world[0][r] * x + world[1][r] * y + world[2][r] * z + world[3][r]))
        };
        let positions: Vec<[f64; 3]> = reader.read_positions().unwrap().map(put).collect();
        let corners: Vec<u32> = match reader.read_indices() {
            Some(indices) => indices.into_u32().collect(),
            None => (0..positions.len() as u32).collect(),
        };
        let w = world;
        let determinant = w[0][0] * (w[1][1] * w[2][2] - w[2][1] * w[1][2])
            - w[1][0] * (w[0][1] * w[2][2] - w[2][1] * w[0][2])
            + w[2][0] * (w[0][1] * w[1][2] - w[1][1] * w[0][2]);
        let triangles = assemble(primitive.mode(), &corners).into_iter().map(|[a, b, c]| {
            let [a, b, c] = [a, b, c].map(|i| positions[i as usize]);
            if determinant < 0.0 { [a, c, b] } else { [a, b, c] }
        });
        objects.push((name, triangles.filter(has_area).collect()));
    }
    for child in node.children() {
        visit(&child, &world, blob, objects);
    }
}

fn assemble(mode: gltf::mesh::Mode, corners: &[u32]) -> Vec<[u32; 3]> {
    use gltf::mesh::Mode;
    match mode {
        Mode::Triangles => corners.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect(),
        Mode::TriangleStrip => {
            let turn = |(k, c): (usize, &[u32])| if k % 2 == 0 { [c[0], c[1], c[2]] } else { [c[0], c[2], c[1]] };
            corners.windows(3).enumerate().map(turn).collect()
        }
        Mode::TriangleFan => corners[1..].windows(2).map(|c| [c[0], c[1], corners[0]]).collect(),
        _ => Vec::new(),
    }
}

/// A node that comes after its parent, with a transform of small whole numbers.
fn nodes() -> impl Strategy<Value = Vec<Value>> {
    let whole = |range: std::ops::Range<i32>| prop::array::uniform3(range);
    let rotation =
        prop::sample::select(vec![[0., 0., 0., 1.], [0., 1., 0., 0.], [0.5, 0.5, 0.5, 0.5], [0.5, -0.5, 0.5, 0.5]]);
    let parts = (whole(-3..4), rotation, whole(-2..3))
        .prop_map(|(t, r, s)| json!({"translation": t, "rotation": r, "scale": s}));
    let matrix = prop::collection::vec(-2..3i32, 12).prop_map(
        |m| json!({"matrix": [m[0], m[1], m[2], 0, m[3], m[4], m[5], 0, m[6], m[7], m[8], 0, m[9], m[10], m[11], 1]}),
    );
    let transform = prop_oneof![Just(json!({})), parts, matrix];
    let node =
        (transform, prop::option::of(0..2usize), prop::option::of("[a-z]{0,3}"), any::<prop::sample::Index>(), 0..4u8);
    prop::collection::vec(node, 1..7).prop_map(|list| {
        let mut children: Vec<Vec<usize>> = vec![Vec::new(); list.len()];
        for (k, (.., parent, is_root)) in list.iter().enumerate().skip(1) {
            if *is_root > 0 {
                // In front, so that order in the document and order among children differ.
                children[parent.index(k)].insert(0, k);
            }
        }
        let nodes = list.into_iter().zip(children).map(|((mut node, mesh, name, ..), children)| {
            let more = [("mesh", json!(mesh)), ("name", json!(name)), ("children", json!(children))];
            for (key, value) in more.into_iter().filter(|(_, v)| !v.is_null() && *v != json!([])) {
                node[key] = value;
            }
            node
        });
        nodes.collect()
    })
}

/// A primitive: its positions, its indices with their size, its mode.
type Primitive = (Vec<[i8; 3]>, Option<(Vec<u32>, usize)>, u32);

fn primitive() -> impl Strategy<Value = Primitive> {
    let positions = prop::collection::vec(prop::array::uniform3(-2..3i8), 3..7);
    let indices = prop::option::of((prop::collection::vec(any::<u32>(), 3..12), prop::sample::select(vec![1, 2, 4])));
    (positions, indices, 0..7u32).prop_map(|(mut positions, indices, mode)| {
        let n = positions.len() as u32;
        let mut indices = indices.map(|(list, size)| (list.into_iter().map(|i| i % n).collect::<Vec<_>>(), size));
        if mode == 4 {
            // A list of triangles has no rest.
            positions.truncate(positions.len() / 3 * 3);
            let n = positions.len() as u32;
            if let Some((list, _)) = &mut indices {
                list.truncate(list.len() / 3 * 3);
                list.iter_mut().for_each(|i| *i %= n);
            }
        }
        (positions, indices, mode)
    })
}

fn document(nodes: Vec<Value>, meshes: &[Vec<Primitive>]) -> Doc {
    let mut doc = Doc::new(json!(nodes));
    for mesh in meshes {
        let mut list = Vec::new();
        for (positions, indices, mode) in mesh {
            let positions: Vec<[f32; 3]> = positions.iter().map(|p| p.map(f32::from)).collect();
            let mut value = json!({"attributes": {"POSITION": doc.positions(&positions)}, "mode": mode});
            if let Some((list, size)) = indices {
                value["indices"] = json!(doc.indices(list, *size));
            }
            list.push(value);
        }
        doc.mesh(json!(list));
    }
    doc
}

proptest! {
    /// Invariant: the same objects in the same order, with the same triangles, as another reader finds.
    #[test]
    fn gltf_objects_are_those_of_another_reader(
        nodes in nodes(),
        meshes in prop::collection::vec(prop::collection::vec(primitive(), 1..3), 2),
    ) {
        let bytes = document(nodes, &meshes).glb();
        let theirs = by_gltf(&bytes);
        match parse_glb(&bytes, None) {
            Ok(file) => prop_assert_eq!(difference(&summary(&file.scene), &theirs, 0.0), None),
            Err(error) => {
                prop_assert!(error.to_string().starts_with("no triangles"), "{}", error);
                prop_assert!(theirs.iter().all(|(_, triangles)| triangles.is_empty()));
            }
        }
    }

    /// Invariant: what is read can be written and is then read as the same.
    #[test]
    fn gltf_written_again_is_the_same(
        nodes in nodes(),
        meshes in prop::collection::vec(prop::collection::vec(primitive(), 1..3), 2),
    ) {
        let Ok(first) = parse_glb(&document(nodes, &meshes).glb(), None) else { return Ok(()) };
        let second = parse_glb(&write_glb(&first.scene).unwrap(), None).unwrap();
        prop_assert_eq!(difference(&summary(&first.scene), &summary(&second.scene), 0.0), None);
        prop_assert_eq!(second.info.n_degenerate_triangles, 0);
        // Now without unused corners, everything is the same.
        let third = parse_glb(&write_glb(&second.scene).unwrap(), None).unwrap();
        prop_assert_eq!(third, second);
    }

    /// Invariant: the same objects, with the same triangles, as another reader of OBJ finds.
    #[test]
    fn obj_objects_are_those_of_another_reader(
        corners in prop::collection::vec(prop::array::uniform3(-4..5i32), 3..9),
        parts in prop::collection::vec(
            (prop::option::of("[a-z]{1,4}"), prop::collection::vec((prop::array::uniform3(any::<u32>()), any::<bool>()), 1..4)),
            1..5,
        ),
        word in prop::sample::select(vec!["o", "g"]),
    ) {
        let n = corners.len() as u32;
        let mut text: String = corners.iter().map(|[x, y, z]| format!("v {x} {y}e0 {z}.5\n")).collect();
        for (name, faces) in &parts {
            text.extend(name.iter().map(|name| format!("{word} {name}\n")));
            for (face, negative) in faces {
                let index = |&i: &u32| i64::from(i % n) + 1 - if *negative { i64::from(n) + 1 } else { 0 };
                text.push_str(&format!("f {}/7 {}//8 {}\n", index(&face[0]), index(&face[1]), index(&face[2])));
            }
        }
        let theirs = by_tobj(&text);
        match parse_obj(text.as_bytes()) {
            Ok(file) => prop_assert_eq!(difference(&summary(&file.scene), &theirs, 0.0), None),
            Err(error) => {
                prop_assert!(error.to_string().starts_with("no triangles"), "{}", error);
                prop_assert!(theirs.iter().all(|(_, triangles)| triangles.is_empty()));
            }
        }
    }
}

/// What the package `tobj` makes of an OBJ of triangles.
fn by_tobj(text: &str) -> Summary {
    let no_materials = |_: &std::path::Path| Err(tobj::LoadError::OpenFileFailed);
    let (models, _) = tobj::load_obj_buf(&mut text.as_bytes(), &tobj::LoadOptions::default(), no_materials).unwrap();
    let object = |model: &tobj::Model| {
        let corner = |&i: &u32| [0, 1, 2].map(|axis| f64::from(model.mesh.positions[3 * i as usize + axis]));
        let triangles = model.mesh.indices.chunks_exact(3).map(|t| [corner(&t[0]), corner(&t[1]), corner(&t[2])]);
        let name = if model.name == "unnamed_object" { "object 0" } else { &model.name };
        (name.to_owned(), triangles.filter(has_area).collect())
    };
    models.iter().map(object).collect()
}

#[test]
fn impostor_scenes_are_found_out() {
    let doc = document(
        vec![json!({"mesh": 0}), json!({"mesh": 0})],
        &[vec![(vec![[0, 0, 0], [1, 0, 0], [0, 1, 0]], None, 4)]],
    );
    let right = by_gltf(&doc.glb());
    assert_eq!(difference(&right, &right, 0.0), None);
    let spoilt = |spoil: fn(&mut Summary)| {
        let mut other = right.clone();
        spoil(&mut other);
        difference(&right, &other, 0.5)
    };
    assert!(spoilt(|s| s[1].1[0][2][1] = 1.75).is_some());
    assert!(spoilt(|s| s.swap(0, 1)).is_some());
    assert!(spoilt(|s| drop(s.pop())).is_some());
    assert!(spoilt(|s| s[0].1.clear()).is_some());
    assert!(spoilt(|s| s[1].1[0].swap(0, 1)).is_some());
}

#[test]
fn quantised_scenes_are_beyond_the_other_reader() {
    // The reason why the other reader is a reference and not the reader.
    assert!(gltf::Gltf::from_slice(&small_doc().glb()).is_err());
}

// --- Real scenes -----------------------------------------------------------------------------------

/// What a scene's description says, beside what was read.
fn check_scene(file: &SceneFile, described: &Value) -> Result<(), String> {
    let stats = &described["stats"];
    let n_triangles = file.info.n_triangles + file.info.n_degenerate_triangles;
    if stats["objects"] != json!(file.info.n_objects) || stats["triangles"] != json!(n_triangles) {
        return Err(format!("{:?} against {stats}", file.info));
    }
    let bounds = file.scene.bounds();
    for (corner, key) in [(bounds.min, "min"), (bounds.max, "max")] {
        let given: Vec<f64> = stats[key].as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect();
        if given.len() != 3 || (0..3).any(|k| (corner[k] - given[k]).abs() > 1e-3) {
            return Err(format!("{key} {corner:?} against {given:?}"));
        }
    }
    Ok(())
}

#[test]
fn real_scenes_are_what_they_are_said_to_be() {
    let Some(data) = data_folder("SIGHTLINES_DATA", "real_scenes_are_what_they_are_said_to_be") else { return };
    let mut n_scenes = 0;
    for folder in fs::read_dir(data.join("scenes")).unwrap().map(|e| e.unwrap().path()).filter(|p| p.is_dir()) {
        for path in crate::common::files(&folder, "glb") {
            let file = read_scene(&path).unwrap_or_else(|e| panic!("{e}"));
            let described: Value = serde_json::from_slice(&fs::read(folder.join("scene.json")).unwrap()).unwrap();
            check_scene(&file, &described).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
            let mut impostor = described.clone();
            impostor["stats"]["max"][1] = json!(described["stats"]["max"][1].as_f64().unwrap() + 0.01);
            assert!(check_scene(&file, &impostor).is_err());
            for json in crate::common::files(&folder, "json") {
                let value: Value = serde_json::from_slice(&fs::read(json).unwrap()).unwrap();
                if let Some(n) = value["n_objects"].as_u64() {
                    assert_eq!(n, file.info.n_objects as u64, "{}", path.display());
                }
            }
            let again = parse_glb(&write_or_skip(&file.scene, &path), None);
            if let Ok(again) = again {
                assert_eq!(summary(&again.scene), summary(&file.scene), "{}", path.display());
            }
            n_scenes += 1;
        }
    }
    assert!(n_scenes > 0, "no scenes in the data folder");
}

/// Scenes with transforms need more than single precision and cannot be written.
fn write_or_skip(scene: &Scene, path: &std::path::Path) -> Vec<u8> {
    write_glb(scene).unwrap_or_else(|error| {
        eprintln!("{}: not written again: {error}", path.display());
        Vec::new()
    })
}

#[test]
fn real_scenes_are_those_of_another_reader() {
    let Some(data) = data_folder("SIGHTLINES_DATA", "real_scenes_are_those_of_another_reader") else { return };
    for folder in fs::read_dir(data.join("scenes")).unwrap().map(|e| e.unwrap().path()).filter(|p| p.is_dir()) {
        for path in crate::common::files(&folder, "glb") {
            let bytes = fs::read(&path).unwrap();
            let (ours, theirs) = (parse_glb(&bytes, None).unwrap(), by_gltf(&bytes));
            // In single precision triangles may lose their area, so only objects and boxes are compared.
            assert_eq!(ours.scene.objects().len(), theirs.len(), "{}", path.display());
            for (k, (object, (name, triangles))) in ours.scene.objects().iter().zip(&theirs).enumerate() {
                let bounds = object.bounds();
                let inside = |p: &[f64; 3]| (0..3).all(|a| p[a] > bounds.min[a] - 1e-3 && p[a] < bounds.max[a] + 1e-3);
                assert!(
                    object.name == *name && triangles.iter().flatten().all(inside),
                    "{}: object {k}",
                    path.display()
                );
            }
        }
    }
}
