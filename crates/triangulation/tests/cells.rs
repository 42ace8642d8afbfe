//! Cells against the walls they were cut from, on grids where every number is exact.

use proptest::prelude::*;
use sightlines_cells::{CellGraph, Plan, PlanLine, Planar};
use sightlines_geometry::{Point2, Segment2, orient2d, signed_area};
use sightlines_triangulation::{noding, subdivide};

type Wall = (Point2, Point2);

fn point(n: i32) -> impl Strategy<Value = Point2> {
    (0..n, 0..n).prop_map(|(x, y)| Point2::new(f64::from(x), f64::from(y)))
}

fn walls(n: i32, count: usize) -> impl Strategy<Value = Vec<Wall>> {
    let wall = (point(n), point(n)).prop_filter("walls have two ends", |(a, b)| a != b);
    proptest::collection::vec(wall, 2..count)
}

/// Walls without proper crossings: later ones that cross an earlier one are left out.
fn flat(walls: Vec<Wall>) -> Vec<Wall> {
    let mut kept: Vec<Wall> = Vec::new();
    for (a, b) in walls {
        let s = Segment2::new(a, b);
        if kept.iter().all(|&(c, d)| !s.crosses(&Segment2::new(c, d))) {
            kept.push((a, b));
        }
    }
    kept
}

fn cut(walls: &[Wall]) -> Option<CellGraph<Planar>> {
    let plan = Plan::from_walls(walls.iter().copied()).unwrap();
    let (graph, summary) = subdivide(&plan).ok()?;
    assert_eq!((summary.n_rounded_crossings, summary.n_dropped_pieces), (0, 0));
    graph.assert_well_formed();
    Some(graph)
}

/// Whether the open segment passes through the inside of the convex polygon: it has points strictly
/// left of every side. Clips by each side in turn; exact for the grid's small integers, since the
/// parameters compared are fractions of integers far below 2^53.
fn enters(polygon: &[Point2], (a, b): Wall) -> bool {
    let n = polygon.len();
    let (mut lo, mut hi) = ((0.0, 1.0), (1.0, 1.0));
    for i in 0..n {
        let (at_a, at_b) =
            (orient2d(polygon[i], polygon[(i + 1) % n], a), orient2d(polygon[i], polygon[(i + 1) % n], b));
        if at_a <= 0.0 && at_b <= 0.0 {
            return false;
        }
        // The value along the wall is at_a + t (at_b - at_a); fractions are (numerator, denominator).
        if at_a < 0.0 && -at_a * lo.1 > lo.0 * (at_b - at_a) {
            lo = (-at_a, at_b - at_a);
        }
        if at_b < 0.0 && at_a * hi.1 < hi.0 * (at_a - at_b) {
            hi = (at_a, at_a - at_b);
        }
    }
    lo.0 * hi.1 < hi.0 * lo.1
}

/// Overlap of two segments along the longer axis of the first, as an interval; empty if not collinear.
fn overlap(s: Wall, t: Wall) -> Option<(f64, f64)> {
    if orient2d(s.0, s.1, t.0) != 0.0 || orient2d(s.0, s.1, t.1) != 0.0 {
        return None;
    }
    let (along, across) = ((s.1.x - s.0.x).abs(), (s.1.y - s.0.y).abs());
    let key = |p: Point2| if along >= across { p.x } else { p.y };
    let range = |w: Wall| (key(w.0).min(key(w.1)), key(w.0).max(key(w.1)));
    let ((a, b), (c, d)) = (range(s), range(t));
    let (lo, hi) = (a.max(c), b.min(d));
    (lo < hi).then_some((lo, hi))
}

/// Length that a set of intervals covers.
fn covered(mut intervals: Vec<(f64, f64)>) -> f64 {
    intervals.sort_by(|p, q| p.0.total_cmp(&q.0));
    let mut end = f64::NEG_INFINITY;
    let mut sum = 0.0;
    for (lo, hi) in intervals {
        sum += (hi - lo.max(end)).max(0.0);
        end = end.max(hi);
    }
    sum
}

