//! glTF 2.0: from a document to objects in world coordinates.

use super::accessor::Elements;
use super::buffers::{Buffers, split_glb};
use super::build::{Builder, Compact};
use super::error::{AccessorErrorKind, AccessorRole, NodeErrorKind, NodeId, PrimitiveErrorKind, SceneReadError};
use super::json::{Document, Mesh, Node, Primitive, TRIANGLES};
use super::transform::Transform;
use super::{MAX_ELEMENTS, MAX_OBJECTS, MIRROR_SUFFIX, SceneFile, SceneFormat};
use crate::beside::{Folder, Neighbours};
use crate::point::check_point;
use std::path::Path;

pub(crate) use super::buffers::MAGIC;

/// Modes from here on make triangles; those before are points and lines.
pub(super) const FIRST_OF_TRIANGLES: u32 = TRIANGLES;
const TRIANGLE_STRIP: u32 = 5;
const TRIANGLE_FAN: u32 = 6;

/// Extensions that do not change where a triangle is, and quantised meshes, which are understood.
const HARMLESS: [&str; 8] = [
    "EXT_lights_",
    "EXT_texture_",
    "KHR_lights_",
    "KHR_materials_",
    "KHR_mesh_quantization",
    "KHR_texture_",
    "KHR_xmp",
    "MSFT_texture_",
];
/// Draws a mesh many times where a reader that does not know it draws it once; objects would be missing.
const INSTANCING: &str = "EXT_mesh_gpu_instancing";

/// Reads a GLB, or the text of a glTF if it does not begin like a GLB.
///
/// * `folder`: where buffers in files are searched; without it they are refused.
/// * returns the scene at rest: one object per node and primitive of the default scene (the first if none is
///   the default, all trees of nodes if there is no scene), parents before children, children in order, in
///   world coordinates. An object has the name of its node, else of the mesh, else `node N`; primitives
///   after the first add `#1`, `#2` and so on. Faces of mirrored nodes are turned round, as glTF has it.
///
/// Costs time and memory in proportion to the file and to what its instances make of it, which
/// [`MAX_ELEMENTS`] and [`MAX_OBJECTS`] bound.
///
/// # Errors
/// [`SceneReadError`] with node and primitive.
///
/// # Source
/// Khronos Group, glTF 2.0 Specification (ISO/IEC 12113:2022), and KHR_mesh_quantization.
/// Chosen here: extensions that code geometry in another way, skins and morph weights are refused.
pub fn parse_glb(bytes: &[u8], folder: Option<&Path>) -> Result<SceneFile, SceneReadError> {
    let folder = folder.map(|folder| Folder(folder.to_owned()));
    parse_gltf(bytes, folder.as_ref().map(|folder| folder as &dyn Neighbours))
}

/// As [`parse_glb`], with buffers wherever `beside` has them; without it, those in files are refused.
///
/// # Errors
/// As [`parse_glb`].
pub fn parse_gltf(bytes: &[u8], beside: Option<&dyn Neighbours>) -> Result<SceneFile, SceneReadError> {
    parse(bytes, beside, |_| {}).map(|(file, _)| file)
}

/// A node with a mesh, as it is read: what an object comes from, one for each primitive of the mesh.
#[derive(Debug, Clone, Copy)]
pub(super) struct Origin<'a> {
    pub(super) node: usize,
    pub(super) mesh: usize,
    /// Whether triangles are turned round.
    pub(super) mirrors: bool,
    /// The mesh's primitives.
    pub(super) locals: &'a [LocalMesh],
}

/// What was read of buffers outside a file, by buffer.
pub(super) type Loaded = Vec<Option<Vec<u8>>>;

/// Reads a scene, and calls `watch` for each node with a mesh, in the order of objects. Also returns the buffers that
/// were read from other files.
pub(super) fn parse(
    bytes: &[u8],
    beside: Option<&dyn Neighbours>,
    watch: impl FnMut(Origin<'_>),
) -> Result<(SceneFile, Loaded), SceneReadError> {
    let (text, binary) = split(bytes)?;
    let document: Document = serde_json::from_str(text).map_err(|source| SceneReadError::Json { source })?;
    check_understood(&document)?;
    let placed = place_nodes(&document)?;
    check_size(&document, &placed)?;
    let buffers = Buffers::new(&document.buffers, binary, beside);
    let file = build(&document, &buffers, &placed, watch)?.finish(SceneFormat::Gltf)?;
    Ok((file, buffers.into_loaded()))
}

/// The text of a GLB or a glTF, and the binary chunk.
pub(super) fn split(bytes: &[u8]) -> Result<(&str, Option<&[u8]>), SceneReadError> {
    let (text, binary) = if bytes.starts_with(MAGIC) { split_glb(bytes)? } else { (bytes, None) };
    // Some editors begin a text with a byte order mark.
    let text = text.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(text);
    let text = std::str::from_utf8(text).map_err(|e| SceneReadError::Utf8 { offset: e.valid_up_to() })?;
    Ok((text, binary))
}

fn check_understood(document: &Document) -> Result<(), SceneReadError> {
    let version = &document.asset.version;
    if version != "2" && !version.starts_with("2.") {
        return Err(SceneReadError::Version { found: version.clone() });
    }
    let strange = |name: &&String| !HARMLESS.iter().any(|harmless| name.starts_with(harmless));
    let instancing = document.extensions_used.iter().find(|name| *name == INSTANCING);
    match document.extensions_required.iter().find(strange).or(instancing) {
        Some(name) => Err(SceneReadError::Extension { name: name.clone() }),
        None => Ok(()),
    }
}

/// A node that has a mesh, and where it is in the world.
#[derive(Debug)]
struct Placed<'a> {
    index: usize,
    node: &'a Node,
    mesh_idx: usize,
    mesh: &'a Mesh,
    world: Transform,
}

