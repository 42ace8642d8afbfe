//! Points where three planes meet.

use crate::plane::{PlaneId, Planes};
use sightlines_exact::Dyadic;
use sightlines_geometry::Point3;
use std::cell::OnceCell;

/// The error of a determinant of three rows, in multiples of the sum of the absolute values of its six products: two products
/// and a difference, a product and two sums are six roundings at most, of 2^-53 each.
const MINOR_ERROR: f64 = 8.0 * f64::EPSILON / 2.0;
/// The error of four products with such determinants and their sum: what they carry, and four roundings.
const SIDE_ERROR: f64 = 16.0 * f64::EPSILON / 2.0;

/// The point of three planes that have one in common, in homogeneous coordinates: `x[k] / x[3]`.
#[derive(Debug)]
pub(crate) struct Corner {
    planes: [PlaneId; 3],
    /// Rounded, and so that `x[3]` is positive.
    x: [f64; 4],
    /// The sums of the absolute values of the products that each of them is made of.
    sizes: [f64; 4],
    /// Whether signs are turned so that `x[3]` is positive.
    is_turned: bool,
    exact: OnceCell<[Dyadic; 4]>,
}

impl Corner {
    /// The point of three planes, unless two of them are parallel or all three have a direction in common.
    pub(crate) fn of(planes: [PlaneId; 3], rows: &Planes) -> Option<Self> {
        let [a, b, c] = planes.map(|plane| rows.row(plane));
        let (mut x, mut sizes) = ([0.0; 4], [0.0; 4]);
        for k in 0..4 {
            (x[k], sizes[k]) = minor(&columns(a, k), &columns(b, k), &columns(c, k));
        }
        let mut corner = Self { planes, x, sizes, is_turned: false, exact: OnceCell::new() };
        let sign = match x[3].abs() > sizes[3] * MINOR_ERROR {
            true => {
                if x[3] > 0.0 {
                    1
                } else {
                    -1
                }
            }
            false => corner.exact(rows)[3].sign(),
        };
        if sign < 0 {
            corner.is_turned = true;
            corner.x = x.map(|k| -k);
            corner.exact = OnceCell::new();
        }
        (sign != 0).then_some(corner)
    }

    /// On which side of a plane it lies: 1 in front, 0 on it, -1 behind. Exact.
    pub(crate) fn side(&self, plane: PlaneId, rows: &Planes) -> i32 {
        if self.planes.contains(&plane) {
            return 0;
        }
        let row = rows.row(plane);
        let products = [row[0] * self.x[0], row[1] * self.x[1], row[2] * self.x[2], row[3] * self.x[3]];
        let height = products[0] + products[1] + products[2] - products[3];
        let size: f64 = (0..4).map(|k| row[k].abs() * self.sizes[k]).sum();
        if height.abs() > size * SIDE_ERROR {
            return if height > 0.0 { 1 } else { -1 };
        }
        let exact = self.exact(rows);
        let product = |k: usize| &Dyadic::new(row[k]) * &exact[k];
        (&(&(&product(0) + &product(1)) + &product(2)) - &product(3)).sign()
    }

    /// The homogeneous coordinates.
    fn exact(&self, rows: &Planes) -> &[Dyadic; 4] {
        self.exact.get_or_init(|| {
            let rows = self.planes.map(|plane| rows.row(plane));
            let of_column = |k: usize| {
                let [a, b, c] = [0, 1, 2].map(|i| Dyadic::vector(columns(rows[i], k)));
                let x = sightlines_exact::vector::determinant(&a, &b, &c);
                if self.is_turned { -x } else { x }
            };
            [0, 1, 2, 3].map(of_column)
        })
    }

    /// The point as doubles, each off by at most 2^-50 of itself, and whether they are exactly that point.
    pub(crate) fn rounded(&self, rows: &Planes) -> (Point3, bool) {
        let exact = self.exact(rows);
        let weight = exact[3].to_f64();
        let point = [0, 1, 2].map(|k| exact[k].to_f64() / weight);
        let is_same = |k: usize| (&(&Dyadic::new(point[k]) * &exact[3]) - &exact[k]).sign() == 0;
        (point, (0..3).all(is_same))
    }
}

/// The three numbers of a row of which coordinate `k` is a determinant (Cramer): the distance in the place of the `k`-th, or
/// the normal for the weight.
fn columns(row: &[f64; 4], k: usize) -> [f64; 3] {
    let mut columns = [row[0], row[1], row[2]];
    if let Some(column) = columns.get_mut(k) {
        *column = row[3];
    }
    columns
}

