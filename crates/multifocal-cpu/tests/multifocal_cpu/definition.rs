//! The reference against the definition by another method: segments and triangles in whole numbers.

use crate::common::{GridScene, Surface, bent, check_blocked, decoded, meets, scene, triangle};
use num_rational::BigRational;
use num_traits::{FromPrimitive, Signed, Zero};
use proptest::prelude::*;
use sightlines_multifocal::{Buffer, Measure, MultifocalBackend};
use sightlines_multifocal_cpu::Reference;

fn buffers(scene: &GridScene, measure: Measure) -> (Vec<Buffer>, f64) {
    let occluders = scene.occluders();
    let job = scene.job(&occluders, measure);
    let mut out = Vec::new();
    Reference.render(&job, &mut out).expect("the reference does every job");
    (out, job.unit())
}

fn samples() -> impl Strategy<Value = Vec<[i64; 5]>> {
    prop::collection::vec([0i64..1000, 0i64..1000, 0i64..1000, 0i64..1000, 0i64..1000], 4)
}

/// What one triangle hides, from the segments between corners alone: the least part of the way to the eyes, as a height.
/// None if it does not block them all, with all eyes off its plane.
fn section(scene: &GridScene, plane: usize, x: u32, y: u32) -> Option<BigRational> {
    let triangle = scene.surfaces[0].triangles[0];
    let mut least: Option<BigRational> = None;
    for v in scene.eye_corners() {
        for p in scene.texel_corners(plane, x, y) {
            let part = meets(p, v, triangle).filter(|t| *t < BigRational::from_i32(1).expect("a number"))?;
            let height = part * BigRational::from_integer((scene.planes[plane] - v[2]).into());
            least = Some(least.map_or(height.clone(), |least| least.min(height)));
        }
    }
    least
}

/// How much is stored: whole units of a height.
fn code(height: &BigRational, unit: f64) -> u32 {
    let units = (height / BigRational::from_float(unit).expect("a unit")).floor();
    u32::try_from(units.to_integer()).expect("less than 2^28") + 1
}

proptest! {
    /// Whatever is stored as blocked is, on every segment, at no less than the value; planes are carried over.
    #[test]
    fn blocked_texels_are_blocked_on_every_segment(
        scene in scene(prop_oneof![triangle(), bent()], 1..=3, 1..=3),
        measure in prop::sample::select(Measure::ALL.to_vec()),
        samples in samples(),
    ) {
        let (out, unit) = buffers(&scene, measure);
        check_blocked(&scene, &out, unit, measure, &samples).map_err(TestCaseError::fail)?;
    }

    /// The twin: one triangle blocks exactly the texels that it blocks between all corners, from the height of the lowest
    /// crossing.
    #[test]
    fn single_triangles_block_all_that_they_can(scene in scene(triangle(), 1..=1, 1..=1)) {
        let (sections, unit) = buffers(&scene, Measure::SectionHeight);
        let (vertices, _) = buffers(&scene, Measure::VertexHeight);
        let corners = scene.surfaces[0].outline.iter();
        let lowest = corners.map(|p| scene.planes[0] - p[2]).min().expect("three corners").max(0);
        let lowest = BigRational::from_integer(lowest.into());
        for (plane, x, y) in scene.all_texels() {
            let wanted = section(&scene, plane, x, y);
            let at = |height: &BigRational| wanted.as_ref().map_or(0, |_| code(height, unit));
            prop_assert_eq!(sections[plane].get(x, y), at(wanted.as_ref().unwrap_or(&lowest)), "texel {} {}", x, y);
            prop_assert_eq!(vertices[plane].get(x, y), at(&lowest), "texel {} {}", x, y);
        }
    }

    /// Distances lie between the height and what pairs of points have: corners of the triangle, or crossings.
    #[test]
    fn distances_are_no_more_than_those_of_points(scene in scene(triangle(), 1..=1, 1..=1)) {
        let by = |measure| buffers(&scene, measure);
        let ((sections, unit), (euclid, euclid_unit)) = (by(Measure::SectionHeight), by(Measure::Euclid));
        let (clipped, clipped_unit) = by(Measure::ClippedEuclid);
        for (plane, x, y) in scene.all_texels() {
            let Some(height) = decoded(&sections[plane], x, y, unit, Measure::SectionHeight) else {
                prop_assert_eq!((euclid[plane].get(x, y), clipped[plane].get(x, y)), (0, 0));
                continue;
            };
            let square = |buffers: &[Buffer], unit| decoded(&buffers[plane], x, y, unit, Measure::Euclid);
            let euclid = square(&euclid, euclid_unit).expect("blocked for each measure");
            let clipped = square(&clipped, clipped_unit).expect("blocked for each measure");
            prop_assert!(euclid <= clipped, "a part is no nearer than the whole");
            // Rounded down to units of its own; the square of a difference of one unit is not much.
            let unit = BigRational::from_float(clipped_unit).expect("a unit");
            let slack = (&height * BigRational::from_integer(2.into()) + &unit) * &unit;
            prop_assert!(&clipped + slack >= &height * &height, "a distance is no less than the height");
            prop_assert!(!euclid.is_negative());
            for p in scene.texel_corners(plane, x, y) {
                for q in &scene.surfaces[0].outline {
                    let d = crate::common::sub(p, *q);
                    prop_assert!(euclid <= BigRational::from_integer(crate::common::dot(d, d).into()));
                }
                for v in scene.eye_corners() {
                    let part = meets(p, v, scene.surfaces[0].triangles[0]).expect("blocked");
                    let d = crate::common::sub(p, v);
                    prop_assert!(clipped <= &part * &part * BigRational::from_integer(crate::common::dot(d, d).into()));
                }
            }
        }
    }
}

