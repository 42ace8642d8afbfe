//! Pairs proven visible by following many lines.

use super::gates::Gates;
use super::vector::{Point3, add, dot, scale};
use sightlines_geometry::Random;
use sightlines_pvs::BitMatrix;

/// Marks all cells on a line as seeing each other. `chain` has the gates that the line passes, in order.
pub(super) fn mark(gates: &Gates, chain: &[u32], visible: &mut BitMatrix) {
    let Some(&last) = chain.last() else { return };
    let cells = || chain.iter().map(|&g| gates.get(g).from).chain([gates.get(last).to]);
    // Only the words with cells of the line.
    let (low, high) = cells().fold((u32::MAX, 0), |(low, high), c| (low.min(c / 64), high.max(c / 64)));
    let words = low as usize..high as usize + 1;
    let mut mask = vec![0u64; words.len()];
    cells().for_each(|c| mask[(c / 64 - low) as usize] |= 1 << (c % 64));
    for cell in cells() {
        let row = &mut visible.row_mut(cell as usize)[words.clone()];
        row.iter_mut().zip(&mask).for_each(|(row, mask)| *row |= mask);
    }
}

/// Pseudorandom lines.
struct Chance(Random);

impl Chance {
    fn point_in(&mut self, corners: &[super::cut::Vertex]) -> Point3 {
        let (mut sum, mut weights) = ([0.0; 3], 0.0);
        for v in corners {
            let weight = self.0.unit() + 2f64.powi(-20);
            sum = add(sum, scale(v.at, weight));
            weights += weight;
        }
        scale(sum, 1.0 / weights)
    }

    fn direction(&mut self) -> Point3 {
        loop {
            let d: Point3 = std::array::from_fn(|_| 2.0 * self.0.unit() - 1.0);
            let square = dot(d, d);
            if (0.01..1.0).contains(&square) {
                return scale(d, 1.0 / square.sqrt());
            }
        }
    }
}

/// Follows `n` lines through a gate, always the same ones, and passes the gates of each to `each`.
pub(super) fn shoot_through(gates: &Gates, gate: u32, n: u32, mut each: impl FnMut(&[u32])) {
    let mut chance = Chance(Random::new(u64::from(gate) << 32));
    let mut chain = Vec::new();
    for _ in 0..n {
        let origin = chance.point_in(gates.corners(gate));
        let d = chance.direction();
        let d = if dot(d, gates.get(gate).normal) < 0.0 { scale(d, -1.0) } else { d };
        gates.chain(gate, origin, d, &mut chain);
        each(&chain);
    }
}
