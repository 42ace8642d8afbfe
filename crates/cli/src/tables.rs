//! Tables of both kinds, plain and packed, for the commands that follow a viewer.

use crate::error::{ErrorAbout, Result};
use crate::input;
use crate::named::one_of;
use clap::builder::TypedValueParser;
use sightlines::eye_to_cell::{CellSource, TableCells};
use sightlines::formats::InputKind;
use sightlines::packed::{Packed, SizeClass};
use sightlines::pvs::Table;
use sightlines::walkthrough::{CoarseVisibility, PackedCells, TableFacts};
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

pub(crate) fn read(path: &Path) -> Result<Table> {
    match input::kind_of(path)? {
        Some(InputKind::Packed) => packed(path, CACHE)?.to_table().in_file(path),
        _ => input::table(path),
    }
}

pub(crate) fn size_class() -> impl TypedValueParser<Value = SizeClass> {
    one_of(&SizeClass::ALL, SizeClass::name, |_| "")
}

/// A table of either kind. Clones share it.
pub(crate) trait Cells:
    TableFacts<Error: Error + Send + Sync + 'static>
    + CoarseVisibility<PlaceError = <Self as CellSource>::Error>
    + Clone
    + Send
    + 'static
{
    /// Refuses a table that does not store where its cells are.
    fn refuse_without_places(&self, path: &Path) -> Result<()> {
        if self.has_places() { Ok(()) } else { Err(input::no_places(path, "no cell can be found at a point")) }
    }

    /// 2 or 3.
    fn n_dimensions(&self) -> u8 {
        CellSource::dimension(self)
    }

    fn counts(&self) -> [usize; 2] {
        [CellSource::n_cells(self), CellSource::n_objects(self)]
    }
}

impl Cells for TableCells<Arc<Table>> {}

impl Cells for PackedCells<File> {}
