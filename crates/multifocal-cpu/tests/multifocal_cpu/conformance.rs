//! The contract of backends: the reference keeps it, and worse impostors do not.

use sightlines_multifocal::conformance::impostors::{Fault, Impostor};
use sightlines_multifocal::conformance::{Clause, Effort, Slack, Violation, run};
use sightlines_multifocal_cpu::{Fast, Reference};

#[test]
fn reference_keeps_the_contract_without_slack() {
    let report = run(&mut Reference, &mut Reference, &Effort::quick(Slack::EXACT)).unwrap_or_else(|v| panic!("{v}"));
    println!("{report:?}");
    assert!(report.blocked > 1000 && report.tight > 1000 && report.valued > 1000 && report.fused > 100, "{report:?}");
    assert_eq!((report.found, report.section_kept, report.unsupported), (report.blocked, report.section, 0));
}

#[test]
fn reference_keeps_the_contract_of_the_integer_form() {
    let effort = Effort { seed: 2, rounds: 2, ..Effort::quick(Slack::INTEGER) };
    let report = run(&mut Reference, &mut Reference, &effort).unwrap_or_else(|v| panic!("{v}"));
    assert!(report.tight > 100 && report.valued > 20, "{report:?}");
    assert!(report.valued < report.tight, "not all are compared with the reference's values: {report:?}");
}

#[test]
fn impostors_are_refused_for_their_faults() {
    for fault in Fault::ALL {
        let violation = run(&mut Impostor::new(Reference, fault), &mut Reference, &Effort::quick(Slack::EXACT));
        let violation = violation.expect_err(&format!("{fault:?} passes"));
        println!("{fault:?}: {violation}");
        assert_eq!(violation.clause(), fault.clause(), "{fault:?}: {violation}");
    }
}

#[test]
fn impostors_are_refused_with_the_slack_of_the_integer_form() {
    for fault in Fault::ALL {
        let violation = run(&mut Impostor::new(Reference, fault), &mut Reference, &Effort::quick(Slack::INTEGER));
        let violation = violation.expect_err(&format!("{fault:?} passes"));
        assert_eq!(violation.clause(), fault.clause(), "{fault:?}: {violation}");
    }
}

#[test]
fn impostor_a_suite_that_looks_at_nothing_is_an_error() {
    let effort = Effort { rounds: 0, ..Effort::quick(Slack::EXACT) };
    let violation = run(&mut Reference, &mut Reference, &effort).expect_err("no scenes were looked at");
    assert_eq!(violation, Violation::NothingRan { what: "scenes" });
    assert_eq!(violation.clause(), Clause::Counted);
    assert_eq!(violation.to_string(), "the suite proves nothing: no scenes");
}

#[test]
fn fast_keeps_the_contract_of_the_integer_form() {
    let report =
        run(&mut Fast::new(), &mut Reference, &Effort::quick(Slack::INTEGER)).unwrap_or_else(|v| panic!("{v}"));
    println!("{report:?}");
    assert!(report.tight > 1000 && report.found * 100 > report.blocked * 95, "{report:?}");
}

#[test]
fn fast_impostors_are_refused_for_their_faults() {
    // A value of the integer form lies below the exact one as a rule, so one unit more is still sound.
    for fault in Fault::ALL.into_iter().filter(|&fault| fault != Fault::OneUnitNearer) {
        let violation = run(&mut Impostor::new(Fast::new(), fault), &mut Reference, &Effort::quick(Slack::INTEGER));
        let violation = violation.expect_err(&format!("{fault:?} passes"));
        assert_eq!(violation.clause(), fault.clause(), "{fault:?}: {violation}");
    }
}
