//! The same orders of faces with sides decided by plain floats, and a z-buffer of 16 bits.
//!
//! Which pixels a face covers is exact here, as everywhere in the crate; for a piece of a face it follows from the
//! planes that cut it, so that pieces of a face never overlap and leave no cracks. What goes wrong is therefore wrong
//! order, and nothing else.

use crate::stability::plain::{Float, Kept, V, dot, minus, rounded};
use sightlines::visible_surface::{Camera, Faces, Fragment, NOTHING};
use std::marker::PhantomData;

/// A part of a face, with rounded corners.
#[derive(Debug, Clone)]
struct Piece<F> {
    face: u32,
    corners: Vec<V<F>>,
    /// Faces whose planes cut it off, and whether it is in front of them.
    cuts: Vec<(u32, bool)>,
}

/// Planes of all faces, and what counts as on them.
struct Planes<F> {
    of: Vec<Kept<F>>,
    epsilon: f64,
}

/// Where a piece lies to a plane.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Lies {
    On,
    Front,
    Behind,
    Across,
}

impl<F: Float> Planes<F> {
    fn new(faces: &Faces, epsilon: f64) -> Self {
        Self { of: faces.corners().iter().map(|&corners| Kept::through(corners)).collect(), epsilon }
    }

    fn lies(&self, piece: &Piece<F>, plane: u32) -> Lies {
        if piece.face == plane {
            return Lies::On;
        }
        let at = piece.corners.iter().map(|&p| self.of[plane as usize].at(p).wide());
        let (front, behind) = at.fold((false, false), |(f, b), x| (f || x > self.epsilon, b || x < -self.epsilon));
        match (front, behind) {
            (false, false) => Lies::On,
            (true, false) => Lies::Front,
            (false, true) => Lies::Behind,
            (true, true) => Lies::Across,
        }
    }

    /// The part of a piece in front of a plane, or behind it.
    fn part(&self, piece: &Piece<F>, plane: u32, front: bool) -> Piece<F> {
        let at = |p: V<F>| {
            let x = self.of[plane as usize].at(p);
            if front { x } else { -x }
        };
        let n = piece.corners.len();
        let mut corners = Vec::with_capacity(n + 1);
        for (i, &a) in piece.corners.iter().enumerate() {
            let b = piece.corners[(i + 1) % n];
            let (fa, fb) = (at(a), at(b));
            let zero = F::of(0.0);
            if fa >= zero {
                corners.push(a);
            }
            if (fa > zero && fb < zero) || (fa < zero && fb > zero) {
                let t = fa / (fa - fb);
                corners.push(std::array::from_fn(|k| a[k] + (b[k] - a[k]) * t));
            }
        }
        let mut cuts = piece.cuts.clone();
        cuts.push((plane, front));
        Piece { face: piece.face, corners, cuts }
    }
}

fn whole_faces<F: Float>(faces: &Faces) -> Vec<Piece<F>> {
    let whole = |face: u32| Piece { face, corners: faces.of(face).map(rounded).to_vec(), cuts: Vec::new() };
    faces.ids().filter(|&f| faces.has_area(f)).map(whole).collect()
}

/// Most pieces that anything is cut into: rounded orders need not come to an end.
const MOST: usize = 1000;

/// A BSP tree that is walked as it is made: farthest first.
fn bsp_order<F: Float>(faces: &Faces, camera: &Camera, epsilon: f64) -> Vec<Piece<F>> {
    enum Work<F> {
        Sort(Vec<Piece<F>>),
        Draw(Vec<Piece<F>>),
    }
    let planes = Planes::new(faces, epsilon);
    let eye = rounded::<F>(camera.eye());
    let mut out = Vec::new();
    let mut left = vec![Work::Sort(whole_faces(faces))];
    let mut n_made = 0;
    while let Some(work) = left.pop() {
        let pieces = match work {
            Work::Draw(pieces) => {
                out.extend(pieces);
                continue;
            }
            Work::Sort(pieces) => pieces,
        };
        let Some(first) = pieces.first() else { continue };
        let plane = first.face;
        let (mut front, mut behind, mut on) = (Vec::new(), Vec::new(), Vec::new());
        for piece in pieces {
            n_made += 1;
            match planes.lies(&piece, plane) {
                Lies::On => on.push(piece),
                Lies::Front => front.push(piece),
                Lies::Behind => behind.push(piece),
                Lies::Across if n_made > MOST => on.push(piece),
                Lies::Across => {
                    front.push(planes.part(&piece, plane, true));
                    behind.push(planes.part(&piece, plane, false));
                }
            }
        }
        // Of faces in one plane the lower id is seen.
        on.sort_by_key(|p| std::cmp::Reverse(p.face));
        let in_front = planes.of[plane as usize].at(eye) > F::of(0.0);
        let (near, far) = if in_front { (front, behind) } else { (behind, front) };
        left.extend([Work::Sort(near), Work::Draw(on), Work::Sort(far)]);
    }
    out
}

