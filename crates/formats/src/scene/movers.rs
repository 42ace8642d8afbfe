//! Extensions of glTF by which programs move things: which of them move a node, and which may move everything.
//!
//! Something that is wrongly taken for still hides what can be seen, and is not seen where it goes; something that is wrongly
//! taken for moving only shows more. So an extension of a node that is not known counts as one that moves it.

use crate::error::counted;
use crate::json::as_index;
use serde::Deserialize;
use serde::de::{Deserializer, IgnoredAny, MapAccess, Visitor};
use serde_json::Value;
use std::collections::BTreeSet;
use std::fmt;

/// Extensions of nodes and documents that leave nodes where they are, by how their names begin.
///
/// `MSFT_lod` shows other meshes in the same place: the finest one stands for all, and levels that reach beyond it are not looked at.
#[rustfmt::skip]
const STILL: [&str; 34] = [
    "AGI_stk_metadata", "CESIUM_", "EXT_feature_metadata", "EXT_instance_features", "EXT_lights_", "EXT_mesh_features",
    "EXT_mesh_gpu_instancing", "EXT_mesh_manifold", "EXT_meshopt_compression", "EXT_structural_metadata",
    "EXT_texture_", "GODOT_single_root", "KHR_audio", "KHR_implicit_shapes", "KHR_lights_", "KHR_materials_",
    "KHR_meshopt_compression", "KHR_node_hoverability", "KHR_node_selectability", "KHR_node_visibility", "KHR_texture_",
    "KHR_xmp", "MSFT_audio_emitter", "MSFT_lod", "OMI_audio_emitter", "OMI_collider", "OMI_environment_sky", "OMI_link",
    "OMI_personality", "OMI_physics_gravity", "OMI_physics_joint", "OMI_physics_shape", "OMI_seat", "OMI_spawn_point",
];

/// Draws a mesh many times.
pub(super) const INSTANCING: &str = "EXT_mesh_gpu_instancing";

/// Shows coarser nodes instead of a node where it is small.
const LEVELS: &str = "MSFT_lod";

/// Extensions of nodes that move them, or have a part that does: see [`moves`].
#[rustfmt::skip]
const MOVING: [&str; 7] = [
    "AGI_articulations", "KHR_physics_rigid_bodies", "OMI_physics_body", "OMI_vehicle_", "VRMC_node_constraint",
    "VRMC_springBone", "VRMC_vrm",
];

/// Extensions of a document by which programs may move any of its nodes: behaviour, and figures that are animated by whoever
/// shows them. Whole names.
#[rustfmt::skip]
const MOVING_EVERYTHING: [&str; 9] = [
    "KHR_interactivity", "MPEG_scene_dynamic", "MPEG_scene_interactivity", "VRM", "VRMC_springBone",
    "VRMC_springBone_extended_collider", "VRMC_springBone_limit", "VRMC_vrm", "VRMC_vrm_animation",
];

fn begins_like(name: &str, list: &[&str]) -> bool {
    list.iter().any(|known| name.starts_with(known))
}

/// Whether an extension of a node moves it, by what it contains where that is known.
fn moves(name: &str, value: &Value) -> bool {
    let Value::Object(members) = value else { return true };
    let text = |value: Option<&Value>| value.and_then(Value::as_str).map(str::to_owned);
    match name {
        // Colliders and triggers without motion stand still.
        "KHR_physics_rigid_bodies" => members.contains_key("motion"),
        // Earlier versions have the kind of body where later ones have `motion`.
        "OMI_physics_body" => match (members.get("motion"), members.get("type")) {
            (Some(motion), _) => text(motion.get("type")).as_deref() != Some("static"),
            (None, Some(kind)) => !matches!(kind.as_str(), Some("static" | "trigger")),
            (None, None) => false,
        },
        // Without the name of an articulation it is a place where something is attached.
        "AGI_articulations" => members.contains_key("articulationName"),
        _ => true,
    }
}

/// The accessors of the transforms of instances, one element each for each instance: translations, rotations, scales.
pub(super) type Instances = [Option<usize>; 3];

/// `None` for what is not as the extension has it.
fn instances(value: &Value) -> Option<Instances> {
    let attributes = value.get("attributes")?.as_object()?;
    let accessor = |name: &str| match attributes.get(name) {
        None => Some(None),
        Some(value) => as_index(value).map(Some),
    };
    Some([accessor("TRANSLATION")?, accessor("ROTATION")?, accessor("SCALE")?])
}

