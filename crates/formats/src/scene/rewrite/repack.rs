//! Accessors, buffer views and one buffer, without what nothing refers to.

use super::RewriteError;
use super::copies::{Layout, NewAccessor, Original, dense};
use super::document::{
    Object, Visit, as_index, as_object, attributes, for_each_accessor, for_each_view, list, put_list,
};
use super::images::{OutsideImage, put};
use crate::error::Within;
use crate::scene::accessor::{AccessorRole, Elements, no_view};
use crate::scene::buffers::missing;
use serde_json::{Value, json};

/// Puts all data together.
///
/// * `old`: the accessors of the document; `new`: those whose indices follow.
/// * `keep_all`: accessors and buffer views of the document stay in their places.
/// * returns the binary chunk.
pub(super) fn repack(
    root: &mut Object,
    original: Original<'_>,
    old: &[Value],
    new: Vec<NewAccessor>,
    outside: &[OutsideImage],
    keep_all: bool,
) -> Result<Vec<u8>, RewriteError> {
    let n_views = list(root, "bufferViews")?.len();
    let mut used = vec![keep_all; old.len()];
    used.resize(old.len() + new.len(), true);
    for_each_accessor(root, &mut |value| {
        let accessor = as_index(value, "an accessor")?;
        let missing = || missing().within(format_args!("accessor {accessor}"));
        *used.get_mut(accessor).ok_or_else(missing)? = true;
        Ok(())
    })?;
    let mut direct = vec![keep_all; n_views];
    outside_of_accessors(root, &mut |value| mark(value, &mut direct))?;

    let fates = fates(root, original, old, &used, direct.clone())?;
    let mut kept = direct;
    for accessor in (0..old.len()).filter(|&a| matches!(fates[a], Fate::Same)) {
        views_of(&old[accessor], &mut kept)?;
    }

    let mut packed = Packed::default();
    let mut view_map = vec![None; n_views];
    let views = list(root, "bufferViews")?;
    for view in (0..n_views).filter(|&v| kept[v]) {
        let bytes = original.bytes(view).within(format_args!("buffer view {view}"))?;
        let json = as_object(&mut views[view], format_args!("bufferViews[{view}]"))?;
        // Whatever is aligned in it stays so.
        let offset = original.document.buffer_views[view].byte_offset;
        view_map[view] = Some(packed.view(std::mem::take(json), bytes, offset % 8)?);
    }
    let mut accessors = Vec::new();
    let mut accessor_map = vec![None; used.len()];
    let remap_view = |value: &mut Value| {
        let view = as_index(value, "bufferView")?;
        let missing = || no_view(view).within(format_args!("buffer view {view}"));
        *value = json!(view_map.get(view).copied().flatten().ok_or_else(missing)?);
        Ok(())
    };
    let fates = fates.into_iter().chain(new.into_iter().map(Fate::New));
    for (accessor, fate) in fates.enumerate() {
        let json = match fate {
            Fate::Gone => continue,
            Fate::Same => {
                let mut json = old[accessor].clone();
                for_each_view(&mut json, &mut |value| remap_view(value))?;
                json
            }
            Fate::New(NewAccessor { mut json, bytes, view }) => {
                json.insert("bufferView".to_owned(), json!(packed.view(view, &bytes, 0)?));
                Value::Object(json)
            }
        };
        accessor_map[accessor] = Some(accessors.len());
        accessors.push(json);
    }
    outside_of_accessors(root, &mut |value| remap_view(value))?;
    for_each_accessor(root, &mut |value| {
        let accessor = as_index(value, "an accessor")?;
        *value = json!(accessor_map[accessor].expect("what is used stays"));
        Ok(())
    })?;
    for image in outside {
        let view = packed.view(Object::new(), &image.bytes, 0)?;
        put(root, image, view);
    }
    let buffers = if packed.binary.is_empty() { Vec::new() } else { vec![json!({"byteLength": packed.binary.len()})] };
    for (key, list) in [("accessors", accessors), ("bufferViews", packed.views), ("buffers", buffers)] {
        put_list(root, key, list);
    }
    Ok(packed.binary)
}

#[derive(Debug)]
enum Fate {
    Gone,
    /// With its buffer views.
    Same,
    /// With its bytes alone.
    New(NewAccessor),
}

