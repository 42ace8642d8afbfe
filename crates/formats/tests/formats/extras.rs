//! What extras, extensions and names of a file state of an object: forms that count, and forms that do not.

use crate::common::glb::{Doc, glb};
use crate::materials::{classified, doc, read};
use serde_json::{Value, json};
use sightlines_formats::SceneFile;
use sightlines_formats::scene::{Role, parse_glb, parse_obj};

/// A scene of a thing with these extras and of another with none. They are any text of JSON.
fn with_extras(extras: &str) -> SceneFile {
    let doc = doc(&[json!({"extras": "EXTRAS"}), json!({})], &[]);
    parse_glb(&glb(&doc.text().replace("\"EXTRAS\"", extras), &doc.binary), None).unwrap()
}

fn is_mirror(extras: &str) -> bool {
    with_extras(extras).scene.mirrors() == [0]
}

/// Whether a thing moves, and may be anywhere; and whether that is not certain.
fn moves(extras: &str) -> (bool, bool) {
    let file = with_extras(extras);
    let is_unclear = file.info.warnings.iter().any(|w| w.contains("a \"moves\" that is neither true nor false"));
    (file.scene.moving().iter().any(|moving| moving.object == 0 && moving.within.is_none()), is_unclear)
}

#[test]
fn roles_are_read_as_they_are_named() {
    for role in Role::ALL {
        let text = format!(r#"{{"sightlines": {{"role": "{}"}}}}"#, role.name());
        match role {
            Role::Mirror => assert!(is_mirror(&text)),
            _ => assert_eq!(classified(&with_extras(&text)), [(0, role, "extras")]),
        }
    }
    let unknown = with_extras(r#"{"sightlines": {"role": "seethrough"}}"#);
    assert!(unknown.info.surfaces.is_empty() && unknown.info.warnings[0].contains("a role that is none of occluder, "));
    let other = with_extras(r#"{"sightlines": {"role": 3}}"#);
    assert!(other.info.surfaces.is_empty() && other.info.warnings.is_empty());
}

#[test]
fn what_moves_is_stated_beside_its_role() {
    for text in
        [r#"{"sightlines": {"role": "door", "moves": true}}"#, r#"{"sightlines": {"moves": true, "role": "door"}}"#]
    {
        assert_eq!(classified(&with_extras(text)), [(0, Role::Door, "extras")]);
        assert_eq!(moves(text), (true, false));
    }
    let stated = |value: &str| moves(&format!(r#"{{"sightlines": {{"moves": {value}}}}}"#));
    for value in ["true", "1", "-1", "0.5"] {
        assert_eq!(stated(value), (true, false), "{value}");
    }
    for value in ["false", "0", "0.0", "null"] {
        assert_eq!(stated(value), (false, false), "{value}");
    }
    for value in [r#""false""#, r#""door""#, "[]", "{}"] {
        assert_eq!(stated(value), (true, true), "{value}");
    }
    for text in [r#"{"moves": true}"#, r#"{"sightlines": {"x": {"moves": true}}}"#] {
        assert_eq!(moves(text), (false, false), "{text}");
    }
}

#[test]
fn what_is_simplified_is_no_occluder_unless_it_says_so() {
    let read = |extras: &str| {
        let mut doc = doc(&[json!({})], &[]);
        doc.json["asset"]["extras"] = json!("EXTRAS");
        let file = parse_glb(&glb(&doc.text().replace("\"EXTRAS\"", extras), &doc.binary), None).unwrap();
        file.info.simplified.map(|simplified| simplified.occluder)
    };
    assert_eq!(read(r#"{"sightlines": {"simplified": {"occluder": true, "x": 1}}, "y": null}"#), Some(true));
    assert_eq!(read(r#"{"sightlines": {"simplified": {"occluder": false}}}"#), Some(false));
    for unclear in ["{}", "null", "true", "[]", r#"{"occluder": "true"}"#, r#"{"occluder": 1}"#, r#"{"x": true}"#] {
        let text = format!(r#"{{"sightlines": {{"simplified": {unclear}}}}}"#);
        assert_eq!(read(&text), Some(false), "{text}");
    }
    for other in ["null", "3", "[]", "{}", r#"{"sightlines": true}"#, r#"{"simplified": {"occluder": false}}"#] {
        assert_eq!(read(other), None, "{other}");
    }
}

#[test]
fn extras_of_any_form_are_read() {
    assert!(is_mirror(r#"{"a": [1], "sightlines": {"x": null, "role": "mirror"}, "b": {"sightlines": 3}}"#));
    for other in [
        "null",
        "true",
        "-1",
        "1.5",
        "7",
        "\"mirror\"",
        "[\"mirror\", {}]",
        "{}",
        r#"{"role": "mirror"}"#,
        r#"{"sightlines": "mirror"}"#,
        r#"{"sightlines": {"role": "Mirror"}}"#,
        r#"{"sightlines": {"role": ["mirror"]}}"#,
        r#"{"sightlines": {"role": {"mirror": "mirror"}}}"#,
        r#"{"x": {"sightlines": {"role": "mirror"}}}"#,
    ] {
        assert!(!is_mirror(other), "{other}");
    }
    // Nested more deeply than is read.
    let deep = format!("{{\"x\": {}{}}}", "[".repeat(5000), "]".repeat(5000));
    assert!(!is_mirror(&deep));
}

#[test]
fn what_an_extension_contains_tells_whether_it_moves() {
    // That of a node without a mesh, which has a child with one.
    let with_extensions = |extensions: Value| {
        let mut doc = Doc::new(json!([{"extensions": extensions, "children": [1]}, {"mesh": 0}]));
        let positions = doc.positions(&[[0., 0., 0.], [1., 0., 0.], [0., 1., 0.]]);
        doc.mesh(json!([{"attributes": {"POSITION": positions}}]));
        doc
    };
    let found = |name: &str, value: Value| {
        let file = read(&with_extensions(json!({name: value})));
        let reason = file.info.surfaces.first().map(|class| class.reason.clone());
        (file.scene.moving().len(), reason)
    };
    let moving = |name: &str, value: Value| found(name, value) == (1, Some(name.to_owned()));
    let still = |name: &str, value: Value| found(name, value) == (0, None);
    let physics = "KHR_physics_rigid_bodies";
    assert!(moving(physics, json!({"motion": {"isKinematic": true}})) && moving(physics, json!(3)));
    assert!(still(physics, json!({"collider": {}})));
    let body = "OMI_physics_body";
    for value in [json!({"motion": {"type": "kinematic"}}), json!({"motion": {}}), json!({"type": "rigid"}), json!([])]
    {
        assert!(moving(body, value.clone()), "{value}");
    }
    for value in [json!({"motion": {"type": "static"}}), json!({"type": "trigger"}), json!({"collider": {"shape": 0}})]
    {
        assert!(still(body, value.clone()), "{value}");
    }
    assert!(moving("AGI_articulations", json!({"articulationName": "arm"})));
    assert!(still("AGI_articulations", json!({"isAttachPoint": true})));
    for name in ["OMI_vehicle_body", "OMI_vehicle_wheel", "VRMC_node_constraint", "VRMC_springBone"] {
        assert!(moving(name, json!({})), "{name}");
    }
    assert_eq!(found("ACME_orbit", json!({})), (1, Some("the unknown extension ACME_orbit".to_owned())));
    for name in
        ["KHR_lights_punctual", "MSFT_lod", "EXT_mesh_gpu_instancing", "KHR_audio_emitter", "KHR_node_visibility"]
    {
        assert!(still(name, json!({})), "{name}");
    }
    let invisible = found("KHR_node_visibility", json!({"visible": false}));
    assert_eq!(invisible, (0, Some("KHR_node_visibility".to_owned())));
    assert!(parse_glb(&with_extensions(json!([])).glb(), None).is_err());
}

/// What a file of some objects makes of the last of them, by its name.
fn by_name(others: &[&str], name: &str) -> (Option<Role>, Option<String>) {
    let corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    let objects = others.iter().chain([&name]).map(|name| format!("o {name}\nf 1 2 3\n"));
    let file = parse_obj(format!("{corners}{}", objects.collect::<String>()).as_bytes()).unwrap();
    let last = file.scene.objects().len() as u32 - 1;
    let class = file.info.surfaces.iter().find(|class| class.object == last);
    let mirror = file.scene.mirrors().contains(&last).then_some(Role::Mirror);
    (mirror.or(class.map(|class| class.role)), class.map(|class| class.reason.clone()))
}

#[test]
fn names_say_what_importers_make_of_them() {
    let role = |name: &str| by_name(&[], name).0;
    for name in ["Wall-colonly", "wall-CONVCOLONLY.001", "a_noimp", "x$navmesh y", "Car-vehicle", "car-wheel2"] {
        assert_eq!(role(name), Some(Role::SeeThrough), "{name}");
    }
    assert_eq!((role("House-occ"), role("House-occonly.002")), (Some(Role::Occluder), Some(Role::Occluder)));
    assert_eq!(role("hall-mirror"), Some(Role::Mirror));
    for name in ["wheel", "Wall-col", "Wall-convcol", "house_occ", "House-OCC", "colonly-wall", "rigidity", ""] {
        assert_eq!(role(name), None, "{name}");
    }
    for (name, is_alpha) in [("Leaves-alpha", true), ("leaves_Alpha.003", true), ("alphabet", false)] {
        let file = read(&doc(&[json!({})], &[json!({"name": name})]));
        let expected: &[_] = if is_alpha { &[(0, Role::SeeThrough, "a material named -alpha")] } else { &[] };
        assert_eq!(classified(&file), expected, "{name}");
    }
}

#[test]
fn hulls_of_meshes_are_not_there() {
    let found = |name: &str| by_name(&["SM_Chair", "Wall.001", "UCX_Lamp", "Box"], name);
    for name in ["UCX_SM_Chair", "UCX_SM_Chair_01", "UBX_Wall.001", "USP_Wall.001_2", "UCP_Box.003", "UCX_Box_a_b"] {
        assert_eq!(found(name).0, Some(Role::Ignore), "{name}");
    }
    // Of no mesh of the file: UCX_Lamp is a hull itself.
    for name in ["UCX_Lamp", "UCX_SM", "UCX_", "UBX_Wall", "UCX_Boxes", "USP_box"] {
        assert_eq!(found(name).0, Some(Role::SeeThrough), "{name}");
    }
    for name in ["ucx_Box", "Box", "A UCX_Box", "UCX"] {
        assert_eq!(found(name).0, None, "{name}");
    }
    assert_eq!(found("Wall-noimp"), (Some(Role::SeeThrough), Some("a name with noimp".to_owned())));
}
