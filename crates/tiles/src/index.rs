//! The folder of a baked world, and its index.

use crate::error::WorldError;
use crate::near::TileBounds;
use crate::plan::{BoxText, VERSION, check_distances, check_names, check_version};
use serde::{Deserialize, Serialize};

/// The name of the index in the folder.
pub const INDEX_NAME: &str = "world.json";

/// A file of a tile. Names contain a key of all that decides the content, so bakes of different inputs do not overwrite each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TilePart {
    /// The table.
    Table,
    /// What it sees of tiles nearby.
    Near,
    /// Of which tiles farther away it sees anything.
    Far,
}

impl TilePart {
    /// All parts.
    pub const ALL: [Self; 3] = [Self::Table, Self::Near, Self::Far];

    /// The end of names of its files.
    const fn extension(self) -> &'static str {
        match self {
            Self::Table => "pvz",
            Self::Near => "near",
            Self::Far => "far",
        }
    }
}

/// The tiles of a world that were baked.
#[derive(Debug, Clone, PartialEq)]
pub struct WorldIndex {
    /// How far away what a tile contains is near another.
    pub border: f64,
    /// How far viewers see at most, along each axis; `None`: to the end of the world.
    pub reach: Option<f64>,
    /// The tiles.
    pub tiles: Vec<TileEntry>,
}

/// A tile that was baked.
#[derive(Debug, Clone, PartialEq)]
pub struct TileEntry {
    /// Its name.
    pub name: String,
    /// Where it is.
    pub bounds: TileBounds,
    /// The key of all that decides its table, and what it sees nearby: 16 bytes.
    pub key: [u8; 16],
    /// The key of all that decides which tiles farther away it sees.
    pub far_key: [u8; 16],
    /// Its cells.
    pub n_cells: u32,
    /// Its objects.
    pub n_objects: u32,
}

impl TileEntry {
    /// The name of a file of it in the folder.
    pub fn file_name(&self, part: TilePart) -> String {
        Self::file_name_of(&self.name, part, if part == TilePart::Far { self.far_key } else { self.key })
    }

    /// The name of the file of a tile with a key.
    pub fn file_name_of(name: &str, part: TilePart, key: [u8; 16]) -> String {
        format!("{name}-{:032x}.{}", u128::from_be_bytes(key), part.extension())
    }

    /// Whether a file in the folder has a name that a file of a tile of this name can have.
    pub fn is_file_of(name: &str, file: &str) -> bool {
        let rest = file.strip_prefix(name).and_then(|rest| rest.strip_prefix('-'));
        let key = rest.and_then(|rest| {
            TilePart::ALL.iter().find_map(|part| rest.strip_suffix(part.extension())?.strip_suffix('.'))
        });
        key.is_some_and(|key| key.len() == 32 && key.bytes().all(|byte| byte.is_ascii_hexdigit()))
    }
}

/// The form of the text.
#[derive(Debug, Serialize, Deserialize)]
struct Text {
    sightlines_world: u32,
    border: f64,
    #[serde(default)]
    reach: Option<f64>,
    tiles: Vec<EntryText>,
}

#[derive(Debug, Serialize, Deserialize)]
struct EntryText {
    name: String,
    viewers: BoxText,
    extent: BoxText,
    key: String,
    far_key: String,
    #[serde(rename = "cells")]
    n_cells: u32,
    #[serde(rename = "objects")]
    n_objects: u32,
}

impl EntryText {
    fn checked(self) -> Result<TileEntry, String> {
        let key = |text: &str| {
            let number =
                Some(text).filter(|text| text.len() == 32 && text.bytes().all(|byte| byte.is_ascii_hexdigit()));
            number
                .and_then(|text| u128::from_str_radix(text, 16).ok())
                .map(u128::to_be_bytes)
                .ok_or("a key is not 32 hexadecimal digits")
        };
        let bounds = |text: BoxText| text.checked().ok_or("a box has no room in it");
        let bounds = TileBounds { viewers: bounds(self.viewers)?, extent: bounds(self.extent)? };
        let Self { name, n_cells, n_objects, .. } = self;
        Ok(TileEntry { name, bounds, key: key(&self.key)?, far_key: key(&self.far_key)?, n_cells, n_objects })
    }
}

impl WorldIndex {
    /// Reads an index. O(length).
    ///
    /// # Errors
    /// [`WorldError::Syntax`], [`WorldError::Version`], [`WorldError::Tile`].
    pub fn parse(text: &[u8]) -> Result<Self, WorldError> {
        check_version(text)?;
        let Text { border, reach, tiles, .. } =
            serde_json::from_slice(text).map_err(|error| WorldError::syntax(&error))?;
        check_distances(border, reach)?;
        check_names(tiles.iter().map(|tile| &*tile.name))?;
        let tiles = tiles
            .into_iter()
            .enumerate()
            .map(|(tile, text)| text.checked().map_err(|what| WorldError::Tile { tile, what }));
        Ok(Self { border, reach, tiles: tiles.collect::<Result<_, _>>()? })
    }

    /// The index as text, a line for each tile.
    pub fn to_json(&self) -> String {
        let hex = |key: [u8; 16]| format!("{:032x}", u128::from_be_bytes(key));
        let line = |tile: &TileEntry| {
            let text = EntryText {
                name: tile.name.clone(),
                viewers: (&tile.bounds.viewers).into(),
                extent: (&tile.bounds.extent).into(),
                key: hex(tile.key),
                far_key: hex(tile.far_key),
                n_cells: tile.n_cells,
                n_objects: tile.n_objects,
            };
            format!("    {}", serde_json::to_string(&text).expect("numbers and texts are JSON"))
        };
        let lines: Vec<String> = self.tiles.iter().map(line).collect();
        let [border, reach] =
            [Some(self.border), self.reach].map(|x| serde_json::to_string(&x).expect("a number is JSON"));
        format!(
            "{{\n  \"sightlines_world\": {VERSION},\n  \"border\": {border},\n  \"reach\": {reach},\n  \"tiles\": [\n{}\n  ]\n}}\n",
            lines.join(",\n")
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sightlines_geometry::Aabb;

    #[test]
    fn indices_come_back() {
        let bounds = Aabb { min: [0.1, -1.0 / 3.0, 0.0], max: [1e9, 0.7, 1.0] };
        let tile = |name: &str, key: u8| TileEntry {
            name: name.to_owned(),
            bounds: TileBounds { viewers: bounds, extent: bounds },
            key: [key; 16],
            far_key: [0; 16],
            n_cells: 7,
            n_objects: 0,
        };
        let index = WorldIndex { border: 0.3, reach: Some(0.7), tiles: vec![tile("a", 1), tile("b-c", 255)] };
        let text = index.to_json();
        assert_eq!(WorldIndex::parse(text.as_bytes()).unwrap(), index);
        (0..text.trim_end().len()).for_each(|n| assert!(WorldIndex::parse(&text.as_bytes()[..n]).is_err(), "{n}"));
        let [one, two] = [&index.tiles[0], &index.tiles[1]].map(|tile| tile.file_name(TilePart::Near));
        assert_eq!(one, "a-01010101010101010101010101010101.near");
        assert!(TileEntry::is_file_of("a", &one) && TileEntry::is_file_of("b-c", &two));
        assert!(!TileEntry::is_file_of("b", &two) && !TileEntry::is_file_of("a", "a-01.near"));
        assert!(!TileEntry::is_file_of("a", "a-01010101010101010101010101010101.json"));
    }
}
