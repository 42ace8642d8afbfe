//! Boxes of what moves, against places that are computed from keys in another way: at times that are drawn, one by one.

use crate::common::glb::Doc;
use proptest::prelude::*;
use serde_json::{Value, json};
use sightlines_formats::SceneFile;
use sightlines_formats::scene::parse_glb;
use sightlines_geometry::{Aabb, Random};

type V3 = [f64; 3];
type Q = [f64; 4];

fn read(doc: &Doc) -> SceneFile {
    parse_glb(&doc.glb(), None).unwrap()
}

fn floats(doc: &mut Doc, values: &[f64], kind: &str) -> usize {
    let n = match kind {
        "SCALAR" => 1,
        "VEC3" => 3,
        "VEC4" => 4,
        _ => 16,
    };
    let bytes: Vec<u8> = values.iter().flat_map(|&x| (x as f32).to_le_bytes()).collect();
    doc.accessor(&bytes, 5126, kind, values.len() / n)
}

/// Adds an animation of one property of a node.
fn animate(doc: &mut Doc, node: usize, path: &str, times: &[f64], values: &[f64], interpolation: &str) {
    let kind = match path {
        "rotation" => "VEC4",
        "weights" => "SCALAR",
        _ => "VEC3",
    };
    let (input, output) = (floats(doc, times, "SCALAR"), floats(doc, values, kind));
    let animation = json!({
        "samplers": [{"input": input, "output": output, "interpolation": interpolation}],
        "channels": [{"sampler": 0, "target": {"node": node, "path": path}}],
    });
    match doc.json["animations"].as_array_mut() {
        Some(list) => list.push(animation),
        None => doc.json["animations"] = json!([animation]),
    }
}

fn within(file: &SceneFile, object: u32) -> Option<Aabb<3>> {
    let moving = file.scene.moving().iter().find(|moving| moving.object == object);
    moving.unwrap_or_else(|| panic!("object {object} does not move")).within
}

