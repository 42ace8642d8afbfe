//! Oracle: every combination of ways past all rectangles, in fractions; and what the tests draw.
//!
//! Method: in each octant, one way past each rectangle is chosen, for all rectangles at once and in the
//! order in which they are given, whether lines meet them or not; each combination is a linear program
//! that [`exact::decide`] solves in fractions. No lines are followed, nothing is done in doubles, and which
//! rectangle is in the way of what plays no part. Combinations that begin with ways that exclude each
//! other already are not written out.

use super::super::super::exact::{self, Exact};
use super::super::super::rows::Row;
use super::super::super::witness::AxialWitness;
use super::super::{BoxTarget, ShaftLine};
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{Signed, Zero};
use proptest::prelude::*;
use sightlines_geometry::Aabb;

/// Two boxes, and what stands between and around them.
#[derive(Debug, Clone)]
pub(super) struct Case {
    pub(super) from: Aabb<3>,
    pub(super) to: Aabb<3>,
    pub(super) target: BoxTarget,
    pub(super) rectangles: Vec<Aabb<3>>,
    /// Rectangles that hide from one side, and whether their fronts face larger coordinates.
    pub(super) one_way: Vec<(Aabb<3>, bool)>,
}

/// Where a box begins and ends on an axis, in a given direction.
fn first_last(b: &Aabb<3>, forward: [bool; 3], axis: usize) -> (f64, f64) {
    if forward[axis] { (b.min[axis], b.max[axis]) } else { (b.max[axis], b.min[axis]) }
}

fn ahead(forward: bool, x: f64, y: f64) -> bool {
    if forward { x < y } else { y < x }
}

/// The rows of lines that have a part in a box.
fn through(b: &Aabb<3>, forward: [bool; 3]) -> Vec<Row> {
    let mut rows = Vec::new();
    for early in 0..3 {
        for late in (0..3).filter(|&late| late != early) {
            let (from, to) = (first_last(b, forward, early).0, first_last(b, forward, late).1);
            rows.push(Row { early, late, from, to });
        }
    }
    rows
}

/// Whether a line reaches one coordinate before another, as a row demands.
fn obeys(line: &AxialWitness, row: &Row) -> bool {
    let time = |axis: usize, x: f64| (fraction(x) - &line.point()[axis]) / &line.direction()[axis];
    time(row.early, row.from) < time(row.late, row.to)
}

fn fraction(x: f64) -> BigRational {
    BigRational::from_float(x).expect("coordinates are finite")
}

impl Case {
    /// The ways past a rectangle: six, less those that cannot be.
    fn ways(&self, rectangle: &Aabb<3>, forward: [bool; 3]) -> Vec<Vec<Row>> {
        let axis = (0..3).find(|&k| rectangle.min[k] == rectangle.max[k]).expect("a rectangle is flat");
        let at = rectangle.min[axis];
        let others: Vec<usize> = (0..3).filter(|&k| k != axis).collect();
        let mut ways = Vec::new();
        for &k in &others {
            let (first, last) = first_last(rectangle, forward, k);
            ways.push(vec![Row { early: axis, late: k, from: at, to: first }]);
            ways.push(vec![Row { early: k, late: axis, from: last, to: at }]);
        }
        if ahead(forward[axis], at, first_last(&self.from, forward, axis).1) {
            let row = |&k: &usize| Row { early: axis, late: k, from: at, to: first_last(&self.from, forward, k).1 };
            ways.push(others.iter().map(row).collect());
        }
        let entry = first_last(&self.to, forward, axis).0;
        if ahead(forward[axis], entry, at) || (self.target == BoxTarget::Surface && entry == at) {
            let row = |&k: &usize| Row { early: k, late: axis, from: first_last(&self.to, forward, k).0, to: at };
            ways.push(others.iter().map(row).collect());
        }
        ways
    }

    /// Whether an open set of lines leads from box to box.
    pub(super) fn is_open(&self) -> bool {
        (0..8u8).any(|octant| {
            let forward = [0, 1, 2].map(|axis| octant & (1 << axis) != 0);
            let leads =
                |k: usize| ahead(forward[k], first_last(&self.from, forward, k).0, first_last(&self.to, forward, k).1);
            let mut rows = through(&self.from, forward);
            rows.extend(through(&self.to, forward));
            (0..3).all(leads) && self.some_combination(octant, forward, &mut rows, &self.stopping(forward), None)
        })
    }

    /// The rectangles that stop lines in a direction.
    fn stopping(&self, forward: [bool; 3]) -> Vec<Aabb<3>> {
        let faces_them = |(rectangle, front_up): &&(Aabb<3>, bool)| {
            (0..3).any(|k| rectangle.min[k] == rectangle.max[k] && *front_up != forward[k])
        };
        let one_way = self.one_way.iter().filter(faces_them).map(|(rectangle, _)| *rectangle);
        self.rectangles.iter().copied().chain(one_way).collect()
    }

