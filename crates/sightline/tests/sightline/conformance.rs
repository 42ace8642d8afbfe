//! The conformance suite: the stabbers of this crate keep the contract, and impostors are refused.

use sightlines_geometry::{Aabb, Adaptive, Portal3};
use sightlines_sightline::conformance::impostors::{Fault, Impostor};
use sightlines_sightline::conformance::{
    Axial, Cases, Clause, Convex, Effort, Planar, Report, Violation, axial, convex, planar, run,
};
use sightlines_sightline::{AxialStabber, ConvexSequence, Funnel, StabLimits, Stabber};
use std::sync::Arc;

fn has_looked(report: Report, effort: &Effort) {
    let rounds = u64::from(effort.rounds);
    assert_eq!(report.sequences, rounds);
    assert!(report.open > rounds && report.blocked > rounds / 4 && report.boxes > rounds / 2, "{report:?}");
    assert!(report.lines > rounds && report.proofs > rounds / 4 && report.undone > rounds, "{report:?}");
    assert!(report.unknown * 100 <= report.open, "{report:?}");
}

const CONVEX: Effort = Effort { seed: 3, rounds: 120, tight: 0.95 };

fn polygons() -> ConvexSequence<Arc<Portal3>> {
    ConvexSequence::new(StabLimits::default())
}

#[test]
fn all_stabbers_conform() {
    let effort = Effort::quick();
    has_looked(planar(&Funnel::new(Adaptive), &effort).expect("the funnel conforms"), &effort);
    has_looked(axial(&AxialStabber::new(), &effort).expect("the axial stabber conforms"), &effort);
    has_looked(convex(&polygons(), &CONVEX).expect("the convex stabber conforms"), &CONVEX);
}

#[test]
fn a_limited_stabber_that_decides_all_passes_as_an_exact_one() {
    let few = Effort { seed: 9, rounds: 60, tight: 1.0 };
    has_looked(convex(&polygons(), &few).expect("nothing of the sort is undecided"), &few);
}

fn refused<S, C>(stabber: &S, cases: &C, effort: &Effort)
where
    S: Stabber<Portal = C::Portal, Bounds = Aabb<3>>,
    S::Portal: Send,
    C: Cases<Bounds = Aabb<3>>,
{
    for fault in Fault::ALL {
        refuse(&run(&Impostor::new(stabber.clone(), fault), stabber, cases, effort), fault);
    }
}

fn refuse(found: &Result<Report, Violation>, fault: Fault) {
    match found {
        Ok(report) => panic!("{fault:?} goes unnoticed: {report:?}"),
        Err(violation) => assert_eq!(violation.clause(), fault.clause(), "{fault:?}: {violation}"),
    }
}

#[test]
fn impostors_are_refused() {
    let effort = Effort::quick();
    for fault in Fault::ALL {
        let funnel = Funnel::new(Adaptive);
        refuse(&run(&Impostor::new(funnel.clone(), fault), &funnel, &Planar, &effort), fault);
    }
    refused(&AxialStabber::new(), &Axial, &effort);
    refused(&polygons(), &Convex, &Effort { tight: 1.0, ..CONVEX });
}

#[test]
fn a_suite_that_compares_nothing_says_so() {
    let none = Effort { rounds: 0, ..Effort::quick() };
    let violation = planar(&Funnel::new(Adaptive), &none).expect_err("nothing ran");
    assert_eq!(
        (violation.clause(), violation.to_string().as_str()),
        (Clause::Counted, "the suite proves nothing: no sequences")
    );
}
