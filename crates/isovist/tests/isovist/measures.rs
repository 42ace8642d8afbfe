//! Measures against sampled rays, limits against the whole.

use crate::{plan, walls};
use proptest::prelude::*;
use sightlines_geometry::{Aabb, Point2};
use sightlines_isovist::{Boundary, Isovist, Limits, Sector, WallMesh};

/// The distance at which a ray leaves an isovist.
fn radial(isovist: &Isovist, d: Point2) -> f64 {
    let eye = isovist.eye();
    let hit = |(a, b): (Point2, Point2)| {
        let (a, step) = (a - eye, b - a);
        let (t, u) = (a.perp_dot(step) / d.perp_dot(step), a.perp_dot(d) / d.perp_dot(step));
        (t > 0.0 && (-1e-9..=1.0 + 1e-9).contains(&u)).then_some(t)
    };
    isovist
        .edges()
        .filter(|e| e.2 != Boundary::Occluding)
        .filter_map(|(a, b, _)| hit((a, b)))
        .fold(f64::INFINITY, f64::min)
}

/// Eyes between the lines of the grid, so that none is on a wall of it.
fn eye() -> impl Strategy<Value = Point2> {
    (0u32..12, 0u32..12).prop_map(|(x, y)| Point2::new(f64::from(x) + 0.37, f64::from(y) + 0.61))
}

fn isovist(walls: &crate::Walls, eye: Point2) -> Isovist {
    let frame = Aabb { min: [-1.0; 2], max: [13.0; 2] };
    WallMesh::with_frame(&plan(walls), frame).unwrap().isovist(eye).unwrap()
}

fn near(a: f64, b: f64, tolerance: f64) -> bool {
    (a - b).abs() <= tolerance * a.abs().max(b.abs()).max(1e-6)
}

proptest! {
    /// Invariant: closed forms equal sums over many rays.
    #[test]
    fn moments_equal_those_of_rays(walls in walls(10, 13), eye in eye()) {
        let isovist = isovist(&walls, eye);
        let m = isovist.measures();
        let n = 20_000;
        let radials: Vec<f64> = (0..n).map(|i| {
            let angle = (f64::from(i) + 0.5) / f64::from(n) * std::f64::consts::TAU;
            radial(&isovist, Point2::from_angle(angle))
        }).collect();
        let mean = |f: &dyn Fn(f64) -> f64| radials.iter().map(|&r| f(r)).sum::<f64>() / f64::from(n);
        let first = mean(&|r| r);
        prop_assert!(near(m.mean_radial, first, 1e-2), "{} {}", m.mean_radial, first);
        prop_assert!(near(m.area, mean(&|r| r * r) * std::f64::consts::PI, 2e-2));
        let (second, third) = (mean(&|r| (r - first).powi(2)), mean(&|r| (r - first).powi(3)));
        prop_assert!((m.variance - second).abs() < 0.03 * (second + 1.0), "{} {}", m.variance, second);
        prop_assert!((m.skewness - third).abs() < 0.1 * (second.powf(1.5) + 1.0), "{} {}", m.skewness, third);
        let (least, most) = (radials.iter().copied().fold(f64::INFINITY, f64::min), radials.iter().copied().fold(0.0, f64::max));
        prop_assert!(m.minimal_radial <= least * (1.0 + 1e-9) && m.maximal_radial >= most * (1.0 - 1e-9));
        prop_assert!(near(m.minimal_radial, least, 2e-2), "{} {}", m.minimal_radial, least);
        prop_assert!(m.compactness > 0.0 && m.compactness <= 1.0 && m.occlusivity <= m.perimeter);
    }

    /// Invariant: within limits, a ray ends at the limit or where it did.
    #[test]
    fn limits_cut_every_ray(walls in walls(10, 13), eye in eye(), radius in 0.5f64..9.0, turn in 0.0f64..6.2, angle in 10.0f64..350.0) {
        let whole = isovist(&walls, eye);
        let direction = Point2::from_angle(turn);
        let deviation = Some(1e-4);
        let round = whole.limited(&Limits { radius: Some(radius), deviation, ..Limits::default() }).unwrap();
        let sector = Some(Sector { direction, angle });
        let wedge = whole.limited(&Limits { sector, ..Limits::default() }).unwrap();
        let both = whole.limited(&Limits { radius: Some(radius), sector, deviation }).unwrap();
        for i in 0..500 {
            let off = (f64::from(i) + 0.5) / 500.0 * 360.0 - 180.0;
            let d = Point2::from_angle(turn + off.to_radians());
            let truth = radial(&whole, d);
            let rounded = radial(&round, d);
            prop_assert!(rounded <= truth.min(radius) * (1.0 + 1e-9) && rounded >= truth.min(radius) - 1e-3 * (1.0 + radius), "{} {} {}", rounded, truth, radius);
            // What is at the sides of the sector itself is left to rounding.
            if off.abs() < 0.5 * angle - 1e-6 {
                prop_assert!(near(radial(&wedge, d), truth, 1e-9), "at {} of {}", off, angle);
                prop_assert!(near(radial(&both, d), rounded, 1e-3));
            }
        }
        let m = (wedge.measures(), both.measures(), round.measures());
        prop_assert!(m.0.area <= whole.measures().area * (1.0 + 1e-9));
        prop_assert!(m.1.area <= m.0.area * (1.0 + 1e-9) && m.1.area <= m.2.area * (1.0 + 1e-9));
        prop_assert!(m.1.maximal_radial <= radius * (1.0 + 1e-9));
    }
}

