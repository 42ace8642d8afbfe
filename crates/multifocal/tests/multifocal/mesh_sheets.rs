//! Sheets against rays: nothing that is reported hidden is ever reached, and most of what is never reached is reported
//! hidden.

use proptest::prelude::*;
use sightlines_geometry::{Aabb, Point3, orient3d};
use sightlines_multifocal::mesh::{PatchOptions, SheetMethod, Sheets, patches};
use sightlines_multifocal::{FromRegion, Guarantee, Occluder, Volume};
use sightlines_testkit::draw;
use sightlines_testkit::meshes::{Soup, boxes, bumpy, free_segment, scene, solid, soup, sphere};

const LIMIT: usize = 1 << 14;

fn cube(middle: Point3, half: f64) -> Aabb<3> {
    Aabb { min: middle.map(|x| x - half), max: middle.map(|x| x + half) }
}

proptest! {
    /// Invariant: a random segment from one box to the other meets the mesh if the sheets report it hidden.
    #[test]
    fn sheets_hide_nothing_that_a_ray_reaches(soup in soup(), pairs in prop::collection::vec(boxes(), 12), seed in any::<u64>()) {
        let (sheets, rays) = (Sheets::new(&soup), scene(&soup));
        let mut tester = sheets.tester();
        for [v, e] in &pairs {
            if tester.hides(v, e, LIMIT) {
                let free = free_segment(&rays, v, e, seed, 200);
                prop_assert!(free.is_none(), "{v:?} to {e:?}: {free:?}");
            }
        }
    }

    /// Invariant: a tester that was used before gives the same answers as a fresh one.
    #[test]
    fn sheets_do_not_remember(soup in soup(), pairs in prop::collection::vec(boxes(), 6)) {
        let sheets = Sheets::new(&soup);
        let mut tester = sheets.tester();
        let again: Vec<bool> = pairs.iter().map(|[v, e]| tester.hides(v, e, LIMIT)).collect();
        let fresh: Vec<bool> = pairs.iter().map(|[v, e]| sheets.hides(v, e, LIMIT)).collect();
        prop_assert_eq!(again, fresh);
    }
}

/// The numbers of pairs that were tested, reported hidden, never reached by a ray, and both reached and reported
/// hidden, with sheets of the meshes changed by `heard`.
fn judged(heard: impl Fn(&Soup) -> Soup) -> [usize; 4] {
    let mut counts = [0; 4];
    for (i, (soup, pairs)) in draw(&(soup(), prop::collection::vec(boxes(), 12)), 400).iter().enumerate() {
        let (sheets, rays) = (Sheets::new(&heard(soup)), scene(soup));
        let mut tester = sheets.tester();
        for [v, e] in pairs {
            let hidden = tester.hides(v, e, LIMIT);
            let reached = free_segment(&rays, v, e, i as u64, 300).is_some();
            let all = [true, hidden, !reached, hidden && reached];
            all.iter().zip(&mut counts).for_each(|(&yes, n)| *n += usize::from(yes));
        }
    }
    counts
}

/// The tightness twin: of the pairs that no ray joins, most are hidden by one sheet.
#[test]
fn sheets_hide_most_of_what_no_ray_reaches() {
    let [n, n_hidden, n_unreached, n_wrong] = judged(Clone::clone);
    eprintln!("{n} pairs: {n_hidden} hidden, {n_unreached} never reached");
    assert_eq!(n_wrong, 0);
    assert!(n_unreached > 500 && n_hidden * 100 > n_unreached * 60, "{n} {n_hidden} {n_unreached}");
}

