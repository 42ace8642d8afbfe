//! The first reach at which two cells may see each other.

mod bytes;
mod make;

use crate::distance::{Boxes, Ways};
use sightlines_pvs::{CellId, Table};

pub use bytes::ReachFileError;

/// As many reaches as four bits number, with one left for "at none of them".
const MOST_REACHES: usize = 15;

/// Who of two bodies moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum WhoMoves {
    /// Both.
    #[default]
    Both,
    /// Only the first; the second holds still. Tells nothing of two that both move.
    One,
}

/// Which reaches to find.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ReachOptions {
    /// The reaches in scene units, ascending; none for [`Reaches::usual_ladder`]. Reach 0 need not be listed.
    pub ladder: Vec<f64>,
    /// Who moves.
    pub movers: WhoMoves,
    /// On which ways.
    pub ways: Ways,
    /// Threads; 0 for as many as the machine has.
    pub threads: usize,
}

/// Why no reaches can be found.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ReachError {
    /// The table has no positions of its cells.
    #[error("the table has no places of its cells, as it was made of a portal file alone")]
    NoPlaces,
    /// Reaches are not finite, not above 0, or not ascending.
    #[error("reach {reach} is not finite, not above 0, or not above the reach before it")]
    Reaches {
        /// The first of which that is true.
        reach: f64,
    },
    /// More reaches than four bits number.
    #[error("{n} reaches, and at most 14 are possible")]
    TooMany {
        /// How many.
        n: usize,
    },
    /// Ways through portals, of a table without portals.
    #[error("the table has no portals, so that ways through them are not known")]
    NoPortals,
}

/// For each pair of cells the first of some reaches at which bodies in them may see each other.
///
/// Four bits for a pair. Bodies at places of two cells that move no farther than a reach below that first one do not see each other, if they stay
/// in cells of the table; a body that leaves all cells is a matter of [`Relevance`](crate::Relevance).
#[derive(Debug, Clone, PartialEq)]
pub struct Reaches {
    /// 0, then the reaches.
    ladder: Vec<f64>,
    movers: WhoMoves,
    ways: Ways,
    /// Of each pair of cells the index of its first reach, or the number of reaches.
    first: Nibbles,
    /// Checksum of the table.
    table: u32,
}

impl Reaches {
    /// Finds the reaches of a table.
    ///
    /// With `R` the cells that a body may reach from a cell, and `V` the visible pairs, both as matrices of bits, pairs may see each other at a reach where
    /// `R V Rᵀ` has a bit, or `R V` if only the first moves. O(n³ / 64) word operations for each reach at worst, for n cells; 4 bits of memory a pair
    /// beside the result, and 2 more for the products. The same bytes with any number of threads.
    ///
    /// # Errors
    /// [`ReachError`].
    ///
    /// # Source
    /// Our own. Teller and Séquin (1991) dilate by one portal to prefetch; here the dilation is by a distance, on both sides.
    pub fn of(table: &Table, options: &ReachOptions) -> Result<Self, ReachError> {
        if !table.has_places() {
            return Err(ReachError::NoPlaces);
        }
        if options.ways == Ways::Portals && table.portals().is_empty() && table.n_cells() > 1 {
            return Err(ReachError::NoPortals);
        }
        let mut reaches = vec![0.0];
        let usual = Self::usual_ladder(table);
        let wanted = if options.ladder.is_empty() { &usual } else { &options.ladder };
        let wanted = wanted.strip_prefix(&[0.0]).unwrap_or(wanted);
        for &reach in wanted {
            let above = reach > reaches[reaches.len() - 1];
            if !above || reach.is_infinite() {
                return Err(ReachError::Reaches { reach });
            }
            reaches.push(reach);
        }
        if reaches.len() > MOST_REACHES {
            return Err(ReachError::TooMany { n: reaches.len() - 1 });
        }
        let boxes = Boxes::of(table);
        let first = make::first_rungs(table, &boxes, &reaches, options);
        Ok(Self { ladder: reaches, movers: options.movers, ways: options.ways, first, table: bytes::checksum(table) })
    }

