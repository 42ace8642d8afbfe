//! Maps as units of work: what they cost, and their tables as results that are kept.

use super::{Done, MapStatus, RejectSummary};
use sightlines_formats::doom::{MapLump, MapLumps};
use sightlines_formats::{RejectTable, Wad};
use sightlines_progress::{Halt, Kept, Units, kept_struct};

pub(crate) const PHASE: &str = "maps";

/// In proportion to the time that a map takes, roughly: with twice as many lines there are twice as many viewers, and each has more in its way.
pub(crate) fn cost(wad: &Wad, map: &MapLumps) -> f64 {
    let size = |lump: usize| wad.lump_bytes(lump).len() as f64;
    // A line takes 14 bytes, and in a map that is a text some 300, with its sides and ends.
    let n_lines = match map.lump(MapLump::Linedefs) {
        Some(lines) => size(lines) / 14.0,
        None => map.range().map(size).sum::<f64>() / 300.0,
    };
    1.0 + n_lines * n_lines
}

/// What comes first in a result.
const KEPT: u8 = 0;
const SKIPPED: u8 = 1;
const FAILED: u8 = 2;
const WRITTEN: u8 = 3;

/// What was done with a map, from the store or now; `None` for one that is for another process, and none of it if what the store has is damaged.
pub(crate) fn get<E: From<Halt>>(
    units: Units<'_>,
    unit: usize,
    mut do_map: impl FnMut() -> Result<Done, E>,
) -> Result<Option<Option<Done>>, E> {
    let Some(bytes) = units.get(PHASE, unit, || do_map().map(|done| encode(&done)))? else { return Ok(None) };
    match bytes.first() {
        // Why it failed is found out again: a map that cannot be done mostly fails at once.
        Some(&FAILED) => do_map().map(|done| Some(Some(done))),
        _ => Ok(Some(decode(&bytes))),
    }
}

kept_struct!(RejectSummary {
    n_rejected,
    n_effects,
    n_disputed_cells,
    n_lines_without_length,
    n_rounded_crossings,
    n_dropped_pieces,
});

fn encode((n_sectors, status, table): &Done) -> Vec<u8> {
    let tag = match status {
        MapStatus::KeptHandMade => KEPT,
        MapStatus::SkippedUnsupported => SKIPPED,
        MapStatus::Failed(_) => FAILED,
        MapStatus::Written(_) => WRITTEN,
    };
    let mut bytes = vec![tag];
    n_sectors.write(&mut bytes);
    if let MapStatus::Written(summary) = status {
        summary.write(&mut bytes);
        bytes.extend(table.iter().flatten());
    }
    bytes
}

fn decode(mut bytes: &[u8]) -> Option<Done> {
    let (tag, n_sectors) = Kept::read(&mut bytes)?;
    match tag {
        KEPT => Some((n_sectors, MapStatus::KeptHandMade, None)),
        SKIPPED => Some((n_sectors, MapStatus::SkippedUnsupported, None)),
        WRITTEN => {
            let summary = RejectSummary::read(&mut bytes)?;
            // As it was computed; whoever makes effects may make it what they like.
            let is_sound = |table: RejectTable| summary.n_effects > 0 || !table.has_hand_made_effects();
            let table = RejectTable::from_bytes(n_sectors, bytes).ok();
            table.is_some_and(is_sound).then(|| (n_sectors, MapStatus::Written(summary), Some(bytes.to_vec())))
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_are_read_as_they_were_written() {
        let summary = RejectSummary {
            n_rejected: 1,
            n_effects: 2,
            n_disputed_cells: 3,
            n_lines_without_length: 4,
            n_rounded_crossings: 5,
            n_dropped_pieces: 6,
        };
        for done in [
            (7, MapStatus::KeptHandMade, None),
            (0, MapStatus::SkippedUnsupported, None),
            (3, MapStatus::Written(summary), Some(vec![0b0101_0110, 0])),
            (0, MapStatus::Written(RejectSummary::default()), Some(Vec::new())),
        ] {
            let bytes = encode(&done);
            assert_eq!(decode(&bytes), Some(done));
            // Whatever is cut off, nothing panics.
            (0..bytes.len()).for_each(|n| drop(decode(&bytes[..n])));
        }
        assert_eq!((decode(&[9, 0, 0, 0, 0]), decode(&[])), (None, None));
        // Tables that nobody computes: one that is not symmetric, one that hides a sector from itself, one of another size.
        let without = RejectSummary { n_effects: 0, ..summary };
        let is_read =
            |table: &[u8], summary| decode(&encode(&(3, MapStatus::Written(summary), Some(table.to_vec())))).is_some();
        for (table, is_sound) in [([0b0000_1010, 0], true), ([0b0000_0010, 0], false), ([1, 0], false)] {
            assert_eq!((is_read(&table, without), is_read(&table, summary)), (is_sound, true), "{table:?}");
        }
        assert!(!is_read(&[0], without));
    }
}
