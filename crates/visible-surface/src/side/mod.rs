//! On which side of a straight line of the picture a pixel's centre lies, exactly.
//!
//! A line of the picture is a plane through the eye. All lines that this crate asks about are edges of faces, the lines
//! in which the planes of two faces meet, and where a plane reaches a depth. Their functions are linear in the ray's direction, hence
//! in pixels: `a x + b y + c`. Doubles with a bound decide nearly always; else the same function is computed without rounding.

use crate::camera::{Camera, U};
use crate::faces::Faces;
use crate::plane::{InputPlane, LEAST};
use crate::vector::{cross, cross_size, dot, dot_size, sub};
use sightlines_exact::{Dyadic, vector as exact};
use sightlines_geometry::Point3;
use std::cell::OnceCell;

/// What a line comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Source {
    /// Rays that pass the edge from p to q on the side of `(p - eye) × (q - eye)`.
    Edge(Point3, Point3),
    /// Rays that meet plane 0 before plane 1, or with opposite signs: see [`Side::cut`].
    Cut(InputPlane, InputPlane),
    /// Rays that meet the plane not before a depth, or with opposite signs.
    Depth(InputPlane, f64),
}

/// The linear function of a line, and its sign for pixels.
#[derive(Debug, Clone)]
pub(crate) struct Side {
    /// Of the place in pixels.
    pub(crate) a: f64,
    pub(crate) b: f64,
    pub(crate) c: f64,
    /// How much the function may be off, anywhere in the picture.
    pub(crate) error: f64,
    source: Source,
    /// Whether the function is the negative of its source's.
    flip: bool,
    exact: OnceCell<Box<[Dyadic; 3]>>,
}

impl Side {
    /// The line of an edge: positive on the side to which `(p - eye) × (q - eye)` points. The same numbers, but for the
    /// sign, for the edge from q to p.
    #[inline]
    pub(crate) fn edge(camera: &Camera, p: Point3, q: Point3) -> Self {
        let flip = p > q;
        let (p, q) = if flip { (q, p) } else { (p, q) };
        let (u, v) = (sub(p, camera.eye()), sub(q, camera.eye()));
        // Two differences, a product and a sum: four roundings.
        Self::new(camera, cross(u, v), cross_size(u, v), Source::Edge(p, q), flip)
    }

    /// The line in which two planes meet: the sign says, times the product of the signs of the eye against both,
    /// whether rays meet `first` before `second`. Both must be met in front of the eye where this is used.
    pub(crate) fn cut(camera: &Camera, faces: &Faces, first: InputPlane, second: InputPlane) -> Self {
        let ((n, n_size), (m, m_size)) = (first.normal(faces), second.normal(faces));
        let ((v, v_size), (w, w_size)) = (depth_value(camera, faces, &first), depth_value(camera, faces, &second));
        // 1 / t = n · d / v for the first and m · d / w for the second; 1 / t is larger where it is nearer.
        let normal = [0, 1, 2].map(|k| w * n[k] - v * m[k]);
        let size = [0, 1, 2].map(|k| w_size * n_size[k] + v_size * m_size[k]);
        Self::new(camera, normal, size, Source::Cut(first, second), false)
    }

    /// The line where a plane reaches a depth: the sign says, times the sign of [`eye_sign`], whether rays meet it not
    /// before that depth.
    pub(crate) fn depth(camera: &Camera, faces: &Faces, plane: InputPlane, depth: f64) -> Self {
        let (n, n_size) = plane.normal(faces);
        let (v, v_size) = depth_value(camera, faces, &plane);
        // t >= depth where v / (n · d) >= depth, so v - depth * n · d has the sign of v: the function of a direction has no
        // constant, so the constant is added below.
        let mut side =
            Self::new(camera, n.map(|x| -depth * x), n_size.map(|x| depth * x), Source::Depth(plane, depth), false);
        side.c += v;
        side.error += 16.0 * U * v_size + U * side.c.abs();
        side
    }

    #[inline]
    fn new(camera: &Camera, normal: Point3, size: Point3, source: Source, flip: bool) -> Self {
        let [corner, across, down] = camera.rays();
        let (mut a, mut b, mut c) = (dot(normal, across), dot(normal, down), dot(normal, corner));
        let reach = dot_size(size, camera.reach());
        if flip {
            (a, b, c) = (-a, -b, -c);
        }
        // At most 16 roundings in the normal, three in the product, four where the function is evaluated; some more are granted
        // for those of `size` and of this line.
        Self { a, b, c, error: 32.0 * U * reach + LEAST, source, flip, exact: OnceCell::new() }
    }

