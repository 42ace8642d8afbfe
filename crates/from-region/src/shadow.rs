//! What a box of blocked space hides from a volume: its umbra.
//!
//! For a box `b` and a point `p`, the eyes `v` whose segments to `p` meet `b` are a convex set, and so are, for an
//! eye, the points. So all segments between two convex hulls meet `b` if those between their corners do. A
//! segment meets a box if three ranges along it have a point in common, those in which it is between the box's sides
//! along one axis; ranges on a line have one if any two of them do. So the question is one
//! about segments and rectangles in the three coordinate planes, and the umbra is what lies in an umbra in each of them.

use crate::bits::Bits;
use crate::grid::Grid;
use sightlines_geometry::{Aabb, Point2, Point3, orient2d};

/// Pairs of axes.
const PLANES: [[usize; 2]; 3] = [[0, 1], [0, 2], [1, 2]];

/// Whether a closed segment in the plane meets a closed rectangle. Exact.
fn meets(v: [f64; 2], p: [f64; 2], low: [f64; 2], high: [f64; 2]) -> bool {
    if (0..2).any(|k| v[k].max(p[k]) < low[k] || v[k].min(p[k]) > high[k]) {
        return false;
    }
    // The corners that are farthest to both sides of the segment's line.
    let rises = (p[0] >= v[0]) == (p[1] >= v[1]);
    let (a, b) = if rises { ([low[0], high[1]], [high[0], low[1]]) } else { (low, high) };
    let [v, p, a, b] = [v, p, a, b].map(Point2::from_array);
    let (a, b) = (orient2d(v, p, a), orient2d(v, p, b));
    !((a > 0.0 && b > 0.0) || (a < 0.0 && b < 0.0))
}

/// The corners of a rectangle.
fn corners(low: [f64; 2], high: [f64; 2]) -> [[f64; 2]; 4] {
    [low, [high[0], low[1]], [low[0], high[1]], high]
}

/// Whether every segment from a volume to the convex hull of `points` meets `blocker`. Exact.
pub(crate) fn hides_points(blocker: &Aabb<3>, volume: &Aabb<3>, points: &[Point3]) -> bool {
    PLANES.iter().all(|&axes| {
        let flat = |p: Point3| axes.map(|k| p[k]);
        let (low, high) = (flat(blocker.min), flat(blocker.max));
        let eyes = corners(flat(volume.min), flat(volume.max));
        points.iter().all(|&p| eyes.iter().all(|&v| meets(v, flat(p), low, high)))
    })
}

/// Whether every segment from a volume to a box meets `blocker`. Exact.
pub(crate) fn hides_box(blocker: &Aabb<3>, volume: &Aabb<3>, target: &Aabb<3>) -> bool {
    PLANES.iter().all(|&axes| {
        let flat = |p: Point3| axes.map(|k| p[k]);
        let (low, high) = (flat(blocker.min), flat(blocker.max));
        let eyes = corners(flat(volume.min), flat(volume.max));
        let ends = corners(flat(target.min), flat(target.max));
        ends.iter().all(|&p| eyes.iter().all(|&v| meets(v, p, low, high)))
    })
}

/// Adds the voxels that are wholly in the umbra of `blocker` to `sets`.
///
/// Cost: O(n²) runs of voxels for a grid of n³, and O(n) exact predicates.
pub(crate) fn add_umbra(sets: [&mut Bits; 2], grid: &Grid, volume: &Aabb<3>, blocker: &Aabb<3>) {
    let [xy, xz, yz] = PLANES.map(|axes| columns(grid, axes, volume, blocker));
    let [first, second] = sets;
    for (x, (&(low, high), &(back, front))) in xy.iter().zip(&xz).enumerate() {
        for (y, &(from, to)) in yz.iter().enumerate().take(high).skip(low) {
            let (from, to) = (back.max(from), front.min(to));
            first.set_run(x, y, from, to);
            second.set_run(x, y, from, to);
        }
    }
}

