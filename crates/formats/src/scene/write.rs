//! Scenes in space as GLB.

use super::Simplification;
use sightlines_cells::{Point3, Scene, SceneObject};
use sightlines_geometry::Aabb;
use std::fmt::{Arguments, Write};

/// Why a scene cannot be written as GLB or OBJ.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SceneWriteError {
    /// GLB holds single precision, and the coordinate needs more.
    #[error("object {object}, vertex {vertex}: {value:?} is not a number of single precision")]
    Precision {
        /// Index of the object.
        object: usize,
        /// Index of the vertex in it.
        vertex: usize,
        /// The coordinate.
        value: f64,
    },
    /// glTF has no meshes without corners.
    #[error("object {object} has no vertices")]
    Empty {
        /// Index of the object.
        object: usize,
    },
    /// An OBJ cannot hold an object.
    #[error("object {object}: an OBJ cannot hold {what}")]
    Obj {
        /// Index of the object.
        object: usize,
        /// What of it.
        what: &'static str,
    },
    /// A GLB has at most 4 GiB.
    #[error("{len} bytes are too many for a GLB")]
    TooLarge {
        /// Bytes of the file.
        len: usize,
    },
}

/// Writes a scene as GLB: a node, a mesh and a primitive per object, without transforms.
///
/// Reading it again gives the same objects in the same order with the same triangles; corners that no
/// triangle uses are gone then, unless the object has no triangles at all: its corners are written as points. Objects that
/// hide nothing get a material with `alphaMode` `BLEND`, those that are seen from both sides one that is `doubleSided`. Of those that move
/// the shape at rest is written, and extras that state that they move: read again, they may be anywhere.
///
/// # Errors
/// [`SceneWriteError`]: a coordinate that single precision cannot hold exactly is refused, not rounded.
pub fn write_glb(scene: &Scene) -> Result<Vec<u8>, SceneWriteError> {
    Ok(write(scene, Numbers::Exact, None)?.0)
}

/// As [`write_glb`], of a scene that has fewer triangles than the one that it was made from, and says so.
///
/// # Errors
/// As [`write_glb`].
pub fn write_simplified_glb(scene: &Scene, simplified: Simplification) -> Result<Vec<u8>, SceneWriteError> {
    Ok(write(scene, Numbers::Exact, Some(simplified))?.0)
}

/// What rounding to single precision changed.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Rounding {
    /// How many coordinates are others than before.
    pub n_coordinates: u64,
    /// The largest change of a coordinate, in scene units.
    pub largest: f64,
}

/// As [`write_simplified_glb`], but coordinates that single precision cannot hold are rounded to the nearest that it can; also returns
/// what that changed. Without such coordinates the bytes are the same.
///
/// * `around`: a box around the scene, or around the one that it is a part of. If its middle is farther from the origin than the box is
///   wide, along an axis, all nodes get a translation to about there, so that less is rounded. Corners in one place stay in one.
///
/// Surfaces move by rounding, so a rounded scene states that it must not be used to hide. Triangles may lose their area.
///
/// # Errors
/// As [`write_glb`], but for coordinates only those beyond the largest of single precision.
pub fn write_rounded_glb(
    scene: &Scene,
    around: &Aabb<3>,
    simplified: Simplification,
) -> Result<(Vec<u8>, Rounding), SceneWriteError> {
    let mut coordinates = scene.objects().iter().flat_map(|o| o.vertices.iter().flatten());
    if coordinates.all(|&value| f64::from(value as f32) == value) {
        return write(scene, Numbers::Exact, Some(simplified));
    }
    let offset = [0, 1, 2].map(|k| {
        let (min, max) = (around.min[k], around.max[k]);
        let middle = f64::from((min / 2.0 + max / 2.0).round() as f32);
        if middle.is_finite() && middle.abs() > max - min { middle } else { 0.0 }
    });
    write(scene, Numbers::Rounded { offset }, Some(simplified))
}

#[derive(Debug, Clone, Copy, Default)]
enum Numbers {
    /// As they are, or not at all.
    #[default]
    Exact,
    /// Rounded, with nodes at `offset`.
    Rounded { offset: Point3 },
}

impl Numbers {
    fn offset(self) -> Point3 {
        if let Self::Rounded { offset } = self { offset } else { [0.0; 3] }
    }
}

