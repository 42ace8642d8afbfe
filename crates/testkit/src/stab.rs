//! Oracle: can a directed line pass through a sequence of portals?
//!
//! Method: a directed line is a form (a, b, c), positive on its left. Those that have every left end
//! on their closed left and every right end on their closed right make a convex cone. If the ends are
//! not all collinear the cone is pointed, and each of its extreme rays is a line through two ends. The
//! sum of all extreme rays lies in the relative interior of the cone, so it is strict in every
//! condition exactly if any line is. No order among the portals is used, no chain, no incremental
//! state: nothing of the funnel.

use crate::exact::{Form, Hp, Int, scaled, small};
use sightlines_geometry::Point2;

/// How directed lines can pass a sequence of portals.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stab {
    /// Some line has every left end strictly on its left and every right end strictly on its right;
    /// then an open set of lines does.
    Open,
    /// Only lines that touch an end, or run along a portal, obey every condition in the closed sense.
    /// Such a line need not meet the portals in their order.
    Grazing,
    /// No line obeys every condition even in the closed sense.
    None,
}

/// Decides it for portals given as (left end, right end), by trying all lines through two ends.
///
/// A line that has both ends of a portal strictly on their sides crosses the open portal in the right
/// direction, so for portals between consecutive convex cells [`Stab::Open`] is the truth about open
/// portals with closed jambs. An empty sequence is open. Exact for every finite coordinate; cost
/// O(n^3) integer operations.
///
/// # Panics
/// If a coordinate is not finite.
pub fn stabbable_brute_force(portals: &[(Point2, Point2)]) -> Stab {
    if portals.is_empty() {
        return Stab::Open;
    }
    let ends: Vec<Point2> = portals.iter().flat_map(|&(left, right)| [left, right]).collect();
    let ends = scaled(&ends);
    // Up to 2^30, a form has coefficients below 2^62, a sum of 2^10 of them values below 2^105.
    match small(&ends, 1 << 30) {
        Some(ends) => decide(ends),
        None => decide(ends),
    }
}

/// `ends` holds left and right ends in turn.
fn decide<T: Int>(ends: Vec<[T; 2]>) -> Stab {
    let ends: Vec<Hp<T>> = ends.into_iter().map(Hp::new).collect();
    let Some(base) = ends.iter().find(|p| **p != ends[0]) else {
        // All ends are one point: every line through it obeys the closed conditions, none the open.
        return Stab::Grazing;
    };
    let base = Form::through(&ends[0], base);
    if ends.iter().all(|p| base.at(p).is_zero()) {
        return decide_collinear(&base, &ends);
    }
    let (lefts, rights): (Vec<_>, Vec<_>) = ends.chunks(2).map(|pair| (&pair[0], &pair[1])).unzip();
    let obeys = |f: &Form<T>, strict: i32| {
        lefts.iter().all(|p| f.at(p).sign() >= strict) && rights.iter().all(|p| -f.at(p).sign() >= strict)
    };
    let zero = || Form { a: T::zero(), b: T::zero(), c: T::zero() };
    let mut sum: Form<T> = zero();
    for p in &ends {
        for q in &ends {
            let f = Form::through(p, q);
            if p != q && obeys(&f, 0) {
                sum = Form { a: sum.a + f.a, b: sum.b + f.b, c: sum.c + f.c };
            }
        }
    }
    // A pointed cone holds no form together with its negative, so a sum of zero had no terms.
    if sum == zero() {
        Stab::None
    } else if obeys(&sum, 1) {
        Stab::Open
    } else {
        Stab::Grazing
    }
}

