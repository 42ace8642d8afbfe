//! Finding one's way in a document that is kept as it was.
//!
//! The document was read before, but readers are more lenient than writers may be: what was skipped may have any form.

use super::RewriteError;
use crate::error::malformed;
use serde_json::{Map, Value};
use std::fmt::Display;

pub(super) type Object = Map<String, Value>;

pub(super) type Visit<'a> = &'a mut dyn FnMut(&mut Value) -> Result<(), RewriteError>;

pub(super) fn form(place: impl Display, expected: &str) -> RewriteError {
    malformed!("{place} is not {expected}").into()
}

pub(super) fn as_object(value: &mut Value, place: impl Display) -> Result<&mut Object, RewriteError> {
    value.as_object_mut().ok_or_else(|| form(place, "an object"))
}

pub(super) fn as_index(value: &Value, place: impl Display) -> Result<usize, RewriteError> {
    crate::json::as_index(value).ok_or_else(|| form(place, "an index"))
}

pub(super) fn list<'v>(object: &'v mut Object, key: &str) -> Result<&'v mut [Value], RewriteError> {
    match object.get_mut(key) {
        None | Some(Value::Null) => Ok(&mut []),
        Some(Value::Array(list)) => Ok(list),
        Some(_) => Err(form(key, "a list")),
    }
}

/// Puts a list where there may be one; glTF has no empty ones.
pub(super) fn put_list(object: &mut Object, key: &str, list: Vec<Value>) {
    object.remove(key);
    if !list.is_empty() {
        object.insert(key.to_owned(), Value::Array(list));
    }
}

/// The accessors of a primitive's attributes and of its morph targets, with the names of the attributes.
pub(super) fn attributes(primitive: &mut Value) -> Result<Vec<(&str, &mut Value)>, RewriteError> {
    let mut found = Vec::new();
    for (key, value) in as_object(primitive, "primitive")? {
        let (lists, place) = match (key.as_str(), value) {
            (_, Value::Null) => continue,
            ("attributes", value) => (std::slice::from_mut(value), "attributes"),
            ("targets", Value::Array(targets)) => (targets.as_mut_slice(), "target"),
            ("targets", _) => return Err(form("targets", "a list")),
            _ => continue,
        };
        for named in lists {
            found.extend(as_object(named, place)?.iter_mut().map(|(name, accessor)| (name.as_str(), accessor)));
        }
    }
    found.retain(|(_, accessor)| !accessor.is_null());
    Ok(found)
}

pub(super) fn for_each_accessor(document: &mut Object, visit: Visit<'_>) -> Result<(), RewriteError> {
    for (k, animation) in list(document, "animations")?.iter_mut().enumerate() {
        for sampler in list(as_object(animation, format_args!("animations[{k}]"))?, "samplers")? {
            let sampler = as_object(sampler, format_args!("animations[{k}].samplers"))?;
            visit_member(sampler, "input", visit)?;
            visit_member(sampler, "output", visit)?;
        }
    }
    for (k, skin) in list(document, "skins")?.iter_mut().enumerate() {
        visit_member(as_object(skin, format_args!("skins[{k}]"))?, "inverseBindMatrices", visit)?;
    }
    for (k, mesh) in list(document, "meshes")?.iter_mut().enumerate() {
        for primitive in list(as_object(mesh, format_args!("meshes[{k}]"))?, "primitives")? {
            if let Some(primitive) = primitive.as_object_mut() {
                visit_member(primitive, "indices", visit)?;
            }
            for (_, accessor) in attributes(primitive)? {
                visit(accessor)?;
            }
        }
    }
    Ok(())
}

fn visit_member(object: &mut Object, key: &str, visit: Visit<'_>) -> Result<(), RewriteError> {
    object.get_mut(key).filter(|value| !value.is_null()).map_or(Ok(()), visit)
}

/// Visits each index of a buffer view in a value, extensions included, extras not.
pub(super) fn for_each_view(value: &mut Value, visit: Visit<'_>) -> Result<(), RewriteError> {
    match value {
        Value::Array(list) => list.iter_mut().try_for_each(|value| for_each_view(value, visit)),
        Value::Object(object) => object.iter_mut().try_for_each(|(key, value)| match key.as_str() {
            "extras" => Ok(()),
            "bufferView" if value.is_null() => Ok(()),
            "bufferView" => visit(value),
            _ => for_each_view(value, visit),
        }),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn references_are_found_where_they_stand() {
        let mut document = json!({
            "extras": {"bufferView": 77},
            "images": [{"bufferView": 3}, {"uri": "x", "extensions": {"X": [{"bufferView": 4, "extras": {"bufferView": 9}}]}}],
            "animations": [{"samplers": [{"input": 10, "output": 11}]}], "skins": [{"inverseBindMatrices": 12}, {}],
            "meshes": [{"primitives": [{"indices": 13, "attributes": {"A": 14}, "targets": [{"B": 15}]}, {"mode": 1}]}]
        });
        let (mut views, mut accessors) = (Vec::new(), Vec::new());
        let into = |list: &mut Vec<usize>, value: &Value| {
            list.push(as_index(value, "")?);
            Ok(())
        };
        for_each_view(&mut document, &mut |v| into(&mut views, v)).unwrap();
        for_each_accessor(document.as_object_mut().unwrap(), &mut |v| into(&mut accessors, v)).unwrap();
        accessors.sort_unstable();
        assert_eq!((views, accessors), (vec![3, 4], vec![10, 11, 12, 13, 14, 15]));
    }

    #[test]
    fn other_forms_are_refused() {
        for text in [r#"{"meshes": 3}"#, r#"{"meshes": [[]]}"#, r#"{"meshes": [{"primitives": [[{"A": 1}]]}]}"#] {
            let mut document: Value = serde_json::from_str(text).unwrap();
            let found = for_each_accessor(document.as_object_mut().unwrap(), &mut |_| Ok(()));
            assert!(matches!(found, Err(RewriteError::Malformed(_))), "{text}: {found:?}");
        }
    }
}
