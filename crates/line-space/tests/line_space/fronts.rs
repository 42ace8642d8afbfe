//! Triangles that hide from their fronts only, against segments that are decided triangle by triangle.

use proptest::prelude::*;
use sightlines_geometry::{Aabb, Point3, Random, orient3d};
use sightlines_line_space::{LineSpace, Outcome};
use sightlines_testkit::draw;
use sightlines_testkit::meshes::{Soup, boxes, quad, soup};

const BUDGET: u32 = 300;

/// A soup of which each triangle may hide from its front only, and may be turned round.
#[derive(Debug, Clone)]
pub(crate) struct Mixed {
    pub(crate) both_sides: Soup,
    pub(crate) fronts: Soup,
}

pub(crate) fn mixed() -> impl Strategy<Value = Mixed> {
    // One, some or all of them have one side; whole surfaces are turned alike, or each triangle as it comes.
    let sides = prop_oneof![Just(0u8), Just(3), any::<u8>()];
    let turns = prop_oneof![2 => Just(0u8), 2 => Just(255), 1 => any::<u8>()];
    (soup(), sides, turns).prop_map(|(soup, sides, turns)| {
        let (mut both_sides, mut fronts) = (Soup::new(), Soup::new());
        for (k, [a, b, c]) in soup.into_iter().enumerate() {
            let t = if turns >> (k % 8) & 1 == 0 { [a, b, c] } else { [a, c, b] };
            if sides >> (k / 4 % 8) & 1 == 1 { both_sides.push(t) } else { fronts.push(t) }
        }
        Mixed { both_sides, fronts }
    })
}

/// Squares of a lattice, of which up to four meet at an edge, each with both sides or one of two: chains close there whose triangles do not
/// agree.
pub(crate) fn lattice() -> impl Strategy<Value = Mixed> {
    let sides = || prop::collection::vec(0u8..8, 108);
    sides().prop_map(|sides| {
        let (mut both_sides, mut fronts) = (Soup::new(), Soup::new());
        let mut sides = sides.into_iter();
        for (axis, place) in (0..3).flat_map(|axis| (0..36).map(move |place| (axis, place))) {
            let corner = |u: i32, v: i32| {
                let mut p = [f64::from(place / 9); 3];
                p[(axis + 1) % 3] = f64::from(place % 3 + u);
                p[(axis + 2) % 3] = f64::from(place / 3 % 3 + v);
                p
            };
            let square = quad([corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)], false);
            match sides.next() {
                Some(0 | 1) => both_sides.extend(square),
                Some(2..5) => fronts.extend(square),
                Some(5..7) => fronts.extend(square.map(turn)),
                _ => {}
            }
        }
        Mixed { both_sides, fronts }
    })
}

/// The lower corner of a box in or around the lattice.
pub(crate) fn corner() -> impl Strategy<Value = Point3> {
    [-2i32..4, -2i32..4, -2i32..4].prop_map(|p| p.map(|x| f64::from(x) + 0.1))
}

fn turn([a, b, c]: [Point3; 3]) -> [Point3; 3] {
    [a, c, b]
}

/// Whether a segment certainly touches a triangle nowhere. Exact.
fn is_apart(p: Point3, q: Point3, &[a, b, c]: &[Point3; 3]) -> bool {
    let [from, to] = [p, q].map(|e| orient3d(a, b, c, e));
    if from * to > 0.0 {
        return true;
    }
    let turns = [[a, b], [b, c], [c, a]].map(|[x, y]| orient3d(p, q, x, y));
    turns.iter().any(|&s| s > 0.0) && turns.iter().any(|&s| s < 0.0)
}

impl Mixed {
    fn lines(&self) -> LineSpace {
        LineSpace::with_fronts(&self.both_sides, &self.fronts)
    }

    /// A segment from one box to another that meets nothing, but for what it passes from behind, out of `n`.
    pub(crate) fn free_segment(&self, v: &Aabb<3>, e: &Aabb<3>, seed: u64, n: u32) -> Option<[Point3; 2]> {
        let mut random = Random::new(seed);
        (0..n).map(|_| [random.point(v), random.point(e)]).find(|&[p, q]| {
            let passes = |t: &[Point3; 3]| orient3d(t[0], t[1], t[2], p) < 0.0 || is_apart(p, q, t);
            self.both_sides.iter().all(|t| is_apart(p, q, t)) && self.fronts.iter().all(passes)
        })
    }
}

