//! Which pixels of a grid are reached by steps between neighbours.

use crate::GridError;
use crate::grid::{Pixel, PixelGrid};
use crate::points::Points;
use sightlines_geometry::{Point2, Segment2};

impl PixelGrid {
    /// The points that are reached from seeds, by steps to any of the eight neighbours of a pixel along which no wall lies: the segment
    /// between the two centres and no wall have a point in common. Up the columns, from left to right.
    ///
    /// # Errors
    /// [`GridError::SeedOutside`], [`GridError::SeedBlocked`].
    ///
    /// # Cost
    /// O(pixels reached · walls that touch a pixel).
    ///
    /// # Source
    /// The steps and the test of seeds are those of depthmapX, `PointMap::makePoints` and `expand` in salalib/pointdata.cpp; decisions
    /// are exact here, and within 1e-10 of a spacing there. A wall that touches the way from the seed to its centre blocks it here.
    pub fn fill(&self, seeds: &[Point2]) -> Result<Points, GridError> {
        let pixel = |&seed: &Point2| {
            let Point2 { x, y } = seed;
            let pixel = self.pixel_at(seed).ok_or(GridError::SeedOutside { x, y })?;
            let centre = self.centre(pixel);
            let way = Segment2::new(seed, centre);
            if self.walls_of(pixel).any(|wall| wall.meets(&way)) {
                return Err(GridError::SeedBlocked { x, y, to_x: centre.x, to_y: centre.y });
            }
            Ok(pixel)
        };
        let seeds: Vec<Pixel> = seeds.iter().map(pixel).collect::<Result<_, _>>()?;
        Ok(self.points(&from_seeds(self, &seeds)))
    }

    /// The points that are enclosed: those that steps as in [`fill`](Self::fill) do not reach from outside the grid and whose centre lies
    /// on no wall. The insides of pillars and of thick walls are enclosed, too; name a seed where they are not wanted.
    ///
    /// # Errors
    /// [`GridError::NothingEnclosed`]
    ///
    /// # Cost
    /// That of [`fill`](Self::fill) for all pixels.
    pub fn enclosed(&self) -> Result<Points, GridError> {
        let filled = enclosed(self);
        if filled.contains(&true) { Ok(self.points(&filled)) } else { Err(GridError::NothingEnclosed) }
    }
}

/// The points inside a building, found without a seed.
#[derive(Debug, Clone, PartialEq)]
pub struct InteriorPoints {
    /// The points, up the columns, from left to right.
    pub points: Points,
    /// Whether walls enclose them. If not, such as where an outer door stands open, they are those around which walls stand.
    pub is_enclosed: bool,
}

impl PixelGrid {
    /// The points inside, for a plan whose interior nobody points out: all that are [enclosed](Self::enclosed), or, where what the walls
    /// enclose is not the largest part of what they surround, that part.
    ///
    /// A pixel is surrounded if walls lie in at least seven of its eight directions, and a part is what steps between surrounded pixels
    /// reach. So the rooms of a building with an open outer door are found, and not the insides of its walls. Of parts that are
    /// equally large the first counts.
    ///
    /// # Errors
    /// [`GridError::NothingEnclosed`] if no pixel is surrounded.
    ///
    /// # Cost
    /// O(pixels · walls that touch a pixel).
    pub fn interior(&self) -> Result<InteriorPoints, GridError> {
        let (enclosed, surrounded) = (enclosed(self), surrounded(self));
        let largest = largest_part(self, &surrounded).ok_or(GridError::NothingEnclosed)?;
        let is_enclosed = largest.iter().zip(&enclosed).all(|(is_inside, is_enclosed)| !is_inside || *is_enclosed);
        Ok(InteriorPoints { points: self.points(if is_enclosed { &enclosed } else { &largest }), is_enclosed })
    }
}

