//! Borders of cells, in parts: between the places where what lies on them begins or ends, nothing changes.

/// More parts of one border are not looked at, but some of them.
const MOST_PARTS: usize = 4096;

/// The middles of the parts into which places cut a range; parts in which no double lies are left out.
pub(crate) fn middles([low, high]: [f64; 2], mut places: Vec<f64>) -> Vec<f64> {
    if low >= high {
        return Vec::new();
    }
    places.retain(|&x| low < x && x < high);
    places.extend([low, high]);
    places.sort_unstable_by(f64::total_cmp);
    places.dedup();
    let middles = places.windows(2).map(|w| (w[0], 0.5 * w[0] + 0.5 * w[1], w[1]));
    evenly(middles.filter(|&(low, middle, high)| low < middle && middle < high).map(|(_, middle, _)| middle).collect())
}

/// All pairs of two lists; some of them, spread over all, if there are too many.
pub(crate) fn pairs(u: &[f64], v: &[f64]) -> Vec<[f64; 2]> {
    let n = u.len() * v.len();
    let step = n.div_ceil(MOST_PARTS).max(1);
    (0..n).step_by(step).map(|i| [u[i / v.len()], v[i % v.len()]]).collect()
}

fn evenly(list: Vec<f64>) -> Vec<f64> {
    let step = list.len().div_ceil(MOST_PARTS).max(1);
    list.into_iter().step_by(step).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_lie_between_places() {
        assert_eq!(middles([0.0, 4.0], vec![2.0, -1.0, 2.0, 9.0, 3.0]), [1.0, 2.5, 3.5]);
        assert!(middles([1.0, 1.0], vec![]).is_empty());
        assert!(middles([2.0, 1.0], vec![1.5]).is_empty(), "upside down");
        let next = 1f64.next_up();
        assert!(middles([1.0, next], vec![]).is_empty(), "no double is between");
        assert_eq!(pairs(&[1.0, 2.0], &[3.0]), [[1.0, 3.0], [2.0, 3.0]]);
        let many: Vec<f64> = (0..1000).map(f64::from).collect();
        assert!(pairs(&many, &many).len() <= MOST_PARTS);
        assert!(pairs(&many, &[]).is_empty());
    }
}