/// All ends lie on one line: it obeys the closed conditions itself, and a strict line cuts it in a
/// point that has all left ends on one side and all right ends on the other.
fn decide_collinear<T: Int>(base: &Form<T>, ends: &[Hp<T>]) -> Stab {
    let along = base.along();
    let at = |skip: usize| ends.iter().skip(skip).step_by(2).map(|p| along.at(p));
    let before = |first: usize, second: usize| at(first).max() < at(second).min();
    if before(0, 1) || before(1, 0) { Stab::Open } else { Stab::Grazing }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::corridor::{any_portals, corridor};
    use proptest::prelude::*;

    type Pair = (Point2, Point2);

    fn portal(lx: f64, ly: f64, rx: f64, ry: f64) -> Pair {
        (Point2::new(lx, ly), Point2::new(rx, ry))
    }

    #[test]
    fn stab_hand_made_cases() {
        let door = |x: f64, lo: f64, hi: f64| portal(x, hi, x, lo);
        let cases: [(&[Pair], Stab); 12] = [
            (&[], Stab::Open),
            (&[door(0., 0., 1.)], Stab::Open),
            (&[door(0., 0., 1.), door(1., 0., 1.)], Stab::Open),
            (&[door(0., 0., 1.), door(1., 5., 6.), door(2., 10., 11.)], Stab::Open),
            (&[door(0., 0., 1.), door(1., 5., 6.), door(2., 0., 1.)], Stab::None),
            // Only the line y = 1 passes all three, and touches all of them.
            (&[door(0., 0., 1.), door(1., 1., 2.), door(2., 0., 1.)], Stab::Grazing),
            // One oblique line touches four ends.
            (&[door(0., 0., 2.), door(1., 3., 9.), door(2., 0., 4.)], Stab::Grazing),
            // A shared left end is fine, a left end that is a right end is not.
            (&[portal(0., 1., 0., 0.), portal(0., 1., 1., 1.)], Stab::Open),
            (&[portal(0., 1., 0., 0.), portal(0., 0., 1., -1.)], Stab::Grazing),
            // Collinear portals, in one and in opposite directions.
            (&[portal(0., 3., 0., 1.), portal(0., 1., 0., 0.)], Stab::Grazing),
            (&[portal(0., 3., 0., 1.), portal(0., 2., 0., 1.)], Stab::Open),
            (&[portal(0., 0., 0., 1.), portal(0., 1., 0., 0.)], Stab::Grazing),
        ];
        for (i, (portals, expected)) in cases.iter().enumerate() {
            assert_eq!(stabbable_brute_force(portals), *expected, "case {i}");
        }
        let point = Point2::new(2., 2.);
        assert_eq!(stabbable_brute_force(&[(point, point)]), Stab::Grazing);
    }

    /// Big and tiny coordinates go the long way and get the same answers.
    #[test]
    fn stab_any_scale() {
        let at = |s: f64| [portal(0., s, 0., 0.), portal(s, 2. * s, s, s), portal(2. * s, s, 2. * s, 0.)];
        for s in [1.0, 1e150, 2f64.powi(-130), 0.1] {
            assert_eq!(stabbable_brute_force(&at(s)), Stab::Grazing, "{s}");
        }
        let mut pinhole = at(1.0);
        pinhole[1].1.y = f64::next_down(1.0);
        assert_eq!(stabbable_brute_force(&pinhole), Stab::Open);
        pinhole[1].1.y = f64::next_up(1.0);
        assert_eq!(stabbable_brute_force(&pinhole), Stab::None);
    }

    fn det(a: Point2, b: Point2, c: Point2) -> f64 {
        (a.x - c.x) * (b.y - c.y) - (a.y - c.y) * (b.x - c.x)
    }

    /// Another method, exact on small grids: two finite sets are strictly separable exactly if their
    /// hulls are disjoint, that is (Kirchberger) if no triangle of one holds a point of the other and
    /// no two segments meet. A separating line has the left ends on its left in one of its directions.
    fn hulls_are_disjoint(portals: &[Pair]) -> bool {
        let (lefts, rights): (Vec<Point2>, Vec<Point2>) = portals.iter().copied().unzip();
        let in_hull = |set: &[Point2], p: Point2| {
            set.iter().any(|&a| {
                set.iter().any(|&b| {
                    set.iter().any(|&c| {
                        let d = [det(a, b, p), det(b, c, p), det(c, a, p)];
                        let inside = d.iter().all(|&x| x >= 0.0) || d.iter().all(|&x| x <= 0.0);
                        inside && p.cmpge(a.min(b).min(c)).all() && p.cmple(a.max(b).max(c)).all()
                    })
                })
            })
        };
        let opposite = |x: f64, y: f64| (x < 0.0 && y > 0.0) || (x > 0.0 && y < 0.0);
        let cross = |a, b, c, d| opposite(det(a, b, c), det(a, b, d)) && opposite(det(c, d, a), det(c, d, b));
        let pairs =
            |set: &[Point2]| -> Vec<Pair> { set.iter().flat_map(|&a| set.iter().map(move |&b| (a, b))).collect() };
        let apart = !pairs(&lefts).iter().any(|&(a, b)| pairs(&rights).iter().any(|&(c, d)| cross(a, b, c, d)));
        apart && !rights.iter().any(|&p| in_hull(&lefts, p)) && !lefts.iter().any(|&p| in_hull(&rights, p))
    }

    /// A line of a dense grid that passes strictly (2) or in the closed sense (1).
    fn best_grid_line(portals: &[Pair]) -> i32 {
        let mut best = 0;
        for (a, b) in (-4..=4).flat_map(|a| (-4..=4).map(move |b| (a, b))).filter(|&ab| ab != (0, 0)) {
            for c in -60..=60 {
                let at = |p: Point2| f64::from(a) * p.x + f64::from(b) * p.y + 0.5 * f64::from(c);
                let least = portals.iter().map(|&(l, r)| at(l).min(-at(r))).fold(f64::INFINITY, f64::min);
                best = best.max(if least > 0.0 { 2 } else { i32::from(least == 0.0) });
            }
        }
        best
    }

    proptest! {
        #[test]
        fn stab_open_means_disjoint_hulls(portals in prop_oneof![any_portals(), corridor()]) {
            let open = stabbable_brute_force(&portals) == Stab::Open;
            prop_assert_eq!(open, hulls_are_disjoint(&portals), "{:?}", portals);
        }

        #[test]
        fn stab_finds_what_a_grid_of_lines_finds(portals in prop_oneof![any_portals(), corridor()]) {
            let found = stabbable_brute_force(&portals);
            match best_grid_line(&portals) {
                2 => prop_assert_eq!(found, Stab::Open),
                1 => prop_assert_ne!(found, Stab::None),
                _ => {}
            }
        }

        #[test]
        fn stab_is_symmetric(portals in prop_oneof![any_portals(), corridor()]) {
            let back: Vec<Pair> = portals.iter().rev().map(|&(l, r)| (r, l)).collect();
            prop_assert_eq!(stabbable_brute_force(&portals), stabbable_brute_force(&back));
        }
    }

    /// The impostors: taking closed for open, or judging neighbouring pairs only, is found out.
    #[test]
    fn stab_comparison_can_fail() {
        let mut wrong = [0; 2];
        for portals in crate::draw(&corridor(), 300) {
            let truth = hulls_are_disjoint(&portals);
            let closed = stabbable_brute_force(&portals) != Stab::None;
            let pairwise = portals.windows(2).all(|w| stabbable_brute_force(w) == Stab::Open);
            wrong[0] += i32::from(closed != truth);
            wrong[1] += i32::from(pairwise != truth);
        }
        assert!(wrong.iter().all(|&n| n > 5), "{wrong:?}");
    }
}
