//! Other triangles for meshes, and other meshes for nodes.

use super::RewriteError;
use super::copies::{Copies, Original};
use super::document::{Object, as_index, as_object, attributes, form, list, put_list};
use super::variants::{Plan, Variant, Variants};
use crate::scene::accessor::{AccessorRole, Elements};
use crate::scene::build::Compact;
use crate::scene::primitive::read_indices;
use crate::scene::source::GltfSource;
use serde_json::{Value, json};
use std::collections::BTreeSet;

/// Gives each mesh its new primitives, and each node its mesh.
///
/// Indices of accessors that are beyond the document's name copies. Meshes that no node has any more go, unless
/// `keep_all`, because an extension may name them.
pub(super) fn change(
    root: &mut Object,
    source: &GltfSource,
    original: Original<'_>,
    variants: &Variants<'_>,
    copies: &mut Copies<'_>,
    keep_all: bool,
) -> Result<(), RewriteError> {
    let mut meshes = match root.remove("meshes") {
        Some(Value::Array(meshes)) => meshes,
        _ => return Err(form("meshes", "a list")),
    };
    let thinned = thinned(&mut meshes, source, variants)?;
    let mut gone = BTreeSet::new();
    let mut mesh_of_node: Vec<(usize, Option<usize>)> = Vec::new();
    for (&m, list) in &variants.by_mesh {
        let before = meshes[m].clone();
        let place = |k: usize| format!("meshes[{m}].primitives[{k}]");
        let primitives = primitives_of(&mut meshes[m], m)?;
        let empty = Vec::new();
        let corners = source.corners.get(m).unwrap_or(&empty);
        let kept: Vec<Value> = primitives
            .iter()
            .enumerate()
            .map(|(k, p)| match corners.get(k) {
                Some(corners) if variants.keep(m, k) => {
                    compacted(p, corners, original, (m, k), &thinned, copies, &place(k))
                }
                _ => Ok(p.clone()),
            })
            .collect::<Result<_, _>>()?;
        let mut is_taken = false;
        for variant in list {
            let mesh = if variant.is_empty() {
                None
            } else {
                let new = primitives_for(variant, &before, &kept, corners, copies, place)?;
                if std::mem::replace(&mut is_taken, true) {
                    let mut mesh = before.clone();
                    *primitives_of(&mut mesh, m)? = new;
                    meshes.push(mesh);
                    Some(meshes.len() - 1)
                } else {
                    *primitives_of(&mut meshes[m], m)? = new;
                    Some(m)
                }
            };
            mesh_of_node.extend(variant.nodes.iter().map(|&node| (node, mesh)));
        }
        if !is_taken && !keep_all {
            gone.insert(m);
        }
    }
    let lost = put_meshes(root, &mesh_of_node, &gone)?;
    drop_weights(root, &lost, keep_all)?;
    let mut k = 0;
    meshes.retain(|_| {
        k += 1;
        !gone.contains(&(k - 1))
    });
    put_list(root, "meshes", meshes);
    Ok(())
}

fn primitives_of(mesh: &mut Value, m: usize) -> Result<&mut Vec<Value>, RewriteError> {
    let mesh = as_object(mesh, format_args!("meshes[{m}]"))?;
    match mesh.entry("primitives").or_insert_with(|| json!([])) {
        Value::Array(primitives) => Ok(primitives),
        _ => Err(form(format_args!("meshes[{m}].primitives"), "a list")),
    }
}

/// The accessors that have vertices for primitives that are gone or changed everywhere: they shall not stay whole for
/// others that need few of their elements. Those of meshes that were not read are needed whole.
fn thinned(
    meshes: &mut [Value],
    source: &GltfSource,
    variants: &Variants<'_>,
) -> Result<BTreeSet<usize>, RewriteError> {
    let (mut thinned, mut whole) = (BTreeSet::new(), BTreeSet::new());
    for (m, mesh) in meshes.iter_mut().enumerate() {
        let was_read = source.corners.get(m).is_some_and(|corners| !corners.is_empty());
        for (k, primitive) in primitives_of(mesh, m)?.iter_mut().enumerate() {
            let set = match (was_read, variants.keep(m, k)) {
                (true, false) => &mut thinned,
                (true, true) => continue,
                (false, _) => &mut whole,
            };
            for (name, accessor) in attributes(primitive)? {
                set.insert(as_index(accessor, format_args!("meshes[{m}].primitives[{k}]: {name}"))?);
            }
        }
    }
    Ok(thinned.difference(&whole).copied().collect())
}

