//! Which faces are left out within a budget.

use crate::intercepts::Intercepts;
use crate::mesh::{Mesh, State};
use sightlines_visible_surface::Faces;

/// The spent share of the view, for each part of the views. Sums are rounded up.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Account {
    spent: Vec<f64>,
}

impl Account {
    pub(crate) fn new(n_parts: usize) -> Self {
        Self { spent: vec![0.0; n_parts] }
    }

    /// The spent share of the part with the most.
    pub(crate) fn most(&self) -> f64 {
        self.spent.iter().copied().fold(0.0, f64::max)
    }

    /// Spends `cost` for each part, if no part exceeds `budget`. Returns whether it did.
    pub(crate) fn spend(&mut self, budget: f64, cost: impl Fn(usize) -> f64) -> bool {
        if (0..self.spent.len()).any(|part| sum_up(self.spent[part], cost(part)) > budget) {
            return false;
        }
        self.spent.iter_mut().enumerate().for_each(|(part, spent)| *spent = sum_up(*spent, cost(part)));
        true
    }

    /// Refunds an earlier cost.
    pub(crate) fn refund(&mut self, cost: impl Fn(usize) -> f64) {
        self.spent.iter_mut().enumerate().for_each(|(part, spent)| {
            let cost = cost(part);
            // The remainder is rounded up; it is never negative, nor more than before.
            if cost > 0.0 {
                *spent = (*spent - cost).next_up().clamp(0.0, *spent);
            }
        });
    }
}

/// A sum of non-negative numbers, rounded up.
pub(crate) fn sum_up(a: f64, b: f64) -> f64 {
    if a == 0.0 {
        b
    } else if b == 0.0 {
        a
    } else {
        (a + b).next_up()
    }
}

/// The unchanged faces of the scene.
pub(crate) fn kept_faces<'a>(mesh: &'a Mesh, faces: &Faces) -> impl Iterator<Item = u32> + 'a {
    faces.ids().filter(|&f| mesh.face(f).state == State::Kept)
}

/// Takes faces, those that intercept least first, as long as their sum stays within `budget` in each part, and calls
/// `take` with each.
pub(crate) fn least_visible(
    intercepts: &Intercepts,
    candidates: impl Iterator<Item = u32>,
    budget: f64,
    account: &mut Account,
    mut take: impl FnMut(u32),
) {
    let mut faces: Vec<(f64, u32)> = candidates.map(|face| (intercepts.largest(face), face)).collect();
    faces.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    for (largest, face) in faces {
        // Later faces are no less visible, and no part has room left for them.
        if largest > budget {
            break;
        }
        if account.spend(budget, |part| intercepts.of(part, face)) {
            take(face);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_part_gets_above_the_budget() {
        let mut account = Account::new(2);
        assert!(account.spend(1.0, |part| [0.5, 0.25][part]));
        assert!(!account.spend(1.0, |part| [0.6, 0.0][part]));
        assert_eq!(account.most(), 0.5);
        // One half plus one half, rounded up, exceeds one.
        assert!(!account.spend(1.0, |part| [0.5, 0.0][part]));
        assert!(account.spend(1.0, |part| [0.0, 0.7][part]));
        assert!((0.95..0.951).contains(&account.most()));
    }
}
