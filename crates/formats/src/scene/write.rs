//! Scenes in space as GLB.

use super::Simplified;
use super::write_error::SceneWriteError;
use serde::Serialize;
use serde_json::{Value, json};
use sightlines_cells::{Point3, Scene, SceneObject};
use sightlines_geometry::Aabb;

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
pub fn write_simplified_glb(scene: &Scene, simplified: Simplified) -> Result<Vec<u8>, SceneWriteError> {
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
    simplified: Simplified,
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

/// How coordinates are written.
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
    simplified: Option<Simplified>,
) -> Result<(Vec<u8>, Rounding), SceneWriteError> {
    let mut parts = Parts { numbers, ..Parts::default() };
    for (k, object) in scene.objects().iter().enumerate() {
        let id = u32::try_from(k);
        let is_mirror = id.is_ok_and(|k| scene.mirrors().binary_search(&k).is_ok());
        let alpha_mode = if id.is_ok_and(|k| scene.is_opaque(k)) { None } else { Some("BLEND") };
        let double_sided = !id.is_ok_and(|k| scene.is_single_sided(k));
        let material = Material { alpha_mode, double_sided };
        let moves = id.is_ok_and(|k| scene.moving().binary_search_by_key(&k, |moving| moving.object).is_ok());
        parts.add(k, object, Marks { is_mirror, moves, material })?;
    }
    let rounding = parts.rounding;
    let is_rounded = rounding.n_coordinates > 0;
    let simplified = simplified.map(|s| Simplified { occluder: s.occluder && !is_rounded });
    Ok((parts.into_glb(simplified)?, rounding))
}

#[derive(Debug, Serialize)]
struct Asset {
    version: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    extras: Option<Value>,
}

#[derive(Debug, Serialize)]
struct Roots {
    nodes: Vec<usize>,
}

#[derive(Debug, Serialize)]
struct Node<'a> {
    name: &'a str,
    mesh: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    translation: Option<Point3>,
    #[serde(skip_serializing_if = "Option::is_none")]
    extras: Option<Extras>,
}

/// What a reader of ours finds about a node.
#[derive(Debug, Serialize)]
struct Extras {
    sightlines: Stated,
}

#[derive(Debug, Serialize)]
struct Stated {
    #[serde(skip_serializing_if = "Option::is_none")]
    role: Option<&'static str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    moves: Option<bool>,
}

/// What an object is in its scene.
#[derive(Debug)]
struct Marks {
    is_mirror: bool,
    moves: bool,
    material: Material,
}

#[derive(Debug, Serialize)]
struct Mesh {
    primitives: [Primitive; 1],
}

#[derive(Debug, Serialize)]
struct Primitive {
    attributes: Attributes,
    #[serde(skip_serializing_if = "Option::is_none")]
    indices: Option<usize>,
    mode: u32,
    #[serde(skip_serializing_if = "Option::is_none")]
    material: Option<usize>,
}

/// The material of objects that are seen alike.
#[derive(Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "camelCase")]
struct Material {
    #[serde(skip_serializing_if = "Option::is_none")]
    alpha_mode: Option<&'static str>,
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    double_sided: bool,
}

#[derive(Debug, Serialize)]
struct Attributes {
    #[serde(rename = "POSITION")]
    position: usize,
}

#[derive(Debug, Serialize)]
#[serde(rename_all = "camelCase")]
struct Accessor {
    buffer_view: usize,
    component_type: u32,
    count: usize,
    #[serde(rename = "type")]
    kind: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    min: Option<[f32; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    max: Option<[f32; 3]>,
}

#[derive(Debug, Serialize)]
#[serde(rename_all = "camelCase")]
struct BufferView {
    buffer: usize,
    byte_offset: usize,
    byte_length: usize,
    target: u32,
}

#[derive(Debug, Serialize)]
#[serde(rename_all = "camelCase")]
struct Buffer {
    byte_length: usize,
}

/// The document; glTF has no empty lists, so what is empty is left out.
#[derive(Debug, Serialize)]
#[serde(rename_all = "camelCase")]
struct Document<'a> {
    asset: Asset,
    scene: usize,
    scenes: [Roots; 1],
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    nodes: &'a [Node<'a>],
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    meshes: &'a [Mesh],
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    materials: &'a [Material],
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    accessors: &'a [Accessor],
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    buffer_views: &'a [BufferView],
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    buffers: &'a [Buffer],
}

