//! Lines through four edges of a sequence of portals, in plain floating point: a warning example.
//!
//! If any line passes, or touches, one does that touches four edges. All of these are computed, in Plücker coordinates,
//! and the sign of each with every edge is taken. Rounded coordinates and a rounded root make signs wrong.

use super::separators::{Rooted, Vector, corners, cross, sub};
use sightlines::geometry::Portal3;

/// A direction and a moment; or for an edge its moment and its direction.
type Six<T> = [T; 6];

fn side<T: Rooted>(x: &Six<T>, y: &Six<T>) -> T {
    x[0] * y[0] + x[1] * y[1] + x[2] * y[2] + x[3] * y[3] + x[4] * y[4] + x[5] * y[5]
}

/// Whether a line through four edges was found that has no other edge on its wrong side. O(edges⁵).
pub fn passes<T: Rooted>(portals: &[Portal3]) -> bool {
    if portals.len() < 2 {
        return true;
    }
    let mut rows: Vec<Six<T>> = Vec::new();
    for portal in portals {
        let corners: Vec<Vector<T>> = corners(portal);
        for (k, &a) in corners.iter().enumerate() {
            let b = corners[(k + 1) % corners.len()];
            let (m, d) = (cross(a, b), sub(b, a));
            rows.push(unit([m[0], m[1], m[2], d[0], d[1], d[2]]));
        }
    }
    let zero = T::of(0.0);
    let touches = |four: [usize; 4], line: Six<T>| {
        let ways = [line, line.map(|x| -x)];
        let others = || rows.iter().enumerate().filter(|(k, _)| !four.contains(k));
        ways.iter().any(|line| others().all(|(_, row)| side(line, row) >= zero))
    };
    let n = rows.len();
    let found = |four: [usize; 4]| lines(four.map(|k| rows[k])).into_iter().flatten().any(|line| touches(four, line));
    (0..n).any(|a| (a + 1..n).any(|b| (b + 1..n).any(|c| (c + 1..n).any(|d| found([a, b, c, d])))))
}

fn unit<T: Rooted>(x: Six<T>) -> Six<T> {
    let length = side(&x, &x).root();
    if length > T::of(0.0) { x.map(|c| c / length) } else { x }
}

/// The lines that touch four others: of the pencil of vectors at right angles to four rows those with `d · m = 0`.
fn lines<T: Rooted>(rows: [Six<T>; 4]) -> [Option<Six<T>>; 2] {
    let Some([f, g]) = pencil(rows) else { return [None; 2] };
    let dm = |x: &Six<T>, y: &Six<T>| x[0] * y[3] + x[1] * y[4] + x[2] * y[5];
    let (a, b, c) = (dm(&f, &f), dm(&f, &g) + dm(&g, &f), dm(&g, &g));
    let discriminant = b * b - T::of(4.0) * a * c;
    let zero = T::of(0.0);
    if discriminant < zero {
        return [None; 2];
    }
    let root = discriminant.root();
    let mix = |s: T, t: T| Some([0, 1, 2, 3, 4, 5].map(|k| s * f[k] + t * g[k]));
    let (size_a, size_c) = (if a < zero { -a } else { a }, if c < zero { -c } else { c });
    if size_a >= size_c {
        let twice = T::of(2.0) * a;
        [mix(-b + root, twice), mix(-b - root, twice)]
    } else {
        let twice = T::of(2.0) * c;
        [mix(twice, -b + root), mix(twice, -b - root)]
    }
}

/// Two vectors that four rows vanish on, by Gauss with full pivoting.
fn pencil<T: Rooted>(mut m: [Six<T>; 4]) -> Option<[Six<T>; 2]> {
    let zero = T::of(0.0);
    let size = |x: T| if x < zero { -x } else { x };
    let mut pivots = [0; 4];
    for k in 0..4 {
        let mut best = (zero, 0, 0);
        for (r, row) in m.iter().enumerate().skip(k) {
            for (c, &x) in row.iter().enumerate() {
                if size(x) > best.0 {
                    best = (size(x), r, c);
                }
            }
        }
        let (largest, row, column) = best;
        if largest <= zero {
            return None;
        }
        m.swap(k, row);
        pivots[k] = column;
        let pivot = m[k];
        for (_, row) in m.iter_mut().enumerate().filter(|(i, _)| *i != k) {
            let factor = row[column] / pivot[column];
            for (c, x) in row.iter_mut().enumerate() {
                *x = if c == column { zero } else { *x - factor * pivot[c] };
            }
        }
    }
    let mut free = (0..6).filter(|c| !pivots.contains(c));
    let mut vector = || {
        let column = free.next()?;
        let mut v = [zero; 6];
        v[column] = T::of(1.0);
        for (k, &p) in pivots.iter().enumerate() {
            v[p] = -(m[k][column] / m[k][p]);
        }
        Some(v)
    };
    Some([vector()?, vector()?])
}
