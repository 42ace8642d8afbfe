//! The question of a stabbing line as a linear program, as the literature puts it: for reference and for teaching.
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
use sightlines_geometry::{Aabb, AxialDoor, Portal2};

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

/// The same for axis-aligned doors in space: the best of the programs of all octants of directions, with
/// slownesses between the margin and 1 and four rows for each door (see `axial` of `sightlines-sightline`). An
/// empty sequence is open with margin 1.
pub fn stab_axial(doors: &[AxialDoor]) -> LpAnswer {
    if doors.is_empty() {
        return LpAnswer::Open { margin: 1.0 };
    }
    let bounds = Aabb::around(doors.iter().flat_map(|d| [d.extent.min, d.extent.max]));
    let octants = (0..8u8).map(|bits| [0, 1, 2].map(|axis| bits >> axis & 1 == 1));
    let possible = octants.filter(|signs| doors.iter().all(|d| signs[usize::from(d.axis)] == d.forward));
    possible.map(|signs| octant(doors, &bounds, signs)).fold(LpAnswer::Unclear, |best, answer| match (best, answer) {
        (LpAnswer::Open { margin: a }, LpAnswer::Open { margin: b }) => LpAnswer::Open { margin: a.max(b) },
        (LpAnswer::Open { .. }, _) | (LpAnswer::Failed, LpAnswer::Unclear) => best,
        _ => answer,
    })
}

fn octant(doors: &[AxialDoor], bounds: &Aabb<3>, signs: [bool; 3]) -> LpAnswer {
    // Each axis is moved and scaled to the unit interval, in the direction of the octant.
    let unit = |axis: usize, x: f64| {
        let u = (x - bounds.min[axis]) / (bounds.max[axis] - bounds.min[axis]).max(f64::MIN_POSITIVE);
        if signs[axis] { u } else { 1.0 - u }
    };
    let mut variables = ProblemVariables::new();
    let margin = variables.add(variable().min(0.0).max(1.0));
    let slowness = [(); 3].map(|()| variables.add(variable().min(0.0).max(1.0)));
    let offset = [(); 3].map(|()| variables.add(variable().min(-4.0).max(4.0)));
    let time = |axis: usize, x: f64| slowness[axis] * unit(axis, x) - offset[axis];
    let mut model = variables.maximise(margin).using(good_lp::default_solver);
    for s in slowness {
        model = model.with(constraint!(s - margin >= 0.0));
    }
    for door in doors {
        let axis = usize::from(door.axis);
        for other in (0..3).filter(|&other| other != axis) {
            let [low, high] = [door.extent.min[other], door.extent.max[other]];
            let [first, last] = if signs[other] { [low, high] } else { [high, low] };
            model = model.with(constraint!(time(axis, door.at()) - time(other, first) - margin >= 0.0));
            model = model.with(constraint!(time(other, last) - time(axis, door.at()) - margin >= 0.0));
        }
    }
    match model.solve() {
        Ok(solution) if solution.value(margin) > CLEAR => LpAnswer::Open { margin: solution.value(margin) },
        Ok(_) | Err(good_lp::ResolutionError::Infeasible) => LpAnswer::Unclear,
        Err(_) => LpAnswer::Failed,
    }
}
