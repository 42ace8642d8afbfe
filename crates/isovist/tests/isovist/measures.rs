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
        // The nearest point of all walls and the frame is always seen.
        let at = |k: usize, w: &[i64; 4]| Point2::new(w[k] as f64, w[k + 1] as f64);
        let frame = [[-1, -1, 13, -1], [13, -1, 13, 13], [13, 13, -1, 13], [-1, 13, -1, -1]];
        let nearest = walls.iter().chain(&frame).map(|w| {
            let (a, b) = (at(0, w), at(2, w));
            let t = ((eye - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
            eye.distance(a + t * (b - a))
        });
        let nearest = nearest.fold(f64::INFINITY, f64::min);
        prop_assert!(near(m.minimal_radial, nearest, 1e-9), "{} {}", m.minimal_radial, nearest);
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

/// Sectors whose sides pass ends of walls: every direction of a small grid, at right angles to where an end is.
#[test]
fn sides_of_sectors_pass_ends_of_walls() {
    let room = [[-10, -20, 41, -20], [41, -20, 41, 20], [41, 20, -10, 20], [-10, 20, -10, -20]];
    let mut n = 0;
    for (x, y) in (1..9).flat_map(|x| (1..9).map(move |y| (x, y))) {
        for (dx, dy) in [(0, 4), (4, 0)] {
            let walls: crate::Walls = room.into_iter().chain([[x, y, x + dx, y + dy]]).collect();
            let frame = Aabb { min: [-50.0; 2], max: [50.0; 2] };
            let whole = WallMesh::with_frame(&plan(&walls), frame).unwrap().isovist(Point2::ZERO).unwrap();
            let area = |direction: Point2, angle: f64| {
                let sector = Some(Sector { direction, angle });
                whole.limited(&Limits { sector, ..Limits::default() }).unwrap().measures().area
            };
            let end = Point2::new(f64::from(x as i32), f64::from(y as i32));
            for turn in [-1.0, 1.0] {
                // The middle of a right angle with one side through the end, and a little to both sides of it.
                let middle = end + turn * end.perp();
                let near = [-1e-9, 1e-9].map(|off| area(middle + off * middle.perp(), 90.0));
                let exact = area(middle, 90.0);
                assert!(near.iter().any(|&a| (a - exact).abs() < 1e-3 * a), "{end} {turn}: {exact} beside {near:?}");
                n += 1;
            }
            // Four quarters are the whole, wherever they begin.
            let quarters: f64 =
                (0..4).scan(end, |d, _| Some(std::mem::replace(d, d.perp()))).map(|d| area(d, 90.0)).sum();
            let most = whole.measures().area;
            assert!((quarters - most).abs() < 1e-9 * quarters, "{end}: {quarters} {most}");
            assert!(area(end, 1e-15) < 1e-6, "a narrow sector at {end}, {dx}: {}", area(end, 1e-15));
            assert!((area(end, 359.999_999) - most).abs() < 1e-3 * most, "a wide one");
        }
    }
    assert_eq!(n, 256);
}

#[test]
fn extreme_limits_are_no_trouble() {
    let whole = isovist(&vec![[0, 0, 12, 0], [12, 0, 12, 12], [12, 12, 0, 12], [0, 12, 0, 0]], Point2::new(6.0, 6.0));
    let limited = |radius: f64, deviation: f64| {
        whole.limited(&Limits { radius: Some(radius), deviation: Some(deviation), sector: None }).unwrap()
    };
    assert!(limited(1.0, 1e-300).vertices().len() < 200_000);
    let point = limited(1e-17, 1e-3).measures();
    assert!(point.area == 0.0 && point.compactness.is_finite() && point.minimal_radial.is_finite());
    for size in [1e200, 1e-200] {
        let sector = Some(Sector { direction: Point2::new(size, 0.0), angle: 90.0 });
        let area = whole.limited(&Limits { sector, ..Limits::default() }).unwrap().measures().area;
        assert!((area - 36.0).abs() < 1e-9, "{area}");
    }
    let round = limited(1.0, 1e-3);
    assert!(round.boundaries().iter().all(|&b| b == Boundary::Limit), "nothing else is within the radius");
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
