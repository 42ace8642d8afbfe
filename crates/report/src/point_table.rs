//! Values at points as files: a row for each point, a column for each kind of value.

use sightlines_geometry::Point2;
use std::fmt::Write;

/// A kind of value.
#[derive(Debug, Clone, Copy)]
pub struct PointColumn<'a> {
    /// Its name; in CSV, without commas, quotes and breaks of lines.
    pub name: &'a str,
    /// A value for each point. `None`, and what is no finite number, is no value.
    pub values: &'a [Option<f64>],
}

/// Writes a table as CSV: a header, then `x`, `y`, `index` (of the point, from 0) and all columns for each point.
///
/// Numbers are as short as they can be without losing anything. Where there is no value, it writes `-1`, as depthmapX does.
///
/// # Panics
/// If a column has not as many values as there are points.
pub fn points_csv(points: &[Point2], columns: &[PointColumn<'_>]) -> String {
    check(points, columns);
    let mut out = String::from("x,y,index");
    columns.iter().for_each(|column| _ = write!(out, ",{}", column.name));
    out.push('\n');
    for (k, p) in points.iter().enumerate() {
        let _ = write!(out, "{},{},{k}", p.x, p.y);
        for column in columns {
            let _ = match known(column.values[k]) {
                Some(value) => write!(out, ",{value}"),
                None => write!(out, ",-1"),
            };
        }
        out.push('\n');
    }
    out
}

/// Writes a table as GeoJSON: a collection of points, with `index` and all columns as properties; null where there is no value.
///
/// # Panics
/// If a column has not as many values as there are points.
pub fn points_geojson(points: &[Point2], columns: &[PointColumn<'_>]) -> String {
    check(points, columns);
    let mut out = String::from("{\"type\":\"FeatureCollection\",\"features\":[");
    for (k, p) in points.iter().enumerate() {
        let comma = if k == 0 { "" } else { "," };
        let _ = write!(
            out,
            "{comma}\n{{\"type\":\"Feature\",\"geometry\":{{\"type\":\"Point\",\"coordinates\":[{},{}]}},\"properties\":{{\"index\":{k}",
            p.x, p.y
        );
        for column in columns {
            let _ = write!(out, ",{}:", serde_json::Value::from(column.name));
            let _ = match known(column.values[k]) {
                Some(value) => write!(out, "{value}"),
                None => write!(out, "null"),
            };
        }
        out.push_str("}}");
    }
    out.push_str("\n]}\n");
    out
}

fn check(points: &[Point2], columns: &[PointColumn<'_>]) {
    assert!(columns.iter().all(|column| column.values.len() == points.len()), "one value for each point");
}

fn known(value: Option<f64>) -> Option<f64> {
    value.filter(|x| x.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    const VALUES: [[Option<f64>; 2]; 2] = [[Some(3.0), Some(0.1)], [None, Some(f64::NAN)]];

    fn columns() -> [PointColumn<'static>; 2] {
        [PointColumn { name: "a", values: &VALUES[0] }, PointColumn { name: "b \"c\"", values: &VALUES[1] }]
    }

    #[test]
    fn rows_are_whole_and_numbers_lose_nothing() {
        let points = [Point2::new(0.1 + 0.2, -4.0), Point2::new(1e-7, 5.0)];
        let csv = points_csv(&points, &columns());
        assert_eq!(csv, "x,y,index,a,b \"c\"\n0.30000000000000004,-4,0,3,-1\n0.0000001,5,1,0.1,-1\n");
        let json: serde_json::Value = serde_json::from_str(&points_geojson(&points, &columns())).unwrap();
        let features = json["features"].as_array().unwrap();
        assert_eq!(features.len(), 2);
        assert_eq!(features[0]["geometry"]["coordinates"][0].as_f64(), Some(0.1 + 0.2));
        assert_eq!(features[1]["properties"]["a"].as_f64(), Some(0.1));
        assert_eq!(features[1]["properties"]["index"].as_u64(), Some(1));
        assert!(features[0]["properties"]["b \"c\""].is_null());
    }

    #[test]
    fn tables_of_nothing_have_a_header() {
        assert_eq!(points_csv(&[], &[]), "x,y,index\n");
        let json: serde_json::Value = serde_json::from_str(&points_geojson(&[], &[])).unwrap();
        assert_eq!(json["features"].as_array().map(Vec::len), Some(0));
    }
}
