//! The faces of a map's world: model 0, which does not move.

use bevy::platform::collections::HashMap;
use bevy::prelude::*;
use bevy_sightlines::{PvsScene, PvsSource};
use bevy_trenchbroom::config::TrenchBroomConfig;
use qbsp::BspData;

/// The bits of a triangle's corners, as meshes of the map have them.
pub(crate) type Corners = [[u32; 3]; 3];

/// The faces of a world.
pub(crate) struct World {
    sources: Vec<PvsSource>,
    /// For each face the part that it goes into.
    pub(crate) part_of: Vec<u32>,
    /// The faces of each triangle. Several, if they share a triangle.
    pub(crate) of_triangle: HashMap<Corners, Vec<u32>>,
}

/// Takes coordinates of the map to those of Bevy, as `bevy_trenchbroom` does: x goes to -z, y to -x, and z to y, all divided by the scale.
pub(crate) fn to_bevy(scale: f32) -> Transform {
    // Halves: the turn has no rounding.
    Transform::from_rotation(Quat::from_xyzw(-0.5, 0.5, 0.5, 0.5)).with_scale(Vec3::splat(1.0 / scale))
}

pub(crate) fn bits(corner: Vec3) -> [u32; 3] {
    // Zero has two signs.
    corner.to_array().map(|x| (x + 0.0).to_bits())
}

impl World {
    /// Reads the faces, and the leafs that list them. O(map).
    pub(crate) fn new(map: &BspData, config: &TrenchBroomConfig, leafs_of_part: u32) -> Self {
        let Some(model) = map.models.first() else {
            return Self { sources: Vec::new(), part_of: Vec::new(), of_triangle: HashMap::default() };
        };
        let first = model.first_face;
        let mut part_of = vec![u32::MAX; model.num_faces as usize];
        for (leaf, record) in map.leaves.iter().enumerate() {
            let listed = map.mark_surfaces.iter().skip(record.face_idx.0 as usize).take(record.face_num.0 as usize);
            for face in listed {
                let part = face.0.checked_sub(first).and_then(|face| part_of.get_mut(face as usize));
                part.into_iter().for_each(|part| *part = (*part).min(leaf as u32 / leafs_of_part));
            }
        }
        let mut sources = Vec::with_capacity(part_of.len());
        let mut of_triangle = HashMap::<Corners, Vec<u32>>::default();
        for (k, face) in (0..).zip(map.faces.iter().skip(first as usize).take(part_of.len())) {
            let corners: Vec<Vec3> = face.vertices(map).collect();
            sources.push(source(first + k, &corners));
            let corners: Vec<Vec3> = corners.into_iter().map(|corner| config.to_bevy_space(corner)).collect();
            for pair in corners.get(1..).unwrap_or_default().windows(2) {
                of_triangle.entry([corners[0], pair[1], pair[0]].map(bits)).or_default().push(k);
            }
        }
        Self { sources, part_of, of_triangle }
    }

    /// What the plugin compares with the objects of a table.
    pub(crate) fn scene(&self) -> PvsScene {
        PvsScene { sources: self.sources.clone() }
    }
}

/// A face as a table has it: by its number in the map.
fn source(face: u32, corners: &[Vec3]) -> PvsSource {
    let (mut min, mut max) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for corner in corners {
        let corner = corner.to_array().map(f64::from);
        min = std::array::from_fn(|k| min[k].min(corner[k]));
        max = std::array::from_fn(|k| max[k].max(corner[k]));
    }
    if corners.is_empty() {
        (min, max) = ([0.0; 3], [0.0; 3]);
    }
    PvsSource { node: face, name: format!("face {face}"), min, max, ..PvsSource::default() }
}
