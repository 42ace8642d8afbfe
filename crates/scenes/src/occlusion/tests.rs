//! The benchmark's rectangles and boxes. The hidden share is measured with rays in the tests of `testkit`.

use super::*;
use sightlines_geometry::orient3d;

const SOME: OcclusionOptions = OcclusionOptions { seed: 5, occluders: 300, occludees: 300, tilt: 60 };

/// The slope of a rectangle along each side.
fn slopes([a, b, c, _]: [Point3; 4]) -> [f64; 2] {
    [(c[2] - b[2]) / (c[0] - b[0]), (b[2] - a[2]) / (b[1] - a[1])]
}

#[test]
fn occlusion_rectangles_are_flat_face_the_volume_and_are_no_steeper_than_asked() {
    for tilt in [0, 30, 60, 100] {
        let made = occlusion(OcclusionOptions { tilt, ..SOME }).unwrap();
        assert_eq!((made.rectangles().len(), made.scene.n_triangles()), (300, 600));
        let mut steepest: f64 = 0.0;
        for r in made.rectangles() {
            let [a, b, c, d] = r;
            assert_eq!(orient3d(a, b, c, d), 0.0);
            let volume = Occlusion::volume(0.5);
            assert!(r.iter().all(|p| p[2] > volume.max[2] && p[2] < Occlusion::FAR));
            // Counter-clockwise as seen from the origin.
            let normal_z = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
            assert!(normal_z < 0.0);
            steepest = slopes(r).iter().fold(steepest, |m, s| m.max(s.abs()));
        }
        let most = f64::from(tilt) / 100.0;
        assert!(steepest <= most && steepest >= 0.8 * most, "{steepest}");
    }
}

#[test]
fn occlusion_boxes_are_in_their_range() {
    let made = occlusion(SOME).unwrap();
    assert_eq!(made.occludees.len(), 300);
    for b in &made.occludees {
        assert!((0..3).all(|k| b.min[k] < b.max[k] && b.max[k] - b.min[k] <= 1.0));
        let middle = 0.5 * (b.min[2] + b.max[2]);
        assert!((5.0..=18.0).contains(&middle) && b.max[2] < Occlusion::FAR);
    }
}

#[test]
fn occlusion_tilt_changes_the_slopes_alone() {
    let [flat, steep] = [0, 60].map(|tilt| occlusion(OcclusionOptions { tilt, ..SOME }).unwrap());
    assert_eq!(steep, occlusion(SOME).unwrap());
    assert_ne!(occlusion(OcclusionOptions { seed: 6, ..SOME }).unwrap().occludees, steep.occludees);
    assert_eq!(flat.occludees, steep.occludees);
    let across = |o: &Occlusion| -> Vec<[f64; 2]> { o.rectangles().flatten().map(|p| [p[0], p[1]]).collect() };
    assert_eq!(across(&flat), across(&steep));
    assert_ne!(flat.scene, steep.scene);
}

#[test]
fn occlusion_options_are_checked() {
    let error = |options: OcclusionOptions| occlusion(options).unwrap_err().to_string();
    assert_eq!(error(OcclusionOptions { occluders: 0, ..SOME }), "occluders is 0, but must be from 1 to 65536");
    assert_eq!(error(OcclusionOptions { occludees: 0, ..SOME }), "occludees is 0, but must be from 1 to 65536");
    assert_eq!(error(OcclusionOptions { tilt: 101, ..SOME }), "tilt is 101, but must be from 0 to 100");
}
