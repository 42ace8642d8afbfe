//! Rotations between keys, as boxes around pieces of arcs and curves of quaternions.

use super::ROUNDING;
use sightlines_geometry::range::Range;

/// The most pieces of the rotations of a node; beyond, neighbours are put together.
pub(super) const MOST_PIECES: usize = 1024;
/// Rotations that differ by less count as equal: single precision rounds them by less. Boxes around arcs are wider by twice
/// as much, so that what lies between a point of the arc and one that is so near to its end is in them.
pub(super) const SAME: f64 = 1e-6;
/// How often an arc or a curve is halved at most.
const MOST_HALVINGS: u32 = 5;
/// Chords from this length on are halved: about 6 degrees of a unit quaternion, 12 of a rotation.
const LONG_CHORD: f64 = 0.1;

/// The two rotations that all keys are, as unit quaternions; `None` if there are more.
pub(super) fn one_arc(keys: impl Iterator<Item = Vec<f64>>) -> Option<[[f64; 4]; 2]> {
    let mut found: Vec<[f64; 4]> = Vec::new();
    for key in keys {
        let key = unit(key.try_into().ok()?)?;
        if !found.iter().any(|q| *q == key || q.map(|x| -x) == key) {
            found.push(key);
        }
        if found.len() > 2 {
            return None;
        }
    }
    Some([*found.first()?, *found.last()?])
}

/// Puts neighbours together while there are too many.
pub(super) fn thin(pieces: &mut Vec<[Range; 4]>) {
    while pieces.len() > MOST_PIECES {
        let joined = |pair: &[[Range; 4]]| {
            let [first, last] = [pair[0], pair[pair.len() - 1]];
            std::array::from_fn(|k| first[k].with(last[k]))
        };
        *pieces = pieces.chunks(2).map(joined).collect();
    }
}

/// Adds boxes around all quaternions between two keys, which have these control points; `None` if one is no rotation.
pub(super) fn turned_between(points: &[[f64; 4]], out: &mut Vec<[Range; 4]>) -> Option<()> {
    match *points {
        [q] => add_arc(unit(q)?, unit(q)?, 0, out),
        [a, b] => {
            let (a, b) = (unit(a)?, unit(b)?);
            let cosine: f64 = (0..4).map(|k| a[k] * b[k]).sum();
            // The shorter arc; of two that are nearly as long, both.
            if cosine > -0.001 {
                add_arc(a, b, MOST_HALVINGS, out);
            }
            if cosine < 0.001 {
                add_arc(a, b.map(|x| -x), MOST_HALVINGS, out);
            }
        }
        [a, b, c, d] => add_curve([a, b, c, d], MOST_HALVINGS, out)?,
        _ => return None,
    }
    Some(())
}

pub(super) fn unit(q: [f64; 4]) -> Option<[f64; 4]> {
    let length = q.iter().map(|x| x * x).sum::<f64>().sqrt();
    (length > 0.0 && length.is_finite()).then(|| q.map(|x| x / length))
}

/// Boxes around the arc between two unit quaternions. The arc is nowhere farther from its chord c than 1 - sqrt(1 - c²/4),
/// which is at most c²/4.
fn add_arc(a: [f64; 4], b: [f64; 4], halvings: u32, out: &mut Vec<[Range; 4]>) {
    let squared: f64 = (0..4).map(|k| (a[k] - b[k]) * (a[k] - b[k])).sum();
    let middle = std::array::from_fn(|k| a[k] + b[k]);
    match unit(middle) {
        Some(middle) if squared > LONG_CHORD * LONG_CHORD && halvings > 0 => {
            add_arc(a, middle, halvings - 1, out);
            add_arc(middle, b, halvings - 1, out);
        }
        _ => {
            let off = squared / 4.0 + 2.0 * SAME;
            out.push(std::array::from_fn(|k| Range::of(a[k]).with(Range::of(b[k])).wider(off)));
        }
    }
}

/// Boxes around a cubic curve of quaternions, which programs bring to unit length afterwards.
fn add_curve(points: [[f64; 4]; 4], halvings: u32, out: &mut Vec<[Range; 4]>) -> Option<()> {
    if points.iter().flatten().any(|x| !x.is_finite()) {
        return None;
    }
    let between = |a: [f64; 4], b: [f64; 4]| -> [f64; 4] { std::array::from_fn(|k| 0.5 * (a[k] + b[k])) };
    let span = (0..4).map(|k| {
        let of = points.map(|p| p[k]);
        of.into_iter().fold(f64::NEG_INFINITY, f64::max) - of.into_iter().fold(f64::INFINITY, f64::min)
    });
    if halvings > 0 && span.fold(0.0, f64::max) > LONG_CHORD {
        let [a, b, c, d] = points;
        let (ab, bc, cd) = (between(a, b), between(b, c), between(c, d));
        let (abc, bcd) = (between(ab, bc), between(bc, cd));
        let middle = between(abc, bcd);
        add_curve([a, ab, abc, middle], halvings - 1, out)?;
        return add_curve([middle, bcd, cd, d], halvings - 1, out);
    }
    let largest = points.iter().flatten().fold(1.0, |m: f64, x| m.max(x.abs()));
    let hull = |k: usize| points.iter().map(|p| Range::of(p[k])).reduce(Range::with).unwrap_or(Range::ALL);
    out.push(std::array::from_fn(|k| hull(k).wider(largest * ROUNDING)));
    Some(())
}
