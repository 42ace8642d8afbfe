//! Visibility tables as assets.

use crate::follow::{Follow, Follower};
use bevy::asset::io::Reader;
use bevy::asset::{AssetLoader, LoadContext};
use bevy::prelude::*;
use sightlines_eye_to_cell::TableCells;
use sightlines_pvs::{CellId, DecodeError, DoorRecord, Frame, ObjectId, Place, PlaceBuffer, PortalId, Table};
use sightlines_walkthrough::WalkOptions;
use std::sync::Arc;

#[cfg(feature = "packed")]
use sightlines_packed::{ByteSource, Packed, PackedError};
#[cfg(feature = "packed")]
use sightlines_walkthrough::{CellBoxes, PackedCells};

/// A visibility table: which parts of a level can be seen from where.
///
/// Files are loaded as any asset: `.pvs`, and with the feature `packed` also `.pvz`.
#[derive(Asset, TypePath, Debug, Clone)]
pub struct PvsTable {
    form: Form,
}

#[derive(Debug, Clone)]
enum Form {
    Plain(Arc<Table>),
    #[cfg(feature = "packed")]
    Packed {
        cells: PackedCells<PackedBytes>,
        boxes: Arc<CellBoxes>,
    },
}

/// The name and the box of an object of a table, along the axes of the table.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct TableObject {
    pub(crate) name: String,
    /// Its node and primitive, if that is known.
    pub(crate) source: Option<(u32, u32)>,
    pub(crate) min: [f64; 3],
    pub(crate) max: [f64; 3],
}

/// Why a table could not be read. Bevy reports it with the path of the asset.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PvsLoadError {
    /// The file could not be read.
    #[error("{asset}: cannot be read")]
    Read {
        /// The path of the asset.
        asset: String,
        /// Why.
        source: std::io::Error,
    },
    /// It is no table, or a damaged one.
    #[error("{asset}: no visibility table")]
    Table {
        /// The path of the asset.
        asset: String,
        /// What is wrong, and where.
        source: Box<DecodeError>,
    },
    /// It is no packed table, or a damaged one.
    #[cfg(feature = "packed")]
    #[error("{asset}: no packed visibility table")]
    Packed {
        /// The path of the asset.
        asset: String,
        /// What is wrong, and where.
        source: Box<PackedError>,
    },
    /// A table of the plane: cameras are in space.
    #[error("{asset}: a table of the plane, not of space")]
    Plane {
        /// The path of the asset.
        asset: String,
    },
}

impl PvsTable {
    /// The same as the file of a table would give.
    pub fn new(table: Table) -> Self {
        Self { form: Form::Plain(Arc::new(table)) }
    }

    /// A packed table that is read piece by piece: from an opened file, for example. At most `cache_bytes` of unpacked blocks are
    /// kept in memory. Reads the boxes of all cells at once, O(cells).
    ///
    /// A camera whose surroundings have not been read yet draws more than it has to for some frames, and never less.
    ///
    /// # Errors
    /// [`PackedError`], with section and byte offset.
    #[cfg(feature = "packed")]
    pub fn packed(source: impl ByteSource + 'static, cache_bytes: usize) -> Result<Self, PackedError> {
        let cells = PackedCells::new(Packed::open(PackedBytes(Box::new(source)), cache_bytes)?);
        let boxes = Arc::new(CellBoxes::read(&cells)?);
        Ok(Self { form: Form::Packed { cells, boxes } })
    }

    /// The table, if it is not a packed one.
    pub fn table(&self) -> Option<&Arc<Table>> {
        match &self.form {
            Form::Plain(table) => Some(table),
            #[cfg(feature = "packed")]
            Form::Packed { .. } => None,
        }
    }

    /// Whether something at `to` may be seen by an eye at `from`, both in the coordinates of the scene as its file has them: for what
    /// thinks, sounds or is sent over a network. Errs towards `true`; outside every cell nothing is known, and the answer is `true`.
    /// Knows nothing of doors. Allocates; O(log cells), for a packed table perhaps a read.
    pub fn may_see(&self, from: [f64; 3], to: [f64; 3]) -> bool {
        let (mut eye, mut place) = (PlaceBuffer::new(), PlaceBuffer::new());
        let (Place::Inside(eye), Place::Inside(place)) = (self.cells_at(from, &mut eye), self.cells_at(to, &mut place))
        else {
            return true;
        };
        eye.iter().any(|&cell| match &self.form {
            Form::Plain(table) => place.iter().any(|&other| table.sees(cell, other)),
            #[cfg(feature = "packed")]
            Form::Packed { cells, .. } => {
                let mut seen = Vec::new();
                cells.packed().visible(cell, &mut seen).is_err() || place.iter().any(|other| seen.contains(other))
            }
        })
    }

