//! Oracle: what does a point in a plan see?
//!
//! Method: turn a ray about the eye. What it meets changes only where it passes the end of a wall or a corner of a
//! region, so one ray in the middle between each two neighbouring of these directions tells everything, and a ray
//! in each of the directions themselves what is only touched. No cells, portals or cones are known here.
//!
//! Exact: coordinates become integers, places on a ray are compared as fractions.

use crate::exact::{scaled, small};
use sightlines_cells::Plan;
use sightlines_geometry::Point2;
use std::cmp::Ordering;
use std::collections::BTreeSet;

/// No coordinate is above this in magnitude, so that products of four differences fit 128 bits.
const BOUND: i128 = 1 << 27;

type V = [i128; 2];

/// An open range of directions between which nothing changes.
#[derive(Debug, Clone, PartialEq)]
pub struct EyeSector {
    /// Where it begins and ends, in radians from the first axis, counter-clockwise; the end is above the beginning.
    pub angles: [f64; 2],
    /// A direction within, not of length 1.
    pub middle: [f64; 2],
    /// The regions that a ray passes through inside before it meets a wall, ascending.
    pub seen: Vec<u32>,
}

/// A direction in which things change.
#[derive(Debug, Clone, PartialEq)]
pub struct EyeTouch {
    /// Radians from the first axis.
    pub angle: f64,
    /// The regions that a ray meets, borders included, before it meets the inside of a wall or a corner that two walls
    /// make across it, ascending.
    pub touched: Vec<u32>,
}

/// All that a point sees.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct EyeFan {
    /// Counter-clockwise; together with the directions between them a full turn.
    pub sectors: Vec<EyeSector>,
    /// The directions between the sectors.
    pub touches: Vec<EyeTouch>,
}

/// Angles nearer to each other than this count as equal, radians; where that matters, either answer is taken.
const NEAR: f64 = 1e-9;

impl EyeFan {
    /// What is seen through an open set of directions that are clearly within `fov / 2` of `centre` (radians).
    pub fn seen(&self, centre: f64, fov: f64) -> BTreeSet<u32> {
        let seen = |s: &&EyeSector| overlap(s.angles, centre, fov) > NEAR;
        self.sectors.iter().filter(seen).flat_map(|s| s.seen.iter().copied()).collect()
    }

    /// What is seen or touched in any direction within `fov / 2` of `centre` or nearly so.
    pub fn touched(&self, centre: f64, fov: f64) -> BTreeSet<u32> {
        let sectors = self.sectors.iter().filter(|s| overlap(s.angles, centre, fov) > -NEAR).map(|s| &s.seen);
        let touches = self.touches.iter().filter(|t| overlap([t.angle, t.angle], centre, fov) > -NEAR);
        sectors.chain(touches.map(|t| &t.touched)).flatten().copied().collect()
    }
}

/// How far two ranges of directions overlap, or minus how far they are apart; a full turn overlaps all.
fn overlap(angles: [f64; 2], centre: f64, fov: f64) -> f64 {
    use std::f64::consts::TAU;
    if fov >= TAU {
        return TAU;
    }
    let [from, to] = angles;
    let turns = (-2..=2).map(|k| centre + f64::from(k) * TAU);
    turns.map(|c| to.min(c + 0.5 * fov) - from.max(c - 0.5 * fov)).fold(f64::NEG_INFINITY, f64::max)
}

/// What `eye` sees of `regions` in `plan`, with `closed` (segments) in the way as well; `None` if coordinates need
/// more digits than this works with: some 27 bits, counted in the finest fraction that occurs.
///
/// * `regions`: convex polygons, counter-clockwise, with an area; of any number, overlapping or not.
///
/// A wall that the eye is on does not hinder it. Exact where walls do not cross regions. O(n log n + n (walls +
/// corners)) for n different directions of wall ends and corners.
pub fn eye_fan(plan: &Plan, closed: &[[Point2; 2]], regions: &[Vec<Point2>], eye: Point2) -> Option<EyeFan> {
    let opaque = plan.lines().iter().filter(|l| l.opaque).map(|l| [l.a, l.b]);
    let walls: Vec<[Point2; 2]> = opaque.chain(closed.iter().copied()).collect();
    let mut points: Vec<Point2> = vec![eye];
    points.extend(walls.iter().flatten());
    points.extend(regions.iter().flatten());
    let points = small(&scaled(&points), BOUND)?;
    let (eye, rest) = points.split_first()?;
    let mut rest = rest.iter().map(|&p| minus(p, *eye));
    let walls: Vec<[V; 2]> = walls.iter().filter_map(|_| Some([rest.next()?, rest.next()?])).collect();
    let regions: Vec<Vec<V>> = regions.iter().map(|r| rest.by_ref().take(r.len()).collect()).collect();
    Some(Around { walls, regions }.turn())
}

