//! The check that the unit tests of all these sweeps make of a few of their cases.

use crate::stability::{Kind, Sweep};
use std::collections::BTreeMap;

/// Asks the first `batches` of each level: no shipped method hides wrongly or fails, each naive one hides wrongly somewhere. The number
/// of answers.
pub(crate) fn check(sweeps: Vec<Sweep>, batches: usize) -> u64 {
    let mut n_answers = 0;
    let mut naive: BTreeMap<String, u64> = BTreeMap::new();
    for mut sweep in sweeps {
        sweep.batches = sweep.batches.min(batches);
        let (rows, findings) = sweep.measure();
        for row in rows {
            assert!(row.cases > 0, "{} asks nothing at {}", row.sweep, row.parameter);
            n_answers += row.cases;
            if row.kind == Kind::Naive {
                *naive.entry(row.method).or_default() += row.n_unsafe;
            } else {
                let own = || findings.iter().find(|f| f.method == row.method && f.level == row.parameter);
                assert_eq!([row.n_unsafe, row.errors], [0, 0], "{:?}", own());
            }
        }
    }
    for (method, n_unsafe) in naive {
        assert!(n_unsafe > 0, "{method} was never wrong");
    }
    n_answers
}