#[test]
fn measures_of_a_square_are_known() {
    let walls = vec![[0, 0, 12, 0], [12, 0, 12, 12], [12, 12, 0, 12], [0, 12, 0, 0]];
    let m = isovist(&walls, Point2::new(6.0, 6.0)).measures();
    assert_eq!((m.area, m.perimeter, m.occlusivity, m.drift, m.minimal_radial), (144.0, 48.0, 0.0, 0.0, 6.0));
    assert!((m.mean_radial - 6.0 * 8.0 / std::f64::consts::TAU * 1f64.asinh()).abs() < 1e-12);
    assert!((m.compactness - std::f64::consts::FRAC_PI_4).abs() < 1e-12);
    let off = isovist(&walls, Point2::new(3.0, 6.0)).measures();
    assert_eq!((off.drift, off.drift_angle), (3.0, 0.0));
    let circle = isovist(&walls, Point2::new(6.0, 6.0));
    let circle = circle.limited(&Limits { radius: Some(5.0), deviation: Some(1e-6), sector: None }).unwrap().measures();
    assert!((circle.area - 25.0 * std::f64::consts::PI).abs() < 1e-4 && circle.variance < 1e-9);
}

#[test]
fn limits_are_checked() {
    let whole = isovist(&vec![[0, 0, 12, 0]], Point2::new(6.0, 6.0));
    let error = |limits: Limits| whole.limited(&limits).unwrap_err().to_string();
    assert_eq!(error(Limits { radius: Some(-1.0), ..Limits::default() }), "the radius -1 is not a positive number");
    assert_eq!(
        error(Limits { radius: Some(f64::NAN), ..Limits::default() }),
        "the radius NaN is not a positive number"
    );
    assert_eq!(error(Limits { deviation: Some(0.0), ..Limits::default() }), "the deviation 0 is not a positive number");
    let sector =
        |direction: Point2, angle: f64| Limits { sector: Some(Sector { direction, angle }), ..Limits::default() };
    assert_eq!(error(sector(Point2::X, 360.0)), "the angle 360 is not above 0 and below 360 degrees");
    assert_eq!(error(sector(Point2::ZERO, 90.0)), "the direction (0, 0) is none");
}
