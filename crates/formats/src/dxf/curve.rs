//! Curves as rational Bézier curves: maps of space act on their corners, and a curve lies within its corners.

use super::affine::Affine;
use sightlines_geometry::sin_cos;

/// A rational Bézier curve; all weights are positive. The ends are exactly the first and the last corner.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Bezier<const D: usize> {
    /// Corners and their weights, two or more.
    pub(super) corners: Vec<([f64; D], f64)>,
}

impl Bezier<3> {
    /// The curve that a map makes of this, seen from above.
    pub(super) fn seen_from_above(&self, map: &Affine) -> Bezier<2> {
        let image = |p| {
            let [x, y, _] = map.point(p);
            [x, y]
        };
        Bezier { corners: self.corners.iter().map(|&(p, weight)| (image(p), weight)).collect() }
    }
}

impl Bezier<2> {
    pub(super) fn halves(&self) -> [Self; 2] {
        let mut level = self.corners.clone();
        let n = level.len();
        let (mut first, mut second) = (Vec::with_capacity(n), Vec::with_capacity(n));
        while let (Some(&start), Some(&end)) = (level.first(), level.last()) {
            first.push(start);
            second.push(end);
            level = level.windows(2).map(|pair| middle(pair[0], pair[1])).collect();
        }
        second.reverse();
        [Self { corners: first }, Self { corners: second }]
    }

    /// Whether no point of the curve is further than `deviation` from the segment between its ends: no corner is.
    pub(super) fn is_flat(&self, deviation: f64) -> bool {
        let [(a, _), .., (b, _)] = self.corners[..] else { return true };
        let inner = &self.corners[1..self.corners.len() - 1];
        inner.iter().all(|&(p, _)| square_to_segment(p, a, b) <= deviation * deviation)
    }
}

fn middle((a, u): ([f64; 2], f64), (b, v): ([f64; 2], f64)) -> ([f64; 2], f64) {
    let sum = u + v;
    (std::array::from_fn(|k| (u * a[k] + v * b[k]) / sum), sum / 2.0)
}

fn square_to_segment(p: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    let (ab, ap) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
    let length = ab[0] * ab[0] + ab[1] * ab[1];
    let along = ab[0] * ap[0] + ab[1] * ap[1];
    let share = if length > 0.0 { (along / length).clamp(0.0, 1.0) } else { 0.0 };
    let away = [ap[0] - share * ab[0], ap[1] - share * ab[1]];
    away[0] * away[0] + away[1] * away[1]
}

/// An arc of an ellipse, `center + cos t · u + sin t · v`, in pieces of at most a quarter.
///
/// * `start`, `sweep`: in degrees; the sweep is above 0 and at most 360, which closes it.
pub(super) fn arc(center: [f64; 3], u: [f64; 3], v: [f64; 3], start: f64, sweep: f64) -> Vec<Bezier<3>> {
    let direction = |degrees| {
        let [sin, cos] = sin_cos(degrees);
        [cos, sin]
    };
    let along = |[cos, sin]: [f64; 2]| -> [f64; 3] { std::array::from_fn(|k| cos * u[k] + sin * v[k]) };
    let place = |degrees| -> [f64; 3] {
        let offset = along(direction(degrees));
        std::array::from_fn(|k| center[k] + offset[k])
    };
    // Quarters begin and end on the axes, where points are exact.
    let end = start + sweep;
    let mut stops = vec![start];
    let mut next = (start / 90.0).floor() * 90.0 + 90.0;
    while next < end && stops.len() < 6 {
        if next > start {
            stops.push(next);
        }
        next += 90.0;
    }
    stops.push(end);
    let n = stops.len();
    let mut places: Vec<[f64; 3]> = stops.iter().map(|&degrees| place(degrees)).collect();
    if sweep >= 360.0 {
        places[n - 1] = places[0];
    }
    let piece = |k: usize| {
        let [sin, cos] = sin_cos((stops[k + 1] - stops[k]) / 2.0);
        let [c, s] = direction(stops[k]);
        let tangent = along([-s, c]);
        let corner = std::array::from_fn(|i| places[k][i] + sin / cos * tangent[i]);
        Bezier { corners: vec![(places[k], 1.0), (corner, cos), (places[k + 1], 1.0)] }
    };
    (0..n - 1).map(piece).collect()
}

/// The arc from `a` to `b` with a bulge, the tangent of a quarter of its angle, positive if it turns left. A bulge of zero is a
/// straight line. Both points have the same height.
pub(super) fn bulged(a: [f64; 3], b: [f64; 3], bulge: f64, pieces: &mut Vec<Bezier<3>>) {
    /// That of a quarter of a circle, rounded up.
    const QUARTER: f64 = 0.414_213_562_373_095_1;
    let [dx, dy] = [b[0] - a[0], b[1] - a[1]];
    let beside = |share: f64| [(a[0] + b[0]) / 2.0 + share * dy, (a[1] + b[1]) / 2.0 - share * dx, a[2]];
    if bulge.abs() > QUARTER && (dx != 0.0 || dy != 0.0) {
        let half = bulge / (1.0 + (1.0 + bulge * bulge).sqrt());
        let top = beside(bulge / 2.0);
        bulged(a, top, half, pieces);
        bulged(top, b, half, pieces);
    } else if bulge != 0.0 {
        let square = bulge * bulge;
        let corner = beside(bulge / (1.0 - square));
        pieces.push(Bezier { corners: vec![(a, 1.0), (corner, (1.0 - square) / (1.0 + square)), (b, 1.0)] });
    } else {
        pieces.push(Bezier { corners: vec![(a, 1.0), (b, 1.0)] });
    }
}
