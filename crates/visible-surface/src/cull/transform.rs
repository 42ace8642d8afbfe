//! Planes, normals and triangles under matrices, and back faces in projection space.
//!
//! A plane is a row: `plane · point` is its function. If points are transformed by M, planes are by the inverse of M from
//! the right, which for columns is the inverse transpose. Only its direction matters, so the cofactors do, which are the
//! inverse transpose times the determinant: nothing is divided by. They turn a plane round if the determinant is
//! negative, hence its sign is put on as well. Transforming a normal by M itself is right only if M keeps angles.
//!
//! A matrix is given by rows and applied to columns `(x, y, z, 1)`. What is computed is rounded, as usual, but signs that
//! decide are exact for the numbers given.
//!
//! Source: Turkowski, "Properties of surface-normal transformations", Graphics Gems, 1990, for normals; the test in
//! projection space is the classical one of Sutherland, Sproull and Schumacker, "A Characterization of Ten Hidden-Surface
//! Algorithms", 1974.

use super::Facing;
use crate::camera::{Camera, U};
use crate::vector::{cross, dot, sub};
use sightlines_exact::{Dyadic, vector as exact};
use sightlines_geometry::Point3;
use sightlines_geometry::vector::unit_of_any_size;

/// A 4 by 4 matrix, row by row.
pub type Matrix = [[f64; 4]; 4];

/// The function of the plane of a triangle, as (normal, constant): positive in front, in scene units cubed. Rounded.
pub fn plane_of(corners: &[Point3; 3]) -> [f64; 4] {
    let [a, b, c] = *corners;
    let n = cross(sub(b, a), sub(c, a));
    [n[0], n[1], n[2], -dot(n, a)]
}

/// A point, as `(x, y, z, w)`, transformed.
pub fn point(matrix: &Matrix, p: [f64; 4]) -> [f64; 4] {
    matrix.map(|row| (0..4).map(|k| row[k] * p[k]).sum())
}

/// A plane transformed: its function at transformed points is what it was at the points themselves, times the determinant's
/// magnitude; so what was in front of it is. None for a matrix that is singular, or has entries that are no finite numbers.
pub fn plane(matrix: &Matrix, plane: [f64; 4]) -> Option<[f64; 4]> {
    let sign = f64::from(determinant_sign(matrix).filter(|&s| s != 0)?);
    Some(cofactors(matrix).map(|row| sign * (0..4).map(|k| row[k] * plane[k]).sum::<f64>()))
}

/// A normal transformed by the linear part of a matrix (the first three of each of the first three rows), and rescaled to
/// length 1. None if that part is singular, or if there is no normal.
pub fn normal(matrix: &Matrix, n: Point3) -> Option<Point3> {
    let [a, b, c] = [0, 1, 2].map(|k| [matrix[k][0], matrix[k][1], matrix[k][2]]);
    let mut linear = [[0.0; 4]; 4];
    for (row, from) in linear.iter_mut().zip([a, b, c]) {
        row[..3].copy_from_slice(&from);
    }
    linear[3][3] = 1.0;
    let sign = f64::from(determinant_sign(&linear).filter(|&s| s != 0)?);
    // The rows of cofactors of a matrix with rows a, b and c.
    let turned = [cross(b, c), cross(c, a), cross(a, b)].map(|row| sign * dot(row, n));
    unit_of_any_size(turned)
}

/// A triangle transformed by a matrix whose last row is (0, 0, 0, 1). A reflection turns the order of corners round, so they are
/// put into another order then: what was the front is the front. None for a singular matrix.
pub fn triangle(matrix: &Matrix, corners: &[Point3; 3]) -> Option<[Point3; 3]> {
    let sign = determinant_sign(matrix).filter(|&s| s != 0)?;
    let [a, b, c] = corners.map(|[x, y, z]| {
        let [x, y, z, _] = point(matrix, [x, y, z, 1.0]);
        [x, y, z]
    });
    Some(if sign > 0 { [a, b, c] } else { [a, c, b] })
}

