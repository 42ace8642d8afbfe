//! Equal rows and equal columns are stored once.

use sightlines_pvs::BitMatrix;
use sightlines_pvs::bits::ones;
use std::collections::HashMap;

/// A division of rows or columns into classes of equal ones.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Classes {
    /// The class of each; classes are numbered by their first members.
    pub of: Vec<u32>,
    /// The first member of each class.
    pub first: Vec<u32>,
}

impl Classes {
    /// Numbers `keys` by first occurrence. O(n) expected; found by hash, compared exactly.
    pub(crate) fn of_keys<K: std::hash::Hash + Eq>(keys: impl Iterator<Item = K>) -> Self {
        let mut known: HashMap<K, u32> = HashMap::new();
        let mut classes = Self { of: Vec::new(), first: Vec::new() };
        for (i, key) in (0u32..).zip(keys) {
            let next = classes.first.len() as u32;
            let class = *known.entry(key).or_insert(next);
            if class == next {
                classes.first.push(i);
            }
            classes.of.push(class);
        }
        classes
    }

    /// The classes of equal rows.
    pub fn of_rows(matrix: &BitMatrix) -> Self {
        Self::of_keys((0..matrix.n_rows()).map(|i| matrix.row(i)))
    }

    /// The classes of equal columns. O(ones).
    pub fn of_columns(matrix: &BitMatrix) -> Self {
        Self::of_rows(&transposed(matrix))
    }

    /// Whether no two are equal.
    pub(crate) fn is_identity(&self) -> bool {
        self.of.len() == self.first.len()
    }
}

fn transposed(matrix: &BitMatrix) -> BitMatrix {
    let mut out = BitMatrix::new(matrix.n_cols(), matrix.n_rows());
    for i in 0..matrix.n_rows() {
        matrix.iter_ones(i).for_each(|j| out.set(j, i, true));
    }
    out
}

/// A matrix without repeated rows and columns.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Distinct {
    /// Classes of rows.
    pub rows: Classes,
    /// Classes of columns.
    pub columns: Classes,
    /// Bit (p, q): the rows of class p have ones in the columns of class q.
    pub bits: BitMatrix,
}

impl Distinct {
    /// Removes repeated rows and columns. O(words) expected, and O(ones of the distinct rows).
    pub fn new(matrix: &BitMatrix) -> Self {
        let rows = Classes::of_rows(matrix);
        let mut kept = BitMatrix::new(rows.first.len(), matrix.n_cols());
        for (p, &i) in rows.first.iter().enumerate() {
            kept.row_mut(p).copy_from_slice(matrix.row(i as usize));
        }
        let columns = Classes::of_columns(&kept);
        if columns.is_identity() {
            return Self { rows, columns, bits: kept };
        }
        let mut bits = BitMatrix::new(rows.first.len(), columns.first.len());
        for p in 0..kept.n_rows() {
            let row = kept.row(p);
            let is_one = |j: usize| row[j / 64] >> (j % 64) & 1 == 1;
            for q in (0..columns.first.len()).filter(|&q| is_one(columns.first[q] as usize)) {
                bits.set(p, q, true);
            }
        }
        Self { rows, columns, bits }
    }

    /// The matrix with all its repetitions. O(words and ones of the result).
    pub fn expand(&self) -> BitMatrix {
        let mut out = BitMatrix::new(self.rows.of.len(), self.columns.of.len());
        let members = Members::new(&self.columns.of, self.columns.first.len());
        for (p, &first) in self.rows.first.iter().enumerate() {
            for q in ones(self.bits.row(p)) {
                members.of(q).iter().for_each(|&j| out.set(first as usize, j as usize, true));
            }
        }
        for (i, &class) in self.rows.of.iter().enumerate() {
            let first = self.rows.first[class as usize] as usize;
            if first != i {
                out.or_into(i, first);
            }
        }
        out
    }
}

/// The members of classes, ascending.
#[derive(Debug, Clone)]
pub(crate) struct Members {
    starts: Vec<u32>,
    members: Vec<u32>,
}

impl Members {
    /// `of` are the classes, all below `n_classes`. O(n).
    pub(crate) fn new(of: &[u32], n_classes: usize) -> Self {
        let mut starts = vec![0u32; n_classes + 1];
        of.iter().for_each(|&class| starts[class as usize + 1] += 1);
        (0..n_classes).for_each(|class| starts[class + 1] += starts[class]);
        let mut next = starts.clone();
        let mut members = vec![0u32; of.len()];
        for (i, &class) in (0u32..).zip(of) {
            members[next[class as usize] as usize] = i;
            next[class as usize] += 1;
        }
        Self { starts, members }
    }

    #[inline]
    pub(crate) fn of(&self, class: usize) -> &[u32] {
        &self.members[self.starts[class] as usize..self.starts[class + 1] as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Matrices in which rows and columns repeat.
    fn matrices() -> impl Strategy<Value = BitMatrix> {
        (0usize..90, 0usize..90, 1usize..9, 1usize..9, any::<u64>()).prop_map(|(n, m, p, q, seed)| {
            let mut matrix = BitMatrix::new(n, m);
            let bit = |i: usize, j: usize| seed.rotate_left((7 * (i * i % p) + 3 * (j * j % q)) as u32) & 1 == 1;
            (0..n).for_each(|i| (0..m).for_each(|j| matrix.set(i, j, bit(i, j))));
            matrix
        })
    }

    proptest! {
        #[test]
        fn repetitions_come_back_and_nothing_repeats(matrix in matrices()) {
            let distinct = Distinct::new(&matrix);
            prop_assert_eq!(&distinct.expand(), &matrix);
            // Tightness: what is left has no two equal rows or columns, found by comparing all pairs.
            let bits = &distinct.bits;
            for (p, q) in (0..bits.n_rows()).flat_map(|p| (0..p).map(move |q| (p, q))) {
                prop_assert!(bits.row(p) != bits.row(q));
            }
            let column = |q: usize| (0..bits.n_rows()).map(|p| bits.get(p, q)).collect::<Vec<_>>();
            for (p, q) in (0..bits.n_cols()).flat_map(|p| (0..p).map(move |q| (p, q))) {
                prop_assert!(column(p) != column(q));
            }
        }

        #[test]
        fn members_are_those_of_the_class(of in prop::collection::vec(0u32..7, 0..50)) {
            let members = Members::new(&of, 7);
            for class in 0..7 {
                let expected: Vec<u32> = (0u32..).zip(&of).filter(|(_, c)| **c == class).map(|(i, _)| i).collect();
                prop_assert_eq!(members.of(class as usize), &expected[..]);
            }
        }
    }
}