#[derive(Debug, Default)]
struct Parts<'a> {
    numbers: Numbers,
    rounding: Rounding,
    nodes: Vec<Node<'a>>,
    meshes: Vec<Mesh>,
    /// All different.
    materials: Vec<Material>,
    accessors: Vec<Accessor>,
    views: Vec<BufferView>,
    binary: Vec<u8>,
}

impl<'a> Parts<'a> {
    fn add(&mut self, k: usize, object: &'a SceneObject, marks: Marks) -> Result<(), SceneWriteError> {
        let position = self.positions(k, object)?;
        let Marks { is_mirror, moves, material } = marks;
        let material = self.material(material);
        let indices = (!object.triangles.is_empty()).then(|| self.indices(object));
        let mode = if indices.is_some() { 4 } else { 0 };
        let primitive = Primitive { attributes: Attributes { position }, indices, mode, material };
        self.meshes.push(Mesh { primitives: [primitive] });
        let stated = Stated { role: is_mirror.then_some("mirror"), moves: moves.then_some(true) };
        let extras = (is_mirror || moves).then_some(Extras { sightlines: stated });
        let translation = Some(self.numbers.offset()).filter(|offset| *offset != [0.0; 3]);
        self.nodes.push(Node { name: &object.name, mesh: self.meshes.len() - 1, translation, extras });
        Ok(())
    }

    /// The index of a material; none for the one that holds where none is stated.
    fn material(&mut self, material: Material) -> Option<usize> {
        if material == (Material { alpha_mode: None, double_sided: false }) {
            return None;
        }
        let known = self.materials.iter().position(|m| *m == material);
        Some(known.unwrap_or_else(|| {
            self.materials.push(material);
            self.materials.len() - 1
        }))
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
        // 5126 is single precision, 34962 an array of vertices.
        let view = self.view(start, 34962);
        let accessor = Accessor {
            buffer_view: view,
            component_type: 5126,
            count: o.vertices.len(),
            kind: "VEC3",
            min: Some(min),
            max: Some(max),
        };
        Ok(self.accessor(accessor))
    }

    fn indices(&mut self, o: &SceneObject) -> usize {
        let start = self.binary.len();
        // The largest index of each size restarts a strip and is not allowed.
        let short = o.vertices.len() <= usize::from(u16::MAX);
        for &index in o.triangles.iter().flatten() {
            let bytes = index.to_le_bytes();
            self.binary.extend_from_slice(if short { &bytes[..2] } else { &bytes });
        }
        // 5123 and 5125 are integers of 16 and 32 bits, 34963 an array of indices.
        let view = self.view(start, 34963);
        let component_type = if short { 5123 } else { 5125 };
        let count = 3 * o.triangles.len();
        self.accessor(Accessor { buffer_view: view, component_type, count, kind: "SCALAR", min: None, max: None })
    }

    fn view(&mut self, byte_offset: usize, target: u32) -> usize {
        let byte_length = self.binary.len() - byte_offset;
        self.views.push(BufferView { buffer: 0, byte_offset, byte_length, target });
        // The next view has to begin at a multiple of four.
        self.binary.resize(self.binary.len().next_multiple_of(4), 0);
        self.views.len() - 1
    }

    fn accessor(&mut self, accessor: Accessor) -> usize {
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    fn into_glb(self, simplified: Option<Simplified>) -> Result<Vec<u8>, SceneWriteError> {
        let buffer = Buffer { byte_length: self.binary.len() };
        let document = Document {
            asset: Asset {
                version: "2.0",
                extras: simplified.map(|s| json!({"sightlines": {"simplified": {"occluder": s.occluder}}})),
            },
            scene: 0,
            scenes: [Roots { nodes: (0..self.nodes.len()).collect() }],
            nodes: &self.nodes,
            meshes: &self.meshes,
            materials: &self.materials,
            accessors: &self.accessors,
            buffer_views: &self.views,
            buffers: if self.binary.is_empty() { &[] } else { std::slice::from_ref(&buffer) },
        };
        let text = serde_json::to_vec(&document).expect("names and finite numbers are JSON");
        container(text, &self.binary).map_err(|len| SceneWriteError::TooLarge { len })
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
