//! Linear programs given to three solvers of others, as their users would.

use super::method::Answer;
use good_lp::{Expression, ProblemVariables, ResolutionError, Solution, SolverModel, variable};

/// A solver.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Solver {
    /// `good_lp` with its feature `minilp`, which is microlp 0.6.
    GoodLp,
    /// minilp 0.2.2 itself.
    Minilp,
    /// microlp 0.7.
    Microlp,
}

/// Margins below this count as none: the solvers promise no more than about 1e-8.
const LEAST_MARGIN: f64 = 1e-9;

/// A program that asks for the largest last unknown, the margin.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Program {
    /// Least and largest value of each unknown; infinities where there is none.
    pub bounds: Vec<[f64; 2]>,
    /// Coefficients, by unknown, of sums that may not be negative.
    pub rows: Vec<Vec<f64>>,
}

/// The program as a `Problem` of a solver, with the variable of its margin. The two solvers have types of the same names,
/// as one descends from the other.
macro_rules! problem {
    ($solver:ident, $program:expr) => {{
        let program: &Program = $program;
        let mut problem = $solver::Problem::new($solver::OptimizationDirection::Maximize);
        let last = program.bounds.len() - 1;
        let objective = |k: usize| f64::from(u8::from(k == last));
        let unknowns: Vec<_> =
            program.bounds.iter().enumerate().map(|(k, b)| problem.add_var(objective(k), (b[0], b[1]))).collect();
        for row in &program.rows {
            let terms: Vec<_> = unknowns.iter().copied().zip(row.iter().copied()).collect();
            problem.add_constraint(terms.as_slice(), $solver::ComparisonOp::Ge, 0.0);
        }
        (problem, unknowns[last])
    }};
}

impl Program {
    /// Whether a solver finds a margin: [`Answer::Seen`] with one, [`Answer::Hidden`] without or where it says that
    /// nothing obeys the rows (zero always does), [`Answer::Failed`] for any other error. May panic, for minilp does.
    pub fn has_margin(&self, solver: Solver) -> Answer {
        let margin = match solver {
            Solver::GoodLp => self.by_good_lp(),
            Solver::Minilp => self.by_minilp(),
            Solver::Microlp => self.by_microlp(),
        };
        match margin {
            Ok(Some(margin)) if margin.is_nan() => Answer::Failed,
            Ok(Some(margin)) if margin > LEAST_MARGIN => Answer::Seen,
            Ok(_) => Answer::Hidden,
            Err(()) => Answer::Failed,
        }
    }

    fn by_good_lp(&self) -> Result<Option<f64>, ()> {
        let mut variables = ProblemVariables::new();
        let unknowns: Vec<_> = self.bounds.iter().map(|b| variables.add(variable().min(b[0]).max(b[1]))).collect();
        let margin = *unknowns.last().ok_or(())?;
        let mut model = variables.maximise(margin).using(good_lp::default_solver);
        for row in &self.rows {
            let sum: Expression = row.iter().zip(&unknowns).map(|(&c, &x)| c * x).sum();
            model = model.with(sum.geq(0.0));
        }
        match model.solve() {
            Ok(solution) => Ok(Some(solution.value(margin))),
            Err(ResolutionError::Infeasible) => Ok(None),
            Err(_) => Err(()),
        }
    }

    fn by_minilp(&self) -> Result<Option<f64>, ()> {
        let (problem, margin) = problem!(minilp, self);
        match problem.solve() {
            Ok(solution) => Ok(Some(solution[margin])),
            Err(minilp::Error::Infeasible) => Ok(None),
            Err(minilp::Error::Unbounded) => Err(()),
        }
    }

    fn by_microlp(&self) -> Result<Option<f64>, ()> {
        let (problem, margin) = problem!(microlp, self);
        match problem.solve() {
            Ok(outcome) => Ok(Some(outcome.solution().ok_or(())?.var_value(margin))),
            Err(microlp::Error::Infeasible) => Ok(None),
            Err(_) => Err(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// x at most 1 and a margin below it: all three find it; without room for one none does.
    #[test]
    fn solvers_solve_what_is_easy() {
        let program = |low: f64| Program {
            bounds: vec![[low, 1.0], [0.0, 1.0]],
            rows: vec![vec![1.0, -1.0], vec![-1.0, -1.0 + if low < 0.0 { 2.0 } else { 0.0 }]],
        };
        for solver in [Solver::GoodLp, Solver::Minilp, Solver::Microlp] {
            assert_eq!(program(-1.0).has_margin(solver), Answer::Seen, "{solver:?}");
            assert_eq!(program(0.0).has_margin(solver), Answer::Hidden, "{solver:?}");
        }
    }
}
