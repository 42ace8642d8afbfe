//! Names of lumps.

use std::fmt;

/// Eight bytes, as they stand in the directory. The name ends at the first zero; what follows it is
/// kept but means nothing.
///
/// `==` compares all eight bytes; [`LumpName::is`] compares names.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub struct LumpName([u8; 8]);

impl LumpName {
    /// The name that stands in a directory as these bytes.
    pub const fn from_raw(raw: [u8; 8]) -> Self {
        Self(raw)
    }

    /// All eight bytes.
    pub const fn raw(&self) -> [u8; 8] {
        self.0
    }

    /// The bytes before the first zero.
    pub fn text(&self) -> &[u8] {
        let end = self.0.iter().position(|&b| b == 0).unwrap_or(self.0.len());
        &self.0[..end]
    }

    /// Whether this is the name `name`. Engines ignore case, so this does.
    pub fn is(&self, name: &str) -> bool {
        self.text().eq_ignore_ascii_case(name.as_bytes())
    }
}

impl fmt::Display for LumpName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.text().escape_ascii())
    }
}

impl fmt::Debug for LumpName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "LumpName(\"{}\")", self.0.escape_ascii())
    }
}
