//! The options, the state and the result of a search.

use sightlines_pvs::BitMatrix;

/// Options of a search.
#[derive(Debug, Clone, Copy, Default)]
pub struct ConvexOptions {
    /// Only the first, coarse bound: quick, but reports much that is hidden as visible.
    pub fast: bool,
    /// Number of threads; 0 for one per core. Affects only the time.
    pub threads: usize,
}

/// The work of a search: counts of elementary operations, equal for equal input and options on every machine and with
/// any number of threads.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct ConvexSearchCounters {
    /// Polygons cut by planes.
    pub clips: u64,
    /// Lines followed through the graph.
    pub lines: u64,
    /// Linear programs.
    pub programs: u64,
    /// Beams followed.
    pub beams: u64,
    /// Sequences of gates followed one by one.
    pub sequences: u64,
}

impl ConvexSearchCounters {
    /// Names and values, in a fixed order.
    pub fn named(&self) -> [(&'static str, u64); 5] {
        let Self { clips, lines, programs, beams, sequences } = *self;
        [("clips", clips), ("lines", lines), ("programs", programs), ("beams", beams), ("sequences", sequences)]
    }

    /// All of it as one number, in cuts of a polygon: the other operations count as many as they were found to take time
    /// for, roughly.
    pub const fn work(&self) -> u64 {
        self.clips + 10 * self.lines + 80 * self.programs + 20 * self.beams + 30 * self.sequences
    }
}

impl std::ops::AddAssign for ConvexSearchCounters {
    fn add_assign(&mut self, other: Self) {
        self.clips += other.clips;
        self.lines += other.lines;
        self.programs += other.programs;
        self.beams += other.beams;
        self.sequences += other.sequences;
    }
}

/// The state of a search: what it has found so far.
#[derive(Debug, Clone, PartialEq)]
pub struct ConvexState {
    /// The current stage, from 0; 4 when all are done.
    pub stage: u32,
    /// How many gates or cells of that stage are done.
    pub done: u64,
    /// Pairs of cells known to see each other; symmetric.
    pub visible: BitMatrix,
    /// Pairs of cells not known to be hidden; symmetric, a superset of `visible`.
    pub possible: BitMatrix,
    /// Row `2 p` has the cells that may be seen through portal `p`, row `2 p + 1` those that may be seen through it in
    /// the opposite direction.
    pub through: BitMatrix,
    /// Pairs (lower id first, in any order) that count as visible unless a line is found.
    pub undecided: Vec<[u32; 2]>,
    /// Counters of the work done so far.
    pub counters: ConvexSearchCounters,
}

/// How far more threads can speed up a search, counted and not timed: see [`ConvexSearch::chain`](super::ConvexSearch::chain).
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct WorkChain {
    /// The [work](ConvexSearchCounters::work) of all units.
    pub all: u64,
    /// That of the unit with the most work of each batch, added up: batches follow each other, so however many threads
    /// there are, they wait for it.
    pub longest: u64,
}

impl WorkChain {
    /// Adds a batch, given the work of its units.
    pub(super) fn add(&mut self, batch: impl Iterator<Item = u64>) {
        let (all, longest) = batch.fold((0, 0), |(all, longest), unit| (all + unit, unit.max(longest)));
        self.all += all;
        self.longest += longest;
    }
}

/// The answer of a search.
#[derive(Debug, Clone, PartialEq)]
pub struct ConvexVisibility {
    /// Which cells see each other; symmetric, diagonal set.
    pub cells: BitMatrix,
    /// Pairs (lower id first, ascending) that count as visible without a line that proves it. Empty for
    /// [`ConvexOptions::fast`], which searches for no lines.
    pub undecided: Vec<[u32; 2]>,
    /// The work done.
    pub counters: ConvexSearchCounters,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chain_waits_for_the_longest_of_each_batch() {
        let mut chain = WorkChain::default();
        chain.add([3, 9, 4].into_iter());
        chain.add([5].into_iter());
        chain.add(std::iter::empty());
        assert_eq!(chain, WorkChain { all: 21, longest: 14 });
    }
}
