//! Triangles that hide from their fronts only, against segments that are decided triangle by triangle.

use proptest::prelude::*;
use sightlines_geometry::{Aabb, Point3, orient3d};
use sightlines_line_space::{LineSpace, Outcome};
use sightlines_testkit::draw;
use sightlines_testkit::fronts::{Mixed, corner, lattice, mixed, turn};
use sightlines_testkit::meshes::{Soup, boxes, quad, soup};

const BUDGET: u32 = 300;

fn lines(mixed: &Mixed) -> LineSpace {
    LineSpace::with_fronts(&mixed.both_sides, &mixed.fronts)
}

proptest! {
    /// Invariant: no segment is free from an eye in one box to a point of another if the lines from the one to the other are reported blocked.
    #[test]
    fn nothing_that_is_seen_past_backs_is_hidden(
        mixed in mixed(),
        pairs in prop::collection::vec(boxes(), 8),
        seed in any::<u64>(),
    ) {
        let mut lines = lines(&mixed);
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
        let mut lines = lines(&mixed);
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
    let [n_apart, n_hidden, n_wrong] = judged(200, lines);
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