/// In one coordinate plane, for each row of squares, from which to before which one they are in the umbra.
fn columns(grid: &Grid, axes: [usize; 2], volume: &Aabb<3>, blocker: &Aabb<3>) -> Vec<(usize, usize)> {
    let flat = |p: Point3| axes.map(|k| p[k]);
    let (low, high) = (flat(blocker.min), flat(blocker.max));
    let eyes = corners(flat(volume.min), flat(volume.max));
    let [i, j] = axes;
    // First the corners of squares: the umbra in the plane is convex, so in each row they are one range.
    let range = |row: usize| -> Option<(usize, usize)> {
        let x = grid.plane(i, row);
        let guess = |v: &[f64; 2]| guess(*v, x, low, high);
        let [from, to] = eyes.iter().map(guess).try_fold([f64::NEG_INFINITY, f64::INFINITY], |[a, b], next| {
            let [c, d] = next?;
            (a.max(c) <= b.min(d)).then_some([a.max(c), b.min(d)])
        })?;
        // `as` saturates, and so ends without a bound are at the border.
        let mut first = grid.place(j, from).ceil() as usize;
        let mut last = (grid.place(j, to).floor().min(grid.n()[j] as f64)).max(-1.0);
        // The guess was rounded. Its ends count if they are certain, and then so does all between.
        let inside = |at: usize| eyes.iter().all(|&v| meets(v, [x, grid.plane(j, at)], low, high));
        while first as f64 <= last && !inside(first) {
            first += 1;
        }
        while first as f64 <= last && !inside(last as usize) {
            last -= 1.0;
        }
        (first as f64 <= last).then_some((first, last as usize))
    };
    let mut before = range(0);
    let squares = (1..=grid.n()[i]).map(|row| {
        let after = range(row);
        let both = before.zip(after).map(|(a, b)| (a.0.max(b.0), a.1.min(b.1))).filter(|(a, b)| a < b);
        before = after;
        both.unwrap_or((0, 0))
    });
    squares.collect()
}

