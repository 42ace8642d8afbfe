//! Lines of the plane that prove visibility.

use crate::exact::{Dyadic, is_coordinate, turn};
use num_bigint::BigInt;
use std::cmp::Ordering;

/// A point of the plane, in scene units.
pub type Point = [f64; 2];

/// A directed line that crosses portals of a cell, and so joins the cells that it passes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PlanLine {
    /// A cell that the line passes.
    pub cell: u32,
    /// The line.
    pub form: LineForm,
}

/// The form in which a line is given.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum LineForm {
    /// From one point towards another, by the bits of their coordinates.
    Points([[u64; 2]; 2]),
    /// `a x + b y + c = 0` in whole numbers; points on the left have a positive value. For lines through no two points
    /// in doubles.
    Whole(Box<[BigInt; 3]>),
}

impl PlanLine {
    /// The line through two points, which passes a cell.
    pub fn through(cell: u32, from: Point, to: Point) -> Self {
        Self { cell, form: LineForm::Points([from, to].map(|p| p.map(f64::to_bits))) }
    }
}

/// A line for tests of sides.
pub(super) enum Line {
    Points(Point, Point),
    Whole([Dyadic; 3]),
}

impl Line {
    /// `None` for points that coincide or are not valid.
    pub(super) fn of(line: &PlanLine) -> Option<Self> {
        match &line.form {
            LineForm::Points(points) => {
                let [p, q] = points.map(|p| p.map(f64::from_bits));
                let fits = [p, q].as_flattened().iter().all(|x| is_coordinate(*x));
                (fits && p != q).then_some(Self::Points(p, q))
            }
            LineForm::Whole(abc) => {
                let [a, b, c] = &**abc;
                Some(Self::Whole([a, b, c].map(|x| Dyadic::whole(x.clone()))))
            }
        }
    }

    pub(super) fn reversed(&self) -> Self {
        match self {
            Self::Points(p, q) => Self::Points(*q, *p),
            Self::Whole([a, b, c]) => Self::Whole([-a, -b, -c]),
        }
    }

    /// `Greater` for points on the left. Exact.
    pub(super) fn side(&self, p: Point) -> Ordering {
        match self {
            Self::Points(from, to) => turn(*from, *to, p),
            Self::Whole([a, b, c]) => {
                let [x, y] = p.map(Dyadic::new);
                (&(&(a * &x) + &(b * &y)) + c).sign()
            }
        }
    }
}
