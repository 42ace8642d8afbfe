//! Truncated and changed files are refused, or answer as before; nothing panics.

use crate::common::{SMALL, table};
use sightlines_packed::{PackOptions, Packed, PackedError, pack};
use sightlines_pvs::{CellId, ObjectId, PlaceBuffer, Table};

/// Makes all queries; each must give an answer or an error.
pub(crate) fn ask_all(packed: &Packed<Vec<u8>>) -> usize {
    let (mut cells, mut numbers, mut nodes, mut n_errors) = (Vec::new(), Vec::new(), Vec::new(), 0);
    let mut count = |result: Result<(), PackedError>| n_errors += usize::from(result.is_err());
    for cell in (0..packed.n_cells().min(100) as u32).map(CellId) {
        count(packed.visible(cell, &mut cells));
        count(packed.coarse(cell, &mut cells));
        count(packed.objects_of(cell, &mut numbers));
        count(packed.objects_seen(cell, &mut numbers));
        count(packed.visible_ranges(cell, &mut Vec::new()));
        count(packed.exits(cell, &mut |_, _, _, _| {}));
        count(packed.stab_roots(cell, &mut nodes).map(drop));
        count(packed.group(cell).map(drop));
        count(packed.cell_name(cell).map(drop));
        count(packed.cell_polygon(cell, &mut Vec::new()));
        let found = packed.cell_box(cell);
        count(packed.cells_at(found.as_ref().map_or([0.0; 3], |found| found.0), &mut PlaceBuffer::new()).map(drop));
        count(found.map(drop));
    }
    for object in 0..packed.n_objects().min(100) as u32 {
        count(packed.object_box(ObjectId(object)).map(drop));
        count(packed.object_name(ObjectId(object)).map(drop));
    }
    for node in 0..packed.n_stab_nodes().unwrap_or(0).min(100) {
        count(packed.stab_node(node, &mut nodes).map(drop));
    }
    n_errors
}

fn read(bytes: Vec<u8>) -> Result<Table, PackedError> {
    let packed = Packed::open(bytes, 1 << 16)?;
    ask_all(&packed);
    packed.verify()?;
    packed.to_table()
}

#[test]
fn every_prefix_is_refused() {
    let mut n = 0;
    for recipe in SMALL {
        let bytes = pack(&table(recipe), &PackOptions::default()).unwrap();
        assert!(read(bytes.clone()).is_ok());
        for len in 0..bytes.len() {
            assert!(Packed::open(bytes[..len].to_vec(), 0).is_err(), "{len} of {} bytes", bytes.len());
            n += 1;
        }
        let mut longer = bytes;
        longer.push(0);
        assert!(Packed::open(longer, 0).is_err());
    }
    assert!(n > 1000, "{n} prefixes");
}

/// Every byte is covered by a checksum: the full check detects a change of any byte, and opening a file detects one of
/// any resident byte.
#[test]
fn every_changed_byte_is_noticed() {
    let mut n = [0; 2];
    for recipe in SMALL {
        let table = table(recipe);
        let bytes = pack(&table, &PackOptions::default()).unwrap();
        let first_block = bytes.len() - n_block_bytes(&bytes);
        for at in 0..bytes.len() {
            let mut changed = bytes.clone();
            changed[at] ^= 1 << (at % 8);
            let opened = Packed::open(changed.clone(), 0);
            assert_eq!(opened.is_ok(), at >= first_block, "byte {at}");
            assert!(read(changed).is_err(), "byte {at}");
            n[usize::from(at >= first_block)] += 1;
        }
    }
    assert!(n[0] > 500 && n[1] > 200, "{n:?} resident and other bytes");
}

fn number(bytes: &[u8], at: usize, n: usize) -> u64 {
    bytes[at..at + n].iter().rev().fold(0, |x, &b| x << 8 | u64::from(b))
}

/// Offset and length of the sections, from the description of the format.
fn sections(bytes: &[u8]) -> Vec<(usize, usize)> {
    let section = |i: usize| (number(bytes, 24 + 24 * i + 8, 8) as usize, number(bytes, 24 + 24 * i + 16, 4) as usize);
    (0..number(bytes, 12, 4) as usize).map(section).collect()
}

fn n_block_bytes(bytes: &[u8]) -> usize {
    let (offset, length) = *sections(bytes).last().unwrap();
    bytes.len() - (offset + length)
}

/// Corrects the checksums of sections and header.
fn seal(bytes: &mut [u8]) {
    let all = sections(bytes);
    for (i, &(offset, length)) in all.iter().enumerate() {
        let crc = crc32(&bytes[offset..offset + length]);
        bytes[24 + 24 * i + 20..24 + 24 * i + 24].copy_from_slice(&crc.to_le_bytes());
    }
    let end = 24 + 24 * all.len();
    let crc = crc32(&bytes[..end]);
    bytes[end..end + 4].copy_from_slice(&crc.to_le_bytes());
}

/// A file that claims four thousand million objects in an unchanged small block: a game would allocate memory for each.
#[test]
fn numbers_of_objects_are_held_against_blocks() {
    let bytes = pack(&table(SMALL[0]), &PackOptions::default()).unwrap();
    let named = |id: &[u8]| (0..).find(|i| &bytes[24 + 24 * i..24 + 24 * i + 4] == id).map(|i| sections(&bytes)[i].0);
    let (head, blocks) = (named(b"HEAD").unwrap(), named(b"BLKS").unwrap());
    let objects = (blocks..).find(|&at| &bytes[at..at + 4] == b"OBJS").unwrap();
    let n = Packed::open(bytes.clone(), 0).unwrap().n_objects();
    for (claimed, right) in [(n, true), (1000 * n, false), (u32::MAX as usize, false)] {
        let mut lie = bytes.clone();
        let number = (claimed as u32).to_le_bytes();
        // The number of records, and as many in a block, so that there is one block.
        for at in [head + 8, objects + 4, objects + 8] {
            lie[at..at + 4].copy_from_slice(&number);
        }
        // Without its own rows of objects, whose length would be wrong.
        lie[head + 20] &= !2;
        seal(&mut lie);
        assert_eq!(Packed::open(lie, 0).is_ok(), right, "{claimed} objects");
    }
}

