//! Comparing pictures of one shot.

use crate::camera::Camera;
use crate::faces::{Faces, NOTHING};
use crate::image::Image;
use crate::method::RenderInput;
use crate::plane::InputPlane;
use crate::raycast::covers;
use crate::side::Side;

/// How a picture differs from another one.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Comparison {
    /// Pixels, as x and y, that show another face.
    pub wrong: Vec<[u32; 2]>,
    /// Of the pixels that show another face, those where either may be shown: the ray through the centre meets both faces, which are
    /// not in one plane, at the same depth, exactly. They are not among `wrong`.
    pub ties: u64,
}

/// Compares a picture of a shot with a reference.
///
/// # Panics
/// If the sizes differ.
pub fn compare(input: &RenderInput<'_>, reference: &Image, image: &Image) -> Comparison {
    let mut out = Comparison::default();
    for [x, y] in reference.differing(image) {
        if is_tie(input.camera, input.faces, [reference.at(x, y), image.at(x, y)], x, y) {
            out.ties += 1;
        } else {
            out.wrong.push([x, y]);
        }
    }
    out
}

/// Whether the ray of a pixel meets two faces, which lie in different planes, at the same depth.
fn is_tie(camera: &Camera, faces: &Faces, pair: [u32; 2], x: u32, y: u32) -> bool {
    if pair.contains(&NOTHING) || !pair.iter().all(|&f| covers(camera, faces, f, x, y)) {
        return false;
    }
    let [a, b] = pair.map(|f| InputPlane::of(faces, f));
    !a.is_same(faces, &b) && Side::cut(camera, faces, a, b).sign(camera, faces, x, y) == 0
}
