//! Values in integers: constants and affine functions below the exact ones.

use super::FormBuilder;
use super::affine::{Around, Window};
use super::edges::Side;
use crate::{Measure, Occluder};
use sightlines_geometry::Point3;

/// Factor that lowers quotients and products of a few rounded numbers: far more than the ten roundings of 2^-53 that
/// any of them accumulates.
const DOWN: f64 = 1.0 - 64.0 * f64::EPSILON;

/// Heights: returns the least value, and appends a slope if it can be larger.
///
/// A hit lies in front of the plane or on it, so a height is at least 0; of a flat occluder it is also at least that of
/// its lowest corner.
pub(super) fn heights(
    builder: &FormBuilder<'_>,
    occluder: &Occluder,
    facets: &[Side],
    bounds: [i32; 4],
    slopes: &mut Vec<[i32; 3]>,
) -> u32 {
    let [lowest, highest] = extent(builder, occluder);
    // No section of an occluder in one height is higher than its corners.
    let level = lowest == highest || builder.measure == Measure::VertexHeight;
    if !level {
        slopes.extend(section(builder, facets, bounds));
    }
    encode(lowest.next_down() / builder.unit)
}

/// The lowest and the highest corner of an occluder above the plane, rounded to nearest.
fn extent(builder: &FormBuilder<'_>, occluder: &Occluder) -> [f64; 2] {
    let (plane, b) = (builder.window.plane, occluder.bounds());
    let (low, high) = (plane.height(b.min), plane.height(b.max));
    [low.min(high), low.max(high)]
}

/// The encoding of a value: whole units, plus one. Never below 0, see [`heights`].
fn encode(units: f64) -> u32 {
    units.floor().max(0.0) as u32 + 1
}

/// An affine function below the lowest point, in the umbra, of what lines from a texel to eyes meet.
///
/// Let `a` be the distance of a place on the plane to a facet's plane, behind it, and `b` that of an eye at height `H`,
/// in front of it, both in the same unit. The line between meets the facet's plane at height `H a / (a + b)`, which is
/// a concave function of `a`; so is the least for all eyes. Between the least and the largest `a` it lies above its chord,
/// which is affine in the place. The least over the facets is bounded at the corners.
fn section(builder: &FormBuilder<'_>, facets: &[Side], bounds: [i32; 4]) -> Option<[i32; 3]> {
    let window = &builder.window;
    let places = Window::places(bounds).map(|place| window.point(place));
    let mut low = [f64::INFINITY; 4];
    for facet in facets {
        let behind = places.map(|p| facet.at(p));
        let in_front = |eye: Point3| {
            let f = facet.at(eye);
            Around { about: -f.about, ..f }
        };
        let least = behind.iter().fold(f64::INFINITY, |least, f| least.min(f.low())).max(0.0);
        let most = behind.iter().fold(0.0, |most: f64, f| most.max(f.high()));
        let height = |behind: f64| {
            let of = |v: &Point3| {
                let up = window.plane.height(*v).next_down();
                up * behind / (behind + in_front(*v).high()) * DOWN
            };
            builder.corners.iter().map(of).fold(f64::INFINITY, f64::min)
        };
        let (at_least, at_most) = (height(least), height(most));
        if !(at_least.is_finite() && at_most.is_finite()) {
            return None;
        }
        let rise = if most > least { ((at_most - at_least) / (most - least)).max(0.0) } else { 0.0 };
        for (low, f) in low.iter_mut().zip(behind) {
            // A chord that rises less is below on this side of its lower end; on the other side, where nothing is in the
            // umbra, it may be anything that keeps the function affine: so the same expression everywhere.
            let along = f.low() - least;
            let chord = at_least + along * rise;
            let slack = (at_least + along.abs() * rise) * (64.0 * f64::EPSILON);
            *low = low.min((chord - slack) / builder.unit);
        }
    }
    let mut slope = Window::slope(bounds, low)?;
    slope[2] += 1;
    Some(slope)
}

/// Distances: returns the least value, and appends slopes.
///
/// For any direction `n` of length 1, a point `p` is at least `n · p - max over corners of n · corner` from the hull of the
/// corners: an affine function below the distance. Directions towards the nearest corner-wise point from several places
/// give several of them. Distances to bent occluders are bounded by heights, which are never more.
pub(super) fn distances(
    builder: &FormBuilder<'_>,
    occluder: &Occluder,
    facets: &[Side],
    bounds: [i32; 4],
    slopes: &mut Vec<[i32; 3]>,
) -> u32 {
    if !occluder.is_flat() {
        return heights(builder, occluder, facets, bounds, slopes);
    }
    let window = &builder.window;
    let [x0, y0, x1, y1] = bounds;
    let middle = [x0 + (x1 - x0) / 2, y0 + (y1 - y0) / 2];
    let corners = Window::places(bounds).map(|place| window.point(place));
    let floor = encode(extent(builder, occluder)[0].next_down() / builder.unit);
    for from in corners.into_iter().chain([window.point(middle)]) {
        let n = direction(from, occluder);
        let low = corners.map(|p| {
            // The projection of `p` less that of the corner nearest to it along n.
            let (about, error) = occluder.outline().iter().fold((f64::INFINITY, 0.0), |(least, error), &c| {
                let terms = [0, 1, 2].map(|k| n[k] * (p[k] - c[k]));
                let size: f64 = terms.iter().map(|t| t.abs()).sum();
                (f64::min(least, terms.iter().sum()), f64::max(error, size))
            });
            let length = n.iter().map(|x| x * x).sum::<f64>().sqrt();
            let value = about - error * (64.0 * f64::EPSILON);
            let length = if value > 0.0 { length / DOWN } else { length * DOWN };
            (value / length).next_down() / builder.unit
        });
        if let Some(mut slope) = Window::slope(bounds, low) {
            slope[2] += 1;
            slopes.push(slope);
        }
    }
    floor
}

/// The approximate direction from the nearest point of a flat convex occluder to `p`; any direction is valid.
fn direction(p: Point3, occluder: &Occluder) -> Point3 {
    let outline = occluder.outline();
    let mut best = (f64::INFINITY, [0.0; 3]);
    let mut offer = |q: Point3| {
        let d = [p[0] - q[0], p[1] - q[1], p[2] - q[2]];
        let square: f64 = d.iter().map(|x| x * x).sum();
        if square < best.0 {
            best = (square, d);
        }
    };
    let sub = |a: Point3, b: Point3| [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    let dot = |a: Point3, b: Point3| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    for i in 1..outline.len() - 1 {
        let (a, b, c) = (outline[0], outline[i], outline[i + 1]);
        // A few steps of the nearest point of a triangle by its three edges and its plane.
        for (a, b) in [(a, b), (b, c), (c, a)] {
            let along = sub(b, a);
            let t = (dot(sub(p, a), along) / dot(along, along)).clamp(0.0, 1.0);
            if t.is_finite() {
                offer([0, 1, 2].map(|k| a[k] + t * along[k]));
            }
        }
        let (u, v) = (sub(b, a), sub(c, a));
        let (uu, uv, vv) = (dot(u, u), dot(u, v), dot(v, v));
        let (pu, pv) = (dot(sub(p, a), u), dot(sub(p, a), v));
        let det = uu * vv - uv * uv;
        let (s, t) = ((pu * vv - pv * uv) / det, (pv * uu - pu * uv) / det);
        if s >= 0.0 && t >= 0.0 && s + t <= 1.0 {
            offer([0, 1, 2].map(|k| a[k] + s * u[k] + t * v[k]));
        }
    }
    best.1
}
