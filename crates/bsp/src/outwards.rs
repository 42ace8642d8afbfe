//! Corners of a convex polygon as doubles, so that nothing of it is lost.

use sightlines_geometry::Point3;

/// How far a rounded corner may be from the true one, and a result from what it was computed as, together, in multiples of the
/// largest coordinate: some roundings of 2^-50 in each of three coordinates.
const ROUNDING: f64 = 1.0 / (1u64 << 47) as f64;
/// Corners nearer to each other than this, in multiples of the largest coordinate, have no direction between them.
const ONE_PLACE: f64 = 1.0 / (1u64 << 44) as f64;
/// If a corner had to be moved further than this, in multiples of the largest coordinate, the polygon is a sliver.
const SLIVER: f64 = 1.0 / (1u64 << 24) as f64;

/// Corners that go round at least what the true corners go round, as seen along the normal. `corners` are those, rounded, in turn,
/// counter-clockwise about the normal; with each whether it is exact.
///
/// Each corner that is not exact is moved outwards, into the angle opposite to that of the polygon, by so much that its rounding cannot
/// take it out of that angle. So the true corner is in the triangle of the moved one and its two true neighbours, which holds for all
/// corners: each is a mean of moved ones. A sliver becomes a rectangle around it.
pub(crate) fn outwards(corners: &[(Point3, bool)], normal: Point3) -> Vec<Point3> {
    if corners.iter().all(|&(_, is_exact)| is_exact) {
        return corners.iter().map(|&(p, _)| p).collect();
    }
    let largest = corners.iter().flat_map(|(p, _)| p).fold(f64::MIN_POSITIVE, |m: f64, x| m.max(x.abs()));
    let normal = scaled(normal, 1.0 / length(normal));
    let places = places(corners, largest * ONE_PLACE);
    moved(&places, normal, largest).unwrap_or_else(|| rectangle(corners, normal, largest))
}

/// A place with one corner or several, which are within `spread` of it.
struct Place {
    at: Point3,
    is_exact: bool,
    spread: f64,
}

/// Corners that are next to each other and nearer than `near` are one place.
fn places(corners: &[(Point3, bool)], near: f64) -> Vec<Place> {
    let mut places: Vec<Place> = Vec::with_capacity(corners.len());
    for &(at, is_exact) in corners {
        // The last corner may be next to the first.
        let found = [places.len().checked_sub(1), Some(0)].into_iter().flatten();
        let found = found.filter(|&k| k < places.len()).find(|&k| length(difference(at, places[k].at)) <= near);
        match found {
            Some(k) => {
                let place = &mut places[k];
                (place.is_exact, place.spread) = (false, place.spread.max(length(difference(at, place.at))));
            }
            None => places.push(Place { at, is_exact, spread: 0.0 }),
        }
    }
    places
}

/// The places, moved outwards; none for a sliver.
fn moved(places: &[Place], normal: Point3, largest: f64) -> Option<Vec<Point3>> {
    let n = places.len();
    // Narrower than that, rounded corners may go round either way.
    if n < 3 || width(places, normal) < 4.0 * largest * ONE_PLACE {
        return None;
    }
    let unit = |from: Point3, to: Point3| {
        let d = difference(to, from);
        scaled(d, 1.0 / length(d))
    };
    let mut all = Vec::with_capacity(n);
    for (k, place) in places.iter().enumerate() {
        if place.is_exact {
            all.push(place.at);
            continue;
        }
        let (before, next) = (places[(k + n - 1) % n].at, places[(k + 1) % n].at);
        let (a, b) = (unit(before, place.at), unit(next, place.at));
        let bisector = sum(a, b);
        // Of a corner that hardly turns, the bisector says nothing.
        let way = if length(bisector) < 1e-3 { cross(difference(next, before), normal) } else { bisector };
        // At this distance along the bisector the sides of the angle are twice the error away.
        let half_sine = length(difference(a, b)) / 2.0;
        let by = 4.0 * (place.spread + largest * ROUNDING) / half_sine;
        if by.is_nan() || by > largest * SLIVER {
            return None;
        }
        // Along the plane: the way is rounded.
        let way = difference(way, scaled(normal, dot(way, normal)));
        all.push(sum(place.at, scaled(way, by / length(way))));
    }
    Some(all)
}

/// How wide places are across the longest way between two of them.
fn width(places: &[Place], normal: Point3) -> f64 {
    let ways = places.iter().flat_map(|p| places.iter().map(move |q| difference(q.at, p.at)));
    let longest = ways.max_by(|a, b| length(*a).total_cmp(&length(*b))).unwrap_or_default();
    let across = cross(normal, longest);
    let across = scaled(across, 1.0 / length(across));
    let heights = places.iter().map(|p| dot(difference(p.at, places[0].at), across));
    let (low, high) = heights.fold((0.0, 0.0), |(low, high): (f64, f64), h| (low.min(h), high.max(h)));
    high - low
}

