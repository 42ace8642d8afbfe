//! Points of an analysis: their places, and the unit of these.

use sightlines_geometry::{CoordinateError, Point2, check_coordinate};

/// Points between which distances and angles are measured.
///
/// Places are offsets in units of a length: those of a grid are whole numbers of its spacing, so that distances are not blurred by the
/// rounding of coordinates.
#[derive(Debug, Clone, PartialEq)]
pub struct Points {
    coordinates: Vec<Point2>,
    places: Vec<[f64; 2]>,
    unit: f64,
    /// Whether a path may turn at a point; no list if at all of them.
    near_walls: Option<Vec<bool>>,
}

/// Why coordinates are no points of an analysis.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PointsError {
    /// A coordinate that cannot be used.
    #[error("point {point}: {source}")]
    Coordinate {
        /// Index of the point.
        point: usize,
        /// What is wrong with it.
        source: CoordinateError,
    },
    /// More points than numbers.
    #[error("{0} points are more than a graph can hold")]
    TooMany(usize),
}

impl Points {
    /// Any points, in this order. Negative zeros become zeros; points may repeat.
    ///
    /// # Errors
    /// [`PointsError`] with the index of the first offender.
    pub fn new(coordinates: impl IntoIterator<Item = Point2>) -> Result<Self, PointsError> {
        let check = |(point, p): (usize, Point2)| {
            let of = |x: f64| check_coordinate(x).map_err(|source| PointsError::Coordinate { point, source });
            Ok(Point2::new(of(p.x)?, of(p.y)?))
        };
        let coordinates: Vec<Point2> = coordinates.into_iter().enumerate().map(check).collect::<Result<_, _>>()?;
        if u32::try_from(coordinates.len()).is_err() {
            return Err(PointsError::TooMany(coordinates.len()));
        }
        let places = coordinates.iter().map(|p| [p.x, p.y]).collect();
        Ok(Self { coordinates, places, unit: 1.0, near_walls: None })
    }

    pub(crate) fn of_grid(coordinates: Vec<Point2>, places: Vec<[f64; 2]>, unit: f64, near_walls: Vec<bool>) -> Self {
        Self { coordinates, places, unit, near_walls: Some(near_walls) }
    }

    /// The points, in scene units.
    pub fn coordinates(&self) -> &[Point2] {
        &self.coordinates
    }

    /// Number of points.
    pub fn len(&self) -> usize {
        self.coordinates.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.coordinates.is_empty()
    }

    /// Scene units in the unit of places.
    pub(crate) fn unit(&self) -> f64 {
        self.unit
    }

    /// From a point to another, in the unit of places.
    pub(crate) fn offset(&self, from: u32, to: u32) -> [f64; 2] {
        let [a, b] = [from, to].map(|p| self.places[p as usize]);
        [b[0] - a[0], b[1] - a[1]]
    }

    /// The distance of two points, in the unit of places.
    pub(crate) fn distance(&self, a: u32, b: u32) -> f64 {
        let [x, y] = self.offset(a, b);
        (x * x + y * y).sqrt()
    }

    /// Whether the pixel of a point or one of the eight around it touches a wall; true for points that are of no grid.
    pub fn is_near_wall(&self, point: u32) -> bool {
        self.near_walls.as_ref().is_none_or(|near| near[point as usize])
    }
}
