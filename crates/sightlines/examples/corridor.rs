//! Bakes a corridor with three rooms along it and prints which room sees which.
//!
//! Run as `cargo run -p sightlines --example corridor`.

use sightlines::bake::{PlanBakeOptions, bake_plan};
use sightlines::cells::Plan;
use sightlines::geometry::Point2;
use sightlines::pvs::Place;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // Rooms of 4 by 4 above a corridor of 12 by 2; each has a door of width 1 in the middle of its wall.
    let mut walls = vec![([0., 0.], [12., 0.]), ([12., 0.], [12., 6.]), ([12., 6.], [0., 6.]), ([0., 6.], [0., 0.])];
    for x in [0., 4., 8.] {
        walls.extend([([x, 2.], [x + 1.5, 2.]), ([x + 2.5, 2.], [x + 4., 2.])]);
    }
    walls.extend([([4., 2.], [4., 6.]), ([8., 2.], [8., 6.])]);
    let plan = Plan::from_walls(walls.into_iter().map(|(a, b)| (Point2::from(a), Point2::from(b))))?;
    let baked = bake_plan(&plan, &PlanBakeOptions::default())?;
    println!("{} cells, {} portals", baked.report.n_cells, baked.report.n_portals);
    let places =
        [("left room", [2., 5.]), ("middle room", [6., 5.]), ("right room", [10., 5.]), ("corridor", [6., 1.])];
    let query = baked.table.in_dimension::<2>()?;
    for (name, at) in places {
        let Place::Inside(here) = query.at(at) else { continue };
        let shows = |p: [f64; 2]| query.at(p).cells().iter().any(|&cell| here.sees(cell));
        let names: Vec<&str> = places.iter().filter(|&&(_, p)| shows(p)).map(|&(n, _)| n).collect();
        println!("from the {name}: {}", names.join(", "));
    }
    Ok(())
}
