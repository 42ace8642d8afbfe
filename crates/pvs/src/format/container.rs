//! Header, section table, checksums: everything in the file except the meaning of sections.

use super::error::{DecodeError, DecodeErrorKind as Kind, SectionId};
use super::writer::Writer;
use super::{ENTRY, FIXED, KNOWN, MAGIC, MAJOR, OPTIONAL};
use std::collections::BTreeSet;

/// A section to be written.
pub(super) struct Payload<'a> {
    pub(super) id: SectionId,
    /// Appends its bytes.
    pub(super) fill: Box<dyn FnOnce(&mut Writer) + 'a>,
}

/// A known section with the right checksum.
#[derive(Clone, Copy)]
pub(super) struct Section<'a> {
    pub(super) id: SectionId,
    pub(super) offset: usize,
    pub(super) bytes: &'a [u8],
}

/// Whether this version has the section; if so, whether it is optional.
fn known(id: SectionId) -> Option<bool> {
    KNOWN.iter().find(|(known, ..)| *known == id).map(|&(_, optional, _)| optional)
}

/// Writes the sections behind a header. None is held twice: large tables have sections of hundreds of megabytes.
pub(super) fn write(sections: Vec<Payload<'_>>) -> Vec<u8> {
    let first = FIXED + ENTRY * sections.len() + 8;
    let mut out = Writer(vec![0; first]);
    let mut entries: Vec<(SectionId, [usize; 2])> = Vec::with_capacity(sections.len());
    for Payload { id, fill } in sections {
        let begin = out.0.len();
        fill(&mut out);
        entries.push((id, [begin, out.0.len()]));
        out.0.resize(out.0.len().next_multiple_of(8), 0);
    }
    let mut out = out.0;
    let mut header = Vec::with_capacity(first);
    header.extend(MAGIC);
    header.extend(MAJOR.to_le_bytes());
    let written = |id: SectionId| entries.iter().any(|entry| entry.0 == id);
    let minor = KNOWN.iter().filter(|known| written(known.0)).map(|known| known.2).max().unwrap_or(0);
    header.extend(minor.to_le_bytes());
    header.extend((entries.len() as u32).to_le_bytes());
    header.extend((out.len() as u64).to_le_bytes());
    for &(id, [begin, end]) in &entries {
        let flags = if known(id) == Some(false) { 0 } else { OPTIONAL };
        header.extend(id.0);
        header.extend(flags.to_le_bytes());
        header.extend((begin as u64).to_le_bytes());
        header.extend(((end - begin) as u64).to_le_bytes());
        header.extend(crc32fast::hash(&out[begin..end]).to_le_bytes());
        header.extend([0; 4]);
    }
    header.extend(crc32fast::hash(&header).to_le_bytes());
    header.extend([0; 4]);
    out[..first].copy_from_slice(&header);
    out
}

/// Checks everything in the file except the meaning of sections; returns the minor version and the known sections.
pub(super) fn read(bytes: &[u8]) -> Result<(u16, Vec<Section<'_>>), DecodeError> {
    let entries = read_header(bytes)?;
    let mut end = FIXED + entries.len() + 8;
    let mut found: Vec<Section<'_>> = Vec::new();
    let mut ids: BTreeSet<SectionId> = BTreeSet::new();
    for (i, entry) in entries.chunks_exact(ENTRY).enumerate() {
        let at = FIXED + ENTRY * i;
        let (section, flags) = read_section(bytes, entry, at, &mut end)?;
        let fail = |kind| DecodeError { section: Some(section.id), offset: at as u64, kind };
        if !ids.insert(section.id) {
            return Err(fail(Kind::Repeated));
        }
        match known(section.id) {
            Some(optional) if flags != u32::from(optional) * OPTIONAL => return Err(fail(Kind::Flags { flags })),
            Some(_) => found.push(section),
            None if flags == OPTIONAL => {}
            None if flags == 0 => return Err(fail(Kind::Unknown)),
            None => return Err(fail(Kind::Flags { flags })),
        }
    }
    match end == bytes.len() {
        true => Ok((u16::from_le_bytes(array(bytes, 10)), found)),
        false => Err(DecodeError { section: None, offset: end as u64, kind: Kind::Misplaced }),
    }
}

