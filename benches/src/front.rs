//! The Pareto front: of what no other is better in both respects.

/// The places in `points` of those that no other point dominates, by ascending first coordinate, then by the second,
/// then by place.
///
/// Less is better. A point dominates another if it is no more in both coordinates, and less in one; so equal points
/// do not dominate each other. Points that are not finite are on no front and dominate nothing. O(n log n).
pub fn pareto_front(points: &[[f64; 2]]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..points.len()).filter(|&i| points[i].iter().all(|x| x.is_finite())).collect();
    order.sort_by(|&i, &j| {
        let [a, b] = [points[i], points[j]];
        a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])).then(i.cmp(&j))
    });
    let mut front: Vec<usize> = Vec::new();
    for i in order {
        let is_kept = front.last().is_none_or(|&last| points[i][1] < points[last][1] || points[i] == points[last]);
        if is_kept {
            front.push(i);
        }
    }
    front
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// By the words of the definition.
    fn brute_force(points: &[[f64; 2]]) -> Vec<usize> {
        let dominates = |a: &[f64; 2], b: &[f64; 2]| a[0] <= b[0] && a[1] <= b[1] && (a[0] < b[0] || a[1] < b[1]);
        let is_kept = |i: &usize| !points.iter().any(|p| dominates(p, &points[*i]));
        (0..points.len()).filter(is_kept).collect()
    }

    fn sorted(mut places: Vec<usize>) -> Vec<usize> {
        places.sort_unstable();
        places
    }

    proptest! {
        #[test]
        fn fronts_are_those_of_brute_force(points in proptest::collection::vec([0u8..6, 0u8..6], 0..24)) {
            let points: Vec<[f64; 2]> = points.iter().map(|p| p.map(f64::from)).collect();
            let front = pareto_front(&points);
            prop_assert!(front.is_sorted_by(|&i, &j| points[i][0] <= points[j][0] && points[i][1] >= points[j][1]));
            prop_assert_eq!(sorted(front), brute_force(&points), "fronts_are_those_of_brute_force: {:?}", points);
        }
    }

    #[test]
    fn what_is_known() {
        assert_eq!(pareto_front(&[]), [0usize; 0]);
        let points = [[3.0, 1.0], [1.0, 2.0], [2.0, 2.0], [1.0, 2.0], [f64::NAN, 0.0], [0.5, f64::INFINITY]];
        assert_eq!(pareto_front(&points), [1, 3, 0]);
        // The impostor: a front that keeps what is dominated is another one.
        assert_ne!(sorted(pareto_front(&points)), [0, 1, 2, 3]);
    }
}
