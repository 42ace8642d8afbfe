//! View shafts and voxels keep the contract of from-region methods, and impostors are refused.

use sightlines_cells::{Scene, SceneObject};
use sightlines_from_region::{ViewShafts, VoxelOptions, Voxels};
use sightlines_multifocal::{FromRegion, Occluder};
use sightlines_testkit::conformance::from_regions::wrong;
use sightlines_testkit::conformance::{Clause, FromRegions, RegionScene, Suite};

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
    let report = FromRegions::quick().run(&mut shafts).expect("shafts conform");
    let [walled, found] = ["targets behind a wall", "hidden targets behind a wall"].map(|what| report[what]);
    assert_eq!((report["scenes"], found, walled), (60, 240, 240));
    assert!(report["visible targets"] > 100 && report["hidden targets"] > 240, "{report:?}");
    assert!(report["targets near the volume"] > 200, "{report:?}");
}

#[test]
fn voxels_conform() {
    // They are coarse: nothing is promised of how much they find.
    let few = FromRegions { rounds: 24, tight: 0.0, ..FromRegions::quick() };
    let report = few.run(&mut voxels).expect("voxels conform");
    assert!(report["visible targets"] > 40 && report["hidden targets"] > 0, "{report:?}");
}

#[test]
fn impostors_are_refused() {
    FromRegions::quick().refuse_all(|fault| wrong(shafts, fault));
}

#[test]
fn a_suite_that_compares_nothing_says_so() {
    let none = FromRegions { rounds: 0, ..FromRegions::quick() };
    assert_eq!(none.run(&mut shafts).expect_err("nothing ran").clause, Clause::Counted);
}