/// The impostors: sheets that ignore a missing triangle, or a crack, are detected.
#[test]
fn sheets_that_overlook_open_edges_are_noticed() {
    // Rays use the mesh without each third triangle, sheets the whole mesh.
    let mut n_wrong = 0;
    for (i, (soup, pairs)) in draw(&(soup(), prop::collection::vec(boxes(), 12)), 150).iter().enumerate() {
        let open: Soup = soup.iter().enumerate().filter(|(k, _)| k % 3 != 0).map(|(_, t)| *t).collect();
        let (sheets, rays) = (Sheets::new(soup), scene(&open));
        let wrong =
            |[v, e]: &&[Aabb<3>; 2]| sheets.hides(v, e, LIMIT) && free_segment(&rays, v, e, i as u64, 300).is_some();
        n_wrong += pairs.iter().filter(wrong).count();
    }
    assert!(n_wrong > 50, "{n_wrong}");
    // Corners rounded to halves close real cracks.
    let rounded = |s: &Soup| s.iter().map(|t| t.map(|p| p.map(|x| (x / 2.0).round() * 2.0))).collect();
    let [.., n_wrong] = judged(rounded);
    assert!(n_wrong > 20, "{n_wrong}");
}

/// Whether the lines of all pairs of corners pass the outline on one side, and cross all planes: the best that a buffer
/// could find.
fn patch_hides(o: &Occluder, v: &Aabb<3>, e: &Aabb<3>) -> bool {
    let corners = |b: &Aabb<3>| -> Vec<Point3> {
        (0..8).map(|i| std::array::from_fn(|k| if i >> k & 1 == 0 { b.min[k] } else { b.max[k] })).collect()
    };
    let (eyes, ends) = (corners(v), corners(e));
    let Some(front) = o.side_of(&eyes) else { return false };
    if o.side_of(&ends) != Some(!front) {
        return false;
    }
    let n = o.outline().len();
    let side = |a: Point3, b: Point3, i: usize| orient3d(o.outline()[i], o.outline()[(i + 1) % n], a, b) > 0.0;
    (0..n).all(|i| eyes.iter().all(|&a| ends.iter().all(|&b| side(a, b, i) == side(eyes[0], ends[0], 0))))
}

/// A wall that is bent around its target: no patch of it hides the target.
#[test]
fn a_curved_wall_hides_what_no_patch_hides() {
    // A quarter of a cylinder of radius 6 around the z axis, in 16 strips of 6 squares.
    let at = |i: i32, z: i32| {
        let t = f64::from(i) / 16.0;
        // Rational, so that nothing depends on a library's sine.
        let (c, s) = ((1.0 - t * t) / (1.0 + t * t), 2.0 * t / (1.0 + t * t));
        [6.0 * c, 6.0 * s, f64::from(z)]
    };
    let square = |k: i32| {
        let (i, z) = (k / 6 - 16, k % 6 - 3);
        sightlines_testkit::meshes::quad([at(i, z), at(i + 1, z), at(i + 1, z + 1), at(i, z + 1)], k % 2 == 0)
    };
    let wall: Soup = (0..32 * 6).flat_map(square).collect();
    let (v, e) = (cube([9.0, 0.0, 0.0], 1.0), Aabb { min: [0.0, -3.4, -0.3], max: [0.3, 3.4, 0.3] });
    assert!(Sheets::new(&wall).hides(&v, &e, LIMIT));
    assert!(Sheets::new(&wall).hides(&e, &v, LIMIT), "from behind as well");
    let found = patches(&wall, &PatchOptions::default());
    assert!(!found.is_empty() && !found.iter().any(|o| patch_hides(o, &v, &e)));
    let [eye, small] = [9.0, 5.0].map(|x| cube([x, 0.2, 0.4], 0.02));
    assert!(found.iter().any(|o| patch_hides(o, &eye, &small)), "patches do hide what is small");
    assert!(free_segment(&scene(&wall), &v, &e, 1, 20_000).is_none());
    // Without one triangle in the middle, and without one beside the hull.
    let without = |i: usize| {
        let mut open = wall.clone();
        open.remove(i);
        Sheets::new(&open).hides(&v, &e, LIMIT)
    };
    assert!(!without(16 * 12 + 6) && without(0));
    assert!(!Sheets::new(&wall).hides(&v, &e, 20), "the limit is kept");
}

