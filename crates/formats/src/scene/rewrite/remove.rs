//! Objects taken out of a glTF document, or made invisible in it, by changes of the text where they are named: all else is the same, byte for byte.

use super::RewriteError;
use crate::error::malformed;
use crate::scene::gltf::{MAGIC, split};
use crate::scene::json::Document;
use crate::scene::source::GltfSource;
use serde::de::{Deserialize, Deserializer, MapAccess, Visitor};
use serde_json::value::RawValue;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::ops::Range;

/// The extension by which a node is not drawn.
const VISIBILITY: &str = "KHR_node_visibility";

/// How the names of extensions begin by which a node sheds light.
const LIGHTS: [&str; 2] = ["KHR_lights_", "EXT_lights_"];

/// What becomes of objects that nobody sees.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Removal {
    /// They are no longer in the scene: nodes lose their mesh, or primitives of it.
    Delete,
    /// Nodes of which nothing is seen are made invisible, by `KHR_node_visibility`; a program can show them.
    Flag,
}

/// A document without some objects.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RemovedObjects {
    /// The file, of the same kind as the source.
    pub bytes: Vec<u8>,
    /// For each object whether it had to stay although it was to go: it shares a node with what is seen, the node is in
    /// several scenes, or it is animated in a way that needs it.
    pub stay: Vec<bool>,
}

/// What is to become of a node.
struct NodePlan {
    mesh: usize,
    /// For each primitive of the mesh.
    drop: Vec<bool>,
}

impl NodePlan {
    fn drops_all(&self) -> bool {
        self.drop.iter().all(|drop| *drop)
    }

    fn drops_any(&self) -> bool {
        self.drop.contains(&true)
    }
}

/// A part of the text, and what comes into its place.
type Edit = (Range<usize>, String);

impl GltfSource {
    /// The document without some objects, as GLB or as text, as it was read. Everything else is as it was, byte for byte: names, extras, materials,
    /// animations, cameras, empty nodes, and all buffers, also where nothing uses them any more ([`Self::rewrite`] leaves that out).
    ///
    /// A node that loses all of its mesh stays in its place. Of a node that loses a part of it, the mesh has fewer primitives; if other nodes
    /// have the mesh as well, it gets one of its own, behind the others. Of a node that is drawn many times, a primitive goes if it goes everywhere.
    ///
    /// * `objects`: for each object of the scene whether it is to go
    ///
    /// Costs the time of reading the text, and the memory of the file.
    ///
    /// # Errors
    /// [`RewriteError`] for another number of objects, and a text of which parts are not what the format says.
    pub fn without(&self, objects: &[bool], how: Removal) -> Result<RemovedObjects, RewriteError> {
        let n = self.n_objects();
        if objects.len() != n {
            return Err(malformed!("{} objects for a scene of {n}", objects.len()).into());
        }
        let (text, _) = split(&self.bytes).expect("the source was read before");
        let document: Document = serde_json::from_str(text).expect("the source was read before");
        let mut plans = self.plans(&document, objects);
        let text_of = Text::new(text)?;
        let channels = document.animations.iter().flat_map(|animation| &animation.channels);
        let weighted: BTreeSet<usize> =
            channels.filter(|c| &*c.target.path == "weights").filter_map(|c| c.target.node).collect();
        if how == Removal::Delete {
            // An animation of weights needs a mesh that has them.
            plans.retain(|node, plan| !(weighted.contains(node) && plan.drops_all()));
        } else {
            text_of.leave_what_can_be_invisible(&document, &mut plans)?;
        }
        let edits = match how {
            Removal::Delete => text_of.deletions(&document, &plans)?,
            Removal::Flag => text_of.flags(plans.keys().copied())?,
        };
        let goes = |k: usize| {
            let origin = self.object(k).expect("it is one of them");
            plans.get(&origin.node).is_some_and(|plan| plan.drop[origin.primitive])
        };
        let stay = (0..n).map(|k| objects[k] && !goes(k)).collect();
        Ok(RemovedObjects { bytes: self.with_text(&edited(text, edits))?, stay })
    }

