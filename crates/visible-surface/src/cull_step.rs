//! Ways to leave faces out, by name.

use crate::camera::Camera;
use crate::cull;
use crate::face_mask::FaceMask;
use crate::faces::Faces;
use crate::hierarchical::{self, DepthPyramid};
use crate::method::{RenderInput, VisibleSurface};
use crate::zbuffer::{DepthFormat, ZBuffer};

/// A way to leave faces out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CullStep {
    /// Those that show their backs.
    Backface,
    /// Those outside the view frustum.
    Frustum,
    /// Those of objects that a visibility table hides.
    Pvs,
    /// Those behind a hierarchical z-buffer of the others.
    HierarchicalZ,
}

impl CullStep {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Backface, Self::Frustum, Self::Pvs, Self::HierarchicalZ];

    /// Lower-case name for options.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Backface => "backface",
            Self::Frustum => "frustum",
            Self::Pvs => "pvs",
            Self::HierarchicalZ => "hierarchical-z",
        }
    }

    /// Leaves faces out of `chosen`, and says how many.
    ///
    /// * `seen`: whether a visibility table shows each object; `None` without one, which leaves nothing out
    ///
    /// # Panics
    /// If `seen` lacks an object.
    pub fn apply(self, faces: &Faces, camera: &Camera, seen: Option<&[bool]>, chosen: &mut FaceMask) -> u64 {
        match self {
            Self::Backface => cull::backface(faces, camera, chosen),
            Self::Frustum => cull::frustum(faces, camera, chosen),
            Self::Pvs => seen.map_or(0, |seen| cull::objects(faces, chosen, |object| seen[object as usize])),
            Self::HierarchicalZ => {
                let (image, _) = ZBuffer::new(DepthFormat::Exact).picture(&RenderInput { faces, camera, mask: chosen });
                hierarchical::cull(faces, chosen, &DepthPyramid::sampled(faces, camera, &image))
            }
        }
    }
}
