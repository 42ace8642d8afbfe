//! Files taken apart and reassembled, with correct checksums: what a patient vandal would write.
//!
//! Written from the description of the format, independently of the code under test.

use prop::sample::Index;
use proptest::prelude::*;
use sightlines_pvs::{DecodeErrorKind, Table};

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Part {
    pub(crate) id: [u8; 4],
    pub(crate) flags: u32,
    pub(crate) bytes: Vec<u8>,
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct File {
    pub(crate) major: u16,
    pub(crate) minor: u16,
    pub(crate) parts: Vec<Part>,
}

fn number(bytes: &[u8], at: usize, n: usize) -> u64 {
    bytes[at..at + n].iter().rev().fold(0, |x, &b| x << 8 | u64::from(b))
}

impl File {
    pub(crate) fn parse(bytes: &[u8]) -> Self {
        let part = |i: usize| {
            let at = 24 + 32 * i;
            let (offset, length) = (number(bytes, at + 8, 8) as usize, number(bytes, at + 16, 8) as usize);
            let id = bytes[at..at + 4].try_into().expect("four bytes");
            Part { id, flags: number(bytes, at + 4, 4) as u32, bytes: bytes[offset..offset + length].to_vec() }
        };
        let parts = (0..number(bytes, 12, 4) as usize).map(part).collect();
        Self { major: number(bytes, 8, 2) as u16, minor: number(bytes, 10, 2) as u16, parts }
    }

    pub(crate) fn part(&mut self, id: &[u8; 4]) -> &mut Part {
        self.parts.iter_mut().find(|part| part.id == *id).expect("the section is there")
    }

    pub(crate) fn write(&self) -> Vec<u8> {
        let mut body = Vec::new();
        let mut table = Vec::new();
        let first = 24 + 32 * self.parts.len() + 8;
        for part in &self.parts {
            table.extend(part.id);
            table.extend(part.flags.to_le_bytes());
            table.extend(((first + body.len()) as u64).to_le_bytes());
            table.extend((part.bytes.len() as u64).to_le_bytes());
            table.extend(u64::from(crc32fast::hash(&part.bytes)).to_le_bytes());
            body.extend(&part.bytes);
            while body.len() % 8 != 0 {
                body.push(0);
            }
        }
        let mut out = b"\x89PVS\r\n\x1a\n".to_vec();
        out.extend(self.major.to_le_bytes());
        out.extend(self.minor.to_le_bytes());
        out.extend((self.parts.len() as u32).to_le_bytes());
        out.extend(((first + body.len()) as u64).to_le_bytes());
        out.extend(table);
        out.extend(u64::from(crc32fast::hash(&out)).to_le_bytes());
        out.extend(body);
        out
    }
}

/// Corrects the checksum of header and section table, if the table's position can be found.
pub(crate) fn fix_header(bytes: &mut [u8]) {
    let end = 24 + 32 * number(bytes, 12, 4) as usize;
    if end + 4 <= bytes.len() {
        let crc = crc32fast::hash(&bytes[..end]);
        bytes[end..end + 4].copy_from_slice(&crc.to_le_bytes());
    }
}

/// Panics unless the table's bytes are refused when they are truncated at a position, and with the byte there changed.
pub(crate) fn assert_damage_is_noticed(table: &Table, at: Index, flip: u8) {
    let bytes = table.to_bytes();
    let at = at.index(bytes.len());
    assert!(Table::from_bytes(&bytes[..at]).is_err(), "cut to {at} bytes");
    let mut changed = bytes;
    changed[at] ^= flip;
    assert!(Table::from_bytes(&changed).is_err(), "byte {at} changed");
}

/// Panics unless every strict prefix of the table's bytes is refused.
pub(crate) fn assert_every_prefix_is_an_error(table: &Table) {
    let bytes = table.to_bytes();
    assert!((0..bytes.len()).all(|n| Table::from_bytes(&bytes[..n]).is_err()));
}

/// Panics unless the table's bytes are refused with any byte changed into any other value.
pub(crate) fn assert_every_changed_byte_is_an_error(table: &Table) {
    let mut bytes = table.to_bytes();
    let mut n_tried = 0;
    for at in 0..bytes.len() {
        for flip in 1..=255 {
            bytes[at] ^= flip;
            assert!(Table::from_bytes(&bytes).is_err(), "byte {at} xor {flip}");
            bytes[at] ^= flip;
            n_tried += 1;
        }
    }
    assert_eq!((n_tried, &Table::from_bytes(&bytes).unwrap()), (255 * bytes.len(), table));
}

/// Changes every byte of some sections into every other value, with correct checksums, and cuts them short: a file is read as it is written, or refused. How
/// many were read, and how many not.
pub(crate) fn forge_every_byte(
    table: &Table,
    is_forged: impl Fn(&[u8; 4]) -> bool,
    check: impl Fn(&Table),
) -> [usize; 2] {
    let file = File::parse(&table.to_bytes());
    assert_eq!(file.write(), table.to_bytes(), "the files of these tests are right themselves");
    let (mut n_tables, mut n_errors) = (0, 0);
    for part in (0..file.parts.len()).filter(|&i| is_forged(&file.parts[i].id)) {
        for at in 0..file.parts[part].bytes.len() {
            let mut forged = file.clone();
            for flip in 1..=255 {
                forged.parts[part].bytes[at] = file.parts[part].bytes[at] ^ flip;
                let bytes = forged.write();
                match Table::from_bytes(&bytes) {
                    Ok(read) => {
                        check(&read);
                        assert_eq!(read.to_bytes(), bytes, "not written as it was read");
                        n_tables += 1;
                    }
                    Err(error) => {
                        assert!(error.offset <= bytes.len() as u64, "{error}");
                        n_errors += 1;
                    }
                }
            }
            forged.parts[part].bytes.truncate(at);
            assert!(Table::from_bytes(&forged.write()).is_err(), "section cut to {at} bytes");
        }
    }
    [n_tables, n_errors]
}

/// A random change of the bytes of a section.
#[derive(Debug)]
pub(crate) struct Change {
    /// Selects the section.
    pub(crate) part: Index,
    place: Index,
    action: u8,
    value: u8,
}

/// One to three changes.
pub(crate) fn changes() -> impl Strategy<Value = Vec<Change>> {
    let change = (any::<Index>(), any::<Index>(), 0u8..6, any::<u8>());
    prop::collection::vec(change.prop_map(|(part, place, action, value)| Change { part, place, action, value }), 1..4)
}

impl Change {
    /// Truncates the bytes, inserts or removes one, or changes one.
    pub(crate) fn apply(&self, bytes: &mut Vec<u8>) {
        let at = self.place.index(bytes.len() + 1);
        match self.action {
            0 => bytes.truncate(at),
            1 => bytes.insert(at, self.value),
            2 if at < bytes.len() => drop(bytes.remove(at)),
            3 if at < bytes.len() => bytes[at] ^= 1 << (self.value % 8),
            _ if at < bytes.len() => bytes[at] = self.value,
            _ => {}
        }
    }
}

/// The error for the table's file with a section changed, which must name the section.
pub(crate) fn forged(table: &Table, id: &[u8; 4], change: impl FnOnce(&mut Vec<u8>)) -> DecodeErrorKind {
    let mut file = File::parse(&table.to_bytes());
    change(&mut file.part(id).bytes);
    let error = Table::from_bytes(&file.write()).unwrap_err();
    assert_eq!(error.section.unwrap().0, *id);
    error.kind
}
