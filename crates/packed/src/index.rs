//! The index of blocks: which records are in which blocks, and where those are in a file.

use crate::bytes::{Origin, Reader};
use crate::container::{ResidentPart, check_crc};
use crate::error::{PackedError, PackedErrorKind as Kind};
use crate::format::{self, FIXED, MAX_UNPACKED_BLOCK, SizeClass};
use crate::source::ByteSource;
use crate::zstandard::Decompressor;
use sightlines_pvs::SectionId;
use std::sync::{Mutex, PoisonError};

/// A block in the file.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Entry {
    pub(crate) offset: u64,
    pub(crate) len: u32,
    pub(crate) raw: u32,
    crc: u32,
}

/// The blocks of a store.
#[derive(Debug, Clone)]
enum Blocks {
    /// As many records in each but the last; the number of the first block among all blocks.
    Even { per_block: u32, first: usize },
    /// The first record of each block, and the block's number; ascending.
    Listed(Vec<(u32, u32)>),
}

/// A store: which records are in which blocks.
#[derive(Debug, Clone)]
pub(crate) struct StoreIndex {
    pub(crate) n_records: u32,
    n_blocks: usize,
    blocks: Blocks,
}

/// The place of a record.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Spot {
    /// Number of the block among all blocks.
    pub(crate) number: usize,
    /// Position of the record in it.
    pub(crate) k: usize,
    /// Records in it.
    pub(crate) n: usize,
}

impl StoreIndex {
    /// The place of a record, which must exist. O(1), in large files O(log blocks).
    #[inline]
    pub(crate) fn find(&self, record: u32) -> Spot {
        match &self.blocks {
            Blocks::Even { per_block, first } => {
                let block = (record / per_block) as usize;
                Spot { number: first + block, k: (record % per_block) as usize, n: self.n_in_block(block) }
            }
            Blocks::Listed(list) => {
                let block = list.partition_point(|&(first, _)| first <= record) - 1;
                let (first, number) = list[block];
                Spot { number: number as usize, k: (record - first) as usize, n: self.n_in_block(block) }
            }
        }
    }

    /// Number of records in a block of the store, counted from its first.
    fn n_in_block(&self, block: usize) -> usize {
        match &self.blocks {
            Blocks::Even { per_block, .. } => {
                let before = block as u64 * u64::from(*per_block);
                (u64::from(self.n_records) - before).min(u64::from(*per_block)) as usize
            }
            Blocks::Listed(list) => {
                let end = list.get(block + 1).map_or(self.n_records, |&(first, _)| first);
                (end - list[block].0) as usize
            }
        }
    }

    /// The blocks: their numbers among all blocks, and their numbers of records.
    pub(crate) fn blocks(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        let number = |block: usize| match &self.blocks {
            Blocks::Even { first, .. } => first + block,
            Blocks::Listed(list) => list[block].1 as usize,
        };
        (0..self.n_blocks).map(move |block| (number(block), self.n_in_block(block)))
    }
}

/// The positions of all blocks.
pub(crate) struct Index {
    stores: Vec<(SectionId, StoreIndex)>,
    pub(crate) entries: Vec<Entry>,
    /// Not in use now; each takes longer to make than a block to unpack.
    unpackers: Mutex<Vec<Decompressor<'static>>>,
}

impl std::fmt::Debug for Index {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Index").field("stores", &self.stores).field("entries", &self.entries).finish_non_exhaustive()
    }
}

impl Index {
    /// Reads `BLKS`; the blocks must fill what is left of the file. O(blocks).
    pub(crate) fn read(resident: &ResidentPart, len: u64) -> Result<Self, PackedError> {
        let section = resident.need(format::BLOCKS)?;
        let mut r = Reader::new(section.bytes, section.place);
        let ((index, offset), end) = match resident.class() {
            SizeClass::Small => (Self::read_small(&mut r, resident.end())?, len),
            SizeClass::Large => (Self::read_large(&mut r)?, resident.base()),
        };
        r.finish()?;
        if offset == end { Ok(index) } else { Err(section.place.fail(Kind::Misplaced)) }
    }

    fn empty() -> Self {
        Self { stores: Vec::new(), entries: Vec::new(), unpackers: Mutex::new(Vec::new()) }
    }

    fn read_small(r: &mut Reader<'_>, mut offset: u64) -> Result<(Self, u64), PackedError> {
        let mut index = Self::empty();
        for _ in 0..r.u32()? {
            let id = index.read_id(r)?;
            let (n_records, per_block) = (r.u32()?, r.u32()?);
            if per_block == 0 {
                return Err(r.fail(Kind::Value { value: 0 }));
            }
            let n_blocks = n_records.div_ceil(per_block) as usize;
            let blocks = Blocks::Even { per_block, first: index.entries.len() };
            index.stores.push((id, StoreIndex { n_records, n_blocks, blocks }));
            for _ in 0..n_blocks {
                index.read_entry(r, &mut offset)?;
            }
        }
        Ok((index, offset))
    }

