//! Reading: one pass over the text, cell by cell.

use super::{ViewCell, ViewCells};
use crate::ReadError;
use crate::bytes::without_mark;
use crate::error::{Malformed, in_file, malformed};
use crate::json::{Context, NOT_AN_OBJECT, Seed, Shape};
use serde::de::{DeserializeSeed, IgnoredAny, MapAccess, SeqAccess};
use sightlines_geometry::{Aabb, check_coordinate};
use std::collections::BTreeMap;
use std::fmt;
use std::path::Path;

/// Reads view cells from a JSON text; see the module for what means what.
///
/// Negative zeros become positive ones; all other coordinates are taken as they are written, to the last bit. A byte
/// order mark is skipped. O(length * log(cells)).
///
/// # Errors
/// [`Malformed`] with line and column where reading stopped, and where known the cell and its id.
pub fn parse_view_cells(text: &[u8]) -> Result<ViewCells, Malformed> {
    let mut reader = Reader::default();
    let mut json = serde_json::Deserializer::from_slice(without_mark(text));
    reader.context.expect(NOT_AN_OBJECT);
    let read = Seed(Top(&mut reader)).deserialize(&mut json).and_then(|()| json.end());
    read.map_err(|error| reader.context.explain(&error))?;
    Ok(ViewCells { cells: reader.cells, axes: reader.axes })
}

/// Reads view cells from a JSON file, as [`parse_view_cells`].
///
/// # Errors
/// [`ReadError`] with the file and what is wrong.
pub fn read_view_cells(path: impl AsRef<Path>) -> Result<ViewCells, ReadError> {
    let path = path.as_ref();
    in_file(path, || Ok(parse_view_cells(&std::fs::read(path)?)?))
}

/// A cell of the list, and its id once that was read.
#[derive(Debug, Default)]
struct Place(Option<usize>, Option<String>);

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.0, &self.1) {
            (None, _) => Ok(()),
            (Some(cell), None) => write!(f, "cell {cell}"),
            // As a Rust string: an id may hold anything, and a message should stay one line.
            (Some(cell), Some(id)) => write!(f, "cell {cell} ({id:?})"),
        }
    }
}

#[derive(Debug, Default)]
struct Reader {
    cells: Vec<ViewCell>,
    axes: Option<[[f64; 3]; 3]>,
    /// The cell that has an id.
    of_id: BTreeMap<String, usize>,
    context: Context<Place>,
}

impl Reader {
    fn add(&mut self, members: Members) -> Result<(), Malformed> {
        let missing = |member: &str| malformed!("there is no \"{member}\"");
        let id = members.id.ok_or_else(|| missing("id"))?;
        let min = members.min.ok_or_else(|| missing("min"))?;
        let max = members.max.ok_or_else(|| missing("max"))?;
        for (axis, (min, max)) in ["x", "y", "z"].into_iter().zip(min.into_iter().zip(max)) {
            if min > max {
                return Err(malformed!("\"min\" is above \"max\" in {axis}: {min} and {max}"));
            }
        }
        if let Some(first) = self.of_id.insert(id.clone(), self.cells.len()) {
            return Err(malformed!("cell {first} has the same id"));
        }
        self.cells.push(ViewCell { id, bounds: Aabb { min, max } });
        Ok(())
    }
}

#[derive(Debug, Default)]
struct Members {
    id: Option<String>,
    min: Option<[f64; 3]>,
    max: Option<[f64; 3]>,
}

fn repeated(member: &str) -> Malformed {
    malformed!("there are two members \"{member}\"")
}

struct Top<'r>(&'r mut Reader);

impl<'de> Shape<'de> for Top<'_> {
    type Value = ();

    fn object<A: MapAccess<'de>>(self, mut map: A) -> Result<(), A::Error> {
        let reader = self.0;
        let mut found = false;
        while let Some(key) = map.next_key::<String>()? {
            match key.as_str() {
                "cells" if found => return Err(reader.context.fail(repeated("cells"))),
                "cells" => {
                    reader.context.expect("\"cells\" is not a list");
                    map.next_value_seed(Seed(List(reader)))?;
                    found = true;
                }
                "axes" => {
                    reader.context.expect(Axes::OTHERWISE);
                    let axes = map.next_value_seed(Seed(Axes(&mut reader.context)))?;
                    if reader.axes.replace(axes).is_some() {
                        return Err(reader.context.fail(repeated("axes")));
                    }
                }
                _ => drop(map.next_value::<IgnoredAny>()?),
            }
        }
        match (found, reader.cells.is_empty()) {
            (false, _) => Err(reader.context.fail("there is no \"cells\"")),
            (true, true) => Err(reader.context.fail("there are no cells in the list")),
            (true, false) => Ok(()),
        }
    }
}

