//! The predicates that everything is decided by, against the same formulas in plain floats.
//!
//! Of each predicate one answer hides something: a wall said to block a line that passes it, a point said to be behind. The truth is a
//! determinant in whole numbers. What only touches a wall counts as hidden by it, as walls are closed.

pub(crate) mod cases;
pub(crate) mod exact;
#[cfg(test)]
pub(crate) mod sharp;
#[cfg(test)]
mod tests;
mod ways;

use super::{Decide, Kind, Sweep, SweepMethod};
use cases::corners;
use cases::{Apart, Case, Place};
use sightlines::geometry::{Point3, Random};

/// A predicate and those who decide it.
struct Ask {
    /// Names of its sweeps: by distance, by scale, by nearness.
    names: [&'static str; 3],
    make: fn(Place, &mut Random) -> Case,
    /// Whether a case is open; nothing where either answer will do.
    open: fn(&[Point3]) -> Option<bool>,
    methods: Vec<Decide<Case>>,
}

const fn shipped(name: &'static str) -> SweepMethod {
    SweepMethod { name, kind: Kind::Shipped }
}

const fn naive(name: &'static str) -> SweepMethod {
    SweepMethod { name, kind: Kind::Naive }
}

fn points<const N: usize>(case: &[Point3]) -> [Point3; N] {
    *case.first_chunk().expect("a case has all of its points")
}

fn asks() -> Vec<Ask> {
    vec![
        Ask {
            names: ["predicate-line-distance", "predicate-line-scale", "predicate-line-ulps"],
            make: cases::line,
            open: |case| Some(exact::turn(points(case)) < 0),
            methods: vec![
                (shipped("line exact"), ways::line::exact),
                (naive("line f64"), ways::line::plain::<f64>),
                (naive("line f64 epsilon"), ways::line::epsilon),
                (naive("line f64 kept"), ways::line::kept),
                (naive("line f32"), ways::line::plain::<f32>),
            ],
        },
        Ask {
            names: ["predicate-plane-distance", "predicate-plane-scale", "predicate-plane-ulps"],
            make: cases::plane,
            open: |case| Some(exact::side(points(case)) > 0),
            methods: vec![
                (shipped("plane exact"), ways::plane::exact),
                (naive("plane f64"), ways::plane::plain::<f64>),
                (naive("plane f64 epsilon"), ways::plane::epsilon),
                (naive("plane f64 kept"), ways::plane::kept),
                (naive("plane f32"), ways::plane::plain::<f32>),
            ],
        },
        Ask {
            names: ["predicate-polygon-distance", "predicate-polygon-scale", "predicate-polygon-ulps"],
            make: cases::polygon,
            open: |case| {
                let (&p, corners) = case.split_last()?;
                let n = corners.len();
                Some((0..n).any(|i| exact::turn([corners[i], corners[(i + 1) % n], p]) < 0))
            },
            methods: vec![
                (shipped("polygon exact"), ways::polygon::exact),
                (naive("polygon f64"), ways::polygon::plain::<f64>),
                (naive("polygon f64 epsilon"), ways::polygon::epsilon),
                (naive("polygon f64 crossings"), ways::polygon::crossings),
                (naive("polygon f32"), ways::polygon::plain::<f32>),
            ],
        },
        Ask {
            names: ["predicate-segments-distance", "predicate-segments-scale", "predicate-segments-ulps"],
            make: cases::segments,
            open: |case| {
                let [a, b, c, d] = points(case);
                let pairs = [[[a, b, c], [a, b, d]], [[c, d, a], [c, d, b]]];
                let signs = pairs.map(|[p, q]| exact::turn(p) * exact::turn(q));
                // Both ends of one strictly on one side of the other; or each parts the other's. Touching may be either.
                if signs.contains(&1) { Some(true) } else { (signs == [-1, -1]).then_some(false) }
            },
            methods: vec![
                (shipped("segments exact"), ways::segments::exact),
                (naive("segments f64"), ways::segments::plain::<f64>),
                (naive("segments f64 epsilon"), ways::segments::epsilon),
                (naive("segments f32"), ways::segments::plain::<f32>),
            ],
        },
        Ask {
            names: ["predicate-umbra-distance", "predicate-umbra-scale", "predicate-umbra-ulps"],
            make: cases::umbra,
            open: |case| {
                let [min, max, a, b, t] = points(case);
                Some(corners(min, max).iter().any(|&v| exact::side([v, a, b, t]) > 0))
            },
            methods: vec![
                (shipped("umbra exact"), ways::umbra::exact),
                (shipped("umbra f32 margin"), ways::umbra::margin),
                (naive("umbra f64"), ways::umbra::plain::<f64>),
                (naive("umbra f64 epsilon"), ways::umbra::epsilon),
                (naive("umbra f32 no margin"), ways::umbra::no_margin),
                (naive("umbra f32"), ways::umbra::plain::<f32>),
            ],
        },
    ]
}

/// What is swept.
#[derive(Debug, Clone, Copy)]
enum Swept {
    Distance,
    Scale,
    Ulps,
}

impl Swept {
    const ALL: [Self; 3] = [Self::Distance, Self::Scale, Self::Ulps];

    const fn about(self) -> [&'static str; 2] {
        match self {
            Self::Distance => [
                "Cases of size 1, a thousandth of that away from undecided, at growing distance from the origin. \
                 The truth is a determinant in whole numbers.",
                "distance from the origin (sizes)",
            ],
            Self::Scale => [
                "Cases at the origin, a millionth of their size away from undecided, of all sizes. \
                 The truth is a determinant in whole numbers.",
                "size of a case (units)",
            ],
            Self::Ulps => [
                "Cases of size 1 at the origin; what decides is moved by some units in the last place from where, \
                 but for rounding, nothing would be decided. The truth is a determinant in whole numbers.",
                "moved by (units in the last place)",
            ],
        }
    }

    fn levels(self, quick: bool) -> Vec<f64> {
        let step = if quick { 3 } else { 1 };
        match self {
            Self::Distance => powers_of_ten(0, 9, step),
            Self::Scale => powers_of_ten(-6, 6, step),
            Self::Ulps => (0..=24).step_by(2 * step).map(|e| f64::from(1u32 << e)).collect(),
        }
    }

    fn place(self, level: f64) -> Place {
        match self {
            Self::Distance => Place { far: level, scale: 1.0, apart: Apart::Part(1e-3) },
            Self::Scale => Place { far: 0.0, scale: level, apart: Apart::Part(1e-6) },
            Self::Ulps => Place { far: 0.0, scale: 1.0, apart: Apart::Ulps(level as i64) },
        }
    }
}

/// Powers of ten as they are read, from `10^low` on, `step` apart.
pub(crate) fn powers_of_ten(low: i32, high: i32, step: usize) -> Vec<f64> {
    (low..=high).step_by(step).map(|e| format!("1e{e}").parse().expect("a power of ten is a number")).collect()
}

/// All sweeps of predicates.
pub fn sweeps(quick: bool) -> Vec<Sweep> {
    let cases = if quick { 4000 } else { 20_000 };
    let mut out = Vec::new();
    for swept in Swept::ALL {
        for Ask { names, make, open, methods } in asks() {
            let [about, parameter] = swept.about();
            let draw = move |level: f64, random: &mut Random| {
                let case = make(swept.place(level), random);
                open(&case).map(|open| (case, open))
            };
            let name = names[swept as usize];
            out.push(Sweep::of_cases([name, about, parameter], swept.levels(quick), cases, methods, draw));
        }
    }
    out
}
