//! How queries were decided.

/// Work counts of a [`ConvexStabber`](super::ConvexStabber) since it was created. Deterministic.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct ConvexStabberCounters {
    /// Sequences decided.
    pub n_asked: u64,
    /// Linear programs solved.
    pub n_programs: u64,
    /// Their pivots.
    pub n_pivots: u64,
    /// Boxes of lines examined, the first of each sequence included.
    pub n_boxes: u64,
    /// Visible by the line given as a hint.
    pub n_by_hint: u64,
    /// Visible by a line found by turns from the hint or the middle.
    pub n_by_turns: u64,
    /// Visible by a line found by turns from the relaxed line of the whole box.
    pub n_by_relaxed: u64,
    /// Visible by a line found after cutting the box.
    pub n_by_cutting: u64,
    /// Hidden by the program in which products are free.
    pub n_hidden_free: u64,
    /// Hidden by the program with bounds on products.
    pub n_hidden_bounded: u64,
    /// Hidden after cutting the box.
    pub n_hidden_cut: u64,
    /// Hidden by a plane with portals on alternating sides.
    pub n_hidden_plane: u64,
    /// Given up.
    pub n_undecided: u64,
    /// Sequences looked at in numbers of two doubles.
    pub n_finely: u64,
    /// Visible by a line in such numbers.
    pub n_by_fine: u64,
    /// Hidden by a sum over hulls, found in such numbers.
    pub n_hidden_fine: u64,
}

impl ConvexStabberCounters {
    /// Every counter, in the order of declaration.
    const fn all(&mut self) -> [&mut u64; 16] {
        [
            &mut self.n_asked,
            &mut self.n_programs,
            &mut self.n_pivots,
            &mut self.n_boxes,
            &mut self.n_by_hint,
            &mut self.n_by_turns,
            &mut self.n_by_relaxed,
            &mut self.n_by_cutting,
            &mut self.n_hidden_free,
            &mut self.n_hidden_bounded,
            &mut self.n_hidden_cut,
            &mut self.n_hidden_plane,
            &mut self.n_undecided,
            &mut self.n_finely,
            &mut self.n_by_fine,
            &mut self.n_hidden_fine,
        ]
    }
}

impl std::ops::Add for ConvexStabberCounters {
    type Output = Self;

    fn add(mut self, mut other: Self) -> Self {
        self.all().into_iter().zip(other.all()).for_each(|(x, y)| *x += *y);
        self
    }
}

impl std::ops::Sub for ConvexStabberCounters {
    type Output = Self;

    /// The difference from `other`, an earlier count.
    fn sub(mut self, mut other: Self) -> Self {
        self.all().into_iter().zip(other.all()).for_each(|(x, y)| *x -= *y);
        self
    }
}