fn rotate(q: Q, v: V3) -> V3 {
    let length = q.iter().map(|x| x * x).sum::<f64>().sqrt();
    let [x, y, z, w] = q.map(|a| a / length);
    let cross = |a: V3, b: V3| [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    let t = cross([x, y, z], v).map(|a| 2.0 * a);
    let u = cross([x, y, z], t);
    std::array::from_fn(|k| v[k] + w * t[k] + u[k])
}

fn slerp(a: Q, b: Q, t: f64) -> Q {
    let dot: f64 = (0..4).map(|k| a[k] * b[k]).sum();
    let (b, dot) = if dot < 0.0 { (b.map(|x| -x), -dot) } else { (b, dot) };
    let angle = dot.clamp(-1.0, 1.0).acos();
    if angle < 1e-9 {
        return a;
    }
    let (from, to) = (((1.0 - t) * angle).sin() / angle.sin(), (t * angle).sin() / angle.sin());
    std::array::from_fn(|k| from * a[k] + to * b[k])
}

/// The value of a curve at the share `t` between two keys; keys have tangents before and behind them if it is cubic.
fn at<const N: usize>(values: &[f64], key: usize, span: f64, t: f64, how: &str) -> [f64; N] {
    let part = |key: usize, part: usize, n: usize| -> [f64; N] {
        std::array::from_fn(|k| f64::from(values[(key * n + part) * N + k] as f32))
    };
    match how {
        "STEP" => part(key, 0, 1),
        "LINEAR" => {
            let (a, b) = (part(key, 0, 1), part(key + 1, 0, 1));
            match (<Q>::try_from(&a[..]), <Q>::try_from(&b[..])) {
                (Ok(a), Ok(b)) => slerp(a, b, t)[..].try_into().unwrap(),
                _ => std::array::from_fn(|k| a[k] + t * (b[k] - a[k])),
            }
        }
        _ => {
            let (p, m) = (part(key, 1, 3), part(key, 2, 3));
            let (q, n) = (part(key + 1, 1, 3), part(key + 1, 0, 3));
            let (t2, t3) = (t * t, t * t * t);
            std::array::from_fn(|k| {
                (2.0 * t3 - 3.0 * t2 + 1.0) * p[k]
                    + span * (t3 - 2.0 * t2 + t) * m[k]
                    + (3.0 * t2 - 2.0 * t3) * q[k]
                    + span * (t3 - t2) * n[k]
            })
        }
    }
}

fn contains(b: &Aabb<3>, p: V3) -> bool {
    // Single precision in files, doubles here: what is computed in another order may be a little outside.
    let slack = 1e-9 * p.iter().fold(1.0, |m: f64, x| m.max(x.abs()));
    (0..3).all(|k| b.min[k] - slack <= p[k] && p[k] <= b.max[k] + slack)
}

/// Keys of a property: so many numbers each.
fn keys(random: &mut Random, n_keys: usize, n: usize, how: &str, scale: f64, unit: bool) -> Vec<f64> {
    let n_parts = if how == "CUBICSPLINE" { 3 } else { 1 };
    let mut out = Vec::new();
    for part in 0..n_keys * n_parts {
        let is_value = n_parts == 1 || part % 3 == 1;
        let mut value: Vec<f64> = (0..n).map(|_| (random.unit() - 0.5) * 2.0 * scale).collect();
        if unit && is_value {
            let length = value.iter().map(|x| x * x).sum::<f64>().sqrt().max(1e-3);
            value.iter_mut().for_each(|x| *x /= length);
        }
        out.extend(value);
    }
    out
}

proptest! {
    /// Whatever is played, and when, a mesh stays in its box; two animated nodes, one above the other, with any interpolation.
    #[test]
    fn nothing_leaves_its_box(seed in any::<u64>()) {
        let mut random = Random::new(seed);
        let hows = ["LINEAR", "STEP", "CUBICSPLINE"];
        let mut doc = Doc::new(json!([
            {"children": [1], "translation": [1, -2, 0.5], "rotation": [0.1, 0.7, 0.1, 0.7]},
            {"children": [2], "scale": [2, 1, -1]},
            {"mesh": 0, "translation": [0, 0, 3]},
        ]));
        doc.triangle();
        let times = [0.0, 0.5, 2.0];
        let mut curves: Vec<(usize, &str, Vec<f64>, &str)> = Vec::new();
        for node in [0, 2] {
            for path in ["translation", "rotation", "scale"] {
                if random.below(3) == 0 {
                    continue;
                }
                let how = hows[random.below(3)];
                let (n, unit) = if path == "rotation" { (4, true) } else { (3, false) };
                let values = keys(&mut random, 3, n, how, if unit { 0.5 } else { 3.0 }, unit);
                animate(&mut doc, node, path, &times, &values, how);
                curves.push((node, path, values, how));
            }
        }
        let file = read(&doc);
        prop_assume!(!curves.is_empty());
        let within = within(&file, 0);
        // A cubic curve of quaternions may pass zero, where there is no telling; nothing else may.
        let is_bounded = within.is_some();
        prop_assert!(is_bounded);
        let within = within.unwrap();
        prop_assert!(!file.scene.is_opaque(0));
        for _ in 0..200 {
            for corner in [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]] {
                let mut p: V3 = corner;
                for node in [2, 1, 0] {
                    let n = &doc.json["nodes"][node];
                    let usual = |path: &str, without: Value| n.get(path).cloned().unwrap_or(without);
                    let numbers = |v: Value| -> Vec<f64> { v.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect() };
                    let mut t: V3 = numbers(usual("translation", json!([0, 0, 0]))).try_into().unwrap();
                    let mut r: Q = numbers(usual("rotation", json!([0, 0, 0, 1]))).try_into().unwrap();
                    let mut s: V3 = numbers(usual("scale", json!([1, 1, 1]))).try_into().unwrap();
                    for (_, path, values, how) in curves.iter().filter(|c| c.0 == node) {
                        // Now and then it is not played.
                        if random.below(8) == 0 {
                            continue;
                        }
                        let (key, share) = (random.below(2), random.unit());
                        let span = times[key + 1] - times[key];
                        match *path {
                            "translation" => t = at(values, key, span, share, how),
                            "scale" => s = at(values, key, span, share, how),
                            _ => {
                                let played = at(values, key, span, share, how);
                                // Fading goes on the shorter arc between what is at rest and what is played.
                                let fade = if random.below(3) == 0 { random.unit() } else { 1.0 };
                                let length = |q: Q| q.iter().map(|x| x * x).sum::<f64>().sqrt();
                                let unit = |q: Q| q.map(|x| x / length(q));
                                r = slerp(unit(r), unit(played), fade);
                            }
                        }
                    }
                    p = std::array::from_fn(|k| p[k] * s[k]);
                    p = rotate(r, p);
                    p = std::array::from_fn(|k| p[k] + t[k]);
                }
                prop_assert!(contains(&within, p), "{p:?} is not in {within:?}");
            }
        }
    }
}