    /// The same line with its sides changed if `sign` is negative.
    #[inline]
    pub(crate) fn times(mut self, sign: i32) -> Self {
        if sign < 0 {
            (self.a, self.b, self.c, self.flip) = (-self.a, -self.b, -self.c, !self.flip);
            // What was computed without rounding holds the other sign.
            self.exact = OnceCell::new();
        }
        self
    }

    /// Whether the centre of a pixel is inside: on the positive side, or on the line itself if that is a left edge, or an upper one.
    #[inline]
    pub(crate) fn has(&self, camera: &Camera, faces: &Faces, x: u32, y: u32) -> bool {
        let value = self.a * (f64::from(x) + 0.5) + self.b * (f64::from(y) + 0.5) + self.c;
        if value.abs() > self.error {
            return value > 0.0;
        }
        self.exactly(camera, faces, x, y) > 0
    }

    /// The sign at the centre of a pixel, exactly; 0 on the line.
    pub(crate) fn sign(&self, camera: &Camera, faces: &Faces, x: u32, y: u32) -> i32 {
        let value = self.a * (f64::from(x) + 0.5) + self.b * (f64::from(y) + 0.5) + self.c;
        if value.abs() > self.error {
            return if value > 0.0 { 1 } else { -1 };
        }
        let [a, b, c] = &**self.exact.get_or_init(|| Box::new(self.exact_function(camera, faces)));
        at(a, b, c, x, y).sign()
    }

    /// 1 or -1; on the line itself, what the rule of left and upper edges says.
    #[cold]
    #[inline(never)]
    fn exactly(&self, camera: &Camera, faces: &Faces, x: u32, y: u32) -> i32 {
        let [a, b, c] = &**self.exact.get_or_init(|| Box::new(self.exact_function(camera, faces)));
        let first = [at(a, b, c, x, y).sign(), a.sign(), b.sign()].into_iter().find(|&s| s != 0);
        first.unwrap_or(-1)
    }

    /// a, b and c without rounding.
    #[cold]
    fn exact_function(&self, camera: &Camera, faces: &Faces) -> [Dyadic; 3] {
        let eye = Dyadic::vector(camera.eye());
        let [corner, across, down] = camera.rays().map(Dyadic::vector);
        let (normal, constant) = match &self.source {
            Source::Edge(p, q) => {
                let [u, v] = [p, q].map(|p| exact::sub(&Dyadic::vector(*p), &eye));
                (exact::cross(&u, &v), None)
            }
            Source::Cut(first, second) => {
                let (n, m) = (first.exact_normal(faces), second.exact_normal(faces));
                let [v, w] = [first, second].map(|p| -p.exact_at(faces, camera.eye()));
                (exact::sub(&exact::scale(&n, &w), &exact::scale(&m, &v)), None)
            }
            Source::Depth(plane, depth) => {
                let n = plane.exact_normal(faces);
                (exact::scale(&n, &Dyadic::new(-depth)), Some(-plane.exact_at(faces, camera.eye())))
            }
        };
        let c = exact::dot(&normal, &corner);
        let c = constant.map_or_else(|| c.clone(), |v| &c + &v);
        let all = [exact::dot(&normal, &across), exact::dot(&normal, &down), c];
        if self.flip { all.map(|x| -x) } else { all }
    }
}

fn at(a: &Dyadic, b: &Dyadic, c: &Dyadic, x: u32, y: u32) -> Dyadic {
    let [x, y] = [x, y].map(|n| Dyadic::new(f64::from(n) + 0.5));
    &(&(a * &x) + &(b * &y)) + c
}

/// `n · (p - eye)` for points p of a plane, and what its rounding is measured by: the negative of the plane's function at the eye.
pub(crate) fn depth_value(camera: &Camera, faces: &Faces, plane: &InputPlane) -> (f64, f64) {
    match *plane {
        InputPlane::Axis(k, at) => {
            let v = at - camera.eye()[usize::from(k)];
            (v, v.abs())
        }
        InputPlane::Face(face) => {
            let a = faces.of(face)[0];
            let (n, size) = plane.normal(faces);
            let way = sub(a, camera.eye());
            (dot(n, way), dot_size(size, way))
        }
    }
}

/// The sign of `n · (p - eye)`, exactly: 1 if the eye is behind the plane, -1 in front, 0 if on it.
pub(crate) fn eye_sign(camera: &Camera, faces: &Faces, plane: &InputPlane) -> i32 {
    -plane.side(faces, camera.eye())
}

#[cfg(test)]
mod tests;
