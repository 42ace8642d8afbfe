//! The WAD container: a header, lumps, and a directory of their places and names.
//!
//! All numbers are little-endian. Header: 4 letters `IWAD` or `PWAD`, i32 number of lumps, i32 place of
//! the directory. Directory entry: i32 place, i32 size, 8 bytes of name. What lumps contain is out
//! of scope here.

mod builder;
mod rewrite;

pub use builder::WadBuilder;
pub use rewrite::Edit;

use crate::ReadError;
use crate::bytes::{bytes_at, i32_at};
use crate::error::{Malformed, in_file, malformed};
use std::fmt;
use std::fs::File;
use std::io::Read;
use std::ops::Range;
use std::path::Path;

pub(crate) const HEADER_LEN: usize = 12;
pub(crate) const ENTRY_LEN: usize = 16;

/// The kind of a WAD.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WadKind {
    /// A whole game: `IWAD`.
    Game,
    /// A patch to one: `PWAD`.
    Patch,
}

impl WadKind {
    pub(crate) const fn magic(self) -> [u8; 4] {
        match self {
            Self::Game => *b"IWAD",
            Self::Patch => *b"PWAD",
        }
    }
}

/// One entry of the directory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Lump {
    /// Its name.
    pub name: LumpName,
    /// Its bytes in the file; empty wherever an empty lump claims to be.
    range: (u32, u32),
    is_lost: bool,
}

impl Lump {
    /// Where its bytes are in the file.
    pub fn range(&self) -> Range<usize> {
        self.range.0 as usize..self.range.1 as usize
    }

    /// Whether it is a REJECT lump whose entry names bytes that cannot be its own, such as those past the end of the file. It has none.
    pub fn is_lost(&self) -> bool {
        self.is_lost
    }

    /// Number of bytes.
    pub fn size(&self) -> usize {
        self.range().len()
    }
}

/// A WAD in memory, checked: every lump is inside the file, and no two overlap in part.
///
/// Several entries may name exactly the same bytes, as tools that save space write them. Entries of
/// size 0 may claim any place. REJECT lumps that start at one place may differ in size, because one
/// node builder lets all tables of zeros share their bytes; one that is nowhere counts as empty ([`Lump::is_lost`]), as it will be replaced.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Wad {
    bytes: Vec<u8>,
    kind: WadKind,
    lumps: Vec<Lump>,
}

impl Wad {
    /// Checks a whole WAD. O(n log n) for n lumps; memory for what is really there.
    ///
    /// # Errors
    /// [`Malformed`] with the lumps concerned.
    pub fn parse(bytes: Vec<u8>) -> Result<Self, Malformed> {
        let header = Header::parse(&bytes, bytes.len() as u64)?;
        let directory = header.directory();
        let lumps = bytes[directory.clone()]
            .chunks_exact(ENTRY_LEN)
            .enumerate()
            .map(|(index, entry)| {
                let name = LumpName::from_raw(bytes_at(entry, 8));
                match parse_entry((index, name), entry, bytes.len(), &directory) {
                    Err(_) if name.is("REJECT") => Ok(Lump { name, range: (0, 0), is_lost: true }),
                    found => found.map(|range| Lump { name, range, is_lost: false }),
                }
            })
            .collect::<Result<Vec<_>, _>>()?;
        check_overlaps(&lumps)?;
        Ok(Self { bytes, kind: header.kind, lumps })
    }

    /// Reads a WAD from a file. A file that is no WAD is refused after its first twelve bytes.
    ///
    /// # Errors
    /// [`ReadError`] with the file and what is wrong.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, ReadError> {
        let path = path.as_ref();
        in_file(path, || {
            let mut file = File::open(path)?;
            let mut bytes = Vec::new();
            file.by_ref().take(HEADER_LEN as u64).read_to_end(&mut bytes)?;
            let about = file.metadata()?;
            Header::parse(&bytes, if about.is_file() { about.len() } else { u64::MAX })?;
            file.read_to_end(&mut bytes)?;
            Ok(Self::parse(bytes)?)
        })
    }

    /// `IWAD` or `PWAD`.
    pub fn kind(&self) -> WadKind {
        self.kind
    }

    /// The whole file.
    pub fn as_bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// The directory, in its order.
    pub fn lumps(&self) -> &[Lump] {
        &self.lumps
    }

    /// The bytes of a lump.
    ///
    /// # Panics
    /// If there is no lump of that index.
    pub fn lump_bytes(&self, lump: usize) -> &[u8] {
        &self.bytes[self.lumps[lump].range()]
    }
}

struct Header {
    kind: WadKind,
    count: u32,
    offset: u32,
}

impl Header {
    fn parse(bytes: &[u8], file_len: u64) -> Result<Self, Malformed> {
        let Some((header, _)) = bytes.split_at_checked(HEADER_LEN) else {
            return Err(malformed!("not a WAD: {} bytes are less than a header", bytes.len()));
        };
        let kind = [WadKind::Game, WadKind::Patch].into_iter().find(|k| header.starts_with(&k.magic()));
        let other = || malformed!("not a WAD: it begins with \"{}\", not IWAD or PWAD", header[..4].escape_ascii());
        let kind = kind.ok_or_else(other)?;
        let (count, offset) = (i32_at(header, 4), i32_at(header, 8));
        let checked = u32::try_from(count).ok().zip(u32::try_from(offset).ok()).filter(|&(count, offset)| {
            let end = u64::from(offset) + u64::from(count) * ENTRY_LEN as u64;
            end <= file_len && (count == 0 || offset as usize >= HEADER_LEN)
        });
        let Some((count, offset)) = checked else {
            let what = format_args!("the directory ({count} lumps at byte {offset})");
            return Err(malformed!("{what} is not inside the file of {file_len} bytes"));
        };
        Ok(Self { kind, count, offset })
    }

