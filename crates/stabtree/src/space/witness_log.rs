//! What a search writes down for a later one: lines, and which pairs each of them was the first to prove.

use sightlines_sightline::{FreeLine, FreeSpan, Shaft};

/// A line that is free.
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

/// Why pairs count as visible: each visible pair of regular cells, and of an object and a regular cell that it does
/// not touch, is in one list, once.
#[derive(Debug, Clone, Default)]
pub(super) struct WitnessLog {
    pub(super) lines: Vec<Line>,
    /// Pairs of cells.
    pub(super) cells: Vec<Proof>,
    /// Pairs of an object and a cell.
    pub(super) objects: Vec<Proof>,
    /// Pairs of cells that count as visible as it is too hard to decide about them.
    pub(super) assumed: Vec<[u32; 2]>,
    /// The same for an object and a cell.
    pub(super) assumed_objects: Vec<[u32; 2]>,
    /// Pairs of an object and a cell that sees a cell inside of the object.
    pub(super) inside: Vec<[u32; 2]>,
}

impl WitnessLog {
    /// Adds those of another search.
    pub(super) fn append(&mut self, mut other: Self) {
        let first = self.lines.len() as u32;
        let moved = |proof: Proof| Proof { line: first + proof.line, ..proof };
        self.lines.append(&mut other.lines);
        self.cells.extend(other.cells.into_iter().map(moved));
        self.objects.extend(other.objects.into_iter().map(moved));
        self.assumed.append(&mut other.assumed);
        self.assumed_objects.append(&mut other.assumed_objects);
        self.inside.append(&mut other.inside);
    }

    /// Takes lines out, by their indices, ascending. Returns them, and for each line there was its index now, or
    /// `None` if it is out; proofs are left as they are. O(lines), with little of it for each line that stays.
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

/// What a line was found for: a pair that it proves, whether or not doubles can tell that it passes both.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum FoundFor {
    /// Groups, of which nothing follows.
    Groups,
    /// Two cells, by their places.
    Cells([usize; 2]),
    /// An object, and a cell by its place.
    Object([usize; 2]),
}

/// What one thread works with.
#[derive(Debug)]
pub(super) struct Worker<'a> {
    pub(super) shaft: Shaft<'a>,
    /// What it writes down, if anything.
    pub(super) log: Option<WitnessLog>,
}

impl Worker<'_> {
    /// What was written down since the last time.
    pub(super) fn take_log(&mut self) -> WitnessLog {
        self.log.as_mut().map(std::mem::take).unwrap_or_default()
    }
}
