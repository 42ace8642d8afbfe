//! The form of files of results: a header, and records whose heads and bodies each have a checksum.
//!
//! All numbers are little-endian. The header is [`MAGIC`], the version of the form (`u32`), the key (16 bytes), a mark of the file (16 bytes; zeros in parts),
//! the length of the program's version (`u16`) and the version itself, and a CRC-32 of all that. A record is [`MARKER`], a CRC-32 of the rest of its head,
//! a CRC-32 of its body, the length of the phase's name (`u16`), the unit (`u64`) and the length of the result (`u64`), which end the head; then the name and
//! the result. The record with the unit [`DIVISION`] states how its phase is divided. In a finished file the last record has no name; its unit is the
//! number of the others.
//!
//! A record whose body is damaged is passed over by its length. Behind a head that is damaged, the next marker with a sound head goes on.

use crate::error::StateError;
use crate::key::Key;
use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::path::Path;

pub(crate) const MAGIC: [u8; 8] = *b"SLUNITS\n";
const VERSION: u32 = 2;
/// How states of searches of Quake maps began before their results were kept in this form.
const OLD_MAGIC: [u8; 8] = *b"\x8ESLVIS\r\n";
/// Bytes of a header before the program's version.
const HEAD: usize = 8 + 4 + 16 + 16 + 2;
/// How each record begins.
const MARKER: [u8; 4] = [0xf5, b'S', b'L', b'R'];
/// Bytes of a record before the name of its phase.
const RECORD_HEAD: usize = 4 + 4 + 4 + 2 + 8 + 8;
/// The unit of the record that states how a phase is divided.
pub(crate) const DIVISION: u64 = u64::MAX;

/// Whose results a file has.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Owner {
    pub(crate) key: Key,
    pub(crate) program: String,
}

impl Owner {
    /// The header of a file with a mark.
    pub(crate) fn header(&self, mark: [u8; 16]) -> Vec<u8> {
        let program = &self.program.as_bytes()[..self.program.len().min(usize::from(u16::MAX))];
        let mut bytes = MAGIC.to_vec();
        bytes.extend(VERSION.to_le_bytes());
        bytes.extend(self.key.0);
        bytes.extend(mark);
        bytes.extend((program.len() as u16).to_le_bytes());
        bytes.extend(program);
        bytes.extend(crc32fast::hash(&bytes).to_le_bytes());
        bytes
    }
}

/// A record with its checksums.
pub(crate) fn record(phase: &str, unit: u64, result: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(RECORD_HEAD + phase.len() + result.len());
    bytes.extend(MARKER);
    bytes.extend([0; 8]);
    bytes.extend((phase.len() as u16).to_le_bytes());
    bytes.extend(unit.to_le_bytes());
    bytes.extend((result.len() as u64).to_le_bytes());
    bytes.extend(phase.as_bytes());
    bytes.extend(result);
    let body = crc32fast::hash(&bytes[RECORD_HEAD..]);
    bytes[8..12].copy_from_slice(&body.to_le_bytes());
    let head = crc32fast::hash(&bytes[8..RECORD_HEAD]);
    bytes[4..8].copy_from_slice(&head.to_le_bytes());
    bytes
}

/// Where a record is in its file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct RecordSpan {
    pub(crate) offset: u64,
    pub(crate) n_bytes: u64,
}

/// What a file holds.
#[derive(Debug)]
pub(crate) struct Scan {
    pub(crate) header: Header,
    /// Phase, unit and place of each sound record, as they come.
    pub(crate) records: Vec<(String, u64, RecordSpan)>,
    /// Where the last whole record ends.
    pub(crate) end: u64,
    /// Whether the file ends with the record of a finished one, and there are as many others as that states.
    pub(crate) is_finished: bool,
    /// Whether something comes after `end`.
    pub(crate) is_torn: bool,
    /// Where damage before `end` begins.
    pub(crate) damage: Vec<u64>,
}

/// A header.
#[derive(Debug)]
pub(crate) struct Header {
    pub(crate) owner: Owner,
    pub(crate) mark: [u8; 16],
    n_bytes: u64,
}