    /// The cells at a point of the scene; outside where they cannot be read, which hides nothing.
    pub(crate) fn cells_at<'b>(&self, point: [f64; 3], buffer: &'b mut PlaceBuffer) -> Place<&'b [CellId]> {
        match &self.form {
            Form::Plain(table) => table.cells_at(point, buffer),
            #[cfg(feature = "packed")]
            Form::Packed { cells, .. } => cells.packed().cells_at(point, buffer).unwrap_or(Place::Outside),
        }
    }

    /// Puts the cells that `cell` may see into `out`; all of them where they cannot be read.
    pub(crate) fn visible(&self, cell: CellId, out: &mut Vec<CellId>) {
        out.clear();
        match &self.form {
            Form::Plain(table) => out.extend(table.visible(cell)),
            #[cfg(feature = "packed")]
            Form::Packed { cells, .. } => {
                if cells.packed().visible(cell, out).is_err() {
                    out.clear();
                    out.extend((0..cells.packed().n_cells() as u32).map(CellId));
                }
            }
        }
    }

    /// Number of cells.
    pub fn n_cells(&self) -> usize {
        match &self.form {
            Form::Plain(table) => table.n_cells(),
            #[cfg(feature = "packed")]
            Form::Packed { cells, .. } => cells.packed().n_cells(),
        }
    }

    /// Number of objects.
    pub fn n_objects(&self) -> usize {
        match &self.form {
            Form::Plain(table) => table.objects().len(),
            #[cfg(feature = "packed")]
            Form::Packed { cells, .. } => cells.packed().n_objects(),
        }
    }

    /// The axes along which the coordinates of the table are, if they are not those of the scene.
    pub(crate) fn frame(&self) -> Option<&Frame> {
        match &self.form {
            Form::Plain(table) => table.frame(),
            #[cfg(feature = "packed")]
            Form::Packed { cells, .. } => cells.packed().frame(),
        }
    }

    /// Whether the table was made for engines that draw the backs of single-sided faces (`--backs drawn`): then such faces hide from both sides.
    pub(crate) fn takes_backs_to_be_drawn(&self) -> bool {
        let info = match &self.form {
            Form::Plain(table) => table.info(),
            #[cfg(feature = "packed")]
            Form::Packed { cells, .. } => cells.packed().info(),
        };
        info.iter().any(|(key, value)| key == "backs" && value == "drawn")
    }

    /// All objects, by id. For a packed table this reads them all.
    ///
    /// # Errors
    /// What cannot be read, as text.
    pub(crate) fn objects(&self) -> Result<Vec<TableObject>, String> {
        match &self.form {
            Form::Plain(table) => Ok((0..)
                .map(ObjectId)
                .zip(table.objects())
                .map(|(id, object)| {
                    let source = table.source_of(id).map(|source| (source.node, source.primitive));
                    TableObject { name: object.name.clone(), source, min: object.min, max: object.max }
                })
                .collect()),
            #[cfg(feature = "packed")]
            Form::Packed { cells, .. } => (0..cells.packed().n_objects() as u32)
                .map(|object| {
                    let (table, object) = (cells.packed(), ObjectId(object));
                    let (min, max) = table.object_box(object)?;
                    let source = table.source_of(object)?.map(|source| (source.node, source.primitive));
                    Ok(TableObject { name: table.object_name(object)?, source, min, max })
                })
                .collect::<Result<_, PackedError>>()
                .map_err(|error| error.to_string()),
        }
    }

    /// For each object whether it touches a cell. What touches none is never seen from a cell, and not known to be hidden either.
    ///
    /// # Errors
    /// What cannot be read, as text.
    pub(crate) fn in_cells(&self) -> Result<Vec<bool>, String> {
        let mut found = vec![false; self.n_objects()];
        let mut note = |objects: &[ObjectId]| objects.iter().for_each(|object| found[object.idx()] = true);
        match &self.form {
            Form::Plain(table) => (0..table.n_cells() as u32).for_each(|cell| note(table.objects_of(CellId(cell)))),
            #[cfg(feature = "packed")]
            Form::Packed { cells, .. } => {
                let mut objects = Vec::new();
                for cell in (0..cells.packed().n_cells() as u32).map(CellId) {
                    cells.packed().objects_of(cell, &mut objects).map_err(|error| error.to_string())?;
                    note(&objects);
                }
            }
        }
        Ok(found)
    }

    /// Calls `show` with the corners of every portal, along the axes of the table.
    ///
    /// # Errors
    /// What cannot be read, as text.
    #[cfg(feature = "gizmos")]
    pub(crate) fn for_each_portal(&self, mut show: impl FnMut(PortalId, &[[f64; 3]])) -> Result<(), String> {
        match &self.form {
            Form::Plain(table) => {
                (0..).zip(table.portals()).for_each(|(id, portal)| show(PortalId(id), &portal.points));
                Ok(())
            }
            #[cfg(feature = "packed")]
            Form::Packed { cells, .. } => {
                for id in (0..cells.packed().n_portals() as u32).map(PortalId) {
                    show(id, &cells.packed().portal(id).map_err(|error| error.to_string())?.points);
                }
                Ok(())
            }
        }
    }

    /// The portals that lie within a box of the scene, ascending; none where they cannot be read. O(portals).
    pub fn portals_within(&self, min: [f64; 3], max: [f64; 3]) -> Vec<PortalId> {
        match &self.form {
            Form::Plain(table) => table.portals_within(min, max),
            #[cfg(feature = "packed")]
            Form::Packed { cells, .. } => cells.packed().portals_within(min, max).unwrap_or_default(),
        }
    }

    /// The doors of the table: names, and the portals that each closes.
    pub fn doors(&self) -> &[DoorRecord] {
        match &self.form {
            Form::Plain(table) => table.doors(),
            #[cfg(feature = "packed")]
            Form::Packed { cells, .. } => cells.packed().doors(),
        }
    }

    /// The box of a cell, along the axes of the table; `None` where it cannot be read.
    #[cfg(feature = "gizmos")]
    pub(crate) fn cell_box(&self, cell: CellId) -> Option<([f64; 3], [f64; 3])> {
        match &self.form {
            Form::Plain(table) => table.cells().get(cell.idx()).map(|cell| (cell.min, cell.max)),
            #[cfg(feature = "packed")]
            Form::Packed { cells, .. } => cells.packed().cell_box(cell).ok(),
        }
    }

    /// Follows a camera through the table.
    pub(crate) fn follow(&self, options: WalkOptions) -> Box<dyn Follow> {
        match &self.form {
            Form::Plain(table) => {
                let cells = Arc::new(TableCells::new(Arc::clone(table)));
                Box::new(Follower::new(Arc::clone(&cells), TableCells::clone(&cells), cells, options))
            }
            #[cfg(feature = "packed")]
            Form::Packed { cells, boxes } => {
                Box::new(Follower::new(cells.clone(), cells.clone(), Arc::clone(boxes), options))
            }
        }
    }
}

