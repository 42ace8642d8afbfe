//! The part of a line of sight that is drawn: from inside the first cell to inside the last.

use sightlines_cells::{CellGraph, Convex};
use sightlines_geometry::{Point2, Portal2};
use sightlines_sightline::{Line3, PlanarWitness};
use sightlines_stabtree::ConvexGate;

/// Two points on the line, rounded: halfway between the first door and the far side of the first cell,
/// and likewise in the last cell. `None` for no doors.
pub(super) fn ends_in_plan(
    [first, last]: [&[Point2]; 2],
    doors: &[Portal2],
    witness: &PlanarWitness,
) -> Option<[Point2; 2]> {
    let (entry, exit) = (doors.first()?, doors.last()?);
    let [p, q] = [witness.crossing(*entry), witness.crossing(*exit)];
    // One door, or two that the line crosses in one point: straight through the door.
    let across = entry.left - entry.right;
    let direction = if p == q { Point2::new(across.y, -across.x) } else { q - p };
    Some([p - direction * (0.5 * reach(first, p, -direction)), q + direction * (0.5 * reach(last, q, direction))])
}

/// How many times `direction` fits between `p` and where the ray from it leaves the convex polygon.
fn reach(polygon: &[Point2], p: Point2, direction: Point2) -> f64 {
    let sides = (0..polygon.len()).map(|i| (polygon[i], polygon[(i + 1) % polygon.len()]));
    let leaves = |(a, b): (Point2, Point2)| {
        let side = b - a;
        let speed = side.perp_dot(direction);
        // Going out means going to the right of the side; how long it takes is distance over speed.
        (speed < 0.0).then(|| (side.perp_dot(a - p) / speed).max(0.0))
    };
    let least = sides.filter_map(leaves).fold(f64::INFINITY, f64::min);
    if least.is_finite() { least } else { 0.0 }
}

/// A little beyond the first and the last portal: clusters have no points of their own.
pub(super) fn ends_of_gates(graph: &CellGraph<Convex>, gates: &[ConvexGate], line: &Line3) -> Option<[[f64; 3]; 2]> {
    let [first, last] = [gates.first()?, gates.last()?].map(|gate| gate.crossing(graph, line));
    let step: [f64; 3] = std::array::from_fn(|k| line.b[k] - line.a[k]);
    let length = step.iter().map(|x| x * x).sum::<f64>().sqrt();
    let size = |gate: &ConvexGate| {
        let shape = &graph.portal(gate.portal).shape;
        let corner = shape.corners().first()?;
        Some(
            shape
                .corners()
                .iter()
                .map(|p| (0..3).map(|k| (p[k] - corner[k]).abs()).fold(0.0, f64::max))
                .fold(0.0, f64::max),
        )
    };
    let beyond = |p: [f64; 3], far: f64| std::array::from_fn(|k| p[k] + far * step[k] / length);
    let ends = [beyond(first, -0.25 * size(gates.first()?)?), beyond(last, 0.25 * size(gates.last()?)?)];
    ends.iter().flatten().all(|x| x.is_finite()).then_some(ends)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(x: f64, y: f64) -> [Point2; 4] {
        [(0., 0.), (2., 0.), (2., 2.), (0., 2.)].map(|(dx, dy)| Point2::new(x + dx, y + dy))
    }

    #[test]
    fn lines_reach_into_both_cells() {
        let door = Portal2 { left: Point2::new(2., 2.), right: Point2::new(2., 0.) };
        let witness = PlanarWitness::through(Point2::new(0., 1.), Point2::new(4., 1.));
        let line = ends_in_plan([&square(0., 0.), &square(2., 0.)], &[door], &witness);
        assert_eq!(line, Some([Point2::new(1., 1.), Point2::new(3., 1.)]));
        let far = Portal2 { left: Point2::new(6., 2.), right: Point2::new(6., 0.) };
        let line = ends_in_plan([&square(0., 0.), &square(6., 0.)], &[door, far], &witness);
        assert_eq!(line, Some([Point2::new(1., 1.), Point2::new(7., 1.)]));
        assert_eq!(ends_in_plan([&square(0., 0.), &square(2., 0.)], &[], &witness), None);
    }
}
