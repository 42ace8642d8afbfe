//! Contracts of interfaces, as code that any implementation can be run against.
//!
//! A [`Suite`] asks an implementation about cases and compares the answers. It gives a [`Report`] of what was compared, or
//! the first [`Violation`]. An [`Impostor`] is an implementation with one [`Fault`]; the suite has to refuse it for the
//! clause that the fault breaks, or it proves nothing.
//!
//! | interface | suite | faults |
//! | --- | --- | --- |
//! | [`Stabber`](sightlines_sightline::Stabber) | [`Stabbers`] | [`StabberFault`] |
//! | [`MultifocalBackend`](sightlines_multifocal::MultifocalBackend) | [`Backends`] | [`BackendFault`] |
//! | [`FromRegion`](sightlines_multifocal::FromRegion) | [`FromRegions`] | [`FromRegionFault`] |
//! | [`CellSource`](sightlines_eye_to_cell::CellSource) | [`CellSources`] | [`CellSourceFault`] |
//!
//! ```
//! use sightlines_geometry::Adaptive;
//! use sightlines_sightline::Funnel;
//! use sightlines_testkit::conformance::{Impostor, Stabbers, Suite};
//!
//! let mut funnel = Funnel::new(Adaptive);
//! let report = Stabbers::planar().run(&mut funnel)?;
//! assert!(report["open sequences"] > 0 && report["blocked sequences"] > 0);
//! Stabbers::planar().refuse_all(|fault| Impostor::new(funnel.clone(), fault));
//! # Ok::<(), sightlines_testkit::conformance::Violation>(())
//! ```

pub use crate::mutate::SplitMix as Random;
use std::collections::BTreeMap;
use std::fmt::{Debug, Display};
use std::ops::Index;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

/// Declares the faults of a contract's impostors, each with the clause that it breaks.
macro_rules! faults {
    ($(#[$about:meta])* $name:ident { $($(#[$what:meta])* $fault:ident breaks $clause:ident,)* }) => {
        $(#[$about])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub enum $name { $($(#[$what])* $fault,)* }

        impl $crate::conformance::Fault for $name {
            const ALL: &'static [Self] = &[$(Self::$fault),*];

            fn clause(self) -> $crate::conformance::Clause {
                match self { $(Self::$fault => $crate::conformance::Clause::$clause,)* }
            }
        }
    };
}

pub mod backends;
pub mod cell_sources;
pub mod from_regions;
mod random;
pub mod stabbers;

pub use backends::{BackendFault, Backends, Slack};
pub use cell_sources::{CellSourceFault, CellSources};
pub use from_regions::{FromRegionFault, FromRegions, RegionScene};
pub use stabbers::{StabberFault, Stabbers};

/// The clauses of all contracts; the documentation of a suite lists those of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Clause {
    /// Nothing that is visible is hidden.
    Conservative,
    /// No value is larger than the exact one.
    Sound,
    /// Enough is hidden.
    Tight,
    /// The same question has the same answer.
    Repeatable,
    /// An undone step leaves no trace.
    Undone,
    /// What a line meets is in reach.
    Reaching,
    /// Lines pass.
    Lines,
    /// Decisions are right, and their evidence holds.
    Evidence,
    /// Everything is written, whatever was there before.
    Complete,
    /// Hulls of points are hidden only if nothing reaches them.
    Points,
    /// What meets the volume is not hidden.
    Near,
    /// Ids are in range.
    Ranges,
    /// Lists ascend.
    Ordered,
    /// What leads there leads back.
    TwoSided,
    /// Boxes and corners are such.
    Shapes,
    /// Stab trees follow portals.
    Trees,
    /// What has to be done is done, without an error; what is not supported is refused.
    Done,
    /// Not a clause of an implementation: the suite itself compared nothing.
    Counted,
}

/// A broken clause.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{contract}, {clause:?}: {case}: expected {expected}, found {found}")]
pub struct Violation {
    /// The interface.
    pub contract: &'static str,
    /// The clause of its contract.
    pub clause: Clause,
    /// Enough to draw the case again.
    pub case: String,
    /// What the clause demands there.
    pub expected: String,
    /// What the implementation did.
    pub found: String,
}

/// Counts of what was compared.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Report {
    contract: &'static str,
    counts: BTreeMap<&'static str, usize>,
}

