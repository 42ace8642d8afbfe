//! A method that takes part in sweeps, what it may answer, and what an answer is worth.

/// What is expected of a method.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// What users get without choosing anything: no unsafe failure, no error.
    Shipped,
    /// Kept for comparison, and known to decide nothing.
    Reference,
    /// A solver of others, used plainly; charted, nothing is expected of it.
    Solver,
    /// The warning example: an unsafe failure somewhere is expected of it.
    Naive,
}

impl Kind {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Shipped, Self::Reference, Self::Solver, Self::Naive];

    /// The word for it in tables.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Shipped => "shipped",
            Self::Reference => "reference",
            Self::Solver => "solver",
            Self::Naive => "naive",
        }
    }
}

/// What a method says about a case.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Answer {
    /// It is visible, or unknown, which is the same for the caller.
    Seen,
    /// Nobody sees it.
    Hidden,
    /// The method has no answer. A panic is caught and counts as this.
    Failed,
}

/// What an answer is worth.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// The answer is the truth.
    Right,
    /// Hides what an open set of lines sees.
    Unsafe,
    /// Shows what is hidden.
    Loose,
    /// No answer.
    Error,
}

impl Outcome {
    /// Of an answer to a case that is open, which is seen through an open set of lines, or is not.
    pub const fn of(open: bool, answer: Answer) -> Self {
        match (open, answer) {
            (_, Answer::Failed) => Self::Error,
            (true, Answer::Hidden) => Self::Unsafe,
            (false, Answer::Seen) => Self::Loose,
            _ => Self::Right,
        }
    }
}

/// A method by its name, the same in all sweeps in which it takes part.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SweepMethod {
    /// Lower-case words without a comma.
    pub name: &'static str,
    /// What is expected of it.
    pub kind: Kind,
}

/// A method with what it answers about a case of type `C`.
pub type Decide<C> = (SweepMethod, fn(&C) -> Answer);

/// Names a method.
pub const fn method<C>(name: &'static str, kind: Kind, decide: fn(&C) -> Answer) -> Decide<C> {
    (SweepMethod { name, kind }, decide)
}
