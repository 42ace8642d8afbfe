//! Pieces of faces, known by the planes that cut them.
//!
//! A fragment is a convex part of a face. It keeps no constructed corners: each of its edges is an edge of the face or lies on a
//! plane of the input. In barycentric coordinates of the face, the function of any plane is linear, with its values at the face's three corners as
//! coefficients; so an edge is a vector of three numbers, a corner is the cross product of two edges, and on which side of a plane a
//! corner lies is the sign of a 3 by 3 determinant of values at corners of the input. However often a fragment is split, decisions are made from
//! input coordinates, of bounded degree, exactly: nothing drifts.
//!
//! Source: representing fragments by planes goes back to Sugihara and Iri, "A solid modelling system free from topological
//! inconsistency", J. Information Processing 12(4), 1989; barycentric vectors are our own choice.

mod extents;
mod split;

use crate::camera::Camera;
use crate::faces::Faces;
use crate::plane::{Approx, InputPlane};
use crate::rows::spans;
use crate::side::Side;
use sightlines_exact::{Dyadic, vector as exact};
use sightlines_geometry::orient3d;
use std::sync::Arc;

pub use crate::extents::Extents;
pub use split::Relation;

/// A convex part of a face. See the module.
#[derive(Debug, Clone)]
pub struct Fragment {
    face: u32,
    /// In the order in which the face's corners go round; none for the whole face. Shared, as trees send the same fragments again and again.
    edges: Option<Arc<[Edge]>>,
}

/// What an edge lies on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum On {
    /// The edge of the face opposite to a corner.
    Face(u8),
    /// A plane that cut the face.
    Plane(InputPlane),
}

/// An edge: where a linear function of barycentric coordinates is 0; it is positive inside.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Edge {
    pub(crate) on: On,
    /// 1 or -1: the side of the plane that is inside.
    pub(crate) sign: i8,
    /// Coefficients: values at the corners of the face, times the sign and a positive number.
    form: [f64; 3],
    /// How much each may be off.
    error: [f64; 3],
}

const fn whole(corner: u8, form: [f64; 3]) -> Edge {
    Edge { on: On::Face(corner), sign: 1, form, error: [0.0; 3] }
}

/// From corner 0 to 1, from 1 to 2, from 2 to 0.
static WHOLE: [Edge; 3] = [whole(2, [0., 0., 1.]), whole(0, [1., 0., 0.]), whole(1, [0., 1., 0.])];

impl Edge {
    fn new(faces: &Faces, face: u32, plane: InputPlane, sign: i8) -> Self {
        let values = faces.of(face).map(|p| plane.at(faces, p));
        // Divided by a power of two, so that products of coefficients stay far from the ends of what doubles hold.
        let largest = values.iter().fold(0.0f64, |m, v| m.max(v.value.abs()));
        let scale = if largest.is_normal() { 2f64.powi(1023 - (largest.to_bits() >> 52) as i32) } else { 1.0 };
        let form = values.map(|v| f64::from(sign) * v.value * scale);
        let error = values.map(|v| if v.error == 0.0 { 0.0 } else { v.error * scale + f64::MIN_POSITIVE });
        Self { on: On::Plane(plane), sign, form, error }
    }

    /// The function without rounding.
    fn exact(&self, faces: &Faces, face: u32) -> [Dyadic; 3] {
        match self.on {
            On::Face(corner) => std::array::from_fn(|k| Dyadic::new(f64::from(u8::from(k == usize::from(corner))))),
            On::Plane(plane) => {
                let values = faces.of(face).map(|p| plane.exact_at(faces, p));
                if self.sign < 0 { values.map(|v| -v) } else { values }
            }
        }
    }
}

impl Fragment {
    /// A whole face, which has an area.
    pub fn whole(face: u32) -> Self {
        Self { face, edges: None }
    }

    /// The face that it is part of.
    pub fn face(&self) -> u32 {
        self.face
    }

    /// Whether it is all of its face.
    pub fn is_whole(&self) -> bool {
        self.edges.is_none()
    }

    /// Number of its edges, which is that of its corners.
    pub fn n_edges(&self) -> usize {
        self.edges().len()
    }

    pub(crate) fn edges(&self) -> &[Edge] {
        self.edges.as_deref().unwrap_or(&WHOLE)
    }

    /// Calls `span(y, from, to)` for each row with pixels that it covers: those from `from` to before `to`. A pixel is covered if the ray
    /// through its centre meets the fragment, at a depth that the camera sees; a ray along an edge belongs to the piece of which that is a
    /// left or upper edge, so that of two pieces that share an edge exactly one has it. Returns how many times doubles could not tell.
    ///
    /// Exact. Cost: some operations for each row and edge.
    pub fn spans(&self, camera: &Camera, faces: &Faces, span: impl FnMut(u32, u32, u32)) -> u64 {
        let window = self.extents(camera, faces).window(camera);
        if window.is_empty() {
            return 0;
        }
        let sides = self.sides(camera, faces);
        if sides.is_empty() { 0 } else { spans(camera, faces, &sides, window, span) }
    }