#[test]
fn sheets_of_solids_and_their_borders() {
    let slab = Sheets::new(&solid([4., -20., -20.], [5., 20., 20.]));
    let v = cube([0.; 3], 1.0);
    let at = |x: f64| cube([x, 0., 0.], 1.0);
    assert!(slab.hides(&v, &at(8.0), LIMIT) && slab.hides(&at(8.0), &v, LIMIT));
    assert!(slab.hides(&at(3.0), &at(8.0), LIMIT), "an eye may touch the wall");
    assert!(slab.hides(&v, &at(6.0), LIMIT), "the front hides what touches the back");
    assert!(!slab.hides(&v, &at(5.0), LIMIT), "but not what touches the front");
    assert!(!slab.hides(&v, &at(4.0), LIMIT) && !slab.hides(&v, &at(-8.0), LIMIT) && !slab.hides(&v, &v, LIMIT));
    let point = |x: f64| Aabb::around([[x, 0.1, 0.2]]);
    assert!(slab.hides(&point(0.0), &point(9.0), LIMIT) && !slab.hides(&point(0.0), &point(3.0), LIMIT));
    assert!(!slab.hides(&v, &Aabb::EMPTY, LIMIT) && !slab.hides(&point(f64::NAN), &at(8.0), LIMIT));
    // Both boxes stand on the floor, to which the wall is joined: its lower edge is on the border of the hull.
    let mut house = solid([4., -20., 0.], [5., 20., 20.]);
    house.extend([
        [[4., -20., 0.], [-20., -20., 0.], [4., 20., 0.]],
        [[-20., -20., 0.], [-20., 20., 0.], [4., 20., 0.]],
    ]);
    let standing = |x: f64| Aabb { min: [x, 0., 0.], max: [x + 1.0, 1., 1.] };
    assert!(Sheets::new(&house).hides(&standing(0.0), &standing(8.0), LIMIT));
    assert!(Sheets::new(&[]).mesh().triangles().is_empty() && !Sheets::new(&[]).hides(&v, &at(8.0), LIMIT));
}

#[test]
fn fins_bumps_and_balls_do_not_open_a_sheet() {
    let (v, e) = (cube([0., 4., 4.], 0.5), cube([9., 4., 4.], 0.5));
    let mut wall = bumpy(10, &[0, 1, 2, 1, 0, 2, 2]);
    assert!(Sheets::new(&wall).hides(&v, &e, LIMIT));
    // A fin that stands on an edge of the wall: three triangles there.
    let [a, b, _] = wall[90];
    wall.push([a, b, [3.0, 4.0, 4.2]]);
    assert!(Sheets::new(&wall).hides(&v, &e, LIMIT));
    let ball = sphere([4.5, 4., 4.], 3.0, 3);
    assert!(Sheets::new(&ball).hides(&v, &e, LIMIT));
    let other = cube([9., 14., 4.], 0.5);
    assert!(!Sheets::new(&ball).hides(&v, &other, LIMIT), "seen past the ball");
}

#[test]
fn the_method_is_the_sheets() {
    let mut method = SheetMethod::new(&solid([4., -20., -20.], [5., 20., 20.]));
    assert_eq!((method.name().as_str(), method.guarantee()), ("sheets", Guarantee::Conservative));
    let volume = Volume::new(cube([0.; 3], 1.0)).unwrap();
    let mut umbra = method.umbra(&volume).unwrap();
    assert!(umbra.hides(&cube([8., 0., 0.], 1.0)) && !umbra.hides(&cube([-8., 0., 0.], 1.0)));
    assert!(umbra.hides_points(&[[7., 0., 0.], [8., 1., 3.]]) && !umbra.hides_points(&[]));
    drop(umbra);
    let mut short = SheetMethod::new(&solid([4., -20., -20.], [5., 20., 20.])).with_limit(0);
    assert!(!short.umbra(&volume).unwrap().hides(&cube([8., 0., 0.], 1.0)));
}
