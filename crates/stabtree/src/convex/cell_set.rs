//! Sets of cells with mostly similar numbers, such as the cells in one beam.

use std::ops::Range;

/// A set of cells: the words of a row of bits from the first to the last that is not zero.
#[derive(Debug, Default)]
pub(super) struct CellSet {
    start: usize,
    words: Vec<u64>,
}

impl CellSet {
    pub(super) fn is_empty(&self) -> bool {
        self.words.is_empty()
    }

    pub(super) fn has(&self, cell: u32) -> bool {
        let word = (cell as usize / 64).checked_sub(self.start).and_then(|k| self.words.get(k));
        word.is_some_and(|word| word >> (cell % 64) & 1 == 1)
    }

    /// Sets it to the cells of a row.
    pub(super) fn set(&mut self, row: &[u64]) {
        self.start = 0;
        self.words.clear();
        self.words.extend_from_slice(row);
        self.trim();
    }

    /// Sets it to the intersection of another set and two rows.
    pub(super) fn set_common(&mut self, other: &Self, first: &[u64], second: &[u64]) {
        let range = other.range();
        self.start = other.start;
        self.words.clear();
        let rows = first[range.clone()].iter().zip(&second[range]);
        self.words.extend(other.words.iter().zip(rows).map(|(w, (a, b))| w & a & b));
        self.trim();
    }

    /// Keeps the cells that are in a row.
    pub(super) fn keep(&mut self, row: &[u64]) {
        let range = self.range();
        self.words.iter_mut().zip(&row[range]).for_each(|(w, row)| *w &= row);
        self.trim();
    }

    /// Keeps the cells for which `keep` returns `true`.
    pub(super) fn retain(&mut self, mut keep: impl FnMut(usize) -> bool) {
        for (k, word) in self.words.iter_mut().enumerate() {
            let mut bits = *word;
            while bits != 0 {
                let bit = bits.trailing_zeros();
                bits &= bits - 1;
                if !keep((self.start + k) * 64 + bit as usize) {
                    *word &= !(1 << bit);
                }
            }
        }
        self.trim();
    }

    /// Whether the two sets have a cell in common.
    pub(super) fn meets(&self, other: &Self) -> bool {
        let common = self.common(other);
        self.part(&common).iter().zip(other.part(&common)).any(|(a, b)| a & b != 0)
    }

    /// Removes the cells of another set.
    pub(super) fn remove(&mut self, other: &Self) {
        let common = self.common(other);
        let start = self.start;
        let theirs = other.part(&common);
        let ours = &mut self.words[common.start - start..common.end - start];
        ours.iter_mut().zip(theirs).for_each(|(a, b)| *a &= !b);
        self.trim();
    }

    /// The words, as a range of a row.
    fn range(&self) -> Range<usize> {
        self.start..self.start + self.words.len()
    }

    /// The words that both have; empty if they are disjoint.
    fn common(&self, other: &Self) -> Range<usize> {
        let (a, b) = (self.range(), other.range());
        let (start, end) = (a.start.max(b.start), a.end.min(b.end));
        if start < end { start..end } else { self.start..self.start }
    }

    fn part(&self, range: &Range<usize>) -> &[u64] {
        if range.is_empty() { &[] } else { &self.words[range.start - self.start..range.end - self.start] }
    }

    /// Drops zero words at both ends.
    fn trim(&mut self) {
        let last = self.words.iter().rposition(|&w| w != 0);
        self.words.truncate(last.map_or(0, |last| last + 1));
        let first = self.words.iter().position(|&w| w != 0).unwrap_or(0);
        if first > 0 {
            self.words.drain(..first);
            self.start += first;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use sightlines_pvs::bits::ones;
    use std::collections::BTreeSet;

    const N_WORDS: usize = 6;

    fn row() -> impl Strategy<Value = Vec<u64>> {
        proptest::collection::vec(
            prop_oneof![2 => Just(0u64), 1 => any::<u64>(), 1 => (0u32..64).prop_map(|b| 1 << b)],
            N_WORDS,
        )
    }

    fn cells(wanted: &CellSet) -> BTreeSet<usize> {
        (0..64 * N_WORDS).filter(|&cell| wanted.has(cell as u32)).collect()
    }

    fn of(row: &[u64]) -> (CellSet, BTreeSet<usize>) {
        let mut wanted = CellSet::default();
        wanted.set(row);
        (wanted, ones(row).collect())
    }

    proptest! {
        /// Compared with ordinary sets.
        #[test]
        fn sets_behave_like_sets(a in row(), b in row(), c in row()) {
            let ((mut x, xs), (y, ys), (_, zs)) = (of(&a), of(&b), of(&c));
            prop_assert_eq!(cells(&x), xs.clone());
            prop_assert_eq!(x.is_empty(), xs.is_empty());
            prop_assert_eq!(x.meets(&y), !xs.is_disjoint(&ys));
            let mut common = CellSet::default();
            common.set_common(&x, &b, &c);
            prop_assert_eq!(cells(&common), xs.iter().copied().filter(|k| ys.contains(k) && zs.contains(k)).collect());
            common.set(&a);
            common.keep(&b);
            prop_assert_eq!(cells(&common), xs.intersection(&ys).copied().collect());
            x.remove(&y);
            prop_assert_eq!(cells(&x), xs.difference(&ys).copied().collect());
            x.set(&a);
            x.retain(|cell| cell % 3 != 0);
            prop_assert_eq!(cells(&x), xs.iter().copied().filter(|cell| cell % 3 != 0).collect());
        }
    }
}
