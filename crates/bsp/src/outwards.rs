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
    if n < 3 {
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
        all.push(sum(place.at, scaled(way, by / length(way))));
    }
    Some(all)
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
