//! The contract of [`MultifocalBackend`].
//!
//! Scenes are drawn, a backend and a reference run on them, and their buffers are compared. The clauses are those of
//! [`MultifocalBackend`], with the [`Slack`] that is stated; besides, what is blocked on a plane is carried to the next one,
//! buffers with other content, of other sizes and numbers, end up equal to new ones, and measures that are not supported
//! are refused.
//!
//! The suite is independent of how buffers are filled: the reference is another backend (that of
//! `sightlines-multifocal-cpu`), like the one under test.

mod check;
mod impostor;
mod scene;
mod shapes;
mod sweep;
mod tight;

use super::{Clause, Random, Report, Suite, Violation};
pub use impostor::BackendFault;
use scene::{FAMILIES, Scene};
use sightlines_multifocal::{BackendError, Buffer, BufferJob, Measure, MultifocalBackend};
use std::fmt::Display;

/// How much a backend may miss of the reference, on the safe side. There are no other tolerances.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slack {
    /// Texels: what is blocked by this much more than a texel on all sides, and towards the viewers, has to be blocked.
    pub edge: f64,
    /// Units of the job: how much smaller a value may be than the one it is compared with.
    pub value: u32,
    /// Whether values of single occluders are compared with the reference's, else with the height of the occluder's
    /// lowest corner, and with the reference's only if the occluder is parallel to the plane.
    pub exact: bool,
    /// Heights above that of the occluder's lowest corner: the part of the reference's, over all compared texels, that
    /// values must reach.
    pub section: f64,
}

impl Slack {
    /// None: for backends that compute what the reference computes.
    pub const EXACT: Self = Self { edge: 0.0, value: 0, exact: true, section: 1.0 };

    /// The integer form of umbrae and values ([`sightlines_multifocal::form`]).
    ///
    /// * edge: coefficients are rounded by half a unit of at least 2^13 to a texel for windows of up to 2^13 texels, so over
    ///   the suite's windows, of less than 2^7 texels, an edge is off by less than 2^-6 texels, its constant included
    /// * section: heights are replaced by the chord of a concave function, taken over the whole umbra, and bounded from
    ///   the texel's lowest corner. The loss depends on the scene: in 50 quick runs 0.67 to 0.94 were kept. This is not
    ///   a theorem, but less would be a reason to investigate
    pub const INTEGER: Self = Self { edge: 1.0 / 64.0, value: 2, exact: false, section: 0.5 };
}

/// The suite of backends.
#[derive(Debug, Clone)]
pub struct Backends<R> {
    /// Exact, and supports every measure.
    pub reference: R,
    /// The seed of the scenes.
    pub seed: u64,
    /// Number of scenes in each family.
    pub rounds: u32,
    /// The slack of the backend.
    pub slack: Slack,
}

impl<R> Backends<R> {
    /// A few seconds with an exact reference, mostly the reference's.
    pub const fn quick(reference: R, slack: Slack) -> Self {
        Self { reference, seed: 1, rounds: 8, slack }
    }
}

impl<B: MultifocalBackend, R: MultifocalBackend + Clone> Suite<B> for Backends<R> {
    const CONTRACT: &'static str = "multifocal backend";
    const NEEDED: &'static [&'static str] = &[
        "scenes",
        "jobs",
        "blocked texels",
        "texels that one occluder blocks",
        "texels with values to compare",
        "texels that only a plane before blocks",
    ];
    const COUNTED: &'static [&'static str] = &[
        "texels",
        "blocked texels found",
        "texels that a plane before blocks",
        "units above lowest corners",
        "units above lowest corners found",
        "measures not supported",
    ];

    fn check(&self, backend: &mut B, report: &mut Report) -> Result<(), Violation> {
        for round in 0..self.rounds {
            for family in FAMILIES {
                let scene = Scene::draw(family, self.seed, round);
                report.count("scenes", 1);
                for measure in measures(round) {
                    let (reference, slack) = (&mut self.reference.clone(), self.slack);
                    Pair { backend, reference, slack, report, scene: &scene, measure }.compare()?;
                }
            }
        }
        report.check_share(self.slack.section, ["units above lowest corners", "units above lowest corners found"])
    }
}

/// Heights always; distances, which take the reference a hundred times longer, in one round of four.
fn measures(round: u32) -> impl Iterator<Item = Measure> {
    Measure::ALL.into_iter().filter(move |measure| measure.is_height() || round.is_multiple_of(4))
}

/// The two backends that are compared.
struct Pair<'a> {
    backend: &'a mut dyn MultifocalBackend,
    reference: &'a mut dyn MultifocalBackend,
    slack: Slack,
    report: &'a mut Report,
    scene: &'a Scene,
    measure: Measure,
}

impl Pair<'_> {
    /// A violation in a texel of a plane, counted through the rows.
    fn broken(&self, clause: Clause, at: [usize; 2], expected: impl Display, found: impl Display) -> Violation {
        let ([plane, i], Scene { family, seed, round, planes, .. }, measure) = (at, self.scene, self.measure.name());
        let width = planes[plane].texels()[0] as usize;
        let texel = (i % width, i / width);
        let case = format_args!("scene {family} {round} of seed {seed}, {measure}, plane {plane}, texel {texel:?}");
        self.report.broken(clause, case, expected, found)
    }

    /// Clause 2 for one texel, of which a value is known.
    fn is_tight(&self, at: [usize; 2], known: u32, got: u32) -> Result<(), Violation> {
        // A blocked texel has at least 1.
        let wanted = known.saturating_sub(self.slack.value).max(1);
        if got >= wanted { Ok(()) } else { Err(self.broken(Clause::Tight, at, format_args!("at least {wanted}"), got)) }
    }

    /// The buffers of the backend.
    fn own(&mut self, job: &BufferJob<'_>, mut out: Vec<Buffer>) -> Result<Vec<Buffer>, Violation> {
        let done = self.backend.render(job, &mut out);
        self.done(job, done.map(|()| out))
    }

    /// Those of the reference.
    fn exact(&mut self, job: &BufferJob<'_>) -> Result<Vec<Buffer>, Violation> {
        let mut out = Vec::new();
        let done = self.reference.render(job, &mut out);
        self.done(job, done.map(|()| out))
    }

    /// Buffers, checked for their shapes.
    fn done(&self, job: &BufferJob<'_>, out: Result<Vec<Buffer>, BackendError>) -> Result<Vec<Buffer>, Violation> {
        let out = out.map_err(|error| self.broken(Clause::Done, [0; 2], "buffers", error))?;
        let shapes: Vec<[u32; 2]> = out.iter().map(Buffer::texels).collect();
        let wanted: Vec<[u32; 2]> = job.planes().iter().map(|plane| plane.texels()).collect();
        if shapes == wanted {
            return Ok(out);
        }
        Err(self.broken(Clause::Complete, [0; 2], format_args!("buffers of {wanted:?}"), format_args!("{shapes:?}")))
    }
}
