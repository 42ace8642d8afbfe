//! Builds two rooms and a door by hand, walks through the door, and has a door in the wrong place refused.
//!
//! Run as `cargo run -p sightlines-cells --example two_rooms`.

use sightlines_cells::{CellGraph, CellId, ConvexCell2, Planar, Portal, Portal2, WellFormedError};
use sightlines_geometry::Point2;

/// A room of 4 by 3 with its lower left corner at (`x`, 0). Its sides are numbered from 0: below, right,
/// above, left.
fn room(x: f64, group: u32) -> ConvexCell2 {
    let corners = [(x, 0.0), (x + 4.0, 0.0), (x + 4.0, 3.0), (x, 3.0)];
    ConvexCell2 { polygon: corners.map(|(x, y)| Point2::new(x, y)).to_vec(), groups: vec![group] }
}

/// A door on the line at `x`, from y = 1 to y = 2: from the right side of room 0 to the left side of room 1.
fn door(x: f64) -> Portal<Planar> {
    let shape = Portal2 { left: Point2::new(x, 2.0), right: Point2::new(x, 1.0) };
    Portal { cells: [CellId(0), CellId(1)], sides: [1, 3], shape }
}

fn rooms(door_at: f64) -> CellGraph<Planar> {
    CellGraph::new(vec![room(0.0, 7), room(4.0, 8)], vec![door(door_at)])
}

fn main() -> Result<(), WellFormedError> {
    let graph = rooms(4.0);
    graph.check_well_formed()?;
    for id in graph.cell_ids() {
        let (cell, bounds) = (graph.cell(id), graph.cell(id).bounds());
        println!("cell {id} of groups {:?}, from {:?} to {:?}", cell.groups, bounds.min, bounds.max);
        for exit in graph.exits(id) {
            let Portal2 { left, right } = graph.crossing(exit);
            println!("  by side {} into cell {}: {left} on the left, {right} on the right", exit.side, exit.to);
        }
    }
    match rooms(5.0).check_well_formed() {
        Ok(()) => println!("a door at x = 5 was accepted"),
        Err(error) => println!("a door at x = 5 is refused: {error}"),
    }
    Ok(())
}
