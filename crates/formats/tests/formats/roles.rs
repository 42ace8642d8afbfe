//! Doors, hulls for collisions, levels of detail, and what extras say of motion.

use crate::common::glb::Doc;
use crate::materials::{classified, doc, options, read, read_with};
use serde_json::{Value, json};
use sightlines_cells::MovingObject;
use sightlines_formats::scene::{EmptyPattern, NamePattern, Role, SceneReadOptions, parse_obj};
use sightlines_geometry::Aabb;

/// A door that stands still in its file is seen wherever it opens to: boxes of turned and slid doors lie in its own.
#[test]
fn doors_that_stand_still_may_open() {
    let mut doc = Doc::new(json!([{"mesh": 0, "extras": {"sightlines": {"role": "door"}}}]));
    let corners = [[1.0, 0.0, 3.0], [1.9, 0.0, 3.0], [1.9, 2.0, 3.04], [1.0, 2.0, 3.04]];
    let positions = doc.positions(&corners.map(|p: [f64; 3]| p.map(|x| x as f32)));
    let indices = doc.indices(&[0, 1, 2, 0, 2, 3], 2);
    doc.mesh(json!([{"attributes": {"POSITION": positions}, "indices": indices}]));
    let file = read(&doc);
    assert_eq!(classified(&file), [(0, Role::Door, "extras")]);
    let [MovingObject { object: 0, within: Some(within) }] = file.scene.moving() else {
        panic!("{:?}", file.scene.moving())
    };
    let corners = &file.scene.objects()[0].vertices;
    let holds = |b: &Aabb<3>, p: [f64; 3]| (0..3).all(|k| b.min[k] <= p[k] && p[k] <= b.max[k]);
    let mut n_turned = 0;
    for hinge in corners {
        for axis in 0..3 {
            let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
            for step in 0..32 {
                let (sine, cosine) = (f64::from(step) * std::f64::consts::TAU / 32.0).sin_cos();
                for p in corners {
                    let (a, b) = (p[u] - hinge[u], p[v] - hinge[v]);
                    let mut turned = *p;
                    (turned[u], turned[v]) = (hinge[u] + cosine * a - sine * b, hinge[v] + sine * a + cosine * b);
                    assert!(holds(within, turned), "{turned:?} about {hinge:?}");
                    n_turned += 1;
                }
            }
        }
        // Slid by its width, to either side, and up by its height.
        for p in corners {
            for by in [[0.9, 0.0, 0.0], [-0.9, 0.0, 0.0], [0.0, 2.0, 0.0]] {
                assert!(holds(within, std::array::from_fn(|k| p[k] + by[k])));
            }
        }
    }
    assert_eq!(n_turned, 4 * 3 * 32 * 4);
    // Tight: no farther than the diagonal of the door, 2.19, and a hair.
    assert!((0..3).all(|k| within.max[k] - corners.iter().map(|p| p[k]).fold(f64::MIN, f64::max) < 2.2), "{within:?}");
    // The impostor: the box in which the door stands. And who says that it never opens is believed.
    let shut = Aabb::around(corners.iter().copied());
    assert!(!holds(&shut, [1.0, 0.0, 3.9]) && holds(within, [1.0, 0.0, 3.9]));
    let still = SceneReadOptions { still: vec!["*".parse().unwrap()], ..options(&[], &[]) };
    let file = read_with(&doc, &still);
    assert_eq!((file.scene.moving().len(), file.scene.see_through()), (0, &[0][..]));
}

/// Motion is stated of nodes, meshes and materials, with whatever a program has for true.
#[test]
fn extras_of_meshes_and_materials_move_things_too() {
    let moves = |value: Value| json!({"sightlines": {"moves": value}});
    let of = |path: &str, value: Value| {
        let mut doc = doc(&[json!({"name": "lift"}), json!({})], &[json!({"name": "steel"}), json!({})]);
        doc.json.pointer_mut(path).unwrap()["extras"] = moves(value);
        let file = read(&doc);
        (file.scene.moving().to_vec(), file.info.warnings)
    };
    let anywhere = vec![MovingObject { object: 0, within: None }];
    for path in ["/nodes/0", "/meshes/0", "/materials/0"] {
        for value in [json!(true), json!(1), json!(1.0)] {
            assert_eq!(of(path, value), (anywhere.clone(), vec![]), "{path}");
        }
        for value in [json!(false), json!(0), Value::Null] {
            assert_eq!(of(path, value), (vec![], vec![]), "{path}");
        }
        let (moving, warnings) = of(path, json!("no"));
        assert_eq!(moving, anywhere, "{path}");
        let [warning] = &warnings[..] else { panic!("{warnings:?}") };
        assert!(
            warning.contains("state a \"moves\" that is neither true nor false, which counts as true: 1, the first"),
            "{warning}"
        );
    }
    // A material that a variant brings.
    let mut variant = doc(&[json!({})], &[json!({}), json!({"extras": moves(json!(1))})]);
    variant.json["meshes"][0]["primitives"][0]["extensions"] =
        json!({"KHR_materials_variants": {"mappings": [{"material": 1, "variants": [0]}]}});
    variant.json["materials"] = json!([{}, {"extras": moves(json!(1))}]);
    assert_eq!(read(&variant).scene.moving(), anywhere);
}

