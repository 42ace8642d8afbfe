//! The tables of one tile, and what is seen from it.

use crate::error::WorldError;
use crate::index::TilePart;
use crate::near::is_within;
use crate::world::{TileId, TiledWorld};
use sightlines_packed::Packed;
use sightlines_packed::across::{Across, SeenAcross};
use sightlines_pvs::{CellId, ObjectId, Place, PlaceBuffer};
use std::collections::BTreeSet;
use std::error::Error;
use std::fs::File;
use std::path::PathBuf;

/// What an eye may see of a world. Sorted, each once.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Seen {
    /// Cells, tile by tile.
    pub cells: Vec<(TileId, CellId)>,
    /// Objects, tile by tile.
    pub objects: Vec<(TileId, ObjectId)>,
    /// Tiles of which everything may be seen, as nothing is known of their parts.
    pub tiles: Vec<TileId>,
}

impl Seen {
    /// Nothing.
    pub fn clear(&mut self) {
        self.cells.clear();
        self.objects.clear();
        self.tiles.clear();
    }

    /// Everything in a world.
    pub fn set_everything(&mut self, world: &TiledWorld) {
        self.clear();
        self.tiles.extend(world.tiles());
    }

    /// Sorts, and removes what is there twice.
    pub fn sort(&mut self) {
        self.cells.sort_unstable();
        self.cells.dedup();
        self.objects.sort_unstable();
        self.objects.dedup();
        self.tiles.sort_unstable();
        self.tiles.dedup();
    }
}

/// Buffers of queries.
#[derive(Debug, Default)]
pub struct TileScratch {
    place: PlaceBuffer,
    at: Vec<CellId>,
    cells: Vec<CellId>,
    objects: Vec<ObjectId>,
    across: Vec<SeenAcross>,
}

/// The tables of one tile, opened.
#[derive(Debug)]
pub struct TileTables {
    tile: TileId,
    table: Packed<File>,
    near: Across<File>,
    far: Across<File>,
    near_ids: Vec<TileId>,
    far_ids: Vec<TileId>,
    /// Tiles within reach that this one does not know of.
    unknown: Vec<TileId>,
    paths: [PathBuf; 3],
}

impl TileTables {
    /// Opens the files of a tile. At most `cache_bytes` of unpacked blocks of its table are kept.
    ///
    /// # Errors
    /// [`WorldError::File`]; [`WorldError::Mixed`] if the files are not those of the index.
    ///
    /// # Panics
    /// If there is no such tile.
    pub fn load(world: &TiledWorld, tile: TileId, cache_bytes: usize) -> Result<Self, WorldError> {
        let entry = &world.index().tiles[tile.0 as usize];
        let open = |part: TilePart| {
            let path = world.path(tile, part);
            Ok((File::open(&path).map_err(|error| WorldError::file(&path, error))?, path))
        };
        let (file, path) = open(TilePart::Table)?;
        let table = Packed::open(file, cache_bytes).map_err(|error| WorldError::file(&path, error))?;
        let is_of =
            table.info().contains(&TiledWorld::stated(entry.key)) && table.n_objects() == entry.n_objects as usize;
        if !is_of || table.n_cells() != entry.n_cells as usize {
            return Err(WorldError::Mixed { path });
        }
        let across = |part: TilePart| {
            let (file, path) = open(part)?;
            let key = if part == TilePart::Far { entry.far_key } else { entry.key };
            let across = Across::open(file).map_err(|error| WorldError::file(&path, error))?;
            let is_of = across.columns().key == key && across.n_rows() == table.n_cells();
            if is_of { Ok(across) } else { Err(WorldError::Mixed { path }) }
        };
        let (near, far) = (across(TilePart::Near)?, across(TilePart::Far)?);
        Self::new(world, tile, table, near, far).ok_or(WorldError::Mixed { path })
    }

