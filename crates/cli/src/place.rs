//! Points and cells as arguments.

use crate::error::{Result, bail};
use crate::numbers::coordinates;
use crate::view::lifted;
use sightlines::geometry::Point2;
use sightlines::pvs::{CellId, Table};
use std::path::Path;
use std::str::FromStr;

/// A point: two or three comma-separated numbers.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Point(Vec<f64>);

impl FromStr for Point {
    type Err = anyhow::Error;

    fn from_str(text: &str) -> Result<Self> {
        if !(2..=3).contains(&text.split(',').count()) {
            bail!("a point is two or three comma-separated numbers, such as -1.5,2");
        }
        Ok(Self(coordinates(text)?))
    }
}

impl std::fmt::Display for Point {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let numbers: Vec<String> = self.0.iter().map(f64::to_string).collect();
        write!(f, "({})", numbers.join(", "))
    }
}

impl Point {
    pub(crate) fn coordinates(&self, dimension: u8, path: &Path) -> Result<&[f64]> {
        let found = self.0.len();
        if usize::from(dimension) != found {
            bail!("{}: the table has {dimension} dimensions, but the point has {found} coordinates", path.display());
        }
        Ok(&self.0)
    }

    /// The point in the plane, if it is one.
    pub(crate) fn planar(&self, path: &Path) -> Result<Point2> {
        self.coordinates(2, path).map(|at| Point2::new(at[0], at[1]))
    }

    /// The point in space, if it is one.
    pub(crate) fn spatial(&self, path: &Path) -> Result<[f64; 3]> {
        self.coordinates(3, path).map(lifted)
    }
}

pub(crate) fn cell(id: u32, table: &Table, path: &Path) -> Result<CellId> {
    let n_cells = table.n_cells();
    if id as usize >= n_cells {
        bail!("{}: there is no cell {id}: the table has {n_cells} cells", path.display());
    }
    Ok(CellId(id))
}

/// A cell by its id, or the cells at a point.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Place {
    Cell(u32),
    Point(Point),
}

impl FromStr for Place {
    type Err = anyhow::Error;

    fn from_str(text: &str) -> Result<Self> {
        if text.contains(',') {
            return Ok(Self::Point(text.parse()?));
        }
        match text.trim().parse() {
            Ok(id) => Ok(Self::Cell(id)),
            Err(_) => bail!("'{text}' is neither the id of a cell nor a point such as -1.5,2"),
        }
    }
}

impl Place {
    /// The cells meant; none for a point outside every cell.
    pub(crate) fn cells(&self, table: &Table, path: &Path) -> Result<Vec<CellId>> {
        match self {
            Self::Cell(id) => Ok(vec![cell(*id, table, path)?]),
            Self::Point(point) => {
                let at = point.coordinates(table.dimension(), path)?;
                Ok(table.place_at(lifted(at)).cells().to_vec())
            }
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
        let point = |text: &str| text.parse::<Point>().map(|p| p.0).map_err(|error| error.to_string());
        assert_eq!(point("-1.5,2"), Ok(vec![-1.5, 2.0]));
        assert_eq!(point(" 1e3 , -0 , 7"), Ok(vec![1000.0, 0.0, 7.0]));
        for bad in ["1", "1,2,3,4"] {
            assert!(point(bad).is_err_and(|error| error.starts_with("a point is two or three")), "{bad}");
        }
        assert_eq!(point("1,x"), Err("'x' is not a number".into()));
        for bad in ["NaN,1", "inf,1", "1,-inf", "1e300,0"] {
            assert!(point(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn places_are_cells_or_points() {
        assert!(matches!("12".parse(), Ok(Place::Cell(12))));
        assert!(matches!("1,2".parse(), Ok(Place::Point(_))));
        for bad in ["", "x", "-3", "1.5", "4294967296"] {
            let error = bad.parse::<Place>().unwrap_err().to_string();
            assert_eq!(error, format!("'{bad}' is neither the id of a cell nor a point such as -1.5,2"));
        }
    }
}
