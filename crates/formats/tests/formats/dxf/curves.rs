//! Curves against their formulas: vertices are on the curve, no point of it is too far away, and there are not too many pieces.

use super::{read, vertices};
use crate::common::dxf::Dxf;
use proptest::prelude::*;
use sightlines_formats::PlanReadOptions;
use sightlines_formats::dxf::{DEFAULT_DEVIATION, parse_dxf};
use std::f64::consts::{PI, TAU};

fn pieces(entity: &Dxf, deviation: f64) -> Vec<[f64; 2]> {
    let options = PlanReadOptions { deviation: Some(deviation), ..PlanReadOptions::default() };
    vertices(&parse_dxf(&entity.model(&Dxf::new()), &options).unwrap())
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

fn to_segment(p: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    let (d, e) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
    let t = ((d[0] * e[0] + d[1] * e[1]) / (d[0] * d[0] + d[1] * d[1])).clamp(0.0, 1.0);
    distance(p, [a[0] + t * d[0], a[1] + t * d[1]])
}

/// How far the points of a curve are from a chain at most, and how far its vertices are from them.
fn compare(chain: &[[f64; 2]], curve: impl Fn(f64) -> [f64; 2]) -> [f64; 2] {
    const N: usize = 3000;
    let samples: Vec<[f64; 2]> = (0..=N).map(|k| curve(k as f64 / N as f64)).collect();
    let to_chain = |&p: &[f64; 2]| chain.windows(2).map(|ab| to_segment(p, ab[0], ab[1])).fold(f64::MAX, f64::min);
    let to_curve = |&p: &[f64; 2]| samples.windows(2).map(|ab| to_segment(p, ab[0], ab[1])).fold(f64::MAX, f64::min);
    [samples.iter().map(to_chain).fold(0.0, f64::max), chain.iter().map(to_curve).fold(0.0, f64::max)]
}

/// Checks a chain against its curve, which is about `size` large, and returns how much of the deviation is used.
fn check(chain: &[[f64; 2]], deviation: f64, size: f64, curve: impl Fn(f64) -> [f64; 2]) -> f64 {
    let [away, off] = compare(chain, &curve);
    // Samples of the curve are joined by chords of their own.
    let sampled = size * 1e-5;
    assert!(away <= deviation * (1.0 + 1e-9) + size * 1e-13, "{away} is more than {deviation}");
    assert!(off <= sampled, "a vertex is {off} off the curve");
    assert!(
        distance(chain[0], curve(0.0)) < size * 1e-13 && distance(chain[chain.len() - 1], curve(1.0)) < size * 1e-13
    );
    away / deviation
}

fn circle_at(center: [f64; 2], radius: f64, from: f64, sweep: f64) -> impl Fn(f64) -> [f64; 2] {
    move |t| {
        let (sin, cos) = (from + t * sweep).sin_cos();
        [center[0] + radius * cos, center[1] + radius * sin]
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, ..ProptestConfig::default() })]

    /// Invariant: arcs keep to the deviation, and use some of it.
    #[test]
    fn arcs_keep_to_the_deviation(
        x in -9i8..9, radius in 1u8..20, start in -400i16..400, sweep in 1i16..=360, fine in 1u8..5
    ) {
        let (center, radius) = ([f64::from(x), 2.5], f64::from(radius) / 4.0);
        let deviation = radius * 0.3f64.powi(i32::from(fine) + 2);
        let [from, turn] = [f64::from(start), f64::from(sweep)];
        let arc = Dxf::new().entity("ARC", "0").at(10, center).put(40, radius).put(50, from).put(51, from + turn);
        let chain = pieces(&arc, deviation);
        let used = check(&chain, deviation, 4.0 * radius, circle_at(center, radius, from.to_radians(), turn.to_radians()));
        // Half a piece would do: as many pieces as are needed, four times at most and one for each quarter.
        let needed = (turn.to_radians() / (2.0 * (1.0 - deviation / radius).acos())).ceil();
        let n = (chain.len() - 1) as f64;
        prop_assert!(n >= needed && n <= 4.0 * needed + 5.0, "{} pieces, {} are needed", n, needed);
        prop_assert!(used > 0.02 || needed <= 5.0, "{}", used);
    }

    /// Invariant: bulges are arcs through both vertices, exactly.
    #[test]
    fn bulges_are_arcs(ax in -9i8..9, ay in -9i8..9, bx in -9i8..9, by in -9i8..9, quarters in -35i8..=35) {
        let (a, b) = ([f64::from(ax), f64::from(ay)], [f64::from(bx), f64::from(by)]);
        let angle = f64::from(quarters) * 0.17;
        prop_assume!(a != b && quarters != 0);
        let bulge = (angle / 4.0).tan();
        let chord = distance(a, b);
        let radius = chord / 2.0 / (angle / 2.0).sin().abs();
        let deviation = radius * 0.01;
        let chain = pieces(&Dxf::new().path(false, &[(a, bulge), (b, 0.0)]), deviation);
        prop_assert_eq!((chain[0], chain[chain.len() - 1]), (a, b));
        // The centre is on the left of a turn to the left that is less than half.
        let height = chord / 2.0 / (angle / 2.0).tan();
        let center = [(a[0] + b[0]) / 2.0 - (b[1] - a[1]) / chord * height, (a[1] + b[1]) / 2.0 + (b[0] - a[0]) / chord * height];
        let from = (a[1] - center[1]).atan2(a[0] - center[0]);
        check(&chain, deviation, 4.0 * radius + chord, circle_at(center, radius, from, angle));
    }

    /// Invariant: ellipses, whole and in part.
    #[test]
    fn ellipses_keep_to_the_deviation(ux in -6i8..6, uy in 1i8..6, ratio in 1u8..=10, start in 0u8..60, sweep in 1u8..60, normal in 0u8..2) {
        let (u, ratio) = ([f64::from(ux), f64::from(uy)], f64::from(ratio) / 10.0);
        let sign = if normal == 0 { 1.0 } else { -1.0 };
        let [from, turn] = [f64::from(start) / 10.0, f64::from(sweep) / 10.0];
        let ellipse = Dxf::new().entity("ELLIPSE", "0").at(10, [1.0, 2.0]).at(11, u).put(40, ratio)
            .put(41, from).put(42, from + turn).put(230, sign);
        let size = u[0].hypot(u[1]);
        let deviation = 0.003 * size;
        let curve = |t: f64| {
            let (sin, cos) = (from + t * turn).sin_cos();
            [1.0 + cos * u[0] - sign * sin * ratio * u[1], 2.0 + cos * u[1] + sign * sin * ratio * u[0]]
        };
        check(&pieces(&ellipse, deviation), deviation, 4.0 * size, curve);
    }

    /// Invariant: splines are what the recursion of their basis functions gives.
    #[test]
    fn splines_keep_to_the_deviation(
        degree in 1usize..6,
        points in prop::collection::vec((-20i8..20, -20i8..20, 1u8..6), 6..12),
        gaps in prop::collection::vec(0u8..4, 24),
        is_clamped: bool,
        has_weights: bool,
    ) {
        let n = points.len();
        // Ascending knots; within, none is there more often than the degree.
        let mut knots = vec![0.0];
        for k in 1..n + degree + 1 {
            let clamped = is_clamped && (k <= degree || k > n);
            let step = if clamped { 0.0 } else if degree > 1 && k % 2 == 0 { f64::from(gaps[k]) } else { 1.0 + f64::from(gaps[k]) };
            knots.push(knots[k - 1] + step);
        }
        let weight = |k: usize| if has_weights { f64::from(points[k].2) / 2.0 } else { 1.0 };
        let point = |k: usize| [f64::from(points[k].0), f64::from(points[k].1)];
        let mut spline = Dxf::new().entity("SPLINE", "0").put(70, 0).put(71, degree);
        for knot in &knots { spline = spline.put(40, knot) }
        for k in (0..n).filter(|_| has_weights) { spline = spline.put(41, weight(k)) }
        for k in 0..n { spline = spline.at(10, point(k)).put(30, 0) }
        let (from, to) = (knots[degree], knots[n]);
        let curve = |t: f64| {
            let u = from + t * (to - from);
            let basis: Vec<f64> = (0..n).map(|k| weight(k) * basis(&knots, k, degree, u, to)).collect();
            let sum: f64 = basis.iter().sum();
            [0, 1].map(|d| basis.iter().enumerate().map(|(k, b)| b * point(k)[d]).sum::<f64>() / sum)
        };
        // All points may be one.
        prop_assume!((1..n).any(|k| point(k) != point(0)) && distance(curve(0.3), curve(0.7)) > 0.1);
        let deviation = 0.05;
        let options = PlanReadOptions { deviation: Some(deviation), ..PlanReadOptions::default() };
        let file = parse_dxf(&spline.model(&Dxf::new()), &options).unwrap();
        // Lines that a curve passes twice are dropped, so that only the curve's distance is compared.
        let all = super::lines(&file);
        let away = (0..=2000).map(|k| {
            let p = curve(f64::from(k) / 2000.0);
            all.iter().map(|l| to_segment(p, [l[0], l[1]], [l[2], l[3]])).fold(f64::MAX, f64::min)
        }).fold(0.0, f64::max);
        prop_assert!(away <= deviation + 1e-9, "{}", away);
        let on_curve = |p: [f64; 2]| (0..=4000).map(|k| distance(p, curve(f64::from(k) / 4000.0))).fold(f64::MAX, f64::min);
        for line in all.iter().step_by(7) {
            prop_assert!(on_curve([line[0], line[1]]) < 0.2, "{:?}", line);
        }
        prop_assert!(distance([all[0][0], all[0][1]], curve(0.0)) < 1e-9);
    }
}

