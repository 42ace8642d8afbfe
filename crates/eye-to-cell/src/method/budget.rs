//! How much work queries may do.

/// Work that a query may do before it takes the answer of a coarser method, in steps: about so many tests of a box against a
/// cone of sight. Never a time, so that the same queries have the same answers everywhere.
///
/// Given to the queries by [`Scratch::allow`](super::Scratch::allow).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct StepBudget(u64);

impl StepBudget {
    /// No bound.
    pub const UNLIMITED: Self = Self(u64::MAX);
    /// 4,096 steps, some tens of microseconds: what a frame of a walkthrough is allowed unless it is told otherwise. In open rooms many
    /// answers are then coarser ones. A step is no time: measure on your scenes.
    pub const FRAME: Self = Self(4096);

    /// So many steps. With 0 every answer of the exact method is that of the one before; from a cell without ways out the two are the same.
    pub const fn steps(n: u64) -> Self {
        Self(n)
    }

    /// The number of steps; `u64::MAX` for no bound.
    pub const fn n_steps(self) -> u64 {
        self.0
    }
}

/// What is left of a budget.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Work {
    left: u64,
}

/// Steps for a portal and a cone: about what clipping costs, in tests of boxes.
pub(super) const CLIP: u64 = 16;
/// Steps for trying to put two pieces together.
pub(super) const JOIN: u64 = 4;

impl Default for Work {
    fn default() -> Self {
        Self::of(StepBudget::UNLIMITED)
    }
}

impl Work {
    pub(super) const fn of(budget: StepBudget) -> Self {
        Self { left: budget.0 }
    }

    /// Takes some steps. Without a bound it never ends: no program counts so far.
    #[inline]
    pub(super) fn take(&mut self, n: u64) {
        self.left = self.left.saturating_sub(n);
    }

    /// Whether nothing is left.
    #[inline]
    pub(super) fn is_spent(self) -> bool {
        self.left == 0
    }

    pub(super) const fn left(self) -> u64 {
        self.left
    }
}
