//! Planes all around a volume: nested boxes, each with a plane on each of its six sides.
//!
//! A line from an eye leaves a box around the volume through one of its sides, so the buffers of six planes cover all
//! lines. Several nested boxes give more: near planes separate the gaps between things better, and planes behind a
//! target also show what blocks in front of it.

mod lines;

use crate::footprint::{is_blocked_by_distance, limit};
use crate::{Buffer, BufferJob, BufferJobError, BufferPlane, BufferPlaneError, Footprint, Measure, Occluder, Volume};
use sightlines_geometry::{Aabb, Point3};

/// The number, positions and resolution of planes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Layout {
    /// Number of planes on each side of the volume, which is the number of nested boxes; at least 1.
    pub planes: u32,
    /// Texels along the longer side of each plane, 1 to [`MAX_TEXELS`](crate::MAX_TEXELS).
    pub texels: u32,
    /// Exponent of the distances of the boxes: 1 for even spacing. Positive; other values place no planes.
    pub growth: f64,
    /// How much wider than the sides of its box a plane is, at least 1: a target whose lines all meet one plane is
    /// proven hidden by it alone.
    pub spread: f64,
    /// The measure of the buffers.
    pub measure: Measure,
    /// Whether values are carried from each plane to the next one.
    pub carry: bool,
}

impl Default for Layout {
    fn default() -> Self {
        Self { planes: 9, texels: 128, growth: 1.5, spread: 1.25, measure: Measure::default(), carry: true }
    }
}

/// The planes on one side of a volume.
#[derive(Debug, Clone, PartialEq)]
pub struct Direction {
    /// Nearest first.
    pub planes: Vec<BufferPlane>,
    /// For each box the plane on this side; `None` if it rounds to that of the box before, or is out of order.
    pub plane_of_box: Vec<Option<usize>>,
    /// For each box its side, along the plane's axes across.
    faces: Vec<[[f64; 2]; 2]>,
}

/// Planes all around a volume.
#[derive(Debug, Clone, PartialEq)]
pub struct Surround {
    volume: Volume,
    measure: Measure,
    carry: bool,
    /// Along each axis downwards, then upwards.
    directions: [Direction; 6],
}

impl Surround {
    /// Lays planes around `volume`, out to the ends of `scene`.
    ///
    /// # Errors
    /// [`BufferPlaneError`] for texels out of range, and for volumes and scenes around which no planes fit.
    pub fn new(volume: &Volume, scene: &Aabb<3>, layout: &Layout) -> Result<Self, BufferPlaneError> {
        let boxes = boxes(volume, scene, layout);
        let mut directions = Vec::with_capacity(6);
        for axis in 0..3 {
            for positive in [false, true] {
                directions.push(direction(volume, &boxes, axis, positive, layout)?);
            }
        }
        let directions = directions.try_into().expect("there are six sides");
        Ok(Self { volume: *volume, measure: layout.measure, carry: layout.carry, directions })
    }

    /// Where the eyes are.
    pub const fn volume(&self) -> &Volume {
        &self.volume
    }

    /// The planes on each side: along each axis downwards, then upwards.
    pub const fn directions(&self) -> &[Direction; 6] {
        &self.directions
    }

    /// The job that fills the buffers of one side.
    ///
    /// # Errors
    /// [`BufferJobError`], if the measure cannot be carried over.
    pub fn job<'a>(
        &self,
        side: usize,
        occluders: impl IntoIterator<Item = &'a Occluder>,
    ) -> Result<BufferJob<'a>, BufferJobError> {
        BufferJob::new(self.volume, self.directions[side].planes.clone(), occluders, self.measure, self.carry)
    }
}

/// The nested boxes around a volume, out to the end of the scene.
fn boxes(volume: &Volume, scene: &Aabb<3>, layout: &Layout) -> Vec<Aabb<3>> {
    let v = volume.bounds();
    let size = (0..3).map(|k| scene.max[k].max(v.max[k]) - scene.min[k].min(v.min[k])).fold(0.0, f64::max);
    // Where the scene ends at the volume, or before it, there has to be a plane as well.
    let least = if size > 0.0 { size / 1024.0 } else { 1.0 };
    let n = layout.planes.max(1);
    let part = |k: u32| (f64::from(k + 1) / f64::from(n)).powf(layout.growth);
    let one = |k: u32| Aabb {
        min: std::array::from_fn(|a| v.min[a] - (v.min[a] - scene.min[a] + least).max(least) * part(k)),
        max: std::array::from_fn(|a| v.max[a] + (scene.max[a] - v.max[a] + least).max(least) * part(k)),
    };
    (0..n).map(one).collect()
}

