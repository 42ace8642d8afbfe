//! Reading an index, and checking it.

use super::error::{LevelsIndexError, LevelsIndexErrorKind as Kind, LevelsPlace};
use super::{LevelFile, LevelsIndex, Text, VERSION};
use crate::ReadError;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// The three bytes that some editors put before a text.
const BYTE_ORDER_MARK: &[u8] = b"\xEF\xBB\xBF";

/// Reads an index of levels; see the module for what means what. A byte order mark is skipped. O(length * log(levels)).
///
/// # Errors
/// [`LevelsIndexError`] with line and column, or the level or cell.
pub fn parse_levels_index(text: &[u8]) -> Result<LevelsIndex, LevelsIndexError> {
    let text = text.strip_prefix(BYTE_ORDER_MARK).unwrap_or(text);
    let syntax = |error: serde_json::Error| {
        let place = LevelsPlace::Text(error.line(), error.column());
        // Our message starts with the position.
        let said = error.to_string();
        let kind = Kind::Syntax(said.split(" at line ").next().unwrap_or_default().to_owned());
        LevelsIndexError { place, kind }
    };
    // The version first: another one may have other members.
    let Version { sightlines_levels: found } = serde_json::from_slice(text).map_err(syntax)?;
    if found != VERSION {
        return Err(LevelsIndexError { place: LevelsPlace::Whole, kind: Kind::Version { found } });
    }
    let Text { n_triangles, budget, levels, cells, .. } = serde_json::from_slice(text).map_err(syntax)?;
    let index = LevelsIndex { n_triangles, budget, levels, cells };
    check(&index)?;
    Ok(index)
}

/// Reads an index of levels from a file, as [`parse_levels_index`].
///
/// # Errors
/// [`ReadError`] with the file and what is wrong.
pub fn read_levels_index(path: impl AsRef<Path>) -> Result<LevelsIndex, ReadError> {
    let text = fs::read(&path).map_err(|error| ReadError::new(&path, error))?;
    parse_levels_index(&text).map_err(|error| ReadError::new(&path, error))
}

#[derive(Deserialize)]
struct Version {
    sightlines_levels: u32,
}

fn check(index: &LevelsIndex) -> Result<(), LevelsIndexError> {
    let share = |member: &'static str, value: f64| {
        if (0.0..=1.0).contains(&value) { Ok(()) } else { Err(Kind::Share { member, value }) }
    };
    let at = |place: LevelsPlace| move |kind: Kind| LevelsIndexError { place, kind };
    share("budget", index.budget).map_err(at(LevelsPlace::Whole))?;
    let mut files: BTreeMap<&str, usize> = BTreeMap::new();
    for (k, level) in index.levels.iter().enumerate() {
        let LevelFile { file: name, n_triangles: n, bound, .. } = level;
        let fail = at(LevelsPlace::Level(k));
        share("bound", *bound).map_err(fail)?;
        if name.is_empty() || name.contains(['/', '\\', ':', '\0']) || name == "." || name == ".." {
            return Err(fail(Kind::File { name: name.clone() }));
        }
        if let Some(first) = files.insert(name, k) {
            return Err(fail(Kind::SameFile { first, name: name.clone() }));
        }
        if *n > index.n_triangles {
            return Err(fail(Kind::Triangles { n: *n, all: index.n_triangles }));
        }
    }
    let n_levels = index.levels.len();
    for (cell, level) in index.cells.iter().enumerate() {
        if let Some(level) = level.filter(|&level| level as usize >= n_levels) {
            return Err(at(LevelsPlace::Cell(cell))(Kind::NoLevel { level, n_levels }));
        }
    }
    Ok(())
}