/// The bytes of a packed table, wherever they are.
#[cfg(feature = "packed")]
pub(crate) struct PackedBytes(Box<dyn ByteSource>);

#[cfg(feature = "packed")]
impl std::fmt::Debug for PackedBytes {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("PackedBytes")
    }
}

#[cfg(feature = "packed")]
impl ByteSource for PackedBytes {
    fn len(&self) -> std::io::Result<u64> {
        self.0.len()
    }

    fn read_at(&self, offset: u64, buf: &mut [u8]) -> std::io::Result<()> {
        self.0.read_at(offset, buf)
    }
}

/// Reads `.pvs` files.
#[derive(Debug, Clone, Copy, Default, TypePath)]
pub struct PvsLoader;

async fn bytes_of(reader: &mut dyn Reader, asset: &str) -> Result<Vec<u8>, PvsLoadError> {
    let mut bytes = Vec::new();
    let read = reader.read_to_end(&mut bytes).await;
    read.map_err(|source| PvsLoadError::Read { asset: asset.to_owned(), source })?;
    Ok(bytes)
}

impl AssetLoader for PvsLoader {
    type Asset = PvsTable;
    type Settings = ();
    type Error = PvsLoadError;

    async fn load(
        &self,
        reader: &mut dyn Reader,
        (): &(),
        context: &mut LoadContext<'_>,
    ) -> Result<PvsTable, PvsLoadError> {
        let asset = context.path().to_string();
        let bytes = bytes_of(reader, &asset).await?;
        match Table::from_bytes(&bytes) {
            Ok(table) if table.dimension() != 3 => Err(PvsLoadError::Plane { asset }),
            Ok(table) => Ok(PvsTable::new(table)),
            Err(source) => Err(PvsLoadError::Table { asset, source: Box::new(source) }),
        }
    }

    fn extensions(&self) -> &[&str] {
        &["pvs"]
    }
}

/// Reads `.pvz` files. The file stays in memory as it is; [`PvsTable::packed`] reads one from a disk instead.
#[cfg(feature = "packed")]
#[derive(Debug, Clone, Copy, Default, TypePath)]
pub struct PackedPvsLoader;

/// How a packed table is read.
#[cfg(feature = "packed")]
#[derive(Debug, Clone, Copy, serde::Serialize, serde::Deserialize)]
pub struct PackedPvsSettings {
    /// At most so many bytes of unpacked blocks are kept.
    pub cache_bytes: usize,
}

#[cfg(feature = "packed")]
impl Default for PackedPvsSettings {
    fn default() -> Self {
        Self { cache_bytes: 16 << 20 }
    }
}

#[cfg(feature = "packed")]
impl AssetLoader for PackedPvsLoader {
    type Asset = PvsTable;
    type Settings = PackedPvsSettings;
    type Error = PvsLoadError;

    async fn load(
        &self,
        reader: &mut dyn Reader,
        settings: &PackedPvsSettings,
        context: &mut LoadContext<'_>,
    ) -> Result<PvsTable, PvsLoadError> {
        let asset = context.path().to_string();
        let bytes = bytes_of(reader, &asset).await?;
        match PvsTable::packed(bytes, settings.cache_bytes) {
            Ok(PvsTable { form: Form::Packed { cells, .. } }) if cells.packed().dimension() != 3 => {
                Err(PvsLoadError::Plane { asset })
            }
            Ok(table) => Ok(table),
            Err(source) => Err(PvsLoadError::Packed { asset, source: Box::new(source) }),
        }
    }

    fn extensions(&self) -> &[&str] {
        &["pvz"]
    }
}
