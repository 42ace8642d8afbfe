//! Header, section table, sections: the resident part of a file, and the check that it is intact.

use crate::bytes::{Origin, u32_at, u64_at};
use crate::error::{PackedError, PackedErrorKind as Kind};
use crate::format::{END, ENTRY, FIXED, MAGIC, MAJOR, MAJOR_LARGE, OPTIONAL, SECTIONS, SizeClass, TAIL};
use crate::source::ByteSource;
use sightlines_pvs::SectionId;
use std::ops::Range;

/// The resident part of a file: all sections, one after the other.
#[derive(Debug)]
pub(crate) struct ResidentPart {
    bytes: Vec<u8>,
    /// Offset of the first section in the file.
    base: u64,
    class: SizeClass,
    minor: u16,
    found: [Option<Range<usize>>; SECTIONS.len()],
}

/// A section's bytes and their position.
#[derive(Clone, Copy)]
pub(crate) struct Section<'a> {
    pub(crate) bytes: &'a [u8],
    pub(crate) place: Origin,
}

impl Section<'_> {
    /// Checks the size of the section.
    pub(crate) fn expect(&self, needed: u64) -> Result<(), PackedError> {
        let found = self.bytes.len() as u64;
        if needed == found { Ok(()) } else { Err(self.place.fail(Kind::Size { needed, found })) }
    }
}

impl ResidentPart {
    /// Reads and checks header, section table and sections; also returns the length of the file.
    ///
    /// Takes no more memory than the length of the file.
    pub(crate) fn read(source: &impl ByteSource) -> Result<(Self, u64), PackedError> {
        let fail = |offset: u64, kind| PackedError::new(None, offset, kind);
        let io = |offset: u64| move |error: std::io::Error| fail(offset, Kind::Io(error));
        let len = source.len().map_err(io(0))?;
        let mut fixed = [0; FIXED];
        let n = (FIXED as u64).min(len) as usize;
        source.read_at(0, &mut fixed[..n]).map_err(io(0))?;
        if !MAGIC.starts_with(&fixed[..n.min(MAGIC.len())]) {
            return Err(fail(0, Kind::Magic));
        }
        if n < FIXED {
            return Err(fail(len, Kind::Cut));
        }
        let (class, base, end, sections) = match u16::from_le_bytes([fixed[8], fixed[9]]) {
            MAJOR => {
                let (base, sections) = small_layout(source, &fixed, len)?;
                let end = sections.last().map_or(0, |(_, range, _)| range.end);
                (SizeClass::Small, base, end, sections)
            }
            MAJOR_LARGE => {
                let (base, end, sections) = large_layout(source, &fixed, len)?;
                (SizeClass::Large, base, end, sections)
            }
            major => return Err(fail(8, Kind::Major { major })),
        };
        let mut bytes = vec![0; end];
        source.read_at(base, &mut bytes).map_err(io(base))?;
        let mut found = [const { None }; SECTIONS.len()];
        for (id, range, crc) in sections {
            let place = Origin { section: id, offset: base + range.start as u64 };
            check_crc(crc, crc32fast::hash(&bytes[range.clone()]), |kind| place.fail(kind))?;
            if let Some(known) = SECTIONS.iter().position(|(known, _)| *known == id) {
                found[known] = Some(range);
            }
        }
        let minor = u16::from_le_bytes([fixed[10], fixed[11]]);
        Ok((Self { bytes, base, class, minor, found }, len))
    }

    /// The size class of the file.
    pub(crate) fn class(&self) -> SizeClass {
        self.class
    }

    /// The minor version that the file states.
    pub(crate) fn minor(&self) -> u16 {
        self.minor
    }

    /// A section that may be missing.
    pub(crate) fn find(&self, id: SectionId) -> Option<Section<'_>> {
        let range = self.range(id)?;
        let place = Origin { section: id, offset: self.base + range.start as u64 };
        Some(Section { bytes: &self.bytes[range], place })
    }

    /// The position of a section in [`ResidentPart::bytes`].
    pub(crate) fn range(&self, id: SectionId) -> Option<Range<usize>> {
        SECTIONS.iter().position(|(known, _)| *known == id).and_then(|known| self.found[known].clone())
    }

    /// A required section.
    pub(crate) fn need(&self, id: SectionId) -> Result<Section<'_>, PackedError> {
        self.find(id).ok_or_else(|| PackedError::new(Some(id), self.end(), Kind::Missing))
    }

    /// All sections.
    #[inline]
    pub(crate) fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// The known sections that exist, with their lengths.
    pub(crate) fn sizes(&self) -> impl Iterator<Item = (SectionId, u64)> + '_ {
        SECTIONS.iter().zip(&self.found).filter_map(|((id, _), at)| Some((*id, at.as_ref()?.len() as u64)))
    }

    /// Offset of the first section in the file.
    pub(crate) fn base(&self) -> u64 {
        self.base
    }

    /// Offset in the file behind the last section.
    pub(crate) fn end(&self) -> u64 {
        self.base + self.bytes.len() as u64
    }
}

