//! Oracle: does one convex region of a plan see another?
//!
//! Method: walls and segments are closed and the regions are taken without their boundary, so if one
//! segment from region to region avoids all walls, all segments near it do; one of them avoids all
//! corners and wall ends too, and its line is of one of the kinds of the module `candidates`. Along such
//! a line each region is an interval. The answer is the same for all lines of a kind: walls cut the
//! line between the two intervals or they do not, and that can change only where the line passes a
//! wall end, a corner, or a point where a wall crosses a side of a region. Those points are given too.

use crate::candidates::{SMALL, for_each_kind};
use crate::exact::{Form, Hp, Int, Place, crossing, scaled, small};
use sightlines_cells::Plan;
use sightlines_geometry::{Point2, is_convex_ccw};

/// Whether an open set of segments from the inside of `polygon_a` to the inside of `polygon_b` avoids
/// all opaque walls of `plan`, their ends included. Lines that are not opaque are ignored.
///
/// * `polygon_a`, `polygon_b`: corners of convex polygons, counter-clockwise. They may overlap (then
///   they see each other: walls have no area) and walls may run through them.
///
/// Exact. Cost O(n^2 (n + walls)) for n wall ends and corners: a few milliseconds for 12 walls on a
/// grid of 256 steps where no wall crosses a polygon, and some ten times that elsewhere.
///
/// # Panics
/// If a polygon is not convex and counter-clockwise.
pub fn sees_brute_force(plan: &Plan, polygon_a: &[Point2], polygon_b: &[Point2]) -> bool {
    assert!(is_convex_ccw(polygon_a), "the first polygon is convex and counter-clockwise");
    assert!(is_convex_ccw(polygon_b), "the second polygon is convex and counter-clockwise");
    let walls = plan.lines().iter().filter(|l| l.opaque).flat_map(|l| [l.a, l.b]);
    let points: Vec<Point2> = polygon_a.iter().chain(polygon_b).copied().chain(walls).collect();
    let points = scaled(&points);
    let (n, m) = (polygon_a.len(), polygon_b.len());
    // Points where walls cross sides are fractions, too large for the bounds of `candidates`.
    let quick = small(&points, SMALL).map(|p| Scene::new(p, n, m)).filter(|s| s.given.len() == s.n_plain);
    quick.map_or_else(|| Scene::new(points, n, m).sees(), |s| s.sees())
}

struct Scene<T> {
    a: Vec<Hp<T>>,
    b: Vec<Hp<T>>,
    walls: Vec<[Hp<T>; 2]>,
    /// Distinct corners, wall ends and crossings of walls with sides.
    given: Vec<Hp<T>>,
    /// How many of them are corners or wall ends.
    n_plain: usize,
}

/// The sides of a polygon.
fn sides<T>(polygon: &[Hp<T>]) -> impl Iterator<Item = (&Hp<T>, &Hp<T>)> {
    polygon.iter().zip(polygon.iter().cycle().skip(1))
}

impl<T: Int> Scene<T> {
    /// The first `n` points are one polygon, the next `m` the other, then come wall ends in pairs.
    fn new(points: Vec<[T; 2]>, n: usize, m: usize) -> Self {
        let points: Vec<Hp<T>> = points.into_iter().map(Hp::new).collect();
        let (a, b) = (points[..n].to_vec(), points[n..n + m].to_vec());
        let walls: Vec<[Hp<T>; 2]> = points[n + m..].chunks(2).map(|ends| [ends[0].clone(), ends[1].clone()]).collect();
        let mut given = points;
        given.sort_unstable();
        given.dedup();
        let n_plain = given.len();
        for (p, q) in sides(&a).chain(sides(&b)) {
            given.extend(walls.iter().filter_map(|[u, v]| proper_crossing(p, q, u, v)));
        }
        given.sort_unstable();
        given.dedup();
        Self { a, b, walls, given, n_plain }
    }

    fn sees(&self) -> bool {
        if self.overlap() {
            return true;
        }
        let mut seen = false;
        for_each_kind(&self.given, |line| seen = seen || self.sees_along(line));
        seen
    }

    /// Whether the insides of the polygons meet: no side of either has the other beyond it.
    fn overlap(&self) -> bool {
        let apart =
            |p: &[Hp<T>], q: &[Hp<T>]| sides(p).any(|(s, t)| q.iter().all(|c| Form::through(s, t).at(c).sign() <= 0));
        !apart(&self.a, &self.b) && !apart(&self.b, &self.a)
    }

