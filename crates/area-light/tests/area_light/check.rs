//! Pieces against rays of `sightlines-testkit`, from random points of the light to random points of the piece.

use crate::common::{Triangle, scene_of};
use sightlines_area_light::{Lighting, Side, State};
use sightlines_geometry::{Point3, orient3d};
use sightlines_testkit::Random;
use sightlines_testkit::RayScene;

/// Rays that were cast, and pieces that they contradict.
#[derive(Debug, Default)]
pub(crate) struct Checked {
    pub(crate) n_umbra: u64,
    pub(crate) n_lit: u64,
    pub(crate) wrong_umbra: Vec<usize>,
    pub(crate) wrong_lit: Vec<usize>,
}

impl Checked {
    pub(crate) fn is_right(&self) -> bool {
        self.wrong_umbra.is_empty() && self.wrong_lit.is_empty()
    }
}

/// Casts `n` rays to each piece that is decided. The scene is given anew, so that a lighting of another scene can be held against it.
///
/// A ray counts if slightly moved ones do the same.
pub(crate) fn check(triangles: &[Triangle], lighting: &Lighting, n: u32, seed: u64) -> Checked {
    let rays = RayScene::new(&scene_of(triangles));
    let mut random = Random::new(seed, 0);
    let mut checked = Checked::default();
    for (i, piece) in lighting.pieces().iter().enumerate() {
        if piece.state == State::InDoubt {
            continue;
        }
        let [a, b, c] = piece.side.turned(triangles[piece.face as usize]);
        for _ in 0..n {
            let (p, l) = (inside(&piece.corners, &mut random), of_light(lighting, &mut random));
            let is_in_front = orient3d(a, b, c, l) > 0.0;
            let moves =
                [[0.0; 3], [1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]];
            let arrives = |m: &Point3| is_in_front && arrives(&rays, l, p, *m);
            match piece.state {
                State::Umbra => {
                    checked.n_umbra += 1;
                    if moves.iter().all(arrives) {
                        checked.wrong_umbra.push(i);
                    }
                }
                _ => {
                    checked.n_lit += 1;
                    if !moves.iter().any(arrives) {
                        checked.wrong_lit.push(i);
                    }
                }
            }
        }
    }
    checked
}

/// Whether light arrives, with the way moved by some billionths of its length, and without its very ends.
fn arrives(rays: &RayScene, l: Point3, p: Point3, moved: Point3) -> bool {
    let length = (0..3).map(|k| (p[k] - l[k]).powi(2)).sum::<f64>().sqrt();
    let at = |s: f64| std::array::from_fn(|k| l[k] + (p[k] - l[k]) * s + moved[k] * length * 2e-9);
    !rays.is_blocked(at(1e-8), at(1.0 - 1e-8))
}

/// A point of a triangle, not at its very border.
fn inside([a, b, c]: &[Point3; 3], random: &mut Random) -> Point3 {
    let (mut s, mut t) = (random.unit(), random.unit());
    if s + t > 1.0 {
        (s, t) = (1.0 - s, 1.0 - t);
    }
    let weight = |x: f64| 0.001 + 0.997 * x;
    let [u, v, w] = [weight(s), weight(t), weight(1.0 - s - t)];
    std::array::from_fn(|k| u * a[k] + v * b[k] + w * c[k])
}

fn of_light(lighting: &Lighting, random: &mut Random) -> Point3 {
    let b = lighting.light().bounds();
    std::array::from_fn(|k| b.min[k] + (b.max[k] - b.min[k]) * (0.001 + 0.998 * random.unit()))
}

/// LightingAreas of the sides of faces by the corners of their pieces add up to those of the faces.
pub(crate) fn covers(triangles: &[Triangle], lighting: &Lighting) -> bool {
    let area = |[a, b, c]: [Point3; 3]| {
        let d = |p: Point3, q: Point3| [0, 1, 2].map(|k| q[k] - p[k]);
        let (u, v) = (d(a, b), d(a, c));
        let n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
        n.iter().map(|x| x * x).sum::<f64>().sqrt() / 2.0
    };
    let mut sums = vec![[0.0; 2]; triangles.len()];
    for piece in lighting.pieces() {
        sums[piece.face as usize][usize::from(piece.side == Side::Back)] += area(piece.corners);
    }
    let fits = |(t, sums): (&Triangle, &[f64; 2])| {
        let whole = area(*t);
        sums.iter().all(|&sum| sum == 0.0 || (sum - whole).abs() <= 1e-9 * whole.max(1e-3))
    };
    triangles.iter().zip(&sums).all(fits)
}
