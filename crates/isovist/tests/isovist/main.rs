//! Tests of isovists and of sight between points.

mod fractions;
mod joints;
mod measures;
mod oracle;
mod regions;
mod seen;
mod space;

use proptest::prelude::*;
use sightlines_cells::Plan;
use sightlines_geometry::Point2;

/// Walls with ends on a small grid: (ax, ay, bx, by).
type Walls = Vec<[i64; 4]>;

fn walls(n: usize, size: i64) -> impl Strategy<Value = Walls> {
    let wall = prop::array::uniform4(0..size).prop_filter("walls have a length", |w| [w[0], w[1]] != [w[2], w[3]]);
    prop::collection::vec(wall, 1..n)
}

fn point(p: [i64; 2]) -> Point2 {
    Point2::new(p[0] as f64, p[1] as f64)
}

fn plan(walls: &Walls) -> Plan {
    Plan::from_walls(walls.iter().map(|w| (point([w[0], w[1]]), point([w[2], w[3]])))).unwrap()
}
