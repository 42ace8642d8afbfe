//! Boxes that share faces, and what lies behind which part of a face.

use sightlines_geometry::{Aabb, BoxTree, Point3, ray_box};
use std::collections::BTreeMap;

/// Where a box ends on a side.
fn end_of(b: &Aabb<3>, side: usize) -> f64 {
    if side % 2 == 1 { b.max[side / 2] } else { b.min[side / 2] }
}

/// A part of a side of a box: all that one other box is behind, or some where none is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Part {
    /// Twice the axis, and one more for the upper one.
    pub(super) side: u8,
    /// The box behind it.
    pub(super) near: Option<u32>,
    /// A rectangle, as a flat box.
    pub(super) bounds: Aabb<3>,
}

/// Boxes, and the parts of their sides. They may leave gaps.
#[derive(Debug)]
pub(super) struct Tiling {
    boxes: Vec<Aabb<3>>,
    tree: BoxTree<3>,
    /// For each box the start of its parts, and the end of the last one's.
    first: Vec<u32>,
    parts: Vec<Part>,
}

impl Tiling {
    /// A box is behind a part of a side of another one if a side of one lies in the plane of the opposite side of the other, to the bit, and they share an
    /// area there. O(n log n) of boxes with few neighbours each.
    pub(super) fn new(boxes: Vec<Aabb<3>>) -> Self {
        let tree = BoxTree::build(&boxes, 4);
        let (mut first, mut parts) = (vec![0], Vec::new());
        for (k, b) in (0u32..).zip(&boxes) {
            let mut of: Vec<Part> = Vec::new();
            let meets = |other: &Aabb<3>| (0..3).all(|k| other.min[k] <= b.max[k] && b.min[k] <= other.max[k]);
            // No line leaves a box without a volume in the way that is asked about.
            if (0..3).all(|k| b.min[k] < b.max[k]) {
                tree.visit(meets, |other| {
                    let near = &boxes[other as usize];
                    let sides = (0..6).filter(|&side| other != k && shares(b, near, side));
                    let part = |side| Part { side: side as u8, near: Some(other), bounds: part(b, near, side) };
                    of.extend(sides.map(part));
                });
            }
            for side in 0..6 {
                let covered = of.iter().filter(|part| usize::from(part.side) == side).map(|part| part.bounds);
                let whole = whole(b, side);
                let open = uncovered(&whole, &covered.collect::<Vec<_>>(), side / 2);
                let wide = open.into_iter().map(|part| wide(part, &whole));
                of.extend(wide.map(|bounds| Part { side: side as u8, near: None, bounds }));
            }
            of.sort_by_key(|part| (part.side, part.near));
            parts.extend(of);
            first.push(parts.len() as u32);
        }
        Self { boxes, tree, first, parts }
    }

    /// The impostor: no line leaves where there is no box behind.
    #[cfg(test)]
    pub(super) fn close(&mut self) {
        for k in 0..self.boxes.len() {
            let of = self.first[k] as usize..self.first[k + 1] as usize;
            self.parts[of].iter_mut().for_each(|part| part.near = part.near.or(Some(k as u32)));
        }
    }

    pub(super) fn boxes(&self) -> &[Aabb<3>] {
        &self.boxes
    }

    pub(super) fn len(&self) -> usize {
        self.boxes.len()
    }

    pub(super) fn n_parts(&self) -> usize {
        self.parts.len()
    }

    /// The parts of the sides of a box, side by side, each with its index.
    pub(super) fn parts(&self, of: u32) -> impl Iterator<Item = (usize, &Part)> + '_ {
        let range = self.first[of as usize] as usize..self.first[of as usize + 1] as usize;
        range.map(|k| (k, &self.parts[k]))
    }

    /// The boxes that share a part of a side with a box.
    pub(super) fn neighbours(&self, of: u32) -> impl Iterator<Item = u32> + '_ {
        self.parts(of).filter_map(|(_, part)| part.near)
    }

    /// Calls back for each box that a segment passes, as doubles have it.
    pub(super) fn passed(&self, from: Point3, to: Point3, mut visit: impl FnMut(u32)) {
        let way: Point3 = std::array::from_fn(|k| to[k] - from[k]);
        let inverse = way.map(|x| if x == 0.0 { f64::NAN } else { 1.0 / x });
        let meets = |b: &Aabb<3>| {
            if (0..3).any(|k| way[k] == 0.0 && (from[k] < b.min[k] || from[k] > b.max[k])) {
                return false;
            }
            let [first, last] = ray_box(b, from, inverse);
            first.max(0.0) <= last.min(1.0)
        };
        self.tree.visit(meets, |k| {
            if meets(&self.boxes[k as usize]) {
                visit(k);
            }
        });
    }
}

