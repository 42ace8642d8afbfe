//! View-volume culling: what lies outside of what the camera sees.
//!
//! The view volume is what rays of the picture meet between the nearest and the farthest depth. Its sides are planes
//! through the eye and the picture's edges. Products are taken in doubles with derived bounds, and only what is surely
//! outside is called so.

use super::{is_usable, object_boxes};
use crate::camera::{Camera, TINY_ERROR, U};
use crate::face_mask::FaceMask;
use crate::faces::Faces;
use crate::vector::{dot, dot_size, sub};
use sightlines_geometry::{Aabb, Point3};

/// How something lies to the view volume.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cover {
    /// Surely all of it is inside.
    Inside,
    /// Neither is sure.
    Across,
    /// Surely no point of it is inside or on the boundary.
    Outside,
}

/// A side of the volume: points p are inside where `normal · (p - eye)` is at least a number.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Side {
    normal: Point3,
    /// What rounding is measured by.
    size: Point3,
    /// Bounds of that number.
    at: [f64; 2],
}

/// What a camera sees, as a convex volume: the sides of the picture, the least depth and the greatest.
///
/// Answers may say [`Cover::Across`] of something that is outside near an edge of the volume: each side is tested
/// separately, and the smallest box around the volume besides. No answer is wrong the other way. What has coordinates
/// that no scene may have, or none, is [`Cover::Across`]; what is empty is outside.
#[derive(Debug, Clone, PartialEq)]
pub struct Frustum {
    eye: Point3,
    sides: Vec<Side>,
    bounds: Aabb<3>,
}

impl Frustum {
    /// The volume of a camera.
    pub fn of(camera: &Camera) -> Self {
        let [x, y, depth] = camera.normals();
        let [x_size, y_size, depth_size] = camera.normal_sizes();
        let size = camera.size().map(f64::from);
        let through_eye = |normal: Point3, size: Point3| Side { normal, size, at: [0.0; 2] };
        // Pixels to the right, times depth, are x · (p - eye), and depth is depth · (p - eye): so left of the right edge is
        // where width * depth - x is not negative. What is on the inner side of both edges is not behind the eye.
        let opposite = |k: usize, n: Point3, n_size: Point3| {
            through_eye(
                [0, 1, 2].map(|i| size[k] * depth[i] - n[i]),
                [0, 1, 2].map(|i| size[k] * depth_size[i] + n_size[i]),
            )
        };
        let [near, far] = camera.depths();
        let (volume, error) = camera.volume();
        let volume = [volume - error, volume + error];
        let at = [near * volume[0] * (1.0 - 8.0 * U), near * volume[1] * (1.0 + 8.0 * U)];
        let mut sides = vec![
            through_eye(x, x_size),
            through_eye(y, y_size),
            opposite(0, x, x_size),
            opposite(1, y, y_size),
            // With 0 for the nearest depth it takes nothing away, but it tells sooner what is behind the eye.
            Side { normal: depth, size: depth_size, at },
        ];
        if far < f64::INFINITY {
            let at = [-far * volume[1] * (1.0 + 8.0 * U), -far * volume[0] * (1.0 - 8.0 * U)];
            sides.push(Side { normal: depth.map(|x| -x), size: depth_size, at });
        }
        Self { eye: camera.eye(), sides, bounds: bounds(camera) }
    }

    /// The smallest box around the volume, rounded outwards; may be infinite.
    pub fn bounds(&self) -> &Aabb<3> {
        &self.bounds
    }

    /// How a closed box lies to the volume.
    pub fn of_box(&self, b: &Aabb<3>) -> Cover {
        if b.is_empty() {
            return Cover::Outside;
        }
        if !is_usable(&[b.min, b.max]) {
            return Cover::Across;
        }
        if self.is_apart(b) {
            return Cover::Outside;
        }
        let (low, high) = (sub(b.min, self.eye), sub(b.max, self.eye));
        let farthest = [0, 1, 2].map(|k| low[k].abs().max(high[k].abs()));
        self.each(|side| {
            // The least and the greatest value over the box, axis by axis.
            let (mut least, mut greatest) = (0.0, 0.0);
            for k in 0..3 {
                let (a, b) = (side.normal[k] * low[k], side.normal[k] * high[k]);
                least += a.min(b);
                greatest += a.max(b);
            }
            // Of 16 roundings, five are in the normal, one in the difference and three in the product.
            let error = 16.0 * U * dot_size(side.size, farthest) + TINY_ERROR;
            [least - error, greatest + error]
        })
    }

