//! Selection of the occluders that are worth drawing.

use super::vector::{add, basis, cross, dot, length, scale, sub, unit, vector_area};
use crate::{BufferPlane, Occluder, Volume};
use sightlines_geometry::Point3;
use std::cmp::Ordering;

/// An approximate description of an occluder.
#[derive(Debug, Clone, Copy)]
struct Sketch {
    middle: Point3,
    /// Area, along the normal.
    area: Point3,
    /// The same with length 1.
    normal: Point3,
    /// Directions of length 1 in its plane, and its total extent along each.
    axes: [Point3; 2],
    widths: [f64; 2],
    is_front_only: bool,
}

/// Sketches of many occluders, to choose from for many volumes.
#[derive(Debug, Clone)]
pub struct Chooser {
    sketches: Vec<Sketch>,
}

impl Chooser {
    /// Examines each once. O(corners).
    pub fn new(occluders: &[Occluder]) -> Self {
        Self { sketches: occluders.iter().map(Sketch::of).collect() }
    }

    /// The up to `n` occluders that hide most space in front of `plane` from all of `volume`, best first. Estimated, as
    /// any choice is sound: the space behind an occluder, up to the plane, that grows with the distance where the
    /// occluder is wider than the volume and shrinks to nothing where it is narrower. Those that are not between the
    /// two, or that eyes see from both sides, are left out.
    ///
    /// O(number of occluders).
    pub fn select(&self, volume: &Volume, plane: &BufferPlane, n: usize) -> Vec<u32> {
        let [chosen] = self.select_for(volume, [plane], n);
        chosen
    }

    /// The same for several planes around one volume: how an occluder looks from there is the same for all of them.
    pub fn select_for<const N: usize>(&self, volume: &Volume, planes: [&BufferPlane; N], n: usize) -> [Vec<u32>; N] {
        let eye = middle_of(volume);
        let mut ranked: [Vec<(f64, u32)>; N] = std::array::from_fn(|_| Vec::new());
        for (i, sketch) in (0..).zip(&self.sketches) {
            let Some(shadow) = sketch.shadow(volume, eye) else { continue };
            for (plane, ranked) in planes.iter().zip(&mut ranked) {
                let space = sketch.hidden_space(&shadow, eye, plane);
                ranked.extend(space.filter(|space| *space > 0.0).map(|space| (space, i)));
            }
        }
        let better = |a: &(f64, u32), b: &(f64, u32)| -> Ordering { b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)) };
        ranked.map(|mut ranked| {
            if n < ranked.len() {
                ranked.select_nth_unstable_by(n, better);
                ranked.truncate(n);
            }
            ranked.sort_unstable_by(better);
            ranked.into_iter().map(|r| r.1).collect()
        })
    }
}

/// Like [`Chooser::select`], for a single query.
pub fn select(volume: &Volume, plane: &BufferPlane, occluders: &[Occluder], n: usize) -> Vec<u32> {
    Chooser::new(occluders).select(volume, plane, n)
}

/// How an occluder looks from a volume.
struct Shadow {
    /// By how much of its width the shadow grows along both axes, for each time its distance from the eye.
    growth: [f64; 2],
    /// Its area as it is seen.
    seen: f64,
    /// From the middle of the volume to its own.
    distance: f64,
}

fn middle_of(volume: &Volume) -> Point3 {
    let b = volume.bounds();
    std::array::from_fn(|k| b.min[k] + (b.max[k] - b.min[k]) / 2.0)
}

impl Sketch {
    fn of(occluder: &Occluder) -> Self {
        let outline = occluder.outline();
        let area = vector_area(outline);
        let middle = scale(outline.iter().fold([0.0; 3], |s, &p| add(s, p)), 1.0 / outline.len() as f64);
        // Along the longest edge, as rectangles have it.
        let next = |i: usize| sub(outline[(i + 1) % outline.len()], outline[i]);
        let longest = (0..outline.len()).map(next).reduce(|a, b| if length(b) > length(a) { b } else { a });
        let normal = unit(area);
        let along = unit(longest.unwrap_or(basis(normal)[0]));
        let axes = [along, cross(normal, along)];
        let widths = axes.map(|a| {
            let ends = outline.iter().map(|&p| dot(a, p));
            let (low, high) = ends.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
            high - low
        });
        Self { middle, area, normal, axes, widths, is_front_only: occluder.is_front_only() }
    }

    /// How it looks from the volume; `None` if the volume is not on one side of it, or is on one that it does not hide from.
    fn shadow(&self, volume: &Volume, eye: Point3) -> Option<Shadow> {
        let b = volume.bounds();
        // The total extent of the volume along a direction.
        let reach = |a: Point3| (0..3).map(|k| (b.max[k] - b.min[k]) * a[k].abs()).sum::<f64>();
        let way = sub(self.middle, eye);
        let facing = dot(self.normal, way);
        if facing.abs() <= reach(self.normal) / 2.0 || self.is_front_only && facing > 0.0 {
            return None;
        }
        // From one eye the shadow grows with the distance; eyes apart from each other reduce it on both sides.
        let view = unit(way);
        let growth: [f64; 2] = std::array::from_fn(|i| {
            let across = sub(self.axes[i], scale(view, dot(self.axes[i], view)));
            let (width, spread) = (self.widths[i] * length(across), reach(unit(across)));
            if width > 0.0 { 1.0 - spread / width } else { f64::NEG_INFINITY }
        });
        let seen = dot(self.area, view).abs();
        Some(Shadow { growth, seen, distance: length(way) })
    }

    /// The approximate space behind it, up to the plane, that is hidden from the volume; `None` if it is not between the two.
    fn hidden_space(&self, shadow: &Shadow, eye: Point3, plane: &BufferPlane) -> Option<f64> {
        // Along the view axis: from the eye to it, and from it to the plane.
        let (in_front, behind) = (plane.height(eye) - plane.height(self.middle), plane.height(self.middle));
        if in_front <= 0.0 || behind <= 0.0 {
            return None;
        }
        let shift = behind / in_front;
        // Up to where it vanishes, as a multiple of the distance from the eye.
        let last = shadow.growth.iter().filter(|g| **g < 0.0).map(|g| -1.0 / g).fold(shift, f64::min);
        if last <= 0.0 {
            return None;
        }
        let [g, h] = shadow.growth;
        let space = last + (g + h) * last * last / 2.0 + g * h * last * last * last / 3.0;
        Some(space * shadow.seen * shadow.distance * self.share_of_window(eye, last, plane))
    }

    /// The share of the shadow's end that falls into the plane's window, by the middle and the widths of the shadow.
    fn share_of_window(&self, eye: Point3, last: f64, plane: &BufferPlane) -> f64 {
        let end = add(self.middle, scale(sub(self.middle, eye), last));
        let (low, high) = (plane.origin(), plane.end());
        let mut share = 1.0;
        for (i, axis) in plane.across().into_iter().enumerate() {
            let widths = (0..2).map(|k| self.widths[k] * self.axes[k][axis].abs());
            let half = widths.sum::<f64>() * (1.0 + last) / 2.0;
            let inside = (end[axis] + half).min(high[i]) - (end[axis] - half).max(low[i]);
            share *= if half > 0.0 { (inside / (2.0 * half)).clamp(0.0, 1.0) } else { 1.0 };
        }
        share
    }
}
