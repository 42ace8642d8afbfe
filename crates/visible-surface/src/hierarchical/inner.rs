//! The lowest level from faces, conservatively: a pixel counts where it is covered wholly, with the farthest depth in it.
//!
//! A single face covers a pixel if all four corners of the pixel are surely on the inner side of its edges. At edges that
//! faces share that would leave a crack, in a wall of two triangles along its diagonal. So from the face at a pixel's
//! centre one goes on: over each edge that may meet the pixel to a face that has the same edge and lies on its other side
//! in the picture. If there is one each time, the faces gone through cover the pixel. For what they cover of it is closed
//! and holds the centre; if it were not all, its border would have a point inside of the pixel that is on one edge of
//! theirs and near no corner of any; but beyond that edge is another of them. Folds and borders of a surface stop it:
//! there no face is on the other side.
//!
//! Where doubles are not sure the pixel stays open.

use super::footprint::{nearness_above, nearness_below};
use super::level::PyramidLevel;
use super::neighbours::Neighbours;
use super::sampled::Bounds;
use crate::camera::Camera;
use crate::face_mask::FaceMask;
use crate::faces::Faces;
use crate::fragment::{Extents, Fragment, facing};
use crate::side::Side;

/// Through how many faces one goes at a pixel. More are rarely near its centre, and then each shows little of what is behind.
const MOST: usize = 24;

/// A linear function of the place in pixels, `a x + b y + c`.
#[derive(Debug, Clone, Copy)]
struct Linear {
    a: f64,
    b: f64,
    c: f64,
    /// How much it may be off, anywhere in the picture.
    error: f64,
}

impl Linear {
    /// Less than its least value in a closed pixel.
    #[inline]
    fn below(&self, x: u32, y: u32) -> f64 {
        let at = |slope: f64, n: u32| slope * f64::from(if slope > 0.0 { n } else { n + 1 });
        at(self.a, x) + at(self.b, y) + self.c - self.error
    }

    /// More than its greatest value in a closed pixel.
    #[inline]
    fn above(&self, x: u32, y: u32) -> f64 {
        let at = |slope: f64, n: u32| slope * f64::from(if slope > 0.0 { n + 1 } else { n });
        at(self.a, x) + at(self.b, y) + self.c + self.error
    }
}

/// A face as the camera sees it.
#[derive(Debug)]
struct Shape {
    face: u32,
    /// 1 or -1: which side of it is seen.
    sign: i32,
    /// Positive inside; edge k goes from corner k to the next.
    edges: [Linear; 3],
    nearness: Linear,
    /// Bounds of the nearness of all of it.
    range: [f64; 2],
}

impl Shape {
    /// None if it shows nothing in the picture.
    fn of(camera: &Camera, faces: &Faces, face: u32) -> Option<Self> {
        let corners = faces.of(face);
        let extents = Extents::around(corners.map(|p| camera.place(p)));
        let size = camera.size().map(f64::from);
        if (0..2).any(|k| extents.pixels[k][1] < 0.0 || extents.pixels[k][0] > size[k]) {
            return None;
        }
        let sign = facing(camera, faces, face)?;
        let Bounds { plane, least } = Bounds::of(camera, faces, face)?;
        let edges = [0, 1, 2].map(|k| {
            let side = Side::edge(camera, corners[k], corners[(k + 1) % 3]).times(sign);
            Linear { a: side.a, b: side.b, c: side.c, error: side.error }
        });
        let nearness = Linear { a: plane.a, b: plane.b, c: plane.c, error: plane.error };
        Some(Self { face, sign, edges, nearness, range: [least, nearness_above(extents.depth[0])] })
    }

    /// Whether it surely covers a closed pixel.
    fn covers(&self, x: u32, y: u32) -> bool {
        self.edges.iter().all(|e| e.below(x, y) > 0.0)
    }

    /// Whether it surely does not meet a closed pixel.
    fn misses(&self, x: u32, y: u32) -> bool {
        self.edges.iter().any(|e| e.above(x, y) < 0.0)
    }

    /// How near its farthest place in a pixel is, or less.
    fn least(&self, x: u32, y: u32) -> f64 {
        self.nearness.below(x, y).max(self.range[0])
    }

    /// Whether no place of it in a pixel is nearer than a nearness.
    fn is_within(&self, limit: f64, x: u32, y: u32) -> bool {
        self.range[1] <= limit || self.nearness.above(x, y) <= limit
    }
}

