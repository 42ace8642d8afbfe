//! Instances of a mesh: `EXT_mesh_gpu_instancing` draws the mesh of a node once for each of a list of transforms.

use super::accessor::Elements;
use super::buffers::Buffers;
use super::error::{AccessorRole, NodeErrorKind};
use super::json::Document;
use super::movers::Instances;
use super::transform::Transform;
use sightlines_cells::Point3;

/// Where each instance is in the coordinates of its node.
///
/// # Errors
/// [`NodeErrorKind`]: no attribute, one that cannot be read or has another number of elements, a rotation that is none.
///
/// # Source
/// The specification of `EXT_mesh_gpu_instancing`: the transform of an instance is applied before that of the node.
pub(super) fn transforms(
    instances: &Instances,
    document: &Document,
    buffers: &Buffers<'_>,
) -> Result<Vec<Transform>, NodeErrorKind> {
    let [translation, rotation, scale] = instances.attributes;
    let read = |attribute: &'static str, accessor: Option<usize>, kind: &str| {
        let Some(accessor) = accessor else { return Ok(None) };
        let failed = NodeErrorKind::Instances { attribute, accessor };
        let of_kind = document.accessors.get(accessor).is_some_and(|a| a.kind == kind);
        match Elements::new(document, buffers, accessor, AccessorRole::Attribute) {
            Ok(elements) if of_kind => Ok(Some((elements, failed))),
            _ => Err(failed),
        }
    };
    let all =
        [read("TRANSLATION", translation, "VEC3")?, read("ROTATION", rotation, "VEC4")?, read("SCALE", scale, "VEC3")?];
    let n = all.iter().flatten().map(|(elements, _)| elements.count).min().ok_or(NodeErrorKind::NoInstances)?;
    if let Some((_, failed)) = all.iter().flatten().find(|(elements, _)| elements.count != n) {
        return Err(failed.clone());
    }
    let [translation, rotation, scale] = &all;
    let numbers = |of: &Option<(Elements<'_>, NodeErrorKind)>, k: usize| {
        of.as_ref().map(|(elements, _)| elements.normalized_numbers(k))
    };
    let point = |of: &Option<_>, k: usize, without: Point3| -> Point3 {
        numbers(of, k).and_then(|numbers| numbers.try_into().ok()).unwrap_or(without)
    };
    let transform = |k: usize| {
        let turn = numbers(rotation, k).and_then(|numbers| numbers.try_into().ok()).unwrap_or([0.0, 0.0, 0.0, 1.0]);
        Transform::from_parts(point(translation, k, [0.0; 3]), turn, point(scale, k, [1.0; 3]))
    };
    (0..n).map(transform).collect()
}
