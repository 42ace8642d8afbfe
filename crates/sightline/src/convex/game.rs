//! Games of a matrix, in numbers of two doubles: what a weighted sum of rows is at least, in every column.
//!
//! One side chooses a row and wants much, the other a column and wants little; each may mix. The value is what both can be
//! sure of. Solved by the simplex method with a full tableau. It proposes and decides nothing.
//!
//! Source: von Neumann and Morgenstern, "Theory of Games and Economic Behavior", 1944, for the value; Dantzig, "Linear
//! Programming and Extensions", 1963, for games as linear programs.

use crate::wide::Wide;

/// Gains below this are rounding. Entries of games are of the order of 1.
const GAIN: f64 = 1e-27;
/// Entries of smaller magnitude are not used as pivots.
const PIVOT: f64 = 1e-22;
/// Number of exchanges after which the first column with a gain enters instead of the one with the largest, so that no
/// basis returns.
const MOST_GREEDY: usize = 60;
/// Number of exchanges after which it gives up.
const MAX_EXCHANGES: usize = 160;

/// The solution of a game.
#[derive(Debug, Clone)]
pub(super) struct Solution {
    /// The value, up to rounding.
    pub(super) value: Wide,
    /// With these weights, which add up to 1, the sum of rows is at least the value in every column.
    pub(super) rows: Vec<Wide>,
    /// With these weights, the sum of columns is at most the value in every row.
    pub(super) columns: Vec<Wide>,
}

