//! What benches share: portal sequences as a search meets them, bakes in processes of their own, rays against
//! tables, a z-buffer, methods on Quake maps, scenes with boxes for eyes, rows of files, charts, what things take.

pub mod bits;
pub mod chart;
pub mod child;
pub mod codings;
pub mod front;
pub mod measure;
pub mod path;
pub mod program;
pub mod quake;
pub mod raster;
pub mod recorded;
pub mod shares;
pub mod spec;
pub mod targets;
pub mod viewed;
pub mod walkers;
pub mod witness;

use sightlines::cells::{CellGraph, Exit, Plan, Planar};
use sightlines::geometry::{Adaptive, Portal2};
use sightlines::sightline::Funnel;

/// A graph by triangulation.
///
/// # Panics
/// If the plan has no region.
pub fn graph(plan: &Plan) -> CellGraph<Planar> {
    sightlines::triangulation::subdivide(plan).expect("a generated plan has regions").0
}

/// Sequences of at least `min` portals that a depth-first search pushes, with the last one blocked or
/// the search at its depth limit: `count` of them, from cells spread over the graph.
pub fn corridors(graph: &CellGraph<Planar>, min: usize, count: usize) -> Vec<Vec<Portal2>> {
    let mut found = Vec::new();
    let stride = (graph.n_cells() / 64).max(1);
    for cell in graph.cell_ids().step_by(stride) {
        for exit in graph.exits(cell) {
            let mut funnel = Funnel::new(Adaptive);
            funnel.start(graph.crossing(exit));
            deeper(graph, exit, &mut funnel, &mut vec![graph.crossing(exit)], min, &mut found);
            if found.len() >= count {
                found.truncate(count);
                return found;
            }
        }
    }
    found
}

fn deeper(
    graph: &CellGraph<Planar>,
    at: &Exit,
    funnel: &mut Funnel<Adaptive>,
    doors: &mut Vec<Portal2>,
    min: usize,
    found: &mut Vec<Vec<Portal2>>,
) {
    const MAX_DEPTH: usize = 24;
    const PER_EXIT: usize = 40;
    let limit = found.len() + PER_EXIT;
    for exit in graph.exits(at.to).iter().filter(|e| e.side != at.entry_side) {
        let door = graph.crossing(exit);
        doors.push(door);
        match funnel.push(door) {
            Some(undo) if doors.len() < MAX_DEPTH => {
                deeper(graph, exit, funnel, doors, min, found);
                funnel.undo(undo);
            }
            Some(undo) => {
                found.push(doors.clone());
                funnel.undo(undo);
            }
            None if doors.len() >= min => found.push(doors.clone()),
            None => {}
        }
        doors.pop();
        if found.len() >= limit {
            return;
        }
    }
}