    /// `None` if tiles nearby are not those of the world.
    fn new(
        world: &TiledWorld,
        tile: TileId,
        table: Packed<File>,
        near: Across<File>,
        far: Across<File>,
    ) -> Option<Self> {
        let near_ids = near.columns().near.iter().map(|near| {
            let id = world.named(&near.name)?;
            let entry = world.tile(id)?;
            ((entry.n_cells, entry.n_objects) == (near.n_cells, near.n_objects)).then_some(id)
        });
        let near_ids: Vec<TileId> = near_ids.collect::<Option<_>>()?;
        let far_ids: Vec<TileId> = far.columns().far.iter().map(|name| world.named(name)).collect::<Option<_>>()?;
        let known: BTreeSet<TileId> = near_ids.iter().chain(&far_ids).copied().chain([tile]).collect();
        let viewers = world.tile(tile)?.bounds.viewers;
        let reach = world.index().reach.unwrap_or(f64::INFINITY);
        let is_in_reach =
            |other: TileId| world.tile(other).is_some_and(|other| is_within(&viewers, &other.bounds.extent, reach));
        let unknown = world.tiles().filter(|other| !known.contains(other) && is_in_reach(*other)).collect();
        let paths = TilePart::ALL.map(|part| world.path(tile, part));
        Some(Self { tile, table, near, far, near_ids, far_ids, unknown, paths })
    }

    /// Which tile it is.
    pub fn tile(&self) -> TileId {
        self.tile
    }

    /// The table of its cells and objects.
    pub fn table(&self) -> &Packed<File> {
        &self.table
    }

    /// The tiles nearby.
    pub fn near(&self) -> &[TileId] {
        &self.near_ids
    }

    /// Bytes in memory, about, with all that the table may keep.
    pub fn n_bytes(&self) -> usize {
        let ids = self.near_ids.len() + self.far_ids.len() + self.unknown.len();
        let across = self.near.resident_bytes() + self.far.resident_bytes();
        self.table.resident_bytes() + self.table.cache_bytes() + across + ids * size_of::<TileId>()
    }

    /// Adds what the cells at a point see; returns whether there are any. [`Seen`] is neither cleared nor sorted.
    ///
    /// # Errors
    /// [`WorldError::File`].
    pub fn see(&self, eye: [f64; 3], seen: &mut Seen, scratch: &mut TileScratch) -> Result<bool, WorldError> {
        let place = self.table.cells_at(eye, &mut scratch.place).map_err(|error| self.fail(TilePart::Table, error))?;
        scratch.at.clear();
        if let Place::Inside(cells) = place {
            scratch.at.extend(cells);
        }
        for k in 0..scratch.at.len() {
            self.see_from(scratch.at[k], seen, scratch)?;
        }
        Ok(!scratch.at.is_empty())
    }

    /// Adds what a cell sees.
    ///
    /// # Errors
    /// [`WorldError::File`], also for a cell that there is not.
    pub fn see_from(&self, cell: CellId, seen: &mut Seen, scratch: &mut TileScratch) -> Result<(), WorldError> {
        scratch.across.clear();
        self.near.seen(cell, &mut scratch.across).map_err(|error| self.fail(TilePart::Near, error))?;
        let n_near = scratch.across.len();
        self.far.seen(cell, &mut scratch.across).map_err(|error| self.fail(TilePart::Far, error))?;
        let (of_near, of_far) = scratch.across.split_at(n_near);
        for part in of_near {
            match part {
                SeenAcross::Cells(k, cells) => {
                    seen.cells.extend(cells.clone().map(|cell| (self.near_ids[*k], CellId(cell))));
                }
                SeenAcross::Objects(k, objects) => {
                    seen.objects.extend(objects.clone().map(|object| (self.near_ids[*k], ObjectId(object))));
                }
                SeenAcross::Tile(_) => {}
            }
        }
        for part in of_far {
            if let SeenAcross::Tile(k) = part {
                seen.tiles.push(self.far_ids[*k]);
            }
        }
        seen.tiles.extend(&self.unknown);
        self.table.visible(cell, &mut scratch.cells).map_err(|error| self.fail(TilePart::Table, error))?;
        seen.cells.extend(scratch.cells.iter().map(|&cell| (self.tile, cell)));
        self.table.objects_seen(cell, &mut scratch.objects).map_err(|error| self.fail(TilePart::Table, error))?;
        seen.objects.extend(scratch.objects.iter().map(|&object| (self.tile, object)));
        Ok(())
    }

    /// Reads everything.
    ///
    /// # Errors
    /// [`WorldError`] for the first damage.
    pub fn verify(&self) -> Result<(), WorldError> {
        self.table.verify().map_err(|error| self.fail(TilePart::Table, error))?;
        self.near.verify().map_err(|error| self.fail(TilePart::Near, error))?;
        self.far.verify().map_err(|error| self.fail(TilePart::Far, error))
    }

    fn fail(&self, part: TilePart, error: impl Into<Box<dyn Error + Send + Sync>>) -> WorldError {
        WorldError::file(&self.paths[part as usize], error)
    }
}
