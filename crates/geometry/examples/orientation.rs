//! Draws on which side of a diagonal the doubles around (0.5, 0.5) lie: by the plain formula, and exactly.
//!
//! Run as `cargo run -p sightlines-geometry --example orientation`.

use sightlines_geometry::{Point2, orient2d};

/// Points to each side of the middle, in both directions.
const REACH: i32 = 9;

/// The determinant in doubles, as it stands in textbooks.
fn plain(a: Point2, b: Point2, c: Point2) -> f64 {
    (a.x - c.x) * (b.y - c.y) - (a.y - c.y) * (b.x - c.x)
}

/// `+` for left of the line, `-` for right, `0` for on it.
fn sign(side: f64) -> char {
    if side > 0.0 {
        '+'
    } else if side < 0.0 {
        '-'
    } else {
        '0'
    }
}

fn main() {
    let [a, b] = [Point2::new(12.0, 12.0), Point2::new(24.0, 24.0)];
    println!("points in steps of {:e} around (0.5, 0.5), the line from {a} to {b}", f64::EPSILON);
    println!("{:<25}exact", "plain doubles");
    let (mut n_wrong, mut n_points) = (0, 0);
    // From the top row down, so that + is above the diagonal.
    for row in (-REACH..=REACH).rev() {
        let points = (-REACH..=REACH).map(|column| {
            let [x, y] = [column, row].map(|steps| 0.5 + f64::from(steps) * f64::EPSILON);
            Point2::new(x, y)
        });
        let signs = points.map(|c| [plain(a, b, c), orient2d(a, b, c)].map(sign));
        let (rounded, exact): (String, String) = signs.map(|[rounded, exact]| (rounded, exact)).unzip();
        println!("{rounded:<25}{exact}");
        n_wrong += rounded.chars().zip(exact.chars()).filter(|(rounded, exact)| rounded != exact).count();
        n_points += exact.len();
    }
    println!("plain doubles are wrong about {n_wrong} of {n_points} points");
}
