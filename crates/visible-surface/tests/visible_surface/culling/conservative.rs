//! Hidden from all rays of the picture, wherever in a pixel.

use crate::culling::oracle::{Chance, Eye, P, aabb, any_box, faces_of};
use proptest::prelude::*;
use sightlines_visible_surface::FaceMask;
use sightlines_visible_surface::hierarchical::{self, DepthPyramid, Neighbours, Rays};

/// A surface of triangles over a grid, with heights: what shares edges, and folds.
fn sheet(chance: &mut Chance, n: i128, rough: i128) -> Vec<[P; 3]> {
    let step = 1 + chance.below(4) as i128;
    let at = chance.point(3);
    let heights: Vec<i128> = (0..(n + 1) * (n + 1)).map(|_| chance.within(rough)).collect();
    let slant = [chance.within(2), chance.within(2)];
    let corner = |i: i128, j: i128| {
        let z = heights[(i * (n + 1) + j) as usize] + slant[0] * i + slant[1] * j;
        [at[0] + (i - n / 2) * step, at[1] + (j - n / 2) * step, at[2] + 6 + z]
    };
    let mut all = Vec::new();
    for i in 0..n {
        for j in 0..n {
            let [a, b, c, d] = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
            // Either diagonal, in any order of corners.
            let two = if chance.below(2) == 0 { [[a, b, c], [a, c, d]] } else { [[a, b, d], [d, b, c]] };
            all.extend(two.map(|[a, b, c]| if chance.below(3) == 0 { [b, a, c] } else { [a, b, c] }));
        }
    }
    all
}

/// A box of twelve triangles: each of its edges is shared, and those of its outline are folds.
fn closed_box(chance: &mut Chance) -> Vec<[P; 3]> {
    let [min, max] = any_box(chance, 5);
    let corner = |i: usize| [0, 1, 2].map(|k| if i >> k & 1 == 0 { min[k] } else { max[k] + 1 });
    let sides = [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]];
    let of = |[a, b, c, d]: [usize; 4]| [[a, b, c], [c, d, a]].map(|t| t.map(corner));
    let mut all: Vec<_> = sides.into_iter().flat_map(of).collect();
    // In front of most eyes that look ahead.
    all.iter_mut().flatten().for_each(|p| p[2] += 6);
    all
}

fn any_scene(chance: &mut Chance) -> Vec<[P; 3]> {
    let mut all = Vec::new();
    for _ in 0..1 + chance.below(2) {
        let (n, rough) = (1 + chance.below(3) as i128, chance.below(3) as i128);
        all.extend(sheet(chance, n, rough));
    }
    if chance.below(2) == 0 {
        all.extend(closed_box(chance));
    }
    // Some go missing, so that there are holes; some more are anywhere.
    let n_holes = chance.below(2);
    for _ in 0..n_holes {
        all.swap_remove(chance.below(all.len() as u64) as usize);
    }
    all.extend((0..3).map(|_| [0; 3].map(|_| chance.point(8))));
    all
}

proptest! {
    #[test]
    fn hidden_faces_change_no_ray(seed in any::<u64>()) {
        let mut chance = Chance(seed);
        let eye = Eye::any(&mut chance);
        let corners = any_scene(&mut chance);
        let faces = faces_of(&corners);
        let all = FaceMask::all(&faces);
        let pyramid = DepthPyramid::conservative(&faces, &eye.camera(), &all);
        prop_assert_eq!(pyramid.rays(), Rays::All);
        let mut left = all.clone();
        hierarchical::cull(&faces, &mut left, &pyramid);
        for parts in [0, 4] {
            let whole = eye.picture(parts, &corners, |f| all.has(f));
            prop_assert_eq!(eye.picture(parts, &corners, |f| left.has(f)), whole);
        }
    }

    #[test]
    fn hidden_boxes_are_seen_by_no_ray_anywhere(seed in any::<u64>()) {
        let mut chance = Chance(seed);
        let eye = Eye::any(&mut chance);
        let corners = any_scene(&mut chance);
        let faces = faces_of(&corners);
        let mut some = FaceMask::all(&faces);
        some.retain(|f| f % 7 != 6);
        let pyramid = DepthPyramid::with_neighbours(&faces, &Neighbours::of(&faces), &eye.camera(), &some);
        for k in 0..24 {
            let mut b = any_box(&mut chance, 12);
            if k % 6 > 0 {
                b[1] = [0, 1, 2].map(|k| b[1][k].min(b[0][k] + 1));
            }
            for parts in [0, 4] {
                prop_assert!(!pyramid.hides(&aabb(&b)) || !eye.sees_box(parts, &corners, |f| some.has(f), &b), "{:?}", b);
            }
        }
    }
}

