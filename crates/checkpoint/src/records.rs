//! The form of files of results: a header, and records that each have a checksum.
//!
//! All numbers are little-endian. The header is [`MAGIC`], the version of the form (`u32`), the key (16 bytes), the length of the program's
//! version (`u16`) and the version itself, and a CRC-32 of all that. A record is a CRC-32 of the rest of it, the length of the phase's name (`u16`), the unit
//! (`u64`), the length of the result (`u64`), the name, the result. In a finished file the last record has no name; its unit is the number of the others.

use crate::error::StateError;
use crate::key::Key;
use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::path::Path;

pub(crate) const MAGIC: [u8; 8] = *b"SLUNITS\n";
const VERSION: u32 = 1;
/// Bytes of a header before the program's version.
const HEAD: usize = 8 + 4 + 16 + 2;
/// Bytes of a record before the name of its phase.
const RECORD_HEAD: usize = 4 + 2 + 8 + 8;

/// Whose results a file has.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Owner {
    pub(crate) key: Key,
    pub(crate) program: String,
}

impl Owner {
    pub(crate) fn header(&self) -> Vec<u8> {
        let program = &self.program.as_bytes()[..self.program.len().min(usize::from(u16::MAX))];
        let mut bytes = MAGIC.to_vec();
        bytes.extend(VERSION.to_le_bytes());
        bytes.extend(self.key.0);
        bytes.extend((program.len() as u16).to_le_bytes());
        bytes.extend(program);
        bytes.extend(crc32fast::hash(&bytes).to_le_bytes());
        bytes
    }
}

/// A record with its checksum.
pub(crate) fn record(phase: &str, unit: u64, result: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(RECORD_HEAD + phase.len() + result.len());
    bytes.extend([0; 4]);
    bytes.extend((phase.len() as u16).to_le_bytes());
    bytes.extend(unit.to_le_bytes());
    bytes.extend((result.len() as u64).to_le_bytes());
    bytes.extend(phase.as_bytes());
    bytes.extend(result);
    let crc = crc32fast::hash(&bytes[4..]);
    bytes[..4].copy_from_slice(&crc.to_le_bytes());
    bytes
}

/// Where a record is in its file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Place {
    pub(crate) offset: u64,
    pub(crate) n_bytes: u64,
}

/// What a file holds.
#[derive(Debug)]
pub(crate) struct Scan {
    pub(crate) owner: Owner,
    /// Phase, unit and place of each record, as they come.
    pub(crate) records: Vec<(String, u64, Place)>,
    /// Where the last whole record ends.
    pub(crate) end: u64,
    /// Whether the file ends with the record of a finished one, and there are as many others as that states.
    pub(crate) is_finished: bool,
    /// Whether something comes after `end`.
    pub(crate) is_torn: bool,
}

/// Reads a file once, checks every record, and keeps where they are. `None` for a file that is empty, as some systems leave one whose writer was stopped.
///
/// # Errors
/// [`StateError::Read`], and [`StateError::NotState`] for a file without a sound header.
pub(crate) fn scan(path: &Path, file: &File) -> Result<Option<Scan>, StateError> {
    let failed = |source| StateError::read(path, source);
    let n_bytes = file.metadata().map_err(failed)?.len();
    let mut reader = BufReader::with_capacity(1 << 16, file);
    reader.seek(SeekFrom::Start(0)).map_err(failed)?;
    if n_bytes == 0 {
        return Ok(None);
    }
    let (owner, mut end) =
        read_header(&mut reader).map_err(failed)?.ok_or_else(|| StateError::NotState(path.to_owned()))?;
    let (mut records, mut is_finished) = (Vec::new(), false);
    while let Some((phase, unit, n)) = read_record(&mut reader, n_bytes.saturating_sub(end)).map_err(failed)? {
        if phase.is_empty() {
            is_finished = unit == records.len() as u64;
            end += if is_finished { n } else { 0 };
            break;
        }
        records.push((phase, unit, Place { offset: end, n_bytes: n }));
        end += n;
    }
    Ok(Some(Scan { owner, records, end, is_finished, is_torn: end < n_bytes }))
}

