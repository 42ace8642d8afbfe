//! Boxes of what moves, against places that are computed from keys in another way: at times that are drawn, one by one.

use crate::common::glb::Doc;
use proptest::prelude::*;
use serde_json::{Value, json};
use sightlines_formats::SceneFile;
use sightlines_formats::scene::{BackFaces, SceneReadOptions, parse_gltf_with};
use sightlines_geometry::{Aabb, Random};

type V3 = [f64; 3];
type Q = [f64; 4];

fn read(doc: &Doc) -> SceneFile {
    parse_gltf_with(&doc.glb(), None, &walls()).unwrap()
}

/// All walls hide from both sides: what is asked about is what moves.
fn walls() -> SceneReadOptions {
    SceneReadOptions { backs: BackFaces::Drawn, ..SceneReadOptions::default() }
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
    contains_rounded(b, p, p.iter().fold(1.0, |m: f64, x| m.max(x.abs())))
}

/// Whether a box contains a point that was computed here, of numbers up to a magnitude.
///
/// Boxes are rounded outwards, places here are rounded in every step: to a place at most three nodes lead, each of at most a
/// hundred operations (a curve of twenty, two arcs of twenty, a rotation of thirty), each off by 2^-53 of the magnitude.
fn contains_rounded(b: &Aabb<3>, p: V3, magnitude: f64) -> bool {
    let slack = 300.0 * 0.5 * f64::EPSILON * magnitude;
    (0..3).all(|k| b.min[k] - slack <= p[k] && p[k] <= b.max[k] + slack)
}