impl Report {
    /// Counts `n` more. Panics on a name that the suite does not declare, as reading one does.
    fn count(&mut self, what: &str, n: usize) {
        *self.counts.get_mut(what).unwrap_or_else(|| panic!("'{what}' is not counted")) += n;
    }

    /// A violation of the contract.
    fn broken(&self, clause: Clause, case: impl Display, expected: impl Display, found: impl Display) -> Violation {
        let [case, expected, found] = [case.to_string(), expected.to_string(), found.to_string()];
        Violation { contract: self.contract, clause, case, expected, found }
    }

    /// A violation unless something holds.
    fn check(
        &self,
        holds: bool,
        clause: Clause,
        case: impl Display,
        expected: impl Display,
        found: impl Display,
    ) -> Result<(), Violation> {
        if holds { Ok(()) } else { Err(self.broken(clause, case, expected, found)) }
    }

    /// Whether the second count is at least this part of the first.
    fn check_share(&self, part: f64, [all, found]: [&str; 2]) -> Result<(), Violation> {
        let (wanted, n) = (part * self[all] as f64, self[found]);
        let holds = n as f64 >= wanted;
        self.check(holds, Clause::Tight, "all cases", format_args!("{wanted} {found}"), n)
    }
}

impl Index<&str> for Report {
    type Output = usize;

    fn index(&self, what: &str) -> &usize {
        self.counts.get(what).unwrap_or_else(|| panic!("'{what}' is not counted"))
    }
}

/// A contract as code, for implementations of type `I`. The same suite draws the same cases on every machine.
pub trait Suite<I> {
    /// The interface.
    const CONTRACT: &'static str;
    /// Kinds of cases. A run without one of them proves nothing.
    const NEEDED: &'static [&'static str];
    /// What else is counted.
    const COUNTED: &'static [&'static str];

    /// Compares, and counts what it compares.
    ///
    /// # Errors
    /// The first [`Violation`].
    fn check(&self, implementation: &mut I, report: &mut Report) -> Result<(), Violation>;

    /// Checks an implementation, and that there was something to compare.
    ///
    /// # Errors
    /// The first [`Violation`].
    fn run(&self, implementation: &mut I) -> Result<Report, Violation> {
        let counts = Self::NEEDED.iter().chain(Self::COUNTED).map(|&what| (what, 0)).collect();
        let mut report = Report { contract: Self::CONTRACT, counts };
        self.check(implementation, &mut report)?;
        match Self::NEEDED.iter().find(|&&what| report[what] == 0) {
            Some(what) => Err(report.broken(Clause::Counted, "all cases", format!("some {what}"), "none")),
            None => Ok(report),
        }
    }

    /// Panics unless an impostor is refused, for the clause that its fault breaks.
    fn refuse(&self, fault: impl Fault, impostor: &mut I) {
        match self.run(impostor) {
            Ok(report) => panic!("{fault:?} goes unnoticed: {report:?}"),
            Err(violation) => assert_eq!(violation.clause, fault.clause(), "{fault:?}: {violation}"),
        }
    }

    /// The same for the impostors with each of the faults.
    fn refuse_all<F: Fault>(&self, mut impostor: impl FnMut(F) -> I) {
        F::ALL.iter().for_each(|&fault| self.refuse(fault, &mut impostor(fault)));
    }
}

/// What impostors do wrong.
pub trait Fault: Copy + Debug + 'static {
    /// All of them.
    const ALL: &'static [Self];

    /// The clause that it breaks, of an implementation that keeps all others without any slack.
    fn clause(self) -> Clause;
}

/// An implementation with one fault.
#[derive(Debug, Clone)]
pub struct Impostor<I, F, M = ()> {
    inner: I,
    fault: F,
    /// What a fault needs to have noted.
    memory: M,
    /// Shared by clones, so that they do not answer alike.
    n_calls: Arc<AtomicUsize>,
}

impl<I, F, M: Default> Impostor<I, F, M> {
    /// A faultless implementation, with a fault.
    pub fn new(inner: I, fault: F) -> Self {
        Self { inner, fault, memory: M::default(), n_calls: Arc::default() }
    }
}

impl<I, F, M> Impostor<I, F, M> {
    /// The number of calls before this one.
    fn call(&self) -> usize {
        self.n_calls.fetch_add(1, Relaxed)
    }
}