    fn sees_along(&self, line: &Form<T>) -> bool {
        let along = line.along();
        let interval = |polygon: &[Hp<T>]| {
            let mut places = sides(polygon).filter_map(|(p, q)| crossing(line, &along, p, q)).map(|(place, _)| place);
            let (s, t) = (places.next()?, places.next()?);
            Some(if s < t { [s, t] } else { [t, s] })
        };
        let (Some(a), Some(b)) = (interval(&self.a), interval(&self.b)) else { return false };
        let [from, to]: [&Place<T>; 2] = if a[1] <= b[0] { [&a[1], &b[0]] } else { [&b[1], &a[0]] };
        !self
            .walls
            .iter()
            .any(|[u, v]| crossing(line, &along, u, v).is_some_and(|(wall, _)| from <= &wall && &wall <= to))
    }
}

/// The point where two segments cross inside both.
pub(crate) fn proper_crossing<T: Int>(p: &Hp<T>, q: &Hp<T>, u: &Hp<T>, v: &Hp<T>) -> Option<Hp<T>> {
    let (line, wall) = (Form::through(p, q), Form::through(u, v));
    let (at_u, at_v) = (line.at(u), line.at(v));
    let cross = at_u.sign() * at_v.sign() < 0 && wall.at(p).sign() * wall.at(q).sign() < 0;
    cross.then(|| Hp::mean(u, &at_v.abs(), v, &at_u.abs()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plans::{convex_polygon, small_grid_plan};
    use crate::sampled::chord_is_clear;
    use proptest::prelude::*;

    fn p(x: f64, y: f64) -> Point2 {
        Point2::new(x, y)
    }

    fn square(x: f64, y: f64, side: f64) -> Vec<Point2> {
        vec![p(x, y), p(x + side, y), p(x + side, y + side), p(x, y + side)]
    }

    fn plan(walls: &[(Point2, Point2)]) -> Plan {
        Plan::from_walls(walls.iter().copied()).unwrap()
    }

    #[test]
    fn sees_hand_made_cases() {
        let (a, b) = (square(0., 0., 2.), square(8., 0., 2.));
        let sees = |walls: &[(Point2, Point2)]| sees_brute_force(&plan(walls), &a, &b);
        assert!(sees(&[]));
        assert!(!sees(&[(p(5., 0.), p(5., 2.))]), "a wall across the whole channel");
        assert!(sees(&[(p(5., 0.), p(5., 1.5))]));
        let gap = |lo: f64, hi: f64| [(p(5., -9.), p(5., lo)), (p(5., hi), p(5., 9.))];
        assert!(sees(&gap(1., f64::next_up(1.))) && !sees(&gap(1., 1.)), "a door of zero width");
        assert!(!sees(&gap(3., 4.)) && sees(&gap(-0.125, 0.125)), "doors beside and at the channel's rim");
        // Two staggered walls that only a graze gets past.
        assert!(!sees(&[(p(4., -9.), p(4., 1.)), (p(6., 1.), p(6., 9.)), (p(4., 1.), p(6., 1.))]));
        assert!(sees(&[(p(4., -9.), p(4., 1.)), (p(6., 1.), p(6., 9.))]), "past both, downwards");
        // Doors that are open each, but in no common line.
        let zigzag = [
            gap(0., 0.25).map(|(u, v)| (u - p(2., 0.), v - p(2., 0.))),
            gap(1.75, 2.),
            gap(0., 0.25).map(|(u, v)| (u + p(2., 0.), v + p(2., 0.))),
        ]
        .concat();
        assert!(!sees(&zigzag));
    }

    #[test]
    fn sees_with_walls_inside_and_on_the_regions() {
        let (a, b) = (square(0., 0., 2.), square(2., 0., 2.));
        let sees = |walls: &[(Point2, Point2)]| sees_brute_force(&plan(walls), &a, &b);
        assert!(sees(&[]) && sees_brute_force(&plan(&[(p(2., 0.), p(2., 2.))]), &a, &square(1., 1., 2.)));
        assert!(!sees(&[(p(2., 0.), p(2., 2.))]), "a wall along the shared side");
        assert!(sees(&[(p(2., 0.), p(2., 1.)), (p(1., -1.), p(1., 3.)), (p(3., -1.), p(3., 3.))]));
        assert!(!sees(&[(p(2., -1.), p(2., 3.)), (p(1., 1.), p(3., 1.))]));
        // Walls that cross on the shared side leave gaps between them there.
        assert!(sees(&[(p(1., 0.), p(3., 2.)), (p(1., 2.), p(3., 0.))]));
    }

    /// Any scale gives the same answer: the long way agrees with the quick one.
    #[test]
    fn sees_any_scale() {
        for s in [1.0, 1e50, 0.3, 2f64.powi(-120)] {
            let (a, b) = (square(0., 0., 2. * s), square(8. * s, 0., 2. * s));
            let walls = |hi: f64| [(p(5. * s, -s), p(5. * s, s)), (p(5. * s, hi), p(5. * s, 3. * s))];
            assert!(!sees_brute_force(&plan(&walls(s)), &a, &b));
            assert!(sees_brute_force(&plan(&walls(f64::next_up(s))), &a, &b));
        }
    }

    /// Points strictly inside a convex polygon: means of its corners with positive weights.
    fn inside(polygon: &[Point2], weights: &[u32]) -> Point2 {
        let weights = weights.iter().map(|&w| f64::from(w + 1));
        let sum: f64 = weights.clone().take(polygon.len()).sum();
        polygon.iter().zip(weights).map(|(&c, w)| c * w).sum::<Point2>() / sum
    }

    fn case() -> impl Strategy<Value = (Plan, Vec<Point2>, Vec<Point2>)> {
        (small_grid_plan(2..=9), convex_polygon(), convex_polygon())
    }

    proptest! {
        /// Lower bound: a clear chord from inside to inside is found.
        #[test]
        fn sees_whatever_chords_see(
            (plan, a, b) in case(), weights in prop::collection::vec(prop::collection::vec(0u32..9, 12), 20),
        ) {
            let chord = |w: &Vec<u32>| (inside(&a, &w[..6]), inside(&b, &w[6..]));
            let found = weights.iter().map(chord).find(|&(from, to)| chord_is_clear(&plan, from, to));
            if let Some(chord) = found {
                prop_assert!(sees_brute_force(&plan, &a, &b), "{:?}", chord);
            }
        }

        #[test]
        fn sees_is_symmetric((plan, a, b) in case()) {
            prop_assert_eq!(sees_brute_force(&plan, &a, &b), sees_brute_force(&plan, &b, &a));
        }

        /// Upper bound: a ring of walls around one region hides it from everything outside.
        #[test]
        fn sees_nothing_through_a_ring((plan, a, b) in case()) {
            let ring = a.iter().zip(a.iter().cycle().skip(1)).map(|(&u, &v)| (u, v));
            let walls = plan.lines().iter().map(|l| (l.a, l.b)).chain(ring);
            let walled = Plan::from_walls(walls).unwrap();
            let apart = !sees_brute_force(&walled, &a, &b);
            prop_assert_eq!(apart, !Scene::new(scaled(&[&a[..], &b].concat()), a.len(), b.len()).overlap());
        }
    }

    proptest! {
        /// Both ways: rooms in a row, one door in each wall, see each other from end to end exactly if
        /// a line passes all doors, which the other oracle decides.
        #[test]
        fn sees_rooms_in_a_row_as_their_doors_are_stabbed(
            doors in prop::collection::vec((0i32..7, 0i32..7), 2..5),
        ) {
            let n = f64::from(u32::try_from(doors.len()).unwrap());
            let mut walls = vec![(p(0., 0.), p(n + 1., 0.)), (p(0., 8.), p(n + 1., 8.))];
            let mut portals = Vec::new();
            for (x, &(from, length)) in (1..).map(f64::from).zip(&doors) {
                let (low, high) = (f64::from(from), f64::from(from + 1 + length % (8 - from)));
                let pieces = [(p(x, 0.), p(x, low)), (p(x, high), p(x, 8.))];
                walls.extend(pieces.into_iter().filter(|(a, b)| a != b));
                portals.push((p(x, high), p(x, low)));
            }
            let room = |x: f64| vec![p(x, 0.), p(x + 1., 0.), p(x + 1., 8.), p(x, 8.)];
            let open = crate::stabbable_brute_force(&portals) == crate::Stab::Open;
            prop_assert_eq!(sees_brute_force(&plan(&walls), &room(0.), &room(n)), open);
        }
    }

    /// The impostors: a few chords miss what is there, and chords between boundaries that graze see
    /// too much; both answers are common in the cases drawn.
    #[test]
    fn sees_comparison_can_fail() {
        let (mut missed, mut seen) = (0, 0);
        for (plan, a, b) in crate::draw(&case(), 200) {
            let one_chord = chord_is_clear(&plan, inside(&a, &[0; 6]), inside(&b, &[0; 6]));
            let truth = sees_brute_force(&plan, &a, &b);
            seen += i32::from(truth);
            missed += i32::from(truth && !one_chord);
        }
        assert!((20..190).contains(&seen) && missed > 5, "{seen} seen, {missed} missed");
    }
}
