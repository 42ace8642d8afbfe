//! The lowest level from a picture.

use super::footprint::nearness_below;
use super::level::PyramidLevel;
use crate::camera::Camera;
use crate::faces::{Faces, NOTHING};
use crate::fragment::{Extents, facing};
use crate::image::Image;
use crate::nearness::Nearness;

/// Bounds of the nearness of a face.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bounds {
    /// Of its plane, as a function of the place in the picture.
    pub(super) plane: Nearness,
    /// Of its farthest corner, a lower bound.
    pub(super) least: f64,
}

impl Bounds {
    /// Of a face; none if it is seen edge-on, or if nothing is in front.
    pub(super) fn of(camera: &Camera, faces: &Faces, face: u32) -> Option<Self> {
        facing(camera, faces, face)?;
        let extents = Extents::around(faces.of(face).map(|p| camera.place(p)));
        let farthest = Some(extents.depth[1]).filter(|&t| t > 0.0)?;
        Some(Self { plane: Nearness::of(camera, faces, face), least: nearness_below(farthest) })
    }
}

/// Writes for each pixel that shows a face how near that is at the pixel's centre, or a little less.
pub(super) fn fill(faces: &Faces, camera: &Camera, image: &Image, base: &mut PyramidLevel) {
    let [width, height] = [0, 1].map(|k| camera.size()[k].min(image.size()[k]));
    // Neighbouring pixels mostly show one face.
    let mut last = (NOTHING, None);
    for y in 0..height {
        let row = base.row_mut(y);
        for x in 0..width {
            let face = image.at(x, y);
            if face as usize >= faces.len() {
                continue;
            }
            if face != last.0 {
                last = (face, Bounds::of(camera, faces, face));
            }
            if let Some(bounds) = last.1 {
                // The plane's bound tells near places; the corner's holds for any plane.
                let here = (bounds.plane.at(x, y) - bounds.plane.error).max(bounds.least);
                let kept = &mut row[x as usize];
                *kept = kept.max(here);
            }
        }
    }
}
