//! Reaches and their file.

use crate::grid::{Grid, distances, grids};
use proptest::prelude::*;
use sightlines_pvs::{CellId, Table};
use sightlines_relevance::{ReachError, ReachFileError, ReachOptions, Reaches, Ways, WhoMoves};

fn ids(n: usize) -> impl Iterator<Item = CellId> {
    (0..n as u32).map(CellId)
}

/// The first reach of each pair, by its definition.
fn by_definition(table: &Table, options: &ReachOptions) -> Vec<Vec<usize>> {
    let n = table.n_cells();
    let far = distances(table, options.ways);
    let reaches: Vec<f64> = std::iter::once(0.0).chain(options.ladder.iter().copied()).collect();
    let gets = |i: usize, k: usize, reach: f64| i == k || reach > 0.0 && far[i][k] <= reach;
    let sees = |i: usize, j: usize, reach: f64| {
        let other = |l: usize| if options.movers == WhoMoves::Both { gets(j, l, reach) } else { j == l };
        (0..n).any(|k| gets(i, k, reach) && (0..n).any(|l| other(l) && table.sees(CellId(k as u32), CellId(l as u32))))
    };
    let first = |i: usize, j: usize| reaches.iter().position(|&reach| sees(i, j, reach)).unwrap_or(reaches.len());
    (0..n).map(|i| (0..n).map(|j| first(i, j)).collect()).collect()
}

fn options() -> impl Strategy<Value = ReachOptions> {
    let ladder = proptest::sample::subsequence(vec![0.5, 1.0, 2.0, 2.5, 3.0, 4.0, 7.0], 1..5);
    let movers = prop_oneof![Just(WhoMoves::Both), Just(WhoMoves::One)];
    let ways = prop_oneof![Just(Ways::Straight), Just(Ways::Portals)];
    (ladder, movers, ways, 1usize..4).prop_map(|(ladder, movers, ways, threads)| ReachOptions {
        ladder,
        movers,
        ways,
        threads,
    })
}

proptest! {
    #[test]
    fn rungs_are_those_of_the_definition(grid in grids(), options in options()) {
        let table = grid.table();
        let reaches = match Reaches::of(&table, &options) {
            Err(ReachError::NoPortals) => return Ok(()),
            reaches => reaches.expect("reaches"),
        };
        let expected = by_definition(&table, &options);
        for i in ids(table.n_cells()) {
            for j in ids(table.n_cells()) {
                prop_assert_eq!(reaches.rung(i, j), expected[i.idx()][j.idx()], "{} {}", i.0, j.0);
            }
        }
        let bytes = reaches.to_bytes();
        prop_assert_eq!(Reaches::from_bytes(&bytes, &table).expect("a file"), reaches);
    }
}

/// Pairs of 90 cells are in more than one word and in more than one byte.
#[test]
fn reaches_of_more_cells_than_bits_in_a_word() {
    let table = Grid { size: [6, 5, 3], seed: 5, blind: 300 }.table();
    let mut kinds = Vec::new();
    for (movers, ways) in
        [(WhoMoves::Both, Ways::Straight), (WhoMoves::One, Ways::Portals), (WhoMoves::Both, Ways::Portals)]
    {
        let options = ReachOptions { ladder: vec![0.5, 2.0, 4.0], movers, ways, threads: 2 };
        let reaches = Reaches::of(&table, &options).expect("reaches");
        let expected = by_definition(&table, &options);
        assert!(ids(90).all(|i| ids(90).all(|j| reaches.rung(i, j) == expected[i.idx()][j.idx()])));
        kinds.push(expected.into_iter().flatten().collect::<std::collections::BTreeSet<_>>().len());
        let shares = reaches.hidden_shares();
        assert!(shares.len() == 4 && shares.windows(2).all(|s| s[0] >= s[1]) && shares[0] > 0.9, "{shares:?}");
    }
    assert_eq!(kinds, [4, 5, 5], "all reaches occur, but that straight ways of both lead everywhere within 4");
}

#[test]
fn every_forged_byte_is_an_error() {
    let table = Grid { size: [3, 2, 1], seed: 2, blind: 5 }.table();
    let reaches =
        Reaches::of(&table, &ReachOptions { ladder: vec![1.0, 2.0], ..ReachOptions::default() }).expect("reaches");
    let bytes = reaches.to_bytes();
    for at in 0..bytes.len() {
        for bit in 0..8 {
            let mut forged = bytes.clone();
            forged[at] ^= 1 << bit;
            assert!(Reaches::from_bytes(&forged, &table).is_err(), "byte {at}");
            // With a right checksum as well: an error, or reaches that say no less than the table.
            let end = forged.len() - 4;
            let crc = crc32fast::hash(&forged[..end]).to_le_bytes();
            forged[end..].copy_from_slice(&crc);
            if let Ok(other) = Reaches::from_bytes(&forged, &table) {
                assert!(ids(6).all(|i| ids(6).all(|j| (other.rung(i, j) == 0) == table.sees(i, j))));
            }
        }
        assert!(Reaches::from_bytes(&bytes[..at], &table).is_err());
    }
    let other = Grid { size: [3, 2, 1], seed: 3, blind: 5 }.table();
    assert_eq!(Reaches::from_bytes(&bytes, &other), Err(ReachFileError::OtherTable));
}

#[test]
fn what_means_nothing_is_refused() {
    let table = Grid { size: [2, 1, 1], seed: 2, blind: 5 }.table();
    let of =
        |reaches: &[f64]| Reaches::of(&table, &ReachOptions { ladder: reaches.to_vec(), ..ReachOptions::default() });
    for reaches in [&[f64::NAN][..], &[-1.0], &[0.0, 0.0], &[2.0, 1.0], &[f64::INFINITY]] {
        assert!(matches!(of(reaches), Err(ReachError::Reaches { .. })), "{reaches:?}");
    }
    assert_eq!(
        of(&[1.0; 20]
            .iter()
            .scan(0.0, |s, x| {
                *s += x;
                Some(*s)
            })
            .collect::<Vec<f64>>()),
        Err(ReachError::TooMany { n: 20 })
    );
    assert_eq!(of(&[0.0, 1.0]).expect("reaches").ladder(), [0.0, 1.0]);
    assert_eq!(of(&[]).expect("reaches").ladder().len(), 8);
}
