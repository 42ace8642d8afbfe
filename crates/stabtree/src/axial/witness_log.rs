//! What a search records for a later one: lines, and the pairs that each of them was the first to prove.

use sightlines_sightline::{FreeLine, FreeSpan, Shaft};

/// A free line.
#[derive(Debug, Clone)]
pub(super) struct Line {
    pub(super) line: FreeLine,
    /// The part of it that was free when it was found.
    pub(super) span: FreeSpan,
}

/// A visible pair, and the line that proves it: both lie on the free part.
#[derive(Debug, Clone, Copy)]
pub(super) struct Proof {
    /// Two cells, or an object and a cell.
    pub(super) pair: [u32; 2],
    /// The index of the line.
    pub(super) line: u32,
}

/// Why pairs count as visible: each visible pair of regular cells, and of an object and a regular cell that it does not
/// touch, is in exactly one list, once.
#[derive(Debug, Clone, Default)]
pub(super) struct WitnessLog {
    pub(super) lines: Vec<Line>,
    /// Pairs of cells.
    pub(super) cells: Vec<Proof>,
    /// Pairs of an object and a cell.
    pub(super) objects: Vec<Proof>,
    /// Pairs of cells that count as visible because they are too hard to decide, or that lines see each other by which
    /// doubles cannot hold.
    pub(super) without_line: Vec<[u32; 2]>,
    /// The same for an object and a cell.
    pub(super) objects_without_line: Vec<[u32; 2]>,
    /// Pairs of an object and a cell that sees a cell inside the object.
    pub(super) inside: Vec<[u32; 2]>,
}

impl WitnessLog {
    /// Adds the records of another search.
    pub(super) fn append(&mut self, mut other: Self) {
        let first = self.lines.len() as u32;
        let moved = |proof: Proof| Proof { line: first + proof.line, ..proof };
        self.lines.append(&mut other.lines);
        self.cells.extend(other.cells.into_iter().map(moved));
        self.objects.extend(other.objects.into_iter().map(moved));
        self.without_line.append(&mut other.without_line);
        self.objects_without_line.append(&mut other.objects_without_line);
        self.inside.append(&mut other.inside);
    }

    /// Removes lines, by their indices, ascending. Returns them, and for each old line its new index, or `None` if it
    /// was removed; proofs are left as they are. O(lines), with little work for each line that stays.
    pub(super) fn take_lines(&mut self, out: &[u32]) -> (Vec<Line>, Vec<Option<u32>>) {
        let mut number = vec![None; self.lines.len()];
        let mut origin: Vec<u32> = (0..self.lines.len() as u32).collect();
        let take = |&i: &u32| {
            origin.swap_remove(i as usize);
            self.lines.swap_remove(i as usize)
        };
        let taken = out.iter().rev().map(take).collect();
        for (now, before) in (0u32..).zip(origin) {
            number[before as usize] = Some(now);
        }
        (taken, number)
    }

    /// Drops lines that prove nothing, if they are more than a quarter. O(proofs).
    pub(super) fn compact(&mut self) {
        let mut idle = vec![true; self.lines.len()];
        self.cells.iter().chain(&self.objects).for_each(|proof| idle[proof.line as usize] = false);
        let out: Vec<u32> = (0u32..).zip(&idle).filter(|(_, idle)| **idle).map(|(line, _)| line).collect();
        if out.len() <= self.lines.len() / 4 {
            return;
        }
        let (_, number) = self.take_lines(&out);
        for proof in self.cells.iter_mut().chain(&mut self.objects) {
            proof.line = number[proof.line as usize].unwrap_or(proof.line);
        }
    }
}

/// Why a line was sought: a pair that it proves, even if doubles cannot confirm that it passes both.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum FoundFor {
    /// Groups, which proves nothing by itself.
    Groups,
    /// Two cells, by their places.
    Cells([usize; 2]),
    /// An object, and a cell by its place.
    Object([usize; 2]),
}

/// The working memory of one thread.
#[derive(Debug)]
pub(super) struct Worker<'a> {
    pub(super) shaft: Shaft<'a>,
    /// Its records, if any are kept.
    pub(super) log: Option<WitnessLog>,
}

impl Worker<'_> {
    /// The records since the last call.
    pub(super) fn take_log(&mut self) -> WitnessLog {
        self.log.as_mut().map(std::mem::take).unwrap_or_default()
    }
}
