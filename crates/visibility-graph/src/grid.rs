//! Grids over a plan: where pixels lie, and which walls touch them.

use crate::points::Points;
use sightlines_cells::Plan;
use sightlines_geometry::{Aabb, CoordinateError, Point2, Segment2, check_coordinate};

/// The most pixels of a grid, filled or not.
pub const MOST_PIXELS: usize = 1 << 26;

/// Square pixels over the bounds of a plan, with centres at multiples of the spacing, as depthmapX places them.
#[derive(Debug, Clone)]
pub struct PixelGrid {
    spacing: f64,
    /// The centre of the lowest pixel on the left.
    origin: Point2,
    n_columns: usize,
    n_rows: usize,
    walls: Vec<Segment2>,
    /// Where the walls of each pixel begin in `of_pixels`, column by column.
    starts: Vec<u32>,
    /// Walls that touch a pixel, and perhaps some that only come near it.
    of_pixels: Vec<u32>,
}

/// A pixel of a grid: its column and row, from 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Pixel {
    /// Column, to the right.
    pub column: u32,
    /// Row, upwards.
    pub row: u32,
}

/// Why there is no grid, or none of its points.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GridError {
    /// A spacing that is no positive number.
    #[error("a spacing of {0} is no positive number")]
    Spacing(f64),
    /// A plan without opaque lines.
    #[error("the plan has no walls")]
    NoWalls,
    /// More pixels than [`MOST_PIXELS`].
    #[error("a spacing of {spacing} makes more than {MOST_PIXELS} pixels of {width} by {height} units")]
    TooFine {
        /// The spacing.
        spacing: f64,
        /// Of the plan.
        width: f64,
        /// Of the plan.
        height: f64,
    },
    /// Coordinates so large that doubles hardly tell neighbouring pixels apart.
    #[error("a spacing of {spacing} is too small for coordinates as large as {largest}")]
    TooFar {
        /// The spacing.
        spacing: f64,
        /// The largest coordinate, or its negative.
        largest: f64,
    },
    /// A pixel whose centre is no usable coordinate.
    #[error("the centre of a pixel: {0}")]
    Coordinate(#[from] CoordinateError),
    /// A seed without a pixel.
    #[error("the seed ({x}, {y}) lies outside the grid")]
    SeedOutside {
        /// Of the seed.
        x: f64,
        /// Of the seed.
        y: f64,
    },
    /// A seed with a wall between it and the centre of its pixel.
    #[error("a wall lies between the seed ({x}, {y}) and the centre of its pixel, ({to_x}, {to_y})")]
    SeedBlocked {
        /// Of the seed.
        x: f64,
        /// Of the seed.
        y: f64,
        /// Of the centre.
        to_x: f64,
        /// Of the centre.
        to_y: f64,
    },
    /// Without seeds: all pixels are reached from outside.
    #[error("no pixel is enclosed by walls that leave no gap between pixels: name a seed")]
    NothingEnclosed,
}

