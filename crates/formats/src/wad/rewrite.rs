//! Writing a WAD again with some lumps changed.

use super::builder::Entry;
use super::{LumpName, Wad, WadBuilder, WadError};
use std::collections::BTreeMap;

/// A change to one lump.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Edit {
    /// The lump of this index has other bytes.
    Replace {
        /// Its index.
        lump: usize,
        /// The new bytes.
        bytes: Vec<u8>,
    },
    /// A new lump stands behind the lump of this index.
    InsertAfter {
        /// The index of the lump before it.
        lump: usize,
        /// Its name.
        name: LumpName,
        /// Its bytes.
        bytes: Vec<u8>,
    },
}

/// The last edit of each lump: of two edits of one lump the later one counts.
#[derive(Default)]
struct Edits<'e> {
    replaced: BTreeMap<usize, &'e [u8]>,
    inserted: BTreeMap<usize, (LumpName, &'e [u8])>,
}

impl Wad {
    /// The file with `edits` made; every other lump keeps its bytes, its name and its turn.
    ///
    /// If all edits replace lumps by others of the same size that share no bytes with any other lump,
    /// they are made in place and the rest of the file is the same, unused bytes included. Otherwise
    /// the file is laid out anew: lumps in the order of the directory, entries that shared their bytes
    /// still sharing them, bytes that no lump names left out. An edit that changes nothing is no edit.
    ///
    /// # Errors
    /// [`WadError::NoSuchLump`] for an edit of a lump that is not there, [`WadError::TooLarge`].
    pub fn with_edits(&self, edits: &[Edit]) -> Result<Vec<u8>, WadError> {
        let edits = self.sort_edits(edits)?;
        let starts = self.starts();
        // Lumps that share any byte begin at one place, as `Wad::parse` checked.
        let alone = |start: usize| {
            let first = starts.partition_point(|&s| s < start);
            starts.get(first + 1) != Some(&start)
        };
        let in_place = edits.inserted.is_empty()
            && edits.replaced.iter().all(|(&lump, new)| {
                let lump = &self.lumps()[lump];
                new.len() == lump.size() && alone(lump.range().start)
            });
        if !in_place {
            return self.lay_out(&edits);
        }
        let mut bytes = self.as_bytes().to_vec();
        for (&lump, new) in &edits.replaced {
            bytes[self.lumps()[lump].range()].copy_from_slice(new);
        }
        Ok(bytes)
    }

    fn sort_edits<'e>(&self, edits: &'e [Edit]) -> Result<Edits<'e>, WadError> {
        let n_lumps = self.lumps().len();
        let mut sorted = Edits::default();
        for edit in edits {
            let (Edit::Replace { lump, .. } | Edit::InsertAfter { lump, .. }) = *edit;
            if lump >= n_lumps {
                return Err(WadError::NoSuchLump { lump, n_lumps });
            }
            match edit {
                Edit::Replace { bytes, .. } => _ = sorted.replaced.insert(lump, bytes),
                Edit::InsertAfter { name, bytes, .. } => _ = sorted.inserted.insert(lump, (*name, bytes)),
            }
        }
        sorted.replaced.retain(|&lump, new| *new != self.lump_bytes(lump));
        Ok(sorted)
    }

    /// The places where lumps begin, sorted, repeated for lumps that share their bytes.
    fn starts(&self) -> Vec<usize> {
        let real = self.lumps().iter().filter(|lump| lump.size() > 0);
        let mut starts: Vec<usize> = real.map(|lump| lump.range().start).collect();
        starts.sort_unstable();
        starts
    }

    fn lay_out(&self, edits: &Edits<'_>) -> Result<Vec<u8>, WadError> {
        let mut out = WadBuilder::new(self.kind());
        let mut placed: BTreeMap<(usize, usize), Entry> = BTreeMap::new();
        for (index, lump) in self.lumps().iter().enumerate() {
            let place = (lump.range().start, lump.range().end);
            if let Some(new) = edits.replaced.get(&index) {
                out.push(lump.name, new)?;
            } else if let Some(&entry) = placed.get(&place).filter(|_| lump.size() > 0) {
                out.share(lump.name, entry);
            } else {
                placed.insert(place, out.push(lump.name, self.lump_bytes(index))?);
            }
            if let Some((name, bytes)) = edits.inserted.get(&index) {
                out.push(*name, bytes)?;
            }
        }
        out.finish()
    }
}