    /// Whether lines obey the rows, of which `known` is one that obeys all but the last few, and go past all
    /// of some rectangles.
    fn some_combination(
        &self,
        octant: u8,
        forward: [bool; 3],
        rows: &mut Vec<Row>,
        rest: &[Aabb<3>],
        known: Option<&AxialWitness>,
    ) -> bool {
        let found;
        let line = match known.filter(|line| rows.iter().all(|row| obeys(line, row))) {
            Some(line) => line,
            None => match exact::decide(rows, octant, &[]) {
                Exact::Open(line) => {
                    found = line;
                    &found
                }
                Exact::Blocked(_) => return false,
            },
        };
        let Some((rectangle, rest)) = rest.split_first() else { return true };
        self.ways(rectangle, forward).into_iter().any(|way| {
            let n = rows.len();
            rows.extend(way);
            let open = self.some_combination(octant, forward, rows, rest, Some(line));
            rows.truncate(n);
            open
        })
    }

    /// Whether a line leads from box to box past all rectangles: its times at coordinates, in fractions.
    pub(super) fn is_free(&self, line: &ShaftLine) -> bool {
        let line = line.witness();
        let (p, d) = (line.point(), line.direction());
        if d.iter().any(Zero::is_zero) {
            return false;
        }
        let time = |k: usize, x: f64| (fraction(x) - &p[k]) / &d[k];
        // When it enters and leaves the extents of a box.
        let times = |b: &Aabb<3>| {
            let times = |k: usize| [time(k, b.min[k]), time(k, b.max[k])];
            let times = [0, 1, 2].map(times).map(|[a, b]| if a < b { [a, b] } else { [b, a] });
            let inside = (0..3).all(|i| (0..3).all(|j| i == j || times[i][0] < times[j][1]));
            let enter = times.iter().map(|t| t[0].clone()).max().expect("three axes");
            let leave = times.iter().map(|t| t[1].clone()).min().expect("three axes");
            inside.then_some([enter, leave])
        };
        let (Some([_, leave]), Some([enter, _])) = (times(&self.from), times(&self.to)) else { return false };
        let meets = |r: &Aabb<3>| {
            let axis = (0..3).find(|&k| r.min[k] == r.max[k]).expect("a rectangle is flat");
            let t = time(axis, r.min[axis]);
            let within = |k: usize| {
                let x = &p[k] + &t * &d[k];
                fraction(r.min[k]) <= x && x <= fraction(r.max[k])
            };
            (0..3).all(|k| k == axis || within(k))
                && leave <= t
                && (t < enter || (t == enter && self.target == BoxTarget::Inside))
        };
        leave <= enter && !self.stopping([0, 1, 2].map(|k| d[k].is_positive())).iter().any(meets)
    }

    /// The same elsewhere: scaled by the size of `factor` on each axis, mirrored where it is negative, moved.
    pub(super) fn placed(&self, factor: [f64; 3], by: [f64; 3]) -> Self {
        let place = |b: &Aabb<3>| {
            let [p, q] = [b.min, b.max].map(|p| [0, 1, 2].map(|k| p[k] * factor[k] + by[k]));
            Aabb { min: [0, 1, 2].map(|k| p[k].min(q[k])), max: [0, 1, 2].map(|k| p[k].max(q[k])) }
        };
        let (from, to) = (place(&self.from), place(&self.to));
        let turned = |(rectangle, front_up): &(Aabb<3>, bool)| {
            let axis = (0..3).find(|&k| rectangle.min[k] == rectangle.max[k]).expect("a rectangle is flat");
            (place(rectangle), *front_up == (factor[axis] > 0.0))
        };
        let one_way = self.one_way.iter().map(turned).collect();
        Self { from, to, target: self.target, rectangles: self.rectangles.iter().map(place).collect(), one_way }
    }

    /// The same from the second box to the first.
    pub(super) fn reversed(&self) -> Self {
        Self { from: self.to, to: self.from, ..self.clone() }
    }

    /// The same with some rectangles that hide from one side, and the side of each.
    pub(super) fn with_sides(mut self, sides: &[Option<bool>]) -> Self {
        let all = std::mem::take(&mut self.rectangles);
        for (rectangle, side) in all.into_iter().zip(sides.iter().cycle()) {
            match side {
                Some(front_up) => self.one_way.push((rectangle, *front_up)),
                None => self.rectangles.push(rectangle),
            }
        }
        self
    }

    /// The same without one of the rectangles.
    pub(super) fn without(&self, rectangle: usize) -> Self {
        let mut case = self.clone();
        case.rectangles.remove(rectangle);
        case
    }
}

