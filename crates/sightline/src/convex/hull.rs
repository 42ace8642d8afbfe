//! The hull of lines with coordinates in the unit box, in space with products as coordinates.
//!
//! Rows are over u, v, s, t, us, ut, vs, vt and the margin. The hull of the sixteen corners, in which
//! each point of (u, v) is multiplied with each of (s, t), has 24 facets: four McCormick rows for each
//! product, and eight rows of Clauser and Horne, one pair for each product that counts negative.
//!
//! Source: McCormick, Math. Programming 10, 1976; Clauser and Horne, Phys. Rev. D 10, 1974, whose
//! polytope is the same; that these are all is Fine, Phys. Rev. Lett. 48, 1982.

use super::simplex::Program;

/// Number of rows that are not about edges.
pub(super) const N_HULL: usize = 9 + 12 + 8;

/// The greatest margin that is of interest.
const CAP: f64 = 1.0;

/// Pairs of a first coordinate (0, 1) and a second one (0, 1), in the order of their products.
const PAIRS: [[usize; 2]; 4] = [[0, 0], [0, 1], [1, 0], [1, 1]];

/// Starts the program with the rows of the hull; it has none yet, or begins with them already.
pub(super) fn start(program: &mut Program<9>) {
    program.truncate(N_HULL);
    if program.n_rows() == N_HULL {
        return;
    }
    for i in 0..9 {
        let (sign, bound) = if i < 8 { (-1.0, 0.0) } else { (1.0, CAP) };
        program.push(std::array::from_fn(|k| if i == k { sign } else { 0.0 }), bound);
    }
    let mut row = |entries: &[(usize, f64)], bound: f64| {
        let mut a = [0.0; 9];
        for &(k, x) in entries {
            a[k] = x;
        }
        program.push(a, bound);
    };
    for (k, [i, j]) in PAIRS.into_iter().enumerate() {
        row(&[(4 + k, 1.0), (i, -1.0)], 0.0);
        row(&[(4 + k, 1.0), (2 + j, -1.0)], 0.0);
        row(&[(4 + k, -1.0), (i, 1.0), (2 + j, 1.0)], 1.0);
    }
    for (k, [i, j]) in PAIRS.into_iter().enumerate() {
        // -1 <= (all products, but this one negative) - (the two coordinates that it does not have) <= 0
        let sign = |x: f64| {
            let products = (0..4).map(move |m| (4 + m, if m == k { -x } else { x }));
            products.chain([(1 - i, -x), (3 - j, -x)]).collect::<Vec<_>>()
        };
        row(&sign(1.0), 0.0);
        row(&sign(-1.0), 1.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn largest(margin: [f64; 8]) -> f64 {
        let mut program = Program::new();
        start(&mut program);
        // The margin is at most the linear form, shifted so as not to meet the cap.
        program.push(std::array::from_fn(|k| if k < 8 { -margin[k] } else { 1.0 }), -100.0);
        program.solve(f64::NEG_INFINITY).0[8] + 100.0
    }

    #[test]
    fn a_linear_form_is_largest_at_a_corner() {
        let mut state = 1u64;
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            ((state >> 33) % 9) as f64 - 4.0
        };
        for _ in 0..2000 {
            let form: [f64; 8] = std::array::from_fn(|_| next());
            let corner = |bits: u32| {
                let [u, v, s, t] = [0, 1, 2, 3].map(|i| f64::from(bits >> i & 1));
                let point = [u, v, s, t, u * s, u * t, v * s, v * t];
                form.iter().zip(point).map(|(f, x)| f * x).sum::<f64>()
            };
            let best = (0..16).map(corner).fold(f64::NEG_INFINITY, f64::max);
            assert!((largest(form) - best).abs() < 1e-9, "{form:?}: {} and {best}", largest(form));
        }
    }
}
