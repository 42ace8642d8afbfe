//! The coding of rows of large files: bytes of bits that are not 0, each after the number of those that are.

use crate::bytes::{Reader, Writer};
use crate::error::{PackedError, PackedErrorKind as Kind};

/// Why items are no row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum RowDefect {
    /// An item is not below the limit.
    TooLarge,
    /// An item is not larger than the one before.
    Order,
}

/// Appends the coded row of ascending items below `limit` to `out`. O(items).
pub(crate) fn encode(items: impl Iterator<Item = u32>, limit: u32, out: &mut Vec<u8>) -> Result<(), RowDefect> {
    let mut writer = Writer(std::mem::take(out));
    let (mut next_byte, mut byte, mut mask) = (0, 0, 0u8);
    let mut last = None;
    let mut defect = None;
    for item in items {
        if item >= limit || last.is_some_and(|last| last >= item) {
            defect = Some(if item >= limit { RowDefect::TooLarge } else { RowDefect::Order });
            break;
        }
        last = Some(item);
        if item / 8 != byte && mask != 0 {
            writer.varint(u64::from(byte - next_byte));
            writer.0.push(mask);
            (next_byte, mask) = (byte + 1, 0);
        }
        byte = item / 8;
        mask |= 1 << (item % 8);
    }
    if mask != 0 {
        writer.varint(u64::from(byte - next_byte));
        writer.0.push(mask);
    }
    *out = writer.0;
    defect.map_or(Ok(()), Err)
}

/// Calls `visit` for each item of a coded row, ascending; all are below `limit`. O(items).
#[inline]
pub(crate) fn decode(r: &mut Reader<'_>, limit: u32, mut visit: impl FnMut(u32)) -> Result<(), PackedError> {
    let n_bytes = u64::from(limit).div_ceil(8);
    let mut next_byte = 0u64;
    while r.left() > 0 {
        let byte = next_byte.saturating_add(r.varint()?);
        let mut mask = r.take(1)?[0];
        // The bits of the last byte end at the limit.
        let stray = byte < n_bytes && byte + 1 == n_bytes && !limit.is_multiple_of(8) && mask >> (limit % 8) != 0;
        if byte >= n_bytes || mask == 0 || stray {
            return Err(r.fail(Kind::Value { value: byte.saturating_mul(8) }));
        }
        let first = 8 * byte as u32;
        while mask != 0 {
            visit(first + mask.trailing_zeros());
            mask &= mask - 1;
        }
        next_byte = byte + 1;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bytes::Origin;
    use proptest::prelude::*;
    use sightlines_pvs::SectionId;

    const PLACE: Origin = Origin { section: SectionId(*b"TEST"), offset: 7 };

    fn decoded(bytes: &[u8], limit: u32) -> Result<Vec<u32>, PackedError> {
        let mut out = Vec::new();
        decode(&mut Reader::new(bytes, PLACE), limit, |item| out.push(item)).map(|()| out)
    }

    /// Sets of items with long runs and long gaps, and a limit.
    fn rows() -> impl Strategy<Value = (Vec<u32>, u32)> {
        (prop::collection::btree_set((0u32..40, 0u32..60), 0..30), 1u32..3000).prop_map(|(runs, limit)| {
            let mut items: Vec<u32> =
                runs.iter().flat_map(|&(at, n)| 70 * at..70 * at + n).filter(|&item| item < limit).collect();
            items.dedup();
            items.sort_unstable();
            items.dedup();
            (items, limit)
        })
    }

    proptest! {
        #[test]
        fn rows_come_back((items, limit) in rows(), cut in any::<prop::sample::Index>()) {
            let mut bytes = vec![7];
            encode(items.iter().copied(), limit, &mut bytes).unwrap();
            prop_assert_eq!(bytes[0], 7);
            prop_assert_eq!(&decoded(&bytes[1..], limit).unwrap(), &items);
            // Each byte that is not 0 is there once: no coding of these bytes is shorter than their number.
            let mut masks: Vec<u32> = items.iter().map(|item| item / 8).collect();
            masks.dedup();
            prop_assert!(bytes.len() > 2 * masks.len() && bytes.len() <= 1 + 3 * masks.len());
            if let Some(&last) = items.last() {
                // The twin: a limit that is too small is refused, in both directions.
                prop_assert!(decoded(&bytes[1..], last).is_err());
                prop_assert_eq!(encode(items.iter().copied(), last, &mut Vec::new()), Err(RowDefect::TooLarge));
                let twice = items.iter().copied().chain([last]);
                prop_assert_eq!(encode(twice, limit, &mut Vec::new()), Err(RowDefect::Order));
            }
            // A row that ends early is refused or has fewer items.
            let cut = 1 + cut.index(bytes.len());
            if let Ok(fewer) = decoded(&bytes[1..cut], limit) {
                prop_assert!(fewer.len() < items.len() || cut == bytes.len());
            }
        }

        #[test]
        fn garbage_is_read_or_refused(bytes in prop::collection::vec(any::<u8>(), 0..60), limit in 0u32..4000) {
            if let Ok(items) = decoded(&bytes, limit) {
                prop_assert!(items.is_sorted_by(|a, b| a < b) && items.last().is_none_or(|&last| last < limit));
            }
        }
    }

    /// A coding that loses the last of eight neighbours is found out by the comparison above.
    #[test]
    fn impostor_a_lost_item_is_found_out() {
        let items: Vec<u32> = (5..31).chain([100, 101]).collect();
        let mut bytes = Vec::new();
        let without_ends = items.iter().copied().filter(|item| items.binary_search(&(item + 1)).is_ok());
        encode(without_ends, 200, &mut bytes).unwrap();
        let read = decoded(&bytes, 200).unwrap();
        assert!(read != items && read.len() == items.len() - 2);
    }
}