#[test]
fn hulls_of_unreal_are_not_seen_and_hide_nothing() {
    let named = |name: &str| json!({"name": name});
    let nodes = ["Chair", "UCX_Chair_00", "UBX_Chair.001", "UCX_Table", "USP_Lamp_01", "UCP_"].map(named);
    let mut doc = doc(&nodes, &[]);
    doc.json["meshes"][0]["name"] = json!("SM_Table");
    doc.json["meshes"][1]["name"] = json!("Table");
    let file = read(&doc);
    let (hull, odd) = (Role::Ignore, Role::SeeThrough);
    assert_eq!(
        classified(&file),
        [
            (1, hull, "a name with UCX_"),
            (2, hull, "a name with UBX_"),
            (3, hull, "a name with UCX_"),
            (4, odd, "a name with USP_"),
            (5, odd, "a name with UCP_")
        ]
    );
    // Ids stay, triangles of hulls go; what belongs to no mesh is seen.
    let n_triangles: Vec<usize> = file.scene.objects().iter().map(|o| o.triangles.len()).collect();
    assert_eq!((n_triangles, file.scene.see_through()), (vec![1, 0, 0, 0, 1, 1], &[1, 2, 3, 4, 5][..]));
    // A pattern shows what only a name calls a hull.
    let shown = read_with(&doc, &options(&["UCX_*"], &["UBX_*"]));
    let drawn: Vec<bool> = shown.scene.objects().iter().map(|o| !o.triangles.is_empty()).collect();
    assert_eq!((drawn, shown.scene.see_through()), (vec![true; 6], &[1, 2, 3, 4, 5][..]));
    // Extras are stronger, and what hangs below a hull is seen, and hides nothing.
    doc.json["nodes"][1]["extras"] = json!({"sightlines": {"role": "occluder"}});
    doc.json["nodes"][2]["children"] = json!([0]);
    doc.json["scenes"][0]["nodes"] = json!([1, 2, 3, 4, 5]);
    let file = read(&doc);
    let hides: Vec<&str> =
        (0..6).filter(|&k| file.scene.is_opaque(k)).map(|k| &*file.scene.objects()[k as usize].name).collect();
    assert_eq!(hides, ["UCX_Chair_00"]);
    assert_eq!(file.scene.objects()[0].name, "UCX_Chair_00");
    // As in an OBJ.
    let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\no Chair\nf 1 2 3\no UCX_Chair_1\nf 1 2 3\no UCX_Sofa\nf 1 2 3\n";
    let file = parse_obj(obj.as_bytes()).unwrap();
    assert_eq!(classified(&file), [(1, hull, "a name with UCX_"), (2, odd, "a name with UCX_")]);
}