    /// For each node that loses something what that is.
    fn plans(&self, document: &Document, objects: &[bool]) -> BTreeMap<usize, NodePlan> {
        let mut plans: BTreeMap<usize, NodePlan> = BTreeMap::new();
        for origin in &self.origins {
            let n = document.meshes[origin.mesh].primitives.len();
            let plan = plans.entry(origin.node).or_insert_with(|| NodePlan { mesh: origin.mesh, drop: vec![true; n] });
            (0..n).for_each(|k| plan.drop[k] &= objects[origin.first_object + k]);
        }
        let in_scenes = scenes_of_nodes(document);
        plans.retain(|&node, plan| plan.drops_any() && in_scenes[node] < 2);
        plans
    }

    /// The file with another text, and all other chunks as they are.
    fn with_text(&self, text: &str) -> Result<Vec<u8>, RewriteError> {
        if !self.bytes.starts_with(MAGIC) {
            return Ok(text.as_bytes().to_vec());
        }
        let size_at = |at: usize| -> [u8; 4] { self.bytes[at..at + 4].try_into().expect("four bytes") };
        let (stated, old) = (u32::from_le_bytes(size_at(8)) as usize, u32::from_le_bytes(size_at(12)) as usize);
        let rest = &self.bytes[20 + old..stated];
        let padded = text.len().next_multiple_of(4);
        let whole = 20 + padded + rest.len();
        let len = u32::try_from(whole).map_err(|_| RewriteError::too_large(whole))?;
        let mut glb = Vec::with_capacity(whole);
        glb.extend_from_slice(&self.bytes[..8]);
        glb.extend_from_slice(&len.to_le_bytes());
        glb.extend_from_slice(&(padded as u32).to_le_bytes());
        glb.extend_from_slice(b"JSON");
        glb.extend_from_slice(text.as_bytes());
        glb.resize(20 + padded, b' ');
        glb.extend_from_slice(rest);
        Ok(glb)
    }
}

/// In how many scenes each node is. What is hidden in one may be seen in another.
fn scenes_of_nodes(document: &Document) -> Vec<u32> {
    let mut counts = vec![0; document.nodes.len()];
    for scene in &document.scenes {
        let mut below = scene.nodes.clone();
        let mut known = BTreeSet::new();
        while let Some(node) = below.pop() {
            // Scenes that were not read may name anything.
            let Some(of) = document.nodes.get(node).filter(|_| known.insert(node)) else { continue };
            counts[node] += 1;
            below.extend(&of.children);
        }
    }
    counts
}

/// The members of an object, in their order, as they are written.
struct Members<'a>(Vec<(String, &'a RawValue)>);

impl<'de: 'a, 'a> Deserialize<'de> for Members<'a> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Each;
        impl<'de> Visitor<'de> for Each {
            type Value = Members<'de>;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("an object")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Members<'de>, A::Error> {
                let mut members = Vec::new();
                while let Some(member) = map.next_entry::<String, &'de RawValue>()? {
                    members.push(member);
                }
                Ok(Members(members))
            }
        }
        deserializer.deserialize_map(Each)
    }
}

impl<'a> Members<'a> {
    fn of(text: &'a str, place: &str) -> Result<Self, RewriteError> {
        serde_json::from_str(text).map_err(|error| malformed!("{place}: {error}").into())
    }

    fn get(&self, key: &str) -> Option<&'a RawValue> {
        self.0.iter().rev().find(|(name, _)| name == key).map(|(_, value)| *value)
    }

    /// The object with these members, some of which have other values, or none.
    fn written(&self, change: impl Fn(&str, &'a str) -> Option<String>) -> String {
        let member =
            |(name, value): &(String, &'a RawValue)| change(name, value.get()).map(|value| named(name, &value));
        format!("{{{}}}", self.0.iter().filter_map(member).collect::<Vec<_>>().join(","))
    }
}

fn named(name: &str, value: &str) -> String {
    format!("{}:{value}", serde_json::to_string(name).expect("a text is JSON"))
}

fn items<'a>(list: &'a RawValue, place: &str) -> Result<Vec<&'a RawValue>, RewriteError> {
    serde_json::from_str(list.get()).map_err(|error| malformed!("{place}: {error}").into())
}

/// The text of a document, and where its parts are.
struct Text<'a> {
    text: &'a str,
    root: Members<'a>,
    nodes: Vec<&'a RawValue>,
    meshes: Vec<&'a RawValue>,
}

