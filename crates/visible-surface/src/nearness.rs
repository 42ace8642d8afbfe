//! Which of two faces is nearer at a pixel, exactly.
//!
//! One over the depth is linear in the picture. In doubles, with a bound, it decides nearly always; else the line in which the planes of
//! both faces meet does, without rounding.

use crate::camera::{Camera, U};
use crate::faces::Faces;
use crate::plane::{InputPlane, LEAST};
use crate::side::{Side, eye_sign};
use crate::vector::{cross, cross_size, dot, dot_size, sub};

/// One over the depth of a face's plane: `a x + b y + c` for a place in pixels, off by at most `error` anywhere in the picture.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Nearness {
    pub(crate) a: f64,
    pub(crate) b: f64,
    pub(crate) c: f64,
    pub(crate) error: f64,
}

impl Nearness {
    /// Of a face that is not seen edge-on.
    #[inline]
    pub(crate) fn of(camera: &Camera, faces: &Faces, face: u32) -> Self {
        let [p, q, r] = *faces.of(face);
        let (u, v, way) = (sub(q, p), sub(r, p), sub(p, camera.eye()));
        let (normal, size) = (cross(u, v), cross_size(u, v));
        let [corner, across, down] = camera.rays();
        let value = dot(normal, way);
        // Eight roundings in the value, ten in the sum above it (four in the normal, three in the product, three where it is evaluated).
        let value_error = 16.0 * U * dot_size(size, way);
        let reach = dot_size(size, camera.reach());
        let least = value.abs() - value_error;
        if least <= 0.0 {
            return Self { a: 0.0, b: 0.0, c: 0.0, error: f64::INFINITY };
        }
        let largest = reach / least;
        // The inverse and the product add two roundings, which is the last term with room for those of this line.
        let error = (24.0 * U * reach + largest * value_error) / least + 16.0 * U * largest + LEAST;
        let inverse = 1.0 / value;
        let scaled = |n: [f64; 3]| dot(normal, n) * inverse;
        let (a, b, c) = (scaled(across), scaled(down), scaled(corner));
        if [a, b, c, error].iter().all(|x| x.is_finite()) {
            Self { a, b, c, error }
        } else {
            Self { a: 0.0, b: 0.0, c: 0.0, error: f64::INFINITY }
        }
    }

    #[inline]
    pub(crate) fn at(&self, x: u32, y: u32) -> f64 {
        self.a * (f64::from(x) + 0.5) + self.b * (f64::from(y) + 0.5) + self.c
    }
}

/// The line in which the planes of two faces meet, and the product of the eye's signs to them; none if they are one plane.
type Meeting = Option<(Side, i32)>;

/// Two faces that doubles cannot tell apart, remembered: the next pixel mostly asks about the same two.
#[derive(Debug, Default)]
pub(crate) struct DepthComparator {
    last: Option<([u32; 2], Meeting)>,
    /// For each face one that was found to lie in its plane and has no higher id, itself if there is none.
    plane_mate: Vec<u32>,
    /// How often it was asked.
    pub(crate) n_exact: u64,
}

impl DepthComparator {
    /// Whether `face` is seen before `other` at a pixel whose ray meets both: it is nearer there, or as near and has the lower id.
    #[cold]
    #[inline(never)]
    pub(crate) fn is_nearer(&mut self, camera: &Camera, faces: &Faces, face: u32, other: u32, x: u32, y: u32) -> bool {
        self.n_exact += 1;
        let pair = [face.min(other), face.max(other)];
        if self.last.as_ref().is_none_or(|(of, _)| *of != pair) {
            let mates = pair.map(|f| self.first_mate(f, faces.len()));
            let line = if mates[0] == mates[1] { None } else { self.meeting(camera, faces, mates, pair) };
            self.last = Some((pair, line));
        }
        let first_wins = match &self.last {
            Some((_, Some((side, sign)))) => side.sign(camera, faces, x, y) * sign >= 0,
            // In one plane, or nothing: the lower id.
            _ => true,
        };
        first_wins == (face == pair[0])
    }

    /// Forgets what depends on the eye; which faces lie in one plane does not.
    pub(crate) fn look_from_elsewhere(&mut self) {
        self.last = None;
    }

    /// The lowest id that is known to lie in the plane of a face.
    fn first_mate(&mut self, face: u32, n: usize) -> u32 {
        if self.plane_mate.is_empty() {
            self.plane_mate = (0..n as u32).collect();
        }
        let mut at = face;
        while self.plane_mate[at as usize] != at {
            let next = self.plane_mate[at as usize];
            // Ways become shorter as they are gone.
            self.plane_mate[at as usize] = self.plane_mate[next as usize];
            at = next;
        }
        at
    }

    /// Where the planes of two faces meet. If they are one, that is remembered of their mates.
    fn meeting(&mut self, camera: &Camera, faces: &Faces, mates: [u32; 2], pair: [u32; 2]) -> Meeting {
        let [first, second] = pair.map(|f| InputPlane::of(faces, f));
        if first.is_same(faces, &second) {
            self.plane_mate[mates[0].max(mates[1]) as usize] = mates[0].min(mates[1]);
            return None;
        }
        let sign = eye_sign(camera, faces, &first) * eye_sign(camera, faces, &second);
        Some((Side::cut(camera, faces, first, second), sign))
    }
}
