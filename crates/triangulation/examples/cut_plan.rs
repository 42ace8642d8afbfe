//! Cuts a small plan with slanted walls, crossing walls and two groups; prints its cells and portals.
//!
//! Run as `cargo run -p sightlines-triangulation --example cut_plan`.

use sightlines_cells::{Plan, PlanError, PlanLine, Portal2};
use sightlines_geometry::Point2;
use sightlines_triangulation::{SubdivisionSummary, subdivide};

fn p(x: f64, y: f64) -> Point2 {
    Point2::new(x, y)
}

/// A hall (group 0) with two crossing walls in it, and a porch (group 1) behind a slanted front with a door.
fn plan() -> Result<Plan, PlanError> {
    // Walls that go counter-clockwise around what is on their left.
    let hall = |a, b| PlanLine { left: Some(0), ..PlanLine::wall(a, b) };
    let porch = |a, b| PlanLine { left: Some(1), ..PlanLine::wall(a, b) };
    let front = |a, b, opaque| PlanLine { a, b, opaque, left: Some(0), right: Some(1) };
    let lines = vec![
        hall(p(0., 0.), p(12., 0.)),
        front(p(12., 0.), p(11., 3.), true),
        front(p(11., 3.), p(10., 6.), false),
        front(p(10., 6.), p(9., 9.), true),
        hall(p(9., 9.), p(0., 9.)),
        hall(p(0., 9.), p(0., 0.)),
        porch(p(12., 0.), p(16., 4.)),
        porch(p(16., 4.), p(9., 9.)),
        PlanLine::wall(p(3., 3.), p(6., 6.)),
        PlanLine::wall(p(3., 6.), p(5., 3.)),
    ];
    Plan::new(lines, Vec::new())
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let plan = plan()?;
    let (graph, SubdivisionSummary { n_triangles, n_rounded_crossings, .. }) = subdivide(&plan)?;
    println!(
        "{} lines; {n_triangles} triangles merged into {} cells; {n_rounded_crossings} crossings rounded",
        plan.lines().len(),
        graph.n_cells()
    );
    for id in graph.cell_ids() {
        let cell = graph.cell(id);
        let corners: Vec<String> = cell.polygon.iter().map(ToString::to_string).collect();
        println!("cell {id}, groups {:?}: {}", cell.groups, corners.join(" "));
    }
    for (number, portal) in graph.portals().iter().enumerate() {
        let ([from, to], Portal2 { left, right }) = (portal.cells, portal.shape);
        println!("portal {number} from cell {from} into cell {to}: {left} on the left, {right} on the right");
    }
    Ok(())
}