/// The perspective of a camera: from scene units to (pixels to the right, pixels down, depth in the picture, 1), each
/// times the depth and a positive number. Depth in the picture grows with depth: it is 0 at the nearest depth and 1 at
/// the farthest, be that infinite; for a camera that sees from depth 0 on it is `-1 / depth`.
///
/// Rounded; without rounding for cameras of small whole numbers.
pub fn projection(camera: &Camera) -> Matrix {
    let row = |n: Point3| [n[0], n[1], n[2], -dot(n, camera.eye())];
    let [x, y, depth] = camera.normals().map(row);
    let [near, far] = camera.depths();
    // Depth in the picture is far (t - near) / (t (far - near)), or (t - near) / t, or -1 / t; what it is divided by
    // besides t is left out and multiplied to the other rows instead.
    let (slope, constant, scale) = match (near > 0.0, far < f64::INFINITY) {
        (true, true) => (far, -far * near, far - near),
        (true, false) => (1.0, -near, 1.0),
        (false, _) => (0.0, -1.0, 1.0),
    };
    let mut z = depth.map(|v| v * slope);
    z[3] += constant * camera.volume().0;
    let [x, y, depth] = [x, y, depth].map(|row| row.map(|v| v * scale));
    [x, y, z, depth]
}

/// Which side of a face is seen in projection space, where the eye is infinitely far away and all rays are parallel: the
/// sign of the z coefficient of the transformed plane. Exact for the matrix and the corners given.
///
/// * `matrix`: a perspective, for which the eye is the point that it sends to (0, 0, k, 0), or a parallel projection, for
///   which the eye looks from where z is least. Whether depth is standard or reversed does not matter for a perspective:
///   the eye is in the scene, and k says.
///
/// [`Facing::Mixed`] for a singular matrix, and for numbers that are not finite.
pub fn facing_in_projection(matrix: &Matrix, corners: &[Point3; 3]) -> Facing {
    let finite = |mut all: std::slice::Iter<'_, f64>| all.all(|x| x.is_finite());
    if !(matrix.iter().all(|row| finite(row.iter())) && corners.iter().all(|p| finite(p.iter()))) {
        return Facing::Mixed;
    }
    // With C for cofactors, the eye is row 2 of C divided by C[2][3], and the z coefficient is row 2 of C times the
    // plane. So the plane's function at the eye is their quotient. For a parallel projection C[2][3] is 0 and the way to
    // the eye is minus row 2 of C divided by the determinant.
    let Some(det) = determinant_sign(matrix).filter(|&s| s != 0) else { return Facing::Mixed };
    let coefficient = z_coefficient_sign(matrix, corners);
    let rows = [0, 1, 3].map(|k| [matrix[k][0], matrix[k][1], matrix[k][2]]);
    let eye = match exact_minor_sign(&rows) {
        // The place of (2, 3) in a checkerboard of signs is a minus.
        0 => -det,
        minor => -minor,
    };
    if coefficient * eye > 0 { Facing::Front } else { Facing::Back }
}

/// The sign of the z coefficient of the plane of a triangle, transformed by cofactors alone.
fn z_coefficient_sign(matrix: &Matrix, corners: &[Point3; 3]) -> i32 {
    // Row 2 of the cofactors times a plane is the determinant of the matrix with the plane in the place of row 2.
    let mut with = *matrix;
    with[2] = plane_of(corners);
    let (value, _) = determinant(&with);
    let [a, b, c] = *corners;
    // The plane's own size: magnitudes instead of differences.
    let grown = |p: Point3, q: Point3| [0, 1, 2].map(|k| p[k].abs() + q[k].abs());
    let size = crate::vector::cross_size(grown(a, b), grown(a, c));
    with[2] = [size[0], size[1], size[2], crate::vector::dot_size(size, a)];
    let (_, all) = determinant(&with);
    // Two differences, a product and a sum, three more in the constant, seven in the determinant; the rest is for the
    // bound itself.
    let error = 32.0 * U * all;
    if value.abs() > error && no_underflow(matrix.iter().flatten().chain(corners.iter().flatten())) {
        return if value > 0.0 { 1 } else { -1 };
    }
    let corners = corners.map(Dyadic::vector);
    let n = exact::normal(&corners);
    let constant = -exact::dot(&n, &corners[0]);
    let [x, y, z] = n;
    let mut rows = matrix.map(|row| row.map(Dyadic::new));
    rows[2] = [x, y, z, constant];
    exact_determinant(&rows).sign()
}

