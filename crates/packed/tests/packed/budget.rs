//! Smaller tables show more and hide nothing that was visible.

use crate::common::{recipes, table};
use proptest::prelude::*;
use sightlines_packed::{PackError, PackOptions, Packed, SizeClass, pack, pack_report};
use sightlines_pvs::{CellId, Table};

/// Pairs of `table` that `other` hides, and pairs that it adds, of cells with cells and with objects.
fn differences(table: &Table, other: &Table) -> (usize, usize) {
    let mut found = (0, 0);
    for cell in (0..table.n_cells() as u32).map(CellId) {
        for b in (0..table.n_cells() as u32).map(CellId) {
            found.0 += usize::from(table.sees(cell, b) && !other.sees(cell, b));
            found.1 += usize::from(!table.sees(cell, b) && other.sees(cell, b));
        }
        let (ours, theirs) = (table.visible_objects(cell), other.visible_objects(cell));
        found.0 += ours.iter().filter(|o| theirs.binary_search(o).is_err()).count();
        found.1 += theirs.iter().filter(|o| ours.binary_search(o).is_err()).count();
    }
    found
}

fn merged_pairs(
    recipe: crate::common::Recipe,
    share: u64,
    class: Option<SizeClass>,
) -> Result<(usize, usize), TestCaseError> {
    let table = table(recipe);
    let (exact, report) = pack_report(&table, &PackOptions { max_bytes: None, class }).unwrap();
    let budget = report.bytes - report.row_bytes * share / 100;
    match pack_report(&table, &PackOptions { max_bytes: Some(budget), class }) {
        Ok((bytes, merged)) => {
            prop_assert!(bytes.len() as u64 <= budget && merged.bytes == bytes.len() as u64);
            let packed = Packed::open(bytes, 1 << 20).unwrap();
            packed.verify().unwrap();
            let other = packed.to_table().unwrap();
            let (hidden, added) = differences(&table, &other);
            prop_assert_eq!(hidden, 0);
            prop_assert!((merged.n_merges > 0) == (budget < exact.len() as u64));
            // Everything else is unchanged.
            let mut parts = other.into_parts();
            parts.rows = table.parts().rows.clone();
            parts.objects_seen = table.parts().objects_seen.clone();
            prop_assert_eq!(&parts, table.parts());
            Ok((merged.n_merges, added))
        }
        Err(PackError::Budget { budget: reported, smallest }) => {
            prop_assert!(reported == budget && smallest > budget);
            Ok((0, 0))
        }
        Err(error) => Err(TestCaseError::fail(error.to_string())),
    }
}

proptest! {
    #[test]
    fn a_budget_is_kept_and_nothing_is_hidden(recipe in recipes(), share in 0u64..40) {
        merged_pairs(recipe, share, None)?;
        merged_pairs(recipe, share, Some(SizeClass::Large))?;
    }
}

/// The tightness twin: a slightly smaller budget costs little, and a sufficient one nothing.
#[test]
fn little_is_added_for_little() {
    // With blocks of five cells, only merges with a cost are left.
    let mut added = Vec::new();
    for share in [0, 2, 6, 12, 25] {
        added.push(merged_pairs((2, 13, 7, 3, 0b0100), share, None).unwrap());
    }
    assert_eq!(added[0], (0, 0));
    assert!(added.iter().any(|(n_merges, added)| *n_merges > 0 && *added > 0), "{added:?}");
    assert!(added.is_sorted_by_key(|(n_merges, _)| *n_merges), "{added:?}");
}

#[test]
fn a_budget_that_cannot_be_kept_says_what_can() {
    let table = table((3, 5, 4, 11, 0xFF));
    let error = pack(&table, &PackOptions { max_bytes: Some(10), class: None }).unwrap_err();
    let PackError::Budget { budget: 10, smallest } = error else { panic!("{error}") };
    let bytes = pack(&table, &PackOptions { max_bytes: Some(smallest), class: None }).unwrap();
    assert_eq!(bytes.len() as u64, smallest);
    assert!(error.to_string().starts_with("a budget of 10 bytes cannot be kept"));
}

/// The impostor: a table that lacks a pair is detected by the comparison in the property.
#[test]
fn impostor_a_hidden_pair_is_counted() {
    let table = table((2, 6, 5, 7, 0xFF));
    let mut parts = table.clone().into_parts();
    let (a, b) = (0..30).flat_map(|a| (0..a).map(move |b| (a, b))).find(|&(a, b)| parts.rows.get(a, b)).unwrap();
    parts.rows.set(a, b, false);
    parts.rows.set(b, a, false);
    let less = Table::new(parts).unwrap();
    assert_eq!((differences(&table, &less), differences(&less, &table)), ((2, 0), (0, 2)));
}
