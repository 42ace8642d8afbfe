//! The pyramid itself, and asking it.

use super::footprint::{Footprint, nearness_below};
use super::level::PyramidLevel;
use super::{Neighbours, Rays, inner, sampled};
use crate::camera::Camera;
use crate::cull::{corners_of, is_usable};
use crate::face_mask::FaceMask;
use crate::faces::Faces;
use crate::image::Image;
use crate::window::Window;
use sightlines_geometry::{Aabb, Point3};

/// For squares of pixels from which depth on everything is hidden. See the [module](super).
#[derive(Debug, Clone, PartialEq)]
pub struct DepthPyramid {
    camera: Camera,
    rays: Rays,
    levels: Vec<PyramidLevel>,
}

/// A footprint is first tested in at most this many squares along each side.
const AT_FIRST: u32 = 4;

impl DepthPyramid {
    /// From a picture of some of the faces that was drawn with this camera: what lies behind what is seen at the centres
    /// of pixels. [`Rays::Centres`].
    ///
    /// The depth of the face at each pixel is computed anew, so any method may have drawn it; but the picture is believed. Pixels
    /// that it does not have hide nothing, and neither do those with faces that do not exist.
    ///
    /// Cost: some operations for each pixel.
    pub fn sampled(faces: &Faces, camera: &Camera, image: &Image) -> Self {
        let mut base = Self::base(camera);
        sampled::fill(faces, camera, image, &mut base);
        Self::of(camera, Rays::Centres, base, f64::min)
    }

    /// From faces: what lies behind those pixels that they cover wholly. [`Rays::All`].
    ///
    /// A pixel counts if a face covers it wholly, or several do that share edges. It costs more than drawing; few large
    /// faces hide nearly as much as all.
    pub fn conservative(faces: &Faces, camera: &Camera, chosen: &FaceMask) -> Self {
        Self::with_neighbours(faces, &Neighbours::of(faces), camera, chosen)
    }

    /// The same, for callers that keep the data shared by all eyes.
    ///
    /// `neighbours`: of these very faces
    pub fn with_neighbours(faces: &Faces, neighbours: &Neighbours, camera: &Camera, chosen: &FaceMask) -> Self {
        let mut base = Self::base(camera);
        inner::fill(faces, neighbours, camera, chosen, &mut base);
        Self::of(camera, Rays::All, base, f64::min)
    }

    /// Pixels that nothing covers: what is beyond the farthest depth is hidden all the same.
    fn base(camera: &Camera) -> PyramidLevel {
        let size = camera.size();
        PyramidLevel { size, nearness: vec![nearness_below(camera.depths()[1]); size[0] as usize * size[1] as usize] }
    }

    /// Puts levels above the lowest; `farthest` is the lesser of two numbers, but for a test that shows that it has to be.
    fn of(camera: &Camera, rays: Rays, base: PyramidLevel, farthest: fn(f64, f64) -> f64) -> Self {
        let mut levels = vec![base];
        while let Some(last) = levels.last().filter(|l| l.size != [1, 1]) {
            let next = last.halved(farthest);
            levels.push(next);
        }
        Self { camera: *camera, rays, levels }
    }

    /// Which rays it answers for.
    pub fn rays(&self) -> Rays {
        self.rays
    }

    /// The levels, from pixels up to a single square.
    pub fn levels(&self) -> &[PyramidLevel] {
        &self.levels
    }

    /// Whether no ray that it answers for sees anything in a closed box: in front of it there is always something.
    ///
    /// Errs towards visible. What may reach the eye or behind it, and what has coordinates that no scene may have, is not
    /// hidden; what is surely outside of the picture or of the depths that the camera sees is.
    pub fn hides(&self, b: &Aabb<3>) -> bool {
        b.is_empty() || is_usable(&[b.min, b.max]) && self.hides_points(corners_of(b))
    }

