//! What a method did.

use std::collections::BTreeMap;

/// Counts of one picture. Of a method that prepares something (a tree, clusters), these are of the picture alone.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Counters {
    /// Faces of which at least a part was drawn or tried.
    pub polygons: u64,
    /// Pieces that were given to the rasteriser: whole faces, and what they were split into. Those outside the picture count.
    pub fragments: u64,
    /// Splits made for this picture.
    pub splits: u64,
    /// Pixels that were written, each time.
    pub written: u64,
    /// Pixels that show a face in the end.
    pub covered: u64,
    /// Decisions that doubles could not make.
    pub exact: u64,
    /// How often each test was made, by its name.
    pub tests: BTreeMap<&'static str, u64>,
}

impl Counters {
    /// Counts `n` tests of a kind.
    pub fn tested(&mut self, test: &'static str, n: u64) {
        *self.tests.entry(test).or_default() += n;
    }

    /// How often a covered pixel was written, on average; 0 if none was.
    pub fn overdraw(&self) -> f64 {
        if self.covered == 0 { 0.0 } else { self.written as f64 / self.covered as f64 }
    }
}