fn write(
    scene: &Scene,
    numbers: Numbers,
    simplified: Option<Simplification>,
) -> Result<(Vec<u8>, Rounding), SceneWriteError> {
    let mut parts = Parts { numbers, ..Parts::default() };
    for (k, object) in scene.objects().iter().enumerate() {
        parts.add(scene, k, object)?;
    }
    let rounding = parts.rounding;
    let is_rounded = rounding.n_coordinates > 0;
    let simplified = simplified.map(|s| Simplification { occluder: s.occluder && !is_rounded });
    Ok((parts.into_glb(simplified)?, rounding))
}

/// A list of the document: elements as JSON texts, with commas between.
#[derive(Debug, Default)]
struct List {
    text: String,
    n: usize,
}

impl List {
    /// Appends an element; returns its index.
    fn push(&mut self, element: Arguments<'_>) -> usize {
        let comma = if self.n == 0 { "" } else { "," };
        write!(self.text, "{comma}{element}").expect("a string takes any text");
        self.n += 1;
        self.n - 1
    }
}

fn json(value: &impl serde::Serialize) -> String {
    serde_json::to_string(value).expect("texts and finite numbers are JSON")
}

fn member(name: &str, value: Option<String>) -> String {
    value.map_or_else(String::new, |value| format!(",\"{name}\":{value}"))
}

#[derive(Debug, Default)]
struct Parts {
    numbers: Numbers,
    rounding: Rounding,
    nodes: List,
    meshes: List,
    materials: Vec<&'static str>,
    accessors: List,
    views: List,
    binary: Vec<u8>,
}

