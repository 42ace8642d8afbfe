//! A glTF document written again as GLB with other triangles, and all else as it was.

mod copies;
mod document;
mod extensions;
mod images;
mod meshes;
mod remove;
mod repack;
mod variants;

pub use remove::{Removal, RemovedObjects};

use super::Simplification;
use super::buffers::Buffers;
use super::gltf::split;
use super::json::{Document, Node};
use super::movers::INSTANCING;
use super::source::GltfSource;
use super::write::container;
use crate::beside::Neighbours;
use crate::error::{Malformed, malformed};
use copies::{Copies, Original};
use document::{Object, as_object, list};
use serde_json::{Value, json};
use variants::Variants;

/// Why a glTF document cannot be written again with fewer triangles.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum RewriteError {
    /// An extension may speak of what is to change.
    #[error("{place}: extension {name} is not understood, and may depend on what is to be changed")]
    Extension {
        /// Where in the document.
        place: String,
        /// The extension.
        name: String,
    },
    /// Triangles that do not fit the scene, a part of the document that is not what the format says, data that are not sound, or more
    /// than a GLB can hold.
    #[error(transparent)]
    Malformed(#[from] Malformed),
}

impl RewriteError {
    /// The error of a file that would have this many bytes, or has them before it is given up.
    pub(super) fn too_large(len: usize) -> Self {
        malformed!("{len} bytes are too many for a GLB").into()
    }

    pub(super) fn check_size(len: usize) -> Result<(), Self> {
        u32::try_from(len).map(|_| ()).map_err(|_| Self::too_large(len))
    }
}

impl GltfSource {
    /// The document as GLB, with other triangles, and all else as it was.
    ///
    /// * `triangles`: for each object `None` if it stays as it is, or all triangles that it shall have, as indices of its
    ///   vertices in the scene and wound as there.
    /// * `simplified`: what the result states about itself, for readers of ours; it is no occluder if the source is none.
    ///
    /// Reading the result gives the objects that have anything left, in the same order: those that stay as they are, and the
    /// others with these triangles in this order, at vertices with the same bits. (Triangles without area are left out by
    /// readers of ours, and names `#1`, `#2` count the primitives that are left.)
    ///
    /// Nodes, materials, textures, cameras, animations, extras and extensions survive. Nodes that shared a mesh and now
    /// differ get meshes of their own, which are put behind the others. A primitive without triangles goes, a mesh without
    /// primitives goes from its node; the node stays. Strips and fans become lists. All attributes of vertices, and their
    /// morph targets, are copied byte by byte, without the vertices that nothing uses any more; sparse accessors of changed
    /// primitives become dense. Accessors and buffer views that nothing uses are left out, except where an extension that
    /// is not understood may mean them: then all of them stay, in their places. Buffers, and images in files beside the
    /// document as far as they can be read, go into the GLB.
    ///
    /// Costs time and memory in proportion to the result and the source. The same arguments give the same bytes.
    ///
    /// # Errors
    /// [`RewriteError`]: arguments that do not fit the scene, attributes that are not sound, and extensions that may speak
    /// of the triangles that are to change.
    pub fn rewrite(
        &self,
        triangles: &[Option<Vec<[u32; 3]>>],
        simplified: Option<Simplification>,
    ) -> Result<Vec<u8>, RewriteError> {
        check(self, triangles)?;
        let (text, binary) = split(&self.bytes).expect("the source was read before");
        let document: Document = serde_json::from_str(text).expect("the source was read before");
        let whole = serde_json::from_str(text);
        let mut whole: Value = whole.map_err(|error| malformed!("the glTF text cannot be written again: {error}"))?;
        let root = as_object(&mut whole, "the document")?;
        let beside = self.folder.as_ref().map(|folder| folder as &dyn Neighbours);
        let buffers = Buffers::new(&document.buffers, binary, beside).with_loaded(&self.loaded);
        // An object is one of many instances of its triangles.
        let is_instanced =
            |node: &Node| node.extensions.as_ref().is_some_and(|extensions| extensions.instances.is_some());
        if let Some(k) = document.nodes.iter().position(is_instanced) {
            return Err(RewriteError::Extension { place: format!("nodes[{k}]"), name: INSTANCING.to_owned() });
        }
        let keep_all = extensions::any_unknown(root)?;
        let outside = images::outside(root, beside)?;
        let variants = Variants::new(self, &document, triangles);
        let old = list(root, "accessors")?.to_vec();
        let original = Original { document: &document, buffers: &buffers };
        let mut copies = Copies::new(original, &old);
        if !variants.are_all_as_before() {
            meshes::change(root, self, original, &variants, &mut copies, keep_all)?;
        }
        if let Some(simplified) = simplified {
            mark(root, simplified.occluder && document.asset.simplified.is_none_or(|before| before.occluder))?;
        }
        extensions::forget_codings(root);
        let binary = repack::repack(root, original, &old, copies.new, &outside, keep_all)?;
        let text = serde_json::to_vec(&whole).expect("what was JSON is JSON");
        container(text, &binary).map_err(RewriteError::too_large)
    }
}

fn check(source: &GltfSource, triangles: &[Option<Vec<[u32; 3]>>]) -> Result<(), RewriteError> {
    let (found, expected) = (triangles.len(), source.n_objects());
    if found != expected {
        return Err(malformed!("triangles of {found} objects for a scene of {expected}").into());
    }
    for (object, list) in triangles.iter().enumerate() {
        let n_vertices = source.object(object).map_or(0, |o| o.corners.len());
        for (triangle, corners) in list.iter().flatten().enumerate() {
            if let Some(&vertex) = corners.iter().find(|&&v| v as usize >= n_vertices) {
                let place = format_args!("object {object}, triangle {triangle}");
                return Err(malformed!("there is no vertex {vertex}").within(place).into());
            }
        }
    }
    Ok(())
}

/// Writes into the extras of the asset whether the scene may be used as an occluder.
fn mark(root: &mut Object, occluder: bool) -> Result<(), RewriteError> {
    let asset = root.get_mut("asset").and_then(Value::as_object_mut);
    let asset = asset.ok_or_else(|| document::form("asset", "an object"))?;
    let extras = member(asset, "extras");
    let ours = member(extras, "sightlines");
    ours.insert("simplified".to_owned(), json!({"occluder": occluder}));
    Ok(())
}

/// A member that is an object, made one if it is not: what was there instead becomes its member `was`.
fn member<'v>(object: &'v mut Object, key: &str) -> &'v mut Object {
    let value = object.entry(key.to_owned()).or_insert(Value::Null);
    if !value.is_object() {
        let was = value.take();
        *value = if was.is_null() { json!({}) } else { json!({"was": was}) };
    }
    value.as_object_mut().expect("just made one")
}