/// All faces that may hide something.
struct Sheet<'a> {
    neighbours: &'a Neighbours,
    shapes: Vec<Shape>,
    /// For each face the index of its shape.
    slot: Vec<u32>,
    /// What is nearer than the nearest depth is not seen, so it hides nothing.
    limit: f64,
}

const NONE: u32 = u32::MAX;

impl Sheet<'_> {
    fn shape(&self, face: u32) -> Option<(u32, &Shape)> {
        let slot = *self.slot.get(face as usize)?;
        self.shapes.get(slot as usize).map(|s| (slot, s))
    }

    /// Goes on from a face that meets a pixel. How near the farthest of what covers it is, if it is covered wholly, and
    /// nearer than what is known.
    fn joined(&self, start: u32, x: u32, y: u32, known: f64, visited: &mut Vec<u32>) -> Option<f64> {
        visited.clear();
        visited.push(start);
        let (mut least, mut next) = (f64::INFINITY, 0);
        while let Some(&slot) = visited.get(next) {
            next += 1;
            let shape = &self.shapes[slot as usize];
            least = least.min(shape.least(x, y));
            if !(least > known && shape.is_within(self.limit, x, y)) {
                return None;
            }
            for (k, edge) in shape.edges.iter().enumerate() {
                let meets = edge.below(x, y) <= 0.0 && edge.above(x, y) >= 0.0;
                if meets && !self.go_on(shape, k, x, y, visited) {
                    return None;
                }
            }
        }
        Some(least)
    }

    /// Over an edge of a shape: whether there is something to go on to, or no need to.
    fn go_on(&self, shape: &Shape, edge: usize, x: u32, y: u32, visited: &mut Vec<u32>) -> bool {
        let all = self.neighbours.at(shape.face, edge);
        let Some(own) = all.iter().find(|s| s.face == shape.face) else { return false };
        let mut found = None;
        for other in all.iter().filter(|s| s.face != shape.face) {
            let Some((slot, beyond)) = self.shape(other.face) else { continue };
            // The edge is a part of both, so it does not meet the pixel.
            if beyond.misses(x, y) {
                return true;
            }
            let turned = if own.along == other.along { -1 } else { 1 };
            if beyond.sign * turned == shape.sign {
                if visited.contains(&slot) {
                    return true;
                }
                found = found.or(Some(slot));
            }
        }
        match found {
            Some(slot) if visited.len() < MOST => {
                visited.push(slot);
                true
            }
            _ => false,
        }
    }
}

/// Writes for each pixel that faces cover wholly how near they are at least; of several in front of each other the nearest.
pub(super) fn fill(
    faces: &Faces,
    neighbours: &Neighbours,
    camera: &Camera,
    chosen: &FaceMask,
    base: &mut PyramidLevel,
) {
    let mut shapes: Vec<Shape> = chosen.iter().filter_map(|f| Shape::of(camera, faces, f)).collect();
    // What is near first: then less of what is behind has to be looked at.
    shapes.sort_by(|a, b| b.range[1].total_cmp(&a.range[1]).then(a.face.cmp(&b.face)));
    let mut slot = vec![NONE; faces.len()];
    for (i, shape) in (0..).zip(&shapes) {
        slot[shape.face as usize] = i;
    }
    let sheet = Sheet { neighbours, shapes, slot, limit: nearness_below(camera.depths()[0]) };
    let mut visited = Vec::new();
    for (start, shape) in (0..).zip(&sheet.shapes) {
        Fragment::whole(shape.face).spans(camera, faces, |y, from, to| {
            let row = base.row_mut(y);
            // Between two pixels of a row that are covered all are.
            let first = (from..to).find(|&x| shape.covers(x, y)).unwrap_or(to);
            let past = (first..to).rev().find(|&x| shape.covers(x, y)).map_or(first, |x| x + 1);
            for x in first..past {
                let kept = &mut row[x as usize];
                if shape.is_within(sheet.limit, x, y) {
                    *kept = kept.max(shape.least(x, y));
                }
            }
            for x in (from..first).chain(past..to) {
                let kept = &mut row[x as usize];
                if let Some(least) = sheet.joined(start, x, y, *kept, &mut visited) {
                    *kept = least;
                }
            }
        });
    }
}