fn minus(a: V, b: V) -> V {
    [a[0] - b[0], a[1] - b[1]]
}

fn cross(a: V, b: V) -> i128 {
    a[0] * b[1] - a[1] * b[0]
}

fn dot(a: V, b: V) -> i128 {
    a[0] * b[0] + a[1] * b[1]
}

/// By angle from the first axis, within a turn.
fn by_angle(a: &V, b: &V) -> Ordering {
    let lower = |v: &V| v[1] < 0 || (v[1] == 0 && v[0] < 0);
    lower(a).cmp(&lower(b)).then_with(|| 0.cmp(&cross(*a, *b)))
}

fn angle(v: V) -> f64 {
    (v[1] as f64).atan2(v[0] as f64)
}

/// A place on a ray: multiples of the direction, as a fraction with a positive denominator.
#[derive(Debug, Clone, Copy)]
struct Place(i128, i128);

impl Place {
    fn of(numerator: i128, denominator: i128) -> Self {
        if denominator < 0 { Self(-numerator, -denominator) } else { Self(numerator, denominator) }
    }

    fn cmp(self, other: Self) -> Ordering {
        (self.0 * other.1).cmp(&(other.0 * self.1))
    }
}

/// Everything as seen from the eye, which is at the origin.
struct Around {
    walls: Vec<[V; 2]>,
    regions: Vec<Vec<V>>,
}

impl Around {
    fn turn(&self) -> EyeFan {
        let points = self.walls.iter().flatten().chain(self.regions.iter().flatten());
        let mut directions: Vec<V> = points.copied().filter(|p| *p != [0, 0]).map(reduced).collect();
        directions.sort_by(by_angle);
        directions.dedup();
        let sector = |(k, &from): (usize, &V)| {
            let to = directions[(k + 1) % directions.len()];
            let middle = between(from, to);
            let start = angle(from);
            let width = (angle(to) - start).rem_euclid(std::f64::consts::TAU);
            let width = if directions.len() == 1 { std::f64::consts::TAU } else { width };
            let middle_of = [middle[0] as f64, middle[1] as f64];
            EyeSector { angles: [start, start + width], middle: middle_of, seen: self.seen(middle) }
        };
        let touch = |&d: &V| EyeTouch { angle: angle(d), touched: self.touched(d) };
        EyeFan {
            sectors: directions.iter().enumerate().map(sector).collect(),
            touches: directions.iter().map(touch).collect(),
        }
    }

    /// The regions that a ray passes through that goes through no wall's end and no corner.
    fn seen(&self, d: V) -> Vec<u32> {
        let hits = self.walls.iter().filter_map(|&[a, b]| {
            let (before, after) = (cross(d, a), cross(d, b));
            let place = Place::of(cross(a, minus(b, a)), cross(d, minus(b, a)));
            (before.signum() * after.signum() < 0 && place.0 > 0).then_some(place)
        });
        let end = hits.min_by(|a, b| a.cmp(*b));
        self.met(d, |from, to| {
            let to = end.map_or(to, |end| Some(to.map_or(end, |to| min(to, end))));
            to.is_none_or(|to| from.cmp(to) == Ordering::Less)
        })
    }

    /// The regions that a ray touches before it is stopped.
    fn touched(&self, d: V) -> Vec<u32> {
        let mut end: Option<Place> = None;
        let stop = |at: Place, end: &mut Option<Place>| {
            if at.0 > 0 && end.is_none_or(|e| at.cmp(e) == Ordering::Less) {
                *end = Some(at);
            }
        };
        // Where walls end on the ray, and whether they come from its left.
        let mut ends: Vec<(Place, bool)> = Vec::new();
        for &[a, b] in &self.walls {
            match [a, b].map(|p| cross(d, p).signum()) {
                [0, 0] => {}
                [0, side] => ends.push((Place(dot(a, d), dot(d, d)), side > 0)),
                [side, 0] => ends.push((Place(dot(b, d), dot(d, d)), side > 0)),
                [s, t] if s == t => {}
                _ => stop(Place::of(cross(a, minus(b, a)), cross(d, minus(b, a))), &mut end),
            }
        }
        for &(at, left) in &ends {
            if ends.iter().any(|&(other, side)| side != left && other.cmp(at) == Ordering::Equal) {
                stop(at, &mut end);
            }
        }
        self.met(d, |from, to| {
            let reached = end.is_none_or(|end| from.cmp(end) != Ordering::Greater);
            reached && to.is_none_or(|to| from.cmp(to) != Ordering::Greater)
        })
    }