/// A basis function, by its definition; the last span has its end.
fn basis(knots: &[f64], k: usize, degree: usize, u: f64, end: f64) -> f64 {
    if degree == 0 {
        let (low, high) = (knots[k], knots[k + 1]);
        return f64::from(u8::from(low <= u && (u < high || (u == end && u == high && low < high))));
    }
    let part = |num: f64, den: f64, k| if den > 0.0 { num / den * basis(knots, k, degree - 1, u, end) } else { 0.0 };
    part(u - knots[k], knots[k + degree] - knots[k], k)
        + part(knots[k + degree + 1] - u, knots[k + degree + 1] - knots[k + 1], k + 1)
}

#[test]
fn the_default_deviation_is_a_share_of_the_plan() {
    let circle = Dxf::new().entity("CIRCLE", "0").at(10, [0.0, 0.0]).put(40, 5);
    let alone = read(&circle.model(&Dxf::new()));
    let [away, _] = compare(&vertices(&alone), circle_at([0.0; 2], 5.0, 0.0, TAU));
    let deviation = 10.0 * DEFAULT_DEVIATION;
    assert!(away <= deviation && away > deviation / 20.0, "{away}");
    // In a plan that is ten times as large it is coarser.
    let wide = circle.line("0", [-50.0, 9.0], [50.0, 9.0]);
    let both = read(&wide.model(&Dxf::new()));
    assert!(both.plan.lines().len() < alone.plan.lines().len());
}