/// Beyond what lines between boxes of the grid reach next to them; large walls go that far.
const FAR: f64 = 20.0;

/// A range of the grid, of some length.
fn range(low: i32, high: i32) -> impl Strategy<Value = [f64; 2]> {
    (low..high, low..high).prop_map(|(a, b)| [f64::from(a.min(b)), f64::from(a.max(b) + 1)])
}

fn boxed(extents: [[f64; 2]; 3]) -> Aabb<3> {
    Aabb { min: extents.map(|e| e[0]), max: extents.map(|e| e[1]) }
}

/// Rectangles mostly across the way, mostly so large that they are missed by one edge at most.
fn rectangle() -> impl Strategy<Value = Aabb<3>> {
    let axis = prop_oneof![3 => Just(0usize), 1 => Just(1), 1 => Just(2)];
    let half = (0..7, any::<bool>()).prop_map(|(x, low)| if low { [-FAR, f64::from(x)] } else { [f64::from(x), FAR] });
    let extent = || prop_oneof![2 => range(0, 7), 2 => half.clone(), 3 => Just([-FAR, FAR])];
    (axis, 0..9, [extent(), extent(), extent()]).prop_map(|(axis, at, mut extents)| {
        extents[axis] = [f64::from(at); 2];
        boxed(extents)
    })
}

/// Two rectangles across the way that leave a slit, or nothing, between them.
fn slit() -> impl Strategy<Value = Vec<Aabb<3>>> {
    (2..7, any::<bool>(), 0..6, 0..3).prop_map(|(at, upright, low, gap)| {
        let sides = [[-FAR, f64::from(low)], [f64::from(low + gap), FAR]];
        let (plane, whole) = ([f64::from(at); 2], [-FAR, FAR]);
        sides.map(|side| boxed(if upright { [plane, side, whole] } else { [plane, whole, side] })).to_vec()
    })
}

/// Boxes on a small grid, one after the other along some axis, and up to five rectangles. On some axes the second box
/// is flat if the target is its surface.
pub(super) fn any_case() -> impl Strategy<Value = Case> {
    let from = (range(0, 3), range(1, 5), range(1, 5)).prop_map(|(x, y, z)| boxed([x, y, z]));
    let to = (range(3, 8), range(1, 5), range(1, 5)).prop_map(|(x, y, z)| boxed([x, y, z]));
    let flat = (any::<bool>(), 0..3usize, any::<bool>());
    let slits =
        (slit(), slit(), prop::option::of(rectangle())).prop_map(|(a, b, c)| [a, b, c.into_iter().collect()].concat());
    let rectangles = prop_oneof![1 => prop::collection::vec(rectangle(), 0..5), 2 => slits];
    (from, to, flat, rectangles, 0..3usize).prop_map(|(from, mut to, (surface, axis, flat), rectangles, turn)| {
        if surface && flat {
            to.max[axis] = to.min[axis];
        }
        let target = if surface { BoxTarget::Surface } else { BoxTarget::Inside };
        let turned = |b: &Aabb<3>| {
            let turned = |p: [f64; 3]| [0, 1, 2].map(|k| p[(k + turn) % 3]);
            Aabb { min: turned(b.min), max: turned(b.max) }
        };
        let rectangles = rectangles.iter().map(turned).collect();
        Case { from: turned(&from), to: turned(&to), target, rectangles, one_way: Vec::new() }
    })
}

/// Factors and moves that change no answer in exact arithmetic; most are not exact in doubles.
pub(super) fn any_place() -> impl Strategy<Value = ([f64; 3], [f64; 3])> {
    let factor = prop::sample::select(vec![1.0, -1.0, 0.1, -0.3, 4.0, -1e-3]);
    let by = prop::sample::select(vec![0.0, 0.7, 1e7, -1e7]);
    (prop::array::uniform3(factor), prop::array::uniform3(by))
}

/// Moves some sides of rectangles by one unit in the last place, so that gaps of that width open and close.
pub(super) fn nudged(mut case: Case, nudges: &[i8]) -> Case {
    for (rectangle, nudge) in case.rectangles.iter_mut().zip(nudges) {
        let side = nudge.unsigned_abs() as usize / 2 % 3;
        if rectangle.min[side] == rectangle.max[side] || nudge % 4 == 0 {
            continue;
        }
        let x = if nudge % 2 == 0 { &mut rectangle.max[side] } else { &mut rectangle.min[side] };
        // Next to zero lies no coordinate that is accepted.
        *x = if *x == 0.0 {
            0.0
        } else if *nudge > 0 {
            x.next_up()
        } else {
            x.next_down()
        };
    }
    case
}

/// A multiplier a little larger.
pub(super) fn more(weight: &BigInt) -> BigInt {
    debug_assert!(weight.is_positive());
    weight + 1
}