#[test]
fn boxes_are_tight() {
    // A door of a metre, hinged at the origin, that opens by a quarter turn and back.
    let h = std::f64::consts::FRAC_1_SQRT_2;
    let mut doc = Doc::new(json!([{"name": "door", "mesh": 0}]));
    let positions = doc.positions(&[[0., 0., 0.], [1., 0., 0.], [1., 2., 0.], [0., 2., 0.]]);
    let indices = doc.indices(&[0, 1, 2, 0, 2, 3], 2);
    doc.mesh(json!([{"attributes": {"POSITION": positions}, "indices": indices}]));
    let turn = [0.0, 0.0, 0.0, 1.0, 0.0, h, 0.0, h, 0.0, 0.0, 0.0, 1.0];
    animate(&mut doc, 0, "rotation", &[0.0, 1.0, 2.0], &turn, "LINEAR");
    let file = read(&doc);
    let b = within(&file, 0).unwrap();
    // The truth is [0, 1] × [0, 2] × [-1, 0].
    for (found, truth) in b.min.iter().chain(&b.max).zip([0.0, 0.0, -1.0, 1.0, 2.0, 0.0]) {
        assert!((found - truth).abs() < 0.06, "{b:?}");
    }
    assert!(contains(&b, [0.0, 0.0, -1.0]) && contains(&b, [1.0, 2.0, 0.0]));
    // Impostors: the box at rest, and one around the keys alone, which the door leaves between them.
    let at_rest = Aabb { min: [0.0; 3], max: [1.0, 2.0, 0.0] };
    assert!(!contains(&at_rest, rotate([0.0, h, 0.0, h], [1.0, 0.0, 0.0])));
    let half = slerp([0.0, 0.0, 0.0, 1.0], [0.0, 1.0, 0.0, 0.0], 0.5);
    assert!(!contains(&Aabb { min: [-1.0, 0.0, 0.0], max: [1.0, 2.0, 0.0] }, rotate(half, [1.0, 0.0, 0.0])));
    assert_eq!(file.info.taken[0].because, "an animation");
    // A lift: exact but for rounding.
    let mut doc = Doc::new(json!([{"children": [1]}, {"mesh": 0}]));
    doc.triangle();
    animate(&mut doc, 0, "translation", &[0.0, 1.0], &[0.0, 0.0, 0.0, 0.0, 8.0, 0.0], "LINEAR");
    let b = within(&read(&doc), 0).unwrap();
    for (found, truth) in b.min.iter().chain(&b.max).zip([0.0, 0.0, 0.0, 1.0, 9.0, 0.0]) {
        assert!((found - truth).abs() < 1e-9, "{b:?}");
    }
}

#[test]
fn what_cannot_be_bounded_may_be_anywhere() {
    let door = || {
        let mut doc = Doc::new(json!([{"mesh": 0}, {"mesh": 0}]));
        doc.triangle();
        animate(&mut doc, 0, "translation", &[0.0, 1.0], &[0.0; 6], "LINEAR");
        doc
    };
    let spoilt = |spoil: &dyn Fn(&mut Value)| {
        let mut doc = door();
        spoil(&mut doc.json);
        let file = read(&doc);
        (file.scene.moving().len(), file.scene.moving().first().map(|m| m.within.is_some()))
    };
    assert_eq!(spoilt(&|_| {}), (1, Some(true)));
    assert_eq!(spoilt(&|d| d["animations"][0]["samplers"][0]["output"] = json!(99)), (1, Some(false)));
    assert_eq!(spoilt(&|d| d["animations"][0]["samplers"][0]["interpolation"] = json!("BEZIER")), (1, Some(false)));
    assert_eq!(spoilt(&|d| d["animations"][0]["channels"][0]["sampler"] = json!(7)), (1, Some(false)));
    assert_eq!(spoilt(&|d| d["animations"][0]["channels"][0]["target"]["path"] = json!("shear")), (1, Some(false)));
    assert_eq!(
        spoilt(&|d| d["nodes"][0]["matrix"] = json!([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1])),
        (1, Some(false))
    );
    let physics = |d: &mut Value| {
        d["nodes"][1]["extensions"] = json!({"KHR_physics_rigid_bodies": {"motion": {"mass": 1}}});
    };
    assert_eq!(spoilt(&physics).0, 2);
    // A channel without a node does nothing, a pointer to nothing that is known everything.
    let target = |target: Value| spoilt(&|d| d["animations"][0]["channels"][0]["target"] = target.clone());
    assert_eq!(target(json!({"path": "translation"})), (0, None));
    let pointer = |text: &str| json!({"path": "pointer", "extensions": {"KHR_animation_pointer": {"pointer": text}}});
    assert_eq!(target(pointer("/nodes/1/translation")), (1, Some(true)));
    assert_eq!(target(pointer("/nodes/1/extensions/X/y")), (1, Some(false)));
    assert_eq!(target(pointer("/materials/0/emissiveFactor")), (0, None));
    assert_eq!(target(json!({"path": "pointer"})), (2, Some(false)));
    let mut doc = door();
    doc.json["animations"][0]["channels"][0]["target"] = pointer("/nodes/1/extensions/KHR_node_visibility/visible");
    let file = read(&doc);
    assert_eq!((file.scene.see_through(), file.scene.moving().len()), (&[1][..], 0));
}