/// The header, and its length; `None` if it is not sound.
fn read_header(reader: &mut impl Read) -> io::Result<Option<(Owner, u64)>> {
    let mut head = [0; HEAD];
    if !fill(reader, &mut head)? || head[..8] != MAGIC || head[8..12] != VERSION.to_le_bytes() {
        return Ok(None);
    }
    let mut program = vec![0; usize::from(u16::from_le_bytes([head[HEAD - 2], head[HEAD - 1]]))];
    let mut crc = [0; 4];
    if !fill(reader, &mut program)? || !fill(reader, &mut crc)? {
        return Ok(None);
    }
    let mut hasher = crc32fast::Hasher::new();
    hasher.update(&head);
    hasher.update(&program);
    let n = (HEAD + program.len() + crc.len()) as u64;
    let (Ok(program), Some(key)) = (String::from_utf8(program), head[12..28].first_chunk()) else { return Ok(None) };
    let owner = Owner { key: Key(*key), program };
    Ok((hasher.finalize().to_le_bytes() == crc).then_some((owner, n)))
}

/// The phase, the unit and the length of the record that begins here, of the `left` bytes that are left; `None` if there is no sound one.
fn read_record(reader: &mut impl Read, left: u64) -> io::Result<Option<(String, u64, u64)>> {
    let mut head = [0; RECORD_HEAD];
    if left < RECORD_HEAD as u64 || !fill(reader, &mut head)? {
        return Ok(None);
    }
    let Head { crc, n_name, unit, n_result } = parse_head(&head);
    let n = (RECORD_HEAD as u64).checked_add(n_name as u64).and_then(|n| n.checked_add(n_result));
    let Some(n) = n.filter(|&n| n <= left) else { return Ok(None) };
    let mut name = vec![0; n_name];
    if !fill(reader, &mut name)? {
        return Ok(None);
    }
    let mut hasher = crc32fast::Hasher::new();
    hasher.update(&head[4..]);
    hasher.update(&name);
    let mut rest = n_result;
    let mut buffer = [0; 1 << 13];
    while rest > 0 {
        let part = &mut buffer[..rest.min(1 << 13) as usize];
        if !fill(reader, part)? {
            return Ok(None);
        }
        hasher.update(part);
        rest -= part.len() as u64;
    }
    let is_sound = hasher.finalize() == crc;
    Ok(String::from_utf8(name).ok().filter(|_| is_sound).map(|name| (name, unit, n)))
}

struct Head {
    crc: u32,
    n_name: usize,
    unit: u64,
    n_result: u64,
}

fn parse_head(head: &[u8; RECORD_HEAD]) -> Head {
    let [c0, c1, c2, c3, n0, n1, rest @ ..] = *head;
    let [u0, u1, u2, u3, u4, u5, u6, u7, r0, r1, r2, r3, r4, r5, r6, r7] = rest;
    Head {
        crc: u32::from_le_bytes([c0, c1, c2, c3]),
        n_name: usize::from(u16::from_le_bytes([n0, n1])),
        unit: u64::from_le_bytes([u0, u1, u2, u3, u4, u5, u6, u7]),
        n_result: u64::from_le_bytes([r0, r1, r2, r3, r4, r5, r6, r7]),
    }
}

/// The result in the record at a place, if it still is the record of that unit.
pub(crate) fn load(file: &mut File, place: Place, phase: &str, unit: u64) -> io::Result<Option<Vec<u8>>> {
    file.seek(SeekFrom::Start(place.offset))?;
    let mut bytes = vec![0; usize::try_from(place.n_bytes).map_err(|_| io::ErrorKind::OutOfMemory)?];
    if !fill(file, &mut bytes)? {
        return Ok(None);
    }
    let Some(Head { crc, n_name, unit: of, n_result }) = bytes.first_chunk().map(parse_head) else { return Ok(None) };
    let is_whole = RECORD_HEAD as u64 + n_name as u64 + n_result == place.n_bytes;
    let is_it = is_whole && of == unit && bytes[RECORD_HEAD..].starts_with(phase.as_bytes()) && n_name == phase.len();
    if !is_it || crc32fast::hash(&bytes[4..]) != crc {
        return Ok(None);
    }
    bytes.drain(..RECORD_HEAD + n_name);
    Ok(Some(bytes))
}

/// Fills a buffer; false if there is less to read.
fn fill(reader: &mut impl Read, buffer: &mut [u8]) -> io::Result<bool> {
    match reader.read_exact(buffer) {
        Ok(()) => Ok(true),
        Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => Ok(false),
        Err(error) => Err(error),
    }
}