/// The pixels that have walls in at least seven of eight directions, and their centre on no wall.
fn surrounded(grid: &PixelGrid) -> Vec<bool> {
    let [n_columns, n_rows] = grid.size();
    let mut n_blocked = vec![0u8; n_columns * n_rows];
    let along = |n: usize, by: i64| (0..n as i64).map(move |k| if by > 0 { n as i64 - 1 - k } else { k });
    for [by_column, by_row] in (-1..=1).flat_map(|x| [-1, 0, 1].map(|y| [x, y])).filter(|by| *by != [0, 0]) {
        // Pixels farther along come first.
        let mut is_blocked = vec![false; n_blocked.len()];
        for column in along(n_columns, by_column) {
            for row in along(n_rows, by_row) {
                let pixel = Pixel { column: column as u32, row: row as u32 };
                let (next_column, next_row) = (column + by_column, row + by_row);
                let is_within = (0..n_columns as i64).contains(&next_column) && (0..n_rows as i64).contains(&next_row);
                let at = grid.index(pixel);
                is_blocked[at] = if is_within {
                    let next = Pixel { column: next_column as u32, row: next_row as u32 };
                    is_blocked[grid.index(next)] || !is_step(grid, pixel, next)
                } else {
                    let step = Segment2::new(grid.centre(pixel), grid.centre_of([next_column as f64, next_row as f64]));
                    grid.walls_of(pixel).any(|wall| wall.meets(&step))
                };
                n_blocked[at] += u8::from(is_blocked[at]);
            }
        }
    }
    let is_surrounded = |(k, n): (usize, &u8)| {
        let pixel = grid.pixel(k);
        *n >= 7 && !grid.walls_of(pixel).any(|wall| wall.contains(grid.centre(pixel)))
    };
    n_blocked.iter().enumerate().map(is_surrounded).collect()
}

/// The largest part of some pixels that steps between them join; `None` of none.
fn largest_part(grid: &PixelGrid, of: &[bool]) -> Option<Vec<bool>> {
    let mut part_of = vec![0u32; of.len()];
    let mut sizes = Vec::new();
    for first in (0..of.len()).filter(|&k| of[k]) {
        if part_of[first] != 0 {
            continue;
        }
        let (part, mut size, mut next) = (sizes.len() as u32 + 1, 0usize, vec![grid.pixel(first)]);
        part_of[first] = part;
        while let Some(pixel) = next.pop() {
            size += 1;
            for neighbour in neighbours(grid, pixel) {
                let at = grid.index(neighbour);
                if of[at] && part_of[at] == 0 && is_step(grid, pixel, neighbour) {
                    part_of[at] = part;
                    next.push(neighbour);
                }
            }
        }
        sizes.push(size);
    }
    let (largest, _) = sizes.iter().enumerate().max_by_key(|(part, size)| (**size, std::cmp::Reverse(*part)))?;
    Some(part_of.iter().map(|part| *part as usize == largest + 1).collect())
}

/// The pixels that are reached from some, as a list for all pixels.
fn from_seeds(grid: &PixelGrid, seeds: &[Pixel]) -> Vec<bool> {
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
fn enclosed(grid: &PixelGrid) -> Vec<bool> {
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
fn is_step(grid: &PixelGrid, from: Pixel, to: Pixel) -> bool {
    let step = Segment2::new(grid.centre(from), grid.centre(to));
    !grid.walls_of(from).chain(grid.walls_of(to)).any(|wall| wall.meets(&step))
}

/// The up to eight pixels around one.
fn neighbours(grid: &PixelGrid, pixel: Pixel) -> impl Iterator<Item = Pixel> {
    let around = |at: u32, n: usize| at.saturating_sub(1)..=(at + 1).min(n as u32 - 1);
    let [n_columns, n_rows] = grid.size();
    around(pixel.column, n_columns)
        .flat_map(move |column| around(pixel.row, n_rows).map(move |row| Pixel { column, row }))
        .filter(move |&other| other != pixel)
}
