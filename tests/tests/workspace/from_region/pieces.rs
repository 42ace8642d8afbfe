//! Footprints, re-projections and splits, each against sampled lines.

use crate::from_region::common::triangles;
use proptest::prelude::*;
use sightlines::geometry::{Aabb, Point3};
use sightlines::multifocal::{BufferJob, BufferPlane, Carry, Footprint, Measure, Volume};
use sightlines::scenes::occlusion::{Occlusion, OcclusionOptions, occlusion};

fn boxed(min: [i32; 3], size: [i32; 3]) -> Aabb<3> {
    let min = min.map(|x| f64::from(x) * 0.25);
    Aabb { min, max: std::array::from_fn(|k| min[k] + f64::from(size[k]) * 0.25) }
}

/// A point of a box, by parts of 16 of its sides.
fn at(b: &Aabb<3>, part: [u32; 3]) -> Point3 {
    std::array::from_fn(|k| b.min[k] + (b.max[k] - b.min[k]) * (f64::from(part[k]) / 16.0))
}

/// Where the line from `v` through `e` meets a plane, in texels.
fn meets(plane: &BufferPlane, v: Point3, e: Point3) -> [f64; 2] {
    let (hv, he) = (plane.height(v), plane.height(e));
    let r = hv / (hv - he);
    let across = plane.across();
    std::array::from_fn(|k| (v[across[k]] + r * (e[across[k]] - v[across[k]]) - plane.origin()[k]) / plane.step()[k])
}

proptest! {
    /// Invariant: the line from any eye through any point of a target meets the plane in a touched texel.
    #[test]
    fn footprints_hold_all_lines(
        volume in ([-8i32..8, -8i32..8, -8i32..8], [0i32..4, 0i32..4, 0i32..4]),
        target in ([-20i32..20, -20i32..20, -20i32..20], [0i32..6, 0i32..6, 0i32..6]),
        axis in 0usize..3,
        positive in any::<bool>(),
        texels in [1u32..40, 1u32..40],
        parts in prop::collection::vec(([0u32..17, 0u32..17, 0u32..17], [0u32..17, 0u32..17, 0u32..17]), 40),
        as_points in any::<bool>(),
    ) {
        let (v, e) = (boxed(volume.0, volume.1), boxed(target.0, target.1));
        let side = if positive { 6.5 } else { -6.5 };
        let plane = BufferPlane::new(axis, positive, side, [-9.3, -7.1], [8.7, 9.9], texels).unwrap();
        let corners: Vec<Point3> = (0..8u32).map(|i| at(&e, [(i & 1) * 16, (i >> 1 & 1) * 16, (i >> 2) * 16])).collect();
        let volume = Volume::new(v).unwrap();
        let footprint = if as_points {
            Footprint::of_points(&volume, &plane, 0.5, &corners)
        } else {
            Footprint::of_box(&volume, &plane, 0.5, &e)
        };
        prop_assume!(plane.check_in_front_of(&volume).is_ok());
        let Some(footprint) = footprint else { return Ok(()) };
        let mut touched = vec![false; texels[0] as usize * texels[1] as usize];
        footprint.all_touched(|xs, y| {
            xs.for_each(|x| touched[y as usize * texels[0] as usize + x as usize] = true);
            true
        });
        let highest = corners.iter().map(|&p| plane.height(p)).fold(f64::MIN, f64::max);
        prop_assert!(highest < 0.0 || f64::from(footprint.limit) * 0.5 > highest, "{footprint:?} {highest}");
        for (a, b) in parts {
            let place = meets(&plane, at(&v, a), at(&e, b));
            let within = (0..2).all(|k| place[k] > 1e-9 && place[k] < f64::from(texels[k]) - 1e-9);
            if footprint.inside {
                prop_assert!((0..2).all(|k| place[k] > -1e-9 && place[k] < f64::from(texels[k]) + 1e-9));
                // On the border between texels either will do.
                let near = (0..2).any(|k| (place[k] - place[k].round()).abs() < 1e-9);
                let texel = place[1] as usize * texels[0] as usize + place[0] as usize;
                prop_assert!(!within || near || touched[texel], "{place:?} {footprint:?}");
            }
        }
    }

    /// Invariant: the line from an eye to a point of a texel crosses the plane before within the ranges; and
    /// ranges are no wider than the lines from the texel's corners by more than a texel on each side.
    #[test]
    fn carries_hold_all_lines(
        volume in ([-8i32..8, -8i32..8, -8i32..8], [0i32..6, 0i32..6, 0i32..6]),
        axis in 0usize..3,
        positive in any::<bool>(),
        texels in [1u32..30, 1u32..30, 1u32..30, 1u32..30],
        at_texel in [0u32..1000, 0u32..1000],
        parts in prop::collection::vec(([0u32..17, 0u32..17, 0u32..17], [0u32..17, 0u32..17]), 40),
    ) {
        let v = boxed(volume.0, volume.1);
        let side = |at: f64| if positive { at } else { -at };
        let plane = |at: f64, window: f64, n: [u32; 2]| BufferPlane::new(axis, positive, side(at), [-window; 2], [window; 2], n).unwrap();
        let (before, after) = (plane(6.0, 7.0, [texels[0], texels[1]]), plane(8.3, 9.0, [texels[2], texels[3]]));
        let job = BufferJob::new(Volume::new(v).unwrap(), vec![before, after], [], Measure::SectionHeight, true).unwrap();
        let carry = Carry::of(&job, 1);
        prop_assert!(f64::from(carry.rise) * job.unit() <= 8.3 - 6.0);
        prop_assert!(f64::from(carry.rise + 2) * job.unit() >= 8.3 - 6.0);
        let (x, y) = (at_texel[0] % texels[2], at_texel[1] % texels[3]);
        let (low, high) = (after.corner(x, y), after.corner(x + 1, y + 1));
        let ranges = [carry.columns[x as usize], carry.rows[y as usize]];
        let across = after.across();
        let mut ends = [[f64::MAX, f64::MIN]; 2];
        for (a, b) in parts.into_iter().chain((0..32).map(|i| ([i & 1, i >> 1 & 1, i >> 2 & 1].map(|x| x * 16), [(i >> 3 & 1) * 16, (i >> 4) * 16]))) {
            let eye = at(&v, a);
            let mut p = low;
            for k in 0..2 {
                p[across[k]] += (high[across[k]] - low[across[k]]) * (f64::from(b[k]) / 16.0);
            }
            let place = meets(&before, eye, p);
            for k in 0..2 {
                ends[k] = [ends[k][0].min(place[k]), ends[k][1].max(place[k])];
                let [first, last] = ranges[k];
                if first <= last {
                    prop_assert!(f64::from(first) <= place[k] + 1e-9 && place[k] <= f64::from(last) + 1.0 + 1e-9, "{place:?} {ranges:?}");
                }
            }
        }
        for k in 0..2 {
            let [first, last] = ranges[k];
            let n = f64::from(before.texels()[k]);
            if first > last {
                prop_assert!(ends[k][0] < 1e-9 || ends[k][1] > n - 1e-9, "{ends:?} is within the window");
            } else {
                prop_assert!(f64::from(first) + 1.0 + 1e-9 >= ends[k][0] && f64::from(last) - 1e-9 <= ends[k][1], "{ends:?} {ranges:?}");
            }
        }
    }
}

