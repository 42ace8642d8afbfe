//! One line of every kind: how lines can run between given points.
//!
//! Two lines that avoid all given points are of one kind if the same points lie on the same sides of
//! both. A line is a point of the (projective) plane of lines, a given point is a line there, and a
//! kind is a cell of the arrangement of those lines. If the given points are not all collinear, every
//! cell has a corner, and a corner is a line through two given points. So it is enough to take every
//! line `f` through two given points and to move it by less than it takes to reach another point, in
//! every way that sorts the points on `f` differently: all to one side (a shift), or those up to some
//! gap to one side and those after it to the other (a turn about the middle of the gap).
//!
//! How far is little enough is no guess: the moved line is `S f + g` with integer forms, where `g` is
//! the shift or turn, and `S = 1 + max |g(p)|` over all given points `p`. Where `f(p)` is not zero it
//! is at least 1 in magnitude, so `S f(p)` outweighs `g(p)` and the side of `p` is kept; where `f(p)`
//! is zero, `g(p)` decides.
//!
//! Bounds for `i128`: with integer points up to K = 2^8, `f` has coefficients up to 2K and 4K^2 and
//! values up to 8K^2; `g` values up to 16K^2, so S is up to 2^20 and `S f + g` has coefficients for x
//! and y up to 2^30 and values up to 2^40; a crossing with a segment is a fraction of at most
//! 2^80 / 2^41, and comparing two takes 2^121.

use crate::exact::{Form, Hp, Int};

/// Largest coordinate of integer points for which everything fits `i128`.
pub(crate) const SMALL: i128 = 1 << 8;

/// Calls `visit` with at least one line of every kind. `points` are distinct and not all collinear.
pub(crate) fn for_each_kind<T: Int>(points: &[Hp<T>], mut visit: impl FnMut(&Form<T>)) {
    for (i, p) in points.iter().enumerate() {
        for q in &points[i + 1..] {
            let f = Form::through(p, q);
            let turn = turn_between(&f, p, q);
            // A point between p and q makes this pair superfluous: its neighbours on f serve.
            let between =
                |r: &Hp<T>| f.at(r).is_zero() && turn.at(r).abs() * p.w.clone() < turn.at(p).abs() * r.w.clone();
            if points.iter().any(between) {
                continue;
            }
            let shift = Form { a: T::zero(), b: T::zero(), c: T::one() };
            for g in [&shift, &turn] {
                let most = points.iter().map(|r| g.at(r).abs()).max().unwrap_or_else(T::zero);
                let s = most + T::one();
                for sign in [T::one(), -T::one()] {
                    let mixed = |f: &T, g: &T| s.clone() * f.clone() + sign.clone() * g.clone();
                    visit(&Form { a: mixed(&f.a, &g.a), b: mixed(&f.b, &g.b), c: mixed(&f.c, &g.c) });
                }
            }
        }
    }
}

/// A line across `f` through the middle between `p` and `q` on it.
fn turn_between<T: Int>(f: &Form<T>, p: &Hp<T>, q: &Hp<T>) -> Form<T> {
    let along = f.along();
    let both = p.w.clone() * q.w.clone();
    let twice = |x: T| x.clone() + x;
    let c = -(along.at(p) * q.w.clone() + along.at(q) * p.w.clone());
    Form { a: twice(both.clone() * along.a), b: twice(both * along.b), c }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::BTreeSet;

    /// The sides of all points, the first point's being positive.
    fn kind(f: &Form<i128>, points: &[Hp<i128>]) -> Vec<i32> {
        let first = f.at(&points[0]).sign();
        points.iter().map(|p| f.at(p).sign() * first).collect()
    }

    fn kinds(points: &[Hp<i128>]) -> BTreeSet<Vec<i32>> {
        let mut kinds = BTreeSet::new();
        for_each_kind(points, |f| {
            kinds.insert(kind(f, points));
        });
        kinds
    }

    /// The arrangement of n lines of the projective plane in general position has 1 + n (n - 1) / 2
    /// cells; points in general position have as many kinds of lines.
    #[test]
    fn candidates_count_in_general_position() {
        let points = [[0, 0], [7, 1], [3, 5], [-4, 6], [2, -9]].map(|p| Hp::new(p.map(i128::from)));
        for n in 3..=5usize {
            assert_eq!(kinds(&points[..n]).len(), 1 + n * (n - 1) / 2);
        }
    }

    proptest! {
        /// Whatever line is drawn, its kind is among the candidates, and candidates avoid all points.
        #[test]
        fn candidates_hold_every_kind(
            points in prop::collection::btree_set([-3i128..=3, -3i128..=3], 3..8),
            lines in prop::collection::vec([-5i128..=5, -5i128..=5, -40i128..=40], 50),
        ) {
            let points: Vec<Hp<i128>> = points.into_iter().map(Hp::new).collect();
            let base = Form::through(&points[0], &points[1]);
            prop_assume!(points.iter().any(|p| base.at(p) != 0));
            let kinds = kinds(&points);
            prop_assert!(kinds.iter().flatten().all(|&side| side != 0));
            for [a, b, c] in lines {
                let line = Form { a: 3 * a, b: 3 * b, c };
                if points.iter().all(|p| line.at(p) != 0) && (a, b) != (0, 0) {
                    prop_assert!(kinds.contains(&kind(&line, &points)), "{:?}", line);
                }
            }
        }
    }
}