    /// 0.25, 0.5, 1, 2, 4, 8 and 16 m: in scene units, or 32 times that for a Quake or a Doom map, whose units are inches or so.
    pub fn usual_ladder(table: &Table) -> Vec<f64> {
        let is_doom = table.dimension() == 2 && table.cells().iter().any(|c| c.group.is_some());
        let metre = if table.kind().is_quake() || is_doom { 32.0 } else { 1.0 };
        (-2..=4).map(|e| metre * f64::powi(2.0, e)).collect()
    }

    /// The reaches, ascending from 0, in scene units.
    pub fn ladder(&self) -> &[f64] {
        &self.ladder
    }

    /// Who moves.
    pub const fn movers(&self) -> WhoMoves {
        self.movers
    }

    /// On which ways.
    pub const fn ways(&self) -> Ways {
        self.ways
    }

    /// Number of cells.
    pub const fn n_cells(&self) -> usize {
        self.first.n
    }

    /// The index in [`Reaches::ladder`] of the first reach at which a body in `a` and one in `b` may see each other; its length if they may not at any of them.
    /// If only one moves, that is the one in `a`. O(1).
    ///
    /// # Panics
    /// If there are no such cells.
    #[inline]
    pub fn rung(&self, a: CellId, b: CellId) -> usize {
        self.first.get(a.idx(), b.idx()) as usize
    }

    /// The rungs of the pairs of a cell, two in a byte: that of cell `j` in the lower bits of byte `j / 2` if `j` is even, else in the upper.
    ///
    /// # Panics
    /// If there is no such cell.
    pub fn row(&self, a: CellId) -> &[u8] {
        self.first.row(a.idx())
    }

    /// The share of ordered pairs of different cells that do not see each other within each reach, from 0 to 1; 0 if there are no pairs.
    pub fn hidden_shares(&self) -> Vec<f64> {
        let n = self.n_cells();
        let mut count = vec![0u64; self.ladder.len() + 1];
        for i in 0..n {
            (0..n).filter(|&j| j != i).for_each(|j| count[self.first.get(i, j) as usize] += 1);
        }
        let all = n as u64 * (n as u64).saturating_sub(1);
        let mut seen = 0;
        let share = |c: &u64| {
            seen += c;
            (all - seen) as f64 / all.max(1) as f64
        };
        count[..self.ladder.len()].iter().map(share).collect()
    }

    /// Whether these are the reaches of a table: of its cells, portals and rows. O(table).
    pub fn are_of(&self, table: &Table) -> bool {
        self.n_cells() == table.n_cells() && self.table == bytes::checksum(table)
    }

    /// Whether bodies in these cells cannot see each other while they move no farther than `reach`, both or the first alone.
    #[inline]
    pub(crate) fn are_hidden_within(&self, a: u32, b: u32, reach: f64) -> bool {
        let rung = self.first.get(a as usize, b as usize) as usize;
        rung > 0 && reach <= self.ladder[rung - 1]
    }
}

/// A square matrix of numbers from 0 to 15.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Nibbles {
    n: usize,
    stride: usize,
    bytes: Vec<u8>,
}

impl Nibbles {
    /// All `value`.
    fn new(n: usize, value: u8) -> Self {
        let stride = n.div_ceil(2);
        let mut all = Self { n, stride, bytes: vec![value | value << 4; n * stride] };
        if n % 2 == 1 {
            (0..n).for_each(|i| all.bytes[i * stride + stride - 1] &= 15);
        }
        all
    }

    fn row(&self, i: usize) -> &[u8] {
        &self.bytes[i * self.stride..(i + 1) * self.stride]
    }

    #[inline]
    fn get(&self, i: usize, j: usize) -> u8 {
        assert!(j < self.n, "column {j} of {}", self.n);
        nibble(self.row(i), j)
    }
}

#[inline]
fn nibble(row: &[u8], j: usize) -> u8 {
    row[j / 2] >> (4 * (j % 2)) & 15
}

fn set_nibble(row: &mut [u8], j: usize, value: u8) {
    let shift = 4 * (j % 2);
    row[j / 2] = row[j / 2] & !(15 << shift) | value << shift;
}
