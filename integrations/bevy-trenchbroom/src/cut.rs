//! Meshes cut into parts.

use crate::world::{World, bits};
use bevy::mesh::{Indices, PrimitiveTopology, VertexAttributeValues};
use bevy::prelude::*;
use std::collections::BTreeMap;
use std::fmt;

/// On meshes of a map that were looked at.
#[derive(Component, Debug, Clone, Copy, PartialEq, Eq, Reflect)]
#[reflect(Component, Clone)]
pub struct PvsMapCut {
    /// How many parts took its place; 0 for a mesh that stays whole.
    pub n_parts: u32,
    /// Triangles that are of no face of the world, which are always drawn.
    pub n_loose: u32,
}

/// A part of a mesh.
pub(crate) struct Part {
    pub(crate) mesh: Mesh,
    /// The faces that it shows, ascending; none for triangles that are of no face.
    pub(crate) faces: Vec<u32>,
    pub(crate) n_triangles: u32,
}

/// Why a mesh is not cut.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Uncut {
    /// It is in the memory of the device only.
    Gone,
    /// It has no triangles with corners of three coordinates.
    NoTriangles,
}

impl fmt::Display for Uncut {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Gone => "it is not in memory; `brush_mesh_asset_usages` has to keep it",
            Self::NoTriangles => "it is no list of triangles",
        })
    }
}

/// The bits of a mesh's corners, and which of them each triangle has.
type Triangles = (Vec<[u32; 3]>, Vec<[usize; 3]>);

fn triangles(mesh: &Mesh) -> Result<Triangles, Uncut> {
    let positions = mesh.try_attribute(Mesh::ATTRIBUTE_POSITION).map_err(|_| Uncut::Gone)?;
    let indices = mesh.try_indices().map_err(|_| Uncut::NoTriangles)?;
    let (VertexAttributeValues::Float32x3(positions), PrimitiveTopology::TriangleList) =
        (positions, mesh.primitive_topology())
    else {
        return Err(Uncut::NoTriangles);
    };
    let corners: Vec<[u32; 3]> = positions.iter().map(|&at| bits(Vec3::from_array(at))).collect();
    let indices: Vec<usize> = indices.iter().collect();
    let (all, rest) = indices.as_chunks::<3>();
    let is_whole = rest.is_empty() && indices.iter().all(|&k| k < corners.len());
    if is_whole { Ok((corners, all.to_vec())) } else { Err(Uncut::NoTriangles) }
}

/// Cuts a mesh of the world into parts: each triangle goes to the part of the face that it is of, found by the bits of its corners. One that several
/// faces have goes to the first one's part, which then shows all of them. O(parts · corners).
pub(crate) fn cut(mesh: &Mesh, world: &World) -> Result<Vec<Part>, Uncut> {
    let (corners, triangles) = triangles(mesh)?;
    let mut parts = BTreeMap::<Option<u32>, (Vec<u32>, Vec<u32>)>::new();
    for triangle in triangles {
        let faces = world.of_triangle.get(&triangle.map(|k| corners[k])).map_or(&[][..], Vec::as_slice);
        let (shown, indices) = parts.entry(faces.first().map(|&face| world.part_of[face as usize])).or_default();
        shown.extend_from_slice(faces);
        indices.extend(triangle.map(|k| k as u32));
    }
    let part = |(shown, indices): (Vec<u32>, Vec<u32>)| {
        let mut faces = shown;
        faces.sort_unstable();
        faces.dedup();
        let n_triangles = indices.len() as u32 / 3;
        let mut part = mesh.clone();
        part.insert_indices(Indices::U32(indices));
        // Leaves the corners of these triangles, whatever attributes they have.
        part.duplicate_vertices();
        Part { mesh: part, faces, n_triangles }
    };
    Ok(parts.into_values().map(part).collect())
}