fn unit(q: Q) -> Q {
    let length = q.iter().map(|x| x * x).sum::<f64>().sqrt();
    q.map(|x| x / length)
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
    /// Whatever is played, and when, a mesh stays in its box: two animated nodes, one above the other, with any interpolation, one
    /// or two animations of a property, and now and then a scale of zero at rest.
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
                for _ in 0..1 + random.below(2) {
                    let how = hows[random.below(3)];
                    let (n, unit) = if path == "rotation" { (4, true) } else { (3, false) };
                    let values = keys(&mut random, 3, n, how, if unit { 0.5 } else { 3.0 }, unit);
                    animate(&mut doc, node, path, &times, &values, how);
                    curves.push((node, path, values, how));
                }
                if path == "scale" && random.below(2) == 0 {
                    doc.json["nodes"][node]["scale"] = json!([0, 0, 0]);
                }
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
                let mut magnitude = 1.0_f64;
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
                        // Fading goes from what is at rest, or played before, to what is played; for rotations on the shorter arc.
                        let fade = if random.below(3) == 0 { random.unit() } else { 1.0 };
                        let faded = |from: V3, to: V3| -> V3 { std::array::from_fn(|k| from[k] + fade * (to[k] - from[k])) };
                        match *path {
                            "translation" => t = faded(t, at(values, key, span, share, how)),
                            "scale" => s = faded(s, at(values, key, span, share, how)),
                            _ => r = slerp(unit(r), unit(at(values, key, span, share, how)), fade),
                        }
                    }
                    p = std::array::from_fn(|k| p[k] * s[k]);
                    magnitude = p.into_iter().chain(t).fold(magnitude, |m, x| m.max(x.abs()));
                    p = rotate(r, p);
                    p = std::array::from_fn(|k| p[k] + t[k]);
                }
                prop_assert!(contains_rounded(&within, p, magnitude), "{p:?} is not in {within:?}");
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
    assert_eq!(file.info.surfaces[0].reason, "an animation");
    // Whether a box contains all corners of the door at a hundred times on its way to a rotation.
    let holds = |b: &Aabb<3>, to: Q| {
        let corners = [[0., 0., 0.], [1., 0., 0.], [1., 2., 0.], [0., 2., 0.]];
        let turn = |k: i32| slerp([0.0, 0.0, 0.0, 1.0], to, f64::from(k) / 100.0);
        (0..=100).all(|k| corners.iter().all(|&corner| contains(b, rotate(turn(k), corner))))
    };
    let quarter = [0.0, f64::from(h as f32), 0.0, f64::from(h as f32)];
    assert!(holds(&b, quarter));
    // The impostor: the box at rest.
    let at_rest = Aabb { min: [0.0; 3], max: [1.0, 2.0, 0.0] };
    assert!(!holds(&at_rest, quarter));
    // A third of a turn leaves the box around its keys on the way; the impostor is that box.
    let third: Q = [0.0, f64::from(0.75_f32.sqrt()), 0.0, 0.5];
    let positions = [[0., 0., 0.], [1., 0., 0.], [1., 2., 0.], [0., 2., 0.]];
    doc.json["animations"] = json!([]);
    animate(&mut doc, 0, "rotation", &[0.0, 1.0], &[&[0.0, 0.0, 0.0, 1.0], &third[..]].concat(), "LINEAR");
    let b = within(&read(&doc), 0).unwrap();
    assert!(holds(&b, third) && b.min[2] > -1.06, "{b:?}");
    let around_keys = Aabb::around(positions.into_iter().flat_map(|p| [p, rotate(third, p)]));
    assert!(!holds(&around_keys, third), "{around_keys:?}");
    // A lift: exact but for rounding.
    let mut doc = Doc::new(json!([{"children": [1]}, {"mesh": 0}]));
    doc.triangle();
    animate(&mut doc, 0, "translation", &[0.0, 1.0], &[0.0, 0.0, 0.0, 0.0, 8.0, 0.0], "LINEAR");
    let b = within(&read(&doc), 0).unwrap();
    for (found, truth) in b.min.iter().chain(&b.max).zip([0.0, 0.0, 0.0, 1.0, 9.0, 0.0]) {
        // A key is widened by 2^-44 of itself.
        assert!((found - truth).abs() < 1e-12, "{b:?}");
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
    // Extensions that move a node, or all of them.
    let extended = |name: &str, value: Value| {
        spoilt(&|d| {
            d["nodes"][1]["extensions"] = json!({name: value.clone()});
            d["animations"] = json!([]);
        })
    };
    for name in ["OMI_vehicle_body", "VRMC_node_constraint", "VRMC_springBone", "ACME_orbit"] {
        assert_eq!(extended(name, json!({})), (1, Some(false)), "{name}");
    }
    assert_eq!(extended("AGI_articulations", json!({"articulationName": "arm"})), (1, Some(false)));
    assert_eq!(extended("OMI_physics_body", json!({"motion": {"type": "dynamic"}})), (1, Some(false)));
    assert_eq!(extended("OMI_physics_body", json!({"motion": {"type": "static"}})), (0, None));
    for name in ["KHR_lights_punctual", "MSFT_lod", "KHR_audio_emitter", "KHR_node_visibility"] {
        assert_eq!(extended(name, json!({})), (0, None), "{name}");
    }
    for name in ["KHR_interactivity", "VRM", "VRMC_springBone"] {
        assert_eq!(spoilt(&|d| d["extensionsUsed"] = json!([name])), (2, Some(false)), "{name}");
        assert_eq!(spoilt(&|d| d["extensions"] = json!({name: {}})), (2, Some(false)), "{name}");
    }
    assert_eq!(spoilt(&|d| d["extensionsUsed"] = json!(["VRMC_materials_mtoon"])), (1, Some(true)));
    assert_eq!(spoilt(&|d| d["extensions"] = json!(7)), (1, Some(true)));
    let mut doc = door();
    doc.json["extensions"] = json!({"KHR_interactivity": {}, "ACME_weather": {}});
    doc.json["nodes"][1]["extensions"] = json!({"ACME_orbit": {}});
    let file = read(&doc);
    let reasons: Vec<&str> = file.info.surfaces.iter().map(|found| found.reason.as_str()).collect();
    assert_eq!(reasons, ["KHR_interactivity", "the unknown extension ACME_orbit"]);
    assert_eq!(
        file.info.warnings,
        [
            "KHR_interactivity may move everything, so nothing hides and all is seen from everywhere: name what never moves \
             (--still)",
            "the extension ACME_weather of the document is not known: name what moves by it, if anything does (--see-through)",
            "1 node has the extension ACME_orbit, which is not known: they count as moving anywhere; name what never moves \
             (--still)"
        ]
    );
    // Who knows that nothing moves says so.
    let still = SceneReadOptions { still: vec!["*".parse().unwrap()], ..walls() };
    let file = parse_gltf_with(&doc.glb(), None, &still).unwrap();
    assert!(file.scene.moving().is_empty() && file.scene.see_through().is_empty());
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

/// What has no area at rest is seen where it has one.
#[test]
fn what_is_flat_at_rest_is_seen_where_it_is_not() {
    let grows = [0.0, 0.0, 0.0, 2.0, 2.0, 2.0];
    let mut doc = Doc::new(json!([{"mesh": 0, "scale": [0, 0, 0], "translation": [5, 0, 0]}, {"mesh": 0}]));
    doc.triangle();
    animate(&mut doc, 0, "scale", &[0.0, 1.0], &grows, "LINEAR");
    let scene = read(&doc).scene;
    let extent = scene.extent(0);
    assert!(
        contains(&extent, [5.0, 0.0, 0.0]) && contains(&extent, [7.0, 0.0, 0.0]) && contains(&extent, [5.0, 2.0, 0.0])
    );
    assert!((0..3).all(|k| extent.max[k] < [7.1, 2.1, 0.1][k] && extent.min[k] > [4.9, -0.1, -0.1][k]), "{extent:?}");
    // The same without animation is nowhere.
    doc.json["animations"] = json!([]);
    let file = read(&doc);
    assert!(file.scene.extent(0).is_empty() && file.info.n_degenerate_triangles == 1);
    // By a node above it, by a target, and by joints.
    let mut doc = Doc::new(json!([{"children": [1], "scale": [1, 0, 0]}, {"mesh": 0}]));
    doc.triangle();
    animate(&mut doc, 0, "scale", &[0.0, 1.0], &grows, "LINEAR");
    assert!(contains(&read(&doc).scene.extent(0), [0.0, 2.0, 0.0]));
    let mut doc = Doc::new(json!([{"mesh": 0}]));
    let positions = doc.positions(&[[0., 0., 0.], [1., 0., 0.], [2., 0., 0.]]);
    let lift = doc.positions(&[[0., 0., 0.], [0., 4., 0.], [0., 0., 0.]]);
    doc.mesh(json!([{"attributes": {"POSITION": positions}, "targets": [{"POSITION": lift}]}]));
    let scene = read(&doc).scene;
    assert!(contains(&scene.extent(0), [1.0, 4.0, 0.0]) && scene.n_triangles() == 1);
    // What is not drawn moves nowhere, and what has no triangles is not drawn.
    doc.json["nodes"][0]["extras"] = json!({"sightlines": {"role": "ignore"}});
    doc.push("nodes", json!({"mesh": 1}));
    doc.push("nodes", json!({"mesh": 2}));
    doc.json["scenes"][0]["nodes"] = json!([0, 1, 2]);
    doc.mesh(json!([{"attributes": {"POSITION": positions}, "mode": 0, "targets": [{"POSITION": lift}]}]));
    doc.triangle();
    let scene = read(&doc).scene;
    assert!(scene.extent(0).is_empty() && scene.extent(1).is_empty() && scene.moving().is_empty());
}

/// What hides, hides where it stands: an occluder that moves is seen wherever it goes, and hides nothing.
#[test]
fn occluders_that_move_hide_nothing() {
    let mut doc =
        Doc::new(json!([{"name": "gate-occ", "mesh": 0}, {"mesh": 0, "extras": {"sightlines": {"role": "occluder"}}}]));
    doc.triangle();
    for node in [0, 1] {
        animate(&mut doc, node, "translation", &[0.0, 1.0], &[0.0, 0.0, 0.0, 0.0, 8.0, 0.0], "LINEAR");
    }
    let opaque = SceneReadOptions { opaque: vec!["gate*".parse().unwrap()], ..walls() };
    for options in [walls(), opaque.clone()] {
        let file = parse_gltf_with(&doc.glb(), None, &options).unwrap();
        assert_eq!(file.scene.see_through(), [0, 1]);
        assert!((0..2).all(|k| contains(&file.scene.extent(k), [0.0, 9.0, 0.0])));
        let warning =
            "2 occluders move and hide nothing, the first is called \"gate-occ\": name what never moves (--still)";
        assert_eq!(file.info.warnings, [warning]);
    }
    // The twins: without animation it hides, and so it does if somebody says that it is never played.
    let still = SceneReadOptions { still: vec!["gate*".parse().unwrap()], ..opaque };
    let file = parse_gltf_with(&doc.glb(), None, &still).unwrap();
    assert_eq!((file.scene.see_through(), file.scene.extent(0).max[1]), (&[1][..], 1.0));
    doc.json["animations"] = json!([]);
    assert!(read(&doc).scene.see_through().is_empty());
}

/// A node is where its parents in the scene put it, whatever other scenes make of it.
#[test]
fn parents_are_those_of_the_scene() {
    let mut doc = Doc::new(json!([{"children": [2]}, {"children": [2], "translation": [50, 0, 0]}, {"mesh": 0}]));
    doc.triangle();
    doc.json["scenes"] = json!([{"nodes": [0]}]);
    animate(&mut doc, 0, "translation", &[0.0, 1.0], &[0.0, 0.0, 0.0, 0.0, 8.0, 0.0], "LINEAR");
    let b = within(&read(&doc), 0).unwrap();
    assert!(contains(&b, [0.0, 9.0, 0.0]) && b.max[0] < 1.1, "{b:?}");
    // The same with the node as a root of the scene that is read, below an animated one of another.
    doc.json["scenes"] = json!([{"nodes": [2]}]);
    assert!(read(&doc).scene.moving().is_empty());
    // A joint outside of the scene with two parents may be anywhere.
    let mut doc = Doc::new(json!([{"mesh": 0, "skin": 0}, {"children": [3]}, {"children": [3]}, {}]));
    let positions = doc.positions(&[[0., 0., 0.], [1., 0., 0.], [0., 1., 0.]]);
    let joints = doc.accessor(&[0; 12], 5121, "VEC4", 3);
    let weights = floats(&mut doc, &[1.0, 0.0, 0.0, 0.0].repeat(3), "VEC4");
    doc.mesh(json!([{"attributes": {"POSITION": positions, "JOINTS_0": joints, "WEIGHTS_0": weights}}]));
    doc.json["skins"] = json!([{"joints": [3]}]);
    doc.json["scenes"] = json!([{"nodes": [0]}]);
    assert_eq!(within(&read(&doc), 0), None);
    doc.json["nodes"][2]["children"] = json!([]);
    assert!(within(&read(&doc), 0).is_some());
}

/// Programs differ in what they make of weights that do not add up to 1, and of more than four joints.
#[test]
fn weights_that_do_not_add_up_are_held() {
    let skinned = |first: [f64; 4], second: [f64; 4]| {
        let mut doc = Doc::new(
            json!([{"mesh": 0, "skin": 0, "translation": [0, 0, -40]}, {"translation": [0, 10, 0]}, {"translation": [0, 20, 0]}]),
        );
        let positions = doc.positions(&[[0., 0., 0.], [1., 0., 0.], [0., 1., 0.]]);
        let joints = [[0, 0, 0, 0], [1, 0, 0, 0]].map(|j| doc.accessor(&[j; 3].concat(), 5121, "VEC4", 3));
        let weights = [first, second].map(|w| floats(&mut doc, &w.repeat(3), "VEC4"));
        doc.mesh(json!([{"attributes": {"POSITION": positions, "JOINTS_0": joints[0], "WEIGHTS_0": weights[0],
            "JOINTS_1": joints[1], "WEIGHTS_1": weights[1]}}]));
        doc.json["skins"] = json!([{"joints": [1, 2]}]);
        within(&read(&doc), 0)
    };
    let half = [0.5, 0.0, 0.0, 0.0];
    let b = skinned(half, half).unwrap();
    // All joints: the middle of both. Four of them, divided by their sum: the first. Not divided: half of it, as seen from the
    // origin or from the node of the mesh.
    for p in [[0.0, 15.0, 0.0], [0.0, 10.0, 0.0], [0.0, 5.0, 0.0], [0.0, 5.0, -20.0]] {
        assert!(contains(&b, p), "{p:?} {b:?}");
    }
    assert!(
        !contains(&b, [0.0, 4.0, 0.0]) && !contains(&b, [0.0, 15.0, -21.0]) && !contains(&b, [0.0, 22.0, 0.0]),
        "{b:?}"
    );
    // All in one set, and no weight in the second: tight.
    let b = skinned([1.0, 0.0, 0.0, 0.0], [0.0; 4]).unwrap();
    assert!(contains(&b, [0.0, 10.0, 0.0]) && !contains(&b, [0.0, 9.99, 0.0]) && !contains(&b, [0.0, 10.0, -0.01]));
    // Above 1, and nothing to divide by; below 0.
    assert!(contains(&skinned([2.0, 0.0, 0.0, 0.0], [0.0; 4]).unwrap(), [2.0, 20.0, 40.0]));
    assert_eq!(skinned([0.0; 4], half), None);
    assert_eq!(skinned(half, [-0.5, 0.0, 0.0, 0.0]), None);
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
    assert_eq!((file.scene.see_through(), file.info.surfaces[0].reason.as_str()), (&[0][..], "a skin"));
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
    assert!((top(&doc) - 4.0).abs() < 1e-13);
    doc.json["meshes"][0]["weights"] = json!([2]);
    let file = read(&doc);
    assert!((top(&doc) - 8.0).abs() < 1e-13 && file.scene.objects()[0].vertices[2] == [0., 1., 8.]);
    assert_eq!(file.info.surfaces[0].reason, "morph targets");
    animate(&mut doc, 0, "weights", &[0.0, 1.0], &[0.0, 3.0], "LINEAR");
    assert!((top(&doc) - 12.0).abs() < 1e-12);
    // Tangents bring it farther than keys.
    let cubic = [0.0, 0.0, 30.0, 0.0, 0.0, 0.0];
    doc.json["animations"] = Value::Null;
    doc.json.as_object_mut().unwrap().remove("animations");
    animate(&mut doc, 0, "weights", &[0.0, 1.0], &cubic, "CUBICSPLINE");
    assert!(top(&doc) >= 4.0 * 30.0 * 4.0 / 27.0);
}
