//! Ids, counters, errors and broken promises of movers.

use std::fmt;

/// The id of a mover. Ids are not reused, and ids of removed movers are recognized.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct MoverId {
    pub(super) slot: u32,
    pub(super) generation: u32,
}

impl MoverId {
    /// An index for data that belongs to movers: small, different for movers that exist at the same time, and reused.
    pub const fn slot(self) -> usize {
        self.slot as usize
    }
}

impl fmt::Display for MoverId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.slot, self.generation)
    }
}

/// How a mover broke its promise.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum BrokenPromise {
    /// It moved faster than its top speed.
    Speed,
    /// It left its region, which is ignored from now on.
    Region,
    /// Its box is empty or not finite; the mover counts as visible.
    NoBox,
}

/// A mover that was found outside its promise. While it was hidden it may have been missed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Broken {
    /// Which.
    pub mover: MoverId,
    /// The time of the query.
    pub at: f64,
    /// The time of its last known position.
    pub known_at: f64,
    /// The broken promise.
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
    /// Cells that were searched for volumes.
    pub cells: u64,
    /// Volumes that a frame found in visible cells.
    pub touched: u64,
    /// Of these, movers that were not visible themselves: false positives of their volumes.
    pub in_vain: u64,
    /// Volumes that expired.
    pub expired: u64,
    /// Queries of a mover's position.
    pub asked: u64,
    /// Reports of a visible mover.
    pub seen: u64,
    /// Volumes that were registered in cells.
    pub entered: u64,
    /// Volumes that were attempted, registered or not.
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
