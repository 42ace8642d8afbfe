use super::*;
use proptest::prelude::*;

/// A symmetric matrix with ones on the diagonal, and weights.
fn sights() -> impl Strategy<Value = (BitMatrix, Option<BitMatrix>, Vec<u64>, Vec<u64>)> {
    (1usize..90, 0usize..70).prop_flat_map(|(n, m)| {
        let pairs = prop::collection::vec((0..n, 0..n), 0..2 * n);
        let seen = prop::option::of(prop::collection::vec((0..n, 0..m.max(1)), 0..n));
        let weights = prop::collection::vec(1u64..9, n);
        let members = prop::collection::vec(1u64..4, n);
        (pairs, seen, weights, members).prop_map(move |(pairs, seen, weights, members)| {
            let mut cells = BitMatrix::identity(n);
            for (a, b) in pairs {
                cells.set(a, b, true);
                cells.set(b, a, true);
            }
            let objects = seen.map(|seen| {
                let mut objects = BitMatrix::new(n, m);
                seen.into_iter().filter(|_| m > 0).for_each(|(i, o)| objects.set(i, o, true));
                objects
            });
            (cells, objects, weights, members)
        })
    })
}

fn is_symmetric(bits: &BitMatrix) -> bool {
    (0..bits.n_rows()).all(|i| (0..=i).all(|j| bits.get(i, j) == bits.get(j, i)) && bits.get(i, i))
}

/// Number of pairs that `more` has and `less` does not; `None` if it lacks one.
fn added(less: &BitMatrix, more: &BitMatrix, of: &[u32]) -> Option<usize> {
    let mut n = 0;
    for (i, j) in (0..less.n_rows()).flat_map(|i| (0..less.n_cols()).map(move |j| (i, j))) {
        match (less.get(i, j), more.get(of[i] as usize, of[j] as usize)) {
            (true, false) => return None,
            (false, true) => n += 1,
            _ => {}
        }
    }
    Some(n)
}

proptest! {
    /// Whatever is merged, nothing visible is hidden, and the matrix stays valid for a table; more merges never show
    /// less; without merges nothing is added (the tightness twin).
    #[test]
    fn merging_only_adds_sight((cells, objects, weights, members) in sights()) {
        let n = cells.n_rows();
        let object_weights = vec![1; objects.as_ref().map_or(0, BitMatrix::n_cols)];
        let sight = Sight { cells: &cells, objects: objects.as_ref(), n_members: &members, weights: &weights, object_weights: &object_weights };
        let order = merge_order(&sight);
        prop_assert_eq!(order.len(), n - 1);
        let mut last = 0;
        for k in 0..n {
            let (of, n_left) = after(&order, k, n);
            prop_assert_eq!(n_left, n - k);
            let bits = merged(&cells, &of, n_left, true);
            prop_assert!(is_symmetric(&bits));
            let more = added(&cells, &bits, &of);
            prop_assert!(more.is_some_and(|more| more >= last && (k > 0 || more == 0)));
            last = more.unwrap_or(0);
            if let Some(objects) = &objects {
                let rows = merged(objects, &of, n_left, false);
                for (i, &into) in of.iter().enumerate() {
                    prop_assert!(objects.row(i).iter().zip(rows.row(into as usize)).all(|(a, b)| a & !b == 0));
                }
            }
        }
        prop_assert_eq!(after(&order, n - 1, n), (vec![0; n], 1));
    }

    /// Tightness: the cheapest merges come first.
    #[test]
    fn blocks_are_merged_before_anything_else(n_blocks in 2usize..9, size in 2usize..6, noise in any::<u64>()) {
        // Cells of a block see each other, except for one pair.
        let n = n_blocks * size;
        let mut cells = BitMatrix::identity(n);
        for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
            cells.set(i, j, i / size == j / size);
        }
        let (a, b) = ((noise % n as u64) as usize, (noise / 97 % n as u64) as usize);
        if a != b {
            cells.set(a, b, false);
            cells.set(b, a, false);
        }
        let ones = vec![1; n];
        let sight = Sight { cells: &cells, objects: None, n_members: &ones, weights: &ones, object_weights: &[] };
        let order = merge_order(&sight);
        // Within the window each block is one class after its merges, at the price of the one pair.
        let (of, n_left) = after(&order, n - n_blocks, n);
        prop_assert!(added(&cells, &merged(&cells, &of, n_left, true), &of).is_some_and(|n| n <= 2));
    }
}

/// The impostor: rows merged without their columns are not symmetric, and the check above detects it.
#[test]
fn rows_alone_are_not_symmetric() {
    let mut cells = BitMatrix::identity(3);
    cells.set(0, 2, true);
    cells.set(2, 0, true);
    let mut rows = cells.clone();
    rows.or_into(1, 0);
    assert!(is_symmetric(&cells) && !is_symmetric(&rows));
    assert_eq!(added(&rows, &cells, &[0, 1, 2]), None);
}