/// A wall across the window, with the eyes in a square: all distances are known.
fn wall(texels: [u32; 2]) -> GridScene {
    let outline = vec![[-100, -100, 32], [-100, 100, 32], [100, 100, 32], [100, -100, 32]];
    let triangles = vec![[outline[0], outline[1], outline[2]], [outline[0], outline[2], outline[3]]];
    GridScene {
        eyes: [[-4, -4, 0], [4, 4, 0]],
        surfaces: vec![Surface { outline, triangles }],
        planes: vec![64],
        low: [16, -8],
        step: [16, 16],
        texels,
        axis: 2,
        positive: true,
    }
}

#[test]
fn distances_to_a_parallel_wall_are_exact() {
    let scene = wall([6, 1]);
    let (euclid, unit) = buffers(&scene, Measure::Euclid);
    let (clipped, clipped_unit) = buffers(&scene, Measure::ClippedEuclid);
    for x in 0..6 {
        // Lines from the texel 16 (x + 1) to 16 (x + 2) to eyes at -4 to 4 cross the wall, half way, up to 8 (x + 2) + 2.
        let aside = f64::from(16 * (x + 1)) - f64::from(8 * (x + 2) + 2);
        // To the wall it is straight up, as long as there is wall: up to 100.
        let past = (f64::from(16 * (x + 1)) - 100.0).max(0.0);
        let wanted = |aside: f64| aside.max(0.0).hypot(32.0);
        let code = |distance: f64, unit: f64| (distance / unit).floor() as u32 + 1;
        if x < 5 {
            assert_eq!(euclid[0].get(x, 0), code(wanted(past), unit), "texel {x}");
            assert_eq!(clipped[0].get(x, 0), code(wanted(aside), clipped_unit), "texel {x}");
        }
    }
    assert!(euclid[0].get(5, 0) > 0, "all of the wall is used");
}