impl<'a> Text<'a> {
    fn new(text: &'a str) -> Result<Self, RewriteError> {
        let root = Members::of(text, "the document")?;
        let list = |key: &str| root.get(key).map_or(Ok(Vec::new()), |list| items(list, key));
        let (nodes, meshes) = (list("nodes")?, list("meshes")?);
        Ok(Self { text, root, nodes, meshes })
    }

    /// Where a value is, which is a part of the text.
    fn place(&self, value: &RawValue) -> Range<usize> {
        let start = value.get().as_ptr() as usize - self.text.as_ptr() as usize;
        start..start + value.get().len()
    }

    /// An edit of a node.
    fn node(
        &self,
        node: usize,
        change: impl Fn(&Members<'a>) -> Result<String, RewriteError>,
    ) -> Result<Edit, RewriteError> {
        let value = *self.nodes.get(node).ok_or_else(|| malformed!("there is no node {node}"))?;
        Ok((self.place(value), change(&Members::of(value.get(), &format!("nodes[{node}]"))?)?))
    }

    /// Leaves of the plans those of nodes that can be made invisible: nothing of them and of what is below them is seen, sheds light or is looked from.
    fn leave_what_can_be_invisible(
        &self,
        document: &Document,
        plans: &mut BTreeMap<usize, NodePlan>,
    ) -> Result<(), RewriteError> {
        plans.retain(|_, plan| plan.drops_all());
        let mut shows = Vec::with_capacity(self.nodes.len());
        for (k, (node, text)) in document.nodes.iter().zip(&self.nodes).enumerate() {
            let members = Members::of(text.get(), &format!("nodes[{k}]"))?;
            let extensions =
                members.get("extensions").map(|value| Members::of(value.get(), "extensions")).transpose()?;
            let has_light =
                extensions.is_some_and(|of| of.0.iter().any(|(name, _)| LIGHTS.iter().any(|l| name.starts_with(l))));
            shows.push(node.mesh.is_some() && !plans.contains_key(&k) || has_light || members.get("camera").is_some());
        }
        plans.retain(|&node, _| {
            let mut below = vec![node];
            // A node has one parent, so this ends.
            while let Some(node) = below.pop() {
                if shows[node] {
                    return false;
                }
                below.extend(&document.nodes[node].children);
            }
            true
        });
        Ok(())
    }

    fn deletions(&self, document: &Document, plans: &BTreeMap<usize, NodePlan>) -> Result<Vec<Edit>, RewriteError> {
        let mut edits = Vec::new();
        // Who has each mesh as it is, and who wants which parts of it.
        let mut is_whole = vec![false; self.meshes.len()];
        for (_, node) in document.nodes.iter().enumerate().filter(|(k, _)| !plans.contains_key(k)) {
            if let Some(whole) = node.mesh.and_then(|mesh| is_whole.get_mut(mesh)) {
                *whole = true;
            }
        }
        let mut variants: BTreeMap<(usize, &[bool]), usize> = BTreeMap::new();
        let mut new: Vec<String> = Vec::new();
        for (&node, plan) in plans {
            if plan.drops_all() {
                let without = |of: &Members<'a>| {
                    let has_mesh = ["mesh", "weights", "skin"];
                    Ok(of.written(|name, value| match name {
                        name if has_mesh.contains(&name) => None,
                        "extensions" => without_instances(value),
                        _ => Some(value.to_owned()),
                    }))
                };
                edits.push(self.node(node, without)?);
                continue;
            }
            let mesh = match variants.get(&(plan.mesh, &plan.drop[..])) {
                Some(&mesh) => mesh,
                None => {
                    let text = self.mesh(plan)?;
                    let mesh = if std::mem::replace(&mut is_whole[plan.mesh], true) {
                        new.push(text);
                        self.meshes.len() + new.len() - 1
                    } else {
                        edits.push((self.place(self.meshes[plan.mesh]), text));
                        plan.mesh
                    };
                    variants.insert((plan.mesh, &plan.drop), mesh);
                    mesh
                }
            };
            if mesh != plan.mesh {
                let renamed =
                    |name: &str, value: &str| Some(if name == "mesh" { mesh.to_string() } else { value.to_owned() });
                edits.push(self.node(node, |of| Ok(of.written(renamed)))?);
            }
        }
        if let Some(last) = self.meshes.last().filter(|_| !new.is_empty()) {
            let end = self.place(last).end;
            edits.push((end..end, format!(",{}", new.join(","))));
        }
        Ok(edits)
    }