impl Parts {
    fn add(&mut self, scene: &Scene, k: usize, object: &SceneObject) -> Result<(), SceneWriteError> {
        let id = u32::try_from(k);
        let position = self.positions(k, object)?;
        let is_front = id.is_ok_and(|k| scene.hides_from_front(k));
        let hides = is_front || id.is_ok_and(|k| scene.is_opaque(k));
        let material = match (hides, is_front || id.is_ok_and(|k| scene.is_single_sided(k))) {
            // What holds where no material is stated.
            (true, true) => None,
            (true, false) => Some(r#"{"doubleSided":true}"#),
            (false, true) => Some(r#"{"alphaMode":"BLEND"}"#),
            (false, false) => Some(r#"{"alphaMode":"BLEND","doubleSided":true}"#),
        };
        let material = material.map(|material| self.material(material));
        let indices = (!object.triangles.is_empty()).then(|| self.indices(object));
        let mode = if indices.is_some() { 4 } else { 0 };
        let [indices, material] = [("indices", indices), ("material", material)]
            .map(|(name, index)| member(name, index.map(|k| k.to_string())));
        let attributes = format_args!(r#""attributes":{{"POSITION":{position}}}"#);
        let mesh =
            self.meshes.push(format_args!(r#"{{"primitives":[{{{attributes}{indices},"mode":{mode}{material}}}]}}"#));
        let offset = self.numbers.offset();
        let translation = member("translation", (offset != [0.0; 3]).then(|| json(&offset)));
        let is_mirror = id.is_ok_and(|k| scene.mirrors().binary_search(&k).is_ok());
        let moves = id.is_ok_and(|k| scene.moving().binary_search_by_key(&k, |moving| moving.object).is_ok());
        let stated = match (is_mirror, moves) {
            (false, false) => None,
            (true, false) => Some(r#""role":"mirror""#),
            (false, true) => Some(r#""moves":true"#),
            (true, true) => Some(r#""role":"mirror","moves":true"#),
        };
        let extras = member("extras", stated.map(|stated| format!(r#"{{"sightlines":{{{stated}}}}}"#)));
        self.nodes.push(format_args!(r#"{{"name":{},"mesh":{mesh}{translation}{extras}}}"#, json(&object.name)));
        Ok(())
    }

    fn material(&mut self, material: &'static str) -> usize {
        let known = self.materials.iter().position(|&m| m == material);
        known.unwrap_or_else(|| {
            self.materials.push(material);
            self.materials.len() - 1
        })
    }

    fn positions(&mut self, object: usize, o: &SceneObject) -> Result<usize, SceneWriteError> {
        if o.vertices.is_empty() {
            return Err(SceneWriteError::Empty { object });
        }
        let (mut min, mut max) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
        let start = self.binary.len();
        let offset = self.numbers.offset();
        for (vertex, p) in o.vertices.iter().enumerate() {
            for (axis, &value) in p.iter().enumerate() {
                let single = (value - offset[axis]) as f32;
                // As readers in double precision place it.
                let change = (f64::from(single) + offset[axis] - value).abs();
                if change != 0.0 {
                    // What is too large for single precision has an infinite change.
                    if matches!(self.numbers, Numbers::Exact) || !change.is_finite() {
                        return Err(SceneWriteError::Precision { object, vertex, value });
                    }
                    self.rounding.n_coordinates += 1;
                    self.rounding.largest = self.rounding.largest.max(change);
                }
                (min[axis], max[axis]) = (min[axis].min(single), max[axis].max(single));
                self.binary.extend_from_slice(&single.to_le_bytes());
            }
        }
        let bounds = format_args!(r#""min":{},"max":{}"#, json(&min), json(&max));
        // 34962 is an array of vertices, 5126 single precision.
        let (view, n) = (self.view(start, 34962), o.vertices.len());
        Ok(self
            .accessors
            .push(format_args!(r#"{{"bufferView":{view},"componentType":5126,"count":{n},"type":"VEC3",{bounds}}}"#)))
    }

    fn indices(&mut self, o: &SceneObject) -> usize {
        let start = self.binary.len();
        // The largest index of each size restarts a strip and is not allowed.
        let short = o.vertices.len() <= usize::from(u16::MAX);
        for &index in o.triangles.iter().flatten() {
            let bytes = index.to_le_bytes();
            self.binary.extend_from_slice(if short { &bytes[..2] } else { &bytes });
        }
        // 34963 is an array of indices, 5123 and 5125 are integers of 16 and 32 bits.
        let (view, n) = (self.view(start, 34963), 3 * o.triangles.len());
        let component = if short { 5123 } else { 5125 };
        self.accessors
            .push(format_args!(r#"{{"bufferView":{view},"componentType":{component},"count":{n},"type":"SCALAR"}}"#))
    }

    fn view(&mut self, offset: usize, target: u32) -> usize {
        let len = self.binary.len() - offset;
        // The next view has to begin at a multiple of four.
        self.binary.resize(self.binary.len().next_multiple_of(4), 0);
        let bytes = format_args!(r#""byteOffset":{offset},"byteLength":{len}"#);
        self.views.push(format_args!(r#"{{"buffer":0,{bytes},"target":{target}}}"#))
    }

    fn into_glb(self, simplified: Option<Simplification>) -> Result<Vec<u8>, SceneWriteError> {
        let stated = |s: Simplification| format!(r#"{{"sightlines":{{"simplified":{{"occluder":{}}}}}}}"#, s.occluder);
        let extras = member("extras", simplified.map(stated));
        let roots: Vec<String> = (0..self.nodes.n).map(|node| node.to_string()).collect();
        let asset = format_args!(r#"{{"version":"2.0"{extras}}}"#);
        let mut text = format!(r#"{{"asset":{asset},"scene":0,"scenes":[{{"nodes":[{}]}}]"#, roots.join(","));
        let buffers = (!self.binary.is_empty()).then(|| format!(r#"{{"byteLength":{}}}"#, self.binary.len()));
        let lists = [
            ("nodes", self.nodes.text),
            ("meshes", self.meshes.text),
            ("materials", self.materials.join(",")),
            ("accessors", self.accessors.text),
            ("bufferViews", self.views.text),
            ("buffers", buffers.unwrap_or_default()),
        ];
        // glTF has no empty lists.
        for (name, list) in lists.iter().filter(|(_, list)| !list.is_empty()) {
            text.extend([",\"", *name, "\":[", list, "]"]);
        }
        text.push('}');
        container(text.into_bytes(), &self.binary).map_err(|len| SceneWriteError::TooLarge { len })
    }
}

/// A GLB of a text and a binary chunk, which is left out if it is empty; or its length, if that is more than 4 GiB.
pub(super) fn container(mut text: Vec<u8>, binary: &[u8]) -> Result<Vec<u8>, usize> {
    text.resize(text.len().next_multiple_of(4), b' ');
    let padding = binary.len().next_multiple_of(4) - binary.len();
    let mut glb = Vec::with_capacity(28 + text.len() + binary.len() + padding);
    glb.extend_from_slice(b"glTF\x02\0\0\0\0\0\0\0");
    for (kind, content, padding) in [(b"JSON", &text[..], 0), (b"BIN\0", binary, padding)] {
        if !content.is_empty() {
            // A chunk longer than its length can say makes the file too long as well.
            glb.extend_from_slice(&((content.len() + padding) as u32).to_le_bytes());
            glb.extend_from_slice(kind);
            glb.extend_from_slice(content);
            glb.resize(glb.len() + padding, 0);
        }
    }
    let len = u32::try_from(glb.len()).map_err(|_| glb.len())?;
    glb[8..12].copy_from_slice(&len.to_le_bytes());
    Ok(glb)
}
