//! The directions in which two fragments are both seen, and in which of them one is nearer: exactly.
//!
//! The directions in which a fragment is seen from the eye are a convex cone, wherever the fragment lies; its sides are
//! planes through the eye, known by what they come from: an edge of a face, or the line in which two planes meet. What
//! two cones have in common is one cut by the sides of the other. A ray of the cone's border is where two of its sides
//! meet, so on which side of a third it lies is the sign of a 3 by 3 determinant; doubles with a bound decide nearly
//! always, else the same without rounding. No ray is ever rounded. That cones are cut, in place of pictures, is why
//! nothing has to be known about depths: fragments may lie across the plane of the eye, and reach around it.

use crate::camera::U;
use crate::faces::NOTHING;
use crate::fragment::{Edge, Fragment, On};
use crate::method::RenderInput;
use crate::plane::{Approx, InputPlane, LEAST};
use crate::side::depth_value;
use crate::vector::{cross, cross_size, dot, sub};
use sightlines_exact::{Dyadic, vector as exact};
use sightlines_geometry::{Point3, orient3d};
use std::cell::{Cell, OnceCell};

/// What a side comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Source {
    /// Directions on the side of `(p - eye) × (q - eye)`; p is the smaller one.
    Edge(Point3, Point3),
    /// `w n - v m` for planes 0 and 1 with normals n and m, where v and w are `n · (p - eye)` for points p of plane 0,
    /// and the same for plane 1.
    Cut(InputPlane, InputPlane),
}

impl Source {
    /// Whether both have one normal, but for the sign.
    fn is_same(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Cut(a, b), Self::Cut(c, d)) => (a, b) == (c, d) || (a, b) == (d, c),
            _ => self == other,
        }
    }
}

/// A plane through the eye: directions whose product with its normal is positive are inside.
#[derive(Debug, Clone)]
pub(super) struct Line {
    /// The normal, divided by its largest component.
    normal: Point3,
    /// How much each component may be off.
    error: Point3,
    source: Source,
    /// Whether it is the negative of its source's.
    flip: bool,
    /// The face that is seen through it.
    face: u32,
    /// Of edges of a face: the one after edge 0, 1 or 2 is 1, 2 or 0.
    place: u8,
    exact: OnceCell<Box<[Dyadic; 3]>>,
}

/// What decisions are made from.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sight<'a> {
    pub(super) input: &'a RenderInput<'a>,
    /// How often doubles could not tell.
    pub(super) n_exact: &'a Cell<u64>,
}

impl Line {
    fn new(normal: Point3, size: Point3, source: Source, flip: bool) -> Self {
        let (face, place) = (NOTHING, 0);
        let largest = normal.iter().fold(0.0f64, |m, x| m.max(x.abs()));
        if !(largest > 0.0 && largest.is_finite() && size.iter().all(|x| x.is_finite())) {
            return Self {
                normal: [0.0; 3],
                error: [f64::INFINITY; 3],
                source,
                flip,
                face,
                place,
                exact: OnceCell::new(),
            };
        }
        let scale = if flip { -largest } else { largest };
        // At most 16 roundings in each factor of a product, and one for it and for each sum and quotient; the smallest
        // normal double is far more than what underflow takes away from a product.
        let bound = |size: f64| (40.0 * U * size + f64::MIN_POSITIVE) / largest + f64::MIN_POSITIVE;
        Self {
            normal: normal.map(|x| x / scale),
            error: size.map(bound),
            source,
            flip,
            face,
            place,
            exact: OnceCell::new(),
        }
    }

    /// The side of an edge, on which `(p - eye) × (q - eye)` lies if `sign` is positive.
    fn edge(sight: &Sight<'_>, p: Point3, q: Point3, sign: i32) -> Self {
        let turned = p > q;
        let (p, q) = if turned { (q, p) } else { (p, q) };
        let [u, v] = [p, q].map(|x| sub(x, sight.input.camera.eye()));
        Self::new(cross(u, v), cross_size(u, v), Source::Edge(p, q), turned != (sign < 0))
    }

    /// The side of the line in which two planes meet: if `sign` is the product of those of the planes' distances, it
    /// holds the directions in which `first` is met before `second`, where both are met.
    fn cut(sight: &Sight<'_>, first: InputPlane, second: InputPlane, sign: i32) -> Self {
        let (faces, camera) = (sight.input.faces, sight.input.camera);
        let ((n, n_size), (m, m_size)) = (first.normal(faces), second.normal(faces));
        let ((v, v_size), (w, w_size)) = (depth_value(camera, faces, &first), depth_value(camera, faces, &second));
        let normal = [0, 1, 2].map(|k| w * n[k] - v * m[k]);
        let size = [0, 1, 2].map(|k| w_size * n_size[k] + v_size * m_size[k]);
        Self::new(normal, size, Source::Cut(first, second), sign < 0)
    }