    /// A mesh with fewer primitives.
    fn mesh(&self, plan: &NodePlan) -> Result<String, RewriteError> {
        let m = plan.mesh;
        let of = Members::of(self.meshes[m].get(), &format!("meshes[{m}]"))?;
        let place = format!("meshes[{m}].primitives");
        let primitives = of.get("primitives").map_or(Ok(Vec::new()), |list| items(list, &place))?;
        let left = primitives.iter().zip(&plan.drop).filter(|(_, drop)| !**drop).map(|(text, _)| text.get());
        let list = format!("[{}]", left.collect::<Vec<_>>().join(","));
        Ok(of.written(|name, value| Some(if name == "primitives" { list.clone() } else { value.to_owned() })))
    }

    fn flags(&self, nodes: impl Iterator<Item = usize>) -> Result<Vec<Edit>, RewriteError> {
        let invisible = named(VISIBILITY, r#"{"visible":false}"#);
        let mut edits = Vec::new();
        for node in nodes {
            let flag = |of: &Members<'a>| {
                let Some(extensions) = of.get("extensions") else {
                    let all = of.written(|_, value| Some(value.to_owned()));
                    let comma = if of.0.is_empty() { "" } else { "," };
                    return Ok(format!("{}{comma}\"extensions\":{{{invisible}}}}}", &all[..all.len() - 1]));
                };
                let extensions = Members::of(extensions.get(), &format!("nodes[{node}].extensions"))?;
                let others = extensions.0.iter().filter(|(name, _)| name != VISIBILITY);
                let mut list: Vec<String> = others.map(|(name, value)| named(name, value.get())).collect();
                list.push(invisible.clone());
                let extensions = format!("{{{}}}", list.join(","));
                Ok(of.written(|name, value| {
                    Some(if name == "extensions" { extensions.clone() } else { value.to_owned() })
                }))
            };
            edits.push(self.node(node, flag)?);
        }
        if !edits.is_empty() {
            edits.extend(self.declaration()?);
        }
        Ok(edits)
    }

    /// Says that the extension is used, unless that is said.
    fn declaration(&self) -> Result<Option<Edit>, RewriteError> {
        let name = format!("\"{VISIBILITY}\"");
        let Some(list) = self.root.get("extensionsUsed") else {
            let last = self.root.0.last().map_or(self.text.len(), |(_, value)| self.place(value).end);
            return Ok(Some((last..last, format!(",\"extensionsUsed\":[{name}]"))));
        };
        let used = items(list, "extensionsUsed")?;
        if used.iter().any(|used| used.get() == name) {
            return Ok(None);
        }
        Ok(Some(match used.last() {
            Some(last) => {
                let end = self.place(last).end;
                (end..end, format!(",{name}"))
            }
            None => (self.place(list), format!("[{name}]")),
        }))
    }
}

/// The extensions of a node without the one that draws its mesh many times; none if that is the only one.
fn without_instances(extensions: &str) -> Option<String> {
    let Ok(Members(mut members)) = serde_json::from_str::<Members<'_>>(extensions) else {
        return Some(extensions.to_owned());
    };
    let n = members.len();
    members.retain(|(name, _)| name != crate::scene::movers::INSTANCING);
    match members.len() {
        left if left == n => Some(extensions.to_owned()),
        0 => None,
        _ => Some(Members(members).written(|_, value| Some(value.to_owned()))),
    }
}

/// The text after some edits, no two of which are of the same part.
fn edited(text: &str, mut edits: Vec<Edit>) -> String {
    edits.sort_by_key(|(range, _)| range.start);
    let mut out = String::with_capacity(text.len());
    let mut at = 0;
    for (range, new) in edits {
        out.push_str(&text[at..range.start]);
        out.push_str(&new);
        at = range.end;
    }
    out.push_str(&text[at..]);
    out
}
