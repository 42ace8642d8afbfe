//! Options of simplification.

/// Options of [`simplify`](crate::simplify).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SimplifyOptions {
    /// The largest share of the sphere of directions, from 0 to 1, whose first hit may change, for every eye that lies
    /// on no surface. 0 removes only what is proven hidden.
    pub budget: f64,
    /// The share of the budget, from 0 to 1, that is reserved for collapsing edges; the rest is for leaving out
    /// triangles, which makes holes as large as the budget.
    pub collapse: f64,
    /// Whether to merge faces of an object that lie exactly in one plane. This moves no visible point; colours and
    /// texture coordinates are interpolated over the larger faces, so they stay the same only where they are linear.
    pub flat: bool,
    /// Whether mirrors in scenes are ignored; otherwise such scenes are refused, as mirrors show what is hidden.
    pub ignore_mirrors: bool,
    /// How far collapsing may move a surface, as a fraction of its distance from the eye, for every eye; infinite for
    /// no limit.
    pub shift: f64,
    /// Smallest number of boxes into which the views are split before bounds are computed.
    pub n_parts: usize,
    /// Rays for the estimate that weighs faces for collapsing.
    pub n_rays: u64,
    /// How often a triangle is split in four to bound its share.
    pub depth: u32,
    /// Number of threads; 0 for one per core. Affects only the time.
    pub threads: usize,
}

impl Default for SimplifyOptions {
    fn default() -> Self {
        Self {
            budget: 0.0,
            collapse: 0.5,
            flat: false,
            ignore_mirrors: false,
            shift: 1.0 / 128.0,
            n_parts: 8,
            n_rays: 1 << 18,
            depth: 4,
            threads: 0,
        }
    }
}

/// An option out of its range.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum OptionsError {
    /// The budget.
    #[error("the budget is a share of the sphere of directions, from 0 to 1, not {0}")]
    Budget(f64),
    /// The share for collapsing.
    #[error("the share of the budget for collapsing is from 0 to 1, not {0}")]
    Collapse(f64),
    /// How far surfaces may move.
    #[error("collapsing moves surfaces by a part of their distance that is at least 0, not {0}")]
    Shift(f64),
    /// Number of boxes.
    #[error("the views are cut into 1 to 65536 boxes, not {0}")]
    Parts(usize),
    /// Depth of triangles.
    #[error("triangles are cut in four at most 8 times, not {0}")]
    Depth(u32),
}

impl SimplifyOptions {
    /// With another budget.
    #[must_use]
    pub const fn with_budget(mut self, budget: f64) -> Self {
        self.budget = budget;
        self
    }

    /// Checks all ranges.
    ///
    /// # Errors
    /// [`OptionsError`], for the first invalid option.
    pub fn check(&self) -> Result<(), OptionsError> {
        let share = |x: f64| (0.0..=1.0).contains(&x);
        if !share(self.budget) {
            return Err(OptionsError::Budget(self.budget));
        }
        if !share(self.collapse) {
            return Err(OptionsError::Collapse(self.collapse));
        }
        if self.shift.is_nan() || self.shift < 0.0 {
            return Err(OptionsError::Shift(self.shift));
        }
        if !(1..=crate::Views::MOST).contains(&self.n_parts) {
            return Err(OptionsError::Parts(self.n_parts));
        }
        if self.depth > 8 {
            return Err(OptionsError::Depth(self.depth));
        }
        Ok(())
    }
}
