//! Small plans of cases that occur in real plans and are excluded in textbooks: one family, one plan.
//!
//! Most are closed by a box, so that a subdivision has an inside; none names a group.

use sightlines_cells::{Plan, PlanLine};
use sightlines_geometry::Point2;

/// A wall as `[ax, ay, bx, by]`.
type Wall = [f64; 4];

/// Every family with its name, in a fixed order.
pub fn all() -> Vec<(&'static str, Plan)> {
    let families = [
        ("empty", Vec::new()),
        ("lone-wall", vec![[0., 0., 3., 1.]]),
        ("shared-end-points", shared_end_points()),
        ("collinear-doors", collinear_doors()),
        ("lined-up-door-ends", lined_up_door_ends()),
        ("slivers", slivers()),
        ("zero-width-doors", zero_width_doors()),
        ("one-ulp-doors", one_ulp_doors()),
        ("one-ulp-pinholes", one_ulp_pinholes()),
        ("t-junctions", t_junctions()),
        ("oblique-t-junctions", oblique_t_junctions()),
        ("axial-crossings", axial_crossings()),
        ("oblique-crossings", oblique_crossings()),
        ("concurrent-crossings", concurrent_crossings()),
        ("collinear-overlaps", collinear_overlaps()),
        ("oblique-overlaps", oblique_overlaps()),
        ("almost-collinear-overlaps", almost_collinear_overlaps()),
        ("duplicate-walls", duplicate_walls()),
        ("spurs", spurs()),
        ("star", star()),
        ("islands", islands()),
        ("touching-corners", touching_corners()),
        ("nested-boxes", nested_boxes()),
        ("flat-pockets", flat_pockets()),
        ("far-from-origin", moved(&collinear_doors(), 1e6)),
        ("very-far-from-origin", moved(&oblique_crossings(), 1e9)),
        ("huge", scaled(&star(), 1e9)),
        ("tiny", scaled(&slivers(), 2f64.powi(-100))),
        ("mixed-scales", mixed_scales()),
        ("open-to-outside", open_to_outside()),
    ];
    families.map(|(name, walls)| (name, plan(&walls))).into()
}

fn plan(walls: &[Wall]) -> Plan {
    let wall = |&[ax, ay, bx, by]: &Wall| PlanLine::wall(Point2::new(ax, ay), Point2::new(bx, by));
    Plan::new(walls.iter().map(wall).collect(), Vec::new()).expect("hand-made walls have a length")
}

/// The box from (0, 0) to (w, h), then `walls`.
fn boxed(w: f64, h: f64, walls: &[Wall]) -> Vec<Wall> {
    let sides = [[0., 0., w, 0.], [w, 0., w, h], [w, h, 0., h], [0., h, 0., 0.]];
    sides.iter().chain(walls).copied().collect()
}

fn moved(walls: &[Wall], by: f64) -> Vec<Wall> {
    walls.iter().map(|w| w.map(|x| x * 0.125 + by)).collect()
}

fn scaled(walls: &[Wall], by: f64) -> Vec<Wall> {
    walls.iter().map(|w| w.map(|x| x * by)).collect()
}

/// Fans of walls that share an end point, and doors that share a jamb.
fn shared_end_points() -> Vec<Wall> {
    let fan = [[4., 4., 6., 4.], [4., 4., 4., 6.], [4., 4., 2., 2.], [4., 4., 6., 7.], [0., 0., 1., 2.]];
    let jamb = [[6., 4., 8., 4.], [6., 0., 6., 3.], [0., 8., 2., 6.], [2., 6., 2., 2.]];
    boxed(8., 8., &[&fan[..], &jamb].concat())
}

/// Two walls, each interrupted by five doors in one line; the doors of both face each other.
fn collinear_doors() -> Vec<Wall> {
    let pieces = [[0., 1.], [2., 3.], [4., 5.], [6., 7.], [8., 9.], [10., 11.]];
    let walls: Vec<Wall> = [3., 5.].iter().flat_map(|&x| pieces.map(|[lo, hi]| [x, lo, x, hi])).collect();
    boxed(8., 11., &walls)
}

