//! The records of a lump, and which of them the records of others name.

use super::{Bsp, BspFormat, layout};
use crate::error::{Malformed, malformed};
use std::ops::Range;

/// How often the records of a list may be named in all, in multiples of its length. Compilers name each once.
const MOST_SHARED: u64 = 4;

/// The records of a lump, of which there is a whole number.
#[derive(Debug, Clone, Copy)]
pub(super) struct Records<'b> {
    format: BspFormat,
    pub(super) lump: usize,
    len: usize,
    bytes: &'b [u8],
}

/// A record of a lump: the lump, and the index of the record.
pub(super) type By = (usize, usize);

impl Bsp {
    pub(super) fn records(&self, of: layout::Records) -> Result<Records<'_>, Malformed> {
        let bytes = self.format.whole_records(of.lump, of.len, self.lump_bytes(of.lump))?;
        Ok(Records { format: self.format, lump: of.lump, len: of.len, bytes })
    }
}

impl<'b> Records<'b> {
    pub(super) fn n(&self) -> usize {
        self.bytes.len() / self.len
    }

    pub(super) fn get(&self, k: usize) -> &'b [u8] {
        &self.bytes[k * self.len..][..self.len]
    }

    pub(super) fn iter(&self) -> std::slice::ChunksExact<'b, u8> {
        self.bytes.chunks_exact(self.len)
    }

    pub(super) fn label(&self) -> String {
        self.format.label(self.lump)
    }

    /// An index that a record names, if it is of one of these.
    pub(super) fn named(&self, by: By, found: i64) -> Result<usize, Malformed> {
        let index = usize::try_from(found).ok().filter(|&k| k < self.n());
        index.ok_or_else(|| self.not_named(by, format_args!("record {found} of")))
    }

    /// A first record and a number of records that a record names, if they are of these.
    pub(super) fn run(&self, by: By, [first, count]: [i64; 2]) -> Result<Range<usize>, Malformed> {
        let (start, len) = (usize::try_from(first).ok(), usize::try_from(count).ok());
        let run = start.zip(len).and_then(|(start, len)| Some(start..start.checked_add(len)?));
        let run = run.filter(|run| run.end <= self.n());
        run.ok_or_else(|| self.not_named(by, format_args!("{count} records from {first} on of")))
    }

    fn not_named(&self, (lump, record): By, what: std::fmt::Arguments<'_>) -> Malformed {
        malformed!("{}: record {record} names {what} {}, which has {}", self.format.label(lump), self.label(), self.n())
    }

    /// Runs may share records, but not so often that a small file becomes a large map.
    pub(super) fn refuse_shared(&self, lump: usize, n_named: u64) -> Result<(), Malformed> {
        if n_named <= MOST_SHARED * self.n() as u64 {
            return Ok(());
        }
        let what = format_args!("{n_named} records of {}, which has {}", self.label(), self.n());
        Err(malformed!("{}: its records name {what}: they share more than is read", self.format.label(lump)))
    }
}
