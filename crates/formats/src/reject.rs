//! The REJECT lump: which sectors cannot see each other.

/// One bit per ordered pair of sectors: 1 where the viewer cannot see the target.
///
/// Bit `viewer * n + target`, least significant first; rows are not aligned to bytes; the spare bits
/// of the last byte are 0. `n * n / 8` bytes of memory, rounded up.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RejectTable {
    n_sectors: u32,
    bytes: Vec<u8>,
}

/// A REJECT lump whose length does not fit the number of sectors.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("REJECT has {found} bytes, but {n_sectors} sectors need {needed}")]
pub struct RejectLengthError {
    /// Number of sectors of the map.
    pub n_sectors: u32,
    /// Bytes in the lump.
    pub found: u64,
    /// Bytes that a full table has.
    pub needed: u64,
}

impl RejectTable {
    /// The table that rejects nothing.
    ///
    /// # Panics
    /// If a table of this size does not fit into memory. Maps have at most 65,536 sectors: 512 MiB.
    pub fn new(n_sectors: u32) -> Self {
        let len = usize::try_from(Self::byte_len(n_sectors)).expect("a table of addressable size");
        Self { n_sectors, bytes: vec![0; len] }
    }

    /// The table that rejects what is not seen: row `i` of `rows` has bit `j % 64` of word `j / 64` set if
    /// sector `i` sees sector `j`. O(n²/64).
    ///
    /// # Panics
    /// If there are fewer than `n_sectors` rows, or fewer words in one than its bits take.
    pub fn from_seen_rows<'r>(n_sectors: u32, mut rows: impl Iterator<Item = &'r [u64]>) -> Self {
        let mut table = Self::new(n_sectors);
        let mut bytes = Vec::with_capacity(table.as_bytes().len() + 16);
        // Bits that do not fill a byte yet; fewer than 8 of them.
        let (mut pending, mut n_pending) = (0u128, 0u32);
        for _ in 0..n_sectors {
            let row = rows.next().expect("a row for each sector");
            for k in (0..n_sectors).step_by(64) {
                let n = (n_sectors - k).min(64);
                let unseen = !row[k as usize / 64] & (u64::MAX >> (64 - n));
                pending |= u128::from(unseen) << n_pending;
                n_pending += n;
                while n_pending >= 8 {
                    bytes.push(pending as u8);
                    pending >>= 8;
                    n_pending -= 8;
                }
            }
        }
        if n_pending > 0 {
            bytes.push(pending as u8);
        }
        table.bytes = bytes;
        table
    }

    /// Reads a lump. Spare bits of the last byte are dropped.
    ///
    /// # Errors
    /// [`RejectLengthError`] unless the lump has exactly the length that `n_sectors` need. Empty and
    /// short lumps do exist; what they stand for differs between engines, so nothing is assumed here.
    pub fn from_bytes(n_sectors: u32, bytes: &[u8]) -> Result<Self, RejectLengthError> {
        let (found, needed) = (bytes.len() as u64, Self::byte_len(n_sectors));
        if found != needed {
            return Err(RejectLengthError { n_sectors, found, needed });
        }
        let mut bytes = bytes.to_vec();
        let used = (u64::from(n_sectors) * u64::from(n_sectors)) % 8;
        if let (Some(last), true) = (bytes.last_mut(), used > 0) {
            *last &= (1 << used) - 1;
        }
        Ok(Self { n_sectors, bytes })
    }

    /// Bytes that a table of `n_sectors` has.
    pub fn byte_len(n_sectors: u32) -> u64 {
        (u64::from(n_sectors) * u64::from(n_sectors)).div_ceil(8)
    }

    /// Number of sectors.
    pub fn n_sectors(&self) -> u32 {
        self.n_sectors
    }

    /// The lump.
    pub fn as_bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// The lump.
    pub fn into_bytes(self) -> Vec<u8> {
        self.bytes
    }

    /// Whether `viewer` cannot see `target`. O(1).
    ///
    /// # Panics
    /// If a sector is not below [`RejectTable::n_sectors`].
    #[inline]
    pub fn get(&self, viewer: u32, target: u32) -> bool {
        let (byte, mask) = self.place(viewer, target);
        self.bytes[byte] & mask != 0
    }

    /// Says whether `viewer` cannot see `target`. O(1).
    ///
    /// # Panics
    /// If a sector is not below [`RejectTable::n_sectors`].
    #[inline]
    pub fn set(&mut self, viewer: u32, target: u32, rejected: bool) {
        let (byte, mask) = self.place(viewer, target);
        if rejected {
            self.bytes[byte] |= mask;
        } else {
            self.bytes[byte] &= !mask;
        }
    }

    /// Number of rejected ordered pairs.
    pub fn n_rejected(&self) -> u64 {
        self.bytes.iter().map(|b| u64::from(b.count_ones())).sum()
    }

    /// Whether every pair has the same answer in both directions. O(n²) bit tests.
    pub fn is_symmetric(&self) -> bool {
        (0..self.n_sectors).all(|a| (0..a).all(|b| self.get(a, b) == self.get(b, a)))
    }

    /// The first sector that is rejected from itself.
    pub fn rejects_itself(&self) -> Option<u32> {
        (0..self.n_sectors).find(|&s| self.get(s, s))
    }

    /// Whether the table says what no line of sight can mean: a pair with one answer there and another
    /// back, or a sector hidden from itself. Map authors write such tables to blind or deafen monsters.
    pub fn has_hand_made_effects(&self) -> bool {
        self.rejects_itself().is_some() || !self.is_symmetric()
    }

    #[inline]
    fn place(&self, viewer: u32, target: u32) -> (usize, u8) {
        assert!(viewer < self.n_sectors && target < self.n_sectors, "sectors are below n_sectors");
        let bit = u64::from(viewer) * u64::from(self.n_sectors) + u64::from(target);
        // The table of this size is in memory, so its byte indices fit a usize.
        ((bit >> 3) as usize, 1 << (bit & 7))
    }
}
