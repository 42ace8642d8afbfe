//! Segments that are moved a little at a time, towards less that is in their way.

use crate::exact::snapped;
use sightlines_geometry::{Aabb, Point3, Random};

/// Moves the ends of a segment within their boxes, by steps of any order of magnitude, and keeps what does not make `openness`
/// less. Stops at the first segment that is good.
///
/// * `openness`: how little is in the way; at 1, nothing as far as doubles tell, `is_good` decides.
pub(crate) fn climb(
    start: [Point3; 2],
    boxes: [&Aabb<3>; 2],
    tries: u32,
    random: &mut Random,
    mut openness: impl FnMut([Point3; 2]) -> f64,
    mut is_good: impl FnMut([Point3; 2]) -> bool,
) -> Option<[Point3; 2]> {
    let mut best = (openness(start), start);
    for _ in 0..tries {
        if best.0 >= 1.0 && is_good(best.1) {
            return Some(best.1);
        }
        let mut next = best.1;
        let which = random.below(3);
        for end in [0, 1].into_iter().filter(|&end| which != end) {
            let step = 2f64.powi(-(random.below(24) as i32));
            let b = boxes[end];
            let moved = std::array::from_fn(|k| {
                let by = (b.max[k] - b.min[k]) * step * (2.0 * random.unit() - 1.0);
                (next[end][k] + by).clamp(b.min[k], b.max[k])
            });
            next[end] = snapped(moved);
        }
        let open = openness(next);
        if open >= best.0 {
            best = (open, next);
        }
    }
    (best.0 >= 1.0 && is_good(best.1)).then_some(best.1)
}
