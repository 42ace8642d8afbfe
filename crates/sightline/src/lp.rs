//! The same question as a linear program, as the literature puts it: for reference and for teaching.
//!
//! Unknown is a line `a x + b y + c`; every left end asks for a value of at least `margin`, every right
//! end for at most `-margin`, and the largest margin is wanted. The solver works in doubles with
//! tolerances of its own, so **its answer decides nothing**: with all coordinates moved by 10^6, the
//! solver behind good_lp's feature `minilp` was measured to call most stabbable sequences infeasible.
//! Here every sequence is first moved and scaled into the unit box, and a margin below [`CLEAR`] is
//! reported as unclear.
//!
//! Source: Teller and Séquin, SIGGRAPH 1991, section 4; Megiddo, SIAM J. Comput. 12, 1983.

use good_lp::{ProblemVariables, Solution, SolverModel, constraint, variable};
use sightlines_geometry::{Aabb, Portal2};

/// Margins above this are trusted, in units of the sequence's own bounding box. The solver's pivots
/// have tolerances of about 1e-8 on coefficients of magnitude 1; two orders more is kept.
pub const CLEAR: f64 = 1e-6;

/// What the linear program says.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum LpAnswer {
    /// A line with this margin passes.
    Open {
        /// Smallest value at any end, in units of the bounding box.
        margin: f64,
    },
    /// No line has a margin above [`CLEAR`]: blocked, or open by less than the solver can tell.
    Unclear,
    /// The solver failed.
    Failed,
}

/// Solves the program for a sequence; an empty one is open with margin 1.
pub fn stab(portals: &[Portal2]) -> LpAnswer {
    let ends = portals.iter().flat_map(|p| [[p.left.x, p.left.y], [p.right.x, p.right.y]]);
    let bounds = Aabb::around(ends);
    let size = (bounds.max[0] - bounds.min[0]).max(bounds.max[1] - bounds.min[1]);
    if portals.is_empty() || size <= 0.0 {
        return LpAnswer::Open { margin: 1.0 };
    }
    let unit = |x: f64, y: f64| ((x - bounds.min[0]) / size, (y - bounds.min[1]) / size);
    let mut variables = ProblemVariables::new();
    let [a, b] = [(); 2].map(|()| variables.add(variable().min(-1.0).max(1.0)));
    let c = variables.add(variable().min(-2.0).max(2.0));
    let margin = variables.add(variable().min(0.0).max(1.0));
    let mut model = variables.maximise(margin).using(good_lp::default_solver);
    for p in portals {
        let (x, y) = unit(p.left.x, p.left.y);
        model = model.with(constraint!(a * x + b * y + c - margin >= 0.0));
        let (x, y) = unit(p.right.x, p.right.y);
        model = model.with(constraint!(a * x + b * y + c + margin <= 0.0));
    }
    match model.solve() {
        Ok(solution) if solution.value(margin) > CLEAR => LpAnswer::Open { margin: solution.value(margin) },
        Ok(_) | Err(good_lp::ResolutionError::Infeasible) => LpAnswer::Unclear,
        Err(_) => LpAnswer::Failed,
    }
}
