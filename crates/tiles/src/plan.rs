//! What a world consists of, as JSON.
//!
//! ```json
//! {
//!   "sightlines_world": 1,
//!   "border": 20,
//!   "tiles": [
//!     {"name": "market", "scene": "market.glb", "viewers": {"min": [0, 0, 0], "max": [100, 30, 100]}},
//!     {"name": "harbour", "scene": "harbour.glb", "at": [100, 0, 0], "cells": "harbour-cells.json"}
//!   ]
//! }
//! ```
//!
//! Each tile is a scene in a file, which `at` moves to its place in the world; without it the scene is there already. Eyes can be in `viewers`, a
//! box in the world, which is cut into cells; or in `cells`, a file of view cells in coordinates of the scene, moved with it. With neither, viewers
//! can be anywhere in the box of the scene. Boxes of viewers may touch and overlap. Names of files are relative to the plan. A tile is near another if what it contains is at most
//! `border` away, along each axis, from the box of the other's viewers; 0 by default: those that touch it. `reach`, if it is there, states that
//! viewers see no farther than that along any axis from their tile's box of viewers, for a far plane or fog.

use crate::error::WorldError;
use serde::{Deserialize, Serialize};
use sightlines_geometry::{Aabb, check_coordinate};
use std::collections::HashMap;

/// The version of plans and indices.
pub(crate) const VERSION: u32 = 1;

/// Most bytes of a name: names are parts of names of files.
const LONGEST_NAME: usize = 100;

/// The tiles of a world.
#[derive(Debug, Clone, PartialEq)]
pub struct WorldPlan {
    /// How far away, along each axis, what a tile contains is near another, in scene units.
    pub border: f64,
    /// How far viewers see at most, along each axis, in scene units: a premise, under which tiles farther away are never seen. At least the border. `None`: to
    /// the end of the world.
    pub reach: Option<f64>,
    /// The tiles; at least one.
    pub tiles: Vec<TilePlan>,
}

/// A tile.
#[derive(Debug, Clone, PartialEq)]
pub struct TilePlan {
    /// Its name, different from all others: letters, digits, `-`, `_` and `.`, which it does not begin with.
    pub name: String,
    /// The file of its scene.
    pub scene: String,
    /// By how much the scene is moved.
    pub at: [f64; 3],
    /// Where eyes can be, in the world. Not empty.
    pub viewers: Option<Aabb<3>>,
    /// A file of view cells, in coordinates of the scene. Not with `viewers`.
    pub cells: Option<String>,
}

/// The form of the text.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Text {
    sightlines_world: u32,
    #[serde(default)]
    border: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    reach: Option<f64>,
    tiles: Vec<TileText>,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct TileText {
    name: String,
    scene: String,
    #[serde(default)]
    at: [f64; 3],
    #[serde(default)]
    viewers: Option<BoxText>,
    #[serde(default)]
    cells: Option<String>,
}

/// A box.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct BoxText {
    min: [f64; 3],
    max: [f64; 3],
}

impl From<&Aabb<3>> for BoxText {
    fn from(b: &Aabb<3>) -> Self {
        Self { min: b.min, max: b.max }
    }
}

impl BoxText {
    /// The box, if it has room and coordinates that can be used.
    pub(crate) fn checked(&self) -> Option<Aabb<3>> {
        let is_right = (0..3).all(|k| self.min[k] < self.max[k]);
        let is_number = self.min.iter().chain(&self.max).all(|x| check_coordinate(*x).is_ok());
        (is_right && is_number).then_some(Aabb { min: self.min, max: self.max })
    }
}

/// Whether a name can be that of a tile, and a part of the name of a file.
pub(crate) fn is_name(name: &str) -> bool {
    let is_right = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
    !name.is_empty() && name.len() <= LONGEST_NAME && name.chars().all(is_right) && !name.starts_with('.')
}

/// Refuses names that are none, and repeated ones. On systems that take large and small letters in names of files as the same, so does this.
pub(crate) fn check_names<'a>(names: impl Iterator<Item = &'a str>) -> Result<(), WorldError> {
    let mut places: HashMap<String, usize> = HashMap::new();
    for (tile, name) in names.enumerate() {
        if !is_name(name) {
            let what = format!(
                "{name:?} is no name of a tile: up to {LONGEST_NAME} letters, digits, '-', '_' and '.', which it does not begin with"
            );
            return Err(WorldError::Tile { tile, what });
        }
        if let Some(first) = places.insert(name.to_ascii_lowercase(), tile) {
            return Err(WorldError::Tile { tile, what: format!("tile {first} has the name {name:?} too") });
        }
    }
    Ok(())
}

impl WorldPlan {
    /// Reads a plan. O(length).
    ///
    /// # Errors
    /// [`WorldError::Syntax`], [`WorldError::Version`], [`WorldError::Tile`], [`WorldError::World`].
    pub fn parse(text: &[u8]) -> Result<Self, WorldError> {
        let syntax = |error: serde_json::Error| WorldError::syntax(&error);
        // The version first: another one may have other members.
        check_version(text)?;
        let Text { border, reach, tiles, .. } = serde_json::from_slice(text).map_err(syntax)?;
        check_distances(border, reach)?;
        if tiles.is_empty() {
            return Err(WorldError::World("there are no tiles"));
        }
        check_names(tiles.iter().map(|tile| &*tile.name))?;
        let tiles = tiles
            .into_iter()
            .enumerate()
            .map(|(tile, text)| text.checked().map_err(|what| WorldError::Tile { tile, what }));
        Ok(Self { border, reach, tiles: tiles.collect::<Result<_, _>>()? })
    }

