//! Numbers about isovists.

use crate::{Boundary, Isovist};
use sightlines_geometry::Point2;

/// The measures of an isovist, in units of the plan.
///
/// In doubles, from vertices that were rounded once: correct but for rounding. Lengths that are averaged over directions are averaged over
/// the angle of the view.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Measures {
    /// A: area. Benedikt 1979.
    pub area: f64,
    /// P: length of the whole outline. Benedikt 1979 counts walls only, depthmapX all of it, as here.
    pub perimeter: f64,
    /// Q: length of the outline's parts that are no wall: occluding rays and the frame. Benedikt 1979.
    pub occlusivity: f64,
    /// 4 π A / P²: 1 for a circle. Conroy Dalton and Turner, as in depthmapX.
    pub compactness: f64,
    /// Distance from the eye to the centroid. Conroy Dalton 2001.
    pub drift: f64,
    /// Direction from the eye to the centroid in degrees, counter-clockwise from the axis of x, from 0 to 360; 0 if they coincide.
    pub drift_angle: f64,
    /// Distance from the eye to the nearest point of the outline.
    pub minimal_radial: f64,
    /// Distance from the eye to the farthest point of the outline.
    pub maximal_radial: f64,
    /// Mean distance to the outline over all directions.
    pub mean_radial: f64,
    /// M2: mean of the squared deviation of the radial from its mean. Benedikt 1979.
    pub variance: f64,
    /// M3: mean of the cubed deviation. Benedikt 1979; divided by `variance` to the power 3/2 it has no unit.
    pub skewness: f64,
}

impl Measures {
    /// The measures with their names, in the order of the fields.
    pub const fn named(&self) -> [(&'static str, f64); 11] {
        [
            ("area", self.area),
            ("perimeter", self.perimeter),
            ("occlusivity", self.occlusivity),
            ("compactness", self.compactness),
            ("drift", self.drift),
            ("drift_angle", self.drift_angle),
            ("minimal_radial", self.minimal_radial),
            ("maximal_radial", self.maximal_radial),
            ("mean_radial", self.mean_radial),
            ("variance", self.variance),
            ("skewness", self.skewness),
        ]
    }
}

impl Isovist {
    /// All measures. O(vertices).
    ///
    /// # Source
    /// Benedikt, "To take hold of space: isovists and isovist fields", Environment and Planning B 6, 1979; for what is not in it, each field
    /// names its own.
    pub fn measures(&self) -> Measures {
        let mut m = Measures { minimal_radial: f64::INFINITY, ..Measures::default() };
        if self.vertices.len() < 3 {
            return Measures::default();
        }
        let (mut twice_area, mut centroid, mut first, mut third) = (0.0, Point2::ZERO, 0.0, 0.0);
        for (a, b, kind) in self.edges() {
            let (a, b) = (a - self.eye, b - self.eye);
            let (step, cross) = (b - a, a.perp_dot(b));
            let length = step.length();
            m.perimeter += length;
            if !matches!(kind, Boundary::Wall(_)) {
                m.occlusivity += length;
            }
            twice_area += cross;
            centroid += (a + b) * cross;
            let (from, to) = (a.length(), b.length());
            m.maximal_radial = m.maximal_radial.max(from);
            if length == 0.0 {
                continue;
            }
            // Along the edge, s runs from a·d to b·d, and the eye is at distance h from its line: r² = h² + s².
            let direction = step / length;
            let (h, s, e) = ((cross / length).abs(), a.dot(direction), b.dot(direction));
            m.minimal_radial = m.minimal_radial.min(if s <= 0.0 && e >= 0.0 { h } else { from.min(to) });
            if h > 0.0 {
                let angle = libm::asinh(e / h) - libm::asinh(s / h);
                first += h * angle;
                third += 0.5 * h * (e * to - s * from + h * h * angle);
            }
        }
        if m.perimeter == 0.0 {
            // All vertices are one point.
            return Measures::default();
        }
        m.area = 0.5 * twice_area;
        m.compactness = 4.0 * std::f64::consts::PI * m.area / (m.perimeter * m.perimeter);
        if twice_area > 0.0 {
            let drift = centroid / (3.0 * twice_area);
            m.drift = drift.length();
            m.drift_angle =
                if m.drift > 0.0 { libm::atan2(drift.y, drift.x).to_degrees().rem_euclid(360.0) } else { 0.0 };
        }
        let (mean, square, cube) = (first / self.angle, twice_area / self.angle, third / self.angle);
        m.mean_radial = mean;
        m.variance = (square - mean * mean).max(0.0);
        m.skewness = cube - 3.0 * mean * square + 2.0 * mean * mean * mean;
        m
    }
}
