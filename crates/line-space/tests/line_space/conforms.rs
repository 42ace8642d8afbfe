//! The method keeps the contract of from-region methods, and impostors of it are refused.

use sightlines_line_space::LineSpace;
use sightlines_multifocal::FromRegion;
use sightlines_multifocal::conformance::from_region::impostors::{Fault, Impostor};
use sightlines_multifocal::conformance::from_region::{Effort, RegionScene, run};

fn lines(scene: &RegionScene) -> Box<dyn FromRegion> {
    Box::new(LineSpace::new(&scene.triangles()))
}

#[test]
fn line_space_conforms() {
    let report = run(&mut lines, &Effort::quick()).expect("line space conforms");
    assert_eq!((report.scenes, report.found, report.walled), (60, 240, 240));
    assert!(report.visible > 100 && report.hidden > 240 && report.near > 200, "{report:?}");
}

#[test]
fn impostors_are_refused() {
    for fault in Fault::ALL {
        let mut make = |scene: &RegionScene| -> Box<dyn FromRegion> {
            Box::new(Impostor::new(lines(scene), scene.clone(), fault))
        };
        match run(&mut make, &Effort::quick()) {
            Ok(report) => panic!("{fault:?} goes unnoticed: {report:?}"),
            Err(violation) => assert!(fault.clauses().contains(&violation.clause()), "{fault:?}: {violation}"),
        }
    }
}
