//! The stabbers of this crate, which are the references of the suites, keep the contract, and impostors are refused.

use sightlines_sightline::Stabber;
use sightlines_testkit::conformance::{Clause, Impostor, Stabbers, Suite};

fn conforms<R: Stabber>(suite: &Stabbers<R>) {
    let report = suite.run(&mut suite.reference.clone()).unwrap_or_else(|v| panic!("{v}"));
    let (rounds, open) = (suite.rounds as usize, report["open sequences"]);
    assert_eq!(report["sequences"], rounds);
    assert!(open > rounds && report["blocked sequences"] > rounds / 4, "{report:?}");
    assert!(report["boxes that a line meets"] > rounds / 2 && report["lines"] > rounds, "{report:?}");
    assert!(report["proofs"] > rounds / 4 && report["answers after undoing"] > rounds, "{report:?}");
    assert!(report["sequences without evidence"] * 100 <= open, "{report:?}");
}

fn refuses<R: Stabber<Portal: Send>>(suite: &Stabbers<R>) {
    suite.refuse_all(|fault| Impostor::new(suite.reference.clone(), fault));
}

#[test]
fn all_stabbers_conform() {
    conforms(&Stabbers::planar());
    conforms(&Stabbers::axial());
    conforms(&Stabbers { seed: 3, rounds: 120, tight: 0.95, ..Stabbers::convex() });
}

#[test]
fn a_limited_stabber_that_decides_all_passes_as_an_exact_one() {
    conforms(&Stabbers { seed: 9, rounds: 60, ..Stabbers::convex() });
}

#[test]
fn impostors_are_refused() {
    refuses(&Stabbers::planar());
    refuses(&Stabbers::axial());
    refuses(&Stabbers { seed: 3, rounds: 120, ..Stabbers::convex() });
}

#[test]
fn a_suite_that_compares_nothing_says_so() {
    let none = Stabbers { rounds: 0, ..Stabbers::planar() };
    let violation = none.run(&mut none.reference.clone()).expect_err("nothing ran");
    assert_eq!(violation.clause, Clause::Counted);
    assert_eq!(violation.to_string(), "stabber, Counted: all cases: expected some sequences, found none");
}
