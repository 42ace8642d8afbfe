//! The walls of a plan: the sides of cells where no portal is.

use sightlines_geometry::{Point2, Segment2};
use sightlines_pvs::CellRecord;

/// The corners of a planar cell, counter-clockwise: its polygon, or its box.
pub(crate) fn corners(cell: &CellRecord) -> Vec<Point2> {
    if !cell.polygon.is_empty() {
        return cell.polygon.iter().map(|&[x, y]| Point2::new(x, y)).collect();
    }
    let ([x0, y0, _], [x1, y1, _]) = (cell.min, cell.max);
    [(x0, y0), (x1, y0), (x1, y1), (x0, y1)].map(|(x, y)| Point2::new(x, y)).to_vec()
}

/// The two ends of a portal of a planar table.
pub(crate) fn ends(points: &[[f64; 3]]) -> Option<Segment2> {
    let [[ax, ay, _], [bx, by, _]] = points else { return None };
    Some(Segment2::new(Point2::new(*ax, *ay), Point2::new(*bx, *by)))
}

/// A convex piece of a plane, and the doors on its sides.
#[derive(Debug, Clone, Default)]
pub(crate) struct Outline<'a> {
    /// Counter-clockwise; empty for nothing.
    pub(crate) corners: &'a [Point2],
    /// In any order and direction.
    pub(crate) doors: Vec<Segment2>,
}

/// What is left of the sides of all outlines when their doors are taken out, each piece once.
///
/// O(outlines * doors of an outline).
pub(crate) fn walls(outlines: &[Outline<'_>]) -> Vec<Segment2> {
    let mut walls: Vec<Segment2> = Vec::new();
    for Outline { corners, doors } in outlines {
        for i in 0..corners.len() {
            closed_pieces(Segment2::new(corners[i], corners[(i + 1) % corners.len()]), doors, &mut walls);
        }
    }
    let key = |s: &Segment2| [s.a.x, s.a.y, s.b.x, s.b.y].map(sortable);
    walls.iter_mut().filter(|s| [s.b.x, s.b.y].map(sortable) < [s.a.x, s.a.y].map(sortable)).for_each(|s| {
        std::mem::swap(&mut s.a, &mut s.b);
    });
    walls.sort_by_key(key);
    walls.dedup();
    walls
}

/// Bits that sort as the numbers do.
fn sortable(x: f64) -> u64 {
    let bits = x.to_bits();
    if bits >> 63 == 0 { bits | 1 << 63 } else { !bits }
}

/// Appends the pieces of `side` that no door covers. Which doors lie on the side is decided exactly.
fn closed_pieces(side: Segment2, doors: &[Segment2], pieces: &mut Vec<Segment2>) {
    // Along the longer extent of the side, positions are coordinates, so nothing is rounded.
    let by_x = (side.b.x - side.a.x).abs() >= (side.b.y - side.a.y).abs();
    let at = |p: Point2| if by_x { p.x } else { p.y };
    let rising = at(side.a) < at(side.b);
    let (low, high) = if rising { (side.a, side.b) } else { (side.b, side.a) };
    let mut open: Vec<(Point2, Point2)> = doors
        .iter()
        .filter(|d| side.contains(d.a) && side.contains(d.b))
        .map(|d| if at(d.a) <= at(d.b) { (d.a, d.b) } else { (d.b, d.a) })
        .collect();
    open.sort_by(|p, q| at(p.0).total_cmp(&at(q.0)));
    let mut from = low;
    for (start, end) in open {
        if at(start) > at(from) {
            pieces.push(Segment2::new(from, start));
        }
        if at(end) > at(from) {
            from = end;
        }
    }
    if at(high) > at(from) {
        pieces.push(Segment2::new(from, high));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn s(ax: f64, ay: f64, bx: f64, by: f64) -> Segment2 {
        Segment2::new(Point2::new(ax, ay), Point2::new(bx, by))
    }

    fn pieces(side: Segment2, doors: &[Segment2]) -> Vec<Segment2> {
        let mut pieces = Vec::new();
        closed_pieces(side, doors, &mut pieces);
        pieces
    }

    #[test]
    fn doors_are_taken_out_of_sides() {
        let side = s(0., 0., 8., 4.);
        assert_eq!(pieces(side, &[]), [side]);
        assert_eq!(pieces(side, &[s(4., 2., 2., 1.)]), [s(0., 0., 2., 1.), s(4., 2., 8., 4.)]);
        assert_eq!(pieces(side, &[s(4., 2., 8., 4.), s(0., 0., 4., 2.)]), []);
        // A door of another side, which only touches this one, takes nothing away.
        assert_eq!(pieces(side, &[s(8., 4., 8., 0.), s(2., 1., 2., 3.)]), [side]);
    }

    #[test]
    fn sides_in_any_direction_are_cut() {
        assert_eq!(pieces(s(0., 5., 0., 0.), &[s(0., 5., 0., 4.)]), [s(0., 0., 0., 4.)]);
        assert_eq!(pieces(s(5., 0., 0., 0.), &[s(1., 0., 2., 0.)]), [s(0., 0., 1., 0.), s(2., 0., 5., 0.)]);
    }

    proptest! {
        /// Invariant: a point of a side is on a piece of wall if and only if no door covers it.
        #[test]
        fn walls_are_where_doors_are_not(
            direction in (-2i32..3, -2i32..3).prop_filter("a side has a direction", |&d| d != (0, 0)),
            doors in proptest::collection::vec((0i32..10, 0i32..10), 0..4),
        ) {
            let at = |t: f64| Point2::new(f64::from(direction.0) * t, f64::from(direction.1) * t);
            let side = Segment2::new(at(0.0), at(9.0));
            let doors: Vec<(f64, f64)> = doors.iter().map(|&(a, b)| (f64::from(a), f64::from(b))).collect();
            let segments: Vec<Segment2> = doors.iter().map(|&(a, b)| Segment2::new(at(a), at(b))).collect();
            let walls = pieces(side, &segments);
            for t in (0..9).map(|i| f64::from(i) + 0.5) {
                let door = doors.iter().any(|&(a, b)| a.min(b) < t && t < a.max(b));
                prop_assert_eq!(walls.iter().any(|w| w.contains(at(t))), !door, "at {}", t);
            }
        }
    }

    #[test]
    fn sorting_bits_sorts_numbers() {
        let numbers = [-7.5, -1.0, 0.0, 1e-300, 2.0, 1e200];
        assert!(numbers.map(sortable).is_sorted());
    }
}
