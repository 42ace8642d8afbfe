//! Sets that are emptied at once.

use sightlines_pvs::{CellId, ObjectId};

/// What counts from 0 without large gaps.
pub(crate) trait Dense: Copy + Ord {
    fn idx(self) -> usize;
}

impl Dense for u32 {
    fn idx(self) -> usize {
        self as usize
    }
}

impl Dense for CellId {
    fn idx(self) -> usize {
        Self::idx(self)
    }
}

impl Dense for ObjectId {
    fn idx(self) -> usize {
        Self::idx(self)
    }
}

/// A set of small numbers with the order in which they came; emptying it does not touch its memory.
#[derive(Debug, Clone)]
pub(crate) struct EpochSet<T = u32> {
    /// Who has the current epoch is in.
    epochs: Vec<u32>,
    epoch: u32,
    list: Vec<T>,
}

impl<T> Default for EpochSet<T> {
    fn default() -> Self {
        Self { epochs: Vec::new(), epoch: 0, list: Vec::new() }
    }
}

impl<T: Dense> EpochSet<T> {
    /// Empties the set and makes room for numbers below `n`.
    pub(crate) fn clear(&mut self, n: usize) {
        if self.epoch == u32::MAX {
            self.epochs.fill(0);
            self.epoch = 0;
        }
        self.epoch += 1;
        self.list.clear();
        if self.epochs.len() < n {
            self.epochs.resize(n, 0);
        }
    }

    /// Adds a number; whether it is new.
    #[inline]
    pub(crate) fn add(&mut self, i: T) -> bool {
        let new = self.epochs[i.idx()] != self.epoch;
        if new {
            self.epochs[i.idx()] = self.epoch;
            self.list.push(i);
        }
        new
    }

    /// Whether a number is in; one that there is no room for is not.
    #[inline]
    pub(crate) fn has(&self, i: T) -> bool {
        self.epochs.get(i.idx()).is_some_and(|&e| e == self.epoch && self.epoch > 0)
    }

    /// What came, in order.
    pub(crate) fn list(&self) -> &[T] {
        &self.list
    }

    /// Puts the list in ascending order.
    pub(crate) fn sort(&mut self) {
        self.list.sort_unstable();
    }
}

/// Numbers with a yes or a no for each that was decided; forgetting all does not touch the memory.
#[derive(Debug, Clone, Default)]
pub(crate) struct Decided {
    /// Twice the epoch for no, one more for yes.
    answers: Vec<u32>,
    epoch: u32,
}

impl Decided {
    /// Forgets all and makes room for numbers below `n`.
    pub(crate) fn clear(&mut self, n: usize) {
        if self.epoch >= u32::MAX / 2 {
            self.answers.fill(0);
            self.epoch = 0;
        }
        self.epoch += 1;
        if self.answers.len() < n {
            self.answers.resize(n, 0);
        }
    }

    /// The answer for `i`, decided now if it is not yet.
    #[inline]
    pub(crate) fn get(&mut self, i: u32, decide: impl FnOnce() -> bool) -> bool {
        let answer = &mut self.answers[i as usize];
        if *answer >> 1 != self.epoch {
            *answer = 2 * self.epoch + u32::from(decide());
        }
        *answer & 1 == 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_are_forgotten() {
        let mut marks = EpochSet::<u32>::default();
        assert!(!marks.has(0));
        marks.clear(3);
        assert!(marks.add(2) && marks.add(0) && !marks.add(2) && marks.has(2) && !marks.has(1));
        assert_eq!(marks.list(), [2, 0]);
        marks.epoch = u32::MAX;
        marks.clear(5);
        assert!((0..5).all(|i| !marks.has(i)) && marks.list().is_empty());
    }

    #[test]
    fn answers_are_kept_until_forgotten() {
        let mut decided = Decided::default();
        decided.clear(2);
        assert!(decided.get(1, || true) && decided.get(1, || false) && !decided.get(0, || false));
        decided.epoch = u32::MAX / 2;
        decided.clear(2);
        assert!(!decided.get(1, || false));
    }
}
