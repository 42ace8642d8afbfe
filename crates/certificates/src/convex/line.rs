//! Lines in space that prove visibility.

use super::vector::{Exact, Point, exact, minus, plus};
use crate::exact::is_coordinate;
use std::cmp::Ordering;

/// A directed line that passes a gate, and so joins the cells before and behind it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ConvexLine {
    /// A gate that the line passes.
    pub gate: u32,
    /// A point and another farther along the line, by the bits of their coordinates.
    pub bits: [[u64; 3]; 2],
    /// What is added to these coordinates, by its bits: for lines that pass where no line through points in doubles does. Mostly 0.
    pub rest: [[u64; 3]; 2],
}

impl ConvexLine {
    /// The line from one point towards another, which passes a gate.
    pub fn through(gate: u32, from: Point, to: Point) -> Self {
        Self { gate, bits: [from, to].map(|p| p.map(f64::to_bits)), rest: [[0; 3]; 2] }
    }

    /// The same, where each coordinate is the sum of two doubles.
    pub fn through_sums(gate: u32, points: [[[f64; 2]; 3]; 2]) -> Self {
        let [bits, rest] = [0, 1].map(|k| points.map(|p| p.map(|x| x[k].to_bits())));
        Self { gate, bits, rest }
    }

    /// Whether some coordinate is a sum of two doubles.
    pub(super) fn has_rest(&self) -> bool {
        self.rest.as_flattened().iter().any(|&x| f64::from_bits(x) != 0.0)
    }

    /// Its two points; `None` if they coincide or are not valid.
    pub(super) fn points(&self) -> Option<LinePoints> {
        let [bits, rest] = [self.bits, self.rest].map(|points| points.map(|p| p.map(f64::from_bits)));
        let fits = [bits, rest].iter().all(|points| points.as_flattened().iter().all(|x| is_coordinate(*x)));
        if !fits {
            return None;
        }
        let sum = |k: usize| if self.has_rest() { plus(&exact(bits[k]), &exact(rest[k])) } else { exact(bits[k]) };
        let exact = [sum(0), sum(1)];
        let step = minus(&exact[1], &exact[0]);
        let moves = step.iter().any(|x| x.sign() != Ordering::Equal);
        moves.then_some(LinePoints { rounded: (!self.has_rest()).then_some(bits), exact })
    }
}

/// Two points of a line, in the order in which it meets them.
pub(super) struct LinePoints {
    /// If they are points in doubles.
    pub(super) rounded: Option<[Point; 2]>,
    pub(super) exact: [Exact; 2],
}

impl LinePoints {
    pub(super) fn reversed(self) -> Self {
        let [p, q] = self.exact;
        Self { rounded: self.rounded.map(|[p, q]| [q, p]), exact: [q, p] }
    }
}
