//! The meaning of a buffer's values.

/// How far in front of a texel everything is blocked: the measure that occluders and occludees are compared by.
///
/// All grow strictly along every segment from the plane to an eye, which is all that soundness needs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub enum Measure {
    /// The distance to the texel, as in the slides: for an occluder the shortest from the texel to any point
    /// of it.
    Euclid,
    /// The distance to the texel, but only to those points of an occluder that lines from the texel to eyes
    /// meet.
    ClippedEuclid,
    /// The height above the plane: for an occluder the lowest of its corners.
    VertexHeight,
    /// The height above the plane: for an occluder the lowest of the points that lines from the texel to
    /// eyes meet.
    #[default]
    SectionHeight,
}

impl Measure {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Euclid, Self::ClippedEuclid, Self::VertexHeight, Self::SectionHeight];

    /// Lower-case name for options and charts.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Euclid => "euclid",
            Self::ClippedEuclid => "clipped",
            Self::VertexHeight => "vertex-height",
            Self::SectionHeight => "height",
        }
    }

    /// Whether values are heights above the plane; otherwise they are distances from the texel.
    pub const fn is_height(self) -> bool {
        matches!(self, Self::VertexHeight | Self::SectionHeight)
    }
}