/// Reads a file once, checks every record, and keeps where they are. `None` for a file that is empty or has only a part of a header, as some systems leave
/// one whose writer was stopped.
///
/// # Errors
/// [`StateError::Read`], [`StateError::OtherForm`] for a file in the form of another version, and [`StateError::NotState`] for one without a sound header.
pub(crate) fn scan(path: &Path, file: &File) -> Result<Option<Scan>, StateError> {
    let failed = |source| StateError::read(path, source);
    let n_bytes = file.metadata().map_err(failed)?.len();
    let mut reader = BufReader::with_capacity(1 << 16, file);
    let Some(header) = header(path, &mut reader)? else { return Ok(None) };
    let (mut records, mut damage, mut is_finished) = (Vec::new(), Vec::new(), false);
    // What is looked at, and the end of the last whole record.
    let (mut at, mut end) = (header.n_bytes, header.n_bytes);
    while let Some(found) = read_record(&mut reader, n_bytes.saturating_sub(at)).map_err(failed)? {
        let n = match found {
            Found::Record { phase, unit, n } if phase.is_empty() => {
                is_finished = unit == records.len() as u64;
                end = if is_finished { at + n } else { end };
                break;
            }
            Found::Record { phase, unit, n } => {
                records.push((phase, unit, RecordSpan { offset: at, n_bytes: n }));
                n
            }
            Found::Damaged { n } => {
                damage.push(at);
                n
            }
            Found::NoHead => match next_head(&mut reader, at + 1, n_bytes).map_err(failed)? {
                Some(next) => {
                    damage.push(at);
                    at = next;
                    continue;
                }
                None => break,
            },
        };
        at += n;
        end = at;
    }
    Ok(Some(Scan { header, records, end, is_finished, is_torn: end < n_bytes, damage }))
}

/// The header of a file; `None` for an empty one, and for one that ends within its header.
///
/// # Errors
/// As [`scan`].
pub(crate) fn header(path: &Path, reader: &mut (impl Read + Seek)) -> Result<Option<Header>, StateError> {
    let failed = |source| StateError::read(path, source);
    let not_state = || StateError::NotState(path.to_owned());
    reader.seek(SeekFrom::Start(0)).map_err(failed)?;
    let mut begin = Vec::new();
    reader.by_ref().take(12).read_to_end(&mut begin).map_err(failed)?;
    if begin.starts_with(&OLD_MAGIC) {
        return Err(StateError::OtherForm(path.to_owned()));
    }
    let n_same = begin.len().min(MAGIC.len());
    if begin[..n_same] != MAGIC[..n_same] {
        return Err(not_state());
    }
    let Some(version) = begin.get(8..12) else { return Ok(None) };
    if version != VERSION.to_le_bytes() {
        return Err(StateError::OtherForm(path.to_owned()));
    }
    reader.seek(SeekFrom::Start(0)).map_err(failed)?;
    let mut head = [0; HEAD];
    if !fill(reader, &mut head).map_err(failed)? {
        return Ok(None);
    }
    let mut program = vec![0; usize::from(u16::from_le_bytes([head[HEAD - 2], head[HEAD - 1]]))];
    let mut crc = [0; 4];
    if !fill(reader, &mut program).map_err(failed)? || !fill(reader, &mut crc).map_err(failed)? {
        return if program.len() < 256 { Ok(None) } else { Err(not_state()) };
    }
    let mut hasher = crc32fast::Hasher::new();
    hasher.update(&head);
    hasher.update(&program);
    let n_bytes = (HEAD + program.len() + crc.len()) as u64;
    let is_sound = hasher.finalize().to_le_bytes() == crc;
    match (String::from_utf8(program), head[12..28].first_chunk(), head[28..44].first_chunk()) {
        (Ok(program), Some(key), Some(mark)) if is_sound => {
            Ok(Some(Header { owner: Owner { key: Key(*key), program }, mark: *mark, n_bytes }))
        }
        _ => Err(not_state()),
    }
}