fn direction(
    volume: &Volume,
    boxes: &[Aabb<3>],
    axis: usize,
    positive: bool,
    layout: &Layout,
) -> Result<Direction, BufferPlaneError> {
    let (mut planes, mut plane_of_box, mut faces) = (Vec::<BufferPlane>::new(), Vec::new(), Vec::new());
    let v = volume.bounds();
    for b in boxes {
        let at = if positive { b.max[axis] } else { b.min[axis] };
        let across = [(axis + 1) % 3, (axis + 2) % 3];
        let (mut min, mut max) = ([0.0; 2], [0.0; 2]);
        for (k, a) in across.into_iter().enumerate() {
            let wide = |eye: f64, end: f64| eye + (end - eye) * layout.spread.max(1.0);
            min[k] = wide(v.min[a], b.min[a]).min(b.min[a]);
            max[k] = wide(v.max[a], b.max[a]).max(b.max[a]);
        }
        let size = [max[0] - min[0], max[1] - min[1]];
        let longer = size[0].max(size[1]);
        let share = |k: usize| ((f64::from(layout.texels) * (size[k] / longer)).ceil() as u32).max(1);
        let plane = BufferPlane::new(axis, positive, at, min, max, [share(0), share(1)])?;
        plane.check_in_front_of(volume)?;
        let farther = |last: &BufferPlane| if positive { last.at() < at } else { last.at() > at };
        let is_farther = planes.last().is_none_or(farther);
        if is_farther {
            planes.push(plane);
        }
        plane_of_box.push(is_farther.then(|| planes.len() - 1));
        faces.push(across.map(|a| [b.min[a], b.max[a]]));
    }
    Ok(Direction { planes, plane_of_box, faces })
}

/// What is hidden from a volume, according to the buffers around it.
#[derive(Debug, Clone)]
pub struct Surrounded<'a> {
    surround: &'a Surround,
    /// For each side one buffer for each of its planes.
    buffers: &'a [Vec<Buffer>; 6],
    /// For each side the unit of its values.
    units: [f64; 6],
    /// The middle of the volume.
    middle: Point3,
}

impl<'a> Surrounded<'a> {
    /// * `buffers`: for each side what a backend made of [`Surround::job`]
    /// * `units`: [`BufferJob::unit`] of each
    ///
    /// # Panics
    /// If buffers and planes do not match.
    pub fn new(surround: &'a Surround, buffers: &'a [Vec<Buffer>; 6], units: [f64; 6]) -> Self {
        for (side, buffers) in surround.directions.iter().zip(buffers) {
            let sizes = side.planes.iter().map(BufferPlane::texels);
            assert!(sizes.eq(buffers.iter().map(Buffer::texels)), "a buffer for each plane");
        }
        let b = surround.volume.bounds();
        let middle = std::array::from_fn(|k| b.min[k] + (b.max[k] - b.min[k]) / 2.0);
        Self { surround, buffers, units, middle }
    }

    /// Whether a closed box is certainly hidden from the whole volume.
    ///
    /// It is if one plane, or all six sides of one box together, prove it. A box that meets the volume never is.
    pub fn hides(&self, target: &Aabb<3>) -> bool {
        self.hides_hull(&target.corners(), target)
    }

    /// Whether the convex hull of points is certainly hidden from the whole volume.
    pub fn hides_points(&self, points: &[Point3]) -> bool {
        self.hides_hull(points, &Aabb::around(points.iter().copied()))
    }

    fn hides_hull(&self, points: &[Point3], target: &Aabb<3>) -> bool {
        let v = self.surround.volume.bounds();
        if (0..3).all(|k| target.min[k] <= v.max[k] && v.min[k] <= target.max[k]) {
            return false;
        }
        let sum = points.iter().fold([0.0; 3], |sum, p| [0, 1, 2].map(|k| sum[k] + p[k]));
        let centre = sum.map(|x| x / points.len() as f64);
        (0..6).any(|side| self.one_plane_hides(side, points, centre, target))
            || self.surround.measure.is_height()
                && (0..self.n_boxes()).any(|k| self.may_box_hide(k, centre, target) && self.box_hides(k, target))
    }

    fn n_boxes(&self) -> usize {
        self.surround.directions[0].plane_of_box.len()
    }

    /// Whether one of the planes of a side hides the target alone.
    ///
    /// * `centre`: of the points, rounded
    fn one_plane_hides(&self, side: usize, points: &[Point3], centre: Point3, target: &Aabb<3>) -> bool {
        let (axis, positive) = (side / 2, side % 2 == 1);
        let v = self.surround.volume.bounds();
        let beyond = if positive { v.max[axis] < target.min[axis] } else { target.max[axis] < v.min[axis] };
        beyond && {
            let planes = &self.surround.directions[side].planes;
            let may = |k: usize| self.may_plane_hide(side, k, points, centre, target);
            (0..planes.len()).rev().any(|k| may(k) && self.plane_hides(side, k, points, target))
        }
    }

