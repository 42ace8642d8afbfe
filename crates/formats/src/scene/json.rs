//! The parts of a glTF document that matter here. Everything else in it is skipped.
//!
//! Numbers of transforms are read in double precision, as JSON has them. In single precision a building
//! that is written 10,000 km from the origin would have its walls moved against each other.

use super::Simplification;
use super::extras::Stated;
use super::movers::{NodeExtensions, moves_everything};
use crate::json::as_index;
use serde::de::{Deserializer, IgnoredAny};
use serde::{Deserialize, de::DeserializeOwned};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Document {
    pub(super) asset: Asset,
    pub(super) scene: Option<usize>,
    #[serde(default)]
    pub(super) scenes: Vec<SceneRoots>,
    #[serde(default)]
    pub(super) nodes: Vec<Node>,
    #[serde(default)]
    pub(super) meshes: Vec<Mesh>,
    /// `None` for one that is not as the specification has it.
    #[serde(default, deserialize_with = "lenient")]
    pub(super) materials: Vec<Option<Material>>,
    /// Likewise.
    #[serde(default, deserialize_with = "lenient")]
    pub(super) skins: Vec<Option<Skin>>,
    #[serde(default)]
    pub(super) animations: Vec<Animation>,
    #[serde(default)]
    pub(super) accessors: Vec<Accessor>,
    #[serde(default)]
    pub(super) buffer_views: Vec<BufferView>,
    #[serde(default)]
    pub(super) buffers: Vec<Buffer>,
    #[serde(default)]
    pub(super) extensions_required: Vec<String>,
    #[serde(default)]
    pub(super) extensions_used: Vec<String>,
    /// Their names.
    #[serde(default, deserialize_with = "super::movers::names")]
    pub(super) extensions: BTreeSet<String>,
}

impl Document {
    pub(super) fn moves_everything(&self) -> Option<&str> {
        moves_everything(self.extensions.iter().chain(&self.extensions_used).map(String::as_str))
    }
}

#[derive(Debug, Deserialize)]
pub(super) struct Asset {
    pub(super) version: String,
    /// Whether its extras mark it as simplified: `{"sightlines": {"simplified": {"occluder": false}}}`.
    #[serde(default, rename = "extras", deserialize_with = "super::extras::simplified")]
    pub(super) simplified: Option<Simplification>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct SceneRoots {
    pub(super) name: Option<Box<str>>,
    pub(super) nodes: Vec<usize>,
}

/// Rare members are boxed: a document may be little else than a million empty nodes.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Node {
    pub(super) name: Option<Box<str>>,
    pub(super) mesh: Option<usize>,
    pub(super) children: Vec<usize>,
    pub(super) matrix: Option<Box<[f64; 16]>>,
    pub(super) translation: Option<Box<[f64; 3]>>,
    pub(super) rotation: Option<Box<[f64; 4]>>,
    pub(super) scale: Option<Box<[f64; 3]>>,
    pub(super) skin: Option<usize>,
    pub(super) weights: Option<Box<[f64]>>,
    /// What its extras state: `{"sightlines": {"role": "mirror", "moves": true}}`.
    #[serde(rename = "extras", deserialize_with = "super::extras::stated")]
    pub(super) stated: Stated,
    pub(super) extensions: Option<Box<NodeExtensions>>,
}

impl Node {
    /// Whether the node, and all below it, is not drawn at first: a program may show it later.
    pub(super) fn is_invisible(&self) -> bool {
        self.extensions.as_ref().is_some_and(|extensions| extensions.is_invisible)
    }

    pub(super) fn coarser(&self) -> &[usize] {
        self.extensions.as_ref().map_or(&[], |extensions| &extensions.coarser)
    }

