//! Planes that cut: those of faces, and those across an axis. Where points lie, exactly.

use crate::camera::{TINY_ERROR, U};
use crate::faces::Faces;
use crate::vector::{cross, cross_size, dot, dot_size, sub};
use sightlines_exact::{Dyadic, vector as exact};
use sightlines_geometry::{Point3, orient3d};

/// A plane through what was given: exact, whatever has been cut by it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum InputPlane {
    /// The plane of a face that has an area; positive in front of it.
    Face(u32),
    /// Across axis 0, 1 or 2 at a coordinate; positive beyond it.
    Axis(u8, f64),
}

/// A number with a bound of how much it is off.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Approx {
    pub(crate) value: f64,
    pub(crate) error: f64,
}

impl Approx {
    /// The sign, if it is sure.
    #[inline]
    pub(crate) fn sign(self) -> Option<i32> {
        if self.value > self.error {
            Some(1)
        } else if self.value < -self.error {
            Some(-1)
        } else if self.value == 0.0 && self.error == 0.0 {
            Some(0)
        } else {
            None
        }
    }
}

impl InputPlane {
    /// The plane of a face, in the form that faces in one plane across an axis share.
    pub fn of(faces: &Faces, face: u32) -> Self {
        let [a, b, c] = faces.of(face);
        match (0..3).find(|&k| a[k] == b[k] && b[k] == c[k]) {
            Some(k) => Self::Axis(k as u8, a[k]),
            None => Self::Face(face),
        }
    }

    /// On which side of it a point lies, exactly: 1, 0 or -1.
    pub fn side(&self, faces: &Faces, p: Point3) -> i32 {
        let x = match *self {
            Self::Axis(k, at) => p[k as usize] - at,
            Self::Face(face) => {
                let [a, b, c] = *faces.of(face);
                orient3d(a, b, c, p)
            }
        };
        i32::from(x > 0.0) - i32::from(x < 0.0)
    }

    /// The value of the plane's function at a point: `p[k] - at`, or `((b - a) × (c - a)) · (p - a)`.
    pub(crate) fn at(&self, faces: &Faces, p: Point3) -> Approx {
        match *self {
            // A difference of doubles has no error if it is 0, and is off by one rounding else.
            Self::Axis(k, at) => {
                let value = p[k as usize] - at;
                Approx { value, error: value.abs() * U }
            }
            Self::Face(face) => {
                let corners @ [a, b, c] = *faces.of(face);
                if corners.contains(&p) {
                    return Approx { value: 0.0, error: 0.0 };
                }
                let (u, v, w) = (sub(b, a), sub(c, a), sub(p, a));
                let value = dot(cross(u, v), w);
                // Two differences, a product, a sum, a difference, a product, two sums: fewer than 16 roundings.
                let error = 16.0 * U * dot_size(cross_size(u, v), w);
                if value.abs() > error || error == 0.0 {
                    return Approx { value, error };
                }
                if orient3d(a, b, c, p) == 0.0 {
                    return Approx { value: 0.0, error: 0.0 };
                }
                let value = self.exact_at(faces, p).to_f64();
                Approx { value, error: 2.0 * U * value.abs() }
            }
        }
    }

    /// The same, without rounding.
    pub(crate) fn exact_at(&self, faces: &Faces, p: Point3) -> Dyadic {
        match *self {
            Self::Axis(k, at) => &Dyadic::new(p[k as usize]) - &Dyadic::new(at),
            Self::Face(face) => {
                let a = Dyadic::vector(faces.of(face)[0]);
                exact::dot(&self.exact_normal(faces), &exact::sub(&Dyadic::vector(p), &a))
            }
        }
    }

    /// The gradient of the plane's function, without rounding.
    pub(crate) fn exact_normal(&self, faces: &Faces) -> [Dyadic; 3] {
        match *self {
            Self::Axis(k, _) => std::array::from_fn(|i| Dyadic::new(if i == usize::from(k) { 1.0 } else { 0.0 })),
            Self::Face(face) => exact::normal(&faces.of(face).map(Dyadic::vector)),
        }
    }

    /// The gradient, and for each component what its rounding is measured by.
    pub(crate) fn normal(&self, faces: &Faces) -> (Point3, Point3) {
        match *self {
            Self::Axis(k, _) => {
                let unit = std::array::from_fn(|i| if i == usize::from(k) { 1.0 } else { 0.0 });
                (unit, unit)
            }
            Self::Face(face) => {
                let [a, b, c] = *faces.of(face);
                let (u, v) = (sub(b, a), sub(c, a));
                (cross(u, v), cross_size(u, v))
            }
        }
    }

    /// Whether two planes are one, whichever way they are turned, exactly.
    pub fn is_same(&self, faces: &Faces, other: &Self) -> bool {
        if self == other {
            return true;
        }
        match (self, other) {
            (Self::Face(a), b) | (b, Self::Face(a)) => faces.of(*a).iter().all(|&p| b.side(faces, p) == 0),
            // One axis at two places, or two axes.
            (Self::Axis(..), Self::Axis(..)) => false,
        }
    }
}

/// A sum of values and its bound must not be lost where doubles are tiny.
pub(crate) const LEAST: f64 = TINY_ERROR;
