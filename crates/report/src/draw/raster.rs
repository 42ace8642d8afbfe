//! Surfaces of a scene as pixels: the nearest one in each, shaded, for isometric views.

use super::space::{Up, depth_of, point_at, project};
use super::surfaces::Surface;
use crate::frame::Frame;
use crate::png::{Pixels, encode_small};
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use sightlines_geometry::{Point2, Point3};
use std::fmt::Write;

/// Up to this size in pixels, a pixel is the mean of four samples.
const MOST_SMOOTHED: u32 = 2400;
/// No surface.
const NONE: u32 = u32::MAX;

/// The nearest surface of each sample, row by row from the upper left corner.
pub(super) struct Raster<'a> {
    frame: &'a Frame,
    up: Up,
    /// Samples of a pixel along a side.
    fine: u32,
    size: [usize; 2],
    /// Larger is nearer.
    depths: Vec<f32>,
    nearest: Vec<u32>,
    surfaces: Vec<Drawn>,
}

/// A surface that was drawn.
struct Drawn {
    /// Towards the viewer, of length 1.
    normal: Point3,
    /// By how much the depth grows from a sample to the next one to the right and down.
    slopes: [f64; 2],
}

impl<'a> Raster<'a> {
    /// Draws surfaces that look at the viewer, or have two sides; of each the part that is not above `below`.
    /// O(surfaces + samples that they cover).
    pub(super) fn of(surfaces: impl Iterator<Item = Surface>, frame: &'a Frame, up: Up, below: Option<f64>) -> Self {
        let fine = if frame.width.max(frame.height) <= MOST_SMOOTHED { 2 } else { 1 };
        let size = [frame.width, frame.height].map(|x| (x * fine) as usize);
        let n = size[0] * size[1];
        let mut raster = Self {
            frame,
            up,
            fine,
            size,
            depths: vec![f32::NEG_INFINITY; n],
            nearest: vec![NONE; n],
            surfaces: Vec::new(),
        };
        for surface in surfaces {
            raster.add(&surface, below.unwrap_or(f64::INFINITY));
        }
        raster
    }

    fn add(&mut self, surface: &Surface, below: f64) {
        let [a, b, c] = surface.corners;
        let side = |p: Point3| -> Point3 { std::array::from_fn(|k| p[k] - a[k]) };
        let ([x, y, z], [u, v, w]) = (side(b), side(c));
        let normal = [y * w - z * v, z * u - x * w, x * v - y * u];
        let length = normal.iter().map(|x| x * x).sum::<f64>().sqrt();
        let towards = normal.iter().sum::<f64>();
        // What is seen along its edge covers nothing.
        if !(length > 0.0 && length.is_finite()) || towards == 0.0 || (surface.is_single_sided && towards < 0.0) {
            return;
        }
        let axis = self.up.axis();
        if surface.corners.iter().all(|p| p[axis] > below) {
            return;
        }
        let normal = normal.map(|x| x * towards.signum() / length);
        let fine = f64::from(self.fine);
        let place = |p: Point3| self.frame.place(project(p, self.up)).map(|x| x * fine);
        let corners = surface.corners.map(place);
        let depths = surface.corners.map(depth_of);
        // The depth as a plane over the samples.
        let [[x0, y0], [x1, y1], [x2, y2]] = corners;
        let area = (x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0);
        let [d1, d2] = [depths[1] - depths[0], depths[2] - depths[0]];
        let slopes = [(d1 * (y2 - y0) - d2 * (y1 - y0)) / area, (d2 * (x1 - x0) - d1 * (x2 - x0)) / area];
        if !slopes.iter().all(|slope| slope.is_finite()) {
            return;
        }
        let id = self.surfaces.len() as u32;
        self.surfaces.push(Drawn { normal, slopes });
        let row_of = |y: f64, most: usize| (y - 0.5).ceil().clamp(0.0, most as f64) as usize;
        let (low, high) = (y0.min(y1).min(y2), y0.max(y1).max(y2));
        for row in row_of(low, self.size[1])..row_of(high, self.size[1]) {
            let y = row as f64 + 0.5;
            let (mut left, mut right) = (f64::INFINITY, f64::NEG_INFINITY);
            for [[ax, ay], [bx, by]] in [[0, 1], [1, 2], [2, 0]].map(|side| side.map(|i: usize| corners[i])) {
                if (ay <= y) != (by <= y) {
                    let x = ax + (y - ay) / (by - ay) * (bx - ax);
                    (left, right) = (left.min(x), right.max(x));
                }
            }
            for column in row_of(left, self.size[0])..row_of(right, self.size[0]) {
                let x = column as f64 + 0.5;
                let depth = depths[0] + (x - x0) * slopes[0] + (y - y0) * slopes[1];
                let at = row * self.size[0] + column;
                if depth as f32 > self.depths[at] && self.point(x, y, depth)[axis] <= below {
                    (self.depths[at], self.nearest[at]) = (depth as f32, id);
                }
            }
        }
    }

