//! Surfaces are nowhere larger than the triangles that they are made of, and smaller only where these overlap.

use super::families::{Family, case};
use super::lattice::{At, STEP, is_on, weighted};
use proptest::test_runner::Config;
use sightlines_geometry::{Point3, Random};
use sightlines_line_space::Surface;

/// How many points of surfaces were tested.
#[derive(Debug, Clone, Copy, Default)]
struct Points {
    /// Triangles that faces were cut into.
    new: u32,
    /// Points of these that are on no given triangle.
    added: u32,
    /// Points of one given triangle alone.
    given: u32,
    /// Those that the surface does not have.
    lost: u32,
}

fn some_point(t: &[At; 3], random: &mut Random) -> At {
    let u = 1 + random.below(4094) as i64;
    let v = 1 + random.below((4095 - u) as usize) as i64;
    weighted(t, [u, v, 4096 - u - v])
}

/// Compares the surface of some triangles with other ones.
fn compare(told: &[[At; 3]], given: &[[At; 3]], points: &mut Points, random: &mut Random) {
    let doubles: Vec<[Point3; 3]> = told.iter().map(|t| t.map(|p| p.map(|x| x as f64 / STEP as f64))).collect();
    let surface = Surface::new(&doubles);
    let mesh = surface.mesh();
    let made: Vec<[At; 3]> = (0..mesh.triangles().len() as u32)
        .map(|t| mesh.corners(t).map(|p| p.map(|x| (x * STEP as f64) as i64)))
        .collect();
    let sorted = |t: &[At; 3]| {
        let mut t = *t;
        t.sort_unstable();
        t
    };
    let known: Vec<[At; 3]> = given.iter().map(sorted).collect();
    for t in made.iter().filter(|t| !known.contains(&sorted(t))) {
        points.new += 1;
        for _ in 0..4 {
            let p = some_point(t, random);
            points.added += u32::from(!given.iter().any(|g| is_on(p, g)));
        }
    }
    for t in given {
        for _ in 0..2 {
            let p = some_point(t, random);
            if given.iter().filter(|g| is_on(p, g)).count() == 1 {
                points.given += 1;
                points.lost += u32::from(!made.iter().any(|m| is_on(p, m)));
            }
        }
    }
}

/// Invariant: whatever is cut, the surface is the given one.
#[test]
fn surfaces_stay_where_they_were() {
    let mut points = Points::default();
    for (seed, family) in (301..).zip(Family::ALL) {
        let n = Config::default().cases / if family == Family::Floor { 1 } else { 4 };
        for i in 0..u64::from(n) {
            let mut random = Random::new(seed << 32 | i);
            let case = case(family, &mut random);
            let before = points;
            compare(&case.triangles, &case.triangles, &mut points, &mut random);
            assert_eq!([points.added, points.lost], [before.added, before.lost], "{family:?}, case {i}: {case:?}");
        }
    }
    eprintln!("{points:?}");
    assert!(points.new > 1000 || Config::default().cases < 200, "{points:?}");
    assert!(points.given > 1000, "{points:?}");
}

/// The impostor: where the surface has one triangle more or less, points are added or lost.
#[test]
fn surfaces_that_are_larger_or_smaller_are_noticed() {
    let (mut larger, mut smaller) = (Points::default(), Points::default());
    for i in 0..40 {
        let mut random = Random::new(401 << 32 | i);
        let triangles = case(Family::Floor, &mut random).triangles;
        let [_, fewer @ ..] = &triangles[..] else { continue };
        compare(&triangles, fewer, &mut larger, &mut random);
        compare(fewer, &triangles, &mut smaller, &mut random);
    }
    assert!(larger.added > 20 && smaller.lost > 20, "{larger:?} {smaller:?}");
}