/// A primitive as it was, but without the vertices that only others needed.
fn compacted(
    primitive: &Value,
    corners: &[usize],
    Original { document, buffers }: Original<'_>,
    (mesh, k): (usize, usize),
    thinned: &BTreeSet<usize>,
    copies: &mut Copies<'_>,
    place: &str,
) -> Result<Value, RewriteError> {
    let typed = &document.meshes[mesh].primitives[k];
    let (Some(positions), Some(indices)) = (typed.attributes.position, typed.indices) else {
        return Ok(primitive.clone());
    };
    let mut shares = false;
    for (name, accessor) in attributes(&mut primitive.clone())? {
        shares |= thinned.contains(&as_index(accessor, format_args!("{place}: {name}"))?);
    }
    let n_positions = document.accessors[positions].count;
    if !shares || corners.len() == n_positions {
        return Ok(primitive.clone());
    }
    let elements = Elements::new(document, buffers, indices, AccessorRole::Indices).expect("it was read before");
    let indices = read_indices(&elements, n_positions)?;
    let place_of = |index: usize| corners.partition_point(|&c| c < index) as u32;
    let indices: Vec<u32> = indices.into_iter().map(place_of).collect();
    match copies.primitive(primitive, corners, &indices, false, place) {
        // It may stay as it is.
        Err(RewriteError::Extension { .. }) => Ok(primitive.clone()),
        other => other,
    }
}

fn primitives_for(
    variant: &Variant<'_>,
    before: &Value,
    kept: &[Value],
    corners: &[Vec<usize>],
    copies: &mut Copies<'_>,
    place: impl Fn(usize) -> String,
) -> Result<Vec<Value>, RewriteError> {
    let mut primitives = Vec::new();
    for (k, plan) in variant.plans.iter().enumerate() {
        match plan {
            Plan::Keep => primitives.push(kept[k].clone()),
            Plan::Drop => {}
            Plan::Triangles(triangles) => {
                let in_file = triangles.iter().map(|triangle| triangle.map(|v| corners[k][v as usize]));
                let mesh = Compact::new(in_file.clone().flatten().collect(), in_file);
                let (before, indices) = (&before["primitives"][k], mesh.triangles.as_flattened());
                primitives.push(copies.primitive(before, &mesh.corners, indices, true, &place(k))?);
            }
        }
    }
    Ok(primitives)
}

/// Puts the meshes of nodes; returns the nodes that have none any more.
fn put_meshes(
    root: &mut Object,
    mesh_of_node: &[(usize, Option<usize>)],
    gone: &BTreeSet<usize>,
) -> Result<BTreeSet<u64>, RewriteError> {
    let mut lost = BTreeSet::new();
    let nodes = list(root, "nodes")?;
    for &(node, mesh) in mesh_of_node {
        let object = as_object(&mut nodes[node], format_args!("nodes[{node}]"))?;
        match mesh {
            Some(mesh) => _ = object.insert("mesh".to_owned(), json!(mesh)),
            None => {
                object.remove("mesh");
                object.remove("weights");
                lost.insert(node as u64);
            }
        }
    }
    for node in nodes.iter_mut().filter_map(Value::as_object_mut).filter(|_| !gone.is_empty()) {
        if let Some(mesh) = node.get_mut("mesh").filter(|mesh| !mesh.is_null()) {
            let before = as_index(mesh, "the mesh of a node")?;
            *mesh = json!(before - gone.range(..before).count());
        }
    }
    Ok(lost)
}

/// Takes away what animates the morph targets of nodes that have no mesh any more.
/// With `keep_all` an animation of nothing else stays as it is: others may count animations.
fn drop_weights(root: &mut Object, lost: &BTreeSet<u64>, keep_all: bool) -> Result<(), RewriteError> {
    if lost.is_empty() || list(root, "animations")?.is_empty() {
        return Ok(());
    }
    let Some(Value::Array(animations)) = root.get_mut("animations") else { return Ok(()) };
    let is_lost = |channel: &Value| {
        let target = &channel["target"];
        target["path"] == "weights" && target["node"].as_u64().is_some_and(|node| lost.contains(&node))
    };
    animations.retain_mut(|animation| match animation.get_mut("channels") {
        Some(Value::Array(channels)) if keep_all && channels.iter().all(is_lost) => true,
        Some(Value::Array(channels)) if channels.iter().any(is_lost) => {
            channels.retain(|channel| !is_lost(channel));
            !channels.is_empty()
        }
        _ => true,
    });
    if animations.is_empty() {
        root.remove("animations");
    }
    Ok(())
}