/// Doors of three walls whose ends all lie on one oblique line: only grazing lines pass.
fn lined_up_door_ends() -> Vec<Wall> {
    let walls =
        [[2., 0., 2., 2.], [2., 4., 2., 12.], [4., 0., 4., 4.], [4., 6., 4., 12.], [6., 0., 6., 1.], [6., 6., 6., 12.]];
    boxed(8., 12., &[&walls[..], &[[5., 0., 5., 5.]]].concat())
}

/// Long rooms of almost no width, and very small angles.
fn slivers() -> Vec<Wall> {
    let walls = [
        [0., 0., 1000., 1.],
        [0., 0., 1000., 2.],
        [0., 8., 999., 9.],
        [1., 8., 1000., 9.],
        [0., 4., 1000., 4.],
        [0., 4.125, 1000., 4.],
        [500., 5., 501., 7.],
    ];
    boxed(1000., 16., &walls)
}

/// Walls that meet exactly where one would expect a door.
fn zero_width_doors() -> Vec<Wall> {
    boxed(9., 6., &[[3., 0., 3., 2.], [3., 2., 3., 6.], [6., 0., 6., 3.], [6., 3., 6., 6.], [3., 2., 6., 3.]])
}

/// Walls that stop short of each other by one unit in the last place, along and across an axis.
fn one_ulp_doors() -> Vec<Wall> {
    let y = 0.1;
    let walls = [
        [0.5, 0., 0.5, y],
        [0.5, f64::next_up(y), 0.5, 1.],
        [0.7, 0., f64::next_down(0.7), 1.],
        [0.7, 0.3, f64::next_down(1.), 0.3],
        [0.1, f64::next_up(0.), 0.3, 0.6],
    ];
    // The smallest step above 0 is not a valid coordinate: the wall stops short of the floor by 2^-140.
    let walls = walls.map(|w| w.map(|x| if x == f64::next_up(0.) { 2f64.powi(-140) } else { x }));
    boxed(1., 1., &walls)
}

/// Holes of one unit in the last place in three walls; a line passes all of them, and the hole in the fourth wall is
/// just off that line.
fn one_ulp_pinholes() -> Vec<Wall> {
    let (low, high) = (f64::next_down(0.5), f64::next_up(0.5));
    let holed = |x: f64, lo: f64, hi: f64| [[x, 0., x, lo], [x, hi, x, 1.]];
    boxed(1., 1., &[holed(0.2, low, 0.5), holed(0.4, low, 0.5), holed(0.6, low, 0.5), holed(0.8, 0.5, high)].concat())
}

/// Walls that end on the inside of another, without a shared vertex.
fn t_junctions() -> Vec<Wall> {
    boxed(8., 8., &[[0., 4., 6., 4.], [3., 0., 3., 4.], [3., 4., 3., 7.], [6., 2., 6., 8.], [6., 5., 8., 5.]])
}

/// The same with meeting points that no double represents: walls that end as near as doubles permit.
fn oblique_t_junctions() -> Vec<Wall> {
    let third = 1.0 / 3.0;
    let walls = [
        [0., 0., 3., 1.],
        [1., third, 0.5, 3.],
        [2., 2.0 * third, 2.5, 3.],
        [2., f64::next_up(2.0 * third), 1., 2.],
        [1., f64::next_down(third), 3., 0.],
    ];
    boxed(3., 3., &walls)
}

fn axial_crossings() -> Vec<Wall> {
    boxed(9., 9., &[[3., -1., 3., 6.], [6., 3., 6., 10.], [-1., 3., 7., 3.], [2., 6., 10., 6.], [3., 5., 3., 8.]])
}