    /// The normal without rounding, not divided by anything.
    fn exactly(&self, sight: &Sight<'_>) -> &[Dyadic; 3] {
        self.exact.get_or_init(|| {
            let eye = sight.input.camera.eye();
            let normal = match &self.source {
                Source::Edge(p, q) => {
                    let [u, v] = [p, q].map(|p| exact::sub(&Dyadic::vector(*p), &Dyadic::vector(eye)));
                    exact::cross(&u, &v)
                }
                Source::Cut(first, second) => {
                    let (n, m) = (first.exact_normal(sight.input.faces), second.exact_normal(sight.input.faces));
                    let [v, w] = [first, second].map(|p| -p.exact_at(sight.input.faces, eye));
                    exact::sub(&exact::scale(&n, &w), &exact::scale(&m, &v))
                }
            };
            Box::new(if self.flip { normal.map(|x| -x) } else { normal })
        })
    }

    /// Of two sides of a cone that follow each other, if they pass through a common end of edges: that point, and 1 if
    /// the ray where they meet leads to it, -1 if away from it.
    fn shared(&self, next: &Self) -> Option<(Point3, i32)> {
        let (Source::Edge(a, b), Source::Edge(c, d)) = (&self.source, &next.source) else { return None };
        let p = [*a, *b].into_iter().find(|p| p == c || p == d)?;
        // Sides of one face meet in a ray that leads away from its corner where something else than that face has them
        // in the other order. What is left of a face's cone meets the sides of that cone nowhere but between the
        // corners.
        let is_ahead = self.face != next.face || next.place == (self.place + 1) % 3;
        Some((p, if is_ahead { 1 } else { -1 }))
    }

    /// On which side a point lies.
    fn at(&self, sight: &Sight<'_>, p: Point3) -> i32 {
        let eye = sight.input.camera.eye();
        let turn = if self.flip { -1 } else { 1 };
        match &self.source {
            Source::Edge(a, b) if *a == p || *b == p => 0,
            Source::Edge(..) => {
                let way = sub(p, eye);
                let value = dot(self.normal, way);
                // One rounding of the difference, three of the product.
                let size: f64 = (0..3).map(|k| (self.error[k] + 8.0 * U * self.normal[k].abs()) * way[k].abs()).sum();
                if value.abs() > size + LEAST {
                    return if value > 0.0 { 1 } else { -1 };
                }
                let Source::Edge(a, b) = self.source else { return 0 };
                // The product of three vectors from the eye is the other way round than where the eye lies to the
                // three.
                let side = orient3d(a, b, p, eye);
                turn * (i32::from(side < 0.0) - i32::from(side > 0.0))
            }
            Source::Cut(first, second) => {
                // At points of one of the planes the function is that of the other one, times what lies between the eye
                // and the first.
                let [n, m] = [first, second].map(|plane| plane.side(sight.input.faces, p));
                let [v, w] = [first, second].map(|plane| -plane.side(sight.input.faces, eye));
                if n == 0 {
                    return -turn * v * m;
                }
                if m == 0 {
                    return turn * w * n;
                }
                let way = exact::sub(&Dyadic::vector(p), &Dyadic::vector(eye));
                sight.n_exact.set(sight.n_exact.get() + 1);
                exact::dot(self.exactly(sight), &way).sign()
            }
        }
    }
}

/// The sides of a cone, in the order in which they go round: the ray where a side begins is the cross product of the
/// side before and it.
#[derive(Debug, Clone)]
pub(super) struct Outline {
    lines: Vec<Line>,
}

impl Outline {
    /// Of a fragment whose plane the eye is not on; `eye` is 1 if it is in front of it, -1 if behind.
    pub(super) fn new(sight: &Sight<'_>, fragment: &Fragment, plane: InputPlane, eye: i32) -> Self {
        let (faces, face) = (sight.input.faces, fragment.face());
        let corners = faces.of(face);
        // The sign of the product of the three ways from the eye to the corners: of a face that is seen from behind.
        // `plane` may be turned another way than the face.
        let turn = -InputPlane::Face(face).side(faces, sight.input.camera.eye());
        let line = |edge: &Edge| match edge.on {
            On::Face(k) => {
                let [p, q] = [1, 2].map(|i| corners[(usize::from(k) + i) % 3]);
                let place = if turn > 0 { k } else { 2 - k };
                Line { face, place, ..Line::edge(sight, p, q, turn) }
            }
            On::Plane(cutter) => Line { face, ..Line::cut(sight, cutter, plane, -eye * i32::from(edge.sign)) },
        };
        let mut lines: Vec<Line> = fragment.edges().iter().map(line).collect();
        if turn < 0 {
            lines.reverse();
        }
        Self { lines }
    }
}