/// Checks the header and its checksum; returns the section table.
fn read_header(bytes: &[u8]) -> Result<&[u8], DecodeError> {
    let fail = |offset: usize, kind| DecodeError { section: None, offset: offset as u64, kind };
    let len = bytes.len() as u64;
    if !MAGIC.starts_with(&bytes[..bytes.len().min(MAGIC.len())]) {
        return Err(fail(0, Kind::Magic));
    }
    let cut = |need| fail(bytes.len(), Kind::HeaderCut { need, len });
    let fixed = bytes.get(..FIXED).ok_or_else(|| cut(FIXED as u64 + 8))?;
    match u16::from_le_bytes(array(fixed, 8)) {
        MAJOR => {}
        major => return Err(fail(8, Kind::Major { major })),
    }
    let need = FIXED as u64 + ENTRY as u64 * u64::from(u32::from_le_bytes(array(fixed, 12))) + 8;
    let header = usize::try_from(need).ok().and_then(|need| bytes.get(..need)).ok_or_else(|| cut(need))?;
    let end = header.len() - 8;
    let (stored, computed) = (u32::from_le_bytes(array(header, end)), crc32fast::hash(&header[..end]));
    if stored != computed {
        return Err(fail(end, Kind::Checksum { stored, computed }));
    }
    check_zero(header, end + 4, header.len(), None)?;
    let stated = u64::from_le_bytes(array(fixed, 16));
    if stated != len {
        return Err(fail(16, Kind::Length { stated, len }));
    }
    Ok(&header[FIXED..end])
}

/// Checks one entry of the section table, at byte `at`, and the section's bytes, which must begin at
/// `end`; moves `end` behind them and their padding.
fn read_section<'a>(
    bytes: &'a [u8],
    entry: &[u8],
    at: usize,
    end: &mut usize,
) -> Result<(Section<'a>, u32), DecodeError> {
    let id = SectionId(array(entry, 0));
    let fail = |offset: usize, kind| DecodeError { section: Some(id), offset: offset as u64, kind };
    let (offset, length) = (u64::from_le_bytes(array(entry, 8)), u64::from_le_bytes(array(entry, 16)));
    let misplaced = || fail(at + 8, Kind::Misplaced);
    let begin = usize::try_from(offset).ok().filter(|&begin| begin == *end).ok_or_else(misplaced)?;
    let stop = usize::try_from(length).ok().and_then(|n| begin.checked_add(n)).ok_or_else(misplaced)?;
    let content = bytes.get(begin..stop).ok_or_else(misplaced)?;
    let padded = stop.checked_next_multiple_of(8).filter(|&p| p <= bytes.len()).ok_or_else(misplaced)?;
    let (stored, computed) = (u32::from_le_bytes(array(entry, 24)), crc32fast::hash(content));
    if stored != computed {
        return Err(fail(begin, Kind::Checksum { stored, computed }));
    }
    check_zero(entry, 28, ENTRY, Some(id)).map_err(|e| DecodeError { offset: e.offset + at as u64, ..e })?;
    check_zero(bytes, stop, padded, Some(id))?;
    *end = padded;
    Ok((Section { id, offset: begin, bytes: content }, u32::from_le_bytes(array(entry, 4))))
}

fn check_zero(bytes: &[u8], from: usize, to: usize, section: Option<SectionId>) -> Result<(), DecodeError> {
    match bytes[from..to].iter().position(|&b| b != 0) {
        Some(i) => Err(DecodeError { section, offset: (from + i) as u64, kind: Kind::NotZero }),
        None => Ok(()),
    }
}

/// The `N` bytes at `at`, which must exist.
pub(super) fn array<const N: usize>(bytes: &[u8], at: usize) -> [u8; N] {
    std::array::from_fn(|i| bytes[at + i])
}
