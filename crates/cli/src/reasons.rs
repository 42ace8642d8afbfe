//! Why cells see each other, as a page carries it.

use crate::progress::Bar;
use sightlines::bake::lines::{LineOptions, Lines, Obstacle, lines};
use sightlines::cells::{CellId, PortalId};
use sightlines::pvs::Table;
use sightlines::viewer::{self, Reasons};

/// Looks for at most `max_lines` lines, and for the reasons of half as many hidden pairs. None for a table without portals, and for none.
pub(crate) fn reasons(table: &Table, max_lines: usize, show_progress: bool) -> Option<Reasons> {
    if max_lines == 0 {
        return None;
    }
    let bar = Bar::new("lines", show_progress);
    // The bar cancels nothing.
    let found = lines(table, LineOptions { max_lines, max_hidden: max_lines.div_ceil(2) }, Some(&bar)).ok().flatten();
    bar.finish();
    found.map(of_page)
}

fn of_page(found: Lines) -> Reasons {
    let cells = |list: &[CellId]| list.iter().map(|id| id.0).collect();
    let portals = |list: &[PortalId]| list.iter().map(|id| id.0).collect();
    let line = |line: &sightlines::bake::lines::SightLine| viewer::Line {
        cells: cells(&line.cells),
        portals: portals(&line.portals),
        ends: line.ends,
    };
    let obstacle = |obstacle: &Obstacle| match obstacle {
        Obstacle::NotConnected => viewer::Obstacle::NotConnected,
        Obstacle::Portals(list) => viewer::Obstacle::Portals(portals(list)),
        Obstacle::Walls(walls) => viewer::Obstacle::Walls(walls.iter().map(|wall| [wall.min, wall.max]).collect()),
    };
    Reasons {
        lines: found.lines.iter().map(line).collect(),
        hidden: found.hidden.iter().map(|pair| (pair.cells.map(|id| id.0), obstacle(&pair.obstacle))).collect(),
        n_pairs: found.n_pairs,
        n_joined: found.n_joined,
    }
}
