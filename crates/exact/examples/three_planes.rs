//! Where three planes meet, exactly: by Cramer's rule on integers, compared with doubles.

use sightlines_exact::{BigInt, BigRational, Grid, vector};

fn main() {
    // Planes a x + b y + c z = d. The third is nearly the sum of the first two.
    let normals = [[1.0, 2.0, 3.0], [0.1, 0.3, 0.7], [1.1, 2.3, 3.7]];
    let right = [6.0, 1.0, 7.0];
    let grid = Grid::of(normals.into_iter().flatten().chain(right)).expect("all are finite");
    let rows = normals.map(|n| grid.vector(n));
    let right = right.map(|d| grid.integer(d));
    let [u, v, w] = [0, 1, 2].map(|k| column(&rows, k));
    let determinant = vector::determinant(&u, &v, &w);
    println!("determinant: {determinant} · 2^{}", 3 * grid.exponent());
    let point =
        [vector::determinant(&right, &v, &w), vector::determinant(&u, &right, &w), vector::determinant(&u, &v, &right)]
            .map(|x| BigRational::new(x, determinant.clone()));
    println!("the planes meet at ({}, {}, {})", point[0], point[1], point[2]);
    for (row, d) in rows.iter().zip(&right) {
        let value = vector::dot(&row.clone().map(BigRational::from_integer), &point);
        assert_eq!(value, BigRational::from_integer(d.clone()), "the point is on every plane, exactly");
    }
    let [a, b, c] = normals;
    let cross = [b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]];
    println!("the determinant in doubles: {:e}", a[0] * cross[0] + a[1] * cross[1] + a[2] * cross[2]);
}

fn column(rows: &[[BigInt; 3]; 3], k: usize) -> [BigInt; 3] {
    rows.each_ref().map(|row| row[k].clone())
}