/// Halves of volumes find what the whole does not, and nothing that the whole finds is lost.
#[test]
fn splitting_finds_more() {
    use sightlines::multifocal::{Layout, Occludees, RaySampler, Split, adaptive};
    let benchmark = occlusion(OcclusionOptions { tilt: 30, ..OcclusionOptions::default() }).unwrap();
    let all = triangles(&benchmark.scene);
    let around = crate::from_region::common::around(&benchmark.scene, &benchmark.occludees);
    let of_box = |b: &Aabb<3>| vec![[b.min, b.max, [b.min[0], b.max[1], b.min[2]]]];
    let occludees = Occludees::new(benchmark.occludees.iter().map(of_box).collect());
    let witness = RaySampler::new([&all[..]]);
    let volume = Volume::new(Occlusion::volume(0.5)).unwrap();
    let visible = |depth| {
        let mut method = crate::from_region::common::buffers(&all, around, Layout::default());
        let mut visible = vec![true; occludees.len()];
        let split = Split { depth, worth: 0.0, n_rays: 0 };
        let effort =
            adaptive::see(&mut method, &occludees, &witness, &volume, &split, &mut visible, &mut |_| ()).unwrap();
        (visible, effort.n_volumes)
    };
    let (whole, one) = visible(0);
    let (parts, many) = visible(3);
    assert_eq!(one, 1);
    assert!(many > 3, "{many} volumes");
    assert!(
        whole.iter().zip(&parts).all(|(whole, part)| *whole || !part),
        "what is hidden from the whole is from parts"
    );
    let count = |v: &[bool]| v.iter().filter(|v| !**v).count();
    assert!(count(&parts) > count(&whole), "{} and {}", count(&parts), count(&whole));
}