/// Every side of every cell is wall, portal or hull, and never two of them. Walls may overlap; a part of a side is hull
/// if no other cell touches it.
fn check_sides(graph: &CellGraph<Planar>, walls: &[Wall]) {
    for id in graph.cell_ids() {
        let polygon = &graph.cell(id).polygon;
        for i in 0..polygon.len() {
            let side = (polygon[i], polygon[(i + 1) % polygon.len()]);
            let wall: Vec<_> = walls.iter().filter_map(|&w| overlap(side, w)).collect();
            let doors: Vec<_> = graph
                .exits(id)
                .iter()
                .map(|e| graph.crossing(e))
                .filter_map(|d| overlap(side, (d.right, d.left)))
                .collect();
            let shared: Vec<_> = graph
                .cell_ids()
                .filter(|&other| other != id)
                .flat_map(|other| {
                    let p = &graph.cell(other).polygon;
                    (0..p.len()).filter_map(move |k| overlap(side, (p[k], p[(k + 1) % p.len()])))
                })
                .collect();
            let both = covered(wall.iter().chain(&doors).copied().collect());
            assert_eq!(both, covered(wall.clone()) + covered(doors.clone()), "a portal lies on a wall");
            let open = covered(wall.iter().chain(&shared).copied().collect()) - covered(wall);
            assert_eq!(covered(doors), open, "an opening between cells has no portal");
        }
    }
}

proptest! {
    /// Invariant: walls run along sides, sides without walls are portals, cells fill the hull.
    #[test]
    fn cells_fit_walls_exactly(walls in walls(7, 10)) {
        let walls = flat(walls);
        let Some(graph) = cut(&walls) else { return Ok(()) };
        for cell in graph.cells() {
            for &wall in &walls {
                prop_assert!(!enters(&cell.polygon, wall), "{:?} enters {:?}", wall, cell.polygon);
            }
        }
        check_sides(&graph, &walls);
        let area: f64 = graph.cells().iter().map(|c| signed_area(&c.polygon)).sum();
        prop_assert_eq!(area, hull_area(&walls));
    }

    /// Invariant: after noding, pieces meet in common ends only, whatever crosses.
    #[test]
    fn noded_pieces_meet_in_ends(walls in walls(6, 9)) {
        let plan = Plan::from_walls(walls).unwrap();
        let noded = noding::node(&plan).unwrap();
        for (i, p) in noded.pieces.iter().enumerate() {
            for q in &noded.pieces[..i] {
                let (s, t) = (Segment2::new(p.a, p.b), Segment2::new(q.a, q.b));
                let inside = |s: &Segment2, p: Point2| p != s.a && p != s.b && s.contains(p);
                prop_assert!(!s.crosses(&t), "{:?} {:?}", p, q);
                prop_assert!(![t.a, t.b].iter().any(|&p| inside(&s, p)));
                prop_assert!(![s.a, s.b].iter().any(|&p| inside(&t, p)));
            }
        }
    }

    /// Invariant: a line between two points of a fine grid that misses every wall misses every piece
    /// (soundness), and one that crosses a wall well away from ends and crossings crosses a piece
    /// (tightness).
    #[test]
    fn noding_errs_towards_visible(walls in walls(6, 9), lines in proptest::collection::vec((point(61), point(61)), 40)) {
        let plan = Plan::from_walls(walls.iter().copied()).unwrap();
        let noded = noding::node(&plan).unwrap();
        let crosses_piece = |s: &Segment2| noded.pieces.iter().any(|p| s.crosses(&Segment2::new(p.a, p.b)));
        for (p, q) in lines {
            let s = Segment2::new(p * 0.125 - Point2::splat(0.9375), q * 0.125 - Point2::splat(0.9375));
            if p == q {
                continue;
            }
            let meets = walls.iter().any(|&(a, b)| s.meets(&Segment2::new(a, b)));
            if !meets {
                prop_assert!(!crosses_piece(&s), "{:?} is free but blocked", s);
            }
            // A determinant above 1e-6 means a distance above 9e-8, for no segment here is longer than
            // 11; a bent piece is within 2^-49 * 8, 1e-14, of its wall. So what crosses the wall at
            // that distance from all ends of pieces crosses a piece.
            let clear = |&&(a, b): &&Wall| {
                let w = Segment2::new(a, b);
                s.crosses(&w) && noded.pieces.iter().all(|k| {
                    let far = |e: Point2| orient2d(s.a, s.b, e).abs() > 1e-6;
                    far(k.a) && far(k.b)
                })
            };
            if walls.iter().find(clear).is_some() {
                prop_assert!(crosses_piece(&s), "{:?} is blocked but free", s);
            }
        }
    }
}

