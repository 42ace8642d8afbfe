//! A street of houses, each turned by another angle: which of them can be seen from its end?

use sightlines_geometry::{Aabb, Point3};
use sightlines_line_space::{LineSpace, Outcome};

/// The sides of a house of 8 by 8, 6 high, turned about its middle.
fn house(middle: Point3, angle: f64) -> Vec<[Point3; 3]> {
    let (sin, cos) = angle.sin_cos();
    let corner = |i: usize| {
        let [x, y] = [[-4., 4.][i & 1], [-4., 4.][i >> 1 & 1]];
        [middle[0] + cos * x - sin * y, middle[1] + sin * x + cos * y, [0., 6.][i >> 2]]
    };
    let sides = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).map(|t| t.map(corner)).collect()
}

fn main() {
    // Three rows of four; eyes are in the street in front of the first one.
    let houses: Vec<Vec<[Point3; 3]>> =
        (0..12).map(|i| house([f64::from(i % 4) * 9.0, f64::from(i / 4) * 14.0, 0.0], f64::from(i) * 0.05)).collect();
    let eyes = Aabb { min: [0.0, -9.0, 1.0], max: [27.0, -7.0, 2.0] };
    let mut lines = LineSpace::new(&houses.concat());
    let seen: Vec<bool> = houses
        .iter()
        .map(|house| house.iter().any(|t| lines.see_triangle(&eyes, *t, 2000) != Outcome::Hidden))
        .collect();
    println!("seen: {seen:?}, after {} cells of line space", lines.n_cells());
    assert!(seen[..4].iter().all(|s| *s), "the first row is in plain sight");
}