impl PixelGrid {
    /// A grid over the bounds of a plan's lines that block sight. Lines that do not block are left out.
    ///
    /// Centres lie at multiples of the spacing, in each direction from the multiple next to the lower bound to the one next to the upper
    /// bound, and at most half a pixel outside; of two that are equally near, the outer one.
    ///
    /// # Errors
    /// [`GridError`]: spacing, no walls, too fine, too far, coordinates.
    ///
    /// # Cost
    /// O(pixels + pixels that walls touch).
    ///
    /// # Source
    /// The placement is that of depthmapX, `PointMap::setGrid` in salalib/pointdata.cpp, without an offset. Where doubles do not represent
    /// multiples of the spacing, centres are rounded by the same operations.
    pub fn over(plan: &Plan, spacing: f64) -> Result<Self, GridError> {
        if !(spacing > 0.0 && spacing.is_finite()) {
            return Err(GridError::Spacing(spacing));
        }
        let walls: Vec<Segment2> = plan.walls().collect();
        let bounds: Aabb<2> = Aabb::around(walls.iter().flat_map(|wall| [wall.a, wall.b]).map(|p| [p.x, p.y]));
        if bounds.is_empty() {
            return Err(GridError::NoWalls);
        }
        let too_fine =
            GridError::TooFine { spacing, width: bounds.max[0] - bounds.min[0], height: bounds.max[1] - bounds.min[1] };
        let mut origin = [0.0; 2];
        let mut n = [0usize; 2];
        for k in 0..2 {
            let beyond = beyond_centre(bounds.min[k], spacing);
            let steps = ((beyond + (bounds.max[k] - bounds.min[k])) / spacing + 0.5).floor();
            if !(0.0..MOST_PIXELS as f64).contains(&steps) {
                return Err(too_fine);
            }
            n[k] = steps as usize + 1;
            origin[k] = bounds.min[k] - beyond;
            let largest = origin[k].abs().max((origin[k] + spacing * steps).abs());
            if largest * f64::EPSILON > 0.25 * SLACK * spacing {
                return Err(GridError::TooFar { spacing, largest });
            }
            // The first and the last of these are the extremes; one more on each side is looked at from outside.
            for step in [-1.0, steps + 1.0] {
                check_coordinate(origin[k] + spacing * step)?;
            }
        }
        if n[0].saturating_mul(n[1]) > MOST_PIXELS {
            return Err(too_fine);
        }
        let [n_columns, n_rows] = n;
        let origin = Point2::new(origin[0], origin[1]);
        let mut grid = Self { spacing, origin, n_columns, n_rows, walls, starts: Vec::new(), of_pixels: Vec::new() };
        grid.sort_walls();
        Ok(grid)
    }

    /// The distance of neighbouring centres along an axis.
    pub fn spacing(&self) -> f64 {
        self.spacing
    }

    /// Columns of pixels, and pixels of a column.
    pub fn size(&self) -> [usize; 2] {
        [self.n_columns, self.n_rows]
    }

    /// The centre of a pixel.
    pub fn centre(&self, pixel: Pixel) -> Point2 {
        self.centre_of([f64::from(pixel.column), f64::from(pixel.row)])
    }

    /// The pixel at a point, if there is one. On the border of two it is the right or upper one.
    pub fn pixel_at(&self, p: Point2) -> Option<Pixel> {
        let place = |x: f64, origin: f64, n: usize| {
            let k = ((x - origin + self.spacing / 2.0) / self.spacing).floor();
            (0.0..n as f64).contains(&k).then_some(k as u32)
        };
        Some(Pixel { column: place(p.x, self.origin.x, self.n_columns)?, row: place(p.y, self.origin.y, self.n_rows)? })
    }

    /// The points of some pixels.
    pub(crate) fn points(&self, filled: &[bool]) -> Points {
        let pixels: Vec<Pixel> = (0..filled.len()).filter(|&k| filled[k]).map(|k| self.pixel(k)).collect();
        let places = pixels.iter().map(|p| [f64::from(p.column), f64::from(p.row)]).collect();
        let touched: Vec<bool> = (0..filled.len()).map(|k| self.is_touched(self.pixel(k))).collect();
        let near = |pixel: &Pixel| {
            let around = |at: u32, n: usize| at.saturating_sub(1)..=(at + 1).min(n as u32 - 1);
            around(pixel.column, self.n_columns)
                .any(|column| around(pixel.row, self.n_rows).any(|row| touched[self.index(Pixel { column, row })]))
        };
        let near_walls = pixels.iter().map(near).collect();
        Points::of_grid(pixels.iter().map(|&p| self.centre(p)).collect(), places, self.spacing, near_walls)
    }

    /// The place of a pixel in lists of all: up the columns.
    pub(crate) fn index(&self, pixel: Pixel) -> usize {
        pixel.column as usize * self.n_rows + pixel.row as usize
    }

    pub(crate) fn pixel(&self, index: usize) -> Pixel {
        Pixel { column: (index / self.n_rows) as u32, row: (index % self.n_rows) as u32 }
    }

    pub(crate) fn centre_of(&self, [column, row]: [f64; 2]) -> Point2 {
        Point2::new(self.origin.x + self.spacing * column, self.origin.y + self.spacing * row)
    }

    /// All walls that touch a pixel, and perhaps some near it.
    pub(crate) fn walls_of(&self, pixel: Pixel) -> impl Iterator<Item = &Segment2> {
        let at = self.index(pixel);
        let [from, to] = [self.starts[at], self.starts[at + 1]].map(|k| k as usize);
        self.of_pixels[from..to].iter().map(|&wall| &self.walls[wall as usize])
    }