#[test]
fn walls_that_overlap_hide_together_what_none_hides_alone() {
    let mut scene = wall([8, 1]);
    scene.eyes = [[-12, -4, 0], [12, 4, 0]];
    (scene.low, scene.step) = ([-32, -8], [8, 16]);
    scene.planes = vec![40, 64];
    let half = |from: i64, to: i64, z: i64| {
        let outline = vec![[from, -100, z], [from, 100, z], [to, 100, z], [to, -100, z]];
        let triangles = vec![[outline[0], outline[1], outline[2]], [outline[0], outline[2], outline[3]]];
        Surface { outline, triangles }
    };
    scene.surfaces = vec![half(-100, 9, 36), half(-1, 100, 38)];
    let (carried, _) = buffers(&scene, Measure::SectionHeight);
    let occluders = scene.occluders();
    let job = scene.job(&occluders, Measure::SectionHeight);
    let apart =
        sightlines_multifocal::BufferJob::new(*job.volume(), job.planes().to_vec(), &occluders, job.measure(), false);
    let mut alone = Vec::new();
    Reference.render(&apart.expect("a job"), &mut alone).expect("the reference does every job");
    assert_eq!(alone[0], carried[0], "nothing is carried to the first plane");
    // In the middle no wall alone has room for lines from the second plane. On the first plane all texels are blocked: by
    // the nearer wall from 4 on, by the farther one from 2; the planes are 24 apart.
    let [low, high] = [26.0, 28.0].map(|height: f64| (height / job.unit()) as u32 + 1);
    assert_eq!(alone[1].values(), [high, high, high, high, 0, low, low, low]);
    assert_eq!(carried[1].values(), [high, high, high, high, low, low, low, low]);
}

#[test]
fn impostor_a_texel_more_and_a_unit_more_are_caught() {
    let mut scene = wall([8, 1]);
    scene.surfaces[0].outline = vec![[-30, -90, 32], [0, 100, 40], [60, -90, 36]];
    scene.surfaces[0].triangles = vec![[[-30, -90, 32], [0, 100, 40], [60, -90, 36]]];
    for measure in Measure::ALL {
        let (mut out, unit) = buffers(&scene, measure);
        let n_segments =
            check_blocked(&scene, &out, unit, measure, &[[1, 2, 3, 4, 5]]).expect("the reference is right");
        assert_eq!(n_segments, out[0].n_blocked() * 33);
        let last = out[0].values().iter().rposition(|&v| v > 0).expect("some are blocked");
        assert!(last < 7, "some are not");
        let kept = out[0].values()[last];
        out[0].values_mut()[last + 1] = 1;
        check_blocked(&scene, &out, unit, measure, &[]).expect_err("a texel more");
        out[0].values_mut()[last + 1] = 0;
        if measure == Measure::SectionHeight {
            out[0].values_mut()[last] = kept + 1;
            check_blocked(&scene, &out, unit, measure, &[]).expect_err("a unit more");
        }
    }
}

#[test]
fn parts_behind_the_plane_do_not_count() {
    // A wall that cuts the plane: its lowest corner is behind it, and what is met is in front or on it.
    let mut scene = wall([8, 1]);
    let outline = vec![[-200, -200, 24], [-200, 200, 24], [200, 200, 104], [200, -200, 104]];
    scene.surfaces[0].triangles = vec![[outline[0], outline[1], outline[2]], [outline[0], outline[2], outline[3]]];
    scene.surfaces[0].outline = outline;
    scene.low = [-64, -8];
    let (vertices, _) = buffers(&scene, Measure::VertexHeight);
    let (sections, unit) = buffers(&scene, Measure::SectionHeight);
    // The wall is at height 0 where x = 0, so the texels up to there are blocked.
    assert_eq!(vertices[0].values(), [1, 1, 1, 1, 0, 0, 0, 0]);
    let heights = sections[0].values().iter().map(|&v| f64::from(v.saturating_sub(1)) * unit);
    let heights: Vec<f64> = heights.collect();
    assert!(heights[..4].is_sorted_by(|a, b| a > b) && heights[3].is_zero(), "{heights:?}");
}
