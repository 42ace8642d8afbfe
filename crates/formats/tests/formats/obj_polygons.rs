//! How faces of an OBJ are cut into triangles.

use proptest::prelude::*;
use sightlines_formats::scene::parse_obj;
use sightlines_geometry::{Point2, Point3, orient2d, signed_area};

/// The triangles of a face with these corners and their number, those without area, which are left out, included; or what is wrong.
fn triangulate(polygon: &[Point3]) -> Result<(Vec<[usize; 3]>, usize), String> {
    let corners: String = polygon.iter().map(|[x, y, z]| format!("v {x:?} {y:?} {z:?}\n")).collect();
    let face: String = (1..=polygon.len()).map(|k| format!(" {k}")).collect();
    let file = parse_obj(format!("{corners}f{face}\n").as_bytes()).map_err(|error| error.what)?;
    let object = &file.scene.objects()[0];
    assert_eq!(object.vertices, polygon);
    let triangles: Vec<[usize; 3]> = object.triangles.iter().map(|t| t.map(|k| k as usize)).collect();
    let n = triangles.len() + file.info.n_degenerate_triangles;
    Ok((triangles, n))
}

/// The corners of a polygon in the plane z = x + 2y, so that every view shows it.
fn lift(flat: &[[f64; 2]]) -> Vec<Point3> {
    flat.iter().map(|&[x, y]| [x, y, x + 2.0 * y]).collect()
}

fn area_xy(polygon: &[Point3], t: [usize; 3]) -> f64 {
    signed_area(&t.map(|k| Point2::new(polygon[k][0], polygon[k][1])))
}

fn check(flat: &[[f64; 2]]) -> Vec<[usize; 3]> {
    let polygon = lift(flat);
    let (triangles, n) = triangulate(&polygon).unwrap();
    assert_eq!(n, flat.len() - 2);
    let all: Vec<Point2> = polygon.iter().map(|p| Point2::new(p[0], p[1])).collect();
    let whole = signed_area(&all);
    let sum: f64 = triangles.iter().map(|&t| area_xy(&polygon, t)).sum();
    assert_eq!(sum, whole);
    assert!(triangles.iter().all(|&t| area_xy(&polygon, t) * whole >= 0.0), "{triangles:?}");
    triangles
}

#[test]
fn quads_are_fans_from_the_first_corner() {
    assert_eq!(check(&[[0., 0.], [1., 0.], [1., 1.], [0., 1.]]), [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(check(&[[0., 0.], [0., 1.], [1., 1.], [1., 0.]]), [[0, 1, 2], [0, 2, 3]]);
    // A dart whose fan from the first corner would cover the notch.
    assert_eq!(check(&[[0., 0.], [4., 1.], [0., 4.], [1., 1.]]).len(), 2);
    assert_eq!(check(&[[4., 1.], [0., 4.], [1., 1.], [0., 0.]]).len(), 2);
}

#[test]
fn combs_and_holes_are_cut() {
    check(&[
        [0., 0.],
        [5., 0.],
        [5., 5.],
        [4., 5.],
        [4., 1.],
        [3., 1.],
        [3., 5.],
        [2., 5.],
        [2., 1.],
        [1., 5.],
        [0., 5.],
    ]);
    // A square with a square hole, joined by a slit that is walked twice.
    let slit = [[0., 0.], [6., 0.], [6., 6.], [0., 6.], [0., 0.], [2., 2.], [2., 4.], [4., 4.], [4., 2.], [2., 2.]];
    let triangles = check(&slit);
    let polygon = lift(&slit);
    let in_hole = |t: &[usize; 3]| {
        let [a, b, c] = t.map(|k| Point2::new(polygon[k][0], polygon[k][1]));
        let p = Point2::new(3.0, 3.1);
        orient2d(a, b, p) > 0.0 && orient2d(b, c, p) > 0.0 && orient2d(c, a, p) > 0.0
    };
    assert!(!triangles.iter().any(in_hole));
}

const CROSSING: &str = "the outline of the face crosses itself";

#[test]
fn crossing_outlines_are_refused() {
    let bow = [[0., 0., 0.], [2., 2., 6.], [2., 0., 2.], [0., 2., 4.]];
    assert_eq!(triangulate(&bow), Err(CROSSING.to_owned()));
    // Seen edge-on it looks like a line from two sides.
    let [a, b, c, d] = [[0., 0.], [1., 1.], [1., 0.], [0., 1.]];
    let on_plane = |axis: usize| {
        [a, b, c, d].map(|p| {
            let mut q = [7.0; 3];
            (q[(axis + 1) % 3], q[(axis + 2) % 3]) = (p[0], p[1]);
            q
        })
    };
    assert!((0..3).all(|axis| triangulate(&on_plane(axis)) == Err(CROSSING.to_owned())));
    // A spiral zigzag with too many corners.
    let zigzag = |k: usize| [k as f64, (k % 2) as f64, 0.0];
    let mut long: Vec<Point3> = (0..1024).map(zigzag).collect();
    long.push([0.0, 9.0, 0.0]);
    assert_eq!(triangulate(&long), Err("a winding face of 1025 corners, more than 1024".to_owned()));
    // Nothing but a line: triangles without area, for the caller to drop.
    let line = triangulate(&[[0.; 3], [1.; 3], [2.; 3], [1.; 3]]);
    assert_eq!(line, Err("no triangles (1 objects, 2 triangles without area)".to_owned()));
}

proptest! {
    /// Invariant: what is accepted covers every point as often as its outline winds around it.
    #[test]
    fn triangles_cover_what_the_outline_winds_around(flat in prop::collection::vec([0..6i32, 0..6i32], 4..9)) {
        let polygon = lift(&flat.iter().map(|p| p.map(f64::from)).collect::<Vec<_>>());
        let triangles = match triangulate(&polygon) {
            Ok((triangles, _)) => triangles,
            Err(error) if error.starts_with("no triangles") => Vec::new(),
            Err(_) => return Ok(()),
        };
        // Points off every line through two points of the grid, and seen from above.
        for (x, y) in (0..25).map(|k| (f64::from(k % 5) + 0.501, f64::from(k / 5) + 0.2503)) {
            let p = Point2::new(x, y);
            let winding = winding_number(&polygon, &(0..polygon.len()).collect::<Vec<_>>(), p);
            let covers: i32 = triangles.iter().map(|t| winding_number(&polygon, t, p)).sum();
            prop_assert_eq!(covers, winding);
            let hands: Vec<i32> = triangles.iter().map(|t| winding_number(&polygon, t, p)).collect();
            prop_assert!(hands.iter().all(|&h| h >= 0) || hands.iter().all(|&h| h <= 0), "{:?}", hands);
        }
    }
}

/// By counting how the outline crosses the ray from `p` to the right.
fn winding_number(polygon: &[Point3], outline: &[usize], p: Point2) -> i32 {
    let corner = |k: usize| Point2::new(polygon[k][0], polygon[k][1]);
    let edges = (0..outline.len()).map(|k| (corner(outline[k]), corner(outline[(k + 1) % outline.len()])));
    edges
        .map(|(a, b)| match (a.y <= p.y, b.y <= p.y) {
            (true, false) => i32::from(orient2d(a, b, p) > 0.0),
            (false, true) => -i32::from(orient2d(a, b, p) < 0.0),
            _ => 0,
        })
        .sum()
}
