//! Which format a file has, and what it holds, in one place.
//!
//! [`FORMATS`] lists what is read: names, endings, how it is recognised, reader. [`detect`] returns the format of bytes with a
//! name, [`detect_file`] that of a file, and [`Source::read`] reads it. A new format is a module with a reader, one line
//! in that list, and a sample in its test.
//!
//! ```
//! use sightlines_formats::input::{Input, Source, detect};
//!
//! let text = br#"{"type": "LineString", "coordinates": [[0, 0], [4, 0]]}"#;
//! assert_eq!(detect("walls.json".as_ref(), text).unwrap().name, "geojson");
//! let walls = Source::Memory { name: "walls.json".as_ref(), bytes: text, beside: None };
//! let Some(Input::Plan(file)) = walls.read().unwrap() else { panic!("a plan") };
//! assert_eq!(file.plan.lines().len(), 1);
//! ```

mod format;
mod members;
mod registry;

pub use crate::beside::{Folder, Neighbours};
pub use format::{Format, InputKind, Sign};
pub use registry::{FORMATS, detect, titles};

use crate::error::{ReadErrorKind, in_file};
use crate::quake::prt::parse_prt;
use crate::quake::{Bsp, Prt, portals_beside};
use crate::{LevelsIndex, PlanFile, PlanReadOptions, ReadError, SceneFile, ViewCells, Wad, dxf, geojson};
use sightlines_pvs::Table;
use std::borrow::Cow;
use std::fs::{self, File};
use std::io::{ErrorKind, Read};
use std::path::Path;

/// As many bytes from the beginning of a file [`detect`] looks at.
pub const HEAD: usize = 4096;

/// What a file holds.
#[derive(Debug)]
#[non_exhaustive]
#[expect(clippy::large_enum_variant, reason = "there is one for each file that is read")]
pub enum Input {
    /// A scene in the plane.
    Plan(PlanFile),
    /// The maps of a Doom game; [`choose_map`](crate::doom::choose_map) picks one.
    Wad(Wad),
    /// A scene in space.
    Scene(SceneFile),
    /// The clusters of a Quake map, without the map.
    Prt(Prt),
    /// A Quake map, without its portals; those are beside it, see [`portals_beside`].
    Bsp(Bsp),
    /// A visibility table.
    Table(Box<Table>),
    /// A packed table, which `sightlines-packed` opens and reads piece by piece.
    Packed,
    /// Proofs of a table, which `sightlines-certificates` reads.
    Proofs,
    /// Boxes where viewers can be.
    ViewCells(ViewCells),
    /// Simplified variants of a scene.
    Levels(LevelsIndex),
}

/// Where an input comes from.
#[derive(Debug, Clone, Copy)]
pub enum Source<'a> {
    /// A file. Other files that it names are read from its folder.
    File(&'a Path),
    /// Bytes in memory.
    Memory {
        /// The name that the bytes would have as a file; only its ending matters.
        name: &'a Path,
        /// The bytes.
        bytes: &'a [u8],
        /// Reads other files that these name; without it, they are refused.
        beside: Option<&'a dyn Neighbours>,
    },
}

impl<'a> Source<'a> {
    /// Reads the input in the format that it is recognised as; `None` if no format recognises it.
    ///
    /// # Errors
    /// [`ReadError`] with the name and the place in the file.
    pub fn read(&self) -> Result<Option<Input>, ReadError> {
        let format = match *self {
            Self::File(path) => detect_file(path)?,
            Self::Memory { name, bytes, .. } => detect(name, bytes),
        };
        format.map(|format| self.read_as(format)).transpose()
    }

    /// Reads the input as `format`, whatever it is.
    ///
    /// # Errors
    /// As [`Source::read`].
    pub fn read_as(&self, format: &Format) -> Result<Input, ReadError> {
        (format.read)(self).map_err(|kind| ReadError::new(self.name(), kind))
    }

    /// The portals of a Quake map: those of the portal file beside it; `None` if there is none.
    ///
    /// # Errors
    /// [`ReadError`] with the name of the portal file and the place in it.
    pub fn portals(&self) -> Result<Option<Prt>, ReadError> {
        let path = portals_beside(self.name());
        let name = Path::new(path.file_name().unwrap_or_default());
        let found = match *self {
            Self::File(map) => Folder::of(map).read(name),
            Self::Memory { beside: Some(beside), .. } => beside.read(name),
            Self::Memory { beside: None, .. } => Ok(None),
        };
        match found {
            Ok(bytes) => bytes.map(|b| parse_prt(&b).map_err(|error| ReadError::new(&path, error))).transpose(),
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
            Err(error) => Err(ReadError::new(&path, error)),
        }
    }

    /// The name of the input.
    pub fn name(&self) -> &'a Path {
        match *self {
            Self::File(path) | Self::Memory { name: path, .. } => path,
        }
    }

    pub(crate) fn bytes(&self) -> Result<Cow<'a, [u8]>, ReadErrorKind> {
        match *self {
            Self::File(path) => Ok(Cow::Owned(fs::read(path)?)),
            Self::Memory { bytes, .. } => Ok(Cow::Borrowed(bytes)),
        }
    }
}

/// The format of a file; `None` if no format recognises it. Reads at most [`HEAD`] bytes.
///
/// # Errors
/// [`ReadError`] if the file cannot be opened or read.
pub fn detect_file(path: impl AsRef<Path>) -> Result<Option<&'static Format>, ReadError> {
    let path = path.as_ref();
    let mut head = Vec::new();
    let read = File::open(path).and_then(|file| file.take(HEAD as u64).read_to_end(&mut head));
    read.map_err(|error| ReadError::new(path, error))?;
    Ok(detect(path, &head))
}

/// Reads a plan from a file of any format of plans; GeoJSON if no format recognises it.
///
/// # Errors
/// [`ReadError`] with the file and what is wrong.
pub fn read_plan_file(path: impl AsRef<Path>, options: &PlanReadOptions) -> Result<PlanFile, ReadError> {
    let path = path.as_ref();
    match detect_file(path)? {
        Some(format) if format.name == "dxf" => {
            in_file(path, || Ok(dxf::parse_dxf(&Source::File(path).bytes()?, options)?))
        }
        Some(format) if format.kind == InputKind::Plan => match Source::File(path).read_as(format)? {
            Input::Plan(file) => Ok(file),
            _ => geojson::read_plan_file(path),
        },
        _ => geojson::read_plan_file(path),
    }
}
