//! The options, the state and the result of a search.

use sightlines_pvs::BitMatrix;

/// How to search.
#[derive(Debug, Clone, Copy, Default)]
pub struct ConvexOptions {
    /// Only the first, coarse bound: quick, and shows much that is hidden.
    pub fast: bool,
    /// Number of threads; 0 for one for each core. Changes nothing but the time.
    pub threads: usize,
}

/// What a search did: counts of elementary operations, the same for the same input and options, whatever the
/// machine and the number of threads.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct ConvexCounters {
    /// Polygons cut by planes.
    pub clips: u64,
    /// Lines followed through the graph.
    pub lines: u64,
    /// Linear programs.
    pub programs: u64,
    /// Beams followed.
    pub beams: u64,
    /// Sequences of gates looked at one by one.
    pub sequences: u64,
}

impl std::ops::AddAssign for ConvexCounters {
    fn add_assign(&mut self, other: Self) {
        self.clips += other.clips;
        self.lines += other.lines;
        self.programs += other.programs;
        self.beams += other.beams;
        self.sequences += other.sequences;
    }
}

/// Where a search stands: all that is needed to go on with it later, for the same graph and options.
#[derive(Debug, Clone, PartialEq)]
pub struct ConvexState {
    /// Which stage is under way, from 0; 4 when all is done.
    pub stage: u32,
    /// How many gates or cells of that stage are done.
    pub done: u64,
    /// Pairs of cells known to see each other; symmetric.
    pub visible: BitMatrix,
    /// Pairs of cells not known to be hidden; symmetric, a superset of `visible`.
    pub possible: BitMatrix,
    /// Row `2 p` has the cells that may be seen through portal `p`, row `2 p + 1` those that may be seen through it
    /// the other way.
    pub through: BitMatrix,
    /// Pairs (lower id first, in any order) that count as visible unless a line is found.
    pub undecided: Vec<[u32; 2]>,
    /// Counters of the work done so far.
    pub counters: ConvexCounters,
}

/// The answer of a search.
#[derive(Debug, Clone, PartialEq)]
pub struct ConvexVisibility {
    /// Which cells see each other; symmetric, diagonal set.
    pub cells: BitMatrix,
    /// Pairs (lower id first, ascending) that count as visible without a line that shows it. Empty for
    /// [`ConvexOptions::fast`], which shows no lines at all.
    pub undecided: Vec<[u32; 2]>,
    /// What was done.
    pub counters: ConvexCounters,
}
