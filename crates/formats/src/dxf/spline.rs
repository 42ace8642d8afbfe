//! Splines (NURBS), and the Bézier curves that they consist of.

use super::curve::Bezier;
use sightlines_geometry::check_coordinate;

/// The largest degree that is read; drawings have 2 or 3, and programs go up to 11.
const MAX_DEGREE: i64 = 25;

/// A spline that was checked: knots that ascend, one weight above zero for each point.
#[derive(Debug)]
pub(super) struct Spline {
    degree: usize,
    knots: Vec<f64>,
    points: Vec<([f64; 3], f64)>,
    is_closed: bool,
}

impl Spline {
    pub(super) fn new(
        degree: i64,
        knots: Vec<f64>,
        points: Vec<[f64; 3]>,
        mut weights: Vec<f64>,
        is_closed: bool,
    ) -> Result<Self, &'static str> {
        if !(1..=MAX_DEGREE).contains(&degree) {
            return Err("its degree is not between 1 and 25");
        }
        // In range, as was checked.
        let degree = degree as usize;
        if weights.is_empty() {
            weights = vec![1.0; points.len()];
        }
        if points.len() <= degree {
            return Err("there are no more control points than its degree");
        }
        if knots.len() != points.len() + degree + 1 {
            return Err("there are not as many knots as control points, the degree and one more");
        }
        if knots.windows(2).any(|pair| pair[0] > pair[1]) {
            return Err("the knots descend");
        }
        if weights.len() != points.len()
            || weights.iter().any(|&weight| weight <= 0.0 || check_coordinate(weight).is_err())
        {
            return Err("there is not one weight above zero, between 2^-140 and 2^200, for each control point");
        }
        if knots[degree] >= knots[points.len()] {
            return Err("all of its knots are one");
        }
        // A knot within that is there more often than the degree.
        let is_broken =
            |k: usize| knots[k] == knots[k + degree] && knots[k] > knots[degree] && knots[k] < knots[points.len()];
        if (0..knots.len() - degree).any(is_broken) {
            return Err("it is in two parts");
        }
        Ok(Self { degree, knots, points: points.into_iter().zip(weights).collect(), is_closed })
    }

    /// The number of corners that [`Spline::pieces`] gives at most.
    pub(super) fn n_corners(&self) -> usize {
        (self.points.len() - self.degree).saturating_mul(self.degree + 1).saturating_add(2)
    }

    /// The curves, each of which begins where the one before it ends. A closed one ends where it begins.
    pub(super) fn pieces(&self) -> Vec<Bezier<3>> {
        let mut pieces: Vec<Bezier<3>> = Vec::new();
        for span in self.degree..self.points.len() {
            let (from, to) = (self.knots[span], self.knots[span + 1]);
            if from >= to {
                continue;
            }
            let corner = |n_to: usize| {
                let parameters = (0..self.degree).map(|k| if k < n_to { to } else { from });
                self.blossom(span, parameters)
            };
            let mut corners: Vec<_> = (0..=self.degree).map(corner).collect();
            if let Some(before) = pieces.last() {
                // The same point but for rounding.
                corners[0].0 = before.corners[self.degree].0;
            }
            pieces.push(Bezier { corners });
        }
        if let (true, Some(first), Some(last)) = (self.is_closed, pieces.first(), pieces.last()) {
            let ends = [last.corners[self.degree].0, first.corners[0].0];
            pieces.push(Bezier { corners: ends.map(|p| (p, 1.0)).to_vec() });
        }
        pieces
    }

    /// The value of the form of a span for as many parameters as the degree, by de Boor's algorithm.
    fn blossom(&self, span: usize, parameters: impl Iterator<Item = f64>) -> ([f64; 3], f64) {
        let p = self.degree;
        let mut d: Vec<([f64; 3], f64)> = self.points[span - p..=span].to_vec();
        for (r, t) in (1..=p).zip(parameters) {
            for k in (r..=p).rev() {
                let (low, high) = (self.knots[span - p + k], self.knots[span + 1 + k - r]);
                // The span between them is not empty.
                let share = (t - low) / (high - low);
                d[k] = between(d[k - 1], d[k], share);
            }
        }
        d[p]
    }
}

/// The point at a share of the way between two with weights; at 0 and 1 exactly these.
fn between((a, u): ([f64; 3], f64), (b, v): ([f64; 3], f64), share: f64) -> ([f64; 3], f64) {
    if share == 0.0 {
        return (a, u);
    }
    if share == 1.0 {
        return (b, v);
    }
    let (u, v) = ((1.0 - share) * u, share * v);
    (std::array::from_fn(|k| (u * a[k] + v * b[k]) / (u + v)), u + v)
}
