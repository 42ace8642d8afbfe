//! The contract of [`MultifocalBackend`], as code that anyone can run.
//!
//! [`run`] draws scenes, runs a backend and a reference on them, and compares their buffers:
//! 1. sound: no texel has more than the reference has;
//! 2. tight: texels that one occluder blocks with room to spare are blocked, and have values within the [`Slack`]; what
//!    is blocked on a plane is carried to the next one;
//! 3. complete: buffers with other content, of other sizes and numbers, end up equal to new ones;
//! 4. repeatable: two runs give the same bits.
//!
//! The suite is independent of how buffers are filled: the reference is another backend (that of
//! `sightlines-multifocal-cpu`), like the one under test. [`impostors`] are backends with one fault each, which the
//! suite must refuse.

mod check;
pub mod from_region;
pub mod impostors;
mod pair;
mod random;
mod scene;
mod shapes;
mod sweep;
mod tight;
mod violation;

use crate::{Measure, MultifocalBackend};
pub use violation::{Clause, Place, Violation};

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

    /// The integer form of umbrae and values ([`crate::form`]).
    ///
    /// * edge: coefficients are rounded by half a unit of at least 2^13 to a texel for windows of up to 2^13 texels, so over
    ///   the suite's windows, of less than 2^7 texels, an edge is off by less than 2^-6 texels, its constant included
    /// * section: heights are replaced by the chord of a concave function, taken over the whole umbra, and bounded from
    ///   the texel's lowest corner. The loss depends on the scene: in 50 quick runs 0.67 to 0.94 were kept. This is not
    ///   a theorem, but less would be a reason to investigate
    pub const INTEGER: Self = Self { edge: 1.0 / 64.0, value: 2, exact: false, section: 0.5 };
}

/// The effort of the suite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Effort {
    /// The seed of the scenes.
    pub seed: u64,
    /// Number of scenes in each family.
    pub rounds: u32,
    /// The slack of the backend.
    pub slack: Slack,
}

impl Effort {
    /// A few seconds with an exact reference, mostly the reference's.
    pub const fn quick(slack: Slack) -> Self {
        Self { seed: 1, rounds: 8, slack }
    }
}

/// Counts of a run without a violation.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Report {
    /// Scenes.
    pub scenes: usize,
    /// Jobs that the backend did.
    pub jobs: usize,
    /// Texels compared with the reference's.
    pub texels: usize,
    /// Those of them that the reference reports blocked.
    pub blocked: usize,
    /// Those of them that the backend reports blocked as well.
    pub found: usize,
    /// Texels that had to be blocked by one occluder.
    pub tight: usize,
    /// Those of them that were compared with the reference's value.
    pub valued: usize,
    /// Texels that had to be blocked because of the plane before.
    pub carried: usize,
    /// Those of them that no occluder blocks alone.
    pub fused: usize,
    /// Units above the lowest corner that the reference has for one occluder, in all.
    pub section: f64,
    /// Those of them that the backend has.
    pub section_kept: f64,
    /// Measures that the backend does not support.
    pub unsupported: usize,
}

/// Checks that `backend` keeps the contract, by comparing it with `reference`, which has to be exact and to support every
/// measure. The same effort draws the same scenes on every machine.
///
/// # Errors
/// The first [`Violation`] that was found; one of them is that there was nothing to compare.
pub fn run(
    backend: &mut dyn MultifocalBackend,
    reference: &mut dyn MultifocalBackend,
    effort: &Effort,
) -> Result<Report, Violation> {
    let mut report = Report::default();
    for round in 0..effort.rounds {
        for family in scene::FAMILIES {
            let scene = scene::Scene::draw(family, effort.seed, round);
            report.scenes += 1;
            for measure in measures(round) {
                let mut pair = pair::Pair { backend, reference, slack: &effort.slack, report: &mut report };
                if !pair.backend.supports(measure) {
                    check::refuses(&mut pair, &scene, measure)?;
                    continue;
                }
                check::compare(&mut pair, &scene, measure, round)?;
                tight::compare(&mut pair, &scene, measure)?;
            }
        }
    }
    check_counts(&report)?;
    check_section(&report, &effort.slack)?;
    Ok(report)
}

/// Heights always; distances, which take the reference a hundred times longer, in one round of four.
fn measures(round: u32) -> impl Iterator<Item = Measure> {
    Measure::ALL.into_iter().filter(move |measure| measure.is_height() || round.is_multiple_of(4))
}

/// A suite without cases proves nothing.
fn check_counts(report: &Report) -> Result<(), Violation> {
    let counts = [
        ("scenes", report.scenes),
        ("jobs", report.jobs),
        ("blocked texels", report.blocked),
        ("texels that one occluder blocks", report.tight),
        ("texels with values to compare", report.valued),
        ("texels that only a plane before blocks", report.fused),
    ];
    match counts.into_iter().find(|&(_, n)| n == 0) {
        Some((what, _)) => Err(Violation::NothingRan { what }),
        None => Ok(()),
    }
}

fn check_section(report: &Report, slack: &Slack) -> Result<(), Violation> {
    // Sums of whole numbers below 2^53.
    let wanted = report.section * slack.section;
    if report.section_kept < wanted {
        return Err(Violation::LooseSections { got: report.section_kept / report.section, wanted: slack.section });
    }
    Ok(())
}
