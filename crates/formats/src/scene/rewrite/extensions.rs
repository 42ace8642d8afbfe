//! What extensions may refer to.

use super::RewriteError;
use super::document::{Object, as_object, form, list};
use serde_json::Value;
use std::fmt::Display;

/// Extensions that name no accessors, no buffers, and buffer views only by the key `bufferView`.
#[rustfmt::skip]
const KNOWN: [&str; 12] = [
    "AGI_", "EXT_lights_", "EXT_texture_", "FB_ngon_encoding", DRACO, "KHR_lights_", "KHR_materials_",
    "KHR_mesh_quantization", "KHR_node_visibility", "KHR_texture_", "KHR_xmp", "MSFT_",
];
/// Codes a primitive again, beside its accessors.
const DRACO: &str = "KHR_draco_mesh_compression";
/// Says which materials a primitive may have, and nothing of its triangles.
const VARIANTS: &str = "KHR_materials_variants";
/// Code a buffer view again, beside its bytes.
const MESHOPT: [&str; 2] = ["EXT_meshopt_compression", "KHR_meshopt_compression"];

/// Whether an extension that may name accessors or buffer views in a way of its own is used.
///
/// Refuses extensions that name buffers in a way of their own: buffers are merged.
pub(super) fn any_unknown(document: &mut Object) -> Result<bool, RewriteError> {
    for (k, view) in list(document, "bufferViews")?.iter_mut().enumerate() {
        let place = format_args!("bufferViews[{k}]");
        let view = as_object(view, place)?;
        // What codes the same bytes again is not needed.
        remove(view, &MESHOPT);
        if let Some(name) = names(view)?.first() {
            return Err(RewriteError::Extension { place: place.to_string(), name: name.clone() });
        }
    }
    let mut any = false;
    for (key, value) in document.iter().filter(|(key, _)| !matches!(key.as_str(), "bufferViews" | "buffers")) {
        any |= unknown_at(key, value, key)?;
    }
    Ok(any)
}

fn unknown_at(key: &str, value: &Value, place: &str) -> Result<bool, RewriteError> {
    match key {
        "extras" => Ok(false),
        "extensions" => unknown_among(value, place),
        _ => unknown_in(value, place),
    }
}

fn unknown_in(value: &Value, place: &str) -> Result<bool, RewriteError> {
    let mut any = false;
    match value {
        Value::Array(list) => {
            for value in list {
                any |= unknown_in(value, place)?;
            }
        }
        Value::Object(object) => {
            for (key, value) in object {
                any |= unknown_at(key, value, place)?;
            }
        }
        _ => {}
    }
    Ok(any)
}

fn unknown_among(extensions: &Value, place: &str) -> Result<bool, RewriteError> {
    let extensions = extensions.as_object().ok_or_else(|| form(format_args!("extensions of {place}"), "an object"))?;
    let mut any = false;
    for (name, content) in extensions {
        let known = KNOWN.iter().any(|known| name.starts_with(known));
        if !known && has_key(content, "buffer") {
            return Err(RewriteError::Extension { place: place.to_owned(), name: name.clone() });
        }
        any |= !known | unknown_in(content, place)?;
    }
    Ok(any)
}

/// Makes the extensions of a primitive, or of an accessor, fit other corners than those it had.
pub(super) fn adapt(object: &mut Object, place: impl Display) -> Result<(), RewriteError> {
    remove(object, &[DRACO]);
    match names(object)?.into_iter().find(|name| name != VARIANTS) {
        Some(name) => Err(RewriteError::Extension { place: place.to_string(), name }),
        None => Ok(()),
    }
}

fn names(object: &Object) -> Result<Vec<String>, RewriteError> {
    match object.get("extensions") {
        None | Some(Value::Null) => Ok(Vec::new()),
        Some(Value::Object(extensions)) => Ok(extensions.keys().cloned().collect()),
        Some(_) => Err(form("extensions", "an object")),
    }
}

fn remove(object: &mut Object, names: &[&str]) {
    if let Some(Value::Object(extensions)) = object.get_mut("extensions") {
        for name in names {
            extensions.remove(*name);
        }
        if extensions.is_empty() {
            object.remove("extensions");
        }
    }
}

/// Takes the names of codings that were left out off the list of what is used.
pub(super) fn forget_codings(document: &mut Object) {
    let mut gone = MESHOPT.to_vec();
    if !document.iter().any(|(key, value)| key != "extras" && has_key(value, DRACO)) {
        gone.push(DRACO);
    }
    if let Some(Value::Array(used)) = document.get_mut("extensionsUsed") {
        used.retain(|name| !name.as_str().is_some_and(|name| gone.contains(&name)));
        if used.is_empty() {
            document.remove("extensionsUsed");
        }
    }
}

fn has_key(value: &Value, key: &str) -> bool {
    match value {
        Value::Array(list) => list.iter().any(|value| has_key(value, key)),
        Value::Object(object) => object.iter().any(|(k, value)| k == key || has_key(value, key)),
        _ => false,
    }
}