/// The twin: what no ray of a grid sees, four to a pixel's side, is mostly found.
#[test]
fn most_hidden_boxes_are_found() {
    let mut chance = Chance(31);
    let (mut n_hidden, mut n_found, mut n_by_single) = (0, 0, 0);
    for _ in 0..150 {
        let eye = Eye::ahead([0, 0, -4], [12, 10]);
        let corners = sheet(&mut chance, 4, 1);
        let faces = faces_of(&corners);
        let all = FaceMask::all(&faces);
        let pyramid = DepthPyramid::conservative(&faces, &eye.camera(), &all);
        // Without neighbours each face is alone.
        let single = DepthPyramid::with_neighbours(&faces, &Neighbours::default(), &eye.camera(), &all);
        for _ in 0..8 {
            let at = chance.point(5);
            let at = [at[0], at[1], 14 + at[2].abs()];
            let b = [at, at.map(|x| x + 1 + chance.below(2) as i128)];
            let (found, seen) = (pyramid.hides(&aabb(&b)), eye.sees_box(4, &corners, |f| all.has(f), &b));
            assert!(!(found && seen), "{b:?}");
            let alone = single.hides(&aabb(&b));
            assert!(found || !alone);
            // Being out of the picture is not what is counted.
            let hidden = !seen && eye.sees_box(4, &[], |_| true, &b);
            n_hidden += usize::from(hidden);
            n_found += usize::from(hidden && found);
            n_by_single += usize::from(hidden && alone);
        }
    }
    eprintln!("{n_found} of {n_hidden} hidden boxes found, {n_by_single} by faces that cover pixels alone");
    assert!(n_hidden > 100);
    assert!(n_found * 100 >= n_hidden * 50, "{n_found} of {n_hidden}");
    assert!(n_by_single * 2 < n_found, "{n_by_single} of {n_found}");
}

/// A slit between the centres of pixels: no pixel shows what is behind, but rays do.
#[test]
fn a_slit_between_centres_is_seen_through() {
    let eye = Eye::ahead([0; 3], [8, 8]);
    let wall = |left: i128, right: i128| {
        let [a, b, c, d] = [[left, -400, 40], [right, -400, 40], [right, 400, 40], [left, 400, 40]];
        [[a, b, c], [a, c, d]]
    };
    // The line between pixels 3 and 4 is x = 0; their centres at this depth are 5 to each side.
    let slit: Vec<_> = wall(-400, -1).into_iter().chain(wall(1, 400)).collect();
    let faces = faces_of(&slit);
    let all = FaceMask::all(&faces);
    let behind = [[-20, -10, 50], [20, 10, 60]];
    let seen = |parts| eye.sees_box(parts, &slit, |_| true, &behind);
    assert_eq!([0, 4].map(seen), [false, true]);
    let sampled = DepthPyramid::sampled(&faces, &eye.camera(), &eye.image(&slit, &all));
    let conservative = DepthPyramid::conservative(&faces, &eye.camera(), &all);
    // So the one would be an impostor for the other.
    assert!(sampled.hides(&aabb(&behind)));
    assert!(!conservative.hides(&aabb(&behind)));
    // Beside the slit both find what is hidden.
    let beside = aabb(&[[15, -10, 50], [24, 10, 60]]);
    assert!(sampled.hides(&beside) && conservative.hides(&beside));
    // With the slit closed, by sharing corners, it hides; with a wall that only touches, it may not.
    let closed: Vec<_> = wall(-400, 0).into_iter().chain(wall(0, 400)).collect();
    let faces = faces_of(&closed);
    assert!(DepthPyramid::conservative(&faces, &eye.camera(), &FaceMask::all(&faces)).hides(&aabb(&behind)));
}