/// What is where a record should begin.
enum Found {
    Record {
        phase: String,
        unit: u64,
        n: u64,
    },
    /// The head of a record, and a body that is not what was written.
    Damaged {
        n: u64,
    },
    /// No sound head, or one of a record that is longer than the file.
    NoHead,
}

/// What is here, of the `left` bytes that are left; `None` at the end of the file.
fn read_record(reader: &mut impl Read, left: u64) -> io::Result<Option<Found>> {
    let mut head = [0; RECORD_HEAD];
    if left == 0 {
        return Ok(None);
    }
    if left < RECORD_HEAD as u64 || !fill(reader, &mut head)? {
        return Ok(Some(Found::NoHead));
    }
    let Some(Head { crc, n_name, unit, n, .. }) = parse_head(&head).filter(|head| head.n <= left) else {
        return Ok(Some(Found::NoHead));
    };
    let mut name = vec![0; n_name];
    if !fill(reader, &mut name)? {
        return Ok(None);
    }
    let mut hasher = crc32fast::Hasher::new();
    hasher.update(&name);
    let mut rest = n - RECORD_HEAD as u64 - n_name as u64;
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
    Ok(Some(match String::from_utf8(name) {
        Ok(phase) if is_sound => Found::Record { phase, unit, n },
        _ => Found::Damaged { n },
    }))
}

/// The first place from `from` on where a record begins that the file has room for; the reader is put there.
fn next_head(reader: &mut (impl Read + Seek), from: u64, n_bytes: u64) -> io::Result<Option<u64>> {
    const WINDOW: u64 = 1 << 16;
    let mut at = from;
    while at + RECORD_HEAD as u64 <= n_bytes {
        reader.seek(SeekFrom::Start(at))?;
        let mut window = Vec::new();
        reader.by_ref().take(WINDOW + RECORD_HEAD as u64 - 1).read_to_end(&mut window)?;
        let is_head = |(k, head): (usize, &[u8])| {
            let head = head.first_chunk().and_then(parse_head)?;
            Some(at + k as u64).filter(|place| head.n <= n_bytes - place)
        };
        if let Some(place) = window.windows(RECORD_HEAD).enumerate().find_map(is_head) {
            reader.seek(SeekFrom::Start(place))?;
            return Ok(Some(place));
        }
        at += WINDOW;
    }
    Ok(None)
}

struct Head {
    /// Of the body.
    crc: u32,
    n_name: usize,
    unit: u64,
    /// Bytes of the record.
    n: u64,
}

/// The head of a record, if it is sound.
fn parse_head(head: &[u8; RECORD_HEAD]) -> Option<Head> {
    if head[..4] != MARKER || crc32fast::hash(&head[8..]).to_le_bytes() != head[4..8] {
        return None;
    }
    let n_name = u16::from_le_bytes(*head[12..].first_chunk()?);
    let n_result = u64::from_le_bytes(*head[22..].first_chunk()?);
    Some(Head {
        crc: u32::from_le_bytes(*head[8..].first_chunk()?),
        n_name: usize::from(n_name),
        unit: u64::from_le_bytes(*head[14..].first_chunk()?),
        n: (RECORD_HEAD as u64 + u64::from(n_name)).checked_add(n_result)?,
    })
}

/// The result in the record at a place, if it still is the record of that unit.
pub(crate) fn load(file: &mut File, place: RecordSpan, phase: &str, unit: u64) -> io::Result<Option<Vec<u8>>> {
    file.seek(SeekFrom::Start(place.offset))?;
    let mut bytes = vec![0; usize::try_from(place.n_bytes).map_err(|_| io::ErrorKind::OutOfMemory)?];
    if !fill(file, &mut bytes)? {
        return Ok(None);
    }
    let Some(Head { crc, n_name, unit: of, n }) = bytes.first_chunk().and_then(parse_head) else { return Ok(None) };
    let is_it = n == place.n_bytes && of == unit && n_name == phase.len();
    if !is_it || !bytes[RECORD_HEAD..].starts_with(phase.as_bytes()) || crc32fast::hash(&bytes[RECORD_HEAD..]) != crc {
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
