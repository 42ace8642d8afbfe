//! Culling: which faces need not be drawn, whatever draws them.
//!
//! Each function takes faces away from a [`FaceMask`] and says how many. What it takes away covers no pixel
//! ([`frustum()`]), shows only its back ([`backface()`]), or belongs to objects that the caller knows to be hidden
//! ([`objects`]). What hides behind other faces is the subject of [`hierarchical`](crate::hierarchical).

mod backface;
mod frustum;
pub mod transform;

pub use backface::{Facing, backface, backface_region, corners_of, facing};
pub use frustum::{Cover, Frustum, frustum};

use crate::face_mask::FaceMask;
use crate::faces::Faces;
use sightlines_geometry::coordinate::MAX_MAGNITUDE;
use sightlines_geometry::{Aabb, Point3};

/// Keeps the faces of the objects for which `keep` returns `true`, for callers with a visibility table. Returns the
/// number of removed faces.
pub fn objects(faces: &Faces, chosen: &mut FaceMask, keep: impl Fn(u32) -> bool) -> u64 {
    chosen.retain(|face| keep(faces.object(face)))
}

/// For each object the smallest box around those of its faces that are chosen; [`Aabb::EMPTY`] where none is.
pub fn object_boxes(faces: &Faces, chosen: &FaceMask) -> Vec<Aabb<3>> {
    let n = faces.ids().map(|f| faces.object(f) as usize + 1).max().unwrap_or(0);
    let mut boxes = vec![Aabb::EMPTY; n];
    for face in chosen.iter() {
        let own = &mut boxes[faces.object(face) as usize];
        *own = faces.of(face).iter().fold(*own, |all, &p| all.with(p));
    }
    boxes
}

/// Whether coordinates are numbers of a size with which nothing overflows. Smaller ones than a scene may have do no harm.
pub(crate) fn is_usable(points: &[Point3]) -> bool {
    points.iter().flatten().all(|x| x.abs() <= MAX_MAGNITUDE)
}
