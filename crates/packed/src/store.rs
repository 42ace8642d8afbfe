//! Records in blocks, for writing.

use crate::bytes::{Writer, bytes_of};
use crate::error::PackError;
use crate::format::{BLOCK_BYTES, MAX_UNPACKED_BLOCK, ROW_BLOCK_BYTES};
use crate::zstandard;
use sightlines_pvs::{BitMatrix, SectionId};

/// Compression level of zstd. Higher levels save a few per cent and take several times as long.
pub(crate) const LEVEL: i32 = 15;
/// Most rows in a block.
const MAX_ROWS: usize = 256;

/// A store with all its blocks as written to the file.
pub(crate) struct Store {
    id: SectionId,
    n_records: u32,
    per_block: u32,
    index: Vec<[u32; 3]>,
    pub(crate) bytes: Vec<u8>,
}

impl Store {
    fn new(id: SectionId, n_records: usize, per_block: usize) -> Result<Self, PackError> {
        let n_records = u32::try_from(n_records).map_err(|_| PackError::TooMany { store: id })?;
        Ok(Self { id, n_records, per_block: per_block as u32, index: Vec::new(), bytes: Vec::new() })
    }

    fn push(&mut self, zstd: &mut zstandard::Compressor<'_>, raw: &[u8]) -> Result<(), PackError> {
        let large = || PackError::Record { store: self.id, bytes: raw.len() as u64 };
        let n_raw = u32::try_from(raw.len()).ok().filter(|n| *n <= MAX_UNPACKED_BLOCK).ok_or_else(large)?;
        let packed = zstd.compress(raw).map_err(|_| PackError::Zstd { store: self.id })?;
        let kept = if packed.len() < raw.len() { &packed } else { raw };
        self.index.push([kept.len() as u32, n_raw, crc32fast::hash(kept)]);
        self.bytes.extend_from_slice(kept);
        Ok(())
    }

    /// Packs records of bytes.
    pub(crate) fn of_records(id: SectionId, records: impl Iterator<Item = Vec<u8>>) -> Result<Self, PackError> {
        let records: Vec<Vec<u8>> = records.collect();
        let mean = records.iter().map(Vec::len).sum::<usize>() / records.len().max(1) + 4;
        let per_block = (BLOCK_BYTES / mean).clamp(1, 1024);
        let mut store = Self::new(id, records.len(), per_block)?;
        let mut zstd = compressor(id)?;
        for block in records.chunks(per_block) {
            let mut raw = Writer::default();
            let mut end = 0u64;
            for record in block {
                end += record.len() as u64;
                raw.u32(u32::try_from(end).map_err(|_| PackError::Record { store: id, bytes: end })?);
            }
            block.iter().for_each(|record| raw.0.extend_from_slice(record));
            store.push(&mut zstd, &raw.0)?;
        }
        Ok(store)
    }

    /// Packs rows of bits into blocks of a suitable size.
    pub(crate) fn of_rows(id: SectionId, bits: &BitMatrix) -> Result<Self, PackError> {
        let per_block = rows_per_block(bits.n_cols());
        let mut store = Self::new(id, bits.n_rows(), per_block)?;
        let mut zstd = compressor(id)?;
        let mut words = Vec::new();
        for begin in (0..bits.n_rows()).step_by(per_block) {
            words.clear();
            let end = bits.n_rows().min(begin + per_block);
            (begin..end).for_each(|i| words.extend_from_slice(bits.row(i)));
            store.push(&mut zstd, &bytes_of(&words))?;
        }
        Ok(store)
    }

    /// Bytes in the file, including the part of the index.
    pub(crate) fn len(&self) -> usize {
        self.bytes.len() + 12 * self.index.len()
    }

    /// Writes the store's part of the index.
    pub(crate) fn write_index(&self, out: &mut Writer) {
        out.0.extend(self.id.0);
        out.u32(self.n_records);
        out.u32(self.per_block);
        self.index.iter().flatten().for_each(|&x| out.u32(x));
    }
}

/// Rows in a block: as many as a block should contain, a power of two.
fn rows_per_block(n_cols: usize) -> usize {
    let fit = ROW_BLOCK_BYTES / (8 * n_cols.div_ceil(64)).max(1);
    let power = if fit == 0 { 1 } else { 1 << fit.ilog2() };
    power.clamp(16, MAX_ROWS)
}

fn compressor(store: SectionId) -> Result<zstandard::Compressor<'static>, PackError> {
    zstandard::Compressor::new(LEVEL).map_err(|_| PackError::Zstd { store })
}
