//! Making WADs from lumps.

use super::{ENTRY_LEN, HEADER_LEN, LumpName, WadError, WadKind};

/// Makes a WAD lump by lump, for tools, generators and tests.
///
/// ```
/// use sightlines_formats::wad::{Wad, WadBuilder, WadKind};
/// let mut builder = WadBuilder::new(WadKind::Patch);
/// builder.lump("README", b"hello")?;
/// let wad = Wad::parse(builder.finish()?)?;
/// assert_eq!(wad.lump_bytes(0), b"hello");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct WadBuilder {
    kind: WadKind,
    bytes: Vec<u8>,
    entries: Vec<Entry>,
    max_len: usize,
}

/// Place, size and name of a lump, as the directory has them.
#[derive(Debug, Clone, Copy)]
pub(super) struct Entry {
    pub(super) offset: i32,
    pub(super) size: i32,
    pub(super) name: LumpName,
}

impl WadBuilder {
    /// A WAD without lumps.
    pub fn new(kind: WadKind) -> Self {
        Self { kind, bytes: vec![0; HEADER_LEN], entries: Vec::new(), max_len: i32::MAX as usize }
    }

    /// Appends a lump.
    ///
    /// # Errors
    /// [`WadError::Name`], or [`WadError::TooLarge`] before anything is copied.
    pub fn lump(&mut self, name: &str, data: &[u8]) -> Result<&mut Self, WadError> {
        self.lump_named(LumpName::new(name)?, data)
    }

    /// Appends a lump under a name that is taken as it stands.
    ///
    /// # Errors
    /// [`WadError::TooLarge`] before anything is copied.
    pub fn lump_named(&mut self, name: LumpName, data: &[u8]) -> Result<&mut Self, WadError> {
        self.push(name, data)?;
        Ok(self)
    }

    pub(super) fn push(&mut self, name: LumpName, data: &[u8]) -> Result<Entry, WadError> {
        // Lumps begin at multiples of four, for engines that map the file and read numbers in place.
        let start = self.bytes.len().next_multiple_of(4);
        let end = self.check_end(start, data.len())?;
        self.bytes.resize(start, 0);
        self.bytes.extend_from_slice(data);
        debug_assert_eq!(self.bytes.len(), end);
        // Both are at most `max_len`, which is an i32.
        let entry = Entry { offset: start as i32, size: data.len() as i32, name };
        self.entries.push(entry);
        Ok(entry)
    }

    /// Appends an entry for bytes that are already there.
    pub(super) fn share(&mut self, name: LumpName, with: Entry) {
        self.entries.push(Entry { name, ..with });
    }

    /// Appends the directory.
    ///
    /// # Errors
    /// [`WadError::TooLarge`].
    pub fn finish(mut self) -> Result<Vec<u8>, WadError> {
        let start = self.bytes.len().next_multiple_of(4);
        self.check_end(start, self.entries.len() * ENTRY_LEN)?;
        self.bytes.resize(start, 0);
        for entry in &self.entries {
            self.bytes.extend_from_slice(&entry.offset.to_le_bytes());
            self.bytes.extend_from_slice(&entry.size.to_le_bytes());
            self.bytes.extend_from_slice(&entry.name.raw());
        }
        self.bytes[..4].copy_from_slice(&self.kind.magic());
        // The directory fits below `max_len`, so do its length and place.
        self.bytes[4..8].copy_from_slice(&(self.entries.len() as i32).to_le_bytes());
        self.bytes[8..12].copy_from_slice(&(start as i32).to_le_bytes());
        Ok(self.bytes)
    }

    fn check_end(&self, start: usize, len: usize) -> Result<usize, WadError> {
        let end = start as u64 + len as u64;
        let fits = end <= self.max_len as u64;
        if fits { Ok(start + len) } else { Err(WadError::TooLarge { lump: self.entries.len(), end }) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_past_the_limit_are_refused() {
        let with_limit = |max_len| {
            let mut builder = WadBuilder { max_len, ..WadBuilder::new(WadKind::Patch) };
            builder.lump("A", &[1; 6])?.lump("B", &[2; 4])?;
            builder.finish()
        };
        // 12 of header, 6 + 2 of A, 4 of B, 32 of directory.
        assert_eq!(with_limit(56).unwrap().len(), 56);
        assert_eq!(with_limit(55), Err(WadError::TooLarge { lump: 2, end: 56 }));
        assert_eq!(with_limit(23), Err(WadError::TooLarge { lump: 1, end: 24 }));
        assert_eq!(WadBuilder::new(WadKind::Game).max_len, i32::MAX as usize);
    }
}
