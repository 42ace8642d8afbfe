//! A hierarchy of boxes, so that a ray need not be tried on everything.
//!
//! Source: binned surface area heuristic, Wald, "On fast construction of SAH-based bounding volume
//! hierarchies", Symposium on Interactive Ray Tracing 2007.

use sightlines_cells::Point3;
use sightlines_geometry::Aabb;

/// Buckets that split planes lie between.
const N_BINS: usize = 16;
/// Up to so many boxes are not split.
const LEAF: usize = 4;

/// A half-line.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Ray {
    origin: Point3,
    /// One over the direction; infinite along axes on which the ray does not move.
    inverse: Point3,
}

impl Ray {
    /// The ray from `origin` along `direction`, which is not zero.
    pub(crate) fn new(origin: Point3, direction: Point3) -> Self {
        Self { origin, inverse: direction.map(|d| 1.0 / d) }
    }

    /// Where the line of the ray enters and leaves a box, as multiples of the direction; rounded.
    pub(crate) fn within(&self, b: &Aabb<3>) -> Option<[f64; 2]> {
        let mut range = [f64::NEG_INFINITY, f64::INFINITY];
        for k in 0..3 {
            let (o, inverse) = (self.origin[k], self.inverse[k]);
            if inverse.is_infinite() {
                if o < b.min[k] || o > b.max[k] {
                    return None;
                }
                continue;
            }
            let (s, t) = ((b.min[k] - o) * inverse, (b.max[k] - o) * inverse);
            range = [range[0].max(s.min(t)), range[1].min(s.max(t))];
        }
        (range[0] <= range[1]).then_some(range)
    }
}

#[derive(Debug, Clone, Copy)]
struct Node {
    bounds: Aabb<3>,
    /// First item of a leaf, or the second child of an inner node (the first follows it at once).
    next: u32,
    /// Number of items; 0 for inner nodes.
    count: u32,
}

/// Boxes in a tree.
#[derive(Debug)]
pub(crate) struct Bvh {
    nodes: Vec<Node>,
    /// Indices of boxes, leaf by leaf.
    items: Vec<u32>,
}

impl Bvh {
    /// A tree over `boxes`, each made larger by `margin` on all sides.
    pub(crate) fn new(boxes: &[Aabb<3>], margin: f64) -> Self {
        let grown: Vec<Aabb<3>> =
            boxes.iter().map(|b| Aabb { min: b.min.map(|x| x - margin), max: b.max.map(|x| x + margin) }).collect();
        let n = u32::try_from(boxes.len()).expect("a scene for tests has fewer than 2^32 boxes");
        let mut bvh = Self { nodes: Vec::new(), items: (0..n).collect() };
        if n > 0 {
            bvh.split(&grown, 0..boxes.len());
        }
        bvh
    }

    /// Adds the tree over a range of items.
    fn split(&mut self, boxes: &[Aabb<3>], range: std::ops::Range<usize>) {
        let items = &mut self.items[range.clone()];
        let bounds = items.iter().fold(Aabb::EMPTY, |b, &i| union(b, &boxes[i as usize]));
        let node = self.nodes.len();
        let as_u32 = |n: usize| u32::try_from(n).expect("fewer nodes than 2^32");
        self.nodes.push(Node { bounds, next: as_u32(range.start), count: as_u32(range.len()) });
        if range.len() <= LEAF {
            return;
        }
        let middle = range.start + partition(boxes, items);
        self.split(boxes, range.start..middle);
        self.nodes[node].next = as_u32(self.nodes.len());
        self.nodes[node].count = 0;
        self.split(boxes, middle..range.end);
    }

    /// Calls `visit` with every item whose box the ray may meet up to `limit`, nearer boxes first as far
    /// as the tree knows; `visit` returns the new limit.
    pub(crate) fn visit(&self, ray: &Ray, mut limit: f64, mut visit: impl FnMut(u32) -> f64) {
        let enter = |node: u32| {
            let range = ray.within(&self.nodes[node as usize].bounds)?;
            (range[1] >= 0.0).then_some((range[0], node))
        };
        let mut stack = Vec::with_capacity(64);
        stack.extend((!self.nodes.is_empty()).then(|| enter(0)).flatten());
        while let Some((from, index)) = stack.pop() {
            if from > limit {
                continue;
            }
            let node = &self.nodes[index as usize];
            if node.count > 0 {
                let items = &self.items[node.next as usize..][..node.count as usize];
                items.iter().for_each(|&item| limit = visit(item));
                continue;
            }
            match (enter(index + 1), enter(node.next)) {
                (Some(a), Some(b)) => stack.extend(if a.0 <= b.0 { [b, a] } else { [a, b] }),
                (a, b) => stack.extend(a.or(b)),
            }
        }
    }
}

fn union(a: Aabb<3>, b: &Aabb<3>) -> Aabb<3> {
    a.with(b.min).with(b.max)
}

/// Half the surface of a box; 0 for an empty one.
fn surface(b: &Aabb<3>) -> f64 {
    let [x, y, z] = [0, 1, 2].map(|k| (b.max[k] - b.min[k]).max(0.0));
    x * y + y * z + z * x
}

/// Orders items so that the first and the rest make two children, and returns how many are first.
fn partition(boxes: &[Aabb<3>], items: &mut [u32]) -> usize {
    let middle = |i: u32, k: usize| 0.5 * boxes[i as usize].min[k] + 0.5 * boxes[i as usize].max[k];
    let middles = Aabb::around(items.iter().map(|&i| [0, 1, 2].map(|k| middle(i, k))));
    let widths = [0, 1, 2].map(|k| middles.max[k] - middles.min[k]);
    let axis = (0..3).max_by(|&a, &b| widths[a].total_cmp(&widths[b])).expect("there are three axes");
    let bin = |i: u32| {
        let part = (middle(i, axis) - middles.min[axis]) / widths[axis];
        // Not a number where all middles are the same: then everything is in the first bin.
        ((part * N_BINS as f64) as usize).min(N_BINS - 1)
    };
    let mut bins = [(Aabb::EMPTY, 0usize); N_BINS];
    for &i in items.iter() {
        let (bounds, count) = &mut bins[bin(i)];
        *bounds = union(*bounds, &boxes[i as usize]);
        *count += 1;
    }
    let cost = |bins: &[(Aabb<3>, usize)]| {
        let bounds = bins.iter().filter(|b| b.1 > 0).fold(Aabb::EMPTY, |a, b| union(a, &b.0));
        surface(&bounds) * bins.iter().map(|b| b.1).sum::<usize>() as f64
    };
    let costs = (1..N_BINS).map(|k| (k, cost(&bins[..k]) + cost(&bins[k..])));
    let best = costs.min_by(|a, b| a.1.total_cmp(&b.1)).expect("there are several bins").0;
    let n = bins[..best].iter().map(|b| b.1).sum();
    if n == 0 || n == items.len() {
        return items.len() / 2;
    }
    // Stable, so that the tree depends on nothing but the boxes.
    items.sort_by_key(|&i| bin(i) >= best);
    n
}
