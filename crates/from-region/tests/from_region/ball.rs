//! What a ball reaches, against balls whose middles move on whole numbers among walls along axes: distances are whole numbers then. What such a
//! ball touches, ours touches.

use crate::common::block;
use proptest::prelude::*;
use sightlines_from_region::BallReach;
use sightlines_geometry::{Aabb, Point3};
use sightlines_testkit::meshes::{quad, solid};

type P = [i32; 3];
/// A closed box, flat as a rule.
type Wall = [P; 2];

/// Rooms along each axis, and walls across each.
const ROOMS: [usize; 3] = [2, 2, 1];
const N_WALLS: [usize; 3] = [6, 6, 8];

/// Side of a room.
const ROOM: i32 = 9;

/// How far around the rooms the middle of a ball may be.
const AROUND: i32 = 3;
const HIGH: P = [2 * ROOM, 2 * ROOM, ROOM];

/// Walls of four rooms, some with a slit along an edge, some missing.
#[derive(Debug, Clone)]
struct Rooms {
    walls: Vec<Wall>,
    gap: i32,
    /// Where the eyes are: at a place, or outside.
    eye: Option<P>,
    targets: Vec<[P; 3]>,
    scale: f64,
    shift: f64,
}

fn squared(a: &Wall, b: &Wall) -> i32 {
    let apart = |k: usize| (a[0][k] - b[1][k]).max(b[0][k] - a[1][k]).max(0);
    (0..3).map(|k| apart(k) * apart(k)).sum()
}

impl Rooms {
    /// Whether a ball may be with its middle at all points of a box.
    fn has_room(&self, at: &Wall, gap: i32) -> bool {
        self.walls.iter().all(|wall| 4 * squared(at, wall) >= gap * gap)
    }

    /// The middles on whole numbers that a ball of this diameter reaches by moves along axes.
    fn reached(&self, gap: i32) -> Vec<P> {
        let size = HIGH.map(|x| x + 2 * AROUND + 1);
        let place = |p: P| p.iter().zip(size).fold(0, |i, (x, n)| i * n + x + AROUND) as usize;
        let n: i32 = size.iter().product();
        let all = || (0..n).map(|i| [i / (size[1] * size[2]), i / size[2] % size[1], i % size[2]].map(|x| x - AROUND));
        let is_there = |p: &P| (0..3).all(|k| (-AROUND..=HIGH[k] + AROUND).contains(&p[k]));
        let is_border = |p: &P| (0..3).any(|k| p[k] == -AROUND || p[k] == HIGH[k] + AROUND);
        let touches = |p: P, eye: P| 4 * squared(&[p, p], &[eye, eye]) <= gap * gap;
        let is_start = |p: &P| match self.eye {
            None => is_border(p),
            Some(eye) => touches(*p, eye),
        };
        let mut pending: Vec<P> = all().filter(is_start).filter(|p| self.has_room(&[*p, *p], gap)).collect();
        let mut is_reached = vec![false; n as usize];
        let mut found = Vec::new();
        while let Some(p) = pending.pop() {
            if std::mem::replace(&mut is_reached[place(p)], true) {
                continue;
            }
            found.push(p);
            for (axis, step) in (0..3).flat_map(|axis| [(axis, -1), (axis, 1)]) {
                let mut q = p;
                q[axis] += step;
                let way = [0, 1, 2].map(|k| [p[k].min(q[k]), p[k].max(q[k])]);
                if is_there(&q) && !is_reached[place(q)] && self.has_room(&[way.map(|w| w[0]), way.map(|w| w[1])], gap)
                {
                    pending.push(q);
                }
            }
        }
        found
    }

    fn at(&self, p: P) -> Point3 {
        p.map(|x| f64::from(x) * self.scale + self.shift)
    }

    fn ball(&self) -> BallReach {
        let walls = self.walls.iter().flat_map(|[low, high]| solid(self.at(*low), self.at(*high)));
        let bounds = block(self.at([0; 3]), self.at(HIGH));
        let eye = self.eye.map(|eye| [block(self.at(eye), self.at(eye))]);
        BallReach::new(walls, &bounds, f64::from(self.gap) * self.scale, eye.as_ref().map(|eye| &eye[..]))
            .expect("few voxels")
    }

    /// Whether a ball that reaches these middles touches a corner of a target.
    fn touches(reached: &[P], gap: i32, target: &[P; 3]) -> bool {
        reached.iter().any(|p| target.iter().any(|q| 4 * squared(&[*p, *p], &[*q, *q]) <= gap * gap))
    }

    /// How many targets a ball touches, and how many ours does not; and one that is missed.
    fn judge(&self, ball: &BallReach) -> (usize, usize, Option<[P; 3]>) {
        let reached = self.reached(self.gap);
        let (mut n_touched, mut n_hidden, mut missed) = (0, 0, None);
        for target in &self.targets {
            let is_touched = Self::touches(&reached, self.gap, target);
            let is_found = ball.touches(&target.map(|p| self.at(p)));
            n_touched += usize::from(is_touched);
            n_hidden += usize::from(!is_found);
            if is_touched && !is_found {
                missed = Some(*target);
            }
        }
        (n_touched, n_hidden, missed)
    }
}

