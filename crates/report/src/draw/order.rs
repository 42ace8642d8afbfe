//! Boxes from back to front.

use sightlines_geometry::Aabb;

/// The indices of boxes that do not overlap, such that for a viewer far away on the positive side of all
/// axes none is in front of a later one.
///
/// Boxes that planes can take apart, one plane after the other, as those of a k-d tree, are ordered so;
/// a knot of boxes that none can is ordered by how near the middles are. Boxes may touch. A box without
/// extent on an axis may come early. O(n log n) for each storey of the tree.
pub(super) fn back_to_front(boxes: &[Aabb<3>]) -> Vec<usize> {
    let mut order = Vec::with_capacity(boxes.len());
    // A group of boxes, and how many axes in a row could not take it apart.
    let mut stack = vec![((0..boxes.len()).collect::<Vec<_>>(), 0, 0)];
    while let Some((mut group, axis, n_failed)) = stack.pop() {
        if group.len() < 2 {
            order.extend(group);
        } else if n_failed == 3 {
            let nearness = |i: &usize| (0..3).map(|k| boxes[*i].min[k] + boxes[*i].max[k]).sum::<f64>();
            group.sort_by(|a, b| nearness(a).total_cmp(&nearness(b)).then(a.cmp(b)));
            order.extend(group);
        } else {
            let layers = layers(boxes, group, axis);
            let n_failed = if layers.len() > 1 { 1 } else { n_failed + 1 };
            // The last to be pushed is the first to be drawn: what is lowest on the axis is farthest away.
            stack.extend(layers.into_iter().rev().map(|layer| (layer, (axis + 1) % 3, n_failed)));
        }
    }
    order
}

/// Takes a group apart along an axis, wherever a plane meets no box; ascending.
fn layers(boxes: &[Aabb<3>], mut group: Vec<usize>, axis: usize) -> Vec<Vec<usize>> {
    group.sort_by(|&a, &b| boxes[a].min[axis].total_cmp(&boxes[b].min[axis]).then(a.cmp(&b)));
    let mut layers: Vec<Vec<usize>> = Vec::new();
    let mut reach = f64::NEG_INFINITY;
    for i in group {
        match layers.last_mut().filter(|_| boxes[i].min[axis] < reach) {
            Some(layer) => layer.push(i),
            None => layers.push(vec![i]),
        }
        reach = reach.max(boxes[i].max[axis]);
    }
    layers
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Cuts a box into pieces by planes that `seed` chooses.
    fn cut(b: Aabb<3>, seed: u64, boxes: &mut Vec<Aabb<3>>) {
        let axis = (seed % 3) as usize;
        let at = b.min[axis] + 1.0 + (seed / 3 % 4) as f64;
        if seed.is_multiple_of(7) || at >= b.max[axis] {
            return boxes.push(b);
        }
        let (mut low, mut high) = (b, b);
        (low.max[axis], high.min[axis]) = (at, at);
        let next = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        cut(high, next >> 7, boxes);
        cut(low, next >> 19, boxes);
    }

    proptest! {
        /// Invariant: what lies lower on an axis and may be covered is drawn first.
        #[test]
        fn boxes_of_a_tree_are_drawn_back_to_front(seed in any::<u64>()) {
            let mut boxes = Vec::new();
            cut(Aabb { min: [0.0; 3], max: [9.0; 3] }, seed, &mut boxes);
            let order = back_to_front(&boxes);
            let mut sorted = order.clone();
            sorted.sort_unstable();
            prop_assert_eq!(sorted, (0..boxes.len()).collect::<Vec<_>>());
            for (i, &a) in order.iter().enumerate() {
                for &b in &order[i + 1..] {
                    // The one drawn later may only be behind if it is in front on another axis too.
                    let behind = |k: usize| boxes[b].max[k] <= boxes[a].min[k];
                    let in_front = |k: usize| boxes[a].max[k] <= boxes[b].min[k];
                    prop_assert!(!(0..3).any(behind) || (0..3).any(in_front), "{:?} before {:?}", boxes[a], boxes[b]);
                }
            }
        }
    }

    /// A row of very many boxes, and boxes wound round each other in a plane, are ordered too.
    #[test]
    fn rows_and_knots_are_ordered() {
        let row: Vec<Aabb<3>> =
            (0..50_000).map(|i| Aabb { min: [f64::from(i), 0.0, 0.0], max: [f64::from(i) + 1.0, 1.0, 1.0] }).collect();
        assert!(back_to_front(&row).is_sorted());
        let flat = |x0, y0, x1, y1| Aabb { min: [x0, y0, 0.0], max: [x1, y1, 1.0] };
        let knot = [flat(0., 0., 2., 1.), flat(2., 0., 3., 2.), flat(1., 2., 3., 3.), flat(0., 1., 1., 3.)];
        let mut order = back_to_front(&knot);
        assert_eq!(order[0], 0);
        order.sort_unstable();
        assert_eq!(order, [0, 1, 2, 3]);
    }
}
