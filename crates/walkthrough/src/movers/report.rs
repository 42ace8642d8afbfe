//! What movers tell about themselves.

use std::fmt;

/// A mover. Ids are not used again; those of removed movers are known to be so.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct MoverId {
    pub(super) slot: u32,
    pub(super) generation: u32,
}

impl MoverId {
    /// A place in a list of things that belong to movers: small, different for movers that are there at the same time, and used again.
    pub const fn slot(self) -> usize {
        self.slot as usize
    }
}

impl fmt::Display for MoverId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.slot, self.generation)
    }
}

/// How a mover's place is not what was promised.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum BrokenPromise {
    /// It moved faster than its top speed.
    Speed,
    /// It left its region, which is not relied upon any more.
    Region,
    /// Its box is empty or not finite; the mover counts as seen.
    NoBox,
}

/// A mover that was found where it should not be. While it was hidden it may have been missed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Broken {
    /// Which.
    pub mover: MoverId,
    /// When it was asked.
    pub at: f64,
    /// When its place was known last.
    pub known_at: f64,
    /// What was broken.
    pub promise: BrokenPromise,
}

impl fmt::Display for Broken {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { mover, at, known_at, .. } = self;
        match self.promise {
            BrokenPromise::Speed => write!(f, "mover {mover} was faster than promised between {known_at} and {at}"),
            BrokenPromise::Region => write!(f, "mover {mover} was outside its region at {at}"),
            BrokenPromise::NoBox => write!(f, "mover {mover} had no finite box at {at}"),
        }
    }
}

/// Counters of the work done so far.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub struct MoverCounters {
    /// Frames.
    pub frames: u64,
    /// Cells that were looked at for volumes.
    pub cells: u64,
    /// Volumes that a frame found in cells that are seen.
    pub touched: u64,
    /// Of these, movers that were not seen themselves: their volume came into view for nothing.
    pub in_vain: u64,
    /// Volumes that ran out.
    pub expired: u64,
    /// Times that a mover was asked for its place.
    pub asked: u64,
    /// Times that a mover was reported as seen.
    pub seen: u64,
    /// Volumes that were entered into the cells.
    pub entered: u64,
    /// Volumes that were tried, whether entered or not.
    pub tried: u64,
    /// Promises that were found broken.
    pub broken: u64,
}

/// Why a frame, or a mover, is refused.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MoverError {
    /// A time that is not finite, or before that of the last frame.
    #[error("the time {now} is not finite, or before {last}")]
    Time {
        /// The time given.
        now: f64,
        /// That of the last frame.
        last: f64,
    },
    /// A box that is empty or not finite.
    #[error("the box of a mover is empty or not finite")]
    Box,
    /// More movers at the same time than 32 bits count.
    #[error("more movers than 32 bits can count")]
    TooMany,
}
