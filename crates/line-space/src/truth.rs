//! Fractions, for tests that follow true corners.

use crate::end::End;
use num_rational::BigRational;
use num_traits::Zero;
use proptest::prelude::*;
use sightlines_geometry::Point3;

/// A point whose coordinates are known exactly.
pub(crate) type Exact = [BigRational; 3];

/// A side, the part of it where it is cut, in 32nds, and whether the first half is kept.
pub(crate) type Cut = (usize, u32, bool);

pub(crate) fn exact(p: Point3) -> Exact {
    p.map(|x| BigRational::from_float(x).expect("finite"))
}

/// `orient3d(a, b, c, d)`.
pub(crate) fn det(a: &Exact, b: &Exact, c: &Exact, d: &Exact) -> BigRational {
    let [u, v, w] = [b, c, d].map(|p| [0, 1, 2].map(|k| &p[k] - &a[k]));
    let minor = |i: usize, j: usize| &u[i] * &v[j] - &u[j] * &v[i];
    minor(1, 2) * &w[0] + minor(2, 0) * &w[1] + minor(0, 1) * &w[2]
}

/// The point with these weights of the corners.
pub(crate) fn mix(corners: &[Exact], weights: &[u64]) -> Exact {
    let sum = BigRational::from_integer(weights.iter().sum::<u64>().into());
    let part = |k: usize| corners.iter().zip(weights).map(move |(c, &w)| &c[k] * BigRational::from_integer(w.into()));
    [0, 1, 2].map(|k| part(k).fold(BigRational::zero(), |a, b| a + b) / &sum)
}

pub(crate) fn cuts(most: usize) -> impl Strategy<Value = Vec<Cut>> {
    prop::collection::vec((0usize..3, 1u32..32, any::<bool>()), 0..most)
}

/// A triangle after some cuts, as an end and by its true corners. Ends early where doubles leave no room.
pub(crate) fn cut_triangle(triangle: [Point3; 3], cuts: Vec<Cut>) -> (End, [Exact; 3]) {
    let (mut end, mut truth) = (End::triangle(triangle), triangle.map(exact));
    for (side, part, first) in cuts {
        let Some(halves) = end.cut(side, f64::from(part) / 32.0) else { break };
        let (i, j) = (side, (side + 1) % 3);
        let part = BigRational::new(part.into(), 32.into());
        let middle = [0, 1, 2].map(|k| &truth[i][k] + (&truth[j][k] - &truth[i][k]) * &part);
        truth[if first { j } else { i }] = middle;
        end = halves[usize::from(!first)];
    }
    (end, truth)
}
