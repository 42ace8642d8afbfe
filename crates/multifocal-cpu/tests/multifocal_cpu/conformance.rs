//! The contract of backends: the reference keeps it, and worse impostors do not.

use sightlines_multifocal_cpu::{Fast, Reference};
use sightlines_testkit::conformance::{BackendFault, Backends, Clause, Fault, Impostor, Slack, Suite};

const EXACT: Backends<Reference> = Backends::quick(Reference, Slack::EXACT);
const INTEGER: Backends<Reference> = Backends::quick(Reference, Slack::INTEGER);

#[test]
fn reference_keeps_the_contract_without_slack() {
    let report = EXACT.run(&mut Reference).unwrap_or_else(|v| panic!("{v}"));
    println!("{report:?}");
    assert!(report["blocked texels"] > 1000 && report["texels that one occluder blocks"] > 1000, "{report:?}");
    assert!(report["texels with values to compare"] > 1000, "{report:?}");
    assert!(report["texels that only a plane before blocks"] > 100, "{report:?}");
    assert_eq!(report["blocked texels found"], report["blocked texels"]);
    assert_eq!(report["units above lowest corners found"], report["units above lowest corners"]);
    assert_eq!(report["measures not supported"], 0);
}

#[test]
fn reference_keeps_the_contract_of_the_integer_form() {
    let report = Backends { seed: 2, rounds: 2, ..INTEGER }.run(&mut Reference).unwrap_or_else(|v| panic!("{v}"));
    let [tight, valued] = ["texels that one occluder blocks", "texels with values to compare"].map(|what| report[what]);
    assert!(tight > 100 && valued > 20, "{report:?}");
    assert!(valued < tight, "not all are compared with the reference's values: {report:?}");
}

#[test]
fn impostors_are_refused_for_their_faults() {
    EXACT.refuse_all(|fault| Impostor::new(Reference, fault));
}

#[test]
fn impostors_are_refused_with_the_slack_of_the_integer_form() {
    INTEGER.refuse_all(|fault| Impostor::new(Reference, fault));
}

#[test]
fn impostor_a_suite_that_looks_at_nothing_is_an_error() {
    let violation = Backends { rounds: 0, ..EXACT }.run(&mut Reference).expect_err("no scenes were looked at");
    assert_eq!(violation.clause, Clause::Counted);
    assert_eq!(violation.to_string(), "multifocal backend, Counted: all cases: expected some scenes, found none");
}

#[test]
fn fast_keeps_the_contract_of_the_integer_form() {
    let report = INTEGER.run(&mut Fast::new()).unwrap_or_else(|v| panic!("{v}"));
    println!("{report:?}");
    assert!(report["texels that one occluder blocks"] > 1000, "{report:?}");
    assert!(report["blocked texels found"] * 100 > report["blocked texels"] * 95, "{report:?}");
}

#[test]
fn fast_impostors_are_refused_for_their_faults() {
    // A value of the integer form lies below the exact one as a rule, so one unit more is still sound.
    for &fault in BackendFault::ALL.iter().filter(|&&fault| fault != BackendFault::OneUnitNearer) {
        INTEGER.refuse(fault, &mut Impostor::new(Fast::new(), fault));
    }
}
