//! Cutting a phase into shards.

use super::manifest::ShardPlan;

/// Cuts units into at most `n_shards` ranges of about the same cost; none is empty. Without any cost, units count alike.
///
/// A range ends where its cost comes nearest to an equal share of what is left, so a unit that costs more than a share has a range of its own, or nearly so.
pub fn cut(costs: &[f64], n_shards: usize) -> Vec<ShardPlan> {
    let is_known = costs.iter().any(|&cost| cost > 0.0);
    let cost_of = |unit: usize| if is_known { costs[unit] } else { 1.0 };
    let n_shards = n_shards.clamp(1, costs.len().max(1));
    let mut left: f64 = (0..costs.len()).map(cost_of).sum();
    let mut shards = Vec::with_capacity(n_shards);
    let mut begin = 0;
    for k in 0..n_shards {
        let n_later = n_shards - k - 1;
        let share = left / (n_later + 1) as f64;
        // As many units stay as there are shards to come.
        let last = costs.len() - n_later.min(costs.len());
        let (mut end, mut cost) = (begin, 0.0);
        while end < last {
            let next = cost_of(end);
            if n_later > 0 && end > begin && cost + next - share > share - cost {
                break;
            }
            cost += next;
            end += 1;
        }
        shards.push(ShardPlan { begin, end, cost });
        left -= cost;
        begin = end;
    }
    shards
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ends(costs: &[f64], n: usize) -> Vec<usize> {
        cut(costs, n).iter().map(|shard| shard.end).collect()
    }

    #[test]
    fn shards_cost_about_the_same() {
        assert_eq!(ends(&[1.0; 8], 4), [2, 4, 6, 8]);
        assert_eq!(ends(&[0.0; 6], 3), [2, 4, 6]);
        assert_eq!(ends(&[4.0, 1.0, 1.0, 1.0, 1.0], 2), [1, 5]);
        assert_eq!(ends(&[1.0, 1.0, 100.0, 1.0, 1.0], 3), [2, 3, 5]);
        assert_eq!(ends(&[1.0; 3], 9), [1, 2, 3]);
        assert_eq!((ends(&[], 5), ends(&[2.0], 0)), (vec![0], vec![1]));
    }

    /// Costs that fall as those of later viewers do: no shard costs much more than its share.
    #[test]
    fn falling_costs_are_cut_evenly() {
        let costs: Vec<f64> = (0..1000).rev().map(f64::from).collect();
        let all: f64 = costs.iter().sum();
        for n in [2, 7, 32, 64] {
            let shards = cut(&costs, n);
            let most = shards.iter().map(|shard| shard.cost).fold(0.0, f64::max);
            assert!(shards.len() == n && most < 1.1 * all / n as f64, "{n}: {most}");
            // The impostor: equal counts of units.
            let first: f64 = costs[..1000 / n].iter().sum();
            assert!(first > 1.4 * all / n as f64);
        }
    }
}
