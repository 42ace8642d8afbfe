//! Points in a row.

/// Points with consecutive numbers, from `start` up to but without `end`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Run {
    /// The first.
    pub start: u32,
    /// One more than the last.
    pub end: u32,
}