    fn directory(&self) -> Range<usize> {
        self.offset as usize..self.offset as usize + self.count as usize * ENTRY_LEN
    }
}

fn parse_entry(
    (index, name): (usize, LumpName),
    entry: &[u8],
    file_len: usize,
    directory: &Range<usize>,
) -> Result<(u32, u32), Malformed> {
    let (offset, size) = (i32_at(entry, 0), i32_at(entry, 4));
    if size == 0 {
        return Ok((0, 0));
    }
    // The sum of two numbers below 2^31 fits.
    let range = u32::try_from(offset).ok().zip(u32::try_from(size).ok()).map(|(start, size)| (start, start + size));
    let Some(range) = range.filter(|&(_, end)| end as usize <= file_len) else {
        let what = malformed!("{size} bytes at byte {offset} are not inside the file of {file_len} bytes");
        return Err(what.within(label(index, name)));
    };
    let [start, end] = [range.0, range.1].map(|at| at as usize);
    if start < HEADER_LEN {
        return Err(malformed!("{} overlaps the header", label(index, name)));
    }
    if start < directory.end && directory.start < end {
        return Err(malformed!("{} overlaps the directory", label(index, name)));
    }
    Ok(range)
}

fn label(index: usize, name: LumpName) -> String {
    format!("lump {index} ({name})")
}

/// Refuses lumps that share some bytes but not all.
fn check_overlaps(lumps: &[Lump]) -> Result<(), Malformed> {
    let mut by_place: Vec<usize> = (0..lumps.len()).filter(|&k| lumps[k].size() > 0).collect();
    by_place.sort_by_key(|&k| lumps[k].range);
    let label = |k: usize| label(k, lumps[k].name);
    let overlap = |a: usize, b: usize| malformed!("{} and {} overlap", label(a.min(b)), label(a.max(b)));
    let mut before: Option<usize> = None;
    for group in by_place.chunk_by(|&a, &b| lumps[a].range.0 == lumps[b].range.0) {
        let (shortest, longest) = (group[0], group[group.len() - 1]);
        if let Some(before) = before.filter(|&k| lumps[k].range.1 > lumps[shortest].range.0) {
            return Err(overlap(before, shortest));
        }
        let uneven = lumps[shortest].range != lumps[longest].range;
        if let Some(&k) = group.iter().find(|&&k| uneven && !lumps[k].name.is("REJECT")) {
            let other = if lumps[k].range == lumps[shortest].range { longest } else { shortest };
            return Err(overlap(k, other));
        }
        before = Some(longest);
    }
    Ok(())
}

/// Eight bytes, as they stand in the directory. The name ends at the first zero; what follows it is
/// kept but means nothing.
///
/// `==` compares all eight bytes; [`LumpName::is`] compares names.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub struct LumpName([u8; 8]);

impl LumpName {
    /// A name of up to eight ASCII characters, filled up with zeros.
    ///
    /// # Errors
    /// [`WadError::Name`] for anything else, a zero character included.
    pub fn new(name: &str) -> Result<Self, WadError> {
        let plain = name.bytes().all(|b| b.is_ascii() && b != 0);
        if name.is_empty() || name.len() > 8 || !plain {
            return Err(WadError::Name { name: name.to_owned() });
        }
        let mut raw = [0; 8];
        raw[..name.len()].copy_from_slice(name.as_bytes());
        Ok(Self::from_raw(raw))
    }

    /// The name that stands in a directory as these bytes.
    pub const fn from_raw(raw: [u8; 8]) -> Self {
        Self(raw)
    }

    /// All eight bytes.
    pub const fn raw(&self) -> [u8; 8] {
        self.0
    }

    /// The bytes before the first zero.
    pub fn text(&self) -> &[u8] {
        let end = self.0.iter().position(|&b| b == 0).unwrap_or(self.0.len());
        &self.0[..end]
    }

    /// Whether this is the name `name`. Engines ignore case, so this does.
    pub fn is(&self, name: &str) -> bool {
        self.text().eq_ignore_ascii_case(name.as_bytes())
    }
}

impl fmt::Display for LumpName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.text().escape_ascii())
    }
}

impl fmt::Debug for LumpName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "LumpName(\"{}\")", self.0.escape_ascii())
    }
}

/// Why a WAD cannot be written.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum WadError {
    /// A name that is empty, longer than eight characters, or not ASCII.
    #[error("\"{}\" cannot be the name of a lump: it takes 1 to 8 ASCII characters", name.escape_debug())]
    Name {
        /// The name.
        name: String,
    },
    /// The file to be written would be larger than its 32-bit places can say.
    #[error("lump {lump} would end at byte {end}, past what a WAD can hold")]
    TooLarge {
        /// Index of the lump, or the number of lumps for the directory.
        lump: usize,
        /// Where it would end.
        end: u64,
    },
    /// An edit names a lump that is not there.
    #[error("there is no lump {lump} among {n_lumps}")]
    NoSuchLump {
        /// The index.
        lump: usize,
        /// How many there are.
        n_lumps: usize,
    },
    /// A map has neither a REJECT lump to replace nor a SECTORS or, as text, ENDMAP lump to put one beside.
    #[error("map {map} has no SECTORS or ENDMAP lump beside which REJECT could stand")]
    NoPlace {
        /// The map's marker.
        map: LumpName,
    },
    /// A map has more sides than lines can name.
    #[error("map {map}: SIDEDEFS: {n_sides} sides are more than lines can name")]
    TooManySides {
        /// The map's marker.
        map: LumpName,
        /// How many it has.
        n_sides: usize,
    },
}
