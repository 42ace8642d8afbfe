//! The result of a check: the pairs proven, or why proofs are refused.

use crate::pairs::{ObjectPairs, Pairs};

/// Pairs for which a proof was checked.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Proven {
    /// Pairs that an open set of lines joins.
    pub visible: Pairs,
    /// Pairs that no open set of lines joins.
    pub hidden: Pairs,
    /// Pairs of a cell and an object to which no open set of lines leads from the cell. Only proofs of scenes in space have any.
    pub hidden_objects: ObjectPairs,
}

impl Proven {
    pub(crate) fn new(visible: Pairs, hidden: Pairs) -> Self {
        Self { visible, hidden, hidden_objects: ObjectPairs::default() }
    }

    /// Number of pairs of different cells for which there is no proof.
    pub fn n_open(&self) -> u64 {
        let n = self.visible.n_cells() as u64;
        n * n.saturating_sub(1) / 2 - self.visible.len() - self.hidden.len()
    }
}

/// The pairs of cells that lines join: each line is followed through the cells that it passes, and is refused if there are
/// none.
pub(crate) fn joined_along<L>(
    n_cells: usize,
    lines: &[L],
    follow: impl Fn(&L) -> Vec<u32>,
    refusal: impl Fn(usize, &L) -> Refusal,
) -> Result<Pairs, Refusal> {
    let mut joined = Pairs::none(n_cells);
    for (index, line) in lines.iter().enumerate() {
        let cells = follow(line);
        if cells.is_empty() {
            return Err(refusal(index, line));
        }
        joined.add_all(&cells);
    }
    Ok(joined)
}

/// Why proofs are refused: the first piece that does not hold.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Refusal {
    /// They are about other cells and portals.
    #[error("the proofs are about other cells or portals than the table has")]
    OtherTable,
    /// Proofs about other objects than the network was given.
    #[error("the proofs are about other objects than the table has")]
    OtherObjects,
    /// A line that passes no portal of its cell.
    #[error("line {index} passes no portal of cell {cell}")]
    Line {
        /// The index of the line.
        index: usize,
        /// The cell.
        cell: u32,
    },
    /// A line in space that does not pass its gate.
    #[error("line {index} does not pass portal {}", gate / 2)]
    Gate {
        /// The index of the line.
        index: usize,
        /// The gate: twice the number of a portal, and 1 more for the way back.
        gate: u32,
    },
    /// An unproven pair that is no pair of cells in ascending order.
    #[error("unproven pair {index} is no pair of cells")]
    Pair {
        /// The index of the pair.
        index: usize,
    },
    /// A walk from a cell that does not exist, or to one.
    #[error("walk {walk}, from cell {from}, is between cells that do not exist")]
    Source {
        /// The index of the walk.
        walk: usize,
        /// The cell.
        from: u32,
    },
    /// A chain is claimed to be blocked without a valid reason.
    #[error("walk {walk}, from cell {from}: reason {block} does not show that the chain is blocked")]
    Block {
        /// The index of the walk.
        walk: usize,
        /// The cell.
        from: u32,
        /// The index of the reason among those of the walk.
        block: usize,
    },
    /// A chain of gates that nothing blocks enters a cell that is claimed to be hidden.
    #[error("walk {walk}, from cell {from}: a chain of portals enters cell {cell}, which should be hidden")]
    Entered {
        /// The index of the walk.
        walk: usize,
        /// The cell.
        from: u32,
        /// The cell that is entered.
        cell: u32,
    },
    /// A walk that ended before all its decisions were used: they were made for another walk.
    #[error("walk {walk}, from cell {from}: not all of its reasons are used")]
    Unused {
        /// The index of the walk.
        walk: usize,
        /// The cell.
        from: u32,
    },
    /// A rectangle that is used as an occluder is no wall.
    #[error("blocker {index} is no wall: {why}")]
    Blocker {
        /// The index of the blocker.
        index: usize,
        /// Why it is no wall.
        why: NoWall,
    },
    /// A proof about two boxes that does not hold.
    #[error("proof {index} does not show that its two boxes are hidden from each other")]
    Boxes {
        /// The index of the proof.
        index: usize,
    },
    /// A proof about a box and an object that does not hold.
    #[error("proof {index} about objects does not show that object {object} is hidden from its box")]
    Object {
        /// The index of the proof among those about objects.
        index: usize,
        /// The object.
        object: u32,
    },
}

/// Why a rectangle is no wall.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum NoWall {
    /// It is not flat along exactly one axis.
    #[error("it is no rectangle")]
    Shape,
    /// Part of it is inside a cell.
    #[error("it goes through cell {0}")]
    Cell(u32),
    /// A portal lies in it.
    #[error("portal {0} is in it")]
    Portal(u32),
}