/// A fold: the two faces at an edge lie on one side of it, so it is a border.
#[test]
fn folds_are_borders() {
    let eye = Eye::ahead([0; 3], [8, 8]);
    let (p, q) = ([4, -400, 40], [4, 400, 40]);
    let fold = [[p, q, [-900, 0, 40]], [p, q, [-900, 0, 60]]];
    let faces = faces_of(&fold);
    let pyramid = DepthPyramid::conservative(&faces, &eye.camera(), &FaceMask::all(&faces));
    // It ends within pixel 4 of each row, behind the centre.
    let behind = [[-5, -5, 70], [8, 5, 80]];
    assert!(eye.sees_box(8, &fold, |_| true, &behind) && !eye.sees_box(0, &fold, |_| true, &behind));
    assert!(!pyramid.hides(&aabb(&behind)));
    assert!(pyramid.hides(&aabb(&[[-35, -5, 70], [-5, 5, 80]])));
    // The same edge with the two faces on its two sides is none.
    let flat = [[p, q, [-900, 0, 40]], [p, q, [900, 0, 60]]];
    let faces = faces_of(&flat);
    assert!(DepthPyramid::conservative(&faces, &eye.camera(), &FaceMask::all(&faces)).hides(&aabb(&behind)));
}

/// In one pixel a slanted wall is near and far: only what is behind its farthest place there is hidden.
#[test]
fn the_farthest_place_in_a_pixel_counts() {
    let eye = Eye::ahead([0; 3], [1, 1]);
    // z = 20 + x, of which the picture shows from z = 13.3 to 40.
    let at = |x: i128, y: i128| [x, y, 20 + x];
    let [a, b, c, d] = [at(-18, -500), at(300, -500), at(300, 500), at(-18, 500)];
    for wall in [vec![[a, b, c], [a, c, d]], vec![[at(-18, -9000), at(3000, 0), at(-18, 9000)]]] {
        let faces = faces_of(&wall);
        let pyramid = DepthPyramid::conservative(&faces, &eye.camera(), &FaceMask::all(&faces));
        // Behind the nearest place and that of the centre, before the wall where it is.
        let before = [[11, 0, 25], [12, 1, 26]];
        assert!(eye.sees_box(16, &wall, |_| true, &before));
        assert!(!pyramid.hides(&aabb(&before)));
        assert!(!pyramid.hides(&aabb(&[[0, 0, 39], [1, 1, 40]])));
        assert!(pyramid.hides(&aabb(&[[-30, -30, 41], [30, 30, 50]])));
    }
}

/// The nearest depth limits what hides: what lies before it is not drawn.
#[test]
fn what_is_before_the_nearest_depth_hides_nothing() {
    let mut eye = Eye::ahead([0; 3], [16, 16]);
    // A depth is 32 units.
    let scaled = |p: P| p.map(|x| 32 * x);
    let slanted = [[[-90, -90, 10], [90, -90, 10], [0, 90, 2]].map(scaled)];
    let faces = faces_of(&slanted);
    let hides = |eye: &Eye, b: [P; 2]| {
        let pyramid = DepthPyramid::conservative(&faces, &eye.camera(), &FaceMask::all(&faces));
        pyramid.hides(&aabb(&b.map(scaled)))
    };
    let (upper, lower) = ([[-1, 3, 11], [1, 5, 12]], [[-1, -5, 11], [1, -4, 12]]);
    assert!(hides(&eye, upper) && hides(&eye, lower));
    eye.near = 6;
    assert!(!hides(&eye, upper) && hides(&eye, lower));
    // And beyond the farthest nothing is seen.
    let beyond = [[-1, 3, 20], [1, 5, 30]];
    assert!(!hides(&eye, beyond));
    eye.far = Some(19);
    assert!(hides(&eye, beyond));
}