fn rooms() -> impl Strategy<Value = Rooms> {
    // Of each wall whether it is there, and how wide its slit is.
    let walls =
        prop::collection::vec(prop_oneof![24 => Just(0), 2 => 1..5, 1 => Just(ROOM)], N_WALLS.iter().sum::<usize>());
    let point = || (0..=HIGH[0], 0..=HIGH[1], 0..=HIGH[2]).prop_map(|(x, y, z)| [x, y, z]);
    let targets =
        prop::collection::vec(prop_oneof![3 => point().prop_map(|p| [p; 3]), 1 => prop::array::uniform3(point())], 12);
    let place = prop_oneof![3 => Just((1.0, 0.0)), 1 => Just((0.1, 100.0)), 1 => Just((1e-6, -1.0))];
    (walls, 2i32..6, prop::option::of(point()), targets, place).prop_map(
        |(slits, gap, eye, targets, (scale, shift))| {
            let place = |axis: usize, i: usize| -> P {
                let n = [0, 1, 2].map(|k| ROOMS[k] + usize::from(k == axis));
                [i / (n[1] * n[2]), i / n[2] % n[1], i % n[2]].map(|x| x as i32 * ROOM)
            };
            let places = (0..3).flat_map(|axis| (0..N_WALLS[axis]).map(move |i| (axis, place(axis, i))));
            let wall = |((axis, low), slit): ((usize, P), &i32)| {
                let mut high = low.map(|x| x + ROOM);
                high[axis] = low[axis];
                high[(axis + 1) % 3] -= slit;
                (*slit < ROOM).then_some([low, high])
            };
            let walls = places.zip(&slits).filter_map(wall).collect();
            Rooms { walls, gap, eye, targets, scale, shift }
        },
    )
}

proptest! {
    /// Invariant: what a ball touches on its way from the eyes is touched by ours.
    #[test]
    fn what_a_ball_touches_is_touched(of in rooms()) {
        let (_, _, missed) = of.judge(&of.ball());
        prop_assert!(missed.is_none(), "{missed:?}");
    }
}

/// The twin: most of what is far from all that balls of a quarter of the gap reach is not touched by ours.
#[test]
fn what_no_small_ball_touches_is_not_touched() {
    let (mut n_far, mut n_found, mut n_touched, mut n_hidden) = (0, 0, 0, 0);
    for of in sightlines_testkit::draw(&rooms(), 160) {
        let ball = of.ball();
        let (touched, hidden, missed) = of.judge(&ball);
        assert_eq!(missed, None);
        (n_touched, n_hidden) = (n_touched + touched, n_hidden + hidden);
        // What is two voxels from a reached one is nearer than four units.
        let is_coarse = (3..5).contains(&of.gap) && of.scale == 1.0 && of.eye.is_none();
        for target in of.targets.iter().filter(|[p, q, _]| is_coarse && p == q) {
            let is_far = !Rooms::touches(&of.reached(1), 8, target);
            n_far += usize::from(is_far);
            n_found += usize::from(is_far && !ball.touches(&target.map(|p| of.at(p))));
        }
    }
    assert!(n_touched > 100 && n_hidden > 100, "{n_touched} touched, {n_hidden} hidden");
    assert!(n_far >= 3 && n_found * 2 > n_far, "{n_found} of {n_far}");
}

/// The comparison notices slits that are overlooked.
#[test]
fn impostor_slits_that_are_overlooked_are_noticed() {
    let whole = |[low, high]: &Wall| {
        let axis = (0..3).find(|&k| low[k] == high[k]).expect("a wall is flat");
        let mut high = low.map(|x| x + ROOM);
        high[axis] = low[axis];
        [*low, high]
    };
    let misses = |of: &Rooms| {
        let closed = Rooms { walls: of.walls.iter().map(whole).collect(), ..of.clone() };
        of.judge(&closed.ball()).2.is_some()
    };
    let n = sightlines_testkit::draw(&rooms(), 100).iter().filter(|of| misses(of)).count();
    assert!(n >= 3, "{n}");
}

/// Six boards around a room, the lid so far above the others; and what is in the room.
fn housing(slit: f64, shift: f64) -> (Vec<[Point3; 3]>, Aabb<3>, [Point3; 3]) {
    let at = |p: Point3| p.map(|x| x + shift);
    let boards = [
        ([0.0; 3], [8.0, 1.0, 8.0]),
        ([0.0, 1.0, 0.0], [1.0, 8.0, 8.0]),
        ([7.0, 1.0, 0.0], [8.0, 8.0, 8.0]),
        ([1.0, 1.0, 0.0], [7.0, 8.0, 1.0]),
        ([1.0, 1.0, 7.0], [7.0, 8.0, 8.0]),
    ];
    let mut walls: Vec<_> = boards.into_iter().flat_map(|(min, max)| solid(at(min), at(max))).collect();
    let lid = 8.0 + shift + slit;
    walls.extend(solid([shift, lid, shift], [8.0 + shift, lid + 1.0, 8.0 + shift]));
    let bounds = Aabb::around(walls.iter().flatten().copied());
    (walls, bounds, [[3.0, 4.0, 3.0], [5.0, 4.0, 3.0], [3.0, 5.0, 5.0]].map(at))
}

