//! Scenes whose answer is known.

use sightlines_geometry::{Aabb, Point3};
use sightlines_line_space::{Effort, LineSpace, Outcome, Surface};
use sightlines_testkit::meshes::{Soup, quad, solid};
use std::sync::Arc;

const BUDGET: u32 = 1000;

fn cube(middle: Point3, half: f64) -> Aabb<3> {
    Aabb { min: middle.map(|x| x - half), max: middle.map(|x| x + half) }
}

fn see(soup: &Soup, v: &Aabb<3>, e: &Aabb<3>) -> Outcome {
    LineSpace::new(soup).see_box(v, e, BUDGET)
}

/// A quarter turn about z by 36.87 degrees: cosine 0.8 and sine 0.6.
fn turned(soup: Soup) -> Soup {
    soup.into_iter().map(|t| t.map(|[x, y, z]| [0.8 * x - 0.6 * y, 0.6 * x + 0.8 * y, z])).collect()
}

#[test]
fn a_wall_hides_what_is_behind_it_from_all_sides() {
    for soup in [solid([4., -20., -20.], [5., 20., 20.]), turned(solid([4., -20., -20.], [5., 20., 20.]))] {
        let (near, far) = (cube([0.; 3], 1.0), cube([9., 0., 0.], 1.0));
        assert_eq!((see(&soup, &near, &far), see(&soup, &far, &near)), (Outcome::Hidden, Outcome::Hidden));
        assert_eq!(see(&soup, &near, &cube([-8., 0., 0.], 1.0)), Outcome::Reached);
        assert_eq!(see(&soup, &near, &cube([9., 0., 60.], 1.0)), Outcome::Reached, "over the top");
        assert_eq!(see(&soup, &near, &near), Outcome::Undecided, "boxes that meet");
    }
}

/// Neither of two walls hides the target alone, and they do not touch: one is in front, the other behind, and they overlap as seen.
#[test]
fn walls_that_do_not_touch_hide_together() {
    let two = |overlap: f64| {
        let mut soup = solid([3., -20., -20.], [3.5, overlap, 20.]);
        soup.extend(solid([6., -overlap, -20.], [6.5, 20., 20.]));
        soup
    };
    let (v, e) = (cube([0.; 3], 0.5), cube([9.5, 0., 0.], 0.5));
    assert_eq!(see(&two(2.0), &v, &e), Outcome::Hidden);
    assert_eq!(see(&turned(two(2.0)), &cube([0.; 3], 0.4), &cube([7.6, 5.7, 0.], 0.4)), Outcome::Hidden);
    assert_eq!(see(&two(-0.5), &v, &e), Outcome::Reached, "a gap between them");
}

#[test]
fn eyes_on_the_wall_see_nothing_through_it() {
    // The view cell is a room, up to its walls.
    let room = solid([0.; 3], [8., 6., 3.]);
    let (v, e) = (Aabb { min: [0.; 3], max: [8., 6., 3.] }, cube([12., 3., 1.], 1.0));
    assert_eq!(see(&room, &v, &e), Outcome::Hidden);
    let mut door = room.clone();
    door.retain(|t| t.iter().any(|p| p[0] != 8.0));
    assert_eq!(see(&door, &v, &e), Outcome::Reached, "without the wall between");
    // A target that touches the only wall is not hidden by it, but by a second one in front.
    let touching = cube([9., 3., 1.], 1.0);
    assert_ne!(see(&room, &cube([4., 3., 1.], 0.5), &touching), Outcome::Hidden);
    let mut double = room;
    double.extend(quad([[7., 0., 0.], [7., 6., 0.], [7., 6., 3.], [7., 0., 3.]], false));
    assert_eq!(see(&double, &cube([4., 3., 1.], 0.5), &touching), Outcome::Hidden);
}

/// A triangle that stands on the blocker's plane, or shares an edge with it, is hidden by it from behind.
#[test]
fn triangles_that_touch_what_hides_them() {
    let soup = solid([4., -9., -9.], [5., 9., 9.]);
    let mut lines = LineSpace::new(&soup);
    let v = cube([0.; 3], 1.0);
    let on_back = [[5., -1., -1.], [5., 1., -1.], [5., 0., 1.]];
    let on_front = on_back.map(|[_, y, z]| [4., y, z]);
    let standing = [[5., -1., -1.], [5., 1., -1.], [8., 0., -1.]];
    assert_eq!(lines.see_triangle(&v, on_back, BUDGET), Outcome::Hidden, "the front hides the back");
    assert_eq!(lines.see_triangle(&v, standing, BUDGET), Outcome::Hidden);
    assert_ne!(lines.see_triangle(&v, on_front, BUDGET), Outcome::Hidden);
    // One sheet: what stands on it behind is hidden, though it touches.
    let sheet: Soup = quad([[5., -9., -9.], [5., 9., -9.], [5., 9., 9.], [5., -9., 9.]], false).into();
    let mut lines = LineSpace::new(&sheet);
    assert_eq!(lines.see_triangle(&v, standing, BUDGET), Outcome::Hidden);
    assert_ne!(lines.see_triangle(&v, on_back, BUDGET), Outcome::Hidden, "it may be in front");
}