/// Between which heights a segment from `v` that ends above `x` meets a rectangle, in rounded numbers; none if at no
/// height.
fn guess(v: [f64; 2], x: f64, low: [f64; 2], high: [f64; 2]) -> Option<[f64; 2]> {
    // The part of the segment that is above the rectangle, from 0 to 1.
    let [near, far] = if x == v[0] {
        (low[0] <= x && x <= high[0]).then_some([0.0, 1.0])?
    } else {
        let [a, b] = [low[0], high[0]].map(|side| (side - v[0]) / (x - v[0]));
        let [near, far] = [a.min(b).max(0.0), a.max(b).min(1.0)];
        (near <= far).then_some([near, far])?
    };
    // To come as high as the lower side: from above by the near end, from below by the far end.
    let at =
        |side: f64, part: f64| if part > 0.0 { v[1] + (side - v[1]) / part } else { (side - v[1]) * f64::INFINITY };
    let least = if v[1] == low[1] {
        if near > 0.0 { v[1] } else { f64::NEG_INFINITY }
    } else {
        at(low[1], if v[1] > low[1] { near } else { far })
    };
    let most = if v[1] == high[1] {
        if near > 0.0 { v[1] } else { f64::INFINITY }
    } else {
        at(high[1], if v[1] < high[1] { near } else { far })
    };
    Some([least, most])
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_rational::BigRational;
    use num_traits::{One, Zero};
    use proptest::prelude::*;
    use sightlines_multifocal::Volume;

    /// The oracle: whether a segment meets a box, by the range of the segment that is left between its sides, in
    /// fractions.
    fn segment_meets(v: Point3, p: Point3, b: &Aabb<3>) -> bool {
        let r = |x: f64| BigRational::from_float(x).unwrap();
        let (mut from, mut to) = (BigRational::zero(), BigRational::one());
        for k in 0..3 {
            let d = r(p[k]) - r(v[k]);
            if d.is_zero() {
                if v[k] < b.min[k] || v[k] > b.max[k] {
                    return false;
                }
                continue;
            }
            let (s, t) = ((r(b.min[k]) - r(v[k])) / &d, (r(b.max[k]) - r(v[k])) / &d);
            let (s, t) = if s < t { (s, t) } else { (t, s) };
            (from, to) = (from.max(s), to.min(t));
        }
        from <= to
    }

    fn corners_of(b: &Aabb<3>) -> [Point3; 8] {
        Volume::new(*b).unwrap().corners()
    }

    /// All segments between corners.
    fn all_meet(b: &Aabb<3>, volume: &Aabb<3>, target: &Aabb<3>) -> bool {
        corners_of(volume).iter().all(|&v| corners_of(target).iter().all(|&p| segment_meets(v, p, b)))
    }

    fn boxes(step: f64) -> impl Strategy<Value = Aabb<3>> {
        (prop::array::uniform3(0i32..12), prop::array::uniform3(0i32..5)).prop_map(move |(p, size)| Aabb {
            min: p.map(|x| f64::from(x) * step),
            max: std::array::from_fn(|k| f64::from(p[k] + size[k]) * step),
        })
    }

    type Case = (Aabb<3>, Aabb<3>, Vec<Aabb<3>>);

    fn case() -> impl Strategy<Value = Case> {
        // Whole numbers, so that things touch; and tenths, so that they nearly do.
        let of = |step| {
            let blocker = (boxes(step), boxes(step)).prop_map(|(a, b)| Aabb::around([a.min, a.max, b.min, b.max]));
            (blocker, boxes(step), prop::collection::vec(boxes(step), 5))
        };
        prop_oneof![of(1.0), of(0.1)]
    }

    proptest! {
        /// Invariant: three flat questions say what 64 segments in space say.
        #[test]
        fn boxes_are_hidden_as_all_segments_say((blocker, volume, targets) in case()) {
            for target in &targets {
                let expected = all_meet(&blocker, &volume, target);
                prop_assert_eq!(hides_box(&blocker, &volume, target), expected, "{:?}", target);
                prop_assert_eq!(hides_points(&blocker, &volume, &corners_of(target)), expected);
            }
        }

        /// Invariant: the voxels of an umbra are those that it holds, and no more; but for a few where a guess was
        /// rounded.
        #[test]
        fn umbras_hold_their_voxels((blocker, volume, _) in case(), n in 3usize..9) {
            let (sound, missed, _) = compare(&blocker, &volume, n);
            prop_assert!(sound);
            prop_assert!(missed <= n * n, "{} missed", missed);
        }
    }

    /// Whether all marked voxels are in the umbra; how many in it are not marked, and how many are.
    fn compare(blocker: &Aabb<3>, volume: &Aabb<3>, n: usize) -> (bool, usize, usize) {
        let grid = Grid::around(&Aabb { min: [0.0; 3], max: [16.0; 3] }, n);
        let (mut marked, mut again) = (Bits::new(grid.n()), Bits::new(grid.n()));
        add_umbra([&mut marked, &mut again], &grid, volume, blocker);
        assert_eq!(marked, again);
        let (mut sound, mut missed) = (true, 0);
        let of = |k: usize| 0..grid.n()[k];
        for voxel in of(0).flat_map(|x| of(1).flat_map(move |y| of(2).map(move |z| [x, y, z]))) {
            let b = grid.bounds(&crate::grid::Block { low: voxel, high: voxel.map(|i| i + 1) });
            let inside = hides_box(blocker, volume, &b);
            sound &= inside || !marked.get(voxel);
            missed += usize::from(inside && !marked.get(voxel));
        }
        (sound, missed, marked.len())
    }

    /// The twin: next to nothing is missed. And the impostor: with the volume a little larger, what was marked is too much.
    #[test]
    fn umbras_miss_next_to_nothing_and_are_not_too_large() {
        let (mut n_missed, mut n_marked, mut n_wrong) = (0, 0, 0);
        for (blocker, volume, _) in sightlines_testkit::draw(&case(), 150) {
            let (sound, missed, marked) = compare(&blocker, &volume, 9);
            assert!(sound);
            (n_missed, n_marked) = (n_missed + missed, n_marked + marked);
            let grid = Grid::around(&Aabb { min: [0.0; 3], max: [16.0; 3] }, 9);
            let sets = &mut [Bits::new(grid.n()), Bits::new(grid.n())];
            let [a, b] = sets;
            add_umbra([a, b], &grid, &volume, &blocker);
            let wider = Aabb { min: volume.min.map(|x| x - 0.5), ..volume };
            let (_, _, fewer) = compare(&blocker, &wider, 9);
            n_wrong += usize::from(fewer < a.len());
        }
        assert!(n_marked > 500 && n_missed * 100 < n_marked && n_wrong > 10, "{n_missed} {n_marked} {n_wrong}");
    }
}
