//! Points and cells as arguments.

use sightlines::geometry::{Point2, check_coordinate};
use sightlines::pvs::{CellId, Table};
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// Why a cell or point is not one of a table.
#[derive(Debug, thiserror::Error)]
pub(crate) enum LookupError {
    /// A cell that the table does not have.
    #[error("{}: there is no cell {cell}: the table has {n_cells} cells", path.display())]
    NoSuchCell { path: PathBuf, cell: u32, n_cells: usize },
    /// A point with the wrong number of coordinates.
    #[error("{}: the table has {dimension} dimensions, but the point has {found} coordinates", path.display())]
    Dimension { path: PathBuf, dimension: u8, found: usize },
}

/// A point: two or three comma-separated numbers.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Point(Vec<f64>);

/// Why a text is not a point.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub(crate) enum PointError {
    #[error("a point is two or three comma-separated numbers, such as -1.5,2")]
    Count,
    #[error("'{0}' is not a number")]
    Number(String),
    #[error(transparent)]
    Coordinate(#[from] sightlines::geometry::CoordinateError),
}

impl FromStr for Point {
    type Err = PointError;

    fn from_str(text: &str) -> Result<Self, PointError> {
        let number = |part: &str| -> Result<f64, PointError> {
            let x: f64 = part.trim().parse().map_err(|_| PointError::Number(part.trim().to_owned()))?;
            Ok(check_coordinate(x)?)
        };
        if !(2..=3).contains(&text.split(',').count()) {
            return Err(PointError::Count);
        }
        Ok(Self(text.split(',').map(number).collect::<Result<_, _>>()?))
    }
}

impl std::fmt::Display for Point {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let numbers: Vec<String> = self.0.iter().map(f64::to_string).collect();
        write!(f, "({})", numbers.join(", "))
    }
}

impl Point {
    /// The coordinates, if they are as many as the table has dimensions.
    pub(crate) fn of(&self, table: &Table, path: &Path) -> Result<&[f64], LookupError> {
        self.coordinates(table.dimension(), path)
    }

    /// The coordinates, if they are as many as `dimension`.
    pub(crate) fn coordinates(&self, dimension: u8, path: &Path) -> Result<&[f64], LookupError> {
        let found = self.0.len();
        if usize::from(dimension) == found {
            Ok(&self.0)
        } else {
            Err(LookupError::Dimension { path: path.to_owned(), dimension, found })
        }
    }

    /// The point with z = 0 in a plane, if it has as many coordinates as the table has dimensions.
    pub(crate) fn lifted(&self, table: &Table, path: &Path) -> Result<[f64; 3], LookupError> {
        let coordinates = self.of(table, path)?;
        Ok(std::array::from_fn(|k| coordinates.get(k).copied().unwrap_or(0.0)))
    }

    /// The point in the plane, if it is one.
    pub(crate) fn planar(&self, table: &Table, path: &Path) -> Result<Point2, LookupError> {
        let coordinates = self.of(table, path)?;
        Ok(Point2::new(coordinates[0], coordinates[1]))
    }

    /// The point in space, if it is one.
    pub(crate) fn spatial(&self, table: &Table, path: &Path) -> Result<[f64; 3], LookupError> {
        let coordinates = self.of(table, path)?;
        Ok([coordinates[0], coordinates[1], coordinates[2]])
    }
}

/// Checks that a table has a cell.
pub(crate) fn cell(id: u32, table: &Table, path: &Path) -> Result<CellId, LookupError> {
    let n_cells = table.n_cells();
    if (id as usize) < n_cells {
        Ok(CellId(id))
    } else {
        Err(LookupError::NoSuchCell { path: path.to_owned(), cell: id, n_cells })
    }
}

/// A cell by its id, or the cells at a point.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Place {
    Cell(u32),
    Point(Point),
}

impl FromStr for Place {
    type Err = PlaceError;

    fn from_str(text: &str) -> Result<Self, PlaceError> {
        if text.contains(',') {
            return Ok(Self::Point(text.parse()?));
        }
        text.trim().parse().map(Self::Cell).map_err(|_| PlaceError::Cell(text.to_owned()))
    }
}

/// Why a text is neither a cell nor a point.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub(crate) enum PlaceError {
    #[error("'{0}' is neither the id of a cell nor a point such as -1.5,2")]
    Cell(String),
    #[error(transparent)]
    Point(#[from] PointError),
}

impl Place {
    /// The cells meant; none for a point outside every cell.
    pub(crate) fn cells(&self, table: &Table, path: &Path) -> Result<Vec<CellId>, LookupError> {
        match self {
            Self::Cell(id) => Ok(vec![cell(*id, table, path)?]),
            Self::Point(point) => Ok(table.place_at(point.lifted(table, path)?).cells().to_vec()),
        }
    }
}

impl std::fmt::Display for Place {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Cell(id) => write!(f, "cell {id}"),
            Self::Point(point) => write!(f, "point {point}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_parsed() {
        let point = |text: &str| text.parse::<Point>().map(|p| p.0);
        assert_eq!(point("-1.5,2"), Ok(vec![-1.5, 2.0]));
        assert_eq!(point(" 1e3 , -0 , 7"), Ok(vec![1000.0, 0.0, 7.0]));
        assert_eq!(point("1"), Err(PointError::Count));
        assert_eq!(point("1,2,3,4"), Err(PointError::Count));
        assert_eq!(point("1,x"), Err(PointError::Number("x".into())));
        for bad in ["NaN,1", "inf,1", "1,-inf", "1e300,0"] {
            assert!(matches!(point(bad), Err(PointError::Coordinate(_))), "{bad}");
        }
    }

    #[test]
    fn places_are_cells_or_points() {
        assert_eq!("12".parse(), Ok(Place::Cell(12)));
        assert!(matches!("1,2".parse(), Ok(Place::Point(_))));
        for bad in ["", "x", "-3", "1.5", "4294967296"] {
            assert_eq!(bad.parse::<Place>(), Err(PlaceError::Cell(bad.into())));
        }
    }
}
