//! Reading: one pass over the text, cell by cell.

use super::error::{ViewCellPlace, ViewCellsError, ViewCellsErrorKind as Kind};
use super::{ViewCell, ViewCells};
use crate::ReadError;
use serde::de::{DeserializeSeed, Deserializer, Error, IgnoredAny, MapAccess, SeqAccess, Visitor};
use serde_json::error::Category;
use sightlines_geometry::{Aabb, check_coordinate};
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::fmt;
use std::fs;
use std::path::Path;

/// The three bytes that some editors put before a text.
const BYTE_ORDER_MARK: &[u8] = b"\xEF\xBB\xBF";

/// Reads view cells from a JSON text; see the module for what means what.
///
/// Negative zeros become positive ones; all other coordinates are taken as they are written, to the last bit. A byte
/// order mark is skipped. O(length * log(cells)).
///
/// # Errors
/// [`ViewCellsError`] with line and column, and where known the cell and its id.
pub fn parse_view_cells(text: &[u8]) -> Result<ViewCells, ViewCellsError> {
    let text = text.strip_prefix(BYTE_ORDER_MARK).unwrap_or(text);
    let mut reader = Reader::default();
    let mut json = serde_json::Deserializer::from_slice(text);
    match reader.whole(&mut json) {
        Ok(()) => Ok(ViewCells { cells: reader.cells, axes: reader.axes }),
        Err(error) => Err(reader.explain(&error)),
    }
}

/// Reads view cells from a JSON file, as [`parse_view_cells`].
///
/// # Errors
/// [`ReadError`] with the file and what is wrong.
pub fn read_view_cells(path: impl AsRef<Path>) -> Result<ViewCells, ReadError> {
    let text = fs::read(&path).map_err(|error| ReadError::new(&path, error))?;
    parse_view_cells(&text).map_err(|error| ReadError::new(&path, error))
}

/// The cells so far, and where in the list the reader is.
#[derive(Debug, Default)]
struct Reader {
    cells: Vec<ViewCell>,
    axes: Option<[[f64; 3]; 3]>,
    /// The cell that has an id.
    of_id: BTreeMap<String, usize>,
    place: ViewCellPlace,
    failure: Option<Kind>,
    /// The error if the next value is of another JSON type than it should be.
    mismatch: Option<Kind>,
}

impl Reader {
    fn whole<'de, R: serde_json::de::Read<'de>>(
        &mut self,
        json: &mut serde_json::Deserializer<R>,
    ) -> Result<(), serde_json::Error> {
        Top(self).deserialize(&mut *json)?;
        json.end()
    }

    /// Keeps the reason and makes the error that carries the position in the text.
    fn fail<E: Error>(&mut self, kind: Kind) -> E {
        self.failure = Some(kind);
        E::custom("no view cells")
    }

    fn explain(mut self, error: &serde_json::Error) -> ViewCellsError {
        let found = match error.classify() {
            Category::Eof => Kind::Truncated,
            Category::Data => self.mismatch.take().unwrap_or(Kind::Syntax),
            Category::Syntax | Category::Io => Kind::Syntax,
        };
        let kind = self.failure.take().unwrap_or(found);
        ViewCellsError { line: error.line(), column: error.column(), place: self.place, kind }
    }

    /// Takes a cell whose members were all read.
    fn add(&mut self, members: Members) -> Result<(), Kind> {
        let id = members.id.ok_or(Kind::Missing("id"))?;
        let min = members.min.ok_or(Kind::Missing("min"))?;
        let max = members.max.ok_or(Kind::Missing("max"))?;
        if let Some(axis) = (0..3).find(|&k| min[k] > max[k]) {
            return Err(Kind::Inverted { axis, min: min[axis], max: max[axis] });
        }
        match self.of_id.entry(id.clone()) {
            Entry::Occupied(first) => return Err(Kind::SameId { first: *first.get() }),
            Entry::Vacant(place) => place.insert(self.cells.len()),
        };
        self.cells.push(ViewCell { id, bounds: Aabb { min, max } });
        Ok(())
    }
}

/// The members of one cell, as far as they were there.
#[derive(Debug, Default)]
struct Members {
    id: Option<String>,
    min: Option<[f64; 3]>,
    max: Option<[f64; 3]>,
}

/// Reads the whole.
struct Top<'r>(&'r mut Reader);

impl<'de> DeserializeSeed<'de> for Top<'_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        self.0.mismatch = Some(Kind::NotAnObject);
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for Top<'_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an object with view cells")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<(), A::Error> {
        let reader = self.0;
        let mut found = false;
        while let Some(key) = map.next_key::<String>()? {
            match key.as_str() {
                "cells" if found => return Err(reader.fail(Kind::Repeated("cells"))),
                "cells" => {
                    map.next_value_seed(List(reader))?;
                    found = true;
                }
                "axes" => {
                    let axes = map.next_value_seed(Axes(reader))?;
                    if reader.axes.replace(axes).is_some() {
                        return Err(reader.fail(Kind::Repeated("axes")));
                    }
                }
                _ => drop(map.next_value::<IgnoredAny>()?),
            }
        }
        match (found, reader.cells.is_empty()) {
            (false, _) => Err(reader.fail(Kind::Missing("cells"))),
            (true, true) => Err(reader.fail(Kind::NoCells)),
            (true, false) => Ok(()),
        }
    }
}

