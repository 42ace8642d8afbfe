//! Data of vertices, copied without those that are not used.

use super::RewriteError;
use super::document::{Object, as_index, as_object, attributes};
use super::extensions;
use crate::error::{Within, malformed};
use crate::scene::accessor::{AccessorRole, Elements, Views};
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;

/// Numbers of `target`: arrays of vertices and of indices.
const VERTICES: u32 = 34962;
const INDICES: u32 = 34963;

/// A document and its bytes, as they were.
pub(super) type Original<'a> = Views<'a, 'a, 'a>;

#[derive(Debug)]
pub(super) struct NewAccessor {
    /// Without a buffer view.
    pub(super) json: Object,
    pub(super) bytes: Vec<u8>,
    /// Members of its buffer view besides buffer, offset and length.
    pub(super) view: Object,
}

/// What an accessor is for, which decides how its elements may lie.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Layout {
    /// Every element begins at a multiple of four bytes.
    Vertices,
    Packed,
}

/// Accessors to come. Their indices follow those of the document.
#[derive(Debug)]
pub(super) struct Copies<'a> {
    original: Original<'a>,
    old: &'a [Value],
    pub(super) new: Vec<NewAccessor>,
    /// Sets of corners by their elements.
    sets: BTreeMap<Vec<usize>, usize>,
    /// Copies by accessor and set of corners.
    copied: BTreeMap<(usize, usize), usize>,
    n_bytes: usize,
}

impl<'a> Copies<'a> {
    pub(super) fn new(original: Original<'a>, old: &'a [Value]) -> Self {
        let (sets, copied) = (BTreeMap::new(), BTreeMap::new());
        Self { original, old, new: Vec::new(), sets, copied, n_bytes: 0 }
    }

    /// A primitive with other corners.
    ///
    /// * `used`: the corners that it has then, ascending, as indices of its accessors;
    /// * `indices`: into `used`;
    /// * `as_list`: whether these are a list of triangles; otherwise they are drawn as before.
    pub(super) fn primitive(
        &mut self,
        primitive: &Value,
        used: &[usize],
        indices: &[u32],
        as_list: bool,
        place: &str,
    ) -> Result<Value, RewriteError> {
        let mut primitive = primitive.clone();
        let object = as_object(&mut primitive, place)?;
        extensions::adapt(object, place)?;
        if as_list {
            // Without a mode, a list of triangles is drawn.
            object.remove("mode");
        }
        let indices = self.indices(indices, used.len())?;
        object.insert("indices".to_owned(), json!(indices));
        let n_sets = self.sets.len();
        let set = match self.sets.get(used) {
            Some(&set) => set,
            None => *self.sets.entry(used.to_vec()).or_insert(n_sets),
        };
        for (name, accessor) in attributes(&mut primitive)? {
            let old = as_index(accessor, format_args!("{place}: {name}"))?;
            let copy = match self.copied.get(&(old, set)) {
                Some(&copy) => copy,
                None => {
                    let copy = self.attribute(old, used, name == "POSITION")?;
                    self.copied.insert((old, set), copy);
                    copy
                }
            };
            *accessor = json!(copy);
        }
        Ok(primitive)
    }

    fn attribute(&mut self, accessor: usize, used: &[usize], is_position: bool) -> Result<usize, RewriteError> {
        let place = format_args!("accessor {accessor}");
        let Original { document, buffers } = self.original;
        let elements = Elements::new(document, buffers, accessor, AccessorRole::Attribute).within(place)?;
        let count = elements.count;
        if let Some(&index) = used.last().filter(|&&last| last >= count) {
            return Err(malformed!("there is no element {index} of {count}").within(place).into());
        }
        let stride = elements.size.next_multiple_of(4);
        self.count_bytes(used.len().saturating_mul(stride))?;
        let mut new = dense(self.old, accessor, &elements, used.iter().copied(), used.len(), Layout::Vertices)?;
        extensions::adapt(&mut new.json, format_args!("accessors[{accessor}]"))?;
        let had_bounds = ["min", "max"].map(|key| new.json.remove(key).is_some()).contains(&true);
        if is_position || had_bounds {
            put_bounds(&mut new.json, &elements, used);
        }
        self.push(new)
    }

