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
//! [`Simplified`](crate::scene::Simplified). `file` is beside the index. Members that are not shown here mean nothing.

mod read;

pub use read::{parse_levels_index, read_levels_index};

use serde::{Deserialize, Serialize};

/// The name of an index in its folder.
pub const INDEX_NAME: &str = "index.json";

/// The version of the index that is written and read.
pub const VERSION: u32 = 1;

/// Which cells have which levels.
#[derive(Debug, Clone, PartialEq)]
pub struct LevelsIndex {
    /// Triangles of the whole scene.
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

/// The form of the text.
#[derive(Debug, Serialize, Deserialize)]
struct Text {
    sightlines_levels: u32,
    #[serde(rename = "triangles")]
    n_triangles: u64,
    budget: f64,
    levels: Vec<LevelFile>,
    cells: Vec<Option<u32>>,
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