#[test]
fn skins_and_morph_targets_are_seen_where_they_may_be() {
    // A strip between two joints, of which the second is turned by animation.
    let mut doc = Doc::new(json!([
        {"mesh": 0, "skin": 0, "translation": [100, 100, 100]},
        {"translation": [0, 5, 0], "children": [2]},
        {"translation": [1, 0, 0]},
    ]));
    let positions = doc.positions(&[[0., 5., 0.], [1., 5., 0.], [2., 5.5, 0.]]);
    let joints = doc.accessor(&[0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0], 5121, "VEC4", 3);
    let weights = floats(&mut doc, &[1.0, 0.0, 0.0, 0.0, 0.5, 0.5, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0], "VEC4");
    let bind = |x: f64| [1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1., 0., -x, -5., 0., 1.];
    let binds = floats(&mut doc, &[bind(0.0), bind(1.0)].concat(), "MAT4");
    doc.mesh(json!([{"attributes": {"POSITION": positions, "JOINTS_0": joints, "WEIGHTS_0": weights}}]));
    doc.json["skins"] = json!([{"joints": [1, 2], "inverseBindMatrices": binds}]);
    let h = std::f64::consts::FRAC_1_SQRT_2;
    animate(&mut doc, 2, "rotation", &[0.0, 1.0], &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, h, h], "LINEAR");
    let file = read(&doc);
    assert_eq!((file.scene.see_through(), file.info.taken[0].because.as_str()), (&[0][..], "a skin"));
    // The node of the mesh does not count.
    let corners = &file.scene.objects()[0].vertices;
    assert_eq!((corners[0], corners[2]), ([0., 5., 0.], [2., 5.5, 0.]));
    let b = within(&file, 0).unwrap();
    // The last corner is 1.118 from the joint.
    assert!([[0., 5., 0.], [2., 5.5, 0.], [0.5, 6., 0.], [1., 6.118, 0.]].iter().all(|&p| contains(&b, p)), "{b:?}");
    assert!(b.max[1] < 6.4 && b.max[0] < 2.3 && b.min[1] > 4.9 && b.max[2] < 0.02, "{b:?}");
    for (path, value) in [
        ("/skins/0/joints", json!([1])),
        ("/skins/0/inverseBindMatrices", json!(99)),
        ("/nodes/0/skin", json!(4)),
        ("/meshes/0/primitives/0/attributes/WEIGHTS_0", json!(99)),
    ] {
        let mut spoilt = doc.clone();
        *spoilt.json.pointer_mut(path).unwrap() = value;
        assert_eq!(within(&read(&spoilt), 0), None, "{path}");
    }
    // A target that lifts one corner: by all weights from 0 to 1, and those that the file states.
    let mut doc = Doc::new(json!([{"mesh": 0}]));
    let positions = doc.positions(&[[0., 0., 0.], [1., 0., 0.], [0., 1., 0.]]);
    let lift = doc.positions(&[[0., 0., 0.], [0., 0., 0.], [0., 0., 4.]]);
    doc.mesh(json!([{"attributes": {"POSITION": positions}, "targets": [{"POSITION": lift}]}]));
    let top = |doc: &Doc| within(&read(doc), 0).unwrap().max[2];
    assert!((top(&doc) - 4.0).abs() < 1e-9);
    doc.json["meshes"][0]["weights"] = json!([2]);
    let file = read(&doc);
    assert!((top(&doc) - 8.0).abs() < 1e-9 && file.scene.objects()[0].vertices[2] == [0., 1., 8.]);
    assert_eq!(file.info.taken[0].because, "morph targets");
    animate(&mut doc, 0, "weights", &[0.0, 1.0], &[0.0, 3.0], "LINEAR");
    assert!((top(&doc) - 12.0).abs() < 1e-9);
    // Tangents bring it farther than keys.
    let cubic = [0.0, 0.0, 30.0, 0.0, 0.0, 0.0];
    doc.json["animations"] = Value::Null;
    doc.json.as_object_mut().unwrap().remove("animations");
    animate(&mut doc, 0, "weights", &[0.0, 1.0], &cubic, "CUBICSPLINE");
    assert!(top(&doc) >= 4.0 * 30.0 * 4.0 / 27.0);
}
