//! Reading: one pass over the text, feature by feature.

use super::error::{GeoJsonError, GeoJsonPlace};
use super::node::{Level, Node};
use super::plan_builder::PlanBuilder;
use crate::{PlanFile, ReadError, ReadErrorKind};
use serde::de::DeserializeSeed;
use sightlines_cells::Plan;
use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::Path;

/// The three bytes that some editors put before a text.
const BYTE_ORDER_MARK: &[u8] = b"\xEF\xBB\xBF";

/// Reads a plan from a GeoJSON text; see the module for what means what.
///
/// Lines come in the order of the text. Rings are closed. Positions that repeat the one before them are dropped, and so are lines
/// without two different positions and lines that repeat others. A byte order mark is skipped. O(length).
///
/// # Errors
/// [`GeoJsonError`] with line and column, and where known the feature, geometry and position.
pub fn parse_plan(text: &[u8]) -> Result<Plan, GeoJsonError> {
    Ok(parse_plan_file(text)?.plan)
}

/// As [`parse_plan`], with what was dropped and what passes through.
///
/// # Errors
/// As [`parse_plan`].
pub fn parse_plan_file(text: &[u8]) -> Result<PlanFile, GeoJsonError> {
    let text = text.strip_prefix(BYTE_ORDER_MARK).unwrap_or(text);
    let mut builder = PlanBuilder::default();
    let result = run(&mut builder, &mut serde_json::Deserializer::from_slice(text));
    result.map_err(|error| builder.context.explain(&error))?;
    builder.finish()
}

/// Reads a plan from a GeoJSON file, as [`parse_plan`]; the text is never in memory as a whole.
///
/// # Errors
/// [`ReadError`] with the file and what is wrong.
pub fn read_plan(path: impl AsRef<Path>) -> Result<Plan, ReadError> {
    Ok(read_plan_file(path)?.plan)
}

/// As [`read_plan`], with what was dropped and what passes through.
///
/// # Errors
/// As [`read_plan`].
pub fn read_plan_file(path: impl AsRef<Path>) -> Result<PlanFile, ReadError> {
    let read = || -> Result<PlanFile, ReadErrorKind> {
        let mut file = BufReader::new(File::open(path.as_ref())?);
        if file.fill_buf()?.starts_with(BYTE_ORDER_MARK) {
            file.consume(BYTE_ORDER_MARK.len());
        }
        let mut builder = PlanBuilder::default();
        match run(&mut builder, &mut serde_json::Deserializer::from_reader(file)) {
            Ok(()) => Ok(builder.finish()?),
            Err(error) if error.is_io() => Err(ReadErrorKind::Io(error.into())),
            Err(error) => Err(builder.context.explain(&error).into()),
        }
    };
    read().map_err(|kind| ReadError::new(&path, kind))
}

/// Reads one value and nothing after it.
fn run<'de, R: serde_json::de::Read<'de>>(
    builder: &mut PlanBuilder,
    json: &mut serde_json::Deserializer<R>,
) -> Result<(), serde_json::Error> {
    Node { builder, level: Level::Top }.deserialize(&mut *json)?;
    // What follows the value is not in any feature.
    builder.context.place = GeoJsonPlace::default();
    json.end()
}