/// The determinant of three rows, and the sum of the absolute values of its products.
fn minor(a: &[f64; 3], b: &[f64; 3], c: &[f64; 3]) -> (f64, f64) {
    let (mut value, mut size) = (0.0, 0.0);
    for (k, i, j) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
        let (p, q) = (b[i] * c[j], b[j] * c[i]);
        value += a[k] * (p - q);
        size += a[k].abs() * (p.abs() + q.abs());
    }
    (value, size)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Plane;
    use proptest::prelude::*;

    fn corner_of(rows: &mut Planes, planes: [[f64; 4]; 3]) -> Option<Corner> {
        let ids = planes.map(|[x, y, z, distance]| rows.add(Plane { normal: [x, y, z], distance }).id);
        Corner::of(ids, rows)
    }

    #[test]
    fn planes_without_one_point_have_no_corner() {
        let mut rows = Planes::default();
        let (x, y, z) = ([1.0, 0.0, 0.0, 1.0], [0.0, 1.0, 0.0, 2.0], [0.0, 0.0, 1.0, 3.0]);
        let corner = corner_of(&mut rows, [x, y, z]).unwrap();
        assert_eq!(corner.rounded(&rows), ([1.0, 2.0, 3.0], true));
        assert!(corner_of(&mut rows, [x, y, [3.0, 4.0, 0.0, 7.0]]).is_none(), "all along z");
        assert!(corner_of(&mut rows, [x, [1.0, 0.0, 0.0, 1.5], z]).is_none(), "parallel");
        let third = corner_of(&mut rows, [x, y, [0.0, 0.0, 3.0, 1.0]]).unwrap();
        let ([_, _, third], is_exact) = third.rounded(&rows);
        assert!(!is_exact && (third - 1.0 / 3.0).abs() < 1e-16);
    }

    /// Four planes through one point, and the last moved by one unit in the last place.
    #[test]
    fn sides_are_exact_where_doubles_are_not() {
        let mut rows = Planes::default();
        let corner =
            corner_of(&mut rows, [[0.6, 0.8, 0.0, 0.7], [0.1, 0.3, 1.0, 0.9], [0.3, -0.2, 0.1, 0.35]]).unwrap();
        let mut n_exact = 0;
        // Sums of the rows go through their point; in doubles their numbers are rounded, so most do not quite.
        for (k, [p, q, r]) in [[1.0, 2.0, 4.0], [0.5, 8.0, -1.0], [3.0, 1.0, 5.0]].into_iter().enumerate() {
            let at = |j: usize| {
                let [a, b, c] = corner.planes.map(|id| rows.row(id)[j]);
                p * a + q * b + r * c
            };
            let row = [0, 1, 2, 3].map(at);
            let id = rows.add(Plane { normal: [row[0], row[1], row[2]], distance: row[3] });
            let side = corner.side(id.id, &rows);
            let exact = corner.exact(&rows);
            let sum = (0..3).map(|j| &Dyadic::new(rows.row(id.id)[j]) * &exact[j]).reduce(|s, t| &s + &t).unwrap();
            let truth = (&sum - &(&Dyadic::new(rows.row(id.id)[3]) * &exact[3])).sign();
            assert_eq!(side, truth, "sum {k}");
            n_exact += usize::from(side == 0);
        }
        assert!(n_exact < 3, "rounded sums miss the point");
    }

    proptest! {
        /// Against the signs of rationals, on planes of small integers, where many pass through a corner.
        #[test]
        fn sides_equal_those_of_integers(rows in proptest::collection::vec((-3i64..=3, -3i64..=3, -3i64..=3, -9i64..=9), 4)) {
            prop_assume!(rows.iter().all(|r| (r.0, r.1, r.2) != (0, 0, 0)));
            let mut planes = Planes::default();
            let ids: Vec<_> = rows
                .iter()
                .map(|r| planes.add(Plane { normal: [r.0 as f64, r.1 as f64, r.2 as f64], distance: r.3 as f64 }))
                .collect();
            let det = |m: [[i64; 3]; 3]| {
                m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0])
                    + m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0])
            };
            let column = |r: &(i64, i64, i64, i64), k: usize| {
                let mut c = [r.0, r.1, r.2];
                if k < 3 {
                    c[k] = r.3;
                }
                c
            };
            let x = [0, 1, 2, 3].map(|k| det([column(&rows[0], k), column(&rows[1], k), column(&rows[2], k)]));
            let corner = Corner::of([ids[0].id, ids[1].id, ids[2].id], &planes);
            prop_assert_eq!(corner.is_some(), x[3] != 0);
            if let Some(corner) = corner {
                let r = rows[3];
                let height = (r.0 * x[0] + r.1 * x[1] + r.2 * x[2] - r.3 * x[3]) * x[3].signum();
                let sign = corner.side(ids[3].id, &planes) * if ids[3].is_flipped { -1 } else { 1 };
                prop_assert_eq!(i64::from(sign), height.signum());
            }
        }
    }
}