fn whole(b: &Aabb<3>, side: usize) -> Aabb<3> {
    let (axis, at) = (side / 2, end_of(b, side));
    let mut flat = *b;
    (flat.min[axis], flat.max[axis]) = (at, at);
    flat
}

fn part(b: &Aabb<3>, near: &Aabb<3>, side: usize) -> Aabb<3> {
    let mut flat = whole(b, side);
    for k in (0..3).filter(|&k| k != side / 2) {
        flat.min[k] = flat.min[k].max(near.min[k]);
        flat.max[k] = flat.max[k].min(near.max[k]);
    }
    flat
}

fn shares(b: &Aabb<3>, near: &Aabb<3>, side: usize) -> bool {
    let is_behind = end_of(b, side) == end_of(near, side ^ 1);
    is_behind && (0..3).all(|k| k == side / 2 || b.min[k] < near.max[k] && near.min[k] < b.max[k])
}

/// What is open is asked about at least so wide, as a share of the side: between doubles that are next to each other there is no line to begin with.
const LEAST_WIDTH: f64 = 1.0 / 1024.0;

/// A part of a side that is not too thin, with all of another one.
fn wide(mut part: Aabb<3>, whole: &Aabb<3>) -> Aabb<3> {
    for k in 0..3 {
        let least = (whole.max[k] - whole.min[k]) * LEAST_WIDTH;
        if part.max[k] - part.min[k] < least {
            part.max[k] = part.max[k].max(part.min[k] + least).min(whole.max[k]);
            part.min[k] = part.min[k].min(part.max[k] - least).max(whole.min[k]);
        }
    }
    part
}

