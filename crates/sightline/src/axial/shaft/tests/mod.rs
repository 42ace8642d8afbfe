//! Boxes among rectangles against every combination of ways past them.

mod certificates;
mod oracle;

use super::{Blockers, Shaft, Verdict};
use oracle::{Case, any_case, any_place, nudged};
use proptest::prelude::*;
use sightlines_testkit::draw;
use std::cell::Cell;

/// Linear programs allowed for each question.
const BUDGET: u32 = 2000;

/// How questions were answered.
#[derive(Debug, Default)]
struct Counts {
    open: Cell<u64>,
    blocked: Cell<u64>,
    undecided: Cell<u64>,
}

impl Counts {
    fn add(&self, kind: Kind) {
        let count = match kind {
            Kind::Open => &self.open,
            Kind::Blocked => &self.blocked,
            Kind::Undecided => &self.undecided,
        };
        count.set(count.get() + 1);
    }

    fn total(&self) -> u64 {
        self.open.get() + self.blocked.get() + self.undecided.get()
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Open,
    Blocked,
    Undecided,
}

/// Compares an answer about `given` with the truth about `case`.
fn compare(case: &Case, given: &Case) -> Result<Kind, String> {
    let blockers = Blockers::new(given.rectangles.iter().copied());
    assert_eq!(blockers.rectangles(), given.rectangles, "all of them are rectangles");
    match Shaft::new(&blockers).decide(&given.from, &given.to, given.target, BUDGET) {
        Verdict::Visible(line) if !case.is_open() => Err(format!("{line:?} where nothing leads")),
        Verdict::Visible(line) if !case.is_free(&line) => Err(format!("{line:?} is not free")),
        Verdict::Visible(_) => Ok(Kind::Open),
        Verdict::Hidden(()) if case.is_open() => Err("blocked, where lines lead".to_owned()),
        Verdict::Hidden(()) => Ok(Kind::Blocked),
        Verdict::Undecided(_) => Ok(Kind::Undecided),
    }
}

proptest! {
    /// Invariant: an answer is that of all combinations of ways, and a line given is free.
    #[test]
    fn boxes_see_each_other_as_combinations_say(case in any_case()) {
        if let Err(error) = compare(&case, &case) {
            prop_assert!(false, "{}: {:?}", error, case);
        }
    }

    /// Invariant: no answer is wrong far from the origin, in a mirror, and with gaps of one unit in the last
    /// place; it may be missing there.
    #[test]
    fn rounding_makes_no_answer_wrong((case, (factor, by)) in (any_case(), any_place()), nudges in any::<[i8; 4]>()) {
        let case = nudged(case.placed(factor, by), &nudges);
        if let Err(error) = compare(&case, &case) {
            prop_assert!(false, "{}: {:?}", error, case);
        }
    }
}

/// Both answers are frequent and undecided cases are rare, on the grid and where rounding has moved what was aligned.
#[test]
fn questions_are_answered() {
    let (plain, moved, thin) = (Counts::default(), Counts::default(), Counts::default());
    let drawn = draw(&(any_case(), any_place(), any::<[i8; 4]>()), 200);
    for (case, (factor, by), nudges) in drawn {
        let placed = case.placed(factor, by);
        let nudged = nudged(case.clone(), &nudges);
        for (case, counts) in [(&case, &plain), (&placed, &moved), (&nudged, &thin)] {
            counts.add(compare(case, case).unwrap_or_else(|error| panic!("{error}: {case:?}")));
        }
    }
    for (name, counts, allowed) in [("grid", &plain, 0), ("moved", &moved, 2), ("thin", &thin, 10)] {
        eprintln!("{name}: {counts:?}");
        assert!(counts.open.get() > 50 && counts.blocked.get() > 50, "{name}: {counts:?}");
        assert!(100 * counts.undecided.get() <= allowed * counts.total(), "{name}: {counts:?}");
    }
}

/// Comparisons that have to fail: one rectangle is forgotten.
#[test]
fn a_forgotten_rectangle_is_noticed() {
    let (mut n_changed, mut n_lines) = (0, 0);
    for case in draw(&any_case(), 100) {
        let open = case.is_open();
        for forgotten in 0..case.rectangles.len() {
            let given = case.without(forgotten);
            let noticed = compare(&case, &given).is_err();
            if noticed && open {
                // The line given is one that the rectangle blocks.
                n_lines += 1;
            } else if !open && given.is_open() {
                n_changed += 1;
                assert!(noticed, "{forgotten} of {case:?}");
            }
        }
    }
    assert!(n_changed > 20 && n_lines > 5, "{n_changed} {n_lines}");
}