/// What the extensions of a node make of it.
#[derive(Debug, Default)]
pub(super) struct NodeExtensions {
    /// Whether the node, and all below it, is not drawn at first: a program may show it later.
    pub(super) is_invisible: bool,
    /// Where its mesh is drawn many times; `Some(None)` if that is not as the extension has it.
    pub(super) instances: Option<Option<Instances>>,
    /// The nodes that are coarser levels of it, by `MSFT_lod`; empty if that is not as the extension has it.
    pub(super) coarser: Vec<usize>,
    /// The first extension that moves it.
    mover: Option<Box<str>>,
}

impl NodeExtensions {
    pub(super) fn reason(&self) -> Option<String> {
        let name = self.mover.as_deref()?;
        Some(if begins_like(name, &MOVING) { name.to_owned() } else { format!("the unknown extension {name}") })
    }
}

impl<'de> Deserialize<'de> for NodeExtensions {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Extensions;
        impl<'de> Visitor<'de> for Extensions {
            type Value = NodeExtensions;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("an object of extensions")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<NodeExtensions, A::Error> {
                let mut found = NodeExtensions::default();
                while let Some(name) = map.next_key::<String>()? {
                    if name == "KHR_node_visibility" {
                        found.is_invisible = map.next_value::<Value>()?.get("visible") == Some(&Value::Bool(false));
                    } else if name == INSTANCING {
                        found.instances = Some(instances(&map.next_value::<Value>()?));
                    } else if name == LEVELS {
                        found.coarser = levels(&map.next_value::<Value>()?).unwrap_or_default();
                    } else if begins_like(&name, &STILL) {
                        map.next_value::<IgnoredAny>()?;
                    } else if moves(&name, &map.next_value::<Value>()?) {
                        found.mover.get_or_insert(name.into());
                    }
                }
                Ok(found)
            }
        }
        deserializer.deserialize_map(Extensions)
    }
}

fn levels(value: &Value) -> Option<Vec<usize>> {
    let ids = value.get("ids")?.as_array()?;
    ids.iter().map(as_index).collect()
}

/// The names of the extensions of a document; none where they are not as the specification has them.
pub(super) fn names<'de, D: Deserializer<'de>>(deserializer: D) -> Result<BTreeSet<String>, D::Error> {
    Ok(match Value::deserialize(deserializer)? {
        Value::Object(all) => all.into_iter().map(|(name, _)| name).collect(),
        _ => BTreeSet::new(),
    })
}

/// The first of some extensions by which a program may move any node of a document.
pub(super) fn moves_everything<'a>(names: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    names.into_iter().find(|name| MOVING_EVERYTHING.contains(name))
}

/// What a user should hear of extensions that move things, or might.
///
/// * `everything`: the one that may move everything
/// * `document`: names of the extensions of the document
/// * `nodes`: the extensions of its nodes
pub(super) fn warnings<'a>(
    everything: Option<&str>,
    document: &BTreeSet<String>,
    nodes: impl Iterator<Item = &'a NodeExtensions>,
) -> Vec<String> {
    let mut all = Vec::new();
    if let Some(name) = everything {
        all.push(format!(
            "{name} may move everything, so nothing hides and all is seen from everywhere: name what never moves (--still)"
        ));
    }
    let is_known =
        |name: &str| begins_like(name, &STILL) || begins_like(name, &MOVING) || MOVING_EVERYTHING.contains(&name);
    for name in document.iter().filter(|name| !is_known(name)) {
        all.push(format!(
            "the extension {name} of the document is not known: name what moves by it, if anything does (--see-through)"
        ));
    }
    let mut nodes: Vec<&str> = nodes.filter_map(|extensions| extensions.mover.as_deref()).collect();
    nodes.retain(|name| !begins_like(name, &MOVING));
    nodes.sort_unstable();
    for of_one in nodes.chunk_by(|a, b| a == b) {
        let (name, nodes) = (of_one[0], counted(of_one.len(), "node has", "nodes have"));
        all.push(format!(
            "{nodes} the extension {name}, which is not known: they count as moving anywhere; name what never moves \
             (--still)"
        ));
    }
    all
}
