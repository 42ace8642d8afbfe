//! Geometries, and their coordinates: nested lists, read flat.

use super::Context;
use crate::json::{Scalar, Seed, Shape};
use serde::de::{Error, MapAccess, SeqAccess};
use sightlines_geometry::{Point2, check_coordinate};

/// Positions, and where lines or rings end among them.
#[derive(Debug, Default)]
pub(super) struct Coordinates {
    /// How many lists there are around a position; `None` for an empty list.
    pub(super) depth: Option<u8>,
    pub(super) points: Vec<Point2>,
    /// One past the last position of each innermost list, for depth 1 and more.
    pub(super) ends: Vec<usize>,
}

impl Coordinates {
    /// The innermost lists: one line or ring, or one list of points, each.
    pub(super) fn parts(&self) -> impl Iterator<Item = &[Point2]> {
        let starts = std::iter::once(0).chain(self.ends.iter().copied());
        starts.zip(&self.ends).map(|(start, &end)| &self.points[start..end])
    }

    fn part_start(&self) -> usize {
        self.ends.last().copied().unwrap_or(0)
    }
}

/// Most lists around a position: those of a MultiPolygon.
const MAX_DEPTH: u8 = 3;

const OTHERWISE: &str = "the coordinates are not lists of positions of two numbers or more, all equally deep";

impl Coordinates {
    pub(super) fn read<'de, A: MapAccess<'de>>(context: &mut Context, map: &mut A) -> Result<Self, A::Error> {
        let mut out = Self::default();
        context.expect(OTHERWISE);
        match map.next_value_seed(Seed(Nested { context, out: &mut out, level: 0 }))? {
            Item::Number(_) => return Err(context.fail(OTHERWISE)),
            Item::Empty => {}
            Item::List(depth) => out.depth = Some(depth),
        }
        (context.place.part, context.place.position) = (None, None);
        Ok(out)
    }
}

/// What was found at one level.
#[derive(Clone, Copy, PartialEq)]
enum Item {
    Number(f64),
    Empty,
    /// A position (0), a list of positions (1), and so on.
    List(u8),
}

struct Nested<'r, 'o> {
    context: &'r mut Context,
    out: &'o mut Coordinates,
    /// Lists around this value.
    level: u8,
}

impl<'de> Shape<'de> for Nested<'_, '_> {
    type Value = Item;

    fn scalar<E: Error>(self, value: Scalar<'_>) -> Result<Item, E> {
        match value {
            Scalar::Number(x) => Ok(Item::Number(x)),
            Scalar::Integer(x) => Ok(Item::Number(x as f64)),
            _ => Err(self.context.fail(OTHERWISE)),
        }
    }

    fn list<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Item, A::Error> {
        if self.level > MAX_DEPTH {
            return Err(self.context.fail(OTHERWISE));
        }
        let mut first = None;
        let mut position = [0.0; 2];
        let mut n_numbers = 0;
        loop {
            // Of the position that comes next, for errors inside it.
            self.context.place.part = Some(self.out.ends.len());
            self.context.place.position = Some(self.out.points.len() - self.out.part_start());
            self.context.expect(OTHERWISE);
            let level = self.level + 1;
            let item = Nested { context: self.context, out: self.out, level };
            let Some(item) = seq.next_element_seed(Seed(item))? else { break };
            match (first, item) {
                (None | Some(Item::Number(_)), Item::Number(x)) => {
                    if let Some(slot) = position.get_mut(n_numbers) {
                        *slot = check_coordinate(x).map_err(|error| self.context.fail(error))?;
                    }
                    n_numbers += 1;
                    first = Some(item);
                }
                (None, Item::List(_)) => first = Some(item),
                (Some(Item::List(a)), Item::List(b)) if a == b => {}
                _ => return Err(self.context.fail(OTHERWISE)),
            }
        }
        match first {
            None if self.level == 0 => Ok(Item::Empty),
            Some(Item::Number(_)) if n_numbers >= 2 => {
                self.out.points.push(Point2::from_array(position));
                Ok(Item::List(0))
            }
            Some(Item::List(depth)) if depth < MAX_DEPTH => {
                if depth == 0 {
                    self.out.ends.push(self.out.points.len());
                }
                Ok(Item::List(depth + 1))
            }
            _ => Err(self.context.fail(OTHERWISE)),
        }
    }
}

/// A kind of geometry.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum GeometryKind {
    Point,
    MultiPoint,
    LineString,
    MultiLineString,
    Polygon,
    MultiPolygon,
}

impl GeometryKind {
    /// All of them in their order, with their names in GeoJSON, and how many lists there are around a position.
    const ALL: [(Self, &str, u8); 6] = [
        (Self::Point, "Point", 0),
        (Self::MultiPoint, "MultiPoint", 1),
        (Self::LineString, "LineString", 1),
        (Self::MultiLineString, "MultiLineString", 2),
        (Self::Polygon, "Polygon", 2),
        (Self::MultiPolygon, "MultiPolygon", 3),
    ];

    /// The kind that has a name in GeoJSON.
    pub(super) fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|(_, own, _)| *own == name).map(|(kind, ..)| kind)
    }

    pub(super) const fn depth(self) -> u8 {
        Self::ALL[self as usize].2
    }
}

/// A geometry whose coordinates have the depth of its kind.
#[derive(Debug)]
pub(super) struct Geometry {
    pub(super) kind: GeometryKind,
    pub(super) coordinates: Coordinates,
    pub(super) index: Option<usize>,
}