/// Decides what becomes of the document's accessors: a used accessor stays in its buffer view if everything in that
/// view stays, and is moved out of it otherwise.
///
/// * `whole`: the buffer views that stay in any case.
fn fates(
    root: &mut Object,
    original: Original<'_>,
    old: &[Value],
    used: &[bool],
    mut whole: Vec<bool>,
) -> Result<Vec<Fate>, RewriteError> {
    let is_vertices = vertex_accessors(root, old.len())?;
    // Views in which something is that goes.
    let mut partial = vec![false; whole.len()];
    for accessor in (0..old.len()).filter(|&a| !used[a]) {
        // What is not used may be wrong.
        let _ = views_of(&old[accessor], &mut partial);
    }
    let elements =
        |accessor: usize| Elements::new(original.document, original.buffers, accessor, AccessorRole::Attribute).ok();
    let is_partial = |accessor: usize, whole: &[bool]| -> Result<bool, RewriteError> {
        let mut is_partial = false;
        for_each_view(&mut old[accessor].clone(), &mut |value| {
            let view = as_index(value, "bufferView")?;
            is_partial |= partial.get(view) == Some(&true) && !whole[view];
            Ok(())
        })?;
        Ok(is_partial)
    };
    // What is not understood stays where it is.
    for accessor in (0..old.len()).filter(|&a| used[a]) {
        if is_partial(accessor, &whole)? && elements(accessor).is_none() {
            views_of(&old[accessor], &mut whole)?;
        }
    }
    let mut n_bytes = 0_usize;
    let fate = |accessor: usize| {
        if !used[accessor] {
            return Ok(Fate::Gone);
        }
        match elements(accessor) {
            Some(elements) if is_partial(accessor, &whole)? => {
                let layout = if is_vertices[accessor] { Layout::Vertices } else { Layout::Packed };
                let all = 0..elements.count;
                // A small file may name the same bytes very often.
                n_bytes = n_bytes.saturating_add(elements.count.saturating_mul(elements.size));
                RewriteError::check_size(n_bytes)?;
                dense(old, accessor, &elements, all, elements.count, layout).map(Fate::New)
            }
            _ => Ok(Fate::Same),
        }
    };
    (0..old.len()).map(fate).collect()
}

fn vertex_accessors(root: &mut Object, n_accessors: usize) -> Result<Vec<bool>, RewriteError> {
    let mut is_vertices = vec![false; n_accessors];
    for mesh in list(root, "meshes")?.iter_mut().filter_map(Value::as_object_mut) {
        for primitive in list(mesh, "primitives")? {
            for (_, accessor) in attributes(primitive)? {
                let accessor = as_index(accessor, "an accessor")?;
                if let Some(is_vertices) = is_vertices.get_mut(accessor) {
                    *is_vertices = true;
                }
            }
        }
    }
    Ok(is_vertices)
}

fn outside_of_accessors(root: &mut Object, visit: Visit<'_>) -> Result<(), RewriteError> {
    for (key, value) in root {
        if !matches!(key.as_str(), "accessors" | "bufferViews" | "buffers" | "extras") {
            for_each_view(value, visit)?;
        }
    }
    Ok(())
}

fn views_of(accessor: &Value, marks: &mut [bool]) -> Result<(), RewriteError> {
    // Accessors are small, and references are only visited in what may be changed.
    for_each_view(&mut accessor.clone(), &mut |value| mark(value, marks))
}

fn mark(value: &mut Value, marks: &mut [bool]) -> Result<(), RewriteError> {
    let view = as_index(value, "bufferView")?;
    let missing = || no_view(view).within(format_args!("buffer view {view}"));
    *marks.get_mut(view).ok_or_else(missing)? = true;
    Ok(())
}

#[derive(Debug, Default)]
struct Packed {
    binary: Vec<u8>,
    views: Vec<Value>,
}

impl Packed {
    /// Appends bytes at an offset that has `rest` when divided by eight; returns the index of their view.
    fn view(&mut self, mut json: Object, bytes: &[u8], rest: usize) -> Result<usize, RewriteError> {
        let len = self.binary.len();
        let offset = len + (rest + 8 - len % 8) % 8;
        let end = offset.saturating_add(bytes.len());
        RewriteError::check_size(end)?;
        self.binary.resize(offset, 0);
        self.binary.extend_from_slice(bytes);
        json.insert("buffer".to_owned(), json!(0));
        json.insert("byteOffset".to_owned(), json!(offset));
        json.insert("byteLength".to_owned(), json!(bytes.len()));
        self.views.push(Value::Object(json));
        Ok(self.views.len() - 1)
    }
}