/// Chains that are too coarse, or on the wrong side of a chord, are noticed.
#[test]
fn impostors_are_noticed() {
    let arc = |deviation| {
        let arc = Dxf::new().entity("ARC", "0").at(10, [0.0, 0.0]).put(40, 2).put(50, 0).put(51, 180);
        pieces(&arc, deviation)
    };
    let distances = |deviation: f64, curve: &dyn Fn(f64) -> [f64; 2]| compare(&arc(deviation), curve)[0];
    let right = circle_at([0.0; 2], 2.0, 0.0, PI);
    let below = circle_at([0.0; 2], 2.0, 0.0, -PI);
    assert!(distances(0.001, &right) <= 0.001);
    assert!(distances(0.1, &right) > 0.001 && distances(0.001, &below) > 1.0);
}

#[test]
fn a_deviation_that_asks_for_too_many_pieces_is_refused() {
    let circle = Dxf::new().entity("CIRCLE", "0").at(10, [0.0, 0.0]).put(40, 5).model(&Dxf::new());
    let with =
        |deviation| parse_dxf(&circle, &PlanReadOptions { deviation: Some(deviation), ..PlanReadOptions::default() });
    assert!(with(1e-9).is_ok());
    assert!(with(1e-30).unwrap_err().to_string().contains("more than 2097152 elements"));
}
