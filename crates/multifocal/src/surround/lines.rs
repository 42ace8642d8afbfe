//! Single lines through buffers: most targets that are not hidden are given up after a few.

use super::{Surrounded, limit};
use crate::{Buffer, BufferPlane};
use sightlines_geometry::{Aabb, Point3};

impl Surrounded<'_> {
    /// Whether a few lines meet the plane where it is blocked. If one of them does not, then no footprint of all lines is blocked; so this
    /// spares footprints, and decides nothing else.
    pub(super) fn may_plane_hide(
        &self,
        side: usize,
        k: usize,
        points: &[Point3],
        centre: Point3,
        target: &Aabb<3>,
    ) -> bool {
        let (plane, buffer) = (&self.surround.directions[side].planes[k], &self.buffers[side][k]);
        // Distances are larger than heights.
        let limit = limit(plane.height(target.min).max(plane.height(target.max)), self.units[side]);
        let b = self.surround.volume.bounds();
        let [u, v] = plane.across();
        let corner = |k: usize| {
            let mut eye = self.middle;
            eye[u] = if k & 1 == 0 { b.min[u] } else { b.max[u] };
            eye[v] = if k & 2 == 0 { b.min[v] } else { b.max[v] };
            eye
        };
        is_blocked_along(plane, buffer, limit, self.middle, centre)
            && (0..4).all(|k| is_blocked_along(plane, buffer, limit, corner(k), points[k % points.len()]))
    }

    /// Whether the line from the middle to the centre of a target leaves a box where it is blocked. If it does not, then the sides of the
    /// box do not hide the target.
    pub(super) fn may_box_hide(&self, at: usize, centre: Point3, target: &Aabb<3>) -> bool {
        let mut first = (f64::INFINITY, 0);
        for (axis, at_centre) in centre.into_iter().enumerate() {
            let way = at_centre - self.middle[axis];
            let side = 2 * axis + usize::from(way > 0.0);
            let direction = &self.surround.directions[side];
            let Some(k) = direction.plane_of_box[at] else { return false };
            let until = (direction.planes[k].at() - self.middle[axis]) / way;
            if until < first.0 {
                first = (until, side);
            }
        }
        let side = first.1;
        let direction = &self.surround.directions[side];
        let Some(k) = direction.plane_of_box[at].filter(|_| first.0 < f64::INFINITY) else { return true };
        let (plane, buffer) = (&direction.planes[k], &self.buffers[side][k]);
        let limit = limit(plane.height(target.min).max(plane.height(target.max)), self.units[side]);
        is_blocked_along(plane, buffer, limit, self.middle, centre)
    }
}

/// Whether the line from an eye through a point meets a plane in its window, at a texel with more than `limit`. In plain doubles.
#[inline]
fn is_blocked_along(plane: &BufferPlane, buffer: &Buffer, limit: u32, eye: Point3, point: Point3) -> bool {
    let height = plane.height(eye);
    let ratio = height / (height - plane.height(point));
    let ([u, v], origin, step) = (plane.across(), plane.origin(), plane.step());
    let place = |k: usize, axis: usize| (eye[axis] + ratio * (point[axis] - eye[axis]) - origin[k]) / step[k];
    let (x, y) = (place(0, u), place(1, v));
    let [width, rows] = buffer.texels();
    // NaN is nowhere.
    let is_inside = x >= 0.0 && y >= 0.0 && x < f64::from(width) && y < f64::from(rows);
    is_inside && buffer.get(x as u32, y as u32) > limit
}
