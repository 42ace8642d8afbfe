//! An index of levels: simplified variants of a scene, each for some cells of a table.
//!
//! ```json
//! {
//!   "sightlines_levels": 1,
//!   "triangles": 66445,
//!   "budget": 0.001,
//!   "levels": [{"file": "level_0.glb", "triangles": 2107, "bytes": 58996, "bound": 0.00098, "occluder": true}],
//!   "cells": [0, 0, null]
//! }
//! ```
//!
//! `triangles` are those of the whole scene, and of each level; `bytes` is what a level takes in memory by the measure of
//! its maker (the file has textures as well). `cells` has for each cell of the table the number of its level, or null where the whole
//! scene is to be drawn. In `budget` and `bound` is the share of the sphere of directions in which an eye in the cells may meet another face
//! first than in the whole scene: what was allowed, and what is promised. `occluder` states whether the level lies inside the scene, as in
//! [`Simplification`](crate::scene::Simplification). `file` is beside the index. Members that are not shown here mean nothing.

use crate::ReadError;
use crate::bytes::without_mark;
use crate::error::{Malformed, in_file, malformed};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;

/// The name of an index in its folder.
pub const INDEX_NAME: &str = "index.json";

/// The version of the index that is written and read.
pub const VERSION: u32 = 1;

/// Which cells have which levels.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct LevelsIndex {
    /// Triangles of the whole scene.
    #[serde(rename = "triangles")]
    pub n_triangles: u64,
    /// The share of the sphere of directions that was allowed to change.
    pub budget: f64,
    /// The levels, by number.
    pub levels: Vec<LevelFile>,
    /// The level of each cell of the table; `None` where the whole scene is to be drawn.
    pub cells: Vec<Option<u32>>,
}

/// A level in a file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LevelFile {
    /// The name of the file, beside the index.
    pub file: String,
    /// Its triangles.
    #[serde(rename = "triangles")]
    pub n_triangles: u64,
    /// What it takes in memory.
    #[serde(rename = "bytes")]
    pub n_bytes: u64,
    /// The share of the sphere of directions that changes at most, for every eye in its cells.
    pub bound: f64,
    /// Whether it may be used as an occluder.
    pub occluder: bool,
}

/// The index as text, a line for each level. Shares have to be finite, as those are that are read.
pub fn write_levels_index(index: &LevelsIndex) -> String {
    let levels: Vec<String> = index.levels.iter().map(|level| format!("    {}", text(level))).collect();
    let levels = if levels.is_empty() { "[]".to_owned() } else { format!("[\n{}\n  ]", levels.join(",\n")) };
    let [n_triangles, budget, cells] = [text(&index.n_triangles), text(&index.budget), text(&index.cells)];
    format!(
        "{{\n  \"sightlines_levels\": {VERSION},\n  \"triangles\": {n_triangles},\n  \"budget\": {budget},\n  \
         \"levels\": {levels},\n  \"cells\": {cells}\n}}\n"
    )
}

fn text(value: &impl Serialize) -> String {
    serde_json::to_string(value).expect("numbers and texts are JSON")
}

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
    let index = serde_json::from_slice(text).map_err(syntax)?;
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
