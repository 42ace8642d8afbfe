//! Boxes that share faces, and which lie behind which part of a face.

use sightlines_geometry::{Aabb, BoxTree, Point3};

/// A side of a box: twice the axis, and one more for the upper one.
pub(super) const fn side(axis: usize, upward: bool) -> usize {
    2 * axis + upward as usize
}

/// Where a box ends on a side.
pub(super) fn end_of(b: &Aabb<3>, side: usize) -> f64 {
    if side % 2 == 1 { b.max[side / 2] } else { b.min[side / 2] }
}

/// A box behind a part of a side of another one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Neighbour {
    pub(super) side: u8,
    pub(super) of: u32,
}

/// Boxes with their neighbours. They may leave gaps: a side of which a part has no neighbour is open.
#[derive(Debug)]
pub(super) struct Tiling {
    boxes: Vec<Aabb<3>>,
    tree: BoxTree<3>,
    /// For each box the start of its neighbours, and the end of the last one's.
    first: Vec<u32>,
    neighbours: Vec<Neighbour>,
    /// For each box its open sides, a bit each.
    open: Vec<u8>,
}

impl Tiling {
    /// Two boxes are neighbours if a side of one lies in the plane of the opposite side of the other, to the bit, and they share an area there.
    /// O(n log n) of boxes with few neighbours each.
    pub(super) fn new(boxes: Vec<Aabb<3>>) -> Self {
        let tree = BoxTree::build(&boxes, 4);
        let (mut first, mut neighbours, mut open) = (vec![0], Vec::new(), Vec::with_capacity(boxes.len()));
        for (k, b) in (0u32..).zip(&boxes) {
            let mut of: Vec<Neighbour> = Vec::new();
            let meets = |other: &Aabb<3>| (0..3).all(|k| other.min[k] <= b.max[k] && b.min[k] <= other.max[k]);
            tree.visit(meets, |other| {
                let near = &boxes[other as usize];
                let sides = (0..6).filter(|&side| other != k && shares(b, near, side));
                of.extend(sides.map(|side| Neighbour { side: side as u8, of: other }));
            });
            of.sort_unstable_by_key(|near| (near.side, near.of));
            let is_open = |&side: &usize| {
                let parts = of.iter().filter(|near| usize::from(near.side) == side);
                let parts: Vec<Aabb<3>> = parts.map(|near| part(b, &boxes[near.of as usize], side)).collect();
                !covers(&whole(b, side), &parts, side / 2)
            };
            // No line leaves a box without a volume in the way that is asked about.
            let has_volume = (0..3).all(|k| b.min[k] < b.max[k]);
            open.push((0..6).filter(|side| !has_volume || is_open(side)).map(|side| 1 << side).sum());
            neighbours.extend(of);
            first.push(neighbours.len() as u32);
        }
        Self { boxes, tree, first, neighbours, open }
    }

    #[cfg(test)]
    pub(super) fn close(&mut self) {
        self.open.fill(0);
    }

    pub(super) fn boxes(&self) -> &[Aabb<3>] {
        &self.boxes
    }

    pub(super) fn len(&self) -> usize {
        self.boxes.len()
    }

    /// How many pairs of neighbours there are, in both orders.
    pub(super) fn n_pairs(&self) -> usize {
        self.neighbours.len()
    }

    /// The neighbours of a box, side by side, each with the index of the pair.
    pub(super) fn neighbours(&self, of: u32) -> impl Iterator<Item = (usize, Neighbour)> + '_ {
        let range = self.first[of as usize] as usize..self.first[of as usize + 1] as usize;
        range.map(|k| (k, self.neighbours[k]))
    }

    pub(super) fn is_open(&self, of: u32, side: usize) -> bool {
        self.open[of as usize] >> side & 1 == 1
    }

    /// The part of a side of a box that a neighbour is behind.
    pub(super) fn part(&self, of: u32, near: Neighbour) -> Aabb<3> {
        part(&self.boxes[of as usize], &self.boxes[near.of as usize], usize::from(near.side))
    }

    /// A side of a box, flat.
    pub(super) fn whole(&self, of: u32, side: usize) -> Aabb<3> {
        whole(&self.boxes[of as usize], side)
    }

    /// Calls back for each box that a segment passes, from the one that holds its start, as doubles have it, as long as there are neighbours; whoever is
    /// called says whether to go on.
    pub(super) fn walk(&self, start: u32, from: Point3, to: Point3, mut visit: impl FnMut(u32)) {
        let way: Point3 = std::array::from_fn(|k| to[k] - from[k]);
        let mut at = start;
        // No segment passes a box twice.
        for _ in 0..self.len() {
            visit(at);
            let b = &self.boxes[at as usize];
            let leaves = |axis: usize| {
                let end = end_of(b, side(axis, way[axis] > 0.0));
                if way[axis] == 0.0 { f64::INFINITY } else { (end - from[axis]) / way[axis] }
            };
            let axis = (1..3).fold(0, |best, axis| if leaves(axis) < leaves(best) { axis } else { best });
            let t = leaves(axis);
            if t >= 1.0 || t.is_nan() {
                return;
            }
            let through = side(axis, way[axis] > 0.0);
            let point: Point3 = std::array::from_fn(|k| from[k] + t * way[k]);
            let holds = |near: &Neighbour| {
                let b = &self.boxes[near.of as usize];
                (0..3).all(|k| k == axis || b.min[k] <= point[k] && point[k] <= b.max[k])
            };
            let Some(next) = self.behind(at, through, point, holds) else { return };
            at = next.of;
        }
    }
}