/// What the depth sort knows of a piece: the range of depths, and its pixels.
#[derive(Debug, Clone)]
struct Waiting<F> {
    piece: Piece<F>,
    depth: [f64; 2],
    pixels: Vec<u32>,
    marked: bool,
}

/// The depth sort with its tests by planes; farthest first.
fn newell_order<F: Float>(faces: &Faces, camera: &Camera, covered: &Covered, epsilon: f64) -> Vec<Piece<F>> {
    let planes = Planes::<F>::new(faces, epsilon);
    let eye = rounded::<F>(camera.eye());
    let ahead = rounded::<F>(camera.ray(f64::from(camera.size()[0]) / 2.0, f64::from(camera.size()[1]) / 2.0));
    let waiting = |piece: Piece<F>, marked: bool| {
        let depth = piece.corners.iter().map(|&p| dot(minus(p, eye), ahead).wide());
        let depth = depth.fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], x| [x.min(l), x.max(h)]);
        let pixels = covered.of(&piece, &planes, camera);
        Waiting { piece, depth, pixels, marked }
    };
    let mut list: Vec<Waiting<F>> = whole_faces(faces).into_iter().map(|p| waiting(p, false)).collect();
    list.retain(|p| !p.pixels.is_empty());
    let by_depth =
        |a: &Waiting<F>, b: &Waiting<F>| a.depth[1].total_cmp(&b.depth[1]).then(b.piece.face.cmp(&a.piece.face));
    list.sort_by(by_depth);
    let mut out = Vec::new();
    let mut n_steps = 0;
    while let Some(p) = list.pop() {
        n_steps += 1;
        let side = |plane: u32| if planes.of[plane as usize].at(eye) > F::of(0.0) { Lies::Front } else { Lies::Behind };
        let may_precede = |q: &Waiting<F>| {
            // The test of projections, as far as the picture shows it.
            let is_apart = || !p.pixels.iter().any(|pixel| q.pixels.binary_search(pixel).is_ok());
            if p.piece.face == q.piece.face || q.depth[1] < p.depth[0] || is_apart() {
                return true;
            }
            let p_to_q = planes.lies(&p.piece, q.piece.face);
            if p_to_q == Lies::On {
                return p.piece.face > q.piece.face;
            }
            (p_to_q != Lies::Across && p_to_q != side(q.piece.face))
                || planes.lies(&q.piece, p.piece.face) == side(p.piece.face)
        };
        let Some(obstacle) = list.iter().rposition(|q| !may_precede(q)).filter(|_| n_steps < MOST) else {
            out.push(p.piece);
            // The next one is the farthest of what is left, whatever has waited for what.
            list.iter_mut().for_each(|q| q.marked = false);
            list.sort_by(by_depth);
            continue;
        };
        if !list[obstacle].marked {
            let mut q = list.remove(obstacle);
            q.marked = true;
            list.push(p);
            list.push(q);
            continue;
        }
        // Those that wait for each other, of which the plane of one cuts another: this one and its obstacle, if they do.
        list.push(p);
        let last = list.len() - 1;
        let circle: Vec<usize> = [last, obstacle].into_iter().chain((0..last).filter(|&k| list[k].marked)).collect();
        let pairs = circle.iter().flat_map(|&k| circle.iter().map(move |&by| (k, by)));
        let cut = pairs
            .map(|(k, by)| (k, list[by].piece.face))
            .find(|&(k, plane)| planes.lies(&list[k].piece, plane) == Lies::Across);
        let Some((k, plane)) = cut else {
            // Nothing to split, as it seems.
            out.extend(list.pop().map(|p| p.piece));
            continue;
        };
        let split = list.remove(k).piece;
        list.extend([true, false].map(|front| waiting(planes.part(&split, plane, front), false)));
        list.retain(|p| !p.pixels.is_empty());
        list.iter_mut().for_each(|q| q.marked = false);
        list.sort_by(by_depth);
    }
    out
}

