//! Faces from triangles: never more than the triangles, and all of them where borders are axis-parallel.

use crate::meshes::{object, quad, rectangle, scene, triangulated};
use proptest::prelude::*;
use sightlines_cells::{Point3, Scene};
use sightlines_geometry::Aabb;
use sightlines_kdtree::{AxialFace, SceneOptions, scene_faces};

const SIDE: i32 = 6;

fn all_faces(scene: &Scene) -> Vec<AxialFace<3>> {
    scene_faces(scene, &SceneOptions { detail_below: Some(0.0), ..SceneOptions::default() }).faces
}

/// How many of the unit squares' middles on planes of `axis` are in each rectangle of a list.
fn squares(axis: usize, rects: &[(usize, Point3, Point3)]) -> Vec<usize> {
    let n = SIDE as u32;
    let centre = |i: u32| {
        let mut p = [0.0; 3];
        p[axis] = f64::from(i % (n + 1));
        p[(axis + 1) % 3] = f64::from(i / (n + 1) % n) + 0.5;
        p[(axis + 2) % 3] = f64::from(i / (n + 1) / n) + 0.5;
        p
    };
    let covers = |r: &&(usize, Point3, Point3), p| r.0 == axis && Aabb { min: r.1, max: r.2 }.contains(p);
    (0..(n + 1) * n * n).map(|i| rects.iter().filter(|r| covers(r, centre(i))).count()).collect()
}

fn check_coverage(rects: &[(usize, Point3, Point3)], faces: &[AxialFace<3>]) -> Result<(), String> {
    let faces: Vec<_> = faces.iter().map(|f| (f.axis, f.min, f.max)).collect();
    for axis in 0..3 {
        let want: Vec<usize> = squares(axis, rects).into_iter().map(|n| n.min(1)).collect();
        if squares(axis, &faces) != want {
            return Err(format!("faces {faces:?} do not cover {rects:?}"));
        }
    }
    Ok(())
}