proptest! {
    /// Invariant: no segment is free from an eye in one box to a point of another if the lines from the one to the other are reported blocked.
    #[test]
    fn nothing_that_is_seen_past_backs_is_hidden(
        mixed in mixed(),
        pairs in prop::collection::vec(boxes(), 8),
        seed in any::<u64>(),
    ) {
        let mut lines = mixed.lines();
        for [v, e] in &pairs {
            if lines.see_box(v, e, BUDGET) == Outcome::Hidden {
                let free = mixed.free_segment(v, e, seed, 200);
                prop_assert!(free.is_none(), "{:?} to {:?}: {:?}", v, e, free);
            }
        }
    }

    /// Invariant: the same where many faces meet.
    #[test]
    fn nothing_that_is_seen_past_backs_of_a_lattice_is_hidden(
        mixed in lattice(),
        pairs in prop::collection::vec((corner(), corner()), 8),
        seed in any::<u64>(),
    ) {
        let mut lines = mixed.lines();
        let unit = |p: Point3| Aabb { min: p, max: p.map(|x| x + 0.8) };
        for (v, e) in pairs.iter().map(|&(p, q)| (unit(p), unit(q))) {
            if lines.see_box(&v, &e, BUDGET) == Outcome::Hidden {
                let free = mixed.free_segment(&v, &e, seed, 500);
                prop_assert!(free.is_none(), "{:?} to {:?}: {:?}", v, e, free);
            }
        }
    }

    /// Invariant: two triangles at one place with opposite fronts hide as one that hides from both sides.
    #[test]
    fn opposite_fronts_are_both_sides(soup in soup(), pairs in prop::collection::vec(boxes(), 4)) {
        let back = soup.iter().map(|&[a, b, c]| [a, c, b]);
        let fronts: Soup = soup.iter().copied().chain(back).collect();
        let (mut twice, mut once) = (LineSpace::with_fronts(&[], &fronts), LineSpace::new(&soup));
        for [v, e] in &pairs {
            prop_assert_eq!(twice.see_box(v, e, 60) == Outcome::Hidden, once.see_box(v, e, 60) == Outcome::Hidden);
        }
    }
}

/// How many pairs no segment joins, how many are reported hidden, and how many are both reported hidden and joined, by lines through what `heard`
/// makes of the meshes.
fn judged(n: usize, heard: impl Fn(&Mixed) -> LineSpace) -> [usize; 3] {
    let mut counts = [0; 3];
    for (i, (mixed, pairs)) in draw(&(mixed(), prop::collection::vec(boxes(), 12)), n).iter().enumerate() {
        let mut lines = heard(mixed);
        for [v, e] in pairs {
            let hidden = lines.see_box(v, e, BUDGET) == Outcome::Hidden;
            let joined = mixed.free_segment(v, e, i as u64, 200).is_some();
            let all = [!joined, hidden, hidden && joined];
            all.iter().zip(&mut counts).for_each(|(&yes, n)| *n += usize::from(yes));
        }
    }
    counts
}

/// The tightness twin, and the impostor: surfaces that hide from both sides hide what is seen past backs.
#[test]
fn most_of_what_nobody_sees_is_hidden() {
    let [n_apart, n_hidden, n_wrong] = judged(200, Mixed::lines);
    eprintln!("{n_apart} pairs apart, {n_hidden} hidden");
    assert_eq!(n_wrong, 0);
    assert!(n_apart > 150 && n_hidden * 100 > n_apart * 55, "{n_apart} {n_hidden}");
    let all = |mixed: &Mixed| LineSpace::new(&[&mixed.both_sides[..], &mixed.fronts].concat());
    let n_wrong = judged(200, all)[2];
    assert!(n_wrong > 20, "{n_wrong}");
}