    /// The lines around what is seen of it; none if it is seen edge-on.
    pub(crate) fn sides(&self, camera: &Camera, faces: &Faces) -> Vec<Side> {
        let corners = faces.of(self.face);
        let Some(sign) = facing(camera, faces, self.face) else { return Vec::new() };
        let plane = InputPlane::of(faces, self.face);
        let eye = crate::side::eye_sign(camera, faces, &plane);
        let mut sides = Vec::with_capacity(self.n_edges() + 2);
        for edge in self.edges() {
            sides.push(match edge.on {
                On::Face(k) => {
                    let [p, q] = [1, 2].map(|i| corners[(usize::from(k) + i) % 3]);
                    Side::edge(camera, p, q).times(sign)
                }
                On::Plane(cutter) => Side::cut(camera, faces, cutter, plane).times(eye * i32::from(edge.sign)),
            });
        }
        let [near, far] = camera.depths();
        if near > 0.0 {
            sides.push(Side::depth(camera, faces, plane, near).times(eye));
        }
        if far < f64::INFINITY {
            sides.push(Side::depth(camera, faces, plane, far).times(-eye));
        }
        sides
    }
}

/// 1 if the eye is behind a face, -1 if it is in front of it, nothing if it is in its plane; exactly.
#[inline]
pub(crate) fn facing(camera: &Camera, faces: &Faces, face: u32) -> Option<i32> {
    let [a, b, c] = *faces.of(face);
    let side = orient3d(a, b, c, camera.eye());
    if side == 0.0 { None } else { Some(if side > 0.0 { -1 } else { 1 }) }
}

/// The determinant of three edge functions, of which the third may be that of any plane: its sign says on which side of that plane the
/// corner lies in which the first two meet.
fn corner_sign(faces: &Faces, face: u32, f: &Edge, g: &Edge, plane: &InputPlane, at: &[Approx; 3]) -> i32 {
    // A plane that made one of the edges holds the corner.
    if [f, g].iter().any(|e| e.on == On::Plane(*plane)) {
        return 0;
    }
    if let (On::Face(i), On::Face(j)) = (f.on, g.on) {
        let corner = usize::from(3 - i - j);
        return at[corner].sign().unwrap_or_else(|| plane.exact_at(faces, faces.of(face)[corner]).sign());
    }
    let (value, error) = determinant(f, g, at);
    if value.abs() > error {
        return if value > 0.0 { 1 } else { -1 };
    }
    if error == 0.0 && value == 0.0 {
        return 0;
    }
    let corner = exact::cross(&f.exact(faces, face), &g.exact(faces, face));
    let values = faces.of(face).map(|p| plane.exact_at(faces, p));
    exact::dot(&corner, &values).sign()
}

/// The determinant in doubles, and how much it may be off.
fn determinant(f: &Edge, g: &Edge, at: &[Approx; 3]) -> (f64, f64) {
    let (corner, error) = corner(f, g);
    let (mut value, mut off) = (0.0, 0.0);
    let mut is_zero = true;
    for k in 0..3 {
        value += corner[k] * at[k].value;
        let bound = error[k] * (at[k].value.abs() + at[k].error) + corner[k].abs() * at[k].error;
        off += bound + 4.0 * crate::camera::U * (corner[k] * at[k].value).abs();
        // Products may vanish below the smallest double, and their bounds with them: only a factor that is 0 makes 0.
        is_zero &= (corner[k] == 0.0 && error[k] == 0.0) || (at[k].value == 0.0 && at[k].error == 0.0);
    }
    // The bounds themselves are rounded.
    (value, if is_zero { 0.0 } else { off * (1.0 + 64.0 * crate::camera::U) + crate::plane::LEAST })
}

/// Where two edges meet, in barycentric coordinates up to a positive factor, and how much each may be off. Positive for edges that
/// follow each other.
fn corner(f: &Edge, g: &Edge) -> ([f64; 3], [f64; 3]) {
    let mut out = ([0.0; 3], [0.0; 3]);
    for (k, i, j) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
        let (left, right) = (f.form[i] * g.form[j], f.form[j] * g.form[i]);
        out.0[k] = left - right;
        let bound =
            |a: usize, b: usize| f.form[a].abs() * g.error[b] + f.error[a] * g.form[b].abs() + f.error[a] * g.error[b];
        let is_zero =
            |a: usize, b: usize| f.form[a] == 0.0 && f.error[a] == 0.0 || g.form[b] == 0.0 && g.error[b] == 0.0;
        // What products may lose below the smallest normal double.
        let lost = if is_zero(i, j) && is_zero(j, i) { 0.0 } else { f64::MIN_POSITIVE };
        out.1[k] = bound(i, j) + bound(j, i) + 2.0 * crate::camera::U * (left.abs() + right.abs()) + lost;
    }
    out
}

#[cfg(test)]
mod tests;
