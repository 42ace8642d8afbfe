//! Header, section table, block index: the positions of things in a file, and the check that they are intact.

use crate::bytes::{Place, Reader, u32_at, u64_at};
use crate::error::{PackedError, PackedErrorKind as Kind};
use crate::format::{self, ENTRY, FIXED, MAGIC, MAJOR, MAX_UNPACKED_BLOCK, OPTIONAL, SECTIONS};
use crate::source::Source;
use sightlines_pvs::SectionId;
use std::ops::Range;

/// The resident part of a file: all sections, one after the other.
#[derive(Debug)]
pub(crate) struct ResidentPart {
    bytes: Vec<u8>,
    /// Offset of the first section in the file.
    base: u64,
    minor: u16,
    found: [Option<Range<usize>>; SECTIONS.len()],
}

/// A section's bytes and their position.
#[derive(Clone, Copy)]
pub(crate) struct Section<'a> {
    pub(crate) bytes: &'a [u8],
    pub(crate) place: Place,
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
    pub(crate) fn read(source: &impl Source) -> Result<(Self, u64), PackedError> {
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
        match u16::from_le_bytes([fixed[8], fixed[9]]) {
            MAJOR => {}
            major => return Err(fail(8, Kind::Major { major })),
        }
        let n_table = ENTRY as u64 * u64::from(u32_at(&fixed, 12));
        let base = FIXED as u64 + n_table + 4;
        if base > len {
            return Err(fail(len, Kind::Cut));
        }
        let mut table = vec![0; n_table as usize + 4];
        source.read_at(FIXED as u64, &mut table).map_err(io(FIXED as u64))?;
        let (table, stored) = table.split_at(n_table as usize);
        let mut crc = crc32fast::Hasher::new();
        crc.update(&fixed);
        crc.update(table);
        check_crc(u32_at(stored, 0), crc.finalize(), |kind| fail(base - 4, kind))?;
        let stated = u64_at(&fixed, 16);
        if stated != len {
            return Err(fail(16, Kind::Length { stated, len }));
        }
        let sections = layout(table, base, len)?;
        let mut bytes = vec![0; sections.last().map_or(0, |(_, range, _)| range.end)];
        source.read_at(base, &mut bytes).map_err(io(base))?;
        let mut found = [const { None }; SECTIONS.len()];
        for (id, range, crc) in sections {
            let place = Place { section: id, offset: base + range.start as u64 };
            check_crc(crc, crc32fast::hash(&bytes[range.clone()]), |kind| place.fail(kind))?;
            if let Some(known) = SECTIONS.iter().position(|(known, _)| *known == id) {
                found[known] = Some(range);
            }
        }
        let minor = u16::from_le_bytes([fixed[10], fixed[11]]);
        Ok((Self { bytes, base, minor, found }, len))
    }

    /// The minor version that the file states.
    pub(crate) fn minor(&self) -> u16 {
        self.minor
    }

    /// A section that may be missing.
    pub(crate) fn find(&self, id: SectionId) -> Option<Section<'_>> {
        let range = self.range(id)?;
        let place = Place { section: id, offset: self.base + range.start as u64 };
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

    /// Offset in the file behind the last section.
    pub(crate) fn end(&self) -> u64 {
        self.base + self.bytes.len() as u64
    }
}

/// The positions of the sections, relative to the first, and their checksums.
type Layout = Vec<(SectionId, Range<usize>, u32)>;

