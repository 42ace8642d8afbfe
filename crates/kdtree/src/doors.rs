//! Doors of a scene: along which planes they stand shut, and which portals they close there.
//!
//! A door hides nothing, and its cells are cut as if it were open. But where one of its faces fills an opening, the cells are divided along
//! that face, so that there is a portal that it closes: each line through the portal meets the face.

use crate::face::AxialFace;
use crate::mesh::others;
use crate::scene_faces::scene_faces;
use crate::scene_options::SceneOptions;
use sightlines_cells::{AxialDoor, Scene};

/// What a door is as it stands in its scene: the rectangles of its largest plane.
#[derive(Debug, Clone, PartialEq)]
pub struct ShutDoor {
    /// The object.
    pub object: u32,
    /// Disjoint rectangles of one plane, all within the triangles of the door.
    pub faces: Vec<AxialFace<3>>,
}

impl ShutDoor {
    /// Whether the door closes a portal while it stands as it does in the scene: its faces lie in the plane of the portal and
    /// cover all of it. Exact.
    pub fn closes(&self, portal: &AxialDoor) -> bool {
        let axis = usize::from(portal.axis);
        let of = |min: &[f64; 3], max: &[f64; 3]| others(axis).map(|k| [min[k], max[k]]);
        let is_in_plane = |face: &&AxialFace<3>| face.axis == axis && face.at == portal.extent.min[axis];
        let faces: Vec<[[f64; 2]; 2]> = self.faces.iter().filter(is_in_plane).map(|f| of(&f.min, &f.max)).collect();
        is_covered(of(&portal.extent.min, &portal.extent.max), &faces)
    }
}

/// The doors of a scene that have faces perpendicular to an axis, in the order of their objects.
///
/// Of each door the plane with the most area counts, of several the first by axis and place: a leaf has two sides, and one portal is
/// enough. The area is rounded, which decides nothing but where cells are divided.
pub fn shut_doors(scene: &Scene) -> Vec<ShutDoor> {
    let of = |&object: &u32| {
        let alone = Scene::new(vec![scene.objects()[object as usize].clone()]).ok()?;
        let found = scene_faces(&alone, &SceneOptions { detail_below: Some(0.0), ..SceneOptions::default() });
        let area = |faces: &[AxialFace<3>]| -> f64 {
            faces.iter().map(|f| others(f.axis).map(|k| f.max[k] - f.min[k]).into_iter().product::<f64>()).sum()
        };
        let planes = found.faces.chunk_by(|a, b| (a.axis, a.at) == (b.axis, b.at));
        let largest = planes.reduce(|best, plane| if area(plane) > area(best) { plane } else { best })?;
        Some(ShutDoor { object, faces: largest.to_vec() })
    };
    scene.doors().iter().filter_map(of).collect()
}

/// Whether rectangles cover one, by comparisons alone. A rectangle without area is covered.
fn is_covered(rect: [[f64; 2]; 2], by: &[[[f64; 2]; 2]]) -> bool {
    let [u, v] = rect;
    if u[0] >= u[1] || v[0] >= v[1] {
        return true;
    }
    let Some((&[a, b], rest)) = by.split_first() else { return false };
    let (u_mid, v_mid) = ([u[0].max(a[0]), u[1].min(a[1])], [v[0].max(b[0]), v[1].min(b[1])]);
    if u_mid[0] >= u_mid[1] || v_mid[0] >= v_mid[1] {
        return is_covered(rect, rest);
    }
    // What is left: below and above along u, and beside what is in between along v.
    let left = [[[u[0], u_mid[0]], v], [[u_mid[1], u[1]], v], [u_mid, [v[0], v_mid[0]]], [u_mid, [v_mid[1], v[1]]]];
    left.into_iter().all(|part| is_covered(part, rest))
}