    fn indices(&mut self, indices: &[u32], n_vertices: usize) -> Result<usize, RewriteError> {
        // The largest index of each size restarts a strip and is not allowed.
        let short = n_vertices <= usize::from(u16::MAX);
        let size = if short { 2 } else { 4 };
        self.count_bytes(indices.len().saturating_mul(size))?;
        let bytes = indices.iter().flat_map(|i| i.to_le_bytes().into_iter().take(size)).collect();
        let component = if short { 5123 } else { 5125 };
        let json = object(json!({"componentType": component, "count": indices.len(), "type": "SCALAR"}));
        self.push(NewAccessor { json, bytes, view: object(json!({"target": INDICES})) })
    }

    fn push(&mut self, accessor: NewAccessor) -> Result<usize, RewriteError> {
        self.new.push(accessor);
        Ok(self.old.len() + self.new.len() - 1)
    }

    /// Gives up before memory does: a small file may name the same bytes very often.
    fn count_bytes(&mut self, more: usize) -> Result<(), RewriteError> {
        self.n_bytes = self.n_bytes.saturating_add(more);
        RewriteError::check_size(self.n_bytes)
    }
}

/// Elements of an accessor, one behind the other.
pub(super) fn dense(
    old: &[Value],
    accessor: usize,
    elements: &Elements<'_>,
    which: impl Iterator<Item = usize>,
    count: usize,
    layout: Layout,
) -> Result<NewAccessor, RewriteError> {
    let mut json = old[accessor].clone();
    let members = as_object(&mut json, format_args!("accessors[{accessor}]"))?;
    for key in ["bufferView", "byteOffset", "sparse"] {
        members.remove(key);
    }
    members.insert("count".to_owned(), json!(count));
    let size = elements.size;
    let stride = if layout == Layout::Vertices { size.next_multiple_of(4) } else { size };
    let mut bytes = Vec::with_capacity(count * stride);
    for k in which {
        match elements.get(k) {
            Some(element) => bytes.extend_from_slice(element),
            None => bytes.resize(bytes.len() + size, 0),
        }
        bytes.resize(bytes.len().next_multiple_of(stride), 0);
    }
    let view = match layout {
        Layout::Vertices if stride != size => json!({"byteStride": stride, "target": VERTICES}),
        Layout::Vertices => json!({"target": VERTICES}),
        Layout::Packed => json!({}),
    };
    Ok(NewAccessor { json: std::mem::take(members), bytes, view: object(view) })
}

fn object(value: Value) -> Object {
    match value {
        Value::Object(object) => object,
        _ => Map::new(),
    }
}

/// The least and the largest numbers of elements, unless JSON cannot hold them as numbers.
fn put_bounds(json: &mut Object, elements: &Elements<'_>, used: &[usize]) {
    if json.get("type").and_then(Value::as_str).is_none_or(|kind| kind.starts_with("MAT")) {
        return;
    }
    let mut bounds: Option<(Vec<f64>, Vec<f64>)> = None;
    for &k in used {
        let numbers = elements.numbers(k);
        let (min, max) = bounds.get_or_insert_with(|| (numbers.clone(), numbers.clone()));
        for (axis, &x) in numbers.iter().enumerate() {
            (min[axis], max[axis]) = (min[axis].min(x), max[axis].max(x));
        }
    }
    let Some((min, max)) = bounds else { return };
    // What is not finite has been skipped, or is all there is.
    if min.iter().chain(&max).all(|x| x.is_finite()) {
        let list = |numbers: Vec<f64>| -> Value {
            let number = |x: f64| if elements.component.is_float() { json!(x) } else { json!(x as i64) };
            numbers.into_iter().map(number).collect()
        };
        json.insert("min".to_owned(), list(min));
        json.insert("max".to_owned(), list(max));
    }
}