    fn read_large(r: &mut Reader<'_>) -> Result<(Self, u64), PackedError> {
        let mut index = Self::empty();
        for _ in 0..r.u32()? {
            let id = index.read_id(r)?;
            let store = StoreIndex { n_records: r.u32()?, n_blocks: 0, blocks: Blocks::Listed(Vec::new()) };
            index.stores.push((id, store));
        }
        let n_blocks = r.u32()?;
        if u64::from(n_blocks) * 16 > r.left() as u64 {
            return Err(r.fail(Kind::Cut));
        }
        index.entries.reserve_exact(n_blocks as usize);
        let mut listed = vec![0u32; index.stores.len()];
        let mut offset = FIXED as u64;
        for number in 0..n_blocks {
            let both = r.u32()?;
            let (store, n) = ((both & 0xFFFF) as usize, both >> 16);
            let Some((_, index_of)) = index.stores.get_mut(store).filter(|_| n > 0) else {
                return Err(r.fail(Kind::Value { value: u64::from(both) }));
            };
            if let Blocks::Listed(list) = &mut index_of.blocks {
                list.push((listed[store], number));
            }
            index_of.n_blocks += 1;
            listed[store] = listed[store].checked_add(n).ok_or_else(|| r.fail(Kind::Value { value: u64::from(n) }))?;
            index.read_entry(r, &mut offset)?;
        }
        match index.stores.iter().zip(&listed).find(|((_, store), listed)| store.n_records != **listed) {
            Some((_, &listed)) => Err(r.fail(Kind::Value { value: u64::from(listed) })),
            None => Ok((index, offset)),
        }
    }

    fn read_id(&self, r: &mut Reader<'_>) -> Result<SectionId, PackedError> {
        let id = r.take(4)?;
        let id = SectionId([id[0], id[1], id[2], id[3]]);
        if self.has(id) { Err(r.fail(Kind::Repeated)) } else { Ok(id) }
    }

    fn read_entry(&mut self, r: &mut Reader<'_>, offset: &mut u64) -> Result<(), PackedError> {
        let (n, raw, crc) = (r.u32()?, r.u32()?, r.u32()?);
        if raw > MAX_UNPACKED_BLOCK || n > raw {
            return Err(r.fail(Kind::Value { value: u64::from(raw.max(n)) }));
        }
        self.entries.push(Entry { offset: *offset, len: n, raw, crc });
        *offset = offset.saturating_add(u64::from(n));
        Ok(())
    }

    /// The stores, with the bytes of their blocks in the file.
    pub(crate) fn sizes(&self) -> impl Iterator<Item = (SectionId, u64)> + '_ {
        let bytes = |store: &StoreIndex| store.blocks().map(|(number, _)| u64::from(self.entries[number].len)).sum();
        self.stores.iter().map(move |(id, store)| (*id, bytes(store)))
    }

    /// Whether there is a store.
    pub(crate) fn has(&self, id: SectionId) -> bool {
        self.stores.iter().any(|(known, _)| *known == id)
    }

    /// Offset of the first block of a store; 0 if it has none.
    pub(crate) fn offset_of(&self, store: &StoreIndex) -> u64 {
        store.blocks().next().map_or(0, |(number, _)| self.entries[number].offset)
    }

    /// A store, with a check of its number of records.
    pub(crate) fn need(&self, id: SectionId, n_records: u32) -> Result<StoreIndex, PackedError> {
        let missing = || PackedError::new(Some(id), 0, Kind::Missing);
        let (_, store) = self.stores.iter().find(|(known, _)| *known == id).ok_or_else(missing)?;
        let (needed, found) = (u64::from(n_records), u64::from(store.n_records));
        let at = self.offset_of(store);
        if needed == found {
            Ok(store.clone())
        } else {
            Err(PackedError::new(Some(id), at, Kind::Value { value: found }))
        }
    }

    /// As [`Index::need`], of a store of records: each block must have room for the four bytes that store a record's
    /// position, so that memory for each record stays below that of the blocks. O(blocks).
    pub(crate) fn need_records(&self, id: SectionId, n_records: u32) -> Result<StoreIndex, PackedError> {
        let store = self.need(id, n_records)?;
        for (number, n) in store.blocks() {
            let entry = &self.entries[number];
            let (needed, found) = (4 * n as u64, u64::from(entry.raw));
            if found < needed {
                return Err(PackedError::new(Some(id), entry.offset, Kind::Size { needed, found }));
            }
        }
        Ok(store)
    }

    /// Reads and unpacks a block. Takes at most twice [`MAX_UNPACKED_BLOCK`] bytes, whatever the file claims.
    pub(crate) fn unpack(
        &self,
        source: &impl ByteSource,
        id: SectionId,
        number: usize,
    ) -> Result<Vec<u8>, PackedError> {
        let Entry { offset, len, raw, crc } = self.entries[number];
        let place = Origin { section: id, offset };
        let mut packed = vec![0; len as usize];
        source.read_at(offset, &mut packed).map_err(|error| place.fail(Kind::Io(error)))?;
        check_crc(crc, crc32fast::hash(&packed), |kind| place.fail(kind))?;
        if len == raw {
            return Ok(packed);
        }
        let unpackers = || self.unpackers.lock().unwrap_or_else(PoisonError::into_inner);
        let kept = unpackers().pop();
        let unpacker = kept.map_or_else(Decompressor::new, Ok);
        let mut unpacker = unpacker.map_err(|error| place.fail(Kind::Io(error)))?;
        let bytes = unpacker.decompress(&packed, raw as usize).ok().filter(|bytes| bytes.len() == raw as usize);
        unpackers().push(unpacker);
        bytes.ok_or_else(|| place.fail(Kind::Unpack { raw }))
    }
}