impl Placed<'_> {
    fn id(&self) -> NodeId {
        id_of(self.index, self.node)
    }

    fn given_name(&self) -> Option<&str> {
        self.node.name.as_deref().or(self.mesh.name.as_deref())
    }

    fn name(&self, primitive: usize) -> String {
        let name = self.given_name().map_or_else(|| format!("node {}", self.index), str::to_owned);
        if primitive == 0 { name } else { format!("{name}#{primitive}") }
    }

    /// Whether the node says, by its extras or by its name, that it is a mirror.
    fn is_mirror(&self) -> bool {
        self.node.is_mirror || self.node.name.as_deref().is_some_and(|name| name.ends_with(MIRROR_SUFFIX))
    }

    fn fail(&self, primitive: usize, kind: PrimitiveErrorKind) -> SceneReadError {
        SceneReadError::Primitive { node: self.id(), primitive, kind: Box::new(kind) }
    }
}

fn id_of(index: usize, node: &Node) -> NodeId {
    NodeId { index, name: node.name.as_deref().map(str::to_owned) }
}

/// The nodes where a scene begins.
fn roots(document: &Document) -> Result<Vec<usize>, SceneReadError> {
    let scene = document.scene.unwrap_or(0);
    match document.scenes.get(scene) {
        Some(roots) => match roots.nodes.iter().find(|&&node| node >= document.nodes.len()) {
            Some(&node) => Err(SceneReadError::NoRoot { scene, node }),
            None => Ok(roots.nodes.clone()),
        },
        None if document.scene.is_some() => Err(SceneReadError::NoScene { scene }),
        None => {
            let mut is_child = vec![false; document.nodes.len()];
            for &child in document.nodes.iter().flat_map(|n| &n.children) {
                // A child that does not exist is reported when its parent is placed.
                if let Some(is_child) = is_child.get_mut(child) {
                    *is_child = true;
                }
            }
            Ok((0..is_child.len()).filter(|&node| !is_child[node]).collect())
        }
    }
}

/// All nodes with meshes, parents before children. Keeps its own stack, so depth costs nothing but memory.
fn place_nodes(document: &Document) -> Result<Vec<Placed<'_>>, SceneReadError> {
    let mut reached = vec![false; document.nodes.len()];
    let mut stack: Vec<_> = roots(document)?.into_iter().rev().map(|node| (node, Transform::IDENTITY)).collect();
    let mut placed = Vec::new();
    while let Some((index, parent)) = stack.pop() {
        let node = &document.nodes[index];
        let fail = |kind| SceneReadError::Node { node: id_of(index, node), kind };
        if std::mem::replace(&mut reached[index], true) {
            return Err(fail(NodeErrorKind::ReachedTwice));
        }
        let world = parent.after(&Transform::of_node(node).map_err(fail)?);
        if let Some(mesh_idx) = node.mesh {
            let mesh = document.meshes.get(mesh_idx).ok_or_else(|| fail(NodeErrorKind::NoMesh { mesh: mesh_idx }))?;
            if is_deformed(node, mesh) {
                return Err(fail(NodeErrorKind::Deformed));
            }
            placed.push(Placed { index, node, mesh_idx, mesh, world });
        }
        if let Some(&child) = node.children.iter().find(|&&child| child >= document.nodes.len()) {
            return Err(fail(NodeErrorKind::NoChild { child }));
        }
        stack.extend(node.children.iter().rev().map(|&child| (child, world)));
    }
    Ok(placed)
}

fn is_deformed(node: &Node, mesh: &Mesh) -> bool {
    let weights = node.weights.as_deref().or(mesh.weights.as_deref());
    node.skin.is_some() || weights.is_some_and(|weights| weights.iter().any(|&w| w != 0.0))
}

