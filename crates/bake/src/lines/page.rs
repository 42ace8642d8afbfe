//! Lines as a page carries them.

use super::{Lines, Obstacle, SightLine};
use sightlines_cells::{CellId, PortalId};
use sightlines_viewer as viewer;

fn cells(list: &[CellId]) -> Vec<u32> {
    list.iter().map(|id| id.0).collect()
}

fn portals(list: &[PortalId]) -> Vec<u32> {
    list.iter().map(|id| id.0).collect()
}

fn line(line: &SightLine) -> viewer::Line {
    viewer::Line { cells: cells(&line.cells), portals: portals(&line.portals), ends: line.ends }
}

fn obstacle(obstacle: &Obstacle) -> viewer::Obstacle {
    match obstacle {
        Obstacle::NotConnected => viewer::Obstacle::NotConnected,
        Obstacle::Portals(list) => viewer::Obstacle::Portals(portals(list)),
        Obstacle::Walls(walls) => viewer::Obstacle::Walls(walls.iter().map(|wall| [wall.min, wall.max]).collect()),
    }
}

impl From<Lines> for viewer::Reasons {
    fn from(found: Lines) -> Self {
        Self {
            lines: found.lines.iter().map(line).collect(),
            hidden: found.hidden.iter().map(|pair| (pair.cells.map(|id| id.0), obstacle(&pair.obstacle))).collect(),
            n_pairs: found.n_pairs,
            n_joined: found.n_joined,
        }
    }
}
