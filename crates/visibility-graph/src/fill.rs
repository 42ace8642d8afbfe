//! Which pixels of a grid are reached by steps between neighbours.

use crate::grid::{Grid, Pixel};
use sightlines_geometry::Segment2;

/// The pixels that are reached from some, as a list for all pixels.
pub(crate) fn from_seeds(grid: &Grid, seeds: &[Pixel]) -> Vec<bool> {
    let [n_columns, n_rows] = grid.size();
    let mut filled = vec![false; n_columns * n_rows];
    let mut next = Vec::new();
    for &seed in seeds {
        if !std::mem::replace(&mut filled[grid.index(seed)], true) {
            next.push(seed);
        }
    }
    while let Some(pixel) = next.pop() {
        for neighbour in neighbours(grid, pixel) {
            let at = grid.index(neighbour);
            if !filled[at] && is_step(grid, pixel, neighbour) {
                filled[at] = true;
                next.push(neighbour);
            }
        }
    }
    filled
}

/// The pixels that are not reached from outside the grid and have their centre on no wall.
pub(crate) fn enclosed(grid: &Grid) -> Vec<bool> {
    let [n_columns, n_rows] = grid.size();
    // A ring of pixels around the grid lies outside all walls: its steps are free, and so are steps to it up to the walls of the pixel.
    let is_entered = |pixel: Pixel| {
        let around = |at: u32| [-1.0, 0.0, 1.0].map(|by| f64::from(at) + by);
        let is_outside = |k: f64, n: usize| k < 0.0 || k >= n as f64;
        around(pixel.column).into_iter().flat_map(|column| around(pixel.row).map(|row| [column, row])).any(|place| {
            (is_outside(place[0], n_columns) || is_outside(place[1], n_rows)) && {
                let step = Segment2::new(grid.centre_of(place), grid.centre(pixel));
                !grid.walls_of(pixel).any(|wall| wall.meets(&step))
            }
        })
    };
    let at_border =
        |p: &Pixel| p.column == 0 || p.row == 0 || p.column as usize + 1 == n_columns || p.row as usize + 1 == n_rows;
    let border = (0..n_columns * n_rows).map(|k| grid.pixel(k)).filter(at_border);
    let seeds: Vec<Pixel> = border.filter(|&pixel| is_entered(pixel)).collect();
    let mut filled = from_seeds(grid, &seeds);
    for (k, is_filled) in filled.iter_mut().enumerate() {
        let pixel = grid.pixel(k);
        let centre = grid.centre(pixel);
        *is_filled = !*is_filled && !grid.walls_of(pixel).any(|wall| wall.contains(centre));
    }
    filled
}

/// Whether no wall lies on the way between the centres of neighbours.
fn is_step(grid: &Grid, from: Pixel, to: Pixel) -> bool {
    let step = Segment2::new(grid.centre(from), grid.centre(to));
    !grid.walls_of(from).chain(grid.walls_of(to)).any(|wall| wall.meets(&step))
}

/// The up to eight pixels around one.
fn neighbours(grid: &Grid, pixel: Pixel) -> impl Iterator<Item = Pixel> {
    let around = |at: u32, n: usize| at.saturating_sub(1)..=(at + 1).min(n as u32 - 1);
    let [n_columns, n_rows] = grid.size();
    around(pixel.column, n_columns)
        .flat_map(move |column| around(pixel.row, n_rows).map(move |row| Pixel { column, row }))
        .filter(move |&other| other != pixel)
}
