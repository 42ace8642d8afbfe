//! Points in a plane from a file, such as measured places and viewpoints: CSV, or GeoJSON with points only.
//!
//! A CSV file has a point on each line, `x,y` or `x,y,name`. The separator is a comma, a semicolon or a tab: the strongest of tab,
//! semicolon and comma that the first line has. A first line of names is a header: it has to name columns `x` and `y`, may name a
//! column `name`, in any order, and other columns are then ignored. Blank lines and lines that begin with `#` are skipped. Values may
//! stand in double quotes, in which two stand for one. The decimal sign is a point. Coordinates are taken as they are.
//!
//! ```
//! use sightlines_formats::points::parse_points;
//!
//! let points = parse_points(b"x;y;name\n# measured\n1.5;2;door\n-3;4e1;\n").unwrap();
//! assert_eq!((points[0].point.x, points[0].name.as_deref()), (1.5, Some("door")));
//! assert_eq!((points[1].point.y, points[1].name.as_deref()), (40.0, None));
//! ```

mod csv;

use crate::bytes::without_mark;
use crate::error::{Malformed, in_file, malformed};
use crate::{ReadError, geojson};
use sightlines_geometry::Point2;
use std::path::Path;

/// A point that may have a name.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedPoint {
    /// Where it is, in the units of the file.
    pub point: Point2,
    /// What its file calls it.
    pub name: Option<String>,
}

/// Reads points in the order of the text: GeoJSON if it begins with a brace, else CSV. In GeoJSON, each position of Points and
/// MultiPoints is one, with the name that a plan would give its object. O(length).
///
/// # Errors
/// [`Malformed`] with line and column; also if there is no point at all, and for GeoJSON with lines or boxes.
pub fn parse_points(text: &[u8]) -> Result<Vec<NamedPoint>, Malformed> {
    let text = without_mark(text);
    let points = if text.trim_ascii_start().starts_with(b"{") { of_geojson(text)? } else { csv::parse(text)? };
    if points.is_empty() {
        return Err(whole("there are no points in the file"));
    }
    Ok(points)
}

/// Reads points from a file, as [`parse_points`].
///
/// # Errors
/// [`ReadError`] with the file and what is wrong.
pub fn read_points(path: impl AsRef<Path>) -> Result<Vec<NamedPoint>, ReadError> {
    let path = path.as_ref();
    in_file(path, || Ok(parse_points(&std::fs::read(path)?)?))
}

/// What is wrong with the file as a whole, where its text begins.
fn whole(what: &str) -> Malformed {
    malformed!("{what}").within("line 1 column 1")
}

fn of_geojson(text: &[u8]) -> Result<Vec<NamedPoint>, Malformed> {
    let file = geojson::parse_plan_file(text)?;
    if !file.plan.lines().is_empty() || file.dropped.n_without_length > 0 {
        return Err(whole("there are lines in the file, which should hold points only"));
    }
    let point = |object: &sightlines_cells::PlanObject| {
        let ([x, y], name) = (object.bounds.min, &object.name);
        if object.bounds.min != object.bounds.max {
            return Err(whole(&format!("the object \"{}\" is a box, not a point", name.escape_debug())));
        }
        Ok(NamedPoint { point: Point2::new(x, y), name: Some(name.clone()) })
    };
    file.plan.objects().iter().map(point).collect()
}