/// Solves a game given by its columns, all of one length. `None` for an empty game, or if it does not end.
///
/// Cost: `O(rows (rows + columns))` for an exchange, and some exchanges for each row.
pub(super) fn solve(columns: &[Vec<Wide>]) -> Option<Solution> {
    let (n_rows, n_columns) = (columns.first()?.len(), columns.len());
    let least = columns.iter().flatten().copied().reduce(|a, b| if b < a { b } else { a })?;
    // With all entries at least 1, the column player's weights, divided by the value, are a linear program that starts
    // at 0.
    let shift = Wide::ONE - least;
    let width = n_columns + n_rows + 1;
    let mut tableau: Vec<Vec<Wide>> = (0..n_rows)
        .map(|i| {
            let mut row = vec![Wide::ZERO; width];
            for (place, column) in row.iter_mut().zip(columns) {
                *place = column[i] + shift;
            }
            (row[n_columns + i], row[width - 1]) = (Wide::ONE, Wide::ONE);
            row
        })
        .collect();
    let mut gains = vec![Wide::ZERO; width];
    gains[..n_columns].fill(-Wide::ONE);
    let mut basis: Vec<usize> = (n_columns..width - 1).collect();
    let mut ended = false;
    for exchange in 0..MAX_EXCHANGES {
        let has_gain = |&k: &usize| gains[k].high < -GAIN;
        let entering = if exchange < MOST_GREEDY {
            (0..width - 1).filter(has_gain).min_by(|&a, &b| gains[a].partial_cmp(&gains[b]).expect("finite"))
        } else {
            (0..width - 1).find(has_gain)
        };
        let Some(entering) = entering else {
            ended = true;
            break;
        };
        let mut leaving: Option<(usize, Wide)> = None;
        for (i, row) in tableau.iter().enumerate().filter(|(_, row)| row[entering].high > PIVOT) {
            let ratio = row[width - 1] / row[entering];
            let sooner = |(k, best): (usize, Wide)| ratio < best || (ratio == best && basis[i] < basis[k]);
            if leaving.is_none_or(sooner) {
                leaving = Some((i, ratio));
            }
        }
        let (out, _) = leaving?;
        basis[out] = entering;
        let pivot = Wide::ONE / tableau[out][entering];
        tableau[out].iter_mut().for_each(|x| *x = *x * pivot);
        let pivot_row = tableau[out].clone();
        let eliminate = |row: &mut [Wide]| {
            let factor = row[entering];
            if factor.high != 0.0 {
                for (x, y) in row.iter_mut().zip(&pivot_row).filter(|(_, y)| y.high != 0.0) {
                    *x = *x - factor * *y;
                }
            }
        };
        tableau.iter_mut().enumerate().filter(|&(i, _)| i != out).for_each(|(_, row)| eliminate(row));
        eliminate(&mut gains);
    }
    let total = gains[width - 1];
    if !ended || total.high.is_nan() || total.high <= 0.0 {
        return None;
    }
    let mut mixed = vec![Wide::ZERO; n_columns];
    for (row, &k) in tableau.iter().zip(&basis).filter(|&(_, &k)| k < n_columns) {
        mixed[k] = row[width - 1] / total;
    }
    Some(Solution {
        value: Wide::ONE / total - shift,
        rows: gains[n_columns..width - 1].iter().map(|&x| x / total).collect(),
        columns: mixed,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_rational::BigRational;
    use num_traits::Signed;
    use proptest::prelude::*;
    use sightlines_exact::rational;

    fn exact(x: Wide) -> BigRational {
        rational(x.high) + rational(x.low)
    }

    /// How much less than the value the weights of rows are sure of, and how much more those of columns, at worst.
    fn gaps(columns: &[Vec<Wide>], found: &Solution) -> [BigRational; 2] {
        let value = exact(found.value);
        let by_rows = columns.iter().map(|c| c.iter().zip(&found.rows).map(|(x, w)| exact(*x) * exact(*w)).sum());
        let sum = |i: usize| columns.iter().zip(&found.columns).map(|(c, w)| exact(c[i]) * exact(*w)).sum();
        let by_columns = (0..columns[0].len()).map(sum);
        let least: BigRational = by_rows.min().expect("a column");
        let most: BigRational = by_columns.max().expect("a row");
        [&value - least, most - &value]
    }

    proptest! {
        /// Invariant: both mixtures are sure of the value, to 2^-85.
        #[test]
        fn both_sides_are_sure_of_the_value(
            n_rows in 1usize..10,
            entries in prop::collection::vec((-8i32..9, -2i32..3), 1..200),
        ) {
            let entry = |(x, step): &(i32, i32)| Wide::of(f64::from(*x) / 8.0) + Wide::of(f64::from(*step) / 256.0);
            let columns: Vec<Vec<Wide>> =
                entries.chunks_exact(n_rows).map(|c| c.iter().map(entry).collect()).collect();
            if columns.is_empty() {
                return Ok(());
            }
            let found = solve(&columns);
            prop_assert!(found.is_some(), "it ends");
            let found = found.unwrap();
            let bound = rational(2f64.powi(-85));
            prop_assert!(gaps(&columns, &found).iter().all(|gap| *gap <= bound), "{:?}", gaps(&columns, &found));
            for weights in [&found.rows, &found.columns] {
                let one: BigRational = weights.iter().map(|w| exact(*w)).sum();
                prop_assert!((one - rational(1.0)).abs() <= bound);
                prop_assert!(weights.iter().all(|w| w.high >= -1e-26));
            }
        }
    }

    /// A game that doubles get wrong: its value is half a unit in the last place of 1.
    #[test]
    fn a_value_of_half_a_unit_in_the_last_place_is_found() {
        let tiny = Wide::of(f64::EPSILON);
        let columns = [vec![Wide::ONE, tiny - Wide::ONE], vec![-Wide::ONE, Wide::ONE]];
        let found = solve(&columns).unwrap();
        // (1 * 1 - (-1)(e - 1)) / (1 + 1 + 1 - (e - 1)) = e / (4 - e).
        let value = tiny / (Wide::of(4.0) - tiny);
        assert!((found.value - value).high.abs() < 1e-30, "{:?}", found.value);
        // The impostor: mixtures that are off by half a unit in the last place are not sure of it.
        let [a, b] = [found.rows[0], found.rows[1]];
        let off = Wide::of(f64::EPSILON / 4.0);
        for rows in [vec![a + off, b - off], vec![a - off, b + off]] {
            let rough = Solution { rows, ..found.clone() };
            assert!(gaps(&columns, &rough)[0] > rational(2f64.powi(-85)));
        }
    }
}
