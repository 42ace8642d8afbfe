//! Tables of both kinds, plain and packed, for the commands that follow a viewer.

use crate::error::{ErrorAbout, Result};
use crate::input;
use crate::output::{JsonSchema, Serialize};
use sightlines::eye_to_cell::{CellSource, TableCells};
use sightlines::formats::InputKind;
use sightlines::packed::{Packed, PackedError, SizeClass};
use sightlines::pvs::{Axis, CellId, DoorRecord, ObjectId, ObjectSource, Table};
use sightlines::walkthrough::{CoarseVisibility, PackedCells};
use std::convert::Infallible;
use std::error::Error;
use std::fs::File;
use std::path::Path;
use std::sync::Arc;

/// A table that was opened, recognized by its first bytes.
#[derive(Debug)]
pub(crate) enum Opened {
    Plain(TableCells<Arc<Table>>),
    Packed(PackedCells<File>),
}

impl Opened {
    /// How it was made, by keys.
    pub(crate) fn info(&self) -> &[(String, String)] {
        match self {
            Self::Plain(cells) => cells.table().info(),
            Self::Packed(cells) => cells.packed().info(),
        }
    }
}

/// Opens a table. Of a packed one, at most `cache_bytes` of unpacked blocks are kept.
pub(crate) fn open(path: &Path, cache_bytes: usize) -> Result<Opened> {
    if input::kind_of(path)? == Some(InputKind::Packed) {
        return Ok(Opened::Packed(PackedCells::new(packed(path, cache_bytes)?)));
    }
    Ok(Opened::Plain(TableCells::new(Arc::new(input::table(path)?))))
}

/// Opens a packed table.
pub(crate) fn packed(path: &Path, cache_bytes: usize) -> Result<Packed<File>> {
    let file = File::open(path).in_file(path)?;
    Packed::open(file, cache_bytes).in_file(path)
}

/// Bytes of blocks of a packed table that are kept while it is unpacked, or asked again and again.
pub(crate) const CACHE: usize = 64 << 20;

/// Reads a table of either kind.
pub(crate) fn read(path: &Path) -> Result<Table> {
    match input::kind_of(path)? {
        Some(InputKind::Packed) => packed(path, CACHE)?.to_table().in_file(path),
        _ => input::table(path),
    }
}

/// The class of a file, on a command line and in answers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Class {
    Small,
    Large,
}

impl Class {
    pub(crate) fn of(class: SizeClass) -> Self {
        match class {
            SizeClass::Small => Self::Small,
            SizeClass::Large => Self::Large,
        }
    }

    pub(crate) fn size_class(self) -> SizeClass {
        match self {
            Self::Small => SizeClass::Small,
            Self::Large => SizeClass::Large,
        }
    }
}

/// A table of either kind. Clones share it.
pub(crate) trait Cells:
    CellSource<Error: Error + Send + Sync + 'static>
    + CoarseVisibility<PlaceError = <Self as CellSource>::Error>
    + Clone
    + Send
    + 'static
{
    /// The axis that points up, if it is known.
    fn up(&self) -> Option<Axis>;

    /// Whether cells can be found at points.
    fn has_places(&self) -> bool;

    fn n_portals(&self) -> usize;

    fn doors(&self) -> &[DoorRecord];

    fn object_name(&self, object: ObjectId) -> Result<String, Self::Error>;

    /// Where an object is in the file that the table was made of; `None` if that is not known.
    fn source_of(&self, object: ObjectId) -> Result<Option<ObjectSource>, Self::Error>;

    /// `None` if the cells of the table have no names.
    fn cell_name(&self, cell: CellId) -> Result<Option<String>, Self::Error>;

    fn polygons_of(&self, object: ObjectId) -> Result<u32, Self::Error>;

    /// Bytes that stay in memory, and bytes of the blocks that are kept now; `None` for a table that is wholly in memory.
    fn bytes_in_memory(&self) -> Option<(usize, usize)>;

    /// Refuses a table that does not store where its cells are.
    fn refuse_without_places(&self, path: &Path) -> Result<()> {
        if self.has_places() { Ok(()) } else { Err(input::no_places(path, "no cell can be found at a point")) }
    }

    /// 2 or 3.
    fn n_dimensions(&self) -> u8 {
        CellSource::dimension(self)
    }

    /// Numbers of cells and of objects.
    fn counts(&self) -> [usize; 2] {
        [CellSource::n_cells(self), CellSource::n_objects(self)]
    }
}

impl Cells for TableCells<Arc<Table>> {
    fn up(&self) -> Option<Axis> {
        self.table().up()
    }

    fn has_places(&self) -> bool {
        self.table().has_places()
    }

    fn n_portals(&self) -> usize {
        self.table().portals().len()
    }

    fn doors(&self) -> &[DoorRecord] {
        self.table().doors()
    }

    fn source_of(&self, object: ObjectId) -> Result<Option<ObjectSource>, Infallible> {
        Ok(self.table().source_of(object))
    }

    fn object_name(&self, object: ObjectId) -> Result<String, Infallible> {
        Ok(self.table().objects()[object.idx()].name.clone())
    }

    fn cell_name(&self, cell: CellId) -> Result<Option<String>, Infallible> {
        Ok(self.table().cell_name(cell).map(str::to_owned))
    }

    fn polygons_of(&self, object: ObjectId) -> Result<u32, Infallible> {
        Ok(self.table().polygons_of(object))
    }

    fn bytes_in_memory(&self) -> Option<(usize, usize)> {
        None
    }
}

impl Cells for PackedCells<File> {
    fn up(&self) -> Option<Axis> {
        self.packed().up()
    }

    fn has_places(&self) -> bool {
        self.packed().has_places()
    }

    fn n_portals(&self) -> usize {
        self.packed().n_portals()
    }

    fn doors(&self) -> &[DoorRecord] {
        self.packed().doors()
    }

    fn source_of(&self, object: ObjectId) -> Result<Option<ObjectSource>, PackedError> {
        self.packed().source_of(object)
    }

    fn object_name(&self, object: ObjectId) -> Result<String, PackedError> {
        self.packed().object_name(object)
    }

    fn cell_name(&self, cell: CellId) -> Result<Option<String>, PackedError> {
        self.packed().cell_name(cell)
    }

    fn polygons_of(&self, object: ObjectId) -> Result<u32, PackedError> {
        self.packed().object_polygons(object)
    }

    fn bytes_in_memory(&self) -> Option<(usize, usize)> {
        Some((self.packed().resident_bytes(), self.packed().bytes_in_use()))
    }
}