fn hull_area(walls: &[Wall]) -> f64 {
    let mut points: Vec<Point2> = walls.iter().flat_map(|w| [w.0, w.1]).collect();
    points.sort_by(|p, q| p.x.total_cmp(&q.x).then(p.y.total_cmp(&q.y)));
    points.dedup();
    let half = |points: &mut dyn Iterator<Item = Point2>| {
        let mut chain: Vec<Point2> = Vec::new();
        for p in points {
            while chain.len() >= 2 && orient2d(chain[chain.len() - 2], chain[chain.len() - 1], p) <= 0.0 {
                chain.pop();
            }
            chain.push(p);
        }
        chain.pop();
        chain
    };
    let mut hull = half(&mut points.iter().copied());
    hull.extend(half(&mut points.iter().rev().copied()));
    signed_area(&hull)
}

/// The impostor of the side check: a graph cut without one of the walls does not fit.
#[test]
fn a_forgotten_wall_is_noticed() {
    let p = Point2::new;
    let corners = [p(0., 0.), p(6., 0.), p(6., 6.), p(0., 6.)];
    let mut walls: Vec<Wall> = (0..4).map(|i| (corners[i], corners[(i + 1) % 4])).collect();
    let graph = cut(&walls).unwrap();
    walls.push((p(1., 2.), p(5., 3.)));
    let entered = graph.cells().iter().any(|c| enters(&c.polygon, walls[4]));
    let sides = std::panic::catch_unwind(|| check_sides(&graph, &walls));
    assert!(entered || sides.is_err());
    check_sides(&cut(&walls).unwrap(), &walls);
}

/// Number of sets of cells joined by portals.
fn n_parts(graph: &CellGraph<Planar>) -> usize {
    let mut reached = vec![false; graph.n_cells()];
    let mut parts = 0;
    for start in graph.cell_ids() {
        let mut stack = vec![start];
        parts += usize::from(!reached[start.idx()]);
        while let Some(cell) = stack.pop() {
            if !std::mem::replace(&mut reached[cell.idx()], true) {
                stack.extend(graph.exits(cell).iter().map(|e| e.to));
            }
        }
    }
    parts
}

#[test]
fn a_wall_that_stops_an_ulp_short_leaves_a_way_and_one_that_touches_does_not() {
    let p = Point2::new;
    let corners = [p(0., 0.), p(4., 0.), p(4., 4.), p(0., 4.)];
    for (top, parts) in [(4f64.next_down(), 1), (4.0, 2)] {
        let mut walls: Vec<Wall> = (0..4).map(|i| (corners[i], corners[(i + 1) % 4])).collect();
        walls.push((p(1., 0.), p(1., top)));
        assert_eq!(n_parts(&cut(&walls).unwrap()), parts, "wall up to {top}");
    }
}

#[test]
fn groups_fill_their_regions_and_disputes_keep_all() {
    let p = Point2::new;
    let corners = [p(0., 0.), p(6., 0.), p(6., 4.), p(0., 4.)];
    let mut lines: Vec<PlanLine> = (0..4).map(|i| PlanLine::wall(corners[i], corners[(i + 1) % 4])).collect();
    let door =
        |left, right| PlanLine { a: p(3., 0.), b: p(3., 4.), opaque: false, left: Some(left), right: Some(right) };
    lines.push(door(4, 7));
    let (graph, summary) = subdivide(&Plan::new(lines.clone(), vec![]).unwrap()).unwrap();
    let groups: Vec<_> = graph.cells().iter().map(|c| (c.bounds().min[0], c.groups.clone())).collect();
    assert!(groups.iter().all(|(x, g)| *g == if *x < 3. { vec![4] } else { vec![7] }), "{groups:?}");
    assert_eq!(summary.n_disputed_cells, 0);
    // The region's outer wall names another sector on the same side: both are kept.
    lines[3].left = Some(5);
    let (graph, summary) = subdivide(&Plan::new(lines, vec![]).unwrap()).unwrap();
    assert!(graph.cells().iter().any(|c| c.groups == [4, 5]));
    assert!(summary.n_disputed_cells > 0);
}

#[test]
fn plans_without_a_region_are_errors() {
    assert!(subdivide(&Plan::from_walls([]).unwrap()).is_err());
    assert!(subdivide(&Plan::from_walls([(Point2::ZERO, Point2::new(3., 1.))]).unwrap()).is_err());
}