/// What is left of a cone. It has an inside.
#[derive(Debug)]
pub(super) struct Common<'a> {
    lines: Vec<&'a Line>,
}

impl<'a> Common<'a> {
    /// What two cones have in common; nothing if that has no inside.
    pub(super) fn of(sight: &Sight<'_>, p: &'a Outline, q: &'a Outline) -> Option<Self> {
        let mut lines = Vec::with_capacity(p.lines.len() + q.lines.len() + 1);
        lines.extend(&p.lines);
        let mut common = Self { lines };
        q.lines.iter().all(|line| common.clip(sight, line)).then_some(common)
    }

    /// Whether in some directions of the cone, and those around, `first` is met before `second`, of which the eye is on
    /// neither and which are not the same; in all directions of the cone both are met.
    pub(super) fn is_nearer(&self, sight: &Sight<'_>, first: (InputPlane, i32), second: (InputPlane, i32)) -> bool {
        let line = Line::cut(sight, first.0, second.0, first.1 * second.1);
        self.signs(sight, &line).contains(&1)
    }

    /// Leaves what is inside of a side; whether anything with an inside is left.
    fn clip(&mut self, sight: &Sight<'_>, line: &'a Line) -> bool {
        let signs = self.signs(sight, line);
        if !signs.contains(&1) {
            return false;
        }
        if !signs.contains(&-1) {
            return true;
        }
        let n = signs.len();
        // Side k goes from ray k to the next, and stays if one of the two is strictly inside.
        let stays = |k: usize| signs[k % n] > 0 || signs[(k + 1) % n] > 0;
        let first = (0..n).find(|&k| stays(k) && !stays(k + n - 1)).unwrap_or_else(|| {
            // All stay: what is cut off is a corner where two sides meet that both reach inside.
            (0..n).find(|&k| signs[k] <= 0).expect("some ray is outside")
        });
        let kept = (0..n).map(|i| (first + i) % n).take_while(|&k| stays(k)).map(|k| self.lines[k]).collect();
        self.lines = kept;
        self.lines.push(line);
        true
    }

    /// For each ray where a side begins, on which side of a line it lies.
    fn signs(&self, sight: &Sight<'_>, line: &Line) -> Vec<i32> {
        let n = self.lines.len();
        (0..n).map(|k| self.sign(sight, self.lines[(k + n - 1) % n], self.lines[k], line)).collect()
    }

    fn sign(&self, sight: &Sight<'_>, f: &Line, g: &Line, line: &Line) -> i32 {
        if f.source.is_same(&line.source) || g.source.is_same(&line.source) {
            return 0;
        }
        if let Some((p, ahead)) = f.shared(g) {
            return ahead * line.at(sight, p);
        }
        determinant(f, g, line).sign().unwrap_or_else(|| {
            sight.n_exact.set(sight.n_exact.get() + 1);
            let ray = exact::cross(f.exactly(sight), g.exactly(sight));
            exact::dot(&ray, line.exactly(sight)).sign()
        })
    }
}

/// The determinant of three normals.
fn determinant(f: &Line, g: &Line, h: &Line) -> Approx {
    let ray = cross(f.normal, g.normal);
    let value = dot(ray, h.normal);
    let mut error = 0.0;
    for (k, i, j) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
        let product = |i: usize, j: usize| {
            let (x, y) = (f.normal[i].abs() + f.error[i], g.normal[j].abs() + g.error[j]);
            f.error[i] * y + x * g.error[j] + 4.0 * U * x * y
        };
        let off = product(i, j) + product(j, i) + f64::MIN_POSITIVE;
        error += off * (h.normal[k].abs() + h.error[k]) + ray[k].abs() * (h.error[k] + 4.0 * U * h.normal[k].abs());
    }
    // The bound itself is rounded; no sum of products of normals is below what doubles hold by more than this.
    Approx { value, error: error * (1.0 + 64.0 * U) + LEAST }
}