/// What a patient vandal would write: changed resident bytes with correct checksums.
#[test]
fn lies_with_right_checksums_are_refused_or_answered() {
    let (mut n_opened, mut n_refused) = (0, 0);
    for recipe in SMALL {
        let bytes = pack(&table(recipe), &PackOptions::default()).unwrap();
        for (offset, length) in sections(&bytes) {
            for (at, value) in (offset..offset + length).flat_map(|at| [1u8, 0xFF].map(|value| (at, value))) {
                let mut changed = bytes.clone();
                changed[at] = value;
                seal(&mut changed);
                match Packed::open(changed, 1 << 12) {
                    Err(_) => n_refused += 1,
                    Ok(packed) => {
                        ask_all(&packed);
                        let _ = packed.verify();
                        n_opened += 1;
                    }
                }
            }
        }
    }
    assert!(n_opened > 1000 && n_refused > 1000, "{n_opened} opened, {n_refused} refused");
}

/// The checksum bit by bit, from its definition: a different method from the crate's.
fn crc32(bytes: &[u8]) -> u32 {
    let step = |crc: u32| (0..8).fold(crc, |crc, _| if crc & 1 == 1 { crc >> 1 ^ 0xEDB8_8320 } else { crc >> 1 });
    !bytes.iter().fold(u32::MAX, |crc, &byte| step(crc ^ u32::from(byte)))
}

/// A file whose block `wanted` is unpacked, passed to `change`, and stored again, with all checksums correct; `None` if
/// there are not that many blocks.
fn with_block(bytes: &[u8], wanted: usize, change: impl FnOnce(&mut Vec<u8>)) -> Option<Vec<u8>> {
    let (index, n_index) = *sections(bytes).last()?;
    let (mut at, mut offset, mut seen) = (index + 4, index + n_index, 0);
    loop {
        if at >= index + n_index {
            return None;
        }
        let n_blocks = number(bytes, at + 4, 4).div_ceil(number(bytes, at + 8, 4)) as usize;
        at += 12;
        if seen + n_blocks > wanted {
            break;
        }
        offset += (0..n_blocks).map(|k| number(bytes, at + 12 * k, 4) as usize).sum::<usize>();
        (at, seen) = (at + 12 * n_blocks, seen + n_blocks);
    }
    offset += (seen..wanted).map(|k| number(bytes, at + 12 * (k - seen), 4) as usize).sum::<usize>();
    at += 12 * (wanted - seen);
    let (len, raw) = (number(bytes, at, 4) as usize, number(bytes, at + 4, 4) as usize);
    let packed = &bytes[offset..offset + len];
    let mut block = if len == raw { packed.to_vec() } else { zstd::bulk::decompress(packed, raw).unwrap() };
    change(&mut block);
    let mut out = [&bytes[..offset], &block[..], &bytes[offset + len..]].concat();
    for (k, field) in [block.len() as u32, block.len() as u32, crc32(&block)].into_iter().enumerate() {
        out[at + 4 * k..at + 4 * k + 4].copy_from_slice(&field.to_le_bytes());
    }
    let total = out.len() as u64;
    out[16..24].copy_from_slice(&total.to_le_bytes());
    let n = sections(bytes).len();
    let crc = crc32(&out[index..index + n_index]);
    out[24 + 24 * n - 4..24 + 24 * n].copy_from_slice(&crc.to_le_bytes());
    let crc = crc32(&out[..24 + 24 * n]);
    out[24 + 24 * n..28 + 24 * n].copy_from_slice(&crc.to_le_bytes());
    Some(out)
}

/// The same in blocks: wrong contents with correct checksums.
#[test]
fn blocks_that_lie_with_right_checksums_are_refused_or_answered() {
    let (mut n_files, mut n_errors, mut n_blocks) = (0, 0, 0);
    for recipe in SMALL {
        let table = table(recipe);
        let bytes = pack(&table, &PackOptions::default()).unwrap();
        for wanted in 0.. {
            let mut n = 0;
            let Some(same) = with_block(&bytes, wanted, |block| n = block.len()) else { break };
            assert_eq!(read(same).unwrap(), table, "an unpacked block says the same");
            n_blocks += 1;
            for (at, value) in (0..n).flat_map(|at| [0u8, 0x7F, 0xFF].map(|value| (at, value))) {
                let lie = with_block(&bytes, wanted, |block| block[at] = value).unwrap();
                let packed = Packed::open(lie, 1 << 16).expect("only a block was changed");
                n_errors += ask_all(&packed);
                let _ = packed.verify();
                n_files += 1;
            }
            // Also a block that is truncated.
            let cut = with_block(&bytes, wanted, |block| block.truncate(n / 2)).unwrap();
            assert!(read(cut).is_err());
        }
    }
    assert!(
        n_blocks >= 10 && n_files > 3000 && n_errors > 3000,
        "{n_blocks} blocks, {n_files} files, {n_errors} errors"
    );
}