    /// The regions for which the range of the ray that is within all their sides is accepted.
    fn met(&self, d: V, accept: impl Fn(Place, Option<Place>) -> bool) -> Vec<u32> {
        let met = |region: &[V]| range(region, d).is_some_and(|(from, to)| accept(from, to));
        (0..).zip(&self.regions).filter(|(_, region)| met(region)).map(|(id, _)| id).collect()
    }
}

/// Where the ray from the origin along `d` is within all sides of a region; `None` if it is beside one all along.
fn range(region: &[V], d: V) -> Option<(Place, Option<Place>)> {
    let (mut from, mut to) = (Place(0, 1), None::<Place>);
    for (k, &a) in region.iter().enumerate() {
        let side = minus(region[(k + 1) % region.len()], a);
        // Inside: cross(side, t d - a) >= 0.
        let (slope, start) = (cross(side, d), -cross(side, a));
        match slope.signum() {
            0 if start < 0 => return None,
            0 => {}
            1 => from = max(from, Place(-start, slope)),
            _ => to = Some(to.map_or(Place(start, -slope), |to| min(to, Place(start, -slope)))),
        }
    }
    to.is_none_or(|to| to.0 >= 0).then_some((from, to))
}

fn max(a: Place, b: Place) -> Place {
    if a.cmp(b) == Ordering::Less { b } else { a }
}

fn min(a: Place, b: Place) -> Place {
    if a.cmp(b) == Ordering::Greater { b } else { a }
}

/// The same direction in lowest terms.
fn reduced(v: V) -> V {
    let mut pair = [v[0].abs(), v[1].abs()];
    while pair[1] != 0 {
        pair = [pair[1], pair[0] % pair[1]];
    }
    v.map(|x| x / pair[0])
}