    fn plane_hides(&self, side: usize, k: usize, points: &[Point3], target: &Aabb<3>) -> bool {
        let (plane, buffer, unit) =
            (&self.surround.directions[side].planes[k], &self.buffers[side][k], self.units[side]);
        let volume = &self.surround.volume;
        // For a box, projections of four corners of its faces suffice.
        let footprint = if points.len() == 8 {
            Footprint::of_box(volume, plane, unit, target)
        } else {
            Footprint::of_points(volume, plane, unit, points)
        };
        let Some(footprint) = footprint else { return false };
        if self.surround.measure.is_height() {
            footprint.is_blocked(buffer)
        } else {
            is_blocked_by_distance(&footprint, plane, unit, points, buffer)
        }
    }

    /// Whether the six sides of one box hide the target together: each line leaves through one of them.
    fn box_hides(&self, at: usize, target: &Aabb<3>) -> bool {
        (0..6).all(|side| {
            let direction = &self.surround.directions[side];
            let Some(k) = direction.plane_of_box[at] else { return false };
            let (plane, buffer) = (&direction.planes[k], &self.buffers[side][k]);
            match exits(&self.surround.volume, plane, &direction.faces[at], target) {
                Exits::None => true,
                Exits::Unknown => false,
                Exits::Texels([x0, y0, x1, y1]) => {
                    // Of what the lines through this side meet, nothing is higher than the highest eye.
                    let heights = [plane.height(target.min), plane.height(target.max)];
                    let limit = limit(heights[0].max(heights[1]), self.units[side]);
                    (y0..y1).all(|y| buffer.row(y)[x0 as usize..x1 as usize].iter().all(|&v| v > limit))
                }
            }
        })
    }
}

/// Where lines from a volume towards a target leave a box through one of its sides.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Exits {
    /// Nowhere.
    None,
    /// Also beside the plane's window.
    Unknown,
    /// In texels from `(x0, y0)` to before `(x1, y1)`.
    Texels([u32; 4]),
}

/// Bounds the places where lines from `volume` through `target` leave through the side `face` on `plane`.
///
/// A line from `v` through `e` meets the plane at `v + r (e - v)` along an axis across, with `r` the height of `v` over the
/// difference of the heights of `v` and `e`, if that is positive. The expression is affine in each of the three, so the ends
/// of its range are at ends of theirs. Where heights overlap, `r` has no largest value; then the limit counts, which is not
/// finite, but may lie on the far side of the face. Rounded outwards, by more than the roundings of each step.
fn exits(volume: &Volume, plane: &BufferPlane, face: &[[f64; 2]; 2], target: &Aabb<3>) -> Exits {
    let b = volume.bounds();
    let sorted = |a: f64, b: f64| [a.min(b).next_down(), a.max(b).next_up()];
    let eyes = sorted(plane.height(b.min), plane.height(b.max));
    let heights = sorted(plane.height(target.min), plane.height(target.max));
    if eyes[1] <= heights[0] {
        return Exits::None;
    }
    // H / (H - h) grows with h; with H it falls if h is positive, and else grows.
    let ratio = |eye: f64, height: f64| eye / (eye - height);
    let least = ratio(eyes[usize::from(heights[0] >= 0.0)], heights[0]) * (1.0 - 4.0 * f64::EPSILON);
    let most = if eyes[0] > heights[1] {
        ratio(eyes[usize::from(heights[1] < 0.0)], heights[1]) * (1.0 + 4.0 * f64::EPSILON)
    } else {
        f64::INFINITY
    };
    let mut texels = [[0u32; 2]; 2];
    for (k, axis) in plane.across().into_iter().enumerate() {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for v in [b.min[axis], b.max[axis]] {
            for e in [target.min[axis], target.max[axis]] {
                for r in [least, most] {
                    let away = e - v;
                    let place = if away == 0.0 { v } else { v + r * away };
                    let error = if place.is_finite() {
                        (v.abs() + r.min(f64::MAX) * away.abs()) * (8.0 * f64::EPSILON)
                    } else {
                        0.0
                    };
                    low = low.min(place - error);
                    high = high.max(place + error);
                }
            }
        }
        let (low, high) = (low.max(face[k][0]), high.min(face[k][1]));
        if low > high {
            return Exits::None;
        }
        let n = plane.texels()[k];
        let (origin, step) = (plane.origin()[k], plane.step()[k]);
        if !(origin <= low && high <= plane.end()[k]) {
            return Exits::Unknown;
        }
        let error = (low.abs() + high.abs() + origin.abs()) * (4.0 * f64::EPSILON);
        let first = (((low - origin - error) / step).next_down().floor().max(0.0) as u32).min(n - 1);
        let end = (((high - origin + error) / step).next_up().ceil().max(0.0) as u32).clamp(first + 1, n);
        texels[k] = [first, end];
    }
    let [[x0, x1], [y0, y1]] = texels;
    Exits::Texels([x0, y0, x1, y1])
}

#[cfg(test)]
mod tests;
