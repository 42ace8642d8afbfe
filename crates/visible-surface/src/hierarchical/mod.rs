//! Hierarchical z: what hides behind what an eye has already been shown to see.
//!
//! A [`DepthPyramid`] keeps for each pixel of a picture from which depth on everything is hidden, and for squares of
//! pixels, of squares of squares and so on the farthest of these depths. What lies behind that in all pixels that it
//! may cover is hidden. Few numbers answer for a large box; where the coarse ones are inconclusive, finer ones are
//! read.
//!
//! What "a pixel" is, is a matter of choice: [`Rays`].
//!
//! Depths are kept as *nearness*, one over the depth, which is linear in the picture, larger where it is nearer, and 0
//! for what is infinitely far away. All numbers are bounds, rounded towards visible: kept ones are farther than what is
//! there, asked ones nearer.
//!
//! Source: Greene, Kass and Miller, "Hierarchical Z-Buffer Visibility", SIGGRAPH 1993. Pixels that single faces cover
//! wholly: "inner-conservative rasterisation" of Hasselgren, Akenine-Möller and Ohlsson, GPU Gems 2, 2005, chapter 42.
//! Going on across edges that faces share is our own.

mod footprint;
mod inner;
mod level;
mod neighbours;
mod pyramid;
mod sampled;

pub use level::PyramidLevel;
pub use neighbours::Neighbours;
pub use pyramid::DepthPyramid;

use crate::cull::object_boxes;
use crate::face_mask::FaceMask;
use crate::faces::Faces;

/// What it means that something is hidden.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rays {
    /// The rays through the centres of pixels do not see it: no pixel of this picture would change.
    Centres,
    /// No ray of the picture sees it, wherever in a pixel.
    All,
}

/// Takes away the faces that a pyramid hides, first by the boxes of objects and then one by one; how many went. What is
/// outside of the picture or of the depths that the camera sees goes as well, for nothing would change.
///
/// The faces of the pyramid may be tested too: a face does not hide itself, and visible faces stay.
pub fn cull(faces: &Faces, chosen: &mut FaceMask, pyramid: &DepthPyramid) -> u64 {
    let hidden: Vec<bool> = object_boxes(faces, chosen).iter().map(|b| pyramid.hides(b)).collect();
    chosen.retain(|face| !hidden[faces.object(face) as usize] && !pyramid.hides_hull(faces.of(face)))
}