/// The sign of the determinant, exactly; none if an entry is not finite.
pub fn determinant_sign(matrix: &Matrix) -> Option<i32> {
    if !matrix.iter().flatten().all(|x| x.is_finite()) {
        return None;
    }
    let (value, all) = determinant(matrix);
    if value.abs() > 16.0 * U * all && no_underflow(matrix.iter().flatten()) {
        return Some(if value > 0.0 { 1 } else { -1 });
    }
    Some(exact_determinant(&matrix.map(|row| row.map(Dyadic::new))).sign())
}

/// Whether no product of six of the numbers and of their differences can be too small for a normal double: all are 0 or
/// at least 2^-100, so that differences are at least 2^-152. (An overflow leaves no finite bound, and nothing exceeds
/// that.)
fn no_underflow<'a>(mut all: impl Iterator<Item = &'a f64>) -> bool {
    const LEAST: f64 = f64::from_bits((1023 - 100) << 52);
    all.all(|&x| x == 0.0 || x.abs() >= LEAST)
}

/// The determinant, and the same sum with all terms positive.
fn determinant(m: &Matrix) -> (f64, f64) {
    let mut sums = (0.0, 0.0);
    // Laplace's expansion in pairs of rows: the six minors of rows 0 and 1 times the complementary ones of rows 2 and 3.
    for (i, j, k, l, sign) in PAIRS {
        let minor = |r: usize, s: usize, i: usize, j: usize| {
            let (a, b) = (m[r][i] * m[s][j], m[r][j] * m[s][i]);
            (a - b, a.abs() + b.abs())
        };
        let ((a, a_size), (b, b_size)) = (minor(0, 1, i, j), minor(2, 3, k, l));
        sums.0 += sign * a * b;
        sums.1 += a_size * b_size;
    }
    sums
}

const PAIRS: [(usize, usize, usize, usize, f64); 6] = [
    (0, 1, 2, 3, 1.0),
    (0, 2, 1, 3, -1.0),
    (0, 3, 1, 2, 1.0),
    (1, 2, 0, 3, 1.0),
    (1, 3, 0, 2, -1.0),
    (2, 3, 0, 1, 1.0),
];

fn exact_determinant(m: &[[Dyadic; 4]; 4]) -> Dyadic {
    let minor = |r: usize, s: usize, i: usize, j: usize| &(&m[r][i] * &m[s][j]) - &(&m[r][j] * &m[s][i]);
    PAIRS.iter().fold(Dyadic::new(0.0), |sum, &(i, j, k, l, sign)| {
        let term = &minor(0, 1, i, j) * &minor(2, 3, k, l);
        if sign > 0.0 { &sum + &term } else { &sum - &term }
    })
}

fn exact_minor_sign(rows: &[Point3; 3]) -> i32 {
    let [a, b, c] = rows.map(Dyadic::vector);
    exact::determinant(&a, &b, &c).sign()
}

/// The cofactors of all entries.
fn cofactors(m: &Matrix) -> Matrix {
    let others = |k: usize| [0, 1, 2, 3].into_iter().filter(move |&i| i != k);
    std::array::from_fn(|r| {
        std::array::from_fn(|c| {
            let mut rows = others(r).map(|r| {
                let mut of = others(c).map(|c| m[r][c]);
                std::array::from_fn(|_| of.next().expect("three are left"))
            });
            let [a, b, c3]: [Point3; 3] = std::array::from_fn(|_| rows.next().expect("three are left"));
            let minor = dot(a, cross(b, c3));
            if (r + c) % 2 == 0 { minor } else { -minor }
        })
    })
}
