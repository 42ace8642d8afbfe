//! Hidden from the centres of pixels.

use crate::culling::oracle::{Chance, Eye, P, aabb, any_box, faces_of};
use proptest::prelude::*;
use sightlines_visible_surface::hierarchical::{self, DepthPyramid, Rays};
use sightlines_visible_surface::{FaceMask, Image, cull};

fn any_faces(chance: &mut Chance, n: usize) -> Vec<[P; 3]> {
    (0..n).map(|_| [0; 3].map(|_| chance.point(6))).collect()
}

proptest! {
    /// What is called hidden changes no pixel, whether all faces or some were in the picture that says so.
    #[test]
    fn hidden_faces_change_no_pixel(seed in any::<u64>()) {
        let mut chance = Chance(seed);
        let eye = Eye::any(&mut chance);
        let corners = any_faces(&mut chance, 20);
        let faces = faces_of(&corners);
        let all = FaceMask::all(&faces);
        let mut some = all.clone();
        some.retain(|f| f % 3 != 0);
        let whole = eye.picture(0, &corners, |f| all.has(f));
        for occluders in [&all, &some] {
            let pyramid = DepthPyramid::sampled(&faces, &eye.camera(), &eye.image(&corners, occluders));
            prop_assert_eq!(pyramid.rays(), Rays::Centres);
            let mut left = all.clone();
            let gone = hierarchical::cull(&faces, &mut left, &pyramid);
            prop_assert_eq!(gone as usize, all.len() - left.len());
            prop_assert_eq!(&eye.picture(0, &corners, |f| left.has(f)), &whole);
        }
    }

    #[test]
    fn hidden_boxes_are_seen_by_no_ray(seed in any::<u64>()) {
        let mut chance = Chance(seed);
        let eye = Eye::any(&mut chance);
        let corners = any_faces(&mut chance, 10);
        let faces = faces_of(&corners);
        let all = FaceMask::all(&faces);
        let pyramid = DepthPyramid::sampled(&faces, &eye.camera(), &eye.image(&corners, &all));
        for _ in 0..8 {
            let b = any_box(&mut chance, 9);
            prop_assert!(!pyramid.hides(&aabb(&b)) || !eye.sees_box(0, &corners, |f| all.has(f), &b), "{:?}", b);
        }
    }
}

/// The twin: of the boxes that no ray sees how many are found.
#[test]
fn most_hidden_boxes_are_found() {
    let mut chance = Chance(11);
    let (mut n_hidden, mut n_found, mut n_seen) = (0, 0, 0);
    for _ in 0..400 {
        let eye = Eye::ahead([0, 0, -8], [9, 7]);
        let corners = any_faces(&mut chance, 12);
        let faces = faces_of(&corners);
        let all = FaceMask::all(&faces);
        let pyramid = DepthPyramid::sampled(&faces, &eye.camera(), &eye.image(&corners, &all));
        for _ in 0..10 {
            let at = chance.point(4);
            let at = [at[0], at[1], 4 + at[2]];
            let b = [at, at.map(|x| x + 1 + chance.below(2) as i128)];
            let (found, seen) = (pyramid.hides(&aabb(&b)), eye.sees_box(0, &corners, |f| all.has(f), &b));
            assert!(!(found && seen));
            // Being out of the picture, or between centres, is not what is counted.
            let hidden = !seen && eye.sees_box(0, &[], |_| true, &b);
            n_seen += usize::from(seen);
            n_hidden += usize::from(hidden);
            n_found += usize::from(hidden && found);
        }
    }
    eprintln!("{n_found} of {n_hidden} hidden boxes found, {n_seen} are seen");
    assert!(n_hidden > 300 && n_seen > 300);
    assert!(n_found * 100 >= n_hidden * 60, "{n_found} of {n_hidden}");
}

