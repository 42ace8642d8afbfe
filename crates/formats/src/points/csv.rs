//! Lines of values.

use super::NamedPoint;
use crate::bytes::text_lines;
use crate::error::{Malformed, malformed};
use sightlines_geometry::{Point2, check_coordinate};
use std::borrow::Cow;

/// A value, and the byte of its line at which it begins, from 1.
type Value<'a> = (usize, Cow<'a, str>);

/// Which columns hold what.
#[derive(Debug, Clone, Copy)]
struct Columns {
    x: usize,
    y: usize,
    name: Option<usize>,
    /// Whether a row may have no more values than these.
    only: bool,
}

/// Without a header.
const PLAIN: Columns = Columns { x: 0, y: 1, name: Some(2), only: true };

pub(super) fn parse(text: &[u8]) -> Result<Vec<NamedPoint>, Malformed> {
    let mut points = Vec::new();
    // Both are decided by the first line.
    let mut form: Option<(char, Columns)> = None;
    for (line, bytes) in (1..).zip(text_lines(text)) {
        let at = |(column, what): (usize, Malformed)| what.within(format_args!("line {line} column {column}"));
        let row = std::str::from_utf8(bytes)
            .map_err(|error| at((error.valid_up_to() + 1, malformed!("this is not UTF-8"))))?;
        if row.trim().is_empty() || row.trim_start().starts_with('#') {
            continue;
        }
        let separator = form.map_or_else(|| separator_of(row), |(separator, _)| separator);
        let values = split(row, separator).map_err(at)?;
        let columns = match form {
            Some((_, columns)) => columns,
            None => {
                let header = header(&values).map_err(at)?;
                form = Some((separator, header.unwrap_or(PLAIN)));
                if header.is_some() {
                    continue;
                }
                PLAIN
            }
        };
        points.push(point(&values, columns, row.len() + 1).map_err(at)?);
    }
    Ok(points)
}

fn separator_of(row: &str) -> char {
    ['\t', ';'].into_iter().find(|&c| row.contains(c)).unwrap_or(',')
}

fn split(row: &str, separator: char) -> Result<Vec<Value<'_>>, (usize, Malformed)> {
    let unclosed = || malformed!("the quotes are not closed at the end of the value");
    let mut values = Vec::new();
    let mut rest = row;
    loop {
        let is_blank = |c: char| c.is_whitespace() && c != separator;
        let trimmed = rest.trim_start_matches(is_blank);
        let column = row.len() - trimmed.len() + 1;
        let behind = match trimmed.strip_prefix('"') {
            Some(quoted) => {
                let (value, behind) = unquote(quoted).ok_or_else(|| (column, unclosed()))?;
                values.push((column, Cow::Owned(value)));
                let behind = behind.trim_start_matches(is_blank);
                if !behind.is_empty() && !behind.starts_with(separator) {
                    return Err((column, unclosed()));
                }
                behind
            }
            None => {
                let end = trimmed.find(separator).unwrap_or(trimmed.len());
                values.push((column, Cow::Borrowed(trimmed[..end].trim_end())));
                &trimmed[end..]
            }
        };
        match behind.strip_prefix(separator) {
            Some(more) => rest = more,
            None => return Ok(values),
        }
    }
}

/// What stands before the closing quotes, and what behind them.
fn unquote(text: &str) -> Option<(String, &str)> {
    let (mut value, mut rest) = (String::new(), text);
    loop {
        let end = rest.find('"')?;
        value.push_str(&rest[..end]);
        rest = &rest[end + 1..];
        match rest.strip_prefix('"') {
            Some(more) => {
                value.push('"');
                rest = more;
            }
            None => return Some((value, rest)),
        }
    }
}

/// The columns that a line of names states; `None` if its first two values are not names but begin as numbers do.
fn header(values: &[Value<'_>]) -> Result<Option<Columns>, (usize, Malformed)> {
    let is_name = |value: &Value<'_>| {
        value.1.starts_with(|c: char| c.is_alphabetic() || c == '_') && value.1.parse::<f64>().is_err()
    };
    if values.len() < 2 || !values.iter().take(2).all(is_name) {
        return Ok(None);
    }
    let find = |name: &str| {
        let mut found = values.iter().enumerate().filter(|(_, (_, value))| value.eq_ignore_ascii_case(name));
        match (found.next(), found.next()) {
            (_, Some((_, (column, _)))) => Err((*column, malformed!("the header names two columns {name}"))),
            (first, None) => Ok(first.map(|(k, _)| k)),
        }
    };
    let needed = |name| find(name)?.ok_or_else(|| (1, malformed!("the header names no column {name}")));
    Ok(Some(Columns { x: needed("x")?, y: needed("y")?, name: find("name")?, only: false }))
}

/// * `end`: one past the last byte of the line, where a missing value is missing
fn point(values: &[Value<'_>], columns: Columns, end: usize) -> Result<NamedPoint, (usize, Malformed)> {
    let coordinate = |idx: usize, what: &str| {
        let missing = |column| (column, malformed!("there is no {what}"));
        let (column, text) = values.get(idx).ok_or_else(|| missing(end))?;
        if text.is_empty() {
            return Err(missing(*column));
        }
        let number = || malformed!("'{}' is not a number", text.escape_debug());
        let x: f64 = text.parse().map_err(|_| (*column, number()))?;
        check_coordinate(x).map_err(|error| (*column, error.into()))
    };
    let point = Point2::new(coordinate(columns.x, "x")?, coordinate(columns.y, "y")?);
    if let (true, Some((column, _))) = (columns.only, values.get(3)) {
        return Err((*column, malformed!("there are more values than x, y and a name")));
    }
    let name = columns.name.and_then(|idx| values.get(idx)).map(|(_, name)| name.to_string());
    Ok(NamedPoint { point, name: name.filter(|name| !name.is_empty()) })
}
