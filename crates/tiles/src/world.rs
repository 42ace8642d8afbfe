//! A baked world in a folder.

use crate::error::WorldError;
use crate::index::{INDEX_NAME, TileEntry, TilePart, WorldIndex};
use sightlines_geometry::{Aabb, BoxTree};
use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};

/// A tile, by its place in the index.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct TileId(pub u32);

/// The key under which the information of a table has that of the bake.
pub(crate) const KEY: &str = "tile";

/// A baked world: its index is in memory, tables are opened tile by tile.
#[derive(Debug)]
pub struct TiledWorld {
    folder: PathBuf,
    index: WorldIndex,
    by_name: HashMap<String, TileId>,
    /// Of the boxes of viewers.
    tree: BoxTree<3>,
}

impl TiledWorld {
    /// The name, and the value, of what the information of the table of a tile states: from which bake it is.
    pub fn stated(key: [u8; 16]) -> (String, String) {
        (KEY.to_owned(), format!("{:032x}", u128::from_be_bytes(key)))
    }

    /// Opens a folder that was baked. Memory in proportion to the index.
    ///
    /// # Errors
    /// [`WorldError::File`], and those of [`WorldIndex::parse`].
    pub fn open(folder: &Path) -> Result<Self, WorldError> {
        let path = folder.join(INDEX_NAME);
        let text = fs::read(&path).map_err(|error| WorldError::file(&path, error))?;
        let index = WorldIndex::parse(&text)?;
        let viewers: Vec<Aabb<3>> = index.tiles.iter().map(|tile| tile.bounds.viewers).collect();
        let by_name = (0..).zip(&index.tiles).map(|(k, tile)| (tile.name.clone(), TileId(k))).collect();
        Ok(Self { folder: folder.to_owned(), by_name, tree: BoxTree::build(&viewers, 4), index })
    }

    /// The index.
    pub fn index(&self) -> &WorldIndex {
        &self.index
    }

    /// What the index states of a tile.
    pub fn tile(&self, tile: TileId) -> Option<&TileEntry> {
        self.index.tiles.get(tile.0 as usize)
    }

    /// The tile of a name.
    pub fn named(&self, name: &str) -> Option<TileId> {
        self.by_name.get(name).copied()
    }

    /// All tiles.
    pub fn tiles(&self) -> impl Iterator<Item = TileId> + use<> {
        (0..self.index.tiles.len() as u32).map(TileId)
    }

    /// The tiles whose viewers can be at a point, borders included; ascending.
    pub fn tiles_at(&self, eye: [f64; 3], out: &mut Vec<TileId>) {
        out.clear();
        self.tree.visit(
            |b| b.contains(eye),
            |tile| {
                if self.index.tiles[tile as usize].bounds.viewers.contains(eye) {
                    out.push(TileId(tile));
                }
            },
        );
        out.sort_unstable();
    }

    /// Calls `show` with tiles whose viewers are at most so far from a point along each axis, in any order.
    pub(crate) fn visit_within(&self, eye: [f64; 3], distance: f64, mut show: impl FnMut(TileId)) {
        let near = |b: &Aabb<3>| (0..3).all(|k| b.min[k] - distance <= eye[k] && eye[k] <= b.max[k] + distance);
        self.tree.visit(near, |tile| {
            if near(&self.index.tiles[tile as usize].bounds.viewers) {
                show(TileId(tile));
            }
        });
    }

    /// The path of a file of a tile.
    pub(crate) fn path(&self, tile: TileId, part: TilePart) -> PathBuf {
        self.folder.join(self.index.tiles[tile.0 as usize].file_name(part))
    }
}
