//! REJECT tables, against matrices.

use proptest::prelude::*;
use sightlines_formats::RejectTable;

#[test]
fn rows_of_what_is_seen_make_the_table() {
    for n in [0u32, 1, 2, 7, 8, 63, 64, 65, 130] {
        let seen = |a: u32, b: u32| (a * 7 + b * 13) % 5 < 2;
        let rows: Vec<Vec<u64>> = (0..n)
            .map(|a| {
                let mut row = vec![0u64; n.div_ceil(64) as usize];
                (0..n).filter(|&b| seen(a, b)).for_each(|b| row[b as usize / 64] |= 1 << (b % 64));
                row
            })
            .collect();
        let table = RejectTable::from_seen_rows(n, rows.iter().map(Vec::as_slice));
        let mut expected = RejectTable::new(n);
        (0..n).for_each(|a| (0..n).for_each(|b| expected.set(a, b, !seen(a, b))));
        assert_eq!(table, expected, "{n} sectors");
    }
}

#[test]
fn bits_are_where_the_engine_looks() {
    let mut table = RejectTable::new(3);
    assert_eq!(table.as_bytes(), [0, 0]);
    table.set(0, 1, true);
    table.set(2, 2, true);
    assert_eq!(table.as_bytes(), [0b0000_0010, 0b0000_0001]);
    table.set(2, 2, false);
    assert_eq!((table.n_rejected(), table.into_bytes()), (1, vec![2, 0]));
}

#[test]
fn only_the_right_length_is_read() {
    for len in [0, 1, 3] {
        assert!(RejectTable::from_bytes(3, &vec![0; len]).is_err());
    }
    let error = RejectTable::from_bytes(3, &[]).unwrap_err();
    assert_eq!(error.to_string(), "REJECT has 0 bytes, but 3 sectors need 2");
    assert_eq!(RejectTable::from_bytes(3, &[0xFF, 0xFF]).unwrap().as_bytes(), [0xFF, 1]);
    assert_eq!(RejectTable::from_bytes(4, &[0xFF, 0xFF]).unwrap().as_bytes(), [0xFF, 0xFF]);
    assert_eq!(RejectTable::from_bytes(0, &[]), Ok(RejectTable::new(0)));
}

#[test]
fn effects_are_distinguished_from_sight() {
    let mut table = RejectTable::new(5);
    table.set(1, 4, true);
    assert!(!table.is_symmetric() && table.has_hand_made_effects());
    table.set(4, 1, true);
    assert!(table.is_symmetric() && !table.has_hand_made_effects());
    table.set(3, 3, true);
    assert!(table.is_symmetric() && table.has_hand_made_effects());
    assert_eq!(table.rejects_itself(), Some(3));
}

#[test]
fn large_tables_are_quick_to_check() {
    let mut table = RejectTable::new(1700);
    table.set(1699, 1698, true);
    assert!(!table.is_symmetric());
    table.set(1698, 1699, true);
    assert!(table.is_symmetric() && table.rejects_itself().is_none());
}

proptest! {
    /// Invariant: a table holds what a matrix of booleans holds, also after a trip through bytes.
    #[test]
    fn reject_agrees_with_a_matrix(n in 1u32..9, ones in prop::collection::vec((0u32..9, 0u32..9), 0..30)) {
        let mut matrix = vec![vec![false; n as usize]; n as usize];
        let mut table = RejectTable::new(n);
        for (k, (a, b)) in ones.into_iter().map(|(a, b)| (a % n, b % n)).enumerate() {
            table.set(a, b, k % 4 != 3);
            matrix[a as usize][b as usize] = k % 4 != 3;
        }
        let table = RejectTable::from_bytes(n, table.as_bytes()).unwrap();
        let all = || (0..n).flat_map(|a| (0..n).map(move |b| (a, b)));
        let truth = |a: u32, b: u32| matrix[a as usize][b as usize];
        prop_assert!(all().all(|(a, b)| table.get(a, b) == truth(a, b)));
        prop_assert_eq!(table.is_symmetric(), all().all(|(a, b)| truth(a, b) == truth(b, a)));
        prop_assert_eq!(table.rejects_itself(), (0..n).find(|&s| truth(s, s)));
        prop_assert_eq!(table.n_rejected(), all().filter(|&(a, b)| truth(a, b)).count() as u64);
    }
}
