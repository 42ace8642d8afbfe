//! The basis of a dual simplex method and its exchange step, in doubles: shared by the linear programs of boxes and of
//! convex polygons, which differ in their columns and in how they find the entering one.

/// Entries of smaller magnitude are not used as pivots.
const PIVOT: f64 = 1e-11;

/// `N` columns, named by `C`, with the explicit inverse of their matrix and the weights that solve the dual program.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Basis<C, const N: usize> {
    pub(crate) columns: [C; N],
    pub(crate) inverse: [[f64; N]; N],
    pub(crate) weights: [f64; N],
}

impl<C: Copy, const N: usize> Basis<C, N> {
    /// Exchanges a column for `entering`, given with its coefficients; false if none can leave. The column that leaves keeps
    /// all weights non-negative; of several, it has the largest pivot, then the lowest place. Columns that are equations
    /// never leave, and their weights may have any sign.
    #[inline]
    pub(crate) fn exchange(&mut self, entering: C, coefficients: &[f64; N], is_equation: impl Fn(C) -> bool) -> bool {
        let image: [f64; N] =
            std::array::from_fn(|i| self.inverse[i].iter().zip(coefficients).map(|(r, a)| r * a).sum());
        let mut leaving: Option<(usize, f64)> = None;
        for i in 0..N {
            if image[i] <= PIVOT || is_equation(self.columns[i]) {
                continue;
            }
            let ratio = self.weights[i] / image[i];
            let better = leaving.is_none_or(|(k, best)| ratio < best || (ratio == best && image[i] > image[k]));
            if better {
                leaving = Some((i, ratio));
            }
        }
        let Some((out, ratio)) = leaving else { return false };
        let scaled = self.inverse[out].map(|r| r / image[out]);
        for (i, factor) in image.into_iter().enumerate().filter(|&(i, _)| i != out) {
            self.weights[i] -= ratio * factor;
            if !is_equation(self.columns[i]) {
                self.weights[i] = self.weights[i].max(0.0);
            }
            for (r, s) in self.inverse[i].iter_mut().zip(&scaled) {
                *r -= factor * s;
            }
        }
        (self.inverse[out], self.weights[out], self.columns[out]) = (scaled, ratio, entering);
        true
    }
}
