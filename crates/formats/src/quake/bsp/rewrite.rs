//! Writing a map again with another visibility lump.

use super::{BSPX_ENTRY, BSPX_HEADER, Bsp};
use crate::bytes::{i32_at, u32_at};
use crate::error::{Malformed, malformed};
use std::ops::Range;

impl Bsp {
    /// Refuses a map whose leafs, which change with visibility, lie under another lump: what [`Self::with_visibility`] would refuse at the end. Of
    /// Quake II, whose leafs do not change, nothing is refused. A map whose leafs would happen to stay as they are is refused too.
    ///
    /// # Errors
    /// [`Malformed`] with both lumps.
    pub fn check_leafs(&self) -> Result<(), Malformed> {
        let changes = !self.format.has_clusters() && self.n_visible_leafs > 0;
        self.over_leafs().filter(|_| changes).map_or(Ok(()), |other| Err(self.shared(other)))
    }

    /// The file with another visibility lump, and with the places of rows and the loudness that go with it in the
    /// leafs that can be seen. Everything else keeps its bytes: what lies behind the lump is moved by a multiple
    /// of four, and the directories (BSPX too) follow. A lump of the same length is replaced in place.
    ///
    /// The lump stays where the directory has it. Where that is no place for a lump (inside another, or not at a
    /// multiple of four), it goes behind the last of all, and the bytes of the old one stay where they are.
    ///
    /// # Errors
    /// [`Malformed`] for a lump that was made for another number of leafs, if leafs would have to change under another lump, and for a
    /// file that would be too large.
    pub fn with_visibility(&self, new: &VisibilityLump) -> Result<Vec<u8>, Malformed> {
        let vis = self.format.visibility_lump();
        let splice = self.splice(new.bytes.len());
        let (old, pad) = (splice.old.clone(), splice.pad);
        let len = (self.bytes.len() - old.len() + splice.lead + new.bytes.len() + pad) as u64;
        if i32::try_from(len).is_err() {
            return Err(malformed!("the file would have {len} bytes, more than a map can have"));
        }
        let leafs = self.changed_leafs(new)?;
        let mut out = Vec::with_capacity(len as usize);
        out.extend_from_slice(&self.bytes[..old.start]);
        out.resize(out.len() + splice.lead, 0);
        let start = out.len();
        out.extend_from_slice(&new.bytes);
        out.resize(out.len() + pad, 0);
        out.extend_from_slice(&self.bytes[old.end..]);

        let moved = |at: usize| if at >= old.end { at - old.len() + splice.lead + new.bytes.len() + pad } else { at };
        let entry = |lump: usize| self.format.magic().len() + 8 * lump;
        for lump in 0..self.lumps.len() {
            let at = entry(lump);
            let offset = i32_at(&self.bytes, at);
            // An empty lump may claim a place outside, which is left alone.
            if let Some(place) = usize::try_from(offset).ok().filter(|&p| p <= self.bytes.len() && lump != vis) {
                put(&mut out, at, moved(place));
            }
        }
        put(&mut out, entry(vis), start);
        put(&mut out, entry(vis) + 4, new.bytes.len());
        if let Some(bspx) = self.bspx {
            for k in 0..bspx.n_lumps {
                let at = bspx.at + BSPX_HEADER + k * BSPX_ENTRY + 24;
                let place = u32_at(&self.bytes, at) as usize;
                if place <= self.bytes.len() {
                    put(&mut out, moved(at), moved(place));
                }
            }
        }
        let place = moved(self.lumps[self.format.leaf_lump()].start);
        out[place..place + leafs.len()].copy_from_slice(&leafs);
        Ok(out)
    }

    fn splice(&self, new_len: usize) -> Splice {
        let n_bytes = self.bytes.len();
        // Multiples of four stay such: what follows moves by a multiple of four. If nothing follows, the file
        // ends at one.
        let pad = |end: usize, old_end: usize| (4 + if old_end < n_bytes { old_end % 4 } else { 0 } - end % 4) % 4;
        match self.free_place() {
            Some(old) if old.len() == new_len => Splice { old, lead: 0, pad: 0 },
            Some(old) if old.start.is_multiple_of(4) => {
                // The padding behind the old lump goes with it, up to what comes next.
                let behind = self.others().map(|l| l.start).filter(|&start| start >= old.end).min();
                let end = old.end.next_multiple_of(4).min(behind.unwrap_or(n_bytes)).min(n_bytes);
                Splice { pad: pad(old.start + new_len, end), old: old.start..end, lead: 0 }
            }
            // Behind everything that the directory names, and before a directory of additional lumps.
            _ => {
                let at = self.end_of_lumps().next_multiple_of(4);
                let (at, lead) = (at.min(n_bytes), at.saturating_sub(n_bytes));
                Splice { old: at..at, lead, pad: pad(at + lead + new_len, at) }
            }
        }
    }

