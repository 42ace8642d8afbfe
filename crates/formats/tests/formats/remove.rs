//! Objects taken out of documents: what goes, and that all else stays byte for byte.

use crate::common::glb::{Doc, small_doc};
use serde_json::{Value, json};
use sightlines_formats::scene::{Removal, parse_glb, parse_glb_with_source};

/// A document with three nodes of one mesh with two primitives, of which one is below another, and things that have to stay.
fn three_nodes() -> Doc {
    let mut doc = small_doc();
    let primitive = doc.json["meshes"][0]["primitives"][0].clone();
    doc.json["meshes"] = json!([{"name": "pair", "primitives": [primitive.clone(), primitive.clone()], "extras": {"z": 1.50, "a": [1, 2]}}]);
    doc.json["nodes"] = json!([
        {"name": "first", "mesh": 0, "children": [1], "extras": {"keep": "this"}},
        {"name": "second", "mesh": 0, "translation": [0, 0, 5]},
        {"name": "third", "mesh": 0, "translation": [0, 0, 9], "extensions": {"KHR_node_visibility": {"visible": true}}}
    ]);
    doc.json["scenes"] = json!([{"nodes": [0, 2]}]);
    doc.json["scene"] = json!(0);
    doc
}

fn chunks(glb: &[u8]) -> (Value, String, Vec<u8>) {
    let size = |at: usize| u32::from_le_bytes(glb[at..at + 4].try_into().unwrap()) as usize;
    let (whole, text) = (size(8), size(12));
    assert_eq!(whole, glb.len());
    let json = std::str::from_utf8(&glb[20..20 + text]).unwrap();
    (serde_json::from_str(json).unwrap(), json.trim_end().to_owned(), glb[20 + text..].to_vec())
}

fn without(doc: &Doc, objects: &[bool], how: Removal) -> (Value, Vec<bool>, Vec<String>) {
    let before = doc.glb();
    let (_, source) = parse_glb_with_source(before.clone(), None).unwrap();
    let removed = source.without(objects, how).unwrap();
    let (json, _, rest) = chunks(&removed.bytes);
    assert_eq!(rest, chunks(&before).2, "other chunks are as they were");
    let names = match parse_glb(&removed.bytes, None) {
        Ok(file) => file.scene.objects().iter().filter(|o| !o.triangles.is_empty()).map(|o| o.name.clone()).collect(),
        Err(error) => panic!("{error}"),
    };
    (json, removed.stay, names)
}

#[test]
fn nodes_lose_their_meshes_or_parts_of_them() {
    let doc = three_nodes();
    let nothing = without(&doc, &[false; 6], Removal::Delete);
    assert_eq!((nothing.0, nothing.1), (doc.json.clone(), vec![false; 6]));
    // All of the first, half of the second.
    let (json, stay, names) = without(&doc, &[true, true, true, false, false, false], Removal::Delete);
    assert_eq!((names, stay), (["second", "third", "third#1"].map(str::to_owned).to_vec(), vec![false; 6]));
    let mut expected = doc.json.clone();
    expected["nodes"][0].as_object_mut().unwrap().remove("mesh");
    expected["nodes"][1]["mesh"] = json!(1);
    let mut half = expected["meshes"][0].clone();
    half["primitives"].as_array_mut().unwrap().remove(0);
    expected["meshes"].as_array_mut().unwrap().push(half);
    assert_eq!(json, expected);
    // If all want the same, the mesh itself is changed.
    let (json, _, names) = without(&doc, &[true, false, true, false, true, false], Removal::Delete);
    assert_eq!((names.len(), json["meshes"].as_array().unwrap().len()), (3, 1));
    assert_eq!(json["meshes"][0]["primitives"].as_array().unwrap().len(), 1);
    assert!(source_error(&doc).contains("1 objects for a scene of 6"));
}

fn source_error(doc: &Doc) -> String {
    parse_glb_with_source(doc.glb(), None).unwrap().1.without(&[true], Removal::Delete).unwrap_err().to_string()
}

#[test]
fn nodes_are_made_invisible_where_nothing_of_them_is_seen() {
    let doc = three_nodes();
    // Below the first is something that is seen.
    let (json, stay, _) = without(&doc, &[true, true, true, false, true, true], Removal::Flag);
    assert_eq!(stay, [true, true, true, false, false, false]);
    let mut expected = doc.json.clone();
    expected["nodes"][2]["extensions"]["KHR_node_visibility"]["visible"] = json!(false);
    expected["extensionsUsed"] = json!(["KHR_node_visibility"]);
    assert_eq!(json, expected);
    let (json, stay, _) = without(&doc, &[true; 6], Removal::Flag);
    assert!(stay.iter().all(|stay| !stay));
    assert_eq!(json["nodes"][0]["extensions"], json!({"KHR_node_visibility": {"visible": false}}));
    // What is in another scene as well stays.
    let mut scenes = doc.clone();
    scenes.json["scenes"] = json!([{"nodes": [0, 2]}, {"nodes": [2]}]);
    let (json, stay, _) = without(&scenes, &[true; 6], Removal::Delete);
    assert_eq!((stay, json["nodes"][2]["mesh"].clone()), (vec![false, false, false, false, true, true], json!(0)));
    // A lamp below it is not to go out.
    let mut lamp = doc.clone();
    lamp.json["nodes"][1]["extensions"] = json!({"KHR_lights_punctual": {"light": 0}});
    assert_eq!(without(&lamp, &[true; 6], Removal::Flag).1, [true, true, true, true, false, false]);
}

/// What is not changed keeps its spelling: spaces, the order of members, how numbers are written.
#[test]
fn texts_keep_their_spelling() {
    let doc = three_nodes();
    let (_, spelt, _) = chunks(&doc.glb());
    let spelt = spelt.replace("\"extras\":{\"a\":[1,2],\"z\":1.5}", "\"extras\" : {\"z\": 1.500, \"a\":[ 1,2 ]}");
    assert!(spelt.contains("1.500"), "{spelt}");
    let buffer = doc.glb();
    let mut glb = buffer[..12].to_vec();
    let mut text = spelt.clone().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    glb.extend_from_slice(&(text.len() as u32).to_le_bytes());
    glb.extend_from_slice(b"JSON");
    glb.extend_from_slice(&text);
    glb.extend_from_slice(&chunks(&buffer).2);
    let len = glb.len() as u32;
    glb[8..12].copy_from_slice(&len.to_le_bytes());
    let (_, source) = parse_glb_with_source(glb, None).unwrap();
    let removed = source.without(&[true, true, false, false, false, false], Removal::Delete).unwrap();
    let after = chunks(&removed.bytes).1;
    assert_eq!(after, spelt.replacen("\"mesh\":0,", "", 1));
}