/// The positions of the sections, relative to the first, and their checksums.
type Layout = Vec<(SectionId, Range<usize>, u32)>;

/// The sections of a small file, and where they begin: header, section table, sections, blocks.
fn small_layout(source: &impl ByteSource, fixed: &[u8; FIXED], len: u64) -> Result<(u64, Layout), PackedError> {
    let fail = |offset: u64, kind| PackedError::new(None, offset, kind);
    let n_table = ENTRY as u64 * u64::from(u32_at(fixed, 12));
    let base = FIXED as u64 + n_table + 4;
    if base > len {
        return Err(fail(len, Kind::Cut));
    }
    let mut table = vec![0; n_table as usize + 4];
    source.read_at(FIXED as u64, &mut table).map_err(|error| fail(FIXED as u64, Kind::Io(error)))?;
    let (table, stored) = table.split_at(n_table as usize);
    let mut crc = crc32fast::Hasher::new();
    crc.update(fixed);
    crc.update(table);
    check_crc(u32_at(stored, 0), crc.finalize(), |kind| fail(base - 4, kind))?;
    let stated = u64_at(fixed, 16);
    if stated != len {
        return Err(fail(16, Kind::Length { stated, len }));
    }
    Ok((base, layout(table, FIXED as u64, base, len)?))
}

/// The sections of a large file, where they begin, and their length: header, blocks, sections, section table, tail.
fn large_layout(source: &impl ByteSource, fixed: &[u8; FIXED], len: u64) -> Result<(u64, usize, Layout), PackedError> {
    let fail = |offset: u64, kind| PackedError::new(None, offset, kind);
    if len < (FIXED + TAIL) as u64 {
        return Err(fail(len, Kind::Cut));
    }
    let at = len - TAIL as u64;
    let mut tail = [0; TAIL];
    source.read_at(at, &mut tail).map_err(|error| fail(at, Kind::Io(error)))?;
    if tail[TAIL - END.len()..] != END {
        return Err(fail(len, Kind::Cut));
    }
    let (base, stated) = (u64_at(&tail, 0), u64_at(&tail, 8));
    let n_table = ENTRY as u64 * u64::from(u32_at(&tail, 16));
    let Some(end) = at.checked_sub(n_table).filter(|&end| end >= FIXED as u64) else {
        return Err(fail(at, Kind::Cut));
    };
    let mut table = vec![0; n_table as usize];
    source.read_at(end, &mut table).map_err(|error| fail(end, Kind::Io(error)))?;
    let mut crc = crc32fast::Hasher::new();
    crc.update(fixed);
    crc.update(&table);
    crc.update(&tail[..20]);
    check_crc(u32_at(&tail, 20), crc.finalize(), |kind| fail(at + 20, kind))?;
    if stated != len {
        return Err(fail(at + 8, Kind::Length { stated, len }));
    }
    if base < FIXED as u64 || base > end {
        return Err(fail(at, Kind::Misplaced));
    }
    let sections = layout(&table, end, base, end)?;
    let n = sections.last().map_or(0, |(_, range, _)| range.end);
    if base + n as u64 != end {
        return Err(fail(at, Kind::Misplaced));
    }
    Ok((base, n, sections))
}

/// The sections that a table at `table_at` lists: one after the other from `base` on, and within `limit`.
fn layout(table: &[u8], table_at: u64, base: u64, limit: u64) -> Result<Layout, PackedError> {
    let mut sections: Layout = Vec::new();
    let mut end = base;
    for (i, entry) in table.chunks_exact(ENTRY).enumerate() {
        let id = SectionId([entry[0], entry[1], entry[2], entry[3]]);
        let fail = |kind| PackedError::new(Some(id), table_at + (ENTRY * i) as u64, kind);
        let (flags, offset, n) = (u32_at(entry, 4), u64_at(entry, 8), u64::from(u32_at(entry, 16)));
        if offset != end || n > limit - end {
            return Err(fail(Kind::Misplaced));
        }
        if sections.iter().any(|(other, _, _)| *other == id) {
            return Err(fail(Kind::Repeated));
        }
        if flags != OPTIONAL && SECTIONS.iter().all(|(known, _)| *known != id) {
            return Err(fail(Kind::Unknown));
        }
        let begin = (end - base) as usize;
        sections.push((id, begin..begin + n as usize, u32_at(entry, 20)));
        end += n;
    }
    Ok(sections)
}

pub(crate) fn check_crc(stored: u32, computed: u32, fail: impl FnOnce(Kind) -> PackedError) -> Result<(), PackedError> {
    if stored == computed { Ok(()) } else { Err(fail(Kind::Checksum { stored, computed })) }
}