/// The finest level stands for all, wherever a file places the others; what would be left out for its own sake is not.
#[test]
fn coarser_levels_are_no_objects() {
    let level = |ids: Value| json!({"MSFT_lod": {"ids": ids}});
    let of = |extensions: &[(usize, Value)], roots: Value, children: &[(usize, Value)]| {
        let mut doc = doc(&["fine", "middle", "coarse", "part"].map(|name| json!({"name": name})), &[]);
        for (node, ids) in extensions {
            doc.json["nodes"][node]["extensions"] = level(ids.clone());
        }
        for (node, list) in children {
            doc.json["nodes"][node]["children"] = list.clone();
        }
        doc.json["scenes"][0]["nodes"] = roots;
        let file = read(&doc);
        let names: Vec<String> = file.scene.objects().iter().map(|o| o.name.clone()).collect();
        (names.join(" "), file.info.warnings)
    };
    let none = Vec::<String>::new();
    let left_out = |text: &str| vec![format!("{text} of others (MSFT_lod): left out, the finest stands for them")];
    let both = [(0, json!([1, 2]))];
    assert_eq!(of(&both, json!([0, 3]), &[]), ("fine part".into(), none.clone()));
    assert_eq!(of(&both, json!([0, 1, 2, 3]), &[]), ("fine part".into(), left_out("2 nodes are coarser levels")));
    assert_eq!(of(&both, json!([2, 3, 0]), &[]), ("part fine".into(), left_out("1 node is a coarser level")));
    // With all below them, and below others.
    assert_eq!(of(&both, json!([0, 1]), &[(1, json!([3]))]), ("fine".into(), left_out("1 node is a coarser level")));
    assert_eq!(
        of(&both, json!([3]), &[(3, json!([1, 0]))]),
        ("part fine".into(), left_out("1 node is a coarser level"))
    );
    // Levels of what is not in the scene, of each other, of themselves, and of what is below a level, stay.
    assert_eq!(of(&both, json!([1, 3]), &[]), ("middle part".into(), none.clone()));
    assert_eq!(of(&[(0, json!([1])), (1, json!([0]))], json!([0, 1]), &[]), ("fine middle".into(), none.clone()));
    assert_eq!(of(&[(0, json!([0]))], json!([0]), &[]), ("fine".into(), none.clone()));
    let below = [(0, json!([1])), (3, json!([2]))];
    let (names, warnings) = of(&below, json!([0, 1, 2]), &[(1, json!([3]))]);
    assert_eq!((names.as_str(), warnings), ("fine coarse", left_out("1 node is a coarser level")));
    for odd in [json!([99]), json!("x"), json!([1.5]), json!(null)] {
        assert_eq!(of(&[(0, odd)], json!([0, 1]), &[]), ("fine middle".into(), none.clone()));
    }
}

#[test]
fn doors_of_a_scene_are_those_with_that_role() {
    let role = |role: &str| json!({"extras": {"sightlines": {"role": role}}});
    let mut doc = doc(&[role("door"), role("detail"), json!({"name": "Door"}), json!({"name": "Door.001"})], &[]);
    assert_eq!(read(&doc).scene.doors(), [0]);
    // By name only what is animated: a wall may be called so.
    let times = doc.json["accessors"].as_array().unwrap().len();
    doc.positions(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]]);
    doc.json["animations"] = json!([{"channels": [{"sampler": 0, "target": {"node": 3, "path": "translation"}}],
        "samplers": [{"input": times, "output": times}]}]);
    assert_eq!(read(&doc).scene.doors(), [0, 3]);
    // One of glass hides nothing when it is shut, nor does a single face whose back is looked through.
    let sided = SceneReadOptions::default();
    assert_eq!(read_with(&doc, &sided).scene.doors(), [0u32; 0]);
    doc.json["materials"] = json!([{"doubleSided": true}, {"alphaMode": "BLEND"}]);
    doc.json["meshes"][0]["primitives"][0]["material"] = json!(0);
    doc.json["meshes"][3]["primitives"][0]["material"] = json!(1);
    assert_eq!((read_with(&doc, &sided).scene.doors(), read(&doc).scene.doors()), (&[0][..], &[0][..]));
    assert!(read_with(&doc, &options(&[], &["*"])).scene.doors().is_empty());
    doc.json["meshes"][0]["primitives"][0]["extensions"] =
        json!({"KHR_materials_variants": {"mappings": [{"material": 1, "variants": [0]}]}});
    assert!(read(&doc).scene.doors().is_empty());
}

#[test]
fn patterns_match_whole_names() {
    let matches = |pattern: &str, name: &str| pattern.parse::<NamePattern>().unwrap().matches(name);
    for (pattern, name) in [
        ("glass", "Glass"),
        ("*glass*", "old GLASS 2"),
        ("*", ""),
        ("a?c", "aéc"),
        ("*.0?1", "Wall.001"),
        ("a*b*c", "a-b-b-c"),
        ("**", "x"),
    ] {
        assert!(matches(pattern, name), "{pattern} {name}");
    }
    for (pattern, name) in [("glass", "glass2"), ("?", ""), ("a*b", "a-b-c"), ("*glass", "glass pane"), ("a?c", "ac")] {
        assert!(!matches(pattern, name), "{pattern} {name}");
    }
    assert_eq!("".parse::<NamePattern>(), Err(EmptyPattern));
    assert_eq!("*gl?ss".parse::<NamePattern>().unwrap().to_string(), "*gl?ss");
}