/// A slit as wide as the gap, or a unit in the last place wider, is open; one of a sixth of it is closed.
#[test]
fn a_slit_as_wide_as_the_gap_is_open() {
    for (gap, shift) in [(0.25, 0.0), (0.3, 0.0), (0.25, 1024.0), (1.0, -3.0), (0.7, 1.0 / 3.0)] {
        let shows = |slit: f64| {
            let (walls, bounds, thing) = housing(slit, shift);
            BallReach::new(walls, &bounds, gap, None).expect("few voxels").touches(&thing)
        };
        // As wide as the difference of the coordinates really is.
        let lid = 8.0 + shift;
        let open = (lid + gap).next_up() - lid;
        assert!(shows(open) && shows(open + gap / 8.0) && shows(gap.next_up()) && open >= gap, "{gap} {shift}");
        assert!(!shows(gap / 6.0) && !shows(0.0), "{gap} {shift}");
    }
}

/// A wall across the first axis, with a square hole.
fn pierced(x: f64, size: f64, hole: Option<[f64; 4]>) -> Vec<[Point3; 3]> {
    let rect = |y0: f64, z0: f64, y1: f64, z1: f64| quad([[x, y0, z0], [x, y1, z0], [x, y1, z1], [x, y0, z1]], false);
    let Some([y0, z0, y1, z1]) = hole else { return rect(0.0, 0.0, size, size).to_vec() };
    let parts = [[0.0, 0.0, size, z0], [0.0, z1, size, size], [0.0, z0, y0, z1], [y1, z0, size, z1]];
    parts.into_iter().flat_map(|[a, b, c, d]| rect(a, b, c, d)).collect()
}

/// A tube of four rooms in a row, each wall between with a hole or none: the ball goes as far as holes are wide enough. So it does through a pipe that joins two
/// voids one in the other, and through a keyhole that is seen from straight ahead only.
#[test]
fn a_ball_goes_through_pipes_and_keyholes_that_are_wide_enough() {
    let hole = |width: f64| Some([3.0, 3.0, 3.0 + width, 3.0 + width]);
    let reached = |holes: [Option<[f64; 4]>; 4], gap: f64, eyes: Option<&[Aabb<3>]>| -> Vec<bool> {
        let mut walls: Vec<[Point3; 3]> =
            holes.iter().enumerate().flat_map(|(k, hole)| pierced(4.0 * k as f64, 8.0, *hole)).collect();
        walls.extend(pierced(16.0, 8.0, None));
        let tube = solid([0.0; 3], [16.0, 8.0, 8.0]);
        walls.extend(tube.into_iter().filter(|t| t.iter().any(|p| p[0] != t[0][0])));
        let bounds = Aabb::around(walls.iter().flatten().copied());
        let ball = BallReach::new(walls, &bounds, gap, eyes).expect("few voxels");
        let thing = |k: usize| {
            [[4.0 * k as f64 + 2.0, 1.0, 1.0], [4.0 * k as f64 + 2.0, 2.0, 1.5], [4.0 * k as f64 + 2.5, 1.0, 2.0]]
        };
        (0..4).map(|k| ball.touches(&thing(k))).collect()
    };
    let wide = hole(1.0);
    assert_eq!(reached([wide, wide, None, wide], 1.0, None), [true, true, false, false]);
    assert_eq!(reached([None, wide, wide, None], 1.0, None), [false; 4]);
    assert_eq!(reached([wide, hole(0.15), wide, wide], 1.0, None), [true, false, false, false]);
    // Of two voids that are joined to each other, eyes in one see the other.
    let eyes = [block([5.0; 3], [5.5; 3])];
    assert_eq!(reached([None, wide, wide, None], 1.0, Some(&eyes)), [true, true, true, false]);
    assert_eq!(reached([None, wide, hole(0.15), None], 1.0, Some(&eyes)), [true, true, false, false]);
}

/// What touches the hull from inside is not touched from outside, where the hull is thicker than a voxel; a flat one does not keep the ball off it.
#[test]
fn what_touches_the_hull_is_not_touched_through_it() {
    let (walls, bounds, _) = housing(0.0, 0.0);
    let ball = |gap: f64| BallReach::new(walls.iter().copied(), &bounds, gap, None).expect("few voxels");
    let on = |y: f64| [[3.0, y, 3.0], [5.0, y, 3.0], [3.0, y, 5.0]];
    assert!(!ball(0.5).touches(&on(1.0)) && ball(0.5).touches(&on(0.0)));
    assert!(ball(0.5).touches(&on(9.0)), "the top of the lid");
    let hull = solid([0.0; 3], [8.0; 3]);
    let bounds = block([0.0; 3], [8.0; 3]);
    let flat = BallReach::new(hull, &bounds, 0.5, None).expect("few voxels");
    assert!(flat.touches(&on(0.0)) && !flat.touches(&on(1.0)));
}