    /// The point of the scene that is seen in a sample at a depth.
    fn point(&self, x: f64, y: f64, depth: f64) -> Point3 {
        let fine = f64::from(self.fine);
        point_at(self.frame.point([x / fine, y / fine]), depth, self.up)
    }

    /// The picture as an element of SVG. `colour` is what a point of a surface is coloured by, a little in front of it, before it is
    /// shaded.
    pub(super) fn image(&self, mut colour: impl FnMut(Point3) -> [u8; 3]) -> Option<String> {
        let [width, height] = self.size;
        let shades: Vec<f64> = self.surfaces.iter().map(|surface| self.shade(surface.normal)).collect();
        let aside = 1.5 / self.frame.scale;
        let mut samples = vec![[255u8; 3]; width * height];
        for row in 0..height {
            for column in 0..width {
                let at = row * width + column;
                let Some(surface) = self.surfaces.get(self.nearest[at] as usize) else { continue };
                let p = self.point(column as f64 + 0.5, row as f64 + 0.5, f64::from(self.depths[at]));
                let base = colour(std::array::from_fn(|k| p[k] + aside * surface.normal[k]));
                let mut light = shades[self.nearest[at] as usize];
                if self.is_edge(at, at + 1, column + 1 < width, 0) || self.is_edge(at, at + width, row + 1 < height, 1)
                {
                    light *= 0.45;
                }
                samples[at] = base.map(|part| (f64::from(part) * light).round().min(255.0) as u8);
            }
        }
        let fine = self.fine as usize;
        let n_samples = (fine * fine) as u32;
        let mut pixels = Vec::with_capacity(3 * samples.len() / n_samples as usize);
        for (y, x) in (0..height / fine).flat_map(|y| (0..width / fine).map(move |x| (y, x))) {
            let of = |k: usize| (0..fine * fine).map(move |i| ((fine * y + i / fine) * width + fine * x + i % fine, k));
            pixels.extend((0..3).map(|k| {
                let sum: u32 = of(k).map(|(at, k)| u32::from(samples[at][k])).sum();
                (sum / n_samples) as u8
            }));
        }
        let Frame { width, height, .. } = *self.frame;
        let png = encode_small([width, height], &pixels, Pixels::Rgb).ok()?;
        let mut out = String::new();
        let _ = writeln!(
            out,
            "<image width=\"{width}\" height=\"{height}\" href=\"data:image/png;base64,{}\"/>",
            STANDARD.encode(png)
        );
        Some(out)
    }

    /// Whether another surface begins behind a sample.
    fn is_edge(&self, at: usize, next: usize, is_there: bool, direction: usize) -> bool {
        if !is_there || self.nearest[at] == self.nearest[next] {
            return false;
        }
        let [here, there] = [at, next].map(|at| self.surfaces.get(self.nearest[at] as usize));
        let (Some(here), Some(there)) = (here, there) else { return true };
        let along: f64 = (0..3).map(|k| here.normal[k] * there.normal[k]).sum();
        let expected = f64::from(self.depths[at]) + here.slopes[direction];
        let sample = 1.0 / (self.frame.scale * f64::from(self.fine));
        along < 0.8 || (f64::from(self.depths[next]) - expected).abs() > 6.0 * sample
    }

    /// How light a surface is: most from above, then from the left.
    fn shade(&self, normal: Point3) -> f64 {
        let [right, left] = self.up.sideways();
        let light = 0.75 * normal[self.up.axis()] + 0.25 * normal[left] - 0.1 * normal[right];
        0.72 + 0.36 * light.max(-0.3)
    }
}

/// The bounds of what is drawn of surfaces, in the plane of the picture.
pub(super) fn points_below(
    surfaces: impl Iterator<Item = Surface>,
    up: Up,
    below: Option<f64>,
) -> impl Iterator<Item = Point2> {
    let corners = surfaces.flat_map(|surface| surface.corners);
    corners.filter(move |p| below.is_none_or(|below| p[up.axis()] <= below)).map(move |p| project(p, up))
}