/// A rectangle around all corners, along the longest way between two of them.
fn rectangle(corners: &[(Point3, bool)], normal: Point3, largest: f64) -> Vec<Point3> {
    let start = corners[0].0;
    let ways = corners.iter().flat_map(|&(p, _)| corners.iter().map(move |&(q, _)| difference(q, p)));
    let longest = ways.max_by(|a, b| length(*a).total_cmp(&length(*b))).unwrap_or_default();
    let least = (0..3).min_by(|&i, &j| normal[i].abs().total_cmp(&normal[j].abs())).unwrap_or(0);
    let mut axis = [0.0; 3];
    axis[least] = 1.0;
    // Across the normal again: the way is rounded.
    let along = if length(longest) > largest * ONE_PLACE { longest } else { axis };
    let across = cross(normal, along);
    let across = scaled(across, 1.0 / length(across));
    let along = cross(across, normal);
    let along = scaled(along, 1.0 / length(along));
    let range = |way: Point3| {
        let heights = corners.iter().map(|&(p, _)| dot(difference(p, start), way));
        let (low, high) = heights.fold((0.0, 0.0), |(low, high): (f64, f64), h| (low.min(h), high.max(h)));
        [low - largest * ONE_PLACE, high + largest * ONE_PLACE]
    };
    let ([u0, u1], [v0, v1]) = (range(along), range(across));
    let corner = |u: f64, v: f64| sum(start, sum(scaled(along, u), scaled(across, v)));
    vec![corner(u0, v0), corner(u1, v0), corner(u1, v1), corner(u0, v1)]
}

fn sum(a: Point3, b: Point3) -> Point3 {
    [0, 1, 2].map(|k| a[k] + b[k])
}

fn difference(a: Point3, b: Point3) -> Point3 {
    [0, 1, 2].map(|k| a[k] - b[k])
}

fn scaled(a: Point3, by: f64) -> Point3 {
    a.map(|x| x * by)
}

fn dot(a: Point3, b: Point3) -> f64 {
    (0..3).map(|k| a[k] * b[k]).sum()
}

fn cross(a: Point3, b: Point3) -> Point3 {
    [(1, 2), (2, 0), (0, 1)].map(|(i, j)| a[i] * b[j] - a[j] * b[i])
}