/// What rectangles across an axis leave of another one, as rectangles. Exact: between two of their coordinates nothing changes. O(n² log n) at worst.
fn uncovered(whole: &Aabb<3>, covered: &[Aabb<3>], axis: usize) -> Vec<Aabb<3>> {
    let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
    let mut us: Vec<f64> =
        covered.iter().flat_map(|b| [b.min[u], b.max[u]]).chain([whole.min[u], whole.max[u]]).collect();
    us.sort_by(f64::total_cmp);
    us.dedup();
    let mut sorted: Vec<&Aabb<3>> = covered.iter().collect();
    sorted.sort_by(|a, b| a.min[v].total_cmp(&b.min[v]));
    let mut open: Vec<Aabb<3>> = Vec::new();
    // Those that reach to the next strip, by their ends in it.
    let mut before: BTreeMap<[u64; 2], usize> = BTreeMap::new();
    for u2 in us.windows(2) {
        let mut now = BTreeMap::new();
        let mut add = |low: f64, high: f64| {
            let ends = [low, high].map(f64::to_bits);
            let at = match before.get(&ends) {
                Some(&at) => {
                    open[at].max[u] = u2[1];
                    at
                }
                None => {
                    let mut b = *whole;
                    (b.min[u], b.max[u], b.min[v], b.max[v]) = (u2[0], u2[1], low, high);
                    open.push(b);
                    open.len() - 1
                }
            };
            now.insert(ends, at);
        };
        let mut from = whole.min[v];
        for b in sorted.iter().filter(|b| b.min[u] <= u2[0] && u2[1] <= b.max[u]) {
            if b.min[v] > from {
                add(from, b.min[v]);
            }
            from = from.max(b.max[v]);
        }
        if from < whole.max[v] {
            add(from, whole.max[v]);
        }
        before = now;
    }
    open
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn block(min: [f64; 3], max: [f64; 3]) -> Aabb<3> {
        Aabb { min, max }
    }

    #[test]
    fn parts_without_a_neighbour_are_open() {
        let cell = block([0.0; 3], [2.0; 3]);
        let low = block([2.0, 0.0, 0.0], [3.0, 2.0, 1.0]);
        let high = |top: f64| block([2.0, -1.0, 1.0], [4.0, 5.0, top]);
        let of = |boxes: Vec<Aabb<3>>, near: Option<u32>| -> Vec<Aabb<3>> {
            let tiling = Tiling::new(boxes);
            let parts = tiling.parts(0).filter(|(_, part)| part.side == 1 && part.near == near);
            parts.map(|(_, part)| part.bounds).collect()
        };
        let open = |boxes: Vec<Aabb<3>>| of(boxes, None);
        assert_eq!(open(vec![cell, low, high(2.0)]), []);
        assert_eq!(of(vec![cell, low, high(2.0)], Some(2)), [block([2.0, 0.0, 1.0], [2.0; 3])]);
        let below = 2.0_f64.next_down();
        let last = block([2.0, 0.0, 2.0 - 2.0 / 1024.0], [2.0; 3]);
        assert_eq!(open(vec![cell, low, high(below)]), [last], "by a unit in the last place, and asked about wider");
        assert_eq!(open(vec![cell, low]), [block([2.0, 0.0, 1.0], [2.0; 3])]);
        let mut moved = high(2.0);
        moved.min[0] = 2.0_f64.next_up();
        assert_eq!(open(vec![cell, low, moved]), [block([2.0, 0.0, 1.0], [2.0; 3])], "behind another plane");
        // Around a box in the middle there are four.
        let middle = block([2.0, 0.5, 0.5], [3.0, 1.5, 1.5]);
        let area = |b: &Aabb<3>| (b.max[1] - b.min[1]) * (b.max[2] - b.min[2]);
        let around = open(vec![cell, middle]);
        assert_eq!((around.len(), around.iter().map(area).sum::<f64>()), (4, 3.0));
        assert_eq!(Tiling::new(vec![cell]).parts(0).count(), 6);
    }

    proptest! {
        /// Invariant: what is open and what is covered are all of the side, by the middles of its finest pieces; no two open parts overlap.
        #[test]
        fn open_parts_are_what_nothing_covers(boxes in prop::collection::vec((0u8..8, 1u8..5, 0u8..8, 1u8..5), 0..12)) {
            let flat = |x: u8, dx: u8, y: u8, dy: u8| {
                let [x, y] = [x, y].map(f64::from);
                block([x, y, 1.0], [(x + f64::from(dx)).min(8.0), (y + f64::from(dy)).min(8.0), 1.0])
            };
            let covered: Vec<Aabb<3>> = boxes.into_iter().map(|(x, dx, y, dy)| flat(x, dx, y, dy)).collect();
            let open = uncovered(&block([0.0, 0.0, 1.0], [8.0, 8.0, 1.0]), &covered, 2);
            for (x, y) in (0..8).flat_map(|x| (0..8).map(move |y| (x, y))) {
                let p = [f64::from(x) + 0.5, f64::from(y) + 0.5, 1.0];
                let is_covered = covered.iter().any(|b| b.contains(p));
                prop_assert_eq!(open.iter().filter(|b| b.contains(p)).count(), usize::from(!is_covered), "{:?}", p);
            }
        }
    }

    #[test]
    fn segments_pass_boxes_beyond_gaps() {
        let at = |x: f64, y: f64| block([x, y, 0.0], [x + 1.0, y + 1.0, 1.0]);
        let tiling = Tiling::new(vec![at(0.0, 0.0), at(1.0, 0.0), at(3.0, 0.0), at(0.0, 1.0)]);
        let mut passed = Vec::new();
        tiling.passed([0.5, 0.25, 0.5], [3.5, 0.75, 0.5], |k| passed.push(k));
        passed.sort_unstable();
        assert_eq!(passed, [0, 1, 2]);
        tiling.passed([0.5, 0.25, 0.5], [0.5, 0.75, 0.5], |k| passed.push(k));
        assert_eq!(passed[3..], [0]);
    }
}
