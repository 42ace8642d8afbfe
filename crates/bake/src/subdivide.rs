//! How plans are cut, by name.

use std::fmt;
use std::str::FromStr;

/// How a plan is cut into cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Subdivide {
    /// By the k-d tree if every line is parallel to an axis and no line names a group, else by
    /// triangulation.
    #[default]
    Auto,
    /// By a k-d tree along the walls. Walls that are not parallel to an axis do not block.
    KdTree,
    /// By a constrained triangulation.
    Triangulation,
}

impl Subdivide {
    /// All ways to cut a plan.
    pub const ALL: [Self; 3] = [Self::Auto, Self::KdTree, Self::Triangulation];

    /// Lower-case name: what [`Display`](fmt::Display) writes and [`FromStr`] reads.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::KdTree => "kd",
            Self::Triangulation => "triangulation",
        }
    }
}

impl fmt::Display for Subdivide {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// Not the name of a subdivision.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("'{0}' is no subdivision: use auto, kd or triangulation")]
pub struct ParseSubdivideError(pub String);

impl FromStr for Subdivide {
    type Err = ParseSubdivideError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Self::ALL.into_iter().find(|how| how.name() == text).ok_or_else(|| ParseSubdivideError(text.to_owned()))
    }
}