    pub(super) fn loose(&self) -> Option<String> {
        if self.stated.moves() {
            return Some("extras".to_owned());
        }
        let by_name = || Some(format!("the name ending in {}", super::role::body_of_name(self.name.as_deref()?)?));
        self.extensions.as_ref().and_then(|extensions| extensions.reason()).or_else(by_name)
    }
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Mesh {
    pub(super) name: Option<Box<str>>,
    pub(super) primitives: Vec<Primitive>,
    pub(super) weights: Option<Box<[f64]>>,
    /// As that of a node, for all nodes with this mesh.
    #[serde(rename = "extras", deserialize_with = "super::extras::stated")]
    pub(super) stated: Stated,
}

#[derive(Debug, Deserialize)]
pub(super) struct Primitive {
    #[serde(default)]
    pub(super) attributes: Attributes,
    pub(super) indices: Option<usize>,
    #[serde(default = "triangles")]
    pub(super) mode: u32,
    pub(super) material: Option<usize>,
    #[serde(default)]
    pub(super) targets: Vec<Attributes>,
    /// Materials that it may have instead, by `KHR_materials_variants`.
    #[serde(default, rename = "extensions", deserialize_with = "variants")]
    pub(super) variants: Vec<usize>,
}

impl Primitive {
    /// Its material, and those that it may have instead; `None` for the standard one.
    pub(super) fn materials(&self) -> Vec<Option<usize>> {
        std::iter::once(self.material).chain(self.variants.iter().copied().map(Some)).collect()
    }
}

/// The materials that a primitive may have instead of its own, by `KHR_materials_variants`. A list that is not as it
/// should be counts as one material that does not exist.
fn variants<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<usize>, D::Error> {
    let extensions = Value::deserialize(deserializer)?;
    let Some(variants) = extensions.get("KHR_materials_variants") else { return Ok(Vec::new()) };
    let of = |mapping: &Value| mapping.get("material").and_then(as_index);
    let mappings = variants.get("mappings").and_then(Value::as_array);
    let found = mappings.and_then(|mappings| mappings.iter().map(of).collect::<Option<Vec<usize>>>());
    Ok(found.unwrap_or_else(|| vec![usize::MAX]))
}

#[derive(Debug, Default, Deserialize)]
pub(super) struct Attributes {
    #[serde(rename = "POSITION")]
    pub(super) position: Option<usize>,
    /// All others: a primitive has any number of sets of joints and weights.
    #[serde(flatten)]
    pub(super) others: BTreeMap<String, Value>,
}

/// What of a material says whether it lets light through.
#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Material {
    pub(super) name: Option<Box<str>>,
    pub(super) alpha_mode: Option<Box<str>>,
    pub(super) double_sided: bool,
    pub(super) extensions: BTreeMap<Box<str>, IgnoredAny>,
    /// As that of a node, for all primitives with this material.
    #[serde(rename = "extras", deserialize_with = "super::extras::stated")]
    pub(super) stated: Stated,
}

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Skin {
    pub(super) joints: Vec<usize>,
    pub(super) inverse_bind_matrices: Option<usize>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Animation {
    pub(super) channels: Vec<Channel>,
    pub(super) samplers: Vec<Sampler>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Channel {
    pub(super) sampler: usize,
    pub(super) target: Target,
}

#[derive(Debug, Deserialize)]
pub(super) struct Target {
    pub(super) node: Option<usize>,
    pub(super) path: Box<str>,
    pub(super) extensions: Option<Value>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Sampler {
    pub(super) input: usize,
    pub(super) output: usize,
    pub(super) interpolation: Option<Box<str>>,
}

/// A list of what can be read of it; nothing where it is no list.
fn lenient<'de, D: Deserializer<'de>, T: DeserializeOwned>(deserializer: D) -> Result<Vec<Option<T>>, D::Error> {
    let Value::Array(list) = Value::deserialize(deserializer)? else { return Ok(Vec::new()) };
    Ok(list.into_iter().map(|element| serde_json::from_value(element).ok()).collect())
}

pub(super) const TRIANGLES: u32 = 4;

fn triangles() -> u32 {
    TRIANGLES
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Accessor {
    pub(super) buffer_view: Option<usize>,
    #[serde(default)]
    pub(super) byte_offset: usize,
    pub(super) component_type: u32,
    #[serde(default)]
    pub(super) normalized: bool,
    pub(super) count: usize,
    #[serde(rename = "type")]
    pub(super) kind: String,
    pub(super) sparse: Option<Box<Sparse>>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Sparse {
    pub(super) count: usize,
    pub(super) indices: SparseIndices,
    pub(super) values: SparseValues,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct SparseIndices {
    pub(super) buffer_view: usize,
    #[serde(default)]
    pub(super) byte_offset: usize,
    pub(super) component_type: u32,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct SparseValues {
    pub(super) buffer_view: usize,
    #[serde(default)]
    pub(super) byte_offset: usize,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct BufferView {
    pub(super) buffer: usize,
    #[serde(default)]
    pub(super) byte_offset: usize,
    pub(super) byte_length: usize,
    pub(super) byte_stride: Option<usize>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Buffer {
    pub(super) byte_length: usize,
    pub(super) uri: Option<Box<str>>,
}