/// A direction strictly between two, counter-clockwise from the first to the second, which may be a full turn away.
fn between(from: V, to: V) -> V {
    let turned = [-from[1], from[0]];
    match (cross(from, to).signum(), dot(from, to).signum()) {
        (1, _) => [from[0] + to[0], from[1] + to[1]],
        (0, -1) => turned,
        (0, _) => from.map(|x| -x),
        _ => [-from[0] - to[0], -from[1] - to[1]],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{draw, sees_brute_force, small_grid_plan};
    use std::f64::consts::{PI, TAU};

    fn p(x: f64, y: f64) -> Point2 {
        Point2::new(x, y)
    }

    fn square(x: f64, y: f64) -> Vec<Point2> {
        vec![p(x, y), p(x + 1.0, y), p(x + 1.0, y + 1.0), p(x, y + 1.0)]
    }

    /// A wall at x = 2 with a door from y = 0 to 1; squares before, behind the door, and behind the wall.
    fn fan(eye: Point2, closed: &[[Point2; 2]]) -> EyeFan {
        let plan = Plan::from_walls([(p(2.0, 1.0), p(2.0, 4.0)), (p(2.0, 0.0), p(2.0, -3.0))]).unwrap();
        let regions = [square(0.0, 0.0), square(3.0, 0.0), square(3.0, 2.0), square(5.0, 2.0)];
        eye_fan(&plan, closed, &regions, eye).unwrap()
    }

    fn list(set: BTreeSet<u32>) -> Vec<u32> {
        set.into_iter().collect()
    }

    #[test]
    fn what_is_seen_through_a_door() {
        let from = |eye| list(fan(eye, &[]).seen(0.0, TAU));
        // The steepest rays through the door rise by 1/3, by 2/3, by 2 to 4.
        assert_eq!(from(p(0.5, 0.5)), [0, 1, 3]);
        assert_eq!(from(p(1.25, 0.5)), [0, 1, 2, 3]);
        assert_eq!(from(p(1.5, -1.0)), [0, 2]);
        // On the wall's line, behind the wall's end, in the wall itself.
        assert_eq!(from(p(2.0, 0.5)), [0, 1, 2, 3]);
        assert_eq!(from(p(2.0, 2.0)), [0, 1, 2, 3]);
        let door = [p(2.0, 0.0), p(2.0, 1.0)];
        assert_eq!(list(fan(p(1.0, 0.5), &[door]).seen(0.0, TAU)), [0]);
        // Only forwards; only back; a hair's breadth about the way to the third square.
        let fan = fan(p(1.25, 0.5), &[]);
        assert_eq!(list(fan.seen(0.0, 0.5 * PI)), [1, 2, 3]);
        assert_eq!(list(fan.seen(PI, 0.5 * PI)), [0]);
        assert_eq!(list(fan.seen((2.0f64 / 3.0).atan() - 1e-4, 1e-6)), [2, 3]);
    }

    #[test]
    fn what_is_only_touched() {
        // From here the steepest ray through the door goes through a corner of the third square.
        let fan = fan(p(0.0, 0.0), &[]);
        assert!(!fan.seen(0.0, TAU).contains(&2) && fan.touched(0.0, TAU).contains(&2));
        let plan = Plan::from_walls([(p(2.0, 1.0), p(2.0, 9.0)), (p(4.0, 2.0), p(4.0, -9.0))]).unwrap();
        let behind = [square(6.0, 3.0)];
        let fan = eye_fan(&plan, &[], &behind, p(0.0, 0.0)).unwrap();
        assert_eq!((list(fan.seen(0.0, TAU)), list(fan.touched(0.0, TAU))), (vec![], vec![0]));
        // The same gap as a corner that is shut.
        let plan = Plan::from_walls([(p(2.0, 1.0), p(2.0, 9.0)), (p(2.0, 1.0), p(4.0, -9.0))]).unwrap();
        let fan = eye_fan(&plan, &[], &behind, p(0.0, 0.0)).unwrap();
        assert!(fan.touched(0.0, TAU).is_empty());
    }

    #[test]
    fn sectors_are_a_full_turn() {
        let fan = fan(p(0.5, 0.25), &[]);
        let sum: f64 = fan.sectors.iter().map(|s| s.angles[1] - s.angles[0]).sum();
        assert!((sum - TAU).abs() < 1e-12 && fan.sectors.len() == fan.touches.len());
        assert!(fan.sectors.iter().all(|s| s.angles[0] < s.angles[1]));
        let nothing = eye_fan(&Plan::default(), &[], &[], p(0.0, 0.0)).unwrap();
        assert_eq!(nothing, EyeFan::default());
        assert_eq!(eye_fan(&Plan::default(), &[[p(0.0, 0.0), p(1.0, 1e-30)]], &[], p(1.0, 0.0)), None);
    }

    #[test]
    fn directions_in_between() {
        for (from, to, middle) in
            [([1, 0], [0, 1], [1, 1]), ([1, 0], [-1, 0], [0, 1]), ([0, 1], [1, 0], [-1, -1]), ([1, 0], [1, 0], [-1, 0])]
        {
            assert_eq!(between(from, to), middle);
        }
    }

    /// What a point in a region sees, the region sees, says another oracle; and many points together see all that the
    /// region sees, or nearly.
    #[test]
    fn points_see_no_more_than_regions() {
        let (mut n_seen, mut n_hidden, mut n_found) = (0, 0, 0);
        for plan in draw(&small_grid_plan(2..7), 40) {
            let regions = [[0.0, 0.0], [5.0, 6.0], [3.0, 3.0], [7.0, 1.0]].map(|[x, y]| square(x, y));
            // Without walls across the regions.
            let inner = |i: i32| f64::from(2 * i + 1) / 16.0;
            let eyes = (0..8).flat_map(|i| (0..8).map(move |j| p(inner(i), inner(j))));
            let mut found = BTreeSet::new();
            for eye in eyes {
                found.extend(eye_fan(&plan, &[], &regions, eye).unwrap().seen(0.0, TAU));
            }
            for (k, region) in (1..).zip(&regions[1..]) {
                let sees = sees_brute_force(&plan, &regions[0], region);
                assert!(sees || !found.contains(&k), "{plan:?}: {k}");
                n_seen += usize::from(sees);
                n_found += usize::from(found.contains(&k));
                n_hidden += usize::from(!sees);
            }
        }
        assert!(n_hidden > 20 && n_found > 30 && n_found + 8 > n_seen, "{n_hidden} {n_found} of {n_seen}");
    }
}
