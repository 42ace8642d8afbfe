//! The memory budget holds, affects no answer, and threads do not interfere.

use crate::common::{recipes, table};
use crate::round_trip::compare;
use proptest::prelude::*;
use sightlines_packed::{PackOptions, Packed, pack};
use sightlines_pvs::{CellId, PlaceBuffer};
use std::sync::atomic::{AtomicUsize, Ordering};

proptest! {
    #[test]
    fn no_budget_changes_an_answer(recipe in recipes(), budget in prop::sample::select(vec![0usize, 100, 500, 2000, 1 << 20])) {
        let table = table(recipe);
        let packed = Packed::open(pack(&table, &PackOptions::default()).unwrap(), budget).unwrap();
        compare(&packed, &table);
        prop_assert!(packed.bytes_in_use() <= budget);
        let stats = packed.stats();
        prop_assert!(budget > 0 || stats.hits == 0);
        prop_assert!(stats.misses == 0 || stats.bytes_read > packed.resident_bytes() as u64);
        compare(&packed, &table);
        // With room for everything, nothing is read twice; the twin: without any, everything is.
        let again = packed.stats();
        prop_assert!(budget < 1 << 20 || again.misses == stats.misses);
        prop_assert!(budget > 0 || again.misses == 2 * stats.misses);
    }
}

#[test]
fn a_file_that_the_host_opened_answers_the_same() {
    let table = table((2, 13, 7, 3, 0xFF));
    let mut file = tempfile::tempfile().unwrap();
    std::io::Write::write_all(&mut file, &pack(&table, &PackOptions::default()).unwrap()).unwrap();
    let packed = Packed::open(file, 1 << 12).unwrap();
    packed.verify().unwrap();
    assert_eq!(packed.to_table().unwrap(), table);
}

/// A file that is truncated while it is open gives errors, and its resident part still answers.
#[test]
fn a_file_that_is_cut_while_open_gives_errors() {
    let table = table((2, 13, 7, 3, 0xFF));
    let mut file = tempfile::tempfile().unwrap();
    std::io::Write::write_all(&mut file, &pack(&table, &PackOptions::default()).unwrap()).unwrap();
    let packed = Packed::open(file.try_clone().unwrap(), 0).unwrap();
    file.set_len(100).unwrap();
    let mut cells = Vec::new();
    assert!(packed.visible(CellId(0), &mut cells).unwrap_err().to_string().contains("section ROWS: cannot read"));
    let mut buffer = PlaceBuffer::new();
    let at = packed.in_dimension().unwrap().cells_at([0.5, 0.5], &mut buffer).unwrap().inside().unwrap();
    packed.coarse(at[0], &mut cells).unwrap();
    assert_eq!(at, table.in_dimension().unwrap().at([0.5, 0.5]).cells());
}

#[test]
fn threads_that_share_a_small_cache_get_the_same_answers() {
    let table = table((3, 13, 7, 8, 0xFF));
    for budget in [0, 3000, 1 << 20] {
        let packed = Packed::open(pack(&table, &PackOptions::default()).unwrap(), budget).unwrap();
        let n = AtomicUsize::new(0);
        std::thread::scope(|scope| {
            for _ in 0..4 {
                scope.spawn(|| n.fetch_add(compare(&packed, &table), Ordering::Relaxed));
            }
        });
        assert!(n.into_inner() > 4000 && packed.bytes_in_use() <= budget);
        let stats = packed.stats();
        assert!(stats.hits + stats.misses > 0 && (budget == 0 || stats.hits > 0), "{stats:?}");
    }
}
