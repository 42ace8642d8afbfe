//! What can be wrong with a DXF drawing, and where.

use super::{MAX_ELEMENTS, MAX_NESTING};
use sightlines_cells::PlanError;
use sightlines_geometry::CoordinateError;
use std::fmt;

/// A DXF text that is not a plan, shown as `line 12: ...`.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{}{kind}", at(*line))]
pub struct DxfError {
    /// Line of the text, from 1; `None` for what concerns the whole.
    pub line: Option<usize>,
    /// What is wrong.
    #[source]
    pub kind: DxfErrorKind,
}

impl DxfError {
    pub(super) const fn at(line: usize, kind: DxfErrorKind) -> Self {
        Self { line: Some(line), kind }
    }

    pub(super) const fn whole(kind: DxfErrorKind) -> Self {
        Self { line: None, kind }
    }
}

fn at(line: Option<usize>) -> String {
    line.map_or(String::new(), |line| format!("line {line}: "))
}

/// What is wrong with a DXF text.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DxfErrorKind {
    /// The other form of DXF.
    #[error("this is binary DXF, which is not read: save it as text (ASCII)")]
    Binary,
    /// The text ends before `EOF`.
    #[error("the drawing ends without EOF, so that a part of it may be missing")]
    Truncated,
    /// A line that should be a group code.
    #[error("this is no group code, which is a whole number")]
    Code,
    /// What stands where a section or an entity should begin or end.
    #[error("expected {0}")]
    Expected(&'static str),
    /// A value that is not a number where one belongs.
    #[error("this is no finite number")]
    Number,
    /// A number that cannot be what it stands for.
    #[error("{what} is {value}, which cannot be")]
    Value {
        /// What it stands for.
        what: &'static str,
        /// The number.
        value: f64,
    },
    /// An entity without a group that it needs.
    #[error("the {entity} has no {what}")]
    Missing {
        /// The kind of entity.
        entity: &'static str,
        /// What is missing.
        what: &'static str,
    },
    /// A number that cannot be a coordinate, or becomes one by inserts that cannot be.
    #[error(transparent)]
    Coordinate(#[from] CoordinateError),
    /// Degree, knots, weights and control points of a spline do not go together.
    #[error("the spline is malformed: {0}")]
    Spline(&'static str),
    /// An insert of a block that is not there.
    #[error("there is no block \"{0}\"")]
    NoSuchBlock(String),
    /// A block that contains itself.
    #[error("the block \"{0}\" contains itself")]
    Recursion(String),
    /// Too many blocks in blocks.
    #[error("blocks are nested more than {MAX_NESTING} deep")]
    Nesting,
    /// Too much of everything.
    #[error("the drawing, with its blocks inserted, has more than {MAX_ELEMENTS} elements")]
    TooMany,
    /// Layers that were asked for and are not there.
    #[error("there is no layer {}; there {}", list(unknown), there_are(names))]
    NoSuchLayer {
        /// Those that are not there.
        unknown: Vec<String>,
        /// Those that are.
        names: Vec<String>,
    },
    /// A deviation of curves that is none.
    #[error("{0} is no deviation of curves, which is a number above 0")]
    Deviation(f64),
    /// The whole is not a plan.
    #[error(transparent)]
    Plan(#[from] PlanError),
}

/// Most names in a message.
const MOST: usize = 40;

fn list(names: &[String]) -> impl fmt::Display {
    let shown: Vec<String> = names.iter().take(MOST).map(|name| name.escape_debug().to_string()).collect();
    let more = if names.len() > MOST { format!(" and {} more", names.len() - MOST) } else { String::new() };
    format!("{}{more}", shown.join(", "))
}

fn there_are(names: &[String]) -> String {
    match names {
        [] => "are none".to_owned(),
        [name] => format!("is {}", name.escape_debug()),
        _ => format!("are {}", list(names)),
    }
}

/// A deviation that can be kept.
pub(super) fn check_deviation(deviation: f64) -> Result<f64, DxfError> {
    let fits = deviation.is_finite() && deviation > 0.0;
    if fits { Ok(deviation) } else { Err(DxfError::whole(DxfErrorKind::Deviation(deviation))) }
}

impl From<DxfError> for crate::ReadErrorKind {
    fn from(error: DxfError) -> Self {
        Self::content(error)
    }
}