    /// The plan as text.
    pub fn to_json(&self) -> String {
        let tile = |tile: &TilePlan| TileText {
            name: tile.name.clone(),
            scene: tile.scene.clone(),
            at: tile.at,
            viewers: tile.viewers.as_ref().map(BoxText::from),
            cells: tile.cells.clone(),
        };
        let tiles = self.tiles.iter().map(tile).collect();
        let text = Text { sightlines_world: VERSION, border: self.border, reach: self.reach, tiles };
        serde_json::to_string_pretty(&text).expect("numbers and texts are JSON") + "\n"
    }
}

/// Refuses distances that are none.
pub(crate) fn check_distances(border: f64, reach: Option<f64>) -> Result<(), WorldError> {
    if !(border >= 0.0 && border.is_finite()) {
        return Err(WorldError::World("\"border\" is a number from 0 on"));
    }
    if reach.is_some_and(|reach| !(reach >= border && reach.is_finite())) {
        return Err(WorldError::World("\"reach\" is a number from \"border\" on"));
    }
    Ok(())
}

/// Refuses a text that is of another version.
pub(crate) fn check_version(text: &[u8]) -> Result<(), WorldError> {
    #[derive(Deserialize)]
    struct Version {
        sightlines_world: u32,
    }
    let found: Version = serde_json::from_slice(text).map_err(|error| WorldError::syntax(&error))?;
    if found.sightlines_world == VERSION { Ok(()) } else { Err(WorldError::Version(found.sightlines_world)) }
}

impl TileText {
    fn checked(self) -> Result<TilePlan, String> {
        let Self { name, scene, at, viewers, cells } = self;
        if at.iter().any(|x| check_coordinate(*x).is_err()) {
            return Err("\"at\" has a coordinate that cannot be used".to_owned());
        }
        if viewers.is_some() && cells.is_some() {
            return Err("both \"viewers\" and \"cells\" say where eyes can be".to_owned());
        }
        let viewers = viewers.map(|b| b.checked().ok_or("\"viewers\" is no box with room in it")).transpose()?;
        Ok(TilePlan { name, scene, at, viewers, cells })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PLAN: &str = r#"{"sightlines_world": 1, "border": 0.1, "tiles": [
        {"name": "a", "scene": "a.glb", "viewers": {"min": [0, 0, 0], "max": [0.1, 1, 1]}},
        {"name": "b", "scene": "b.glb", "at": [1, 0, 0], "cells": "b.json"},
        {"name": "c", "scene": "a.glb"}]}"#;

    #[test]
    fn plans_come_back() {
        let plan = WorldPlan::parse(PLAN.as_bytes()).unwrap();
        assert_eq!((plan.border, plan.tiles.len(), plan.tiles[1].at), (0.1, 3, [1.0, 0.0, 0.0]));
        assert_eq!(plan.tiles[0].viewers.unwrap().max, [0.1, 1.0, 1.0]);
        assert_eq!(WorldPlan::parse(plan.to_json().as_bytes()).unwrap(), plan);
    }

    #[test]
    fn what_is_wrong_is_named() {
        let cases = [
            ("\"border\": 0.1", "\"border\": -1", "\"border\" is a number from 0 on"),
            ("\"border\": 0.1", "\"border\": 2, \"reach\": 1", "\"reach\" is a number from \"border\" on"),
            ("\"a.glb\", ", "\"a.glb\" ", "line 2 column 40: expected `,` or `}`"),
            ("\"b\", ", "\"A\", ", "tile 1: tile 0 has the name \"A\" too"),
            (
                "\"b\", ",
                "\"../b\", ",
                "tile 1: \"../b\" is no name of a tile: up to 100 letters, digits, '-', '_' and '.', which it does not begin with",
            ),
            ("[0.1, 1, 1]", "[0, 1, 1]", "tile 0: \"viewers\" is no box with room in it"),
            ("\"at\": [1, 0, 0]", "\"at\": [1e300, 0, 0]", "tile 1: \"at\" has a coordinate that cannot be used"),
            (
                "\"at\": [1, 0, 0]",
                "\"viewers\": {\"min\": [0, 0, 0], \"max\": [1, 1, 1]}",
                "tile 1: both \"viewers\" and \"cells\" say where eyes can be",
            ),
            ("\"sightlines_world\": 1", "\"sightlines_world\": 2", "version 2 of the world is not known"),
            (
                "\"border\"",
                "\"boarder\"",
                "line 1 column 33: unknown field `boarder`, expected one of `sightlines_world`, `border`, `reach`, `tiles`",
            ),
        ];
        for (old, new, expected) in cases {
            assert!(PLAN.contains(old));
            let error = WorldPlan::parse(PLAN.replacen(old, new, 1).as_bytes()).unwrap_err();
            assert_eq!(error.to_string(), expected, "{new}");
        }
        let none = WorldPlan::parse(br#"{"sightlines_world": 1, "tiles": []}"#).unwrap_err();
        assert_eq!(none.to_string(), "there are no tiles");
        (0..PLAN.len()).for_each(|n| assert!(WorldPlan::parse(&PLAN.as_bytes()[..n]).is_err(), "{n}"));
    }
}
