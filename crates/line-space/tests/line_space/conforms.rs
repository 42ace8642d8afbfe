//! The method keeps the contract of from-region methods, and impostors of it are refused.

use sightlines_line_space::LineSpace;
use sightlines_multifocal::FromRegion;
use sightlines_testkit::conformance::from_regions::wrong;
use sightlines_testkit::conformance::{FromRegions, RegionScene, Suite};

fn lines(scene: &RegionScene) -> Box<dyn FromRegion> {
    Box::new(LineSpace::new(&scene.triangles()))
}

#[test]
fn line_space_conforms() {
    let report = FromRegions::quick().run(&mut lines).expect("line space conforms");
    let [walled, found] = ["targets behind a wall", "hidden targets behind a wall"].map(|what| report[what]);
    assert_eq!((report["scenes"], found, walled), (60, 240, 240));
    assert!(report["visible targets"] > 100 && report["hidden targets"] > 240, "{report:?}");
    assert!(report["targets near the volume"] > 200, "{report:?}");
}

#[test]
fn impostors_are_refused() {
    FromRegions::quick().refuse_all(|fault| wrong(lines, fault));
}
