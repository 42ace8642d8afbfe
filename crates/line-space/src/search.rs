//! The search: cells of line space are blocked by chains or cut in two, until none is left or one has a free line.

use crate::chain::{AtFold, Blocked, ChainFinder, Gap, Shaft};
use crate::marks::Marks;
use crate::roots::{Root, Roots};
use crate::side::{Part, Side};
use crate::split::{promise, split};
use crate::surface::{Hit, Surface};
use crate::touch::Target;
use sightlines_geometry::{Aabb, Random};
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

/// Hits this near to the end of a line count as its end: the target itself, or what lies on it. So `Reached` may be wrong by that part of a
/// line, which shows more; what is hidden is never decided by it.
pub(crate) const AT_END: f64 = 1e-6;

/// When a search ends although cells of line space are left.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Patience {
    /// Never.
    Full,
    /// When more cells wait than the budget allows, or when many cells have blocked little: when after n cells the share of lines that is
    /// still open exceeds [`HOPELESS`] times the square root of the budget, divided by n.
    WhileItPays,
}

/// Of the boxes and triangles that were found hidden in two real scenes at most one in ten was beyond that before; of the others
/// one in two.
const HOPELESS: f64 = 1.25;

/// How many triangles a chain has beyond its first fold. Chains that fold once and block are short as a rule; most others go
/// around what they began on.
pub(crate) const MOST_BEYOND_FOLD: usize = 32;

/// The search for the lines between two ends, with its memory.
#[derive(Debug)]
pub(crate) struct Search {
    finder: ChainFinder,
    queue: VecDeque<Root>,
    hits: Vec<Hit>,
    /// How many hits of a line are tried as starts of chains.
    attempts: usize,
    /// How often chains blocked all lines of a cell, by the triangle where they began. What blocks the lines to one target often blocks those to
    /// the next.
    successes: Marks<u32>,
}

impl Search {
    pub(crate) fn new(surface: &Surface, attempts: usize, longest: usize) -> Self {
        let successes = Marks::new(surface.mesh().triangles().len());
        Self {
            finder: ChainFinder::new(surface, longest),
            queue: VecDeque::new(),
            hits: Vec::new(),
            attempts,
            successes,
        }
    }

    /// Has to come before the lines from another volume; forgets as well.
    pub(crate) fn look_from(&mut self, volume: &Aabb<3>) {
        self.finder.look_from(volume);
        self.forget();
    }

    /// Forgets where chains that blocked lines began. Between two calls, the outcome of a search may depend on earlier ones.
    pub(crate) fn forget(&mut self) {
        self.successes.forget();
    }

