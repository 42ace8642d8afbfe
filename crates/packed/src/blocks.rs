//! Blocks of records, written to a large file one after the other.

use crate::bytes::Writer;
use crate::error::{PackError, StreamError};
use crate::format::{
    FIXED, LARGE_BLOCK_BYTES, LARGE_ROW_BLOCK_BYTES, MAX_UNPACKED_BLOCK, PARTS_SEEN, PLACES, ROWS, SEEN,
};
use crate::zstandard;
use sightlines_pvs::SectionId;
use std::io::Write;

/// Compression level of zstd. Higher levels save a tenth and take twenty times as long.
const LEVEL: i32 = 3;
/// Most records in a block.
const MAX_RECORDS: usize = 1024;

/// A store with the records that wait for their block to be full.
struct Pending {
    id: SectionId,
    n_records: u32,
    n_bytes: u64,
    ends: Vec<u32>,
    content: Vec<u8>,
}

/// Writes blocks, and keeps their index.
pub(crate) struct BlockWriter<W: Write> {
    out: W,
    at: u64,
    zstd: zstandard::Compressor<'static>,
    stores: Vec<Pending>,
    n_blocks: u32,
    index: Writer,
    raw: Writer,
}

impl<W: Write> BlockWriter<W> {
    /// Begins the file.
    pub(crate) fn new(mut out: W, fixed: &[u8]) -> Result<Self, StreamError> {
        out.write_all(fixed)?;
        let zstd = zstandard::Compressor::new(LEVEL).map_err(|_| PackError::Zstd { store: SectionId(*b"BLKS") })?;
        let (index, raw) = (Writer::default(), Writer::default());
        Ok(Self { out, at: FIXED as u64, zstd, stores: Vec::new(), n_blocks: 0, index, raw })
    }

    /// Begins a store; its number.
    pub(crate) fn store(&mut self, id: SectionId) -> usize {
        self.stores.push(Pending { id, n_records: 0, n_bytes: 0, ends: Vec::new(), content: Vec::new() });
        self.stores.len() - 1
    }

    /// Adds a record to a store.
    pub(crate) fn push(&mut self, store: usize, record: &[u8]) -> Result<(), StreamError> {
        let pending = &self.stores[store];
        if pending.content.len() + record.len() > MAX_UNPACKED_BLOCK as usize / 2 {
            self.flush(store)?;
        }
        let pending = &mut self.stores[store];
        let id = pending.id;
        pending.content.extend_from_slice(record);
        let end = u32::try_from(pending.content.len()).ok();
        pending.ends.push(end.ok_or(PackError::Record { store: id, bytes: record.len() as u64 })?);
        pending.n_records = pending.n_records.checked_add(1).ok_or(PackError::TooMany { store: id })?;
        let target =
            if [ROWS, SEEN, PARTS_SEEN, PLACES].contains(&id) { LARGE_ROW_BLOCK_BYTES } else { LARGE_BLOCK_BYTES };
        if pending.content.len() + 4 * pending.ends.len() >= target || pending.ends.len() == MAX_RECORDS {
            self.flush(store)?;
        }
        Ok(())
    }

    /// Writes a store of records.
    pub(crate) fn all(&mut self, id: SectionId, records: impl Iterator<Item = Vec<u8>>) -> Result<(), StreamError> {
        let store = self.store(id);
        for record in records {
            self.push(store, &record)?;
        }
        self.flush(store)
    }

    /// Writes what waits in a store.
    pub(crate) fn flush(&mut self, store: usize) -> Result<(), StreamError> {
        let Pending { id, ends, content, n_bytes, .. } = &mut self.stores[store];
        let id = *id;
        if ends.is_empty() {
            return Ok(());
        }
        self.raw.0.clear();
        ends.iter().for_each(|&end| self.raw.u32(end));
        self.raw.0.extend_from_slice(content);
        let raw = &self.raw.0;
        let large = || PackError::Record { store: id, bytes: raw.len() as u64 };
        let n_raw = u32::try_from(raw.len()).ok().filter(|n| *n <= MAX_UNPACKED_BLOCK).ok_or_else(large)?;
        let packed = self.zstd.compress(raw).map_err(|_| PackError::Zstd { store: id })?;
        let kept = if packed.len() < raw.len() { &packed } else { raw };
        self.index.u32(store as u32 | (ends.len() as u32) << 16);
        self.index.u32(kept.len() as u32);
        self.index.u32(n_raw);
        self.index.u32(crc32fast::hash(kept));
        self.out.write_all(kept)?;
        self.at += kept.len() as u64;
        *n_bytes += kept.len() as u64;
        self.n_blocks = self.n_blocks.checked_add(1).ok_or(PackError::TooMany { store: id })?;
        ends.clear();
        content.clear();
        Ok(())
    }

    /// Writes all that waits. The output, its length, the section `BLKS`, and the bytes of the blocks of each store.
    pub(crate) fn finish(mut self) -> Result<(W, u64, Vec<u8>, Vec<u64>), StreamError> {
        (0..self.stores.len()).try_for_each(|store| self.flush(store))?;
        let mut blocks = Writer::default();
        blocks.u32(self.stores.len() as u32);
        for store in &self.stores {
            blocks.0.extend(store.id.0);
            blocks.u32(store.n_records);
        }
        blocks.u32(self.n_blocks);
        blocks.0.extend(self.index.0);
        Ok((self.out, self.at, blocks.0, self.stores.iter().map(|store| store.n_bytes).collect()))
    }
}
