//! Reading: one pass over the text, feature by feature, of one JSON text or of one after the other.

use super::Place;
use super::node::{Level, Node};
use super::plan_builder::PlanBuilder;
use crate::bytes::without_mark;
use crate::error::{Malformed, in_file};
use crate::json::{NOT_AN_OBJECT, Seed};
use crate::{PlanFile, ReadError, ReadErrorKind};
use serde::de::DeserializeSeed;
use sightlines_cells::Plan;
use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;

/// Reads a plan from a GeoJSON text; see the module for what means what.
///
/// Several texts, one behind the other, are one plan. Lines come in the order of the text. Rings are closed. Positions that repeat the one before them are dropped, and so are lines
/// without two different positions and lines that repeat others. A byte order mark is skipped. O(length).
///
/// # Errors
/// [`Malformed`] with line and column, and where known the feature, geometry and position.
pub fn parse_plan(text: &[u8]) -> Result<Plan, Malformed> {
    Ok(parse_plan_file(text)?.plan)
}

/// As [`parse_plan`], with what was dropped and what passes through.
///
/// # Errors
/// As [`parse_plan`].
pub fn parse_plan_file(text: &[u8]) -> Result<PlanFile, Malformed> {
    let (mut builder, text) = (PlanBuilder::default(), without_mark(text));
    let result = if is_sequence(text) {
        run(&mut builder, &mut serde_json::Deserializer::from_reader(Sequence(text)))
    } else {
        run(&mut builder, &mut serde_json::Deserializer::from_slice(text))
    };
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
    let path = path.as_ref();
    in_file(path, || {
        let mut file = BufReader::new(File::open(path)?);
        let head = file.fill_buf()?;
        let n_skipped = head.len() - without_mark(head).len();
        let is_sequence = is_sequence(without_mark(head));
        file.consume(n_skipped);
        let mut builder = PlanBuilder::default();
        let result = if is_sequence {
            run(&mut builder, &mut serde_json::Deserializer::from_reader(Sequence(file)))
        } else {
            run(&mut builder, &mut serde_json::Deserializer::from_reader(file))
        };
        match result {
            Ok(()) => Ok(builder.finish()?),
            Err(error) if error.is_io() => Err(ReadErrorKind::Io(error.into())),
            Err(error) => Err(builder.context.explain(&error).into()),
        }
    })
}

/// Reads values up to the end of the text, one behind the other; at least one.
fn run<'de, R: serde_json::de::Read<'de>>(
    builder: &mut PlanBuilder,
    json: &mut serde_json::Deserializer<R>,
) -> Result<(), serde_json::Error> {
    builder.context.expect(NOT_AN_OBJECT);
    Seed(Node { builder, level: Level::Top }).deserialize(&mut *json)?;
    for record in 1.. {
        // What follows a value is not in any feature.
        builder.context.place = Place::default();
        let behind = match json.end() {
            Ok(()) => break,
            Err(error) if error.is_syntax() => (error.line(), error.column()),
            Err(error) => return Err(error),
        };
        builder.begin_record(record);
        builder.context.expect(NOT_AN_OBJECT);
        if let Err(error) = Seed(Node { builder, level: Level::Top }).deserialize(&mut *json) {
            if (error.line(), error.column()) == behind {
                // Not even the beginning of a value.
                builder.context.place = Place::default();
            }
            return Err(error);
        }
    }
    Ok(())
}

/// The byte before each text of a sequence (RFC 8142). No JSON text has it outside of a string, and in a string only escaped.
const RECORD_SEPARATOR: u8 = 0x1E;

pub(crate) fn is_sequence(text: &[u8]) -> bool {
    text.trim_ascii_start().first() == Some(&RECORD_SEPARATOR)
}

/// Reads a sequence with tabs for separators: white space outside of strings, and refused inside. A text that was cut off leaves a string or a
/// bracket open, so what is behind it makes no whole of it.
pub(super) struct Sequence<R>(pub(super) R);

impl<R: Read> Read for Sequence<R> {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        let n = self.0.read(buffer)?;
        buffer[..n].iter_mut().filter(|byte| **byte == RECORD_SEPARATOR).for_each(|byte| *byte = b'\t');
        Ok(n)
    }
}