    /// The bytes of the old lump, if they are its own; for an empty one its place, if it is no other's.
    fn free_place(&self) -> Option<Range<usize>> {
        let vis = self.format.visibility_lump();
        let mut old = self.lumps[vis].clone();
        if old.is_empty() {
            let claimed = usize::try_from(i32_at(&self.bytes, self.format.magic().len() + 8 * vis)).ok()?;
            old = claimed..claimed;
        }
        let inside = self.format.header_len() <= old.start && old.end <= self.end_of_lumps();
        let is_own = self.others().all(|l| l.end <= old.start || old.end <= l.start);
        (inside && is_own).then_some(old)
    }

    /// The places of all lumps besides that of visibility, but for empty ones.
    fn others(&self) -> impl Iterator<Item = &Range<usize>> {
        let vis = self.format.visibility_lump();
        self.lumps.iter().enumerate().filter(move |(k, l)| *k != vis && !l.is_empty()).map(|(_, l)| l)
    }

    fn end_of_lumps(&self) -> usize {
        self.lumps.iter().map(|l| l.end).max().unwrap_or(0).max(self.format.header_len())
    }

    /// The lump of leafs with new places and loudness, or with its old bytes where nothing is to change.
    fn changed_leafs(&self, new: &VisibilityLump) -> Result<Vec<u8>, Malformed> {
        let index = self.format.leaf_lump();
        let mut leafs = self.lump_bytes(index).to_vec();
        let layout = self.format.layout();
        let n_rows = if self.format.has_clusters() { 0 } else { self.n_visible_leafs };
        let n_sounds = if self.format.has_sounds() { self.n_visible_leafs } else { 0 };
        for (found, n_leafs) in [(new.leaf_rows.len(), n_rows), (new.ambient.len(), n_sounds)] {
            if found != n_leafs {
                return Err(malformed!("the rows are for {found} leafs, the map has {n_leafs} that can be seen"));
            }
        }
        let mut records: Vec<&mut [u8]> = leafs.chunks_exact_mut(layout.leafs.len).skip(1).collect();
        for (record, &row) in records.iter_mut().zip(&new.leaf_rows) {
            // A lump that fits a file has no row past what 31 bits can say.
            put(record, LEAF_ROW, row as usize);
        }
        if let Some(at) = layout.leaf_ambient {
            records.iter_mut().zip(&new.ambient).for_each(|(record, level)| record[at..at + 4].copy_from_slice(level));
        }
        match self.over_leafs().filter(|_| leafs != self.lump_bytes(index)) {
            Some(other) => Err(self.shared(other)),
            None => Ok(leafs),
        }
    }

    /// The first other lump that has bytes of the lump of leafs.
    fn over_leafs(&self) -> Option<usize> {
        let index = self.format.leaf_lump();
        let range = &self.lumps[index];
        let over = |l: &Range<usize>| l.start < range.end && range.start < l.end;
        (0..self.lumps.len()).find(|&k| k != index && over(&self.lumps[k]))
    }

    fn shared(&self, other: usize) -> Malformed {
        let [lump, other] = [self.format.leaf_lump(), other].map(|lump| self.format.label(lump));
        malformed!("{lump} has to change, but {other} lies over it")
    }
}

/// Where a leaf has the place of its row, in all formats whose leafs have one.
const LEAF_ROW: usize = 4;

/// A visibility lump, and what goes with it in the leafs; [`Bsp::with_visibility`] puts it into a map.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct VisibilityLump {
    /// The lump.
    pub bytes: Vec<u8>,
    /// For each leaf that can be seen where its row begins in the lump; empty for Quake II and III.
    pub leaf_rows: Vec<u32>,
    /// For each of those leafs how loud water, sky, slime and lava are; empty for formats
    /// [without such sounds](super::BspFormat::has_sounds).
    pub ambient: Vec<[u8; 4]>,
}

/// `old` gives way to `lead` zeros, the new lump, and `pad` zeros.
struct Splice {
    old: Range<usize>,
    lead: usize,
    pad: usize,
}

fn put(bytes: &mut [u8], at: usize, number: usize) {
    bytes[at..at + 4].copy_from_slice(&(number as u32).to_le_bytes());
}