    /// How the convex hull of points lies to the volume.
    pub fn of_hull(&self, points: &[Point3]) -> Cover {
        if points.is_empty() {
            return Cover::Outside;
        }
        if !is_usable(points) {
            return Cover::Across;
        }
        if self.is_apart(&Aabb::around(points.iter().copied())) {
            return Cover::Outside;
        }
        self.each(|side| {
            points.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[least, greatest], &p| {
                let way = sub(p, self.eye);
                let value = dot(side.normal, way);
                let error = 16.0 * U * dot_size(side.size, way) + TINY_ERROR;
                [least.min(value - error), greatest.max(value + error)]
            })
        })
    }

    /// How a closed ball lies to the volume; a negative radius counts as 0.
    pub fn of_sphere(&self, centre: Point3, radius: f64) -> Cover {
        let radius = if radius < 0.0 { 0.0 } else { radius };
        if !is_usable(&[centre, [radius; 3]]) {
            return Cover::Across;
        }
        let grown = |sign: f64| centre.map(|x| x + sign * (radius + 4.0 * U * (x.abs() + radius)));
        if self.is_apart(&Aabb { min: grown(-1.0), max: grown(1.0) }) {
            return Cover::Outside;
        }
        let way = sub(centre, self.eye);
        self.each(|side| {
            // The normal's length, at least: its own error is at most five roundings of its size.
            let length = dot(side.normal, side.normal).sqrt() + 8.0 * U * side.size.iter().sum::<f64>();
            let reach = radius * length * (1.0 + 8.0 * U) + TINY_ERROR;
            let value = dot(side.normal, way);
            let error = (16.0 * U * dot_size(side.size, way) + 4.0 * U * reach) + TINY_ERROR;
            [value - error - reach, value + error + reach]
        })
    }

    /// Puts together what each side says; `range` gives bounds of the values of a side.
    #[inline]
    fn each(&self, range: impl Fn(&Side) -> [f64; 2]) -> Cover {
        let mut cover = Cover::Inside;
        for side in &self.sides {
            let [least, greatest] = range(side);
            if greatest < side.at[0] {
                return Cover::Outside;
            }
            cover = if least > side.at[1] { cover } else { Cover::Across };
        }
        cover
    }

    fn is_apart(&self, b: &Aabb<3>) -> bool {
        (0..3).any(|k| b.max[k] < self.bounds.min[k] || b.min[k] > self.bounds.max[k])
    }
}

/// The smallest box around the view volume of a camera, rounded outwards. The volume is the hull of its four edges.
fn bounds(camera: &Camera) -> Aabb<3> {
    let [corner, across, down] = camera.rays();
    let [width, height] = camera.size().map(f64::from);
    let [near, far] = camera.depths();
    let mut all = Aabb::EMPTY;
    for (x, y) in [(0.0, 0.0), (width, 0.0), (0.0, height), (width, height)] {
        let ray = camera.ray(x, y);
        for k in 0..3 {
            let error = 8.0 * U * (corner[k].abs() + width * across[k].abs() + height * down[k].abs());
            let (low, high) = (ray[k] - error, ray[k] + error);
            // No product is of 0 and infinity: far is multiplied by what is not 0, near is finite.
            let least = if low < 0.0 { far * low } else { near * low };
            let greatest = if high > 0.0 { far * high } else { near * high };
            let round = |x: f64| 8.0 * U * (x.abs() + camera.eye()[k].abs()) + TINY_ERROR;
            all.min[k] = all.min[k].min(camera.eye()[k] + least - finite(round(least)));
            all.max[k] = all.max[k].max(camera.eye()[k] + greatest + finite(round(greatest)));
        }
    }
    all
}

/// What is not finite is taken as 0: infinite bounds need no room for rounding.
fn finite(x: f64) -> f64 {
    if x.is_finite() { x } else { 0.0 }
}

/// Takes away the faces that are surely outside of the view volume, first by the boxes of objects and then one by one;
/// how many went. No face goes that covers a pixel.
pub fn frustum(faces: &Faces, camera: &Camera, chosen: &mut FaceMask) -> u64 {
    let volume = Frustum::of(camera);
    let cover: Vec<Cover> = object_boxes(faces, chosen).iter().map(|b| volume.of_box(b)).collect();
    chosen.retain(|face| match cover[faces.object(face) as usize] {
        Cover::Inside => true,
        Cover::Across => volume.of_hull(faces.of(face)) != Cover::Outside,
        Cover::Outside => false,
    })
}
