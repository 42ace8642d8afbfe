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
    type Found = Option<(usize, Point3)>;
    let (mut least, mut most): (Found, Found) = (None, None);
    for (k, &corner) in corners.iter().enumerate() {
        let to = sub(corner, e);
        let n = cross(along, to);
        if size(n) <= ROUNDING * size(along) * size(to) {
            continue;
        }
        // The turn from one to another is less than a half if the polygon is on one side of some plane
        // through the edge; if not, no tangent is one.
        let turn = |other: Found| other.map(|(_, normal)| dot(along, cross(normal, n)));
        if turn(least).is_none_or(|t| t < 0.0) {
            least = Some((k, n));
        }
        if turn(most).is_none_or(|t| t > 0.0) {
            most = Some((k, n));
        }
    }
    let [least, most] = [least, most].map(|found| found.map(|(k, _)| k));
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

#[cfg(test)]
mod tests {
    use super::*;
    use sightlines_geometry::Random;

    /// Without exact sides, no plane is missed that stops something; and some are found that stop nothing.
    #[test]
    fn planes_are_left_out_rightly() {
        let mut random = Random::new(3);
        let (mut n_left_out, mut n_stop, mut n_wrong) = (0, 0, 0);
        for _ in 0..3000 {
            let mut point = |x: f64| [x, 0.0, 0.0].map(|x| x + (random.unit() * 3.0).floor() + random.unit() * 1e-14);
            let triangle = |k: i32| std::array::from_fn::<Point3, 3, _>(|_| point(f64::from(k)));
            let triangles: Vec<[Point3; 3]> = (0..4).map(triangle).collect();
            let portals: Vec<Portal3> = triangles.iter().filter_map(|corners| Portal3::around(corners)).collect();
            let refs: Vec<&Portal3> = portals.iter().collect();
            let among: Vec<usize> = (0..refs.len()).collect();
            let [e, f, c] = [triangles[0][0], triangles[0][1], triangles[3][2]];
            let loose = stops(&refs, &among, [e, f, c], |_| 0.0);
            let exact = stops(&refs, &among, [e, f, c], |p| orient3d(e, f, c, p));
            assert!(loose.is_some() || exact.is_none());
            n_left_out += u32::from(loose.is_none());
            n_stop += u32::from(exact.is_some());
            n_wrong += u32::from(loose.is_some() && exact.is_none());
        }
        assert!(n_left_out > 300 && n_stop > 30 && n_wrong > 30, "{n_left_out} {n_stop} {n_wrong}");
    }
}