/// A wall before half of the picture, and boxes in a row behind it: the numbers are known.
#[test]
fn a_wall_hides_what_is_behind_it() {
    for size in [[64, 48], [63, 47], [1, 1], [5, 3]] {
        let eye = Eye::ahead([0; 3], size);
        let wall = [[[-50, -50, 10], [0, -50, 10], [0, 50, 10]], [[-50, -50, 10], [0, 50, 10], [-50, 50, 10]]];
        let faces = faces_of(&wall);
        let pyramid = DepthPyramid::sampled(&faces, &eye.camera(), &eye.image(&wall, &FaceMask::all(&faces)));
        let hides = |min: P, max: P| pyramid.hides(&aabb(&[min, max]));
        // Around the eye.
        assert!(!hides([-1, -1, -1], [1, 1, 1]), "{size:?}");
        if size != [1, 1] {
            // Behind, before, through the wall, and beyond its edge; at 10 units the picture reaches from -5 to 5.
            assert!((0..5).all(|k| hides([k - 5, -2, 11], [k - 4, 2, 12])), "{size:?}");
            assert!(!hides([-4, -2, 8], [-1, 2, 9]), "{size:?}");
            assert!(!hides([-4, -2, 9], [-1, 2, 30]), "{size:?}");
            assert!(!hides([-4, -2, 11], [4, 2, 30]), "{size:?}");
        }
        // It is not behind itself.
        assert_eq!(hierarchical::cull(&faces, &mut FaceMask::all(&faces), &pyramid), 0, "{size:?}");
        let sizes: Vec<_> = pyramid.levels().iter().map(|l| l.size()).collect();
        assert_eq!((sizes[0], sizes[sizes.len() - 1]), (size, [1, 1]));
        assert!(sizes.windows(2).all(|w| w[1] == w[0].map(|n| n.div_ceil(2))));
    }
}

#[test]
fn pictures_that_do_not_fit_hide_nothing_more() {
    let eye = Eye::ahead([0; 3], [4, 4]);
    let wall = [
        [[-90, -90, 5], [90, -90, 5], [0, 90, 5]],
        [[0, 0, 1], [0, 1, 2], [0, 3, 2]],
        [[9, 0, -1], [0, 9, -1], [9, 9, -1]],
    ];
    let faces = faces_of(&wall);
    let behind = aabb(&[[-3, -3, 9], [3, 3, 10]]);
    let pyramid = |size, face| {
        let mut image = Image::new(size);
        image.faces_mut().fill(face);
        DepthPyramid::sampled(&faces, &eye.camera(), &image)
    };
    assert!(pyramid([4, 4], 0).hides(&behind) && pyramid([9, 5], 0).hides(&behind));
    // Too small, of a face that is not there, seen edge-on, behind the eye.
    for (size, face) in [([2, 9], 0), ([4, 4], 7), ([4, 4], 1), ([4, 4], 2)] {
        assert!(!pyramid(size, face).hides(&behind), "{size:?} {face}");
    }
    // Coordinates that no scene may have.
    for bad in [f64::NAN, f64::INFINITY, 1e300] {
        let mut b = behind;
        b.max[2] = bad;
        assert!(!pyramid([4, 4], 0).hides(&b) && !pyramid([4, 4], 0).hides_hull(&[b.max]));
    }
    assert!(pyramid([4, 4], 0).hides(&sightlines_geometry::Aabb::EMPTY));
}

/// What is culled before and after goes together.
#[test]
fn all_kinds_of_culling_together_change_no_pixel() {
    let mut chance = Chance(21);
    let mut gone = [0; 3];
    for _ in 0..300 {
        let eye = Eye::any(&mut chance);
        let corners = any_faces(&mut chance, 25);
        let faces = faces_of(&corners);
        let mut chosen = FaceMask::all(&faces);
        gone[0] += cull::backface(&faces, &eye.camera(), &mut chosen);
        let whole = eye.picture(0, &corners, |f| chosen.has(f));
        gone[1] += cull::frustum(&faces, &eye.camera(), &mut chosen);
        let pyramid = DepthPyramid::sampled(&faces, &eye.camera(), &eye.image(&corners, &chosen));
        gone[2] += hierarchical::cull(&faces, &mut chosen, &pyramid);
        assert_eq!(eye.picture(0, &corners, |f| chosen.has(f)), whole);
    }
    eprintln!("culled: {gone:?}");
    assert!(gone.iter().all(|&n| n > 50), "{gone:?}");
}
