//! Where the objects of a glTF scene come from, so that their document can be written again with fewer triangles.

use super::SceneFile;
use super::gltf::{Loaded, MAGIC, parse};
use super::surface::SceneReadOptions;
use crate::beside::{Folder, Neighbours};
use crate::error::Malformed;
use std::path::Path;

/// A glTF document with its buffers, and what the objects of its scene come from.
#[derive(Debug)]
pub struct GltfSource {
    pub(super) bytes: Vec<u8>,
    pub(super) folder: Option<Folder>,
    /// What was read of buffers outside `bytes`, by buffer.
    pub(super) loaded: Loaded,
    pub(super) origins: Vec<NodeOrigin>,
    /// For meshes that were read, for each primitive the indices in its accessors of its object's vertices, ascending.
    pub(super) corners: Vec<Vec<Vec<usize>>>,
    /// Index into `origins`, and primitive, of each object.
    objects: Vec<(u32, u32)>,
}

/// A node with a mesh.
#[derive(Debug, Clone, Copy)]
pub(super) struct NodeOrigin {
    pub(super) node: usize,
    pub(super) mesh: usize,
    pub(super) mirrors: bool,
    pub(super) first_object: usize,
}

/// What an object comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ObjectOrigin<'a> {
    /// Its node, as an index in the document.
    pub node: usize,
    /// The mesh of the node, as an index in the document.
    pub mesh: usize,
    /// The primitive of the mesh.
    pub primitive: usize,
    /// For each of the object's vertices its index in the primitive's accessors, ascending.
    pub corners: &'a [usize],
    /// Whether the node mirrors its mesh: triangles of the object then run the other way round than in the file.
    pub is_mirrored: bool,
}

/// As [`parse_glb`](super::parse_glb), with the source that is needed to write the document again with fewer triangles.
///
/// Costs the memory of the file and of its outside buffers, and a number for each vertex of a mesh.
///
/// # Errors
/// As [`parse_glb`](super::parse_glb).
pub fn parse_glb_with_source(bytes: Vec<u8>, folder: Option<&Path>) -> Result<(SceneFile, GltfSource), Malformed> {
    parse_with_source(bytes, folder, &SceneReadOptions::default())
}

pub(super) fn parse_with_source(
    bytes: Vec<u8>,
    folder: Option<&Path>,
    options: &SceneReadOptions,
) -> Result<(SceneFile, GltfSource), Malformed> {
    let (mut origins, mut objects, mut corners) = (Vec::new(), Vec::new(), Vec::<Vec<Vec<usize>>>::new());
    let folder = folder.map(|folder| Folder(folder.to_owned()));
    let beside = folder.as_ref().map(|folder| folder as &dyn Neighbours);
    let (file, loaded) = parse(&bytes, beside, options, |origin| {
        let (node, mesh) = (origin.node, origin.mesh);
        if corners.len() <= mesh {
            corners.resize_with(mesh + 1, Vec::new);
        }
        if corners[mesh].is_empty() {
            corners[mesh] = origin.locals.iter().map(|local| local.mesh.corners.clone()).collect();
        }
        let first_object = objects.len();
        // Objects, and so nodes that have some, are fewer than `MAX_OBJECTS`.
        objects.extend((0..origin.locals.len()).map(|k| (origins.len() as u32, k as u32)));
        if !origin.locals.is_empty() {
            origins.push(NodeOrigin { node, mesh, mirrors: origin.mirrors, first_object });
        }
    })?;
    Ok((file, GltfSource { bytes, folder, loaded, origins, corners, objects }))
}

impl GltfSource {
    /// Number of objects of the scene.
    pub fn n_objects(&self) -> usize {
        self.objects.len()
    }

    /// Whether the file is a GLB; else it is a text.
    pub fn is_glb(&self) -> bool {
        self.bytes.starts_with(MAGIC)
    }

    /// What object `k` comes from; `None` if there is no such object.
    pub fn object(&self, k: usize) -> Option<ObjectOrigin<'_>> {
        let &(origin, primitive) = self.objects.get(k)?;
        let (origin, primitive) = (&self.origins[origin as usize], primitive as usize);
        let corners = &self.corners[origin.mesh][primitive];
        Some(ObjectOrigin { node: origin.node, mesh: origin.mesh, primitive, corners, is_mirrored: origin.mirrors })
    }
}
