//! Images in files beside a document.

use super::RewriteError;
use super::document::{Object, as_object, list};
use crate::beside::Neighbours;
use crate::scene::buffers::load_file;
use serde_json::{Value, json};
use std::collections::BTreeMap;

#[derive(Debug)]
pub(super) struct OutsideImage {
    pub(super) bytes: Vec<u8>,
    mime: &'static str,
    images: Vec<usize>,
}

/// The images that can be taken along: others keep their URIs.
pub(super) fn outside(
    document: &mut Object,
    beside: Option<&dyn Neighbours>,
) -> Result<Vec<OutsideImage>, RewriteError> {
    let mut by_uri: BTreeMap<String, Vec<usize>> = BTreeMap::new();
    for (k, image) in list(document, "images")?.iter_mut().enumerate() {
        let image = as_object(image, format_args!("images[{k}]"))?;
        match image.get("uri").and_then(Value::as_str) {
            Some(uri) if !image.contains_key("bufferView") => by_uri.entry(uri.to_owned()).or_default().push(k),
            _ => {}
        }
    }
    let load = |(uri, images): (String, Vec<usize>)| {
        // Data URIs, and images elsewhere, are not files below the folder.
        let bytes = load_file(beside, &uri).ok()?;
        let mime = mime_of(&bytes)?;
        Some(OutsideImage { bytes, mime, images })
    };
    Ok(by_uri.into_iter().filter_map(load).collect())
}

pub(super) fn put(document: &mut Object, outside: &OutsideImage, view: usize) {
    let Some(Value::Array(images)) = document.get_mut("images") else { return };
    for &k in &outside.images {
        if let Some(image) = images.get_mut(k).and_then(Value::as_object_mut) {
            image.remove("uri");
            image.insert("bufferView".to_owned(), json!(view));
            image.insert("mimeType".to_owned(), json!(outside.mime));
        }
    }
}

fn mime_of(bytes: &[u8]) -> Option<&'static str> {
    match bytes {
        [0x89, b'P', b'N', b'G', ..] => Some("image/png"),
        [0xFF, 0xD8, 0xFF, ..] => Some("image/jpeg"),
        [b'R', b'I', b'F', b'F', _, _, _, _, b'W', b'E', b'B', b'P', ..] => Some("image/webp"),
        [0xAB, b'K', b'T', b'X', b' ', b'2', b'0', 0xBB, ..] => Some("image/ktx2"),
        _ => None,
    }
}
