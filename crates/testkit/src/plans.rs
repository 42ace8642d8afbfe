//! Strategies for plans and convex regions on small integer grids.

use proptest::collection::SizeRange;
use proptest::prelude::*;
use sightlines_cells::Plan;
use sightlines_geometry::Point2;

/// Grids go from 0 to this.
const SIDE: i32 = 8;

type Grid = [i32; 2];
type Wall = [Grid; 2];

fn point([x, y]: Grid) -> Point2 {
    Point2::new(f64::from(x), f64::from(y))
}

fn plan(walls: Vec<Wall>, boxed: bool) -> Plan {
    let s = SIDE;
    let sides = [[[0, 0], [s, 0]], [[s, 0], [s, s]], [[s, s], [0, s]], [[0, s], [0, 0]]];
    let sides = sides.into_iter().filter(|_| boxed);
    Plan::from_walls(walls.into_iter().chain(sides).map(|[a, b]| (point(a), point(b))))
        .expect("walls on the grid have a length")
}

fn grid() -> impl Strategy<Value = Grid> {
    [0..=SIDE, 0..=SIDE]
}

/// `n_lines` opaque walls on the grid from 0 to 8, half the time with a box around them. They cross,
/// overlap, repeat, touch and line up as chance has it; few directions make that common.
pub fn small_grid_plan(n_lines: impl Into<SizeRange>) -> impl Strategy<Value = Plan> {
    let any_wall = (grid(), grid()).prop_map(|(a, b)| [a, b]);
    let short_wall = (grid(), [-2i32..=2, -2i32..=2]).prop_map(|(a, [dx, dy])| [a, [a[0] + dx, a[1] + dy]]);
    let wall = prop_oneof![2 => axial_wall(), 1 => any_wall, 1 => short_wall];
    let wall = wall.prop_filter("of some length", |[a, b]| a != b);
    (prop::collection::vec(wall, n_lines), any::<bool>()).prop_map(|(walls, boxed)| plan(walls, boxed))
}

/// As [`small_grid_plan`], with walls parallel to the axes only.
pub fn axial_plan(n_lines: impl Into<SizeRange>) -> impl Strategy<Value = Plan> {
    (prop::collection::vec(axial_wall(), n_lines), any::<bool>()).prop_map(|(walls, boxed)| plan(walls, boxed))
}

fn axial_wall() -> impl Strategy<Value = Wall> {
    (any::<bool>(), 0..=SIDE, 0..SIDE, 0..SIDE, any::<bool>()).prop_map(|(horizontal, at, from, length, back)| {
        let to = from + 1 + length % (SIDE - from);
        let [a, b] = if horizontal { [[from, at], [to, at]] } else { [[at, from], [at, to]] };
        if back { [b, a] } else { [a, b] }
    })
}

/// A convex polygon of 3 to 5 corners on the grid from 0 to 8, counter-clockwise.
pub fn convex_polygon() -> impl Strategy<Value = Vec<Point2>> {
    let corner = || (0..=SIDE, 0..=SIDE);
    let set = prop_oneof![
        prop::collection::vec(corner(), 5),
        // Small boxes and triangles, so that walls find room between two of them.
        (0..SIDE, 0..SIDE, 1i32..=2, 1i32..=2).prop_map(|(x, y, w, h)| vec![
            (x, y),
            (x + w, y),
            (x, y + h),
            (x + w, y + h)
        ]),
        (0..SIDE, 0..SIDE, 1i32..=2, 1i32..=2).prop_map(|(x, y, w, h)| vec![(x, y), (x + w, y), (x, y + h)]),
    ];
    set.prop_filter_map("corners that are not collinear", |set| {
        let hull = hull(set);
        (hull.len() >= 3).then(|| hull.into_iter().map(|(x, y)| point([x, y])).collect())
    })
}

/// Corners of the convex hull, counter-clockwise (monotone chain); fewer than 3 if it has no area.
fn hull(mut points: Vec<(i32, i32)>) -> Vec<(i32, i32)> {
    points.sort_unstable();
    points.dedup();
    let turn = |p: (i32, i32), q: (i32, i32), r: (i32, i32)| (q.0 - p.0) * (r.1 - p.1) - (q.1 - p.1) * (r.0 - p.0);
    let chain = |points: &mut dyn Iterator<Item = (i32, i32)>| {
        let mut chain: Vec<(i32, i32)> = Vec::new();
        for p in points {
            while chain.len() >= 2 && turn(chain[chain.len() - 2], chain[chain.len() - 1], p) <= 0 {
                chain.pop();
            }
            chain.push(p);
        }
        chain.pop();
        chain
    };
    let mut hull = chain(&mut points.iter().copied());
    hull.extend(chain(&mut points.iter().rev().copied()));
    hull
}

#[cfg(test)]
mod tests {
    use super::*;
    use sightlines_geometry::{Segment2, is_convex_ccw};

    proptest! {
        #[test]
        fn plans_are_on_the_grid(plan in small_grid_plan(0..6), axial in axial_plan(1..6)) {
            prop_assert!(plan.small_grid().is_some() && plan.lines().len() <= 9);
            prop_assert!(axial.is_axial() && !axial.lines().is_empty());
        }

        #[test]
        fn polygons_are_convex(polygon in convex_polygon()) {
            prop_assert!(is_convex_ccw(&polygon), "{:?}", polygon);
        }
    }

    /// Degenerate cases are common: crossings, touching, overlaps and boxes are all there.
    #[test]
    fn plans_are_degenerate_often_enough() {
        let (mut crossing, mut touching, mut boxed) = (0, 0, 0);
        for plan in crate::draw(&small_grid_plan(6), 200) {
            let s: Vec<Segment2> = plan.lines()[..6].iter().map(|l| Segment2::new(l.a, l.b)).collect();
            let pairs = || s.iter().enumerate().flat_map(|(i, p)| s[..i].iter().map(move |q| (p, q)));
            crossing += i32::from(pairs().any(|(p, q)| p.crosses(q)));
            touching += i32::from(pairs().any(|(p, q)| p.meets(q) && !p.crosses(q)));
            boxed += i32::from(plan.lines().len() == 10);
        }
        assert!([crossing, touching, boxed].iter().all(|&n| n > 50), "{crossing} {touching} {boxed}");
    }
}