#[test]
fn effort_is_kept_and_more_of_it_finds_more() {
    // A fence of posts before another one that closes its gaps: many chains.
    let post = |x: f64, i: i32| solid([x, f64::from(2 * i), -50.], [x + 0.5, f64::from(2 * i) + 1.3, 50.]);
    let fence: Soup = (-20..20)
        .flat_map(|i| [post(5., i), post(6., i).into_iter().map(|t| t.map(|[x, y, z]| [x, y + 1., z])).collect()])
        .flatten()
        .collect();
    let surface = Arc::new(Surface::new(&fence));
    let (v, e) = (cube([0.; 3], 2.0), cube([12., 0., 0.], 2.0));
    let mut lines = LineSpace::shared(Arc::clone(&surface), Effort::default());
    assert_eq!(lines.see_box(&v, &e, 1), Outcome::Undecided);
    assert_eq!(lines.n_cells(), 1);
    let mut short = LineSpace::shared(surface, Effort { longest_chain: 1, ..Effort::default() });
    assert_eq!(lines.see_box(&v, &e, 10_000), Outcome::Hidden);
    short.see_box(&v, &e, 10_000);
    assert!(short.n_cells() > lines.n_cells(), "{} {}", short.n_cells(), lines.n_cells());
}

/// A flat volume that lies in a wall has no inside: who is there may look either way.
#[test]
fn flat_volumes_in_a_wall_see_both_ways() {
    let sheet: Soup = quad([[5., -9., -9.], [5., 9., -9.], [5., 9., 9.], [5., -9., 9.]], false).into();
    let flat = Aabb { min: [5., -1., -1.], max: [5., 1., 1.] };
    let thick = Aabb { min: [4., -1., -1.], max: [5., 1., 1.] };
    let [front, back] = [cube([0.; 3], 1.0), cube([9., 0., 0.], 1.0)];
    assert_eq!([see(&sheet, &flat, &front), see(&sheet, &flat, &back)].map(|o| o == Outcome::Hidden), [false; 2]);
    assert_eq!((see(&sheet, &thick, &front), see(&sheet, &thick, &back)), (Outcome::Reached, Outcome::Hidden));
}

#[test]
fn boxes_and_points_without_area_are_decided_too() {
    let soup = solid([4., -20., -20.], [5., 20., 20.]);
    let point = |x: f64| Aabb::around([[x, 0.1, 0.2]]);
    let line = Aabb { min: [9., 0., 0.], max: [9., 2., 0.] };
    assert_eq!(see(&soup, &point(0.), &point(9.)), Outcome::Hidden);
    assert_eq!(see(&soup, &point(0.), &line), Outcome::Hidden);
    assert_eq!(see(&soup, &point(0.), &point(3.)), Outcome::Reached);
    assert_eq!(see(&soup, &point(f64::NAN), &point(3.)), Outcome::Undecided);
    assert_eq!(see(&soup, &Aabb::EMPTY, &point(3.)), Outcome::Undecided);
    let mut lines = LineSpace::new(&soup);
    assert_eq!(
        lines.see_triangle(&point(0.), [[9., 0., 0.], [9., 1., 0.], [9., 2., 0.]], 100),
        Outcome::Hidden,
        "no area"
    );
}

/// A target that touches the plane where lines begin at a corner: that plane supports it, too, and the edges of a door lie in it.
#[test]
fn part_of_a_wall_is_seen_through_a_door() {
    let mut soup: Soup = quad([[0., 7., -1.], [0., 9., -1.], [0., 9., 9.], [0., 7., 9.]], false).into();
    soup.extend(quad([[0., 4., 4.], [0., 7., 4.], [0., 7., 9.], [0., 4., 9.]], false));
    soup.extend(quad([[4., -1., -1.], [4., 9., -1.], [4., 9., 9.], [4., -1., 9.]], false));
    let v = Aabb { min: [-2.0, 6.0, 2.0], max: [0.0, 8.5, 4.0] };
    let target = [[0.0, 9.0, 9.0], [8.0, 9.0, 9.0], [8.0, 9.0, -1.0]];
    assert_eq!(LineSpace::new(&soup).see_triangle(&v, target, BUDGET), Outcome::Reached);
    // What is beyond the wall is hidden.
    let beyond = [[4.0, 9.0, 9.0], [8.0, 9.0, 9.0], [8.0, 9.0, -1.0]];
    soup.extend(quad([[4., 9., -1.], [0., 9., -1.], [0., 9., 9.], [4., 9., 9.]], false));
    soup.extend(quad([[4., -1., 9.], [0., -1., 9.], [0., 9., 9.], [4., 9., 9.]], false));
    assert_eq!(LineSpace::new(&soup).see_triangle(&v, beyond, BUDGET), Outcome::Hidden);
}