    /// Decides about all lines of the roots, with at most `budget` cells of line space, or fewer by `patience`.
    pub(crate) fn run(
        &mut self,
        surface: &Surface,
        roots: &Roots,
        target: &Target,
        budget: u32,
        patience: Patience,
    ) -> (Outcome, u32) {
        self.queue.clear();
        self.queue.extend(roots.whole());
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
            // Each cell that waits takes at least one from the budget.
            let is_too_long = patience == Patience::WhileItPays && self.queue.len() as u32 >= budget.saturating_sub(n);
            if n == budget || open * f64::from(n) > hopeless || is_too_long {
                return (Outcome::Undecided, n);
            }
            n += 1;
            let parts = roots.parts(&root);
            if root.cell.from.counts_for_nothing(|t| surface.corners(t)) {
                open -= root.share;
                continue;
            }
            let Some(mut shaft) = Shaft::new(root.cell, root.start, target, surface, &mut random) else {
                return (Outcome::Undecided, n);
            };
            let root = Root { cell: shaft.cell, ..root };
            let side = root.limit.map(|limit| Side::new(&root.cell, limit));
            let side = match side.map(|side| (side, side.part())) {
                Some((_, Part::None)) => {
                    open -= root.share;
                    continue;
                }
                Some((side, Part::Some)) => Some(side),
                // Asks a little more, never less.
                Some((_, Part::All)) | None => None,
            };
            let root = Root { limit: side.map(|side| side.limit), ..root };
            let is_ready = side.is_none_or(|side| shaft.limit(side, &mut random));
            let gap = if is_ready {
                surface.hits(shaft.line[0], shaft.line[1], &mut self.hits);
                let finder = &mut self.finder;
                self.hits.retain(|hit| finder.blocks(surface, &shaft, hit.triangle));
                let is_free = self.hits.iter().all(|hit| hit.at > 1.0 - AT_END);
                // A line of a root with parts may be none of those in question.
                if is_free && parts.is_empty() {
                    return (Outcome::Reached, n);
                }
                match if is_free { Err(Gap::Other) } else { self.block(surface, &shaft, target) } {
                    Ok(Blocked::All) => {
                        open -= root.share;
                        continue;
                    }
                    Ok(Blocked::Side { limit, share }) => {
                        let blocked = share * root.share;
                        open -= blocked;
                        let limit = Some(limit.opposite());
                        self.queue.push_back(Root { limit, share: root.share - blocked, ..root });
                        continue;
                    }
                    Err(gap) => gap,
                }
            } else {
                Gap::Other
            };
            if !parts.is_empty() {
                let share = root.share / parts.len() as f64;
                self.queue.extend(parts.iter().map(|part| Root { limit: root.limit, share, ..*part }));
                continue;
            }
            let Some(parts) = split(surface, &shaft, &gap) else { return (Outcome::Undecided, n) };
            let first = self.queue.len();
            self.queue.extend(parts.into_iter().flatten().map(|cell| Root { cell, ..root }));
            let share = root.share / (self.queue.len() - first) as f64;
            self.queue.iter_mut().skip(first).for_each(|part| part.share = share);
        }
        (Outcome::Hidden, n)
    }

    /// Blocks the lines of a cell, or those on one side of an edge, by one of several chains, or says where best to cut.
    fn block(&mut self, surface: &Surface, shaft: &Shaft, target: &Target) -> Result<Blocked, Gap> {
        let successes = |hit: &Hit| self.successes.get(hit.triangle).unwrap_or_default();
        self.hits.sort_unstable_by(|a, b| {
            let by_success = successes(b).cmp(&successes(a));
            let by_area = || surface.area(b.triangle).total_cmp(&surface.area(a.triangle));
            by_success.then_with(by_area).then(a.triangle.cmp(&b.triangle))
        });
        self.hits.dedup_by_key(|hit| hit.triangle);
        self.hits.truncate(self.attempts);
        self.finder.next_cell();
        let (mut best, mut most) = ((f64::NEG_INFINITY, Gap::Other), None::<(f64, Blocked)>);
        let mut note = |gap: Gap| {
            let promise = promise(surface, shaft, &gap);
            if promise > best.0 {
                best = (promise, gap);
            }
        };
        let finder = &mut self.finder;
        let mut folding = Vec::new();
        for hit in &self.hits {
            match finder.block(surface, shaft, target, hit.triangle, AtFold::Leave) {
                Ok(Blocked::All) => {
                    let n = self.successes.get(hit.triangle).unwrap_or_default();
                    self.successes.set(hit.triangle, n.saturating_add(1));
                    return Ok(Blocked::All);
                }
                Ok(part @ Blocked::Side { share, .. }) => {
                    if most.is_none_or(|most| share > most.0) {
                        most = Some((share, part));
                    }
                }
                Err(failure) => {
                    if failure.can_fold {
                        folding.push(hit.triangle);
                    }
                    note(failure.gap);
                }
            }
        }
        if let Some((_, part)) = most {
            return Ok(part);
        }
        folding.reverse();
        while let Some(triangle) = folding.pop() {
            match finder.block(surface, shaft, target, triangle, AtFold::Follow(MOST_BEYOND_FOLD)) {
                Ok(blocked) => return Ok(blocked),
                Err(failure) => note(failure.gap),
            }
            // A chain that has gone around to another hit is the one from there, as a rule.
            folding.retain(|&other| !finder.has(other));
        }
        Err(best.1)
    }
}
