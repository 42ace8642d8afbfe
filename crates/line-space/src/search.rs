//! The search: cells of line space are blocked by chains or cut in two, until none is left or one has a free line.

use crate::cell::Cell;
use crate::chain::{ChainFinder, Gap, Shaft};
use crate::split::{promise, split};
use crate::surface::{Hit, Surface};
use crate::touch::{Start, Target};
use sightlines_geometry::Random;
use std::collections::VecDeque;

/// What was found about all lines of some cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// Every line is blocked, by exact predicates.
    Hidden,
    /// A line was found that meets nothing, as doubles have it.
    Reached,
    /// Neither, within the effort allowed.
    Undecided,
}

/// A cell that waits, and where its lines begin.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Root {
    pub(crate) cell: Cell,
    pub(crate) start: Start,
    /// Its part of all lines, roughly: halves have half of it.
    pub(crate) share: f64,
}

/// Hits this near to the end of a line count as its end: the target itself, or what lies on it. So `Reached` may be wrong by that part of a
/// line, which shows more; what is hidden is never decided by it.
const AT_END: f64 = 1e-6;

/// When a search ends although cells of line space are left.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Patience {
    /// Never.
    Full,
    /// When little was blocked by many cells: if the share of lines that is open after n cells is more than [`HOPELESS`], times the root
    /// of the budget, over n.
    WhileItPays,
}

/// Of the boxes and triangles that were found hidden in two real scenes at most one in ten was beyond that before; of the others
/// one in two.
const HOPELESS: f64 = 1.25;

/// The search for the lines between two ends, with its memory.
#[derive(Debug)]
pub(crate) struct Search {
    finder: ChainFinder,
    queue: VecDeque<Root>,
    hits: Vec<Hit>,
    /// How many hits of a line are tried as starts of chains.
    attempts: usize,
}

impl Search {
    pub(crate) fn new(surface: &Surface, attempts: usize, longest: usize) -> Self {
        Self { finder: ChainFinder::new(surface, longest), queue: VecDeque::new(), hits: Vec::new(), attempts }
    }

    /// Decides about all lines of the roots, with at most `budget` cells of line space, or fewer by `patience`.
    pub(crate) fn run(
        &mut self,
        surface: &Surface,
        roots: impl IntoIterator<Item = Root>,
        target: &Target,
        budget: u32,
        patience: Patience,
    ) -> (Outcome, u32) {
        self.queue.clear();
        self.queue.extend(roots);
        let n_roots = self.queue.len() as f64;
        self.queue.iter_mut().for_each(|root| root.share = 1.0 / n_roots);
        let hopeless = match patience {
            Patience::Full => f64::INFINITY,
            Patience::WhileItPays => HOPELESS * f64::from(budget).sqrt(),
        };
        let mut open = 1.0;
        if self.queue.is_empty() {
            return (Outcome::Undecided, 0);
        }
        let mut random = Random::new(1);
        let mut n = 0;
        while let Some(root) = self.queue.pop_front() {
            if n == budget || open * f64::from(n) > hopeless {
                return (Outcome::Undecided, n);
            }
            n += 1;
            let mut weights = || [0; 4].map(|_| 0.7 + 0.6 * random.unit());
            let Some(shaft) = Shaft::new(root.cell, root.start, [weights(), weights()]) else {
                return (Outcome::Undecided, n);
            };
            surface.hits(shaft.line[0], shaft.line[1], &mut self.hits);
            if self.hits.iter().all(|hit| hit.at > 1.0 - AT_END) {
                return (Outcome::Reached, n);
            }
            match self.block(surface, &shaft, target) {
                None => open -= root.share,
                Some(gap) => match split(surface, &shaft, &gap) {
                    Some(halves) => {
                        self.queue.extend(halves.map(|cell| Root { cell, share: root.share / 2.0, ..root }))
                    }
                    None => return (Outcome::Undecided, n),
                },
            }
        }
        (Outcome::Hidden, n)
    }

    /// Blocks a cell by one of several chains, or says where best to cut.
    fn block(&mut self, surface: &Surface, shaft: &Shaft, target: &Target) -> Option<Gap> {
        self.hits.sort_unstable_by(|a, b| {
            surface.area(b.triangle).total_cmp(&surface.area(a.triangle)).then(a.triangle.cmp(&b.triangle))
        });
        self.hits.dedup_by_key(|hit| hit.triangle);
        self.finder.next_cell();
        let mut best = (f64::NEG_INFINITY, Gap::Other);
        for hit in self.hits.iter().take(self.attempts) {
            match self.finder.block(surface, shaft, target, hit.triangle) {
                Ok(()) => return None,
                Err(gap) => {
                    let promise = promise(surface, shaft, &gap);
                    if promise > best.0 {
                        best = (promise, gap);
                    }
                }
            }
        }
        Some(best.1)
    }
}
