//! Sequences that a plane stops: the earliest portal on one side, a later one on the other, and the
//! last one on the first side again.
//!
//! Much of what is hidden in maps on a grid is hidden so narrowly that a grazing line passes, and then no sum of rows
//! is negative everywhere. A plane needs no margin. Its position is free within limits, so it can be moved until it
//! holds an edge of one portal and a corner of another.

use super::certificate::PlaneProof;
use super::vector::{cross, dot, size, sub};
use sightlines_geometry::{Point3, Portal3, orient3d};

/// Relative size below which a distance may be rounding; such a distance is decided exactly.
const ROUNDING: f64 = 1e-9;

/// A plane that stops all lines through `portals`; only those in `among` (ascending) are considered.
/// Cost: grows with the cube of their number.
pub(super) fn stopping(portals: &[&Portal3], among: &[usize]) -> Option<PlaneProof> {
    for &held in among {
        let corners = portals[held].corners();
        for edge in 0..corners.len() {
            let (e, f) = (corners[edge], corners[(edge + 1) % corners.len()]);
            for &touched in among.iter().filter(|&&t| t != held) {
                for corner in tangents(e, f, portals[touched].corners()).into_iter().flatten() {
                    let plane = PlaneProof { edge: (held, edge), corner: (touched, corner), stops: [0; 3] };
                    let c = portals[touched].corners()[corner];
                    // Most planes stop nothing, which needs no exact side to be seen.
                    if stops(portals, among, [e, f, c], |_| 0.0).is_some()
                        && let Some(stops) = stops(portals, among, [e, f, c], |p| orient3d(e, f, c, p))
                    {
                        return Some(PlaneProof { stops, ..plane });
                    }
                }
            }
        }
    }
    None
}

/// The corners of a polygon with which the plane through an edge has it on one side: about the first and
/// the last one as the plane turns round the edge.
fn tangents(e: Point3, f: Point3, corners: &[Point3]) -> [Option<usize>; 2] {
    let along = sub(f, e);
    let normal = |k: usize| cross(along, sub(corners[k], e));
    let (mut least, mut most) = (None, None);
    for (k, &corner) in corners.iter().enumerate() {
        let n = normal(k);
        if size(n) <= ROUNDING * size(along) * size(sub(corner, e)) {
            continue;
        }
        // The turn from one to another is less than a half if the polygon is on one side of some plane
        // through the edge; if not, no tangent is one.
        let turn = |other: Option<usize>| other.map(|o| dot(along, cross(normal(o), n)));
        if turn(least).is_none_or(|t| t < 0.0) {
            least = Some(k);
        }
        if turn(most).is_none_or(|t| t > 0.0) {
            most = Some(k);
        }
    }
    [least, most.filter(|m| Some(*m) != least)]
}

/// The first three portals on alternating sides of the plane through three points, if there are three. `close` tells
/// the side of a point that rounding leaves in doubt; 0 counts as both sides. So the answer is exact if `close` is, and
/// if it is always 0, `None` is right.
#[inline(always)]
fn stops(
    portals: &[&Portal3],
    among: &[usize],
    [e, f, c]: [Point3; 3],
    close: impl Fn(Point3) -> f64,
) -> Option<[usize; 3]> {
    let (along, to) = (sub(f, e), sub(c, e));
    // A determinant of rounded differences is accurate to less than 20 * 2^-53 of the product of their sizes; above a
    // multiple of that its sign is exact.
    let (normal, rounding) = (cross(along, to), ROUNDING * size(along) * size(to));
    // For both sides that the first one can be on: how many have been found, and which.
    let mut found = [(0, [0; 3]); 2];
    for &i in among {
        let (mut below, mut above) = (true, true);
        for &p in portals[i].corners() {
            let from = sub(p, e);
            let height = dot(normal, from);
            let side = if height.abs() > rounding * size(from) {
                height
            } else if p == e || p == f || p == c {
                0.0
            } else {
                close(p)
            };
            below &= side <= 0.0;
            above &= side >= 0.0;
            if !below && !above {
                break;
            }
        }
        for (start, (n, which)) in found.iter_mut().enumerate() {
            if if (start + *n) % 2 == 0 { below } else { above } {
                which[*n] = i;
                *n += 1;
                if *n == 3 {
                    return Some(*which);
                }
            }
        }
    }
    None
}
