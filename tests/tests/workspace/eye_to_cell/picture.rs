//! Pictures, given by their rectangle: which directions are in one.

use sightlines::eye_to_cell::View;
use sightlines::geometry::{Aabb, Point3};
use sightlines_testkit::Random;
use std::f64::consts::{PI, TAU};

/// A view in space, kept so that directions can be compared with it.
pub(crate) struct Picture {
    pub(crate) view: View,
    axes: [Point3; 3],
    fov: f64,
    aspect: f64,
}

pub(crate) fn dot(a: Point3, b: Point3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn minus(a: Point3, b: Point3) -> Point3 {
    [0, 1, 2].map(|k| a[k] - b[k])
}

/// `p + t d`.
pub(crate) fn along(p: Point3, d: Point3, t: f64) -> Point3 {
    [0, 1, 2].map(|k| p[k] + t * d[k])
}

fn unit(a: Point3) -> Point3 {
    let length = dot(a, a).sqrt();
    a.map(|x| x / length)
}

fn cross(a: Point3, b: Point3) -> Point3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Fields of view in degrees.
const FIELDS: [f64; 8] = [0.1, 0.6, 8.0, 60.0, 90.0, 140.0, 200.0, 360.0];

impl Picture {
    /// A picture that shows `direction` in its middle, tilted as chance has it; or all round.
    pub(crate) fn random(eye: Point3, direction: Point3, random: &mut Random) -> Self {
        let forward = unit(direction);
        let up = random.direction();
        let right = unit(cross(forward, up));
        let (fov, aspect) = (FIELDS[random.below(FIELDS.len())].to_radians(), [0.5, 1.0, 1.78][random.below(3)]);
        let view = match fov < TAU {
            true => View::perspective_horizontal(eye, direction, up, fov, aspect),
            false => View::all_round(eye),
        };
        Self {
            view: view.expect("numbers in their ranges"),
            axes: [forward, right, cross(right, forward)],
            fov,
            aspect,
        }
    }

    /// Whether a direction is in the picture and not at its rim.
    pub(crate) fn contains(&self, d: Point3) -> bool {
        let [forward, right, up] = self.axes.map(|axis| dot(axis, d));
        if self.fov >= TAU {
            return true;
        }
        if self.fov >= PI {
            return right.atan2(forward).abs() < 0.5 * self.fov - 1e-9;
        }
        let half = (0.5 * self.fov).tan() * forward * (1.0 - 1e-9);
        forward > 0.0 && right.abs() < half && up.abs() < half / self.aspect
    }

    /// A direction in the picture.
    pub(crate) fn direction(&self, random: &mut Random) -> Point3 {
        if self.fov >= PI {
            return loop {
                let d = random.direction();
                if self.contains(d) {
                    break d;
                }
            };
        }
        let half = (0.5 * self.fov).tan() * 0.999;
        let [forward, right, up] = self.axes;
        let [x, y] = [half, half / self.aspect].map(|half| half * (2.0 * random.unit() - 1.0));
        along(along(forward, right, x), up, y)
    }
}

/// The box around some points.
pub(crate) fn box_around(points: &[Point3]) -> Aabb<3> {
    Aabb::around(points.iter().copied())
}