/// Which pixels each face covers, exactly; ascending.
pub(super) struct Covered(Vec<Vec<u32>>);

impl Covered {
    pub(super) fn new(faces: &Faces, camera: &Camera) -> Self {
        let width = camera.size()[0];
        let of = |face: u32| {
            let mut pixels = Vec::new();
            if faces.has_area(face) {
                Fragment::whole(face).spans(camera, faces, |y, from, to| {
                    pixels.extend((from..to).map(|x| y * width + x));
                });
            }
            pixels.sort_unstable();
            pixels
        };
        Self(faces.ids().map(of).collect())
    }

    /// The pixels of a piece.
    fn of<F: Float>(&self, piece: &Piece<F>, planes: &Planes<F>, camera: &Camera) -> Vec<u32> {
        let is_inside = |&pixel: &u32| {
            let (p, _) = hit(&planes.of[piece.face as usize], camera, pixel);
            piece.cuts.iter().all(|&(plane, front)| (planes.of[plane as usize].at(p) >= F::of(0.0)) == front)
        };
        let all = self.0[piece.face as usize].iter().copied();
        if piece.cuts.is_empty() { all.collect() } else { all.filter(is_inside).collect() }
    }
}

/// Where the ray of a pixel meets a face, and its depth, in plain floats.
fn hit<F: Float>(plane: &Kept<F>, camera: &Camera, pixel: u32) -> (V<F>, F) {
    let width = camera.size()[0];
    let ray = rounded::<F>(camera.ray(f64::from(pixel % width) + 0.5, f64::from(pixel / width) + 0.5));
    let eye = rounded::<F>(camera.eye());
    let t = -plane.at(eye) / dot(plane.normal, ray);
    (std::array::from_fn(|k| eye[k] + ray[k] * t), t)
}

fn paint<F: Float>(pieces: &[Piece<F>], faces: &Faces, camera: &Camera, covered: &Covered) -> Vec<u32> {
    let planes = Planes::<F>::new(faces, 0.0);
    let mut out = vec![NOTHING; (camera.size()[0] * camera.size()[1]) as usize];
    for piece in pieces {
        for pixel in covered.of(piece, &planes, camera) {
            out[pixel as usize] = piece.face;
        }
    }
    out
}

/// How a naive method orders.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ordered<F> {
    newell: bool,
    epsilon: f64,
    floats: PhantomData<F>,
}

impl<F: Float> Ordered<F> {
    pub(super) const fn bsp(epsilon: f64) -> Self {
        Self { newell: false, epsilon, floats: PhantomData }
    }

    pub(super) const fn newell(epsilon: f64) -> Self {
        Self { newell: true, epsilon, floats: PhantomData }
    }

    /// What each pixel shows.
    pub(super) fn picture(&self, faces: &Faces, camera: &Camera) -> Vec<u32> {
        let covered = Covered::new(faces, camera);
        let pieces = if self.newell {
            newell_order::<F>(faces, camera, &covered, self.epsilon)
        } else {
            bsp_order::<F>(faces, camera, self.epsilon)
        };
        paint(&pieces, faces, camera, &covered)
    }
}

/// A z-buffer of whole numbers of 16 bits, from 0 at the nearest depth of the camera to 65535 at the farthest; where it has none, at a 64th
/// of a unit and in the infinite.
pub(super) fn z16(faces: &Faces, camera: &Camera) -> Vec<u32> {
    let planes = Planes::<f64>::new(faces, 0.0);
    let covered = Covered::new(faces, camera);
    let [near, far] = camera.depths();
    let near = if near > 0.0 { near } else { 1.0 / 64.0 };
    let (most, least) = (1.0 / near, 1.0 / far);
    let n = (camera.size()[0] * camera.size()[1]) as usize;
    let (mut out, mut depths) = (vec![NOTHING; n], vec![u16::MAX; n]);
    for (face, pixels) in (0u32..).zip(&covered.0) {
        for &pixel in pixels {
            let (_, t) = hit(&planes.of[face as usize], camera, pixel);
            let z = (((most - 1.0 / t) / (most - least)).clamp(0.0, 1.0) * f64::from(u16::MAX)).round() as u16;
            let pixel = pixel as usize;
            if z < depths[pixel] || out[pixel] == NOTHING {
                (depths[pixel], out[pixel]) = (z, face);
            }
        }
    }
    out
}
