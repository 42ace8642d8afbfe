//! View shafts and voxels keep the contract of from-region methods, and impostors are refused.

use sightlines_cells::{Scene, SceneObject};
use sightlines_from_region::{ViewShafts, VoxelOptions, Voxels};
use sightlines_multifocal::conformance::from_region::impostors::{Fault, Impostor};
use sightlines_multifocal::conformance::from_region::{Clause, Effort, RegionScene, run};
use sightlines_multifocal::{FromRegion, Occluder};

fn shafts(scene: &RegionScene) -> Box<dyn FromRegion> {
    let patch = |face: [[f64; 3]; 4]| {
        let [a, b, c, d] = face;
        Occluder::patch(face.to_vec(), &[[a, b, c], [a, c, d]]).expect("sides of boxes have an area")
    };
    Box::new(ViewShafts::new(scene.faces().into_iter().map(patch).collect()))
}

fn voxels(scene: &RegionScene) -> Box<dyn FromRegion> {
    let object = |(k, triangles): (usize, &[[[f64; 3]; 3]])| SceneObject {
        name: format!("box {k}"),
        vertices: triangles.iter().flatten().copied().collect(),
        triangles: (0..triangles.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
    };
    let scene = Scene::new(scene.triangles().chunks(12).enumerate().map(object).collect()).expect("boxes are a scene");
    let options = VoxelOptions { n_longest: 48, ..VoxelOptions::default() };
    Box::new(Voxels::new(&scene, options).expect("few voxels"))
}

#[test]
fn view_shafts_conform() {
    let report = run(&mut shafts, &Effort::quick()).expect("shafts conform");
    assert_eq!((report.scenes, report.found, report.walled), (60, 240, 240));
    assert!(report.visible > 100 && report.hidden > 240 && report.near > 200, "{report:?}");
}

#[test]
fn voxels_conform() {
    // They are coarse: nothing is promised of how much they find.
    let few = Effort { rounds: 24, tight: 0.0, ..Effort::quick() };
    let report = run(&mut voxels, &few).expect("voxels conform");
    assert!(report.visible > 40 && report.hidden > 0, "{report:?}");
}

#[test]
fn impostors_are_refused() {
    for fault in Fault::ALL {
        let mut make = |scene: &RegionScene| -> Box<dyn FromRegion> {
            Box::new(Impostor::new(shafts(scene), scene.clone(), fault))
        };
        match run(&mut make, &Effort::quick()) {
            Ok(report) => panic!("{fault:?} goes unnoticed: {report:?}"),
            Err(violation) => assert!(fault.clauses().contains(&violation.clause()), "{fault:?}: {violation}"),
        }
    }
}

#[test]
fn a_suite_that_compares_nothing_says_so() {
    let none = Effort { rounds: 0, ..Effort::quick() };
    assert_eq!(run(&mut shafts, &none).expect_err("nothing ran").clause(), Clause::Counted);
}
