//! Instances of a mesh: `EXT_mesh_gpu_instancing` draws the mesh of a node once for each of a list of transforms.

use super::accessor::{AccessorRole, Elements};
use super::buffers::Buffers;
use super::json::Document;
use super::movers::{INSTANCING, Instances};
use super::transform::Transform;
use crate::error::{Malformed, malformed};
use sightlines_cells::Point3;

/// Where each instance is in the coordinates of its node.
///
/// # Errors
/// [`Malformed`]: no attribute, one that cannot be read or has another number of elements, a rotation that is none.
///
/// # Source
/// The specification of `EXT_mesh_gpu_instancing`: the transform of an instance is applied before that of the node.
pub(super) fn transforms(
    instances: &Instances,
    document: &Document,
    buffers: &Buffers<'_>,
) -> Result<Vec<Transform>, Malformed> {
    let [translation, rotation, scale] = *instances;
    let misfit =
        |attribute: &str, accessor: usize| malformed!("{INSTANCING}: {attribute} (accessor {accessor}) does not fit");
    let read = |attribute: &'static str, accessor: Option<usize>, kind: &str| {
        let Some(accessor) = accessor else { return Ok(None) };
        let of_kind = document.accessors.get(accessor).is_some_and(|a| a.kind == kind);
        match Elements::new(document, buffers, accessor, AccessorRole::Attribute) {
            Ok(elements) if of_kind => Ok(Some((elements, attribute, accessor))),
            _ => Err(misfit(attribute, accessor)),
        }
    };
    let all =
        [read("TRANSLATION", translation, "VEC3")?, read("ROTATION", rotation, "VEC4")?, read("SCALE", scale, "VEC3")?];
    let n = all.iter().flatten().map(|(elements, ..)| elements.count).min().ok_or_else(no_instances)?;
    if let Some((_, attribute, accessor)) = all.iter().flatten().find(|(elements, ..)| elements.count != n) {
        return Err(misfit(attribute, *accessor));
    }
    let [translation, rotation, scale] = all.map(|found| found.map(|(elements, ..)| elements));
    let numbers = |of: Option<Elements<'_>>, k: usize| of.map(|elements| elements.normalized_numbers(k));
    let point = |of, k, without: Point3| numbers(of, k).and_then(|all| all.try_into().ok()).unwrap_or(without);
    let transform = |k: usize| {
        let turn = numbers(rotation, k).and_then(|numbers| numbers.try_into().ok()).unwrap_or([0.0, 0.0, 0.0, 1.0]);
        Transform::from_parts(point(translation, k, [0.0; 3]), turn, point(scale, k, [1.0; 3]))
    };
    (0..n).map(transform).collect()
}

/// The error of a mesh that is to be drawn many times, and nowhere.
pub(super) fn no_instances() -> Malformed {
    malformed!("{INSTANCING} without TRANSLATION, ROTATION or SCALE")
}
