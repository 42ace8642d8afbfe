//! The picture of an explanation: in a plan, and in space from above and as an isometric view.

use crate::error::{ErrorAbout, Result};
use crate::picture::{draw_plan, middle, up_of};
use sightlines::bake::GraphKind;
use sightlines::bake::explain::{Answer, Explanation, Reason};
use sightlines::cells::PortalId;
use sightlines::geometry::Point2;
use sightlines::pvs::{CellId, Table};
use sightlines::report::{
    DrawOptions, Drawing, IsometricOptions, PictureSubject, SliceOptions, Up, isometric_drawing, slice_drawing,
};
use std::path::Path;

/// The size of each of the two views, in pixels.
const SIZE: u32 = 1000;

/// What A sees, B, and the line through the portals or what blocks it.
pub(super) fn svg(path: &Path, table: &Table, pair: [CellId; 2], explanation: &Explanation) -> Result<String> {
    match explanation.cells {
        GraphKind::Planar => draw_plan(path, table, &in_plan(pair, &explanation.answer)),
        _ => in_space(path, table, pair, explanation),
    }
}

/// The line through the portals, or the first blocked way.
fn in_plan([a, b]: [CellId; 2], answer: &Answer) -> DrawOptions<'static> {
    let (ends, portals) = match answer {
        Answer::Visible(line, _) => (line.ends, &line.portals[..]),
        Answer::Hidden(Reason::Blocked { blocked, .. }) => {
            (None, blocked.first().map_or(&[][..], |first| &first.way.portals))
        }
        _ => (None, &[][..]),
    };
    DrawOptions {
        view: PictureSubject::Cell(a),
        target: Some(b),
        marked_portals: portals.iter().map(|p| p.idx()).collect(),
        line: ends.map(|ends| ends.map(|[x, y, _]| Point2::new(x, y))),
        ..DrawOptions::default()
    }
}

/// The line through the portals or the walls that block all lines: from above at the height where the line begins, else of
/// the middle of A, and as an isometric view that is cut above all that is shown.
fn in_space(path: &Path, table: &Table, [a, b]: [CellId; 2], explanation: &Explanation) -> Result<String> {
    let up = up_of(table);
    let (line, portals): (_, &[PortalId]) = match &explanation.answer {
        Answer::Visible(line, _) => (line.ends, &line.portals),
        _ => (None, &[]),
    };
    let portals: Vec<usize> = portals.iter().map(|portal| portal.idx()).collect();
    let height = line.map_or(middle(table, a, up), |line| line[0][up.axis()]);
    let marked: Vec<Vec<[f64; 3]>> = match (line, &explanation.answer) {
        (Some(_), _) => portals.iter().map(|&portal| table.portals()[portal].points.clone()).collect(),
        (None, Answer::Hidden(Reason::Walls(found))) => {
            found.walls.iter().map(|wall| corners(wall.min, wall.max)).collect()
        }
        _ => Vec::new(),
    };
    let view = PictureSubject::Cell(a);
    let options = SliceOptions {
        view,
        up,
        height,
        line,
        target: Some(b),
        marked_portals: &portals,
        legend: false,
        size: SIZE,
        ..SliceOptions::default()
    };
    let above = slice_drawing(table, &options).in_file(path)?;
    let below = Some(highest(table, [a, b], line, up));
    let options = IsometricOptions {
        view,
        up,
        below,
        line,
        target: Some(b),
        marked: &marked,
        legend: false,
        size: SIZE,
        ..IsometricOptions::default()
    };
    let isometric = isometric_drawing(table, &options).in_file(path)?;
    let title = match (line, explanation.answer.verdict()) {
        (Some(_), _) => format!("Cell {} sees cell {} along this line", a.0, b.0),
        (None, Some(true)) => format!("Cell {} sees cell {}", a.0, b.0),
        (None, Some(false)) => format!("Cell {} does not see cell {}", a.0, b.0),
        (None, None) => format!("Whether cell {} sees cell {} is not decided", a.0, b.0),
    };
    let pictures =
        [(format!("from above, cut at height {height:.2}"), above), ("from the side and above".to_owned(), isometric)];
    Ok(Drawing::side_by_side(&title, &pictures))
}

/// The height above which nothing is shown: that of the line, or of the middles of both cells.
fn highest(table: &Table, cells: [CellId; 2], line: Option<[[f64; 3]; 2]>, up: Up) -> f64 {
    let heights = match line {
        Some(ends) => ends.map(|p| p[up.axis()]),
        None => cells.map(|cell| middle(table, cell, up)),
    };
    heights[0].max(heights[1])
}

/// The corners of a rectangle at right angles to an axis, in turn.
fn corners(min: [f64; 3], max: [f64; 3]) -> Vec<[f64; 3]> {
    let flat = (0..3).find(|&k| min[k] == max[k]).unwrap_or(0);
    let [u, v] = [(flat + 1) % 3, (flat + 2) % 3];
    let corner = |[high_u, high_v]: [bool; 2]| {
        let mut p = min;
        p[u] = if high_u { max[u] } else { min[u] };
        p[v] = if high_v { max[v] } else { min[v] };
        p
    };
    [[false, false], [true, false], [true, true], [false, true]].map(corner).to_vec()
}
