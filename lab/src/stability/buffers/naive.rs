//! Buffers as one would fill them at first.

use super::truth::grid_corners;
use crate::stability::plain::{cross, dot, minus};
use sightlines::geometry::{Point3, orient3d};
use sightlines::multifocal::{Buffer, BufferJob, BufferPlane, Occluder};

/// Fills a buffer: `blocks` says for an occluder and a point whether all eyes are blocked there, `value` what is stored.
fn fill(
    job: &BufferJob<'_>,
    plane: &BufferPlane,
    blocks: impl Fn(&Occluder, f64, Point3) -> bool,
    value: impl Fn(&Occluder) -> u32,
    at_centres: bool,
) -> Buffer {
    let [w, h] = plane.texels();
    let row = w + 1;
    let corners = job.volume().corners();
    let mut out = Buffer::new(plane);
    for o in job.occluders() {
        let Some(front) = o.side_of(&corners) else { continue };
        let (sign, value) = (if front { 1.0 } else { -1.0 }, value(o));
        let corner = |i: u32| plane.corner(i % row, i / row);
        let grid: Vec<bool> = (0..row * (h + 1)).map(|i| !at_centres && blocks(o, sign, corner(i))).collect();
        for (i, stored) in out.values_mut().iter_mut().enumerate() {
            let around = grid_corners(i, w as usize);
            let is_blocked = if at_centres {
                let [low, high] = [corner(around[0] as u32), corner(around[3] as u32)];
                blocks(o, sign, std::array::from_fn(|k| low[k] + (high[k] - low[k]) / 2.0))
            } else {
                around.iter().all(|&k| grid[k])
            };
            if is_blocked {
                *stored = (*stored).max(value);
            }
        }
    }
    out
}

/// The height of the lowest corner, rounded to the nearest whole unit.
fn nearest(job: &BufferJob<'_>, plane: &BufferPlane, o: &Occluder) -> u32 {
    let least = o.outline().iter().map(|&p| plane.height(p)).fold(f64::INFINITY, f64::min);
    (least / job.unit()).round().max(0.0) as u32 + 1
}

/// The same, rounded down.
fn down(job: &BufferJob<'_>, plane: &BufferPlane, o: &Occluder) -> u32 {
    let least = o.outline().iter().map(|&p| plane.height(p)).fold(f64::INFINITY, f64::min);
    (least.next_down() / job.unit()).floor().max(0.0) as u32 + 1
}

fn edges(o: &Occluder) -> impl Iterator<Item = [Point3; 2]> + '_ {
    let outline = o.outline();
    (0..outline.len()).map(move |i| [outline[i], outline[(i + 1) % outline.len()]])
}

/// The whole box in plain doubles: a number that is at least `-epsilon` counts as inside.
pub(super) fn doubles(job: &BufferJob<'_>, plane: &BufferPlane, epsilon: f64) -> Buffer {
    let b = *job.volume().bounds();
    let centre: Point3 = std::array::from_fn(|k| (b.min[k] + b.max[k]) / 2.0);
    let half: Point3 = std::array::from_fn(|k| (b.max[k] - b.min[k]) / 2.0);
    let blocks = |o: &Occluder, sign: f64, t: Point3| {
        let inner = |[p, q]: [Point3; 2]| {
            let n = cross(minus(p, t), minus(q, t));
            sign * dot(minus(centre, t), n) - dot(n.map(f64::abs), half) >= -epsilon
        };
        let behind = |[p, q, r]: [Point3; 3]| sign * dot(minus(t, p), cross(minus(q, p), minus(r, p))) <= epsilon;
        edges(o).all(inner) && o.facets().iter().all(|&f| behind(f))
    };
    fill(job, plane, blocks, |o| down(job, plane, o), false)
}

fn exactly(o: &Occluder, sign: f64, eyes: &[Point3], t: Point3) -> bool {
    let inner = |[p, q]: [Point3; 2]| eyes.iter().all(|&v| sign * orient3d(v, p, q, t) <= 0.0);
    edges(o).all(inner) && o.facets().iter().all(|&[p, q, r]| sign * orient3d(p, q, r, t) <= 0.0)
}

/// Exact predicates, but asked at the middle of each texel alone.
pub(super) fn centres(job: &BufferJob<'_>, plane: &BufferPlane) -> Buffer {
    let eyes = job.volume().corners();
    fill(job, plane, |o, sign, t| exactly(o, sign, &eyes, t), |o| down(job, plane, o), true)
}

/// Exact predicates, but with the middle of the volume for all of it.
pub(super) fn one_eye(job: &BufferJob<'_>, plane: &BufferPlane) -> Buffer {
    let b = *job.volume().bounds();
    let centre = [std::array::from_fn(|k| (b.min[k] + b.max[k]) / 2.0)];
    fill(job, plane, |o, sign, t| exactly(o, sign, &centre, t), |o| down(job, plane, o), false)
}

/// Exact predicates, but heights rounded to nearest.
pub(super) fn nearest_heights(job: &BufferJob<'_>, plane: &BufferPlane) -> Buffer {
    let eyes = job.volume().corners();
    fill(job, plane, |o, sign, t| exactly(o, sign, &eyes, t), |o| nearest(job, plane, o), false)
}

/// Triangles with their corners put onto a grid, so that what is near together becomes one.
pub(super) fn snapped(triangles: &[[Point3; 3]], grid: f64) -> Vec<[Point3; 3]> {
    triangles.iter().map(|t| t.map(|p| p.map(|x| (x / grid).round() * grid))).collect()
}
