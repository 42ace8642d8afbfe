//! Lines in space that prove visibility.

use super::vector::Point;
use crate::exact::is_coordinate;

/// A directed line that passes a gate, and so joins the cells before and behind it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ConvexLine {
    /// A gate that the line passes.
    pub gate: u32,
    /// A point and another farther along the line, by the bits of their coordinates.
    pub bits: [[u64; 3]; 2],
}

impl ConvexLine {
    /// The line from one point towards another, which passes a gate.
    pub fn through(gate: u32, from: Point, to: Point) -> Self {
        Self { gate, bits: [from, to].map(|p| p.map(f64::to_bits)) }
    }

    /// Its two points; `None` if they coincide or are not valid.
    pub(super) fn points(&self) -> Option<[Point; 2]> {
        let [p, q] = self.bits.map(|p| p.map(f64::from_bits));
        let fits = [p, q].as_flattened().iter().all(|x| is_coordinate(*x));
        (fits && p != q).then_some([p, q])
    }
}
