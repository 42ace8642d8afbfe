//! Cuts a small office floor at several thresholds, then locates a point.

use sightlines_cells::{Plan, PlanError};
use sightlines_geometry::Point2;
use sightlines_kdtree::{KdError, KdOptions, PlanSubdivision, subdivide_plan};

/// Six rooms on each side of a corridor, each with a door of width 1 and a desk.
fn office() -> Result<Plan, PlanError> {
    let mut walls = Vec::new();
    let mut wall = |x0: f64, y0: f64, x1: f64, y1: f64| walls.push((Point2::new(x0, y0), Point2::new(x1, y1)));
    wall(0.0, 0.0, 48.0, 0.0);
    wall(0.0, 18.0, 48.0, 18.0);
    for x in (0..=6).map(|i| f64::from(i) * 8.0) {
        wall(x, 0.0, x, 8.0);
        wall(x, 10.0, x, 18.0);
    }
    for x in (0..6).map(|i| f64::from(i) * 8.0) {
        for (corridor, desk) in [(8.0, 3.0), (10.0, 14.0)] {
            wall(x, corridor, x + 3.0, corridor);
            wall(x + 4.0, corridor, x + 8.0, corridor);
            wall(x + 2.0, desk, x + 5.0, desk);
        }
    }
    Plan::from_walls(walls)
}

fn print_row(tau: f64, PlanSubdivision { tree, .. }: &PlanSubdivision) {
    let (cells, portals) = (tree.cells().len(), tree.portals().len());
    println!("{tau:>9.1} {cells:>6} {portals:>8} {:>7}", tree.n_detail());
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let plan = office()?;
    println!("{} walls\nthreshold  cells  portals  detail", plan.lines().len());
    for tau in [0.0, 0.2, 0.4, 0.6, 0.8, 1.0] {
        print_row(tau, &subdivide_plan(&plan, &KdOptions { tau, ..KdOptions::default() })?);
    }
    let rooms: Result<PlanSubdivision, KdError> = subdivide_plan(&plan, &KdOptions::default());
    let PlanSubdivision { tree, graph, .. } = rooms?;
    let viewer = [20.0, 9.0];
    let cell = tree.locate(viewer).ok_or("the viewer is outside")?;
    let bounds = tree.cells()[cell.idx()].bounds;
    println!("at {viewer:?}: cell {cell}, from {:?} to {:?}, ways out:", bounds.min, bounds.max);
    for exit in graph.exits(cell) {
        let door = graph.crossing(exit);
        println!("  to cell {:>2} between {} and {}", exit.to.0, door.left, door.right);
    }
    Ok(())
}
