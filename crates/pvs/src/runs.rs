//! Sets of indices as bytes: runs of consecutive ones. Where cells are numbered from place to place, what a cell sees is few runs.
//!
//! A set is the number of its runs, and for each how many indices lie between it and the one before, and its length less one: all as
//! varints, with seven bits in a byte, the low ones first, and a top bit that is set if more follow.

use std::ops::Range;

/// Appends a number as a varint.
pub fn write_varint(mut x: u64, out: &mut Vec<u8>) {
    while x >= 0x80 {
        out.push(x as u8 | 0x80);
        x >>= 7;
    }
    out.push(x as u8);
}

/// Takes a varint from the front of `bytes`; `None` if there is none, or one of more than 64 bits.
pub fn read_varint(bytes: &mut &[u8]) -> Option<u64> {
    let mut x = 0u64;
    for shift in (0..u64::BITS).step_by(7) {
        let (&byte, rest) = bytes.split_first()?;
        *bytes = rest;
        let part = u64::from(byte & 0x7F);
        if part << shift >> shift != part {
            return None;
        }
        x |= part << shift;
        if byte < 0x80 {
            return Some(x);
        }
    }
    None
}

/// The runs of ascending indices.
pub fn runs_of(indices: impl IntoIterator<Item = u32>) -> Vec<Range<u32>> {
    let mut runs: Vec<Range<u32>> = Vec::new();
    for i in indices {
        match runs.last_mut() {
            Some(last) if last.end == i => last.end += 1,
            _ => runs.push(i..i + 1),
        }
    }
    runs
}

/// Appends a set, given by its runs: ascending, not empty, and with at least one index between two of them.
pub fn write_runs(runs: &[Range<u32>], out: &mut Vec<u8>) {
    write_varint(runs.len() as u64, out);
    let mut end = 0;
    for run in runs {
        write_varint(u64::from(run.start - end), out);
        write_varint(u64::from(run.end - run.start - 1), out);
        end = run.end;
    }
}

/// Takes a set of indices below `n` from the front of `bytes`; `None` if there is none. Memory in proportion to the bytes.
pub fn read_runs(bytes: &mut &[u8], n: u32) -> Option<Vec<Range<u32>>> {
    let count = read_varint(bytes)?;
    // Each takes two bytes at least.
    let count = usize::try_from(count).ok().filter(|count| *count <= bytes.len() / 2)?;
    let mut runs: Vec<Range<u32>> = Vec::with_capacity(count);
    let mut end = 0u32;
    for k in 0..count {
        let gap = u32::try_from(read_varint(bytes)?).ok().filter(|gap| k == 0 || *gap > 0)?;
        let length = u32::try_from(read_varint(bytes)?).ok()?.checked_add(1)?;
        let start = end.checked_add(gap)?;
        end = start.checked_add(length).filter(|end| *end <= n)?;
        runs.push(start..end);
    }
    Some(runs)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn sets_come_back(set in prop::collection::btree_set(0u32..500, 0..200), after in any::<u64>()) {
            let runs = runs_of(set.iter().copied());
            prop_assert!(runs.windows(2).all(|pair| pair[0].end < pair[1].start));
            let mut bytes = Vec::new();
            write_runs(&runs, &mut bytes);
            write_varint(after, &mut bytes);
            let mut rest = &bytes[..];
            let found = read_runs(&mut rest, 500).unwrap();
            prop_assert_eq!(found.iter().cloned().flatten().collect::<Vec<_>>(), set.iter().copied().collect::<Vec<_>>());
            prop_assert_eq!((read_varint(&mut rest), rest.len()), (Some(after), 0));
            // One index less would not hold the largest.
            if let Some(last) = runs.last() {
                prop_assert_eq!(read_runs(&mut &bytes[..], last.end - 1), None);
            }
        }

        #[test]
        fn any_bytes_are_a_set_or_none(bytes in prop::collection::vec(any::<u8>(), 0..40), n in any::<u32>()) {
            if let Some(runs) = read_runs(&mut &bytes[..], n) {
                prop_assert!(runs.iter().all(|run| run.start < run.end && run.end <= n));
                prop_assert!(runs.windows(2).all(|pair| pair[0].end < pair[1].start));
            }
        }
    }

    #[test]
    fn numbers_that_are_too_large_are_none() {
        let mut bytes = vec![0xFF; 9];
        bytes.push(1);
        assert_eq!(read_varint(&mut &bytes[..]), Some(u64::MAX));
        bytes[9] = 2;
        assert_eq!(read_varint(&mut &bytes[..]), None);
        assert_eq!(read_varint(&mut &[0x80][..]), None);
        // Two runs next to each other are one.
        assert_eq!(read_runs(&mut &[2, 0, 0, 0, 0][..], 9), None);
        assert_eq!(read_runs(&mut &[1, 0xFF, 0xFF, 0xFF, 0xFF, 0x0F, 0][..], u32::MAX), None);
    }
}
