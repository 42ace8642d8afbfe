//! What buffers compare, as an argument.

use sightlines::multifocal::Measure;

/// A measure as an argument.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum MeasureArg {
    Euclid,
    Clipped,
    VertexHeight,
    Height,
}

impl MeasureArg {
    /// The measure.
    pub(crate) const fn measure(self) -> Measure {
        match self {
            Self::Euclid => Measure::Euclid,
            Self::Clipped => Measure::ClippedEuclid,
            Self::VertexHeight => Measure::VertexHeight,
            Self::Height => Measure::SectionHeight,
        }
    }
}
