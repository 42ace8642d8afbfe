//! Reading an index, and checking it.

use super::{LevelFile, LevelsIndex, Text, VERSION};
use crate::ReadError;
use crate::bytes::without_mark;
use crate::error::{Malformed, in_file, malformed};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::Path;

/// Reads an index of levels; see the module for what means what. A byte order mark is skipped. O(length * log(levels)).
///
/// # Errors
/// [`Malformed`] with line and column, or the level or cell.
pub fn parse_levels_index(text: &[u8]) -> Result<LevelsIndex, Malformed> {
    let text = without_mark(text);
    let syntax = |error: serde_json::Error| {
        // Our message starts with the position.
        let said = error.to_string();
        let what = malformed!("{}", said.split(" at line ").next().unwrap_or_default());
        what.within(format_args!("line {} column {}", error.line(), error.column()))
    };
    // The version first: another one may have other members.
    let Version { sightlines_levels: found } = serde_json::from_slice(text).map_err(syntax)?;
    if found != VERSION {
        return Err(malformed!("version {found} of the index is not {VERSION}"));
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
    let path = path.as_ref();
    in_file(path, || Ok(parse_levels_index(&std::fs::read(path)?)?))
}

#[derive(Deserialize)]
struct Version {
    sightlines_levels: u32,
}

fn check(index: &LevelsIndex) -> Result<(), Malformed> {
    let share = |member: &str, value: f64| {
        let fits = (0.0..=1.0).contains(&value);
        if fits { Ok(()) } else { Err(malformed!("\"{member}\" is a share from 0 to 1, not {value}")) }
    };
    share("budget", index.budget)?;
    let mut files: BTreeMap<&str, usize> = BTreeMap::new();
    for (k, level) in index.levels.iter().enumerate() {
        let LevelFile { file: name, n_triangles: n, bound, .. } = level;
        let fail = |what: Malformed| what.within(format_args!("level {k}"));
        share("bound", *bound).map_err(fail)?;
        if name.is_empty() || name.contains(['/', '\\', ':', '\0']) || name == "." || name == ".." {
            return Err(fail(malformed!("{name:?} is no name of a file beside the index")));
        }
        if let Some(first) = files.insert(name, k) {
            return Err(fail(malformed!("level {first} is in the same file, {name:?}")));
        }
        if *n > index.n_triangles {
            return Err(fail(malformed!("{n} triangles are more than the {} of the scene", index.n_triangles)));
        }
    }
    let n_levels = index.levels.len();
    for (cell, level) in index.cells.iter().enumerate() {
        if let Some(level) = level.filter(|&level| level as usize >= n_levels) {
            let what = malformed!("there is no level {level}, there are {n_levels}");
            return Err(what.within(format_args!("cell {cell}")));
        }
    }
    Ok(())
}