fn layout(table: &[u8], base: u64, len: u64) -> Result<Layout, PackedError> {
    let mut sections: Layout = Vec::new();
    let mut end = base;
    for (i, entry) in table.chunks_exact(ENTRY).enumerate() {
        let id = SectionId([entry[0], entry[1], entry[2], entry[3]]);
        let fail = |kind| PackedError::new(Some(id), (FIXED + ENTRY * i) as u64, kind);
        let (flags, offset, n) = (u32_at(entry, 4), u64_at(entry, 8), u64::from(u32_at(entry, 16)));
        if offset != end || n > len - end {
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

fn check_crc(stored: u32, computed: u32, fail: impl FnOnce(Kind) -> PackedError) -> Result<(), PackedError> {
    if stored == computed { Ok(()) } else { Err(fail(Kind::Checksum { stored, computed })) }
}

/// A block in the file.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Entry {
    pub(crate) offset: u64,
    pub(crate) len: u32,
    pub(crate) raw: u32,
    crc: u32,
}

/// A store: which records are in which blocks.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct StoreIndex {
    pub(crate) n_records: u32,
    pub(crate) per_block: u32,
    /// Number of its first block among all blocks.
    pub(crate) first: usize,
    pub(crate) n_blocks: usize,
}

impl StoreIndex {
    /// Number of records in a block of the store, counted from its first.
    pub(crate) fn n_in_block(&self, block: usize) -> usize {
        let before = block as u64 * u64::from(self.per_block);
        (u64::from(self.n_records) - before).min(u64::from(self.per_block)) as usize
    }
}

/// The positions of all blocks.
#[derive(Debug)]
pub(crate) struct Index {
    stores: Vec<(SectionId, StoreIndex)>,
    pub(crate) entries: Vec<Entry>,
}

impl Index {
    /// Reads `BLKS`; the blocks must fill the rest of the file. O(blocks).
    pub(crate) fn read(resident: &ResidentPart, len: u64) -> Result<Self, PackedError> {
        let section = resident.need(format::BLOCKS)?;
        let mut r = Reader::new(section.bytes, section.place);
        let (mut stores, mut entries) = (Vec::<(SectionId, StoreIndex)>::new(), Vec::new());
        let mut offset = resident.end();
        for _ in 0..r.u32()? {
            let id = r.take(4)?;
            let id = SectionId([id[0], id[1], id[2], id[3]]);
            let (n_records, per_block) = (r.u32()?, r.u32()?);
            let repeated = stores.iter().any(|(other, _)| *other == id);
            if per_block == 0 || repeated {
                return Err(r.fail(if repeated { Kind::Repeated } else { Kind::Value { value: 0 } }));
            }
            let n_blocks = n_records.div_ceil(per_block) as usize;
            stores.push((id, StoreIndex { n_records, per_block, first: entries.len(), n_blocks }));
            for _ in 0..n_blocks {
                let (n, raw, crc) = (r.u32()?, r.u32()?, r.u32()?);
                if raw > MAX_UNPACKED_BLOCK || n > raw {
                    return Err(r.fail(Kind::Value { value: u64::from(raw.max(n)) }));
                }
                entries.push(Entry { offset, len: n, raw, crc });
                offset = offset.saturating_add(u64::from(n));
            }
        }
        r.finish()?;
        if offset == len { Ok(Self { stores, entries }) } else { Err(section.place.fail(Kind::Misplaced)) }
    }

    /// The stores, with the bytes of their blocks in the file.
    pub(crate) fn sizes(&self) -> impl Iterator<Item = (SectionId, u64)> + '_ {
        let bytes = |store: &StoreIndex| self.entries[store.first..store.first + store.n_blocks].iter();
        self.stores.iter().map(move |(id, store)| (*id, bytes(store).map(|entry| u64::from(entry.len)).sum()))
    }

    /// Whether there is a store.
    pub(crate) fn has(&self, id: SectionId) -> bool {
        self.stores.iter().any(|(known, _)| *known == id)
    }

    /// A store, with a check of its number of records.
    pub(crate) fn need(&self, id: SectionId, n_records: u32) -> Result<StoreIndex, PackedError> {
        let missing = || PackedError::new(Some(id), 0, Kind::Missing);
        let (_, store) = self.stores.iter().find(|(known, _)| *known == id).ok_or_else(missing)?;
        let (needed, found) = (u64::from(n_records), u64::from(store.n_records));
        let at = self.entries.get(store.first).map_or(0, |entry| entry.offset);
        if needed == found { Ok(*store) } else { Err(PackedError::new(Some(id), at, Kind::Value { value: found })) }
    }

    /// As [`Index::need`], of a store of records: each block must have room for the four bytes that store a record's
    /// position, so that memory for each record stays below that of the blocks. O(blocks).
    pub(crate) fn need_records(&self, id: SectionId, n_records: u32) -> Result<StoreIndex, PackedError> {
        let store = self.need(id, n_records)?;
        for block in 0..store.n_blocks {
            let entry = &self.entries[store.first + block];
            let needed = 4 * store.n_in_block(block) as u64;
            if u64::from(entry.raw) < needed {
                let found = u64::from(entry.raw);
                return Err(PackedError::new(Some(id), entry.offset, Kind::Size { needed, found }));
            }
        }
        Ok(store)
    }

    /// Reads and unpacks a block. Takes at most twice [`MAX_UNPACKED_BLOCK`] bytes, whatever the file claims.
    pub(crate) fn unpack(&self, source: &impl Source, id: SectionId, number: usize) -> Result<Vec<u8>, PackedError> {
        let Entry { offset, len, raw, crc } = self.entries[number];
        let place = Place { section: id, offset };
        let mut packed = vec![0; len as usize];
        source.read_at(offset, &mut packed).map_err(|error| place.fail(Kind::Io(error)))?;
        check_crc(crc, crc32fast::hash(&packed), |kind| place.fail(kind))?;
        if len == raw {
            return Ok(packed);
        }
        let bytes = zstd::bulk::decompress(&packed, raw as usize).ok().filter(|bytes| bytes.len() == raw as usize);
        bytes.ok_or_else(|| place.fail(Kind::Unpack { raw }))
    }
}
