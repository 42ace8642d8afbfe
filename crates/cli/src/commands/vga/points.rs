//! Which points there are.

use super::error::Error;
use crate::error::InputError;
use sightlines::cells::Plan;
use sightlines::geometry::Point2;
use sightlines::visibility_graph::{Grid, GridError, Points};
use std::path::Path;

/// The points of a grid over a plan: those that seeds reach or, without seeds, all that are enclosed; and the grid's columns and rows.
pub(super) fn of_grid(path: &Path, plan: &Plan, spacing: f64, seeds: &[Point2]) -> Result<(Points, [usize; 2]), Error> {
    let failed = |source: GridError| Error::Grid { path: path.to_owned(), source };
    let grid = Grid::over(plan, spacing).map_err(failed)?;
    let points = if seeds.is_empty() { grid.enclosed() } else { grid.fill(seeds) };
    Ok((points.map_err(failed)?, grid.size()))
}

/// The points of a file: a line for each, of which the first two columns count. A first line that is no point is a header.
pub(super) fn of_file(path: &Path) -> Result<Points, Error> {
    let text = std::fs::read_to_string(path).map_err(|source| InputError::Open { path: path.to_owned(), source })?;
    let mut all = Vec::new();
    for (k, line) in text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty()) {
        match point(line) {
            Some(point) => all.push(point),
            None if k == 0 => {}
            None => {
                let text = line.chars().take(60).collect();
                return Err(Error::Line { path: path.to_owned(), line: k + 1, text });
            }
        }
    }
    if all.is_empty() {
        return Err(Error::NoPoints(path.to_owned()));
    }
    Points::new(all).map_err(|source| Error::Points { path: path.to_owned(), source })
}

fn point(line: &str) -> Option<Point2> {
    let mut cells = line.split([',', ';', '\t']).map(|cell| cell.trim().parse::<f64>().ok());
    Some(Point2::new(cells.next()??, cells.next()??))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_the_first_two_columns() {
        assert_eq!(point("1.5, -2"), Some(Point2::new(1.5, -2.0)));
        assert_eq!(point("1e3\t0\tname"), Some(Point2::new(1000.0, 0.0)));
        for bad in ["", "1", "x,y", "1,", "1 2"] {
            assert_eq!(point(bad), None, "{bad:?}");
        }
    }
}