/// Reads the axes of the cells.
struct Axes<'r>(&'r mut Reader);

impl Axes<'_> {
    /// How far products of the axes may be from those of unit vectors at right angles, as files round them. A box is the hull of its
    /// corners in any case.
    const OFF: f64 = 1e-3;

    fn mismatch() -> Kind {
        Kind::Member { member: "axes", expected: "a list of three unit vectors at right angles" }
    }
}

impl<'de> DeserializeSeed<'de> for Axes<'_> {
    type Value = [[f64; 3]; 3];

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Self::Value, D::Error> {
        self.0.mismatch = Some(Self::mismatch());
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for Axes<'_> {
    type Value = [[f64; 3]; 3];

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("three vectors")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Self::Value, A::Error> {
        let reader = self.0;
        let mut axes = [[0.0; 3]; 3];
        for slot in &mut axes {
            let axis = seq.next_element_seed(Corner { reader: &mut *reader, member: "axes" })?;
            let Some(axis) = axis else { return Err(reader.fail(Self::mismatch())) };
            *slot = axis;
        }
        let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let are_right = (0..3).all(|i| (0..3).all(|j| (dot(axes[i], axes[j]) - f64::from(i == j)).abs() <= Self::OFF));
        if seq.next_element::<IgnoredAny>()?.is_some() || !are_right {
            return Err(reader.fail(Self::mismatch()));
        }
        Ok(axes)
    }
}

/// Reads the list of cells into the reader.
struct List<'r>(&'r mut Reader);

impl<'de> DeserializeSeed<'de> for List<'_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        self.0.mismatch = Some(Kind::Member { member: "cells", expected: "a list" });
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for List<'_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a list of cells")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<(), A::Error> {
        loop {
            self.0.place = ViewCellPlace { cell: Some(self.0.cells.len()), id: None };
            if seq.next_element_seed(Cell(self.0))?.is_none() {
                break;
            }
        }
        self.0.place = ViewCellPlace::default();
        Ok(())
    }
}

/// Reads one cell into the reader.
struct Cell<'r>(&'r mut Reader);

impl<'de> DeserializeSeed<'de> for Cell<'_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        self.0.mismatch = Some(Kind::NotAnObject);
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for Cell<'_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a cell")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<(), A::Error> {
        let reader = self.0;
        let mut members = Members::default();
        while let Some(key) = map.next_key::<String>()? {
            let repeated = match key.as_str() {
                "id" => {
                    reader.mismatch = Some(Kind::Member { member: "id", expected: "text" });
                    let id = map.next_value::<String>()?;
                    if id.is_empty() {
                        return Err(reader.fail(Kind::EmptyId));
                    }
                    reader.place.id = Some(id.clone());
                    members.id.replace(id).map(|_| "id")
                }
                "min" => {
                    let corner = map.next_value_seed(Corner { reader, member: "min" })?;
                    members.min.replace(corner).map(|_| "min")
                }
                "max" => {
                    let corner = map.next_value_seed(Corner { reader, member: "max" })?;
                    members.max.replace(corner).map(|_| "max")
                }
                _ => {
                    map.next_value::<IgnoredAny>()?;
                    None
                }
            };
            if let Some(member) = repeated {
                return Err(reader.fail(Kind::Repeated(member)));
            }
        }
        reader.add(members).map_err(|kind| reader.fail(kind))
    }
}

/// Reads a corner of a cell: three coordinates.
struct Corner<'r> {
    reader: &'r mut Reader,
    member: &'static str,
}

impl<'de> DeserializeSeed<'de> for Corner<'_> {
    type Value = [f64; 3];

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<[f64; 3], D::Error> {
        self.reader.mismatch = Some(self.mismatch());
        deserializer.deserialize_any(self)
    }
}

impl Corner<'_> {
    fn mismatch(&self) -> Kind {
        Kind::Member { member: self.member, expected: "a list of three numbers" }
    }
}

impl<'de> Visitor<'de> for Corner<'_> {
    type Value = [f64; 3];

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("three numbers")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<[f64; 3], A::Error> {
        let mut corner = [0.0; 3];
        for slot in &mut corner {
            let Some(x) = seq.next_element::<f64>()? else { return Err(self.reader.fail(self.mismatch())) };
            *slot = check_coordinate(x)
                .map_err(|source| self.reader.fail(Kind::Coordinate { member: self.member, source }))?;
        }
        if seq.next_element::<IgnoredAny>()?.is_some() {
            return Err(self.reader.fail(self.mismatch()));
        }
        Ok(corner)
    }
}
