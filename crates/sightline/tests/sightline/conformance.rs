//! The stabbers of this crate keep the contract, and impostors are refused.

use sightlines_geometry::{Adaptive, Portal3};
use sightlines_sightline::{AxialStabber, ConvexSequence, Funnel, StabLimits};
use sightlines_testkit::conformance::stabbers::Convex;
use sightlines_testkit::conformance::{Clause, Impostor, Report, Stabbers, Suite};
use std::sync::Arc;

fn has_looked(report: &Report, rounds: usize) {
    let open = report["open sequences"];
    assert_eq!(report["sequences"], rounds);
    assert!(open > rounds && report["blocked sequences"] > rounds / 4, "{report:?}");
    assert!(report["boxes that a line meets"] > rounds / 2 && report["lines"] > rounds, "{report:?}");
    assert!(report["proofs"] > rounds / 4 && report["answers after undoing"] > rounds, "{report:?}");
    assert!(report["sequences without evidence"] * 100 <= open, "{report:?}");
}

type Polygons = ConvexSequence<Arc<Portal3>>;

fn polygons() -> Polygons {
    ConvexSequence::new(StabLimits::default())
}

fn convex(tight: f64) -> Stabbers<Polygons, Convex> {
    Stabbers { seed: 3, rounds: 120, tight, ..Stabbers::convex() }
}

#[test]
fn all_stabbers_conform() {
    has_looked(&Stabbers::planar().run(&mut Funnel::new(Adaptive)).expect("the funnel conforms"), 300);
    has_looked(&Stabbers::axial().run(&mut AxialStabber::new()).expect("the axial stabber conforms"), 300);
    has_looked(&convex(0.95).run(&mut polygons()).expect("the convex stabber conforms"), 120);
}

#[test]
fn a_limited_stabber_that_decides_all_passes_as_an_exact_one() {
    let few = Stabbers { seed: 9, rounds: 60, ..Stabbers::convex() };
    has_looked(&few.run(&mut polygons()).expect("nothing of the sort is undecided"), 60);
}

#[test]
fn impostors_are_refused() {
    Stabbers::planar().refuse_all(|fault| Impostor::new(Funnel::new(Adaptive), fault));
    Stabbers::axial().refuse_all(|fault| Impostor::new(AxialStabber::new(), fault));
    convex(1.0).refuse_all(|fault| Impostor::new(polygons(), fault));
}

#[test]
fn a_suite_that_compares_nothing_says_so() {
    let none = Stabbers { rounds: 0, ..Stabbers::planar() };
    let violation = none.run(&mut Funnel::new(Adaptive)).expect_err("nothing ran");
    assert_eq!(violation.clause, Clause::Counted);
    assert_eq!(violation.to_string(), "stabber, Counted: all cases: expected some sequences, found none");
}