/// A wall on a floor, each with one side: a volume in front of both looks past neither, one behind the wall past the wall.
#[test]
fn walls_hide_from_the_front_and_on_floors() {
    let at = |x: f64, y: f64, z: f64| [x, y, z];
    let floor = quad([at(-20., -20., 0.), at(20., -20., 0.), at(20., 20., 0.), at(-20., 20., 0.)], false);
    // Its front is towards lower x.
    let wall = |x: f64| quad([at(x, -20., 0.), at(x, -20., 9.), at(x, 20., 9.), at(x, 20., 0.)], false);
    let unit = |x: f64| Aabb { min: [x, -1., 1.], max: [x + 2., 1., 2.] };
    let fronts: Soup = floor.iter().chain(&wall(5.)).chain(&wall(6.)).copied().collect();
    let mut lines = LineSpace::with_fronts(&[], &fronts);
    assert_eq!(lines.see_box(&unit(-4.), &unit(10.), BUDGET), Outcome::Hidden);
    assert_eq!(lines.see_box(&unit(10.), &unit(-4.), BUDGET), Outcome::Reached);
    // A box that reaches behind both: some of its eyes look past them.
    let across = Aabb { min: [-4., -1., 1.], max: [7., 1., 2.] };
    assert_ne!(lines.see_box(&across, &unit(10.), BUDGET), Outcome::Hidden);
    // Below the floor nothing is seen from above, and everything from below.
    let below = Aabb { min: [-4., -1., -3.], max: [-2., 1., -1.] };
    assert_eq!(lines.see_box(&unit(-4.), &below, BUDGET), Outcome::Hidden);
    assert_eq!(lines.see_box(&below, &unit(-4.), BUDGET), Outcome::Reached);
}

/// A screen of flat pieces around half of a target. No volume before it is in front of all pieces: what blocks is the screen as a whole, from
/// outside only.
#[test]
fn bent_screens_hide_from_volumes_that_reach_behind_their_pieces() {
    let n = 8;
    let at = |i: i32, z: f64| {
        let angle = std::f64::consts::PI * f64::from(i) / f64::from(n);
        [-6.0 * angle.sin(), 6.0 * angle.cos(), z]
    };
    let pieces = |i: i32| quad([at(i, -20.0), at(i, 20.0), at(i + 1, 20.0), at(i + 1, -20.0)], false);
    let screen = |turned: bool| -> Soup { (0..n).flat_map(pieces).map(|t| if turned { turn(t) } else { t }).collect() };
    let volume = Aabb { min: [-9.0, -5.0, 0.0], max: [-8.0, 5.0, 1.0] };
    let target = Aabb { min: [-1.0, -1.0, 0.0], max: [0.0, 1.0, 1.0] };
    let outcomes = [false, true].map(|turned| {
        let fronts = screen(turned);
        let behind_some = fronts.iter().any(|t| volume.corners().iter().any(|&p| orient3d(t[0], t[1], t[2], p) < 0.0));
        assert!(behind_some);
        LineSpace::with_fronts(&[], &fronts).see_box(&volume, &target, BUDGET)
    });
    assert!(outcomes.contains(&Outcome::Hidden) && outcomes.contains(&Outcome::Reached), "{outcomes:?}");
    // The same from within: blocked by the other screen.
    for (turned, outcome) in [false, true].into_iter().zip(outcomes) {
        let inside = LineSpace::with_fronts(&[], &screen(turned)).see_box(&target, &volume, BUDGET);
        assert_ne!(inside, outcome);
    }
    // A piece that is turned round lets lines pass.
    let hiding = screen(outcomes[1] == Outcome::Hidden);
    let gap: Soup = hiding.iter().enumerate().map(|(k, &t)| if k / 2 == 3 { turn(t) } else { t }).collect();
    assert_eq!(LineSpace::with_fronts(&[], &gap).see_box(&volume, &target, BUDGET), Outcome::Reached);
    // With the pieces before it, it hides again.
    let both: Soup = hiding.into_iter().chain(gap).collect();
    assert_eq!(LineSpace::with_fronts(&[], &both).see_box(&volume, &target, BUDGET), Outcome::Hidden);
}