impl Tiling {
    /// The first neighbour on a side, by index, of those that hold a point of it.
    fn behind(&self, of: u32, side: usize, point: Point3, holds: impl Fn(&Neighbour) -> bool) -> Option<Neighbour> {
        let all = &self.neighbours[self.first[of as usize] as usize..self.first[of as usize + 1] as usize];
        let start = all.partition_point(|near| usize::from(near.side) < side);
        let all = &all[start..start + all[start..].partition_point(|near| usize::from(near.side) == side)];
        if all.len() <= FEW {
            return all.iter().copied().find(holds);
        }
        let mut found: Option<Neighbour> = None;
        let near = |b: &Aabb<3>| (0..3).all(|k| k == side / 2 || b.min[k] <= point[k] && point[k] <= b.max[k]);
        let plane = end_of(&self.boxes[of as usize], side);
        let meets = |b: &Aabb<3>| near(b) && b.min[side / 2] <= plane && plane <= b.max[side / 2];
        self.tree.visit(meets, |other| {
            let known = all.binary_search_by_key(&other, |near| near.of).ok().map(|k| all[k]);
            found = found.into_iter().chain(known.filter(&holds)).min_by_key(|near| near.of);
        });
        found
    }
}

/// So many neighbours on a side are gone through one by one.
const FEW: usize = 16;

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

/// Whether rectangles across an axis cover another one. Exact: between two of their coordinates nothing changes.
fn covers(whole: &Aabb<3>, parts: &[Aabb<3>], axis: usize) -> bool {
    if let [one] = parts {
        return one == whole;
    }
    let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
    let lines = |k: usize| {
        let mut at: Vec<f64> =
            parts.iter().flat_map(|b| [b.min[k], b.max[k]]).chain([whole.min[k], whole.max[k]]).collect();
        at.sort_by(f64::total_cmp);
        at.dedup();
        at
    };
    let (us, vs) = (lines(u), lines(v));
    us.windows(2).all(|u2| {
        vs.windows(2).all(|v2| {
            let within = |b: &Aabb<3>| b.min[u] <= u2[0] && u2[1] <= b.max[u] && b.min[v] <= v2[0] && v2[1] <= b.max[v];
            parts.iter().any(within)
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn block(min: [f64; 3], max: [f64; 3]) -> Aabb<3> {
        Aabb { min, max }
    }

    #[test]
    fn a_side_is_open_unless_neighbours_cover_all_of_it() {
        let cell = block([0.0; 3], [2.0; 3]);
        let low = block([2.0, 0.0, 0.0], [3.0, 2.0, 1.0]);
        let high = |top: f64| block([2.0, -1.0, 1.0], [4.0, 5.0, top]);
        let open = |boxes: Vec<Aabb<3>>| Tiling::new(boxes).is_open(0, side(0, true));
        assert!(!open(vec![cell, low, high(2.0)]));
        assert!(open(vec![cell, low, high(2.0_f64.next_down())]), "by a unit in the last place");
        assert!(open(vec![cell, low]));
        let mut moved = high(2.0);
        moved.min[0] = 2.0_f64.next_up();
        assert!(open(vec![cell, low, moved]), "behind another plane");
        let tiling = Tiling::new(vec![cell, low, high(2.0)]);
        let of: Vec<Neighbour> = tiling.neighbours(0).map(|(_, near)| near).collect();
        assert_eq!(of, [1, 2].map(|of| Neighbour { side: 1, of }));
        assert_eq!(tiling.part(0, of[1]), block([2.0, 0.0, 1.0], [2.0; 3]));
        assert_eq!((0..6).filter(|&side| tiling.is_open(0, side)).count(), 5);
    }

    #[test]
    fn a_walk_passes_box_by_box() {
        let at = |x: f64, y: f64| block([x, y, 0.0], [x + 1.0, y + 1.0, 1.0]);
        let tiling = Tiling::new(vec![at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)]);
        let mut passed = Vec::new();
        tiling.walk(0, [0.5, 0.25, 0.5], [1.75, 1.5, 0.5], |k| passed.push(k));
        assert_eq!(passed, [0, 1, 2]);
    }
}