struct Axes<'r>(&'r mut Context<Place>);

impl Axes<'_> {
    /// How far products of the axes may be from those of unit vectors at right angles, as files round them. A box is the hull of its
    /// corners in any case.
    const OFF: f64 = 1e-3;
    const OTHERWISE: &'static str = "\"axes\" is not a list of three unit vectors at right angles";
}

impl<'de> Shape<'de> for Axes<'_> {
    type Value = [[f64; 3]; 3];

    fn list<A: SeqAccess<'de>>(self, mut list: A) -> Result<Self::Value, A::Error> {
        let mut axes = [[0.0; 3]; 3];
        for slot in &mut axes {
            self.0.expect(NO_AXIS);
            let axis = Corner { context: &mut *self.0, member: "axes", otherwise: NO_AXIS };
            let Some(axis) = list.next_element_seed(Seed(axis))? else { return Err(self.0.fail(Self::OTHERWISE)) };
            *slot = axis;
        }
        let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let are_right = (0..3).all(|i| (0..3).all(|j| (dot(axes[i], axes[j]) - f64::from(i == j)).abs() <= Self::OFF));
        if list.next_element::<IgnoredAny>()?.is_some() || !are_right {
            return Err(self.0.fail(Self::OTHERWISE));
        }
        Ok(axes)
    }
}

struct List<'r>(&'r mut Reader);

impl<'de> Shape<'de> for List<'_> {
    type Value = ();

    fn list<A: SeqAccess<'de>>(self, mut list: A) -> Result<(), A::Error> {
        loop {
            self.0.context.place = Place(Some(self.0.cells.len()), None);
            self.0.context.expect(NOT_AN_OBJECT);
            if list.next_element_seed(Seed(Cell(self.0)))?.is_none() {
                break;
            }
        }
        self.0.context.place = Place::default();
        Ok(())
    }
}

struct Cell<'r>(&'r mut Reader);

impl<'de> Shape<'de> for Cell<'_> {
    type Value = ();

    fn object<A: MapAccess<'de>>(self, mut map: A) -> Result<(), A::Error> {
        let reader = self.0;
        let mut members = Members::default();
        while let Some(key) = map.next_key::<String>()? {
            let context = &mut reader.context;
            let is_repeated = match key.as_str() {
                "id" => {
                    context.expect("\"id\" is not text");
                    let id = map.next_value::<String>()?;
                    if id.is_empty() {
                        return Err(context.fail("the id is empty"));
                    }
                    context.place.1 = Some(id.clone());
                    members.id.replace(id).is_some()
                }
                "min" | "max" => {
                    let (slot, member, otherwise) = match key == "min" {
                        true => (&mut members.min, "min", NO_MIN),
                        false => (&mut members.max, "max", NO_MAX),
                    };
                    context.expect(otherwise);
                    slot.replace(map.next_value_seed(Seed(Corner { context, member, otherwise }))?).is_some()
                }
                _ => {
                    map.next_value::<IgnoredAny>()?;
                    false
                }
            };
            if is_repeated {
                return Err(reader.context.fail(repeated(&key)));
            }
        }
        reader.add(members).map_err(|what| reader.context.fail(what))
    }
}

const NO_AXIS: &str = "\"axes\" is not a list of three numbers";
const NO_MIN: &str = "\"min\" is not a list of three numbers";
const NO_MAX: &str = "\"max\" is not a list of three numbers";

struct Corner<'r> {
    context: &'r mut Context<Place>,
    member: &'static str,
    otherwise: &'static str,
}

impl<'de> Shape<'de> for Corner<'_> {
    type Value = [f64; 3];

    fn list<A: SeqAccess<'de>>(self, mut list: A) -> Result<[f64; 3], A::Error> {
        let mut corner = [0.0; 3];
        for slot in &mut corner {
            let Some(x) = list.next_element::<f64>()? else { return Err(self.context.fail(self.otherwise)) };
            let wrong = |error| self.context.fail(format_args!("\"{}\": {error}", self.member));
            *slot = check_coordinate(x).map_err(wrong)?;
        }
        if list.next_element::<IgnoredAny>()?.is_some() {
            return Err(self.context.fail(self.otherwise));
        }
        Ok(corner)
    }
}