    /// The same for the convex hull of points.
    pub fn hides_hull(&self, points: &[Point3]) -> bool {
        points.is_empty() || is_usable(points) && self.hides_points(points.iter().copied())
    }

    fn hides_points(&self, points: impl IntoIterator<Item = Point3>) -> bool {
        let footprint = Footprint::of(&self.camera, self.rays, points);
        let Window { min, max } = footprint.pixels;
        if footprint.pixels.is_empty() {
            return true;
        }
        // What nothing can hide needs no squares.
        if footprint.nearness == f64::INFINITY {
            return false;
        }
        let squares = |level: usize, k: usize| ((max[k] - 1) >> level) - (min[k] >> level) + 1;
        let mut level = 0;
        while level + 1 < self.levels.len() && (0..2).any(|k| squares(level, k) > AT_FIRST) {
            level += 1;
        }
        let range = |k: usize| min[k] >> level..=(max[k] - 1) >> level;
        range(1).all(|y| range(0).all(|x| self.square_hides(level, x, y, &footprint)))
    }

    /// Whether a footprint is hidden in all of its pixels below a square.
    fn square_hides(&self, level: usize, x: u32, y: u32, footprint: &Footprint) -> bool {
        if self.levels[level].at(x, y) > footprint.nearness {
            return true;
        }
        if level == 0 {
            return false;
        }
        let Window { min, max } = footprint.pixels;
        let below = level - 1;
        let range = |k: usize, at: u32| (2 * at).max(min[k] >> below)..=(2 * at + 1).min((max[k] - 1) >> below);
        range(1, y).all(|y| range(0, x).all(|x| self.square_hides(below, x, y, footprint)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A pyramid that keeps the nearest of each square is caught: it hides what is seen through an open column of pixels.
    #[test]
    fn the_farthest_depth_it_has_to_be() {
        let camera =
            Camera::look_at([0.0; 3], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0], 90.0, [32, 32]).expect("it looks ahead");
        let mut base = DepthPyramid::base(&camera);
        (0..32).for_each(|y| base.row_mut(y)[..15].fill(0.5));
        let of = |farthest| DepthPyramid::of(&camera, Rays::All, base.clone(), farthest);
        let behind = |from: f64, to: f64| Aabb { min: [from, -3.5, 4.0], max: [to, 3.5, 5.0] };
        // Which half of the picture the wall covers does not matter here. It leaves the column next to the middle open.
        let (wall, open) = if of(f64::min).hides(&behind(-3.5, -0.5)) {
            (behind(-3.5, -0.5), behind(-3.5, -0.05))
        } else {
            (behind(0.5, 3.5), behind(0.05, 3.5))
        };
        assert_eq!([wall, open].map(|b| of(f64::min).hides(&b)), [true, false]);
        assert_eq!([wall, open].map(|b| of(f64::max).hides(&b)), [true, true]);
    }

    #[test]
    fn every_square_is_the_least_below_it() {
        let camera =
            Camera::look_at([0.0; 3], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0], 90.0, [13, 6]).expect("it looks ahead");
        let mut base = DepthPyramid::base(&camera);
        for y in 0..6 {
            (0..).zip(base.row_mut(y)).for_each(|(x, v)| *v = f64::from((7 * x + 31 * y) % 23));
        }
        let pyramid = DepthPyramid::of(&camera, Rays::All, base, f64::min);
        assert_eq!(pyramid.levels().len(), 5);
        for (k, level) in pyramid.levels().iter().enumerate() {
            for y in 0..level.size()[1] {
                for x in 0..level.size()[0] {
                    let below = (0..6u32).filter(|v| v >> k == y).flat_map(|v| (0..13u32).map(move |u| (u, v)));
                    let least = below.filter(|(u, _)| u >> k == x).map(|(u, v)| f64::from((7 * u + 31 * v) % 23));
                    assert_eq!(level.at(x, y), least.fold(f64::INFINITY, f64::min));
                }
            }
        }
    }
}