/// Whether a point is in a triangle of a plane, its border included; in integers, 16 to a unit.
fn in_triangle(t: &[[i64; 2]; 3], p: [i64; 2]) -> bool {
    let turn = |a: [i64; 2], b: [i64; 2]| (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
    let turns = [turn(t[0], t[1]), turn(t[1], t[2]), turn(t[2], t[0])];
    turns.iter().all(|&x| x >= 0) || turns.iter().all(|&x| x <= 0)
}

/// No point of a face is outside of the triangles, which lie on z = 0: tried at points near its corners
/// and inside of it.
fn check_inside(triangles: &[[[i64; 2]; 3]], faces: &[AxialFace<3>]) -> Result<(), String> {
    for f in faces {
        let [lo, hi] = [f.min, f.max].map(|p| [(p[0] * 16.0) as i64, (p[1] * 16.0) as i64]);
        let step = |k: usize| (1..16).map(move |i| lo[k] + (hi[k] - lo[k]) * i / 16).chain([lo[k] + 1, hi[k] - 1]);
        for p in step(0).flat_map(|x| step(1).map(move |y| [x, y])) {
            let scaled = |t: &[[i64; 2]; 3]| t.map(|c| c.map(|x| x * 16));
            if !triangles.iter().any(|t| in_triangle(&scaled(t), p)) {
                return Err(format!("{f:?} covers {p:?} / 16"));
            }
        }
    }
    Ok(())
}

fn on_ground(triangles: &[[[i64; 2]; 3]]) -> Scene {
    let lifted: Vec<[Point3; 3]> = triangles.iter().map(|t| t.map(|[x, y]| [x as f64, y as f64, 0.0])).collect();
    scene(vec![object("ground", &lifted)])
}

proptest! {
    /// Invariant: rectangles, however they overlap and are triangulated, give faces that cover the same.
    #[test]
    fn faces_are_the_rectangles(
        rects in prop::collection::vec((rectangle(SIDE), any::<u64>()), 0..8),
        n_objects in 1usize..3,
    ) {
        let mut triangles: Vec<Vec<[Point3; 3]>> = vec![vec![]; n_objects];
        for (i, ((axis, min, max), seed)) in rects.iter().enumerate() {
            triangles[i % n_objects].extend(triangulated(*axis, *min, *max, *seed));
        }
        let faces = all_faces(&scene(triangles.iter().map(|t| object("wall", t)).collect()));
        let rects: Vec<_> = rects.into_iter().map(|(r, _)| r).collect();
        // A rectangle without extent covers nothing, but contains middles of squares of its own plane never.
        check_coverage(&rects, &faces).map_err(TestCaseError::fail)?;
    }

    /// Invariant: the way a rectangle is cut into triangles changes nothing, to the last bit.
    #[test]
    fn faces_do_not_depend_on_triangulation(rects in prop::collection::vec(rectangle(SIDE), 0..6), seeds in any::<[u64; 2]>()) {
        let faces = seeds.map(|seed| {
            let cut = |(axis, min, max): &(usize, Point3, Point3)| triangulated(*axis, *min, *max, seed);
            all_faces(&scene(vec![object("wall", &rects.iter().flat_map(cut).collect::<Vec<_>>())]))
        });
        prop_assert_eq!(&faces[0], &faces[1]);
    }

    /// Invariant: triangles of any shape never give a face that sticks out of their union.
    #[test]
    fn faces_are_inside_of_triangles(soup in prop::collection::vec(any::<[[u8; 2]; 3]>(), 1..8)) {
        let soup: Vec<[[i64; 2]; 3]> = soup.iter().map(|t| t.map(|c| c.map(|x| i64::from(x % 7)))).collect();
        check_inside(&soup, &all_faces(&on_ground(&soup))).map_err(TestCaseError::fail)?;
    }

    /// Invariant: the same for fans around a corner, which hang together and fold back over themselves.
    #[test]
    fn faces_are_inside_of_fans(corners in prop::collection::vec([0i64..8, 0i64..8], 3..10)) {
        let fan: Vec<_> = corners.windows(2).skip(1).map(|w| [corners[0], w[0], w[1]]).collect();
        check_inside(&fan, &all_faces(&on_ground(&fan))).map_err(TestCaseError::fail)?;
    }
}

#[test]
fn impostors_are_found_out() {
    // Boxes around triangles instead of rectangles inside of them.
    let half = [[[0, 0], [4, 0], [0, 4]]];
    let around = AxialFace::new(2, [0.0; 3], [4.0, 4.0, 0.0]);
    assert!(check_inside(&half, &[around]).is_err());
    assert!(check_inside(&half, &[AxialFace::new(2, [0.0; 3], [2.0, 2.0, 0.0])]).is_ok());
    // Nothing where there is a rectangle, and something where there is none.
    let rect = (2, [0.0; 3], [4.0, 4.0, 0.0]);
    assert!(check_coverage(&[rect], &[around]).is_ok());
    assert!(check_coverage(&[rect], &[]).is_err());
    assert!(check_coverage(&[], &[around]).is_err());
}

#[test]
fn slanted_planes_are_other() {
    let mut triangles = quad(0, [1.0, 0.0, 0.0], [1.0, 2.0, 2.0], true);
    triangles[1][0][0] = 1.0f64.next_up();
    triangles.push([[0.0; 3], [0.0, 1.0, 0.0], [0.0, 2.0, 0.0]]);
    let found = scene_faces(&scene(vec![object("wall", &triangles)]), &SceneOptions::default());
    assert_eq!((found.n_axial_triangles, found.n_other_triangles, found.n_empty_triangles), (1, 1, 1));
    assert_eq!(found.faces, [], "half a rectangle contains none of its corners");
}

#[test]
fn single_precision_keeps_planes() {
    // 0.1 in single precision is the same number wherever it comes from.
    let x = f64::from(0.1f32);
    let walls = [(0.0, 1.0), (1.0, f64::from(1.7f32))];
    let quads: Vec<_> = walls.iter().flat_map(|&(y0, y1)| quad(0, [x, y0, 0.0], [x, y1, 3.0], true)).collect();
    let found = scene_faces(&scene(vec![object("wall", &quads)]), &SceneOptions::default());
    assert_eq!(found.faces, [AxialFace::new(0, [x, 0.0, 0.0], [x, f64::from(1.7f32), 3.0])]);
}

proptest! {
    /// Of walls of one side and others, each place of a plane is in one face: a wall with two sides where there is one, or where two stand back
    /// to back; else a front where there is one. Nothing is counted twice.
    #[test]
    fn walls_back_to_back_are_walls(
        rects in prop::collection::vec((rectangle(SIDE), any::<bool>(), any::<bool>()), 1..8)
    ) {
        let objects = rects.iter().map(|(r, up, _)| object("wall", &quad(r.0, r.1, r.2, *up))).collect();
        let fronts: Vec<u32> = (0u32..).zip(&rects).filter(|(_, (.., one_sided))| *one_sided).map(|(k, _)| k).collect();
        let scene = scene(objects).with_front_occluders(fronts).expect("objects");
        let found = scene_faces(&scene, &SceneOptions { detail_below: Some(0.0), ..SceneOptions::default() });
        let of = |up: Option<bool>| -> Vec<_> {
            let faces = match up {
                None => found.faces.clone(),
                Some(up) => found.fronts.iter().filter(|front| front.1 == up).map(|front| front.0).collect(),
            };
            faces.iter().map(|f| (f.axis, f.min, f.max)).collect()
        };
        let given = |pick: &dyn Fn(bool, bool) -> bool| -> Vec<_> {
            rects.iter().filter(|(_, up, one)| pick(*up, *one)).map(|(r, ..)| *r).collect()
        };
        for axis in 0..3 {
            let n = |rects: &[(usize, Point3, Point3)]| squares(axis, rects);
            let [walls, up, down] = [n(&of(None)), n(&of(Some(true))), n(&of(Some(false)))];
            let [both, ups, downs] = [given(&|_, one| !one), given(&|up, one| one && up), given(&|up, one| one && !up)].map(|r| n(&r));
            for k in 0..walls.len() {
                let is = |n: &[usize]| n[k] > 0;
                prop_assert_eq!(walls[k], usize::from(is(&both) || is(&ups) && is(&downs)));
                prop_assert_eq!(up[k], usize::from(is(&ups) && !is(&downs)));
                prop_assert_eq!(down[k], usize::from(is(&downs) && !is(&ups)));
            }
        }
    }
}
