//! Coordinates that differ by less than the gap become one.
//!
//! Along each axis by itself: what happens to a coordinate depends on its value alone. So corners at one place go to one place, a panel that
//! ends where a wall begins still does, and whatever shared a plane shares it afterwards. Planes come from the corners of triangles that
//! are flat across an axis within half the gap; other corners are taken along where they are near a plane.

use crate::area::{main_axis, spread};
use sightlines_geometry::Point3;
use sightlines_geometry::vector::normal;

/// Coordinates that become one.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Plane {
    /// What is moved: from the lowest to the highest value.
    from: f64,
    to: f64,
    /// Where it is moved to.
    at: f64,
}

/// For each axis, which coordinates become which.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Snaps {
    /// By axis, ascending; their ranges do not meet.
    planes: [Vec<Plane>; 3],
}

impl Snaps {
    /// From the triangles of a scene along the axes of a frame.
    ///
    /// Values of one plane differ by at most half the gap, and nothing is moved farther than that, so two surfaces that are more than the gap
    /// apart along an axis stay apart; across a diagonal, those that are more than √3 times the gap apart. O(n log n) for n triangles.
    pub(crate) fn of(triangles: impl Iterator<Item = [Point3; 3]>, gap: f64) -> Self {
        let mut values: [Vec<f64>; 3] = Default::default();
        let most = gap / 2.0;
        for t in triangles {
            let axis = main_axis(normal(t));
            if spread(&t, axis) <= most {
                for (k, values) in values.iter_mut().enumerate() {
                    values.extend(t.map(|p| p[k]));
                }
            }
        }
        Self { planes: values.map(|values| planes(values, most)) }
    }

    /// Where a coordinate along an axis goes: itself, if there is nothing near it.
    pub fn snap(&self, axis: usize, x: f64) -> f64 {
        let planes = &self.planes[axis];
        let after = planes.partition_point(|plane| plane.to < x);
        planes.get(after).filter(|plane| plane.from <= x).map_or(x, |plane| plane.at)
    }

    /// Number of coordinates, of all axes, that others were moved to.
    pub fn n_planes(&self) -> usize {
        self.planes.iter().map(Vec::len).sum()
    }
}

/// The planes of all values along an axis, each at most `most` wide.
fn planes(mut values: Vec<f64>, most: f64) -> Vec<Plane> {
    values.sort_unstable_by(f64::total_cmp);
    let mut groups: Vec<&[f64]> = Vec::new();
    for run in values.chunk_by(|a, b| b - a <= most) {
        split(run, most, &mut groups);
    }
    let middle = |group: &[f64]| group[group.len() / 2];
    let planes = groups.iter().enumerate().map(|(i, group)| {
        let (first, last, at) = (group[0], group[group.len() - 1], middle(group));
        // What is near it comes along, but no farther than half the way to the next one.
        let below = i.checked_sub(1).map_or(f64::NEG_INFINITY, |k| groups[k][groups[k].len() - 1]);
        let above = groups.get(i + 1).map_or(f64::INFINITY, |group| group[0]);
        let from = (at - most).max(below + (first - below) / 2.0).min(first);
        let to = (at + most).min(last + (above - last) / 2.0).max(last);
        Plane { from, to, at }
    });
    let mut planes: Vec<Plane> = planes.collect();
    // Halfway between two planes is on neither.
    for k in 1..planes.len() {
        if planes[k].from <= planes[k - 1].to {
            planes[k].from = planes[k - 1].to.next_up();
        }
    }
    planes
}

/// Divides ascending values until no part is wider than `most`: at the widest hole of the middle half, the first of several.
fn split<'a>(values: &'a [f64], most: f64, out: &mut Vec<&'a [f64]>) {
    let mut pending = vec![values];
    while let Some(part) = pending.pop() {
        let n = part.len();
        if part[n - 1] - part[0] <= most {
            out.push(part);
            continue;
        }
        // A hole is before its place. The range is never empty, as there are two values at least.
        let (low, high) = ((n / 4).max(1), (n - n / 4).min(n - 1));
        let hole = |k: &usize| part[*k] - part[*k - 1];
        let widest = (low..=high).reduce(|best, k| if hole(&k) > hole(&best) { k } else { best }).unwrap_or(low);
        let at = if hole(&widest) > 0.0 { widest } else { (1..n).find(|k| hole(k) > 0.0).unwrap_or(widest) };
        // The last in, the first out: lower values first.
        pending.extend([&part[at..], &part[..at]]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn snapped(values: &[f64], most: f64, x: f64) -> f64 {
        Snaps { planes: [planes(values.to_vec(), most), Vec::new(), Vec::new()] }.snap(0, x)
    }

    #[test]
    fn near_values_become_one() {
        let values = [1.0, 1.25, 1.25, 5.0, 5.5, 9.0];
        assert_eq!([1.0, 1.25, 5.0, 5.5, 9.0].map(|x| snapped(&values, 0.5, x)), [1.25, 1.25, 5.5, 5.5, 9.0]);
        // Others come along as far as half the gap, and no farther.
        assert_eq!([0.75, 0.7, 9.5, 9.6, 7.0].map(|x| snapped(&values, 0.5, x)), [1.25, 0.7, 9.0, 9.6, 7.0]);
        assert_eq!(snapped(&[], 1.0, 3.0), 3.0);
    }

    #[test]
    fn long_rows_are_divided_at_their_holes() {
        let values = [0.0, 0.25, 0.5, 1.0, 1.25, 1.5];
        assert_eq!(values.map(|x| snapped(&values, 0.5, x)), [0.25, 0.25, 0.25, 1.25, 1.25, 1.25]);
        let many: Vec<f64> = (0..10_000).map(|i| f64::from(i) / 1024.0).collect();
        let most = 1.0 / 64.0;
        for &x in &many {
            assert!((snapped(&many, most, x) - x).abs() <= most, "{x}");
        }
        let repeated = [vec![0.0; 50], vec![1.0; 50]].concat();
        assert_eq!([0.0, 1.0].map(|x| snapped(&repeated, 0.5, x)), [0.0, 1.0]);
        let one_sided = [vec![0.0; 90], vec![1.0]].concat();
        assert_eq!([0.0, 1.0].map(|x| snapped(&one_sided, 0.5, x)), [0.0, 1.0]);
    }

    /// The order of coordinates stays: nothing is moved past something else.
    #[test]
    fn the_order_stays() {
        let values: Vec<f64> = (0..500).map(|i| f64::from(i * i % 997) / 10.0).collect();
        let mut all: Vec<f64> = values.iter().flat_map(|x| [x - 0.04, *x, x + 0.03]).collect();
        all.sort_unstable_by(f64::total_cmp);
        let after: Vec<f64> = all.iter().map(|&x| snapped(&values, 0.15, x)).collect();
        assert!(after.is_sorted() && after != all);
    }
}