/// Walls that cross in points that no double represents.
fn oblique_crossings() -> Vec<Wall> {
    boxed(10., 10., &[[1., 1., 8., 9.], [1., 8., 9., 2.], [4., 0., 5., 10.], [0., 5., 10., 6.], [2., 3., 11., 7.]])
}

/// Walls that all cross in (10/3, 10/3), which no double represents.
fn concurrent_crossings() -> Vec<Wall> {
    let walls = [[1., 1., 9., 9.], [0., 5., 10., 0.], [5., 0., 0., 10.], [2., 6., 4., 2.], [6., 2., 2., 4.]];
    boxed(10., 10., &walls)
}

fn collinear_overlaps() -> Vec<Wall> {
    let walls = [
        [1., 3., 6., 3.],
        [4., 3., 8., 3.],
        [5., 3., 2., 3.],
        [4., 0., 4., 5.],
        [4., 5., 4., 2.],
        [0., 0., 5., 0.],
        [3., 10., 12., 10.],
    ];
    boxed(10., 10., &walls)
}

fn oblique_overlaps() -> Vec<Wall> {
    boxed(10., 10., &[[0., 0., 6., 4.], [3., 2., 9., 6.], [6., 4., 3., 2.], [1., 8., 5., 6.], [3., 7., 7., 5.]])
}

/// Walls that overlap except for one unit in the last place at an end.
fn almost_collinear_overlaps() -> Vec<Wall> {
    let walls = [
        [0.1, 0.2, 0.9, 0.6],
        [0.1, 0.2, 0.9, f64::next_up(0.6)],
        [0.1, f64::next_down(0.2), 0.9, 0.6],
        [0.3, 0.3, 0.7, 0.5],
        [0.5, 0.7, 0.5, 0.9],
        [f64::next_up(0.5), 0.7, 0.5, 0.9],
    ];
    boxed(1., 1., &walls)
}

fn duplicate_walls() -> Vec<Wall> {
    let wall = [2., 1., 3., 5.];
    let turned = [3., 5., 2., 1.];
    boxed(6., 6., &[wall, wall, turned, [4., 0., 4., 6.], [4., 6., 4., 0.], [0., 0., 6., 0.]])
}

/// Walls that end inside a room.
fn spurs() -> Vec<Wall> {
    let walls = [
        [0., 3., 3., 3.],
        [3., 3., 3., 4.],
        [3., 4., 2., 5.],
        [10., 5., 6., 5.],
        [5., 0., 5., 4.],
        [5., 10., 5., 6.],
        [8., 8., 9., 9.],
    ];
    boxed(10., 10., &walls)
}

/// Sixteen walls that meet in one point.
fn star() -> Vec<Wall> {
    let rays = [(4., 0.), (4., 1.), (3., 3.), (1., 4.)];
    let turned = rays.iter().flat_map(|&(x, y)| [(x, y), (-y, x), (-x, -y), (y, -x)]);
    boxed(10., 10., &turned.map(|(x, y)| [5., 5., 5. + x, 5. + y]).collect::<Vec<_>>())
}

/// Walls and rings that touch nothing.
fn islands() -> Vec<Wall> {
    let square = [[3., 3., 4., 3.], [4., 3., 4., 4.], [4., 4., 3., 4.], [3., 4., 3., 3.]];
    let diamond = [[7., 5., 8., 6.], [8., 6., 7., 7.], [7., 7., 6., 6.], [6., 6., 7., 5.]];
    boxed(10., 10., &[&square[..], &diamond, &[[1., 8., 4., 9.], [5., 2., 9., 2.]]].concat())
}

/// Rings that touch in a corner only: no door between the rooms on either side.
fn touching_corners() -> Vec<Wall> {
    let ring = |x: f64, y: f64| {
        [[x, y, x + 2., y], [x + 2., y, x + 2., y + 2.], [x + 2., y + 2., x, y + 2.], [x, y + 2., x, y]]
    };
    boxed(10., 8., &[ring(2., 2.), ring(4., 4.), ring(6., 2.), ring(8., 6.)].concat())
}

