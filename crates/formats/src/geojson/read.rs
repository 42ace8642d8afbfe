//! Reading: one pass over the text, feature by feature.

use super::coordinates::Coordinates;
use super::error::{GeoJsonError, GeoJsonErrorKind, GeoJsonPlace, GeometryKind};
use super::node::{Geometry, Level, Node};
use super::properties::{Properties, wrong};
use crate::{ReadError, ReadErrorKind};
use serde::de::{DeserializeSeed, Error};
use serde_json::error::Category;
use sightlines_cells::{LineId, Plan, PlanLine, PlanObject};
use sightlines_geometry::{Aabb, Point2};
use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::Path;

/// The three bytes that some editors put before a text.
const BYTE_ORDER_MARK: &[u8] = b"\xEF\xBB\xBF";

/// Reads a plan from a GeoJSON text; see the module for what means what.
///
/// Lines come in the order of the text. Rings are closed. Positions that repeat the one before them are
/// dropped as long as the line has two different ones. A byte order mark is skipped. O(length).
///
/// # Errors
/// [`GeoJsonError`] with line and column, and where known the feature, geometry and position.
pub fn parse_plan(text: &[u8]) -> Result<Plan, GeoJsonError> {
    let text = text.strip_prefix(BYTE_ORDER_MARK).unwrap_or(text);
    let mut reader = Reader::default();
    let result = reader.run(&mut serde_json::Deserializer::from_slice(text));
    result.map_err(|error| reader.explain(&error))?;
    reader.finish()
}

/// Reads a plan from a GeoJSON file, as [`parse_plan`]; the text is never in memory as a whole.
///
/// # Errors
/// [`ReadError`] with the file and what is wrong.
pub fn read_plan(path: impl AsRef<Path>) -> Result<Plan, ReadError> {
    let read = || -> Result<Plan, ReadErrorKind> {
        let mut file = BufReader::new(File::open(path.as_ref())?);
        if file.fill_buf()?.starts_with(BYTE_ORDER_MARK) {
            file.consume(BYTE_ORDER_MARK.len());
        }
        let mut reader = Reader::default();
        match reader.run(&mut serde_json::Deserializer::from_reader(file)) {
            Ok(()) => Ok(reader.finish()?),
            Err(error) if error.is_io() => Err(ReadErrorKind::Io(error.into())),
            Err(error) => Err(reader.explain(&error).into()),
        }
    };
    read().map_err(|kind| ReadError::new(&path, kind))
}

/// The plan so far, and where in the text's scene the reader is.
#[derive(Debug, Default)]
pub(super) struct Reader {
    lines: Vec<PlanLine>,
    objects: Vec<PlanObject>,
    mirrors: Vec<LineId>,
    pub(super) place: GeoJsonPlace,
    failure: Option<GeoJsonErrorKind>,
    /// What to say if the next value is of another JSON type than it should be.
    mismatch: Option<GeoJsonErrorKind>,
}

impl Reader {
    fn run<'de, R: serde_json::de::Read<'de>>(
        &mut self,
        json: &mut serde_json::Deserializer<R>,
    ) -> Result<(), serde_json::Error> {
        Node { reader: self, level: Level::Top }.deserialize(&mut *json)?;
        // What follows the value is not in any feature.
        self.place = GeoJsonPlace::default();
        json.end()
    }

    /// Says what is wrong if the value that is read next is of another JSON type than expected.
    pub(super) fn expect(&mut self, otherwise: GeoJsonErrorKind) {
        self.mismatch = Some(otherwise);
    }

    /// Keeps the reason and makes the error that carries the position in the text.
    pub(super) fn fail<E: Error>(&mut self, kind: GeoJsonErrorKind) -> E {
        self.failure = Some(kind);
        E::custom("not a plan")
    }

    fn explain(&mut self, error: &serde_json::Error) -> GeoJsonError {
        let found = match error.classify() {
            Category::Eof => GeoJsonErrorKind::Truncated,
            Category::Data => self.mismatch.take().unwrap_or(GeoJsonErrorKind::Syntax),
            Category::Syntax | Category::Io => GeoJsonErrorKind::Syntax,
        };
        let kind = self.failure.take().unwrap_or(found);
        GeoJsonError { line: error.line(), column: error.column(), place: self.place, kind }
    }

    fn finish(self) -> Result<Plan, GeoJsonError> {
        let place = GeoJsonPlace::default();
        // Coordinates and lengths were checked on the way; only the number of lines is left.
        let plan = Plan::new(self.lines, self.objects).and_then(|plan| plan.with_mirrors(self.mirrors));
        plan.map_err(|e| GeoJsonError { line: 1, column: 1, place, kind: e.into() })
    }

    /// Adds the geometries of one feature to the plan.
    pub(super) fn add_feature(&mut self, geometries: &[Geometry], about: &Properties) -> Result<(), GeoJsonErrorKind> {
        if about.is_mirror && about.transparent {
            return Err(wrong("mirror", "false where lines do not block sight"));
        }
        for geometry in geometries {
            self.place.geometry = geometry.index;
            match geometry.kind {
                GeometryKind::Point | GeometryKind::MultiPoint => self.add_points(&geometry.coordinates.points, about),
                kind => self.add_lines(kind, &geometry.coordinates, about)?,
            }
        }
        self.place.geometry = None;
        Ok(())
    }

    fn add_points(&mut self, points: &[Point2], about: &Properties) {
        let mut add = |points: &[Point2], suffix: &str| {
            let base = about.name.as_ref().or(about.id.as_ref());
            let name = base.map_or_else(|| format!("object {}", self.objects.len()), |base| format!("{base}{suffix}"));
            self.objects.push(PlanObject { name, bounds: Aabb::around(points.iter().map(|p| [p.x, p.y])) });
        };
        match points {
            [] => {}
            [_] => add(points, ""),
            _ if about.is_box => add(points, ""),
            _ => points.iter().enumerate().for_each(|(k, &point)| add(&[point], &format!(" #{k}"))),
        }
    }

    fn add_lines(
        &mut self,
        kind: GeometryKind,
        coordinates: &Coordinates,
        about: &Properties,
    ) -> Result<(), GeoJsonErrorKind> {
        let closed = matches!(kind, GeometryKind::Polygon | GeometryKind::MultiPolygon);
        let first = self.lines.len();
        for (part, points) in coordinates.parts().enumerate() {
            let before = self.lines.len();
            let back = closed.then(|| (points[points.len() - 1], points[0]));
            let steps = points.windows(2).map(|pair| (pair[0], pair[1])).chain(back);
            self.lines.extend(steps.filter(|(a, b)| a != b).map(|(a, b)| {
                let &Properties { transparent, left, right, .. } = about;
                PlanLine { a, b, opaque: !transparent, left, right }
            }));
            if self.lines.len() == before {
                self.place.part = Some(part);
                return Err(GeoJsonErrorKind::NoExtent(kind));
            }
        }
        if about.is_mirror {
            // More lines than ids are refused in the end.
            self.mirrors.extend((first..self.lines.len()).filter_map(|line| u32::try_from(line).ok().map(LineId)));
        }
        Ok(())
    }
}
