//! Three rooms in a row: how far, in steps of sight, each point is from all others, as digits on a grid.
//!
//! Run as `cargo run -p sightlines-visibility-graph --example rooms`.

use sightlines_cells::Plan;
use sightlines_geometry::Point2;
use sightlines_isovist::{Touch, WallMesh};
use sightlines_visibility_graph::{GlobalMeasures, PixelGrid, VisibilityGraph, WorkOptions};
use std::collections::BTreeMap;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let wall = |[ax, ay, bx, by]: [f64; 4]| (Point2::new(ax, ay), Point2::new(bx, by));
    let plan = Plan::from_walls(
        [
            [0.0, 0.0, 12.0, 0.0],
            [12.0, 0.0, 12.0, 6.0],
            [12.0, 6.0, 0.0, 6.0],
            [0.0, 6.0, 0.0, 0.0],
            [4.0, 0.0, 4.0, 2.0],
            [4.0, 3.0, 4.0, 6.0],
            [8.0, 0.0, 8.0, 4.0],
            [8.0, 5.0, 8.0, 6.0],
        ]
        .map(wall),
    )?;
    let points = PixelGrid::over(&plan, 0.3)?.enclosed()?;
    let mesh = WallMesh::new(&plan)?;
    let index = mesh.index(points.coordinates())?;
    let seen = |eye: u32, list: &mut Vec<u32>| mesh.points_seen(eye, &index, Touch::Blocks, list);
    let graph = VisibilityGraph::build(points.len() as u32, seen, &WorkOptions::default())?;
    let depth = GlobalMeasures::of(&graph, None, &WorkOptions::default())?.mean_depth;

    println!("{} points in {} runs; mean depth from 1 to 3, as tenths above 1:", points.len(), graph.n_runs());
    let mut rows: BTreeMap<i64, BTreeMap<i64, u32>> = BTreeMap::new();
    for (p, depth) in points.coordinates().iter().zip(&depth) {
        let [x, y] = [p.x, p.y].map(|x| (x / 0.3).round() as i64);
        rows.entry(-y).or_default().insert(x, ((depth - 1.0) * 10.0).round() as u32);
    }
    for row in rows.values() {
        let cells = (0..=40).map(|x| row.get(&x).map_or("   ".to_owned(), |depth| format!("{depth:3}")));
        println!("{}", cells.collect::<String>().trim_end());
    }
    Ok(())
}