/// Rooms around rooms, without doors.
fn nested_boxes() -> Vec<Wall> {
    let ring = |d: f64| {
        let e = 12. - d;
        [[d, d, e, d], [e, d, e, e], [e, e, d, e], [d, e, d, d]]
    };
    boxed(12., 12., &[ring(1.), ring(2.), ring(5.)].concat())
}

/// Closed rings without any area, isolated and along a wall.
fn flat_pockets() -> Vec<Wall> {
    let walls = [
        [1., 1., 4., 1.],
        [4., 1., 2., 1.],
        [2., 1., 1., 1.],
        [0., 0., 0., 3.],
        [0., 3., 0., 0.],
        [2., 3., 6., 5.],
        [6., 5., 4., 4.],
        [4., 4., 2., 3.],
    ];
    boxed(8., 8., &walls)
}

/// A room of a millionth of a unit inside a room of a million units.
fn mixed_scales() -> Vec<Wall> {
    let s = 2f64.powi(-20);
    let small = boxed(s, s, &[[0.5 * s, 0., 0.5 * s, 0.25 * s]]);
    let big = boxed(1048576., 1048576., &[[s, s, 1048576., 1048576.], [0., 2. * s, 524288., 1048576.]]);
    [small, big].concat()
}

/// A box with an open side: the inside is connected with the unbounded outside.
fn open_to_outside() -> Vec<Wall> {
    vec![[0., 0., 6., 0.], [6., 0., 6., 6.], [6., 6., 0., 6.], [3., 0., 3., 4.], [-4., 3., -2., 3.], [-3., 5., -3., 1.]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::check::{checksum, crossings};
    use sightlines_geometry::orient2d;
    use std::collections::BTreeSet;

    #[test]
    fn degenerate_families_are_counted_and_named_once() {
        let families = all();
        assert_eq!(families.len(), 30);
        let names: BTreeSet<&str> = families.iter().map(|(name, _)| *name).collect();
        assert_eq!(names.len(), families.len());
        let n_empty = families.iter().filter(|(_, p)| p.lines().is_empty()).count();
        assert_eq!(n_empty, 1);
    }

    #[test]
    fn degenerate_families_are_deterministic() {
        let sum = all().iter().map(|(_, p)| checksum(p)).fold(0u64, |s, c| s.rotate_left(5) ^ c);
        assert_eq!(sum, PINNED);
    }

    const PINNED: u64 = 14508295383940906062;

    fn family(wanted: &str) -> Plan {
        all().into_iter().find(|(name, _)| *name == wanted).unwrap().1
    }

    /// The families have the properties in their names.
    #[test]
    fn degenerate_families_are_degenerate() {
        for name in ["t-junctions", "axial-crossings", "oblique-crossings", "collinear-overlaps", "duplicate-walls"] {
            assert!(crossings(&family(name)) > 0, "{name}");
        }
        for name in ["islands", "nested-boxes"] {
            assert_eq!(crossings(&family(name)), 0, "{name}");
        }
        let star = family("star");
        assert_eq!(star.lines().iter().filter(|l| l.a == Point2::new(5., 5.)).count(), 16);
        assert!(family("axial-crossings").is_axial() && !family("oblique-crossings").is_axial());
        assert!(family("tiny").bounds().max[0] < 1e-20 && family("huge").bounds().max[0] == 1e10);
        assert!(family("very-far-from-origin").bounds().min[0] == 1e9);
    }

    /// Concurrent walls do meet in one point, and the gaps of one ulp exist.
    #[test]
    fn degenerate_points_are_where_they_should_be() {
        let third = Point2::new(10., 10.);
        for l in &family("concurrent-crossings").lines()[4..] {
            assert_eq!(orient2d(l.a * 3., l.b * 3., third), 0.0, "{l:?}");
        }
        let gaps = family("one-ulp-doors");
        assert_eq!(gaps.lines()[4].b.y.next_up(), gaps.lines()[5].a.y);
    }
}