fn length(a: Point3) -> f64 {
    dot(a, a).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Plane;
    use crate::plane::Planes;
    use crate::polygon::Polygon;
    use proptest::prelude::*;
    use sightlines_exact::{BigRational, rational};

    /// Twice the area of a triangle in a view, exactly.
    fn turn(p: [&BigRational; 2], q: [&BigRational; 2], r: [&BigRational; 2]) -> BigRational {
        (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])
    }

    /// Three planes as rows of rationals, solved by Cramer's rule.
    fn solve(rows: [[f64; 4]; 3]) -> Option<[BigRational; 3]> {
        let rows = rows.map(|row| row.map(rational));
        let det = |column: usize| {
            let at = |i: usize, k: usize| if k == column { &rows[i][3] } else { &rows[i][k] };
            let term = |i: usize, j: usize, k: usize| at(0, i) * at(1, j) * at(2, k);
            term(0, 1, 2) + term(1, 2, 0) + term(2, 0, 1) - term(0, 2, 1) - term(1, 0, 2) - term(2, 1, 0)
        };
        let weight = det(3);
        (weight != rational(0.0)).then(|| [0, 1, 2].map(|k| det(k) / &weight))
    }

    proptest! {
        /// The triangle of three planes in a fourth: its exact corners are within the rounded ones, and these are near. Planes that are nearly
        /// parallel make slivers.
        #[test]
        fn nothing_is_lost(
            normals in proptest::collection::vec((-1.0..1.0f64, -1.0..1.0f64, -1.0..1.0f64, -900.0..900.0f64), 4),
            nearly in prop_oneof![Just(None), (0..40i32).prop_map(Some)],
        ) {
            let single = |x: f64| f64::from(x as f32);
            let mut rows: Vec<[f64; 4]> = normals.iter().map(|n| [n.0, n.1, n.2, n.3].map(single)).collect();
            if let Some(shift) = nearly {
                let by = single(2f64.powi(-shift));
                rows[2] = [rows[1][0] + by, rows[1][1], rows[1][2] - by / 3.0, rows[1][3] + by].map(single);
            }
            prop_assume!(rows.iter().all(|r| r[..3].iter().any(|x| x.abs() > 0.1)));
            let mut planes = Planes::default();
            let ids: Vec<_> = rows.iter().map(|r| planes.add(Plane { normal: [r[0], r[1], r[2]], distance: r[3] })).collect();
            let walls = [0, 1, 2].map(|axis| [-65536.0, 65536.0].map(|distance| {
                let mut normal = [0.0; 3];
                normal[axis] = 1.0;
                planes.add(Plane { normal, distance }).id
            }));
            let whole = Polygon::of_plane(ids[0].id, &walls, &planes).unwrap();
            // One of the eight parts that three planes can leave.
            let part = (0..8).find_map(|k: i32| {
                let sign = |bit: i32| if k >> bit & 1 == 1 { 1 } else { -1 };
                let part = whole.clone().on_side(ids[1].id, sign(0), &planes)?;
                part.on_side(ids[2].id, sign(1), &planes)?.on_side(ids[3].id, sign(2), &planes).filter(|p| p.corners().len() == 3)
            });
            let Some(part) = part else { return Ok(()) };
            let normal = planes.row(ids[0].id);
            let corners: Vec<_> = part.corners().iter().map(|c| c.rounded(&planes)).collect();
            let rounded = outwards(&corners, [normal[0], normal[1], normal[2]]);

            let axis = (0..3).max_by(|&i, &j| normal[i].abs().total_cmp(&normal[j].abs())).unwrap();
            let (mut u, mut v) = ((axis + 1) % 3, (axis + 2) % 3);
            if normal[axis] < 0.0 {
                (u, v) = (v, u);
            }
            // The exact corners are the points of the plane and two of the others; all but three of them are elsewhere.
            let mut n_known = 0;
            let all: Vec<[f64; 4]> = rows[1..].to_vec();
            let largest = corners.iter().flat_map(|(p, _)| p).fold(1.0f64, |m, x| m.max(x.abs()));
            for (i, j) in [(0, 1), (0, 2), (1, 2)] {
                let Some(exact) = solve([rows[0], all[i], all[j]]) else { continue };
                let near = |p: &Point3| (0..3).all(|k| {
                    let off = &exact[k] - rational(p[k]);
                    off < rational(1e-14 * largest) && off > rational(-1e-14 * largest)
                });
                if !corners.iter().any(|(p, _)| near(p)) {
                    continue;
                }
                n_known += 1;
                for k in 0..rounded.len() {
                    let [p, q] = [rounded[k], rounded[(k + 1) % rounded.len()]].map(|p| p.map(rational));
                    let inside = turn([&p[u], &p[v]], [&q[u], &q[v]], [&exact[u], &exact[v]]);
                    prop_assert!(inside >= rational(0.0), "corner {i}{j} is outside of {rounded:?}, made of {corners:?}");
                }
            }
            // Corners on the walls of the cube are known to nobody.
            prop_assume!(n_known > 0);
            // And no wider than it must be.
            for p in &rounded {
                let nearest = corners.iter().map(|(q, _)| length(difference(*p, *q))).fold(f64::INFINITY, f64::min);
                prop_assert!(nearest <= largest * 2.0 * SLIVER || rounded.len() == 4, "{nearest} in {rounded:?}");
            }
        }
    }

    #[test]
    fn exact_corners_stay() {
        let square = [[0.0, 0.0, 5.0], [4.0, 0.0, 5.0], [4.0, 4.0, 5.0], [0.0, 4.0, 5.0]];
        assert_eq!(outwards(&square.map(|p| (p, true)), [0.0, 0.0, 1.0]), square);
        // One that is not is moved outwards, and only that one.
        let mut corners = square.map(|p| (p, true));
        corners[2].1 = false;
        let moved = outwards(&corners, [0.0, 0.0, 1.0]);
        assert_eq!((&moved[..2], moved[3]), (&square[..2], square[3]));
        assert!(moved[2][0] > 4.0 && moved[2][1] > 4.0 && moved[2][0] < 4.0 + 1e-9 && moved[2][2] == 5.0);
    }

    #[test]
    fn slivers_become_rectangles() {
        let thin = [[0.0, 0.0, 5.0], [4000.0, 0.0, 5.0], [4000.0, 1e-12, 5.0]];
        let around = outwards(&thin.map(|p| (p, false)), [0.0, 0.0, 1.0]);
        assert_eq!(around.len(), 4);
        let range = |k: usize| around.iter().fold([0.0f64; 2], |[low, high], p| [low.min(p[k]), high.max(p[k])]);
        let ([x0, x1], [y0, y1]) = (range(0), range(1));
        assert!(x0 < 0.0 && x1 > 4000.0 && y0 < 0.0 && y1 > 1e-12);
        assert!(around.iter().all(|p| p[0] > -1e-6 && p[0] < 4000.0 + 1e-6 && p[1].abs() < 1e-6));
        // A point becomes a square.
        let point = [[7.0, 7.0, 5.0]; 3].map(|p| (p, false));
        assert_eq!(outwards(&point, [0.0, 0.0, 1.0]).len(), 4);
    }
}