/// Refuses scenes that are too large before any object is made: a small file can describe a large scene.
fn check_size(document: &Document, placed: &[Placed<'_>]) -> Result<(), SceneReadError> {
    let count = |accessor: usize| document.accessors.get(accessor).map_or(0, |a| a.count);
    let mut sum = [("triangles", 0_usize, MAX_ELEMENTS), ("corners", 0, MAX_ELEMENTS), ("objects", 0, MAX_OBJECTS)];
    for at in placed {
        for (k, primitive) in at.mesh.primitives.iter().enumerate() {
            let n_positions = primitive.attributes.position.map_or(0, count);
            let n = primitive.indices.map_or(n_positions, count);
            // A long name weighs as much as several objects.
            let n_objects = 1 + at.given_name().map_or(0, str::len) / 128;
            for ((what, sum, max), more) in
                sum.iter_mut().zip([n_triangles_of(primitive.mode, n), n.min(n_positions), n_objects])
            {
                *sum = sum.saturating_add(more);
                if *sum > *max {
                    return Err(at.fail(k, PrimitiveErrorKind::TooMany { what, max: *max }));
                }
            }
        }
    }
    Ok(())
}

fn build(
    document: &Document,
    buffers: &Buffers<'_>,
    placed: &[Placed<'_>],
    mut watch: impl FnMut(Origin<'_>),
) -> Result<Builder, SceneReadError> {
    let mut builder = Builder::saying(document.asset.simplified);
    // Meshes by their index, read when the first node has them.
    let mut meshes: Vec<Option<Vec<LocalMesh>>> = Vec::new();
    meshes.resize_with(document.meshes.len(), || None);
    for at in placed {
        let mesh = match &mut meshes[at.mesh_idx] {
            Some(mesh) => mesh,
            unread => {
                let read = |(k, p)| LocalMesh::read(document, buffers, p).map_err(|kind| at.fail(k, kind));
                unread.insert(at.mesh.primitives.iter().enumerate().map(read).collect::<Result<_, _>>()?)
            }
        };
        watch(Origin { node: at.index, mesh: at.mesh_idx, mirrors: at.world.mirrors(), locals: mesh });
        for (k, local) in mesh.iter().enumerate() {
            let world = |(&vertex, &p)| {
                check_point(at.world.apply(p)).map_err(|kind| at.fail(k, PrimitiveErrorKind::Vertex { vertex, kind }))
            };
            let vertices = local.mesh.corners.iter().zip(&local.positions).map(world).collect::<Result<_, _>>()?;
            builder.add(at.name(k), vertices, local.mesh.triangles.iter().copied(), at.world.mirrors());
            if at.is_mirror() {
                builder.mark_mirror();
            }
        }
    }
    Ok(builder)
}

/// A primitive as it is in its mesh.
#[derive(Debug)]
pub(super) struct LocalMesh {
    pub(super) mesh: Compact,
    /// Of each corner of `mesh`.
    positions: Vec<[f64; 3]>,
}

impl LocalMesh {
    fn read(document: &Document, buffers: &Buffers<'_>, primitive: &Primitive) -> Result<Self, PrimitiveErrorKind> {
        let positions = primitive.attributes.position.ok_or(PrimitiveErrorKind::NoPositions)?;
        let elements = |accessor, role| {
            let fail = |kind: AccessorErrorKind| PrimitiveErrorKind::Accessor { role, accessor, kind };
            Elements::new(document, buffers, accessor, role).map_err(fail)
        };
        let positions = elements(positions, AccessorRole::Positions)?;
        let corners = match primitive.indices {
            Some(indices) => read_indices(&elements(indices, AccessorRole::Indices)?, positions.count)?,
            None => (0..positions.count).collect(),
        };
        check_mode(primitive.mode, corners.len())?;
        let n_triangles = n_triangles_of(primitive.mode, corners.len());
        let triangles = (0..n_triangles).map(|k| triangle_of(primitive.mode, k).map(|place| corners[place]));
        let mesh = Compact::new(corners.clone(), triangles);
        let positions = mesh.corners.iter().map(|&k| positions.position(k)).collect();
        Ok(Self { mesh, positions })
    }
}

pub(super) fn read_indices(indices: &Elements<'_>, n_positions: usize) -> Result<Vec<usize>, PrimitiveErrorKind> {
    let check = |position| {
        let index = indices.index(position);
        let fail = PrimitiveErrorKind::Index { position, index, n_positions };
        usize::try_from(index).ok().filter(|&i| i < n_positions).ok_or(fail)
    };
    (0..indices.count).map(check).collect()
}

/// Refuses modes that do not exist, and lists of triangles that end in a part of one.
fn check_mode(mode: u32, n_corners: usize) -> Result<(), PrimitiveErrorKind> {
    match mode {
        TRIANGLES if !n_corners.is_multiple_of(3) => Err(PrimitiveErrorKind::Corners { n_corners }),
        0..=TRIANGLE_FAN => Ok(()),
        _ => Err(PrimitiveErrorKind::Mode { mode }),
    }
}

/// Triangles that `n` corners make; points and lines make none.
fn n_triangles_of(mode: u32, n: usize) -> usize {
    match mode {
        TRIANGLES => n / 3,
        TRIANGLE_STRIP | TRIANGLE_FAN => n.saturating_sub(2),
        _ => 0,
    }
}

/// Which corners triangle `k` has, in the order of the specification (section 3.7.2.1).
fn triangle_of(mode: u32, k: usize) -> [usize; 3] {
    match mode {
        // Every other triangle of a strip runs the other way round.
        TRIANGLE_STRIP => [k, k + 1 + k % 2, k + 2 - k % 2],
        TRIANGLE_FAN => [k + 1, k + 2, 0],
        _ => [3 * k, 3 * k + 1, 3 * k + 2],
    }
}