    /// Whether a wall and a closed pixel have a point in common. Exact for borders that are rounded once, alike for both pixels beside them.
    fn is_touched(&self, pixel: Pixel) -> bool {
        let border = |origin: f64, k: u32| origin + (2.0 * f64::from(k) - 1.0) * (self.spacing / 2.0);
        let [left, right] = [pixel.column, pixel.column + 1].map(|k| border(self.origin.x, k));
        let [low, high] = [pixel.row, pixel.row + 1].map(|k| border(self.origin.y, k));
        let corners = [[left, low], [right, low], [right, high], [left, high]].map(|[x, y]| Point2::new(x, y));
        let is_inside = |p: Point2| left <= p.x && p.x <= right && low <= p.y && p.y <= high;
        self.walls_of(pixel).any(|wall| {
            is_inside(wall.a) || (0..4).any(|k| Segment2::new(corners[k], corners[(k + 1) % 4]).meets(wall))
        })
    }

    /// Lists the walls of each pixel.
    fn sort_walls(&mut self) {
        let mut pairs: Vec<(u32, u32)> = Vec::new();
        for (wall, segment) in self.walls.iter().enumerate() {
            self.pixels_near(segment, |pixel| pairs.push((pixel as u32, wall as u32)));
        }
        pairs.sort_unstable();
        let mut starts = vec![0u32; self.n_columns * self.n_rows + 1];
        for &(pixel, _) in &pairs {
            starts[pixel as usize + 1] += 1;
        }
        for k in 1..starts.len() {
            starts[k] += starts[k - 1];
        }
        self.starts = starts;
        self.of_pixels = pairs.into_iter().map(|(_, wall)| wall).collect();
    }

    /// All pixels that a wall touches, and perhaps some near it: each column's part of the wall with [`SLACK`] on all sides.
    fn pixels_near(&self, wall: &Segment2, mut each: impl FnMut(usize)) {
        // In pixels, where the pixel k reaches from k to k + 1.
        let place =
            |p: Point2| [(p.x - self.origin.x) / self.spacing + 0.5, (p.y - self.origin.y) / self.spacing + 0.5];
        let [mut a, mut b] = [place(wall.a), place(wall.b)];
        if a[0] > b[0] {
            (a, b) = (b, a);
        }
        let most = |n: usize| n as f64 - 1.0;
        let range = |low: f64, high: f64, n: usize| {
            let [low, high] = [low - SLACK, high + SLACK].map(|x| x.floor().clamp(0.0, most(n)) as usize);
            low..=high
        };
        for column in range(a[0], b[0], self.n_columns) {
            let slope = (b[1] - a[1]) / (b[0] - a[0]);
            let at = |x: f64| {
                let y = a[1] + (x - a[0]) * slope;
                // Upright walls have no slope.
                if y.is_nan() { a[1] } else { y }
            };
            let [left, right] = [column as f64 - SLACK, column as f64 + 1.0 + SLACK];
            let ends = if b[0] - a[0] <= SLACK { [a[1], b[1]] } else { [at(left.max(a[0])), at(right.min(b[0]))] };
            let low = ends[0].min(ends[1]).max(a[1].min(b[1]));
            let high = ends[0].max(ends[1]).min(a[1].max(b[1]));
            range(low, high, self.n_rows).for_each(|row| each(column * self.n_rows + row));
        }
    }
}

/// Added to the part of a wall on all sides when pixels near it are listed, in pixels. It decides nothing: walls that are listed for
/// nothing are tested for nothing. Places are at most 2^26 pixels, and computed in a few roundings of 2^-53 of that, or less than 2^-24;
/// centres are off by a unit in the last place of a coordinate, at most a quarter of this.
const SLACK: f64 = 1.0 / 4096.0;

/// How far a bound is beyond the multiple of the spacing next to it: from minus half a spacing, not reached, to half a spacing.
fn beyond_centre(x: f64, spacing: f64) -> f64 {
    let mut beyond = x % spacing;
    if beyond < spacing / 2.0 {
        beyond += spacing;
    }
    if beyond > spacing / 2.0 {
        beyond -= spacing;
    }
    beyond
}
